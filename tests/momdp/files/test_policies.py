"""Policies in XML and in the compact format."""

from __future__ import annotations

import io
import tempfile
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt.errors import InputError
from coadapt.momdp import AlphaVectorPolicy
from coadapt.momdp.files import read_policy, write_policy

SUFFIXES = (".policy", ".policyx", ".coadapt", ".POLICYX")

POLICY = AlphaVectorPolicy(
    start=np.array([0, 2, 3]),
    vectors=np.array([[1.0, -0.1], [1e-17, 3e300], [0.1 + 0.2, -1 / 3]]),
    actions=np.array([4, 0, 1]),
)


def assert_equal(one: AlphaVectorPolicy, other: AlphaVectorPolicy) -> None:
    for name in ("start", "vectors", "actions"):
        first, second = getattr(one, name), getattr(other, name)
        assert first.dtype == second.dtype
        np.testing.assert_array_equal(first, second)


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_comes_back_exactly(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"policy{suffix}"
    write_policy(POLICY, path)
    assert_equal(POLICY, read_policy(path))
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


@given(st.integers(1, 4), st.integers(1, 4), st.integers(0, 2**32))
def test_any_policy_comes_back(x: int, y: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    start = np.concatenate(([0], np.cumsum(rng.integers(1, 4, size=x))))
    policy = AlphaVectorPolicy(
        start=start,
        vectors=rng.normal(size=(start[-1], y)) * 10.0 ** rng.integers(-9, 9),
        actions=rng.integers(5, size=start[-1]),
    )
    with tempfile.TemporaryDirectory() as directory:
        for suffix in (".policyx", ".coadapt"):
            path = Path(directory) / f"policy{suffix}"
            write_policy(policy, path)
            assert_equal(policy, read_policy(path))


def test_xml_as_text(tmp_path: Path) -> None:
    """A space ends each vector: the reference reads words up to white space."""
    write_policy(POLICY, tmp_path / "a.policy")
    assert (tmp_path / "a.policy").read_text() == (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<Policy version="0.1" type="value" model="problem">\n'
        '<AlphaVector vectorLength="2" numObsValue="2" numVectors="3">\n'
        '<Vector action="4" obsValue="0">1 -0.1 </Vector>\n'
        '<Vector action="0" obsValue="0">1e-17 3e+300 </Vector>\n'
        '<Vector action="1" obsValue="1">0.30000000000000004 -0.3333333333333333 </Vector>\n'
        "</AlphaVector>\n</Policy>\n"
    )


def xml(directory: Path, vectors: str, head: str = "") -> AlphaVectorPolicy:
    head = head or '<AlphaVector vectorLength="3" numObsValue="2" numVectors="2">'
    path = directory / "a.policy"
    path.write_text(f"<Policy type='value'>\n{head}\n{vectors}</AlphaVector>\n</Policy>")
    return read_policy(path)


FIRST = "<Vector action='1' obsValue='1'>1 2 3</Vector>\n"
SECOND = "<Vector action='0' obsValue='0'>4 5 6</Vector>\n"


def test_vectors_in_any_order_and_sparse(tmp_path: Path) -> None:
    policy = xml(
        tmp_path,
        FIRST + "<SparseVector action='2' obsValue='0'><Entry>2 0.5</Entry><Entry> 0 -1 </Entry>"
        "</SparseVector>",
    )
    assert policy.start.tolist() == [0, 1, 2]
    assert policy.actions.tolist() == [2, 1]
    assert policy.vectors.tolist() == [[-1, 0, 0.5], [1, 2, 3]]


@pytest.mark.parametrize(
    ("vectors", "head", "message"),
    [
        (FIRST, "", "2: found 1 vectors, expected numVectors='2'"),
        (FIRST + FIRST, "", "2: found no vector for observed value 0, expected at least one"),
        (FIRST + SECOND.replace("6", ""), "", "4: found 2 numbers, expected 3"),
        (FIRST + SECOND.replace("6", "x"), "", "4: found 'x', expected a number"),
        (FIRST + SECOND.replace("6", "nan"), "", "4: found 'nan', expected a number"),
        (FIRST.replace("obsValue='1'", "obsValue='2'"), "", "3: found obsValue='2', expected a wh"),
        (FIRST.replace("'1'", "'-1'"), "", "3: found obsValue='-1', expected a whole number"),
        (FIRST.replace("action='1'", ""), "", "3: found <Vector> without action, expected action"),
        ("<SparseVector action='1' obsValue='1'><Entry>3 1</Entry></SparseVector>", "",
         "3: found '3 1', expected an index below 3 and a number"),
        (FIRST, '<AlphaVector vectorLength="1000000000" numObsValue="2" numVectors="1">',
         "2: found vectorLength='1000000000', expected a whole number from 1 to 1000000"),
        ("", '<AlphaVector vectorLength="0" numObsValue="1" numVectors="0">',
         "2: found vectorLength='0', expected a whole number from 1 to"),
        (FIRST, '<AlphaVector vectorLength="3">', "2: found <AlphaVector> without numObsValue"),
        ("<Matrix/>", "", "3: found <Matrix> in <AlphaVector>, expected <SparseVector>, <Vector>"),
        ("", '<AlphaVector vectorLength="3" numObsValue="0" numVectors="0">',
         "2: found numObsValue='0', expected a whole number from 1 to"),
    ],
)  # fmt: skip
def test_xml_errors(tmp_path: Path, vectors: str, head: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        xml(tmp_path, vectors, head)
    assert str(caught.value).startswith(f"{tmp_path / 'a.policy'}:{message}")


def test_without_vectors(tmp_path: Path) -> None:
    (tmp_path / "a.policy").write_text("<Policy/>")
    with pytest.raises(InputError, match="found no <AlphaVector>, expected one"):
        read_policy(tmp_path / "a.policy")


def test_reference_policy_has_its_value(tmp_path: Path) -> None:
    """Tiger's policy as the C++ reference solver prints it: 19.3711 at the start belief."""
    (tmp_path / "a.policy").write_text(
        '<?xml version="1.0" encoding="ISO-8859-1"?>\n'
        '<Policy version="0.1" type="value" model="Tiger.pomdpx">\n'
        '<AlphaVector vectorLength="2" numObsValue="1" numVectors="5">\n'
        '<Vector action="1" obsValue="0">-81.5975 28.4025 </Vector>\n'
        '<Vector action="0" obsValue="0">3.01448 24.6954 </Vector>\n'
        '<Vector action="0" obsValue="0">24.6954 3.01452 </Vector>\n'
        '<Vector action="2" obsValue="0">28.4025 -81.5975 </Vector>\n'
        '<Vector action="0" obsValue="0">19.3711 19.3711 </Vector>\n</AlphaVector> </Policy>\n'
    )
    policy = read_policy(tmp_path / "a.policy")
    assert policy.value(0, np.array([0.5, 0.5])) == 19.3711
    assert policy.action(0, np.array([0.5, 0.5])) == 0
    assert policy.action(0, np.array([1.0, 0.0])) == 2


def compact(directory: Path, **arrays: object) -> Path:
    """A compact policy of which some arrays are others, or missing where None."""
    members = {
        "format": np.array([1]),
        "start": POLICY.start,
        "vectors": POLICY.vectors,
        "actions": POLICY.actions,
        **arrays,
    }
    path = directory / "a.coadapt"
    with path.open("wb") as file:
        np.savez(file, **{name: array for name, array in members.items() if array is not None})
    return path


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"format": np.array([2])}, r"found format \[2\], expected version 1"),
        ({"format": np.array([1.0])}, "found format of type float64"),
        ({"start": None}, "found a damaged archive"),
        ({"start": np.array([0, 2, 2, 3])}, "do not fit together"),
        ({"start": np.array([0, 3, 2, 3])}, "do not fit together"),
        ({"start": np.array([0])}, "do not fit together"),
        ({"start": np.array([0, 2, 4])}, "do not fit together"),
        ({"actions": np.array([0, 1])}, "do not fit together"),
        ({"actions": np.array([0, 1, -1])}, "out of range"),
        ({"vectors": np.full((3, 2), np.nan)}, "out of range"),
        ({"vectors": np.zeros((3, 0))}, "do not fit together"),
        ({"vectors": np.zeros(3)}, r"found vectors of type float64 and shape '\(3,\)'"),
        ({"vectors": np.array([[object()]])}, "found vectors of type object"),
        ({"vectors": np.asfortranarray(np.zeros((3, 2)))}, "found vectors of type"),
    ],
)
def test_compact_errors(tmp_path: Path, arrays: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        read_policy(compact(tmp_path, **arrays))


@pytest.mark.parametrize(
    ("rows", "message"),
    [(10**9, "expected at most 40,000,000 numbers"), (1000, "cut short"), (2, "many")],
)
def test_a_header_that_promises_too_much_or_too_little(
    tmp_path: Path, rows: int, message: str
) -> None:
    """The array's header declares so many rows of two; the archive holds three."""
    path = compact(tmp_path, vectors=None)
    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        header, {"descr": "<f8", "fortran_order": False, "shape": (rows, 2)}
    )
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr("vectors.npy", header.getvalue() + bytes(3 * 2 * 8))
    with pytest.raises(InputError, match=message):
        read_policy(path)


@pytest.mark.parametrize(
    "header",
    [
        "(" * 3900,
        "-" * 3900 + "1",
        "{" * 200,
        "\0",
        "",
        '"""',
        " \n  x\n y",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (True, 1)}",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (-1, -1)}",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (1, " + "1" * 3900 + ")}",
        "{'descr': [('a', '<f8')], 'fortran_order': False, 'shape': (1, 1)}",
    ],
)
def test_headers_made_to_do_harm(tmp_path: Path, header: str) -> None:
    path = compact(tmp_path, vectors=None)
    size = len(header).to_bytes(2, "little")
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr("vectors.npy", b"\x93NUMPY\x01\x00" + size + header.encode() + bytes(8))
    with pytest.raises(InputError) as caught:
        read_policy(path)
    assert len(str(caught.value)) < 400


def test_names_of_members_that_are_no_text(tmp_path: Path) -> None:
    data = bytearray(compact(tmp_path).read_bytes().replace(b"start.npy", b"st\xff\xfet.npy"))
    at = data.index(b"PK\x01\x02", data.index(b"PK\x01\x02") + 1)  # the second of the directory
    data[at + 9] |= 8  # its name is said to be UTF-8
    (tmp_path / "b.coadapt").write_bytes(data)
    with pytest.raises(InputError, match="damaged archive"):
        read_policy(tmp_path / "b.coadapt")


def test_no_pickles(tmp_path: Path) -> None:
    class Bomb:
        def __reduce__(self) -> object:
            return (pytest.fail, ("unpickled",))

    with pytest.raises(InputError):
        read_policy(compact(tmp_path, vectors=np.array([[Bomb()]], dtype=object)))


def test_truncated_compact_files(tmp_path: Path) -> None:
    write_policy(POLICY, tmp_path / "a.coadapt")
    data = (tmp_path / "a.coadapt").read_bytes()
    for size in range(len(data)):
        (tmp_path / "b.coadapt").write_bytes(data[:size])
        with pytest.raises(InputError):
            read_policy(tmp_path / "b.coadapt")


def test_suffixes(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"ends in '\.npz', expected \.policy, \.policyx or"):
        write_policy(POLICY, tmp_path / "a.npz")
    with pytest.raises(InputError, match="cannot be read"):
        read_policy(tmp_path / "a.policy")
    assert list(tmp_path.iterdir()) == []
