"""`coadapt study serve` as a process: links, tokens, TLS, changes of the protocol, the end."""

from __future__ import annotations

import contextlib
import os
import re
import signal
import socket
import ssl
import subprocess
import sys
from collections.abc import Generator
from pathlib import Path

import httpx2
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from coadapt.cli import main
from coadapt.study.protocol.reader import FILE
from coadapt.study.server.run import Address
from coadapt.study.server.security import is_admin_token
from coadapt.study.server.unchanged import differences
from coadapt.study.store import Store
from tests.study.sessions import small_study

PROGRAM = [sys.executable, "-c", "import sys; from coadapt.cli import main; sys.exit(main())"]


@pytest.fixture
def directory(tmp_path: Path) -> Path:
    """A study of its own, with the policies that other tests have planned."""
    planned, _, _ = small_study()
    (tmp_path / FILE).write_bytes((planned / FILE).read_bytes())
    (tmp_path / "policies").symlink_to(planned / "policies")
    return tmp_path


def start(directory: Path, *options: str) -> subprocess.Popen[str]:
    command = [*PROGRAM, "study", "serve", f"{directory}", "--port", "0", *options]
    pipe = subprocess.PIPE
    return subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, env={**os.environ})


@contextlib.contextmanager
def served(directory: Path, *options: str) -> Generator[tuple[str, str, subprocess.Popen[str]]]:
    """The address, what the program printed, and its process; it ends by SIGTERM."""
    process = start(directory, *options)
    assert process.stdout is not None
    printed = ""
    try:
        for line in process.stdout:
            printed += line
            if line.startswith("Ctrl-C"):
                break
        else:
            pytest.fail(f"did not start: {process.stderr.read() if process.stderr else ''}")
        yield printed.split()[1], printed, process
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGTERM)
        process.communicate(timeout=30)


def refused(capsys: pytest.CaptureFixture[str], directory: Path, *options: str) -> str:
    """The error of a server that must not start."""
    capsys.readouterr()
    assert main(["study", "serve", f"{directory}", "--port", "0", *options]) == 2
    error = capsys.readouterr().err
    assert len(error.splitlines()) == 1
    return error


def test_links_tokens_and_changes(directory: Path, capsys: pytest.CaptureFixture[str]) -> None:
    url = Store.url_in(directory)
    with served(directory) as (address, printed, process):
        token = re.search(r"/admin\?token=(\S+)", printed)
        assert token is not None
        assert "PROLIFIC_PID={{%PROLIFIC_PID%}}" in printed
        answer = httpx2.get(address)  # the first participant
        assert answer.status_code == 303
        page = httpx2.get(address.rstrip("/") + answer.headers["location"])
        assert "Welcome" in page.text
        process.send_signal(signal.SIGINT)
        _, error = process.communicate(timeout=30)
        assert process.returncode == 0
        assert error == ""  # local: no warning, and nothing else to say
    store = Store(url)
    assert is_admin_token(store, token[1])
    assert not is_admin_token(store, token[1] + "x")
    assert token[1] not in store.settings().values()
    content = b"".join(path.read_bytes() for path in directory.glob("study.db*"))
    assert token[1].encode() not in content  # only its hash is kept
    text = (directory / FILE).read_text()
    (directory / FILE).write_text("# A comment changes nothing.\n" + text)
    with served(directory, "--new-token") as (_, printed, _):
        new = re.search(r"/admin\?token=(\S+)", printed)
        assert new is not None and is_admin_token(store, new[1])
        assert not is_admin_token(store, token[1])
    (directory / FILE).write_text(text.replace("trials = 3", "trials = 4"))
    error = refused(capsys, directory)
    assert "study.toml: found changes of trials since the first participant came" in error
    with served(directory, "--accept-changes") as (_, printed, _):
        assert "admin?token" not in printed  # the old one still holds
    (directory / FILE).write_text(text)
    assert "found changes of trials" in refused(capsys, directory)  # what was accepted counts now
    store.close()


def test_a_port_that_is_taken_and_other_errors(
    directory: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        error = refused(capsys, directory, "--port", f"{port}")
        assert f"cannot listen at 127.0.0.1 port {port}: Address already in use" in error
    assert "--certificate and --key go together" in refused(capsys, directory, "--key", "k.pem")
    assert "found no file" in refused(
        capsys, directory, "--key", "no.pem", "--certificate", "no.pem"
    )
    (directory / FILE).write_text("format = 2\n")
    assert "study.toml" in refused(capsys, directory)


def test_tls(directory: Path, capsys: pytest.CaptureFixture[str]) -> None:
    certificate, key = directory / "cert.pem", directory / "key.pem"
    making = ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256"]
    making += ["-nodes", "-keyout", f"{key}", "-out", f"{certificate}", "-days", "2"]
    making += ["-subj", "/CN=localhost", "-addext", "subjectAltName=IP:127.0.0.1"]
    subprocess.run(
        making,
        check=True,
        capture_output=True,
    )
    trusting = ssl.create_default_context(cafile=f"{certificate}")
    options = ("--certificate", f"{certificate}", "--key", f"{key}")
    with served(directory, *options) as (address, _, process):
        assert address.startswith("https://127.0.0.1:")
        answer = httpx2.get(address, verify=trusting)
        assert "Secure" in answer.headers["set-cookie"]
        link = address.replace("https", "wss").rstrip("/") + answer.headers["location"] + "/steer"
        with connect(link, ssl=trusting) as websocket:
            websocket.send('{"type":"ping","page_time":1}')
            assert '"pong"' in f"{websocket.recv()}"
            process.send_signal(signal.SIGTERM)  # an open connection does not hold up the end
            with pytest.raises(ConnectionClosed) as closed:
                websocket.recv(timeout=20)
            # RFC 6455's registry: 1012, the service is restarted
            assert closed.value.rcvd is not None and closed.value.rcvd.code == 1012
        process.wait(20)
    (directory / "key.pem").write_text("no key")
    assert "certificate and key cannot be used" in refused(capsys, directory, *options)


@pytest.mark.parametrize(
    ("address", "link", "secure", "context"),
    [
        (Address(), "http://127.0.0.1:80", False, True),
        (Address("0.0.0.0"), "http://0.0.0.0:80", False, False),
        (Address("::1"), "http://[::1]:80", False, True),
        (Address("lab.example"), "http://lab.example:80", False, False),
        (Address("localhost"), "http://localhost:80", False, True),
        (Address("h", 0, Path("c"), Path("k")), "https://h:80", True, True),
        (Address(public="https://s.example/"), "https://s.example", True, True),
        (Address(public="http://s.example"), "http://s.example", False, False),
    ],
)
def test_addresses(address: Address, link: str, secure: bool, context: bool) -> None:
    # Secure contexts: https://w3c.github.io/webappsec-secure-contexts/#is-origin-trustworthy
    assert address.link(80) == link
    assert address.is_secure is secure
    assert address.is_secure_context is context


def test_a_warning_where_browsers_offer_no_gamepads(directory: Path) -> None:
    with served(directory, "--host", "0.0.0.0") as (_, _, process):
        process.send_signal(signal.SIGTERM)
        _, error = process.communicate(timeout=30)
        assert error.startswith("Warning: participants reach this address without TLS")


def test_differences_are_named() -> None:
    old = {"study": {"a": 1, "b": [1, {"c": 2}], "d": [1]}, "task": {"name": "x"}}
    new = {"study": {"a": 1, "b": [1, {"c": 3}], "d": [1, 2]}, "task": {"name": "y"}, "e": 1}
    assert list(differences(old, new)) == ["e", "b[1].c", "d", "task.name"]
    assert list(differences(old, old)) == []
