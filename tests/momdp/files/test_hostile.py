"""Files made to do harm: refused soon, in little memory, with one line."""

from __future__ import annotations

import io
import json
import random
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coadapt.errors import InputError
from coadapt.momdp import check_momdp
from coadapt.momdp.files import read_policy, read_pomdp, write_policy
from tests.momdp.files import limited
from tests.momdp.files.test_cassandra import BODY, HEAD
from tests.momdp.files.test_cassandra_errors import HEAD as TWO
from tests.momdp.files.test_policies import POLICY
from tests.momdp.files.test_pomdpx import DIAGRAM, VARIABLES, document, table
from tests.momdp.files.test_pomdpx_errors import TEXT, entry

linux = pytest.mark.skipif(sys.platform != "linux", reason="limits a process's memory")

MEMORY = 1 << 30

LAUGHS = "".join(
    f'<!ENTITY l{i} "{f"&l{i - 1};" * 10 if i else "ha"}">' for i in range(12)
)  # fmt: skip


def pomdpx(*, y: int = 2, x_values: int = 2, entries: str = "", **parts: str) -> str:
    """A file with many states of which the tables say little."""
    text = TEXT.replace('vnameCurr="yy"><NumValues>2<', f'vnameCurr="yy"><NumValues>{y}<').replace(
        "<ValueEnum>u v</ValueEnum>", f"<NumValues>{x_values}</NumValues>"
    )
    text = text.replace("<ProbTable>0.5 0.5</ProbTable>", "<ProbTable>uniform</ProbTable>")
    for old, new in parts.items():
        assert old in text
        text = text.replace(old, new)
    return text.replace(entry("* * - -", "identity"), entries or entry("* * - -", "identity"))


def declaring(kind: str, sizes: list[int], more: str = "") -> str:
    """A file with more variables of one kind, with so many values."""
    variables = "".join(
        f"<{kind} vname='b{i}'><NumValues>{size}</NumValues></{kind}>"
        for i, size in enumerate(sizes)
    )
    return document(variables=VARIABLES.replace("</Variable>", f"{more}{variables}</Variable>"))


def cassandra(states: int, actions: int, seen: int, entries: str) -> str:
    return f"discount: 0.5\nstates: {states}\nactions: {actions}\nobservations: {seen}\n{entries}\n"


def dense(states: int) -> str:
    return f"T: * uniform\nO: * uniform\nstart: {'0 ' * states}"


def archive(start: int, count: int) -> bytes:
    """A compact policy of zeros: numbers of ``start``, and of ``vectors`` of length 1."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as members:
        for name, shape, kind in (
            ("format", 1, "<i8"), ("start", start, "<i8"), ("vectors", (count, 1), "<f8"),
            ("actions", count, "<i8"),
        ):  # fmt: skip
            numbers = np.zeros(shape, dtype=kind)
            if name == "format":
                numbers[:] = 1
            elif name == "start":
                numbers[-1] = count
            with members.open(f"{name}.npy", "w") as member:
                np.lib.format.write_array(member, numbers)
    return file.getvalue()


# Name, contents, and a part of the message; None where the file is fine.
FILES: dict[str, tuple[str | bytes, str | None]] = {
    "laughs.pomdpx": (f"<!DOCTYPE pomdpx [{LAUGHS}]><pomdpx>&l11;</pomdpx>", "document type"),
    "laughs.policy": (f"<!DOCTYPE Policy [{LAUGHS}]><Policy>&l11;</Policy>", "document type"),
    "external.pomdpx": (
        '<!DOCTYPE pomdpx [<!ENTITY e SYSTEM "file:///etc/passwd">]><pomdpx>&e;</pomdpx>',
        "document type",
    ),
    "dtd.pomdpx": ('<!DOCTYPE pomdpx SYSTEM "http://127.0.0.1:9/a.dtd"><pomdpx/>', "document"),
    "parameter.pomdpx": ('<!DOCTYPE p [<!ENTITY % a "<!ENTITY b \'c\'>">%a;]><p/>', "document"),
    "entity.pomdpx": ("<pomdpx><Description>&who;</Description></pomdpx>", "undefined entity"),
    "billion.pomdp": (cassandra(10**9, 1, 1, ""), "found 1000000000 states"),
    "billion.pomdpx": (pomdpx(y=10**9), "found 1000000000 values"),
    "million.pomdp": (cassandra(10**6, 1, 1, "T: * identity\nO: * uniform"), None),
    "million_uniform.pomdp": (cassandra(10**6, 1, 1, "T: * uniform\nO: * uniform"), "expected"),
    "million_matrix.pomdp": (cassandra(10**6, 1, 1, "T: *\n1 0 0"), "x"),
    "uniform.pomdp": (cassandra(3000, 5, 1, "T: * uniform\nO: * uniform"), None),
    "uniform_all.pomdp": (cassandra(3500, 5, 5, "T: * uniform\nO: * uniform"), "expected at most"),
    "wild_rows.pomdp": (
        cassandra(50_000, 20, 1, "T: * : * : 7 1\nO: * uniform\n" + "T: * : * : 8 0\n" * 2000),
        "expected fewer",
    ),
    "wild_cells.pomdp": (
        cassandra(40_000, 1, 1, "".join(f"T: * : * : {i} 1e-5\n" for i in range(5000))),
        "expected",
    ),
    "observed_rewards.pomdp": (
        cassandra(
            2000, 1, 2000,
            "T: * uniform\nO: * uniform\n" + "".join(f"R: * : * : * : {i} 1\n" for i in range(9)),
        ),
        "expected at most",
    ),
    "huge_rewards.pomdp": (TWO + BODY.replace("swap", "1").replace("stay", "0")
                           + "R: * : * : * : * 1e308\nR: * : * : 0 : * 1e999\n", "expected"),
    "x.pomdpx": (pomdpx(x_values=900_000), "actions x observed states, expected at most"),
    "x_many.pomdpx": (pomdpx(x_values=200_000), None),
    "y_many.pomdpx": (pomdpx(y=500_000), None),
    "xy.pomdpx": (pomdpx(x_values=5000, y=5000), "observed states x actions x hidden states"),
    "y_uniform.pomdpx": (pomdpx(y=20_000, entries=entry("* * - -", "uniform")), "expected"),
    "y_wild.pomdpx": (
        pomdpx(y=5000, entries="".join(
            entry(f"* * s{i} *", f"{1 / 5000!r}") for i in range(5000))),
        "expected at most",
    ),
    "x_uniform.pomdpx": (
        pomdpx(x_values=5000).replace(entry("* - -", "identity"), entry("* - -", "uniform")),
        "expected",
    ),
    "many_values.pomdpx": (declaring("ActionVar", [10**6] * 900), "actions, expected at most"),
    "one_value_often.pomdpx": (
        declaring("ObsVar", [500_000] + [1] * 900), "characters in the names of the observations",
    ),
    "long_names.pomdpx": (
        declaring("ObsVar", [100_000], f"<ObsVar vname='p'><ValueEnum>{'z' * 99_999}</ValueEnum>"
                  "</ObsVar>"),
        "characters in the names of the observations",
    ),
    "many_nodes.pomdpx": (
        document(gain="<Func><Var>gain</Var><Parameter type='DD'><DAG><Node var='act'>"
                 + "<Edge val='a'/>" * 300_000),
        "elements of decision diagrams",
    ),
    "long_number.pomdp": (
        cassandra(1, 1, 1, f"start: {'0' * 5000}\nT: * identity\nO: * uniform"), "a state",
    ),
    "long_discount.pomdp": (f"discount: 1.{'0' * 10**6}", "expected at least 0 and below 1"),
    "long_discount.pomdpx": (
        f"<pomdpx><Discount>1.{'0' * 10**6}</Discount></pomdpx>", "expected at least 0 and below 1",
    ),
    "long_line.pomdp": (cassandra(2, 1, 1, f"T: * {'11 ' * 9_000_000}"), "found 11, expected"),
    "long_table.pomdpx": (
        TEXT.replace("0.5 0.5", "1 " * 12_000_000), "found 12000000 numbers, expected 2",
    ),
    "long_vector.policy": (
        '<Policy><AlphaVector vectorLength="2" numObsValue="1" numVectors="1">'
        f"<Vector action='0' obsValue='0'>{'1 ' * 12_000_000}</Vector></AlphaVector></Policy>",
        "found 12000000 numbers, expected 2",
    ),
    "bomb.coadapt": (archive(2 * 10**7, 4 * 10**7), "expected at most 1,000,001 numbers"),
    "large.coadapt": (archive(2, 4 * 10**7), None),
    "deep.pomdpx": ("<pomdpx><Description>" + "<a>" * 100_000, "nested 200 deep"),
    "deep_nodes.pomdpx": (
        document(rock=DIAGRAM.split("<DAG>")[0] + "<DAG>"
                 + "<Node var='act'><Edge val='go'>" * 50_000),
        "nested 200 deep",
    ),
    "long_attribute.pomdpx": (f"<pomdpx id='{'z' * 30_000_000}'>", "malformed"),
    "long_text.pomdpx": (f"<pomdpx><Discount>{'9' * 30_000_000}</Discount>", "found '9999"),
    "long_name.pomdpx": (f"<{'z' * 30_000_000}>", "found <zzzz"),
    "long_word.pomdp": (f"discount: {'9' * 30_000_000}", "found '9999"),
    "many_names.pomdp": ("states: " + "".join(f"n{i} " for i in range(1_100_000)), "at most"),
    "many_variables.pomdpx": (
        "<pomdpx><Variable>" + "".join(
            f"<RewardVar vname='r{i}'/>" for i in range(100_000)), "more than 1000 variables"),
    "templates.pomdpx": (
        # Each template leads to the next by both of its edges: 2^60 paths.
        document(
            gain="<Func><Var>gain</Var><Parent>act</Parent><Parameter type='DD'>"
            "<DAG><SubDAG type='template' idref='t0'/></DAG>" + "".join(
                f"<SubDAGTemplate id='t{i}'><SubDAG type='template' idref='t{i + 1}'/>"
                "</SubDAGTemplate>" for i in range(60)
            ) + "<SubDAGTemplate id='t60'><SubDAG type='template' idref='t0'/></SubDAGTemplate>"
            "</Parameter></Func>"
        ),
        "does not lead back to itself",
    ),
    "branching_templates.pomdpx": (
        # Sixty binary variables, each branched on by the next template: 2^60 paths.
        document(
            variables=VARIABLES.replace("</Variable>", "".join(
                f"<ActionVar vname='b{i}'><NumValues>1</NumValues></ActionVar>" for i in range(60)
            ) + "</Variable>"),
            gain=f"<Func><Var>gain</Var><Parent>{' '.join(f'b{i}' for i in range(60))} act</Parent>"
            "<Parameter type='DD'><DAG><SubDAG type='template' idref='t0'/></DAG>" + "".join(
                f"<SubDAGTemplate id='t{i}'><Node var='b{i}'><Edge val='a0'>"
                f"<SubDAG type='template' idref='t{i + 1}'/></Edge></Node></SubDAGTemplate>"
                for i in range(60)
            ) + "<SubDAGTemplate id='t60'><Node var='act'><Edge val='go'><Terminal>1</Terminal>"
            "</Edge></Node></SubDAGTemplate></Parameter></Func>",
        ),
        None,
    ),
    "sparse.policy": (
        '<Policy><AlphaVector vectorLength="1000000" numObsValue="1" numVectors="9999">'
        + "<SparseVector action='0' obsValue='0'/>" * 9999,
        "numbers in all vectors",
    ),
    "observed_values.policy": (
        '<Policy><AlphaVector vectorLength="1" numObsValue="1000000" numVectors="0">'
        "</AlphaVector></Policy>",
        "found no vector",
    ),
    "encoding.pomdpx": (b"<?xml version='1.0' encoding='utf-7'?><pomdpx/>", "encoding"),
    "no_encoding.pomdpx": (b"<?xml version='1.0' encoding='none'?><pomdpx/>", "encoding"),
    "zeros.pomdpx": (b"\0" * 5_000_000, "malformed"),
    "zeros.pomdp": (b"\0" * 5_000_000, "found '"),
    "garbage.pomdp": (random.Random(0).randbytes(1_000_000), "found"),
    "garbage.pomdpx": (random.Random(1).randbytes(1_000_000), "malformed"),
    "garbage.policy": (random.Random(2).randbytes(1_000_000), "malformed"),
    "garbage.coadapt": (random.Random(3).randbytes(1_000_000), "damaged"),
    "many_parents.pomdpx": (
        document(cost=table("cost", " ".join(["act"] * 100), " = 1", reward=True)),
        "expected a variable, once",
    ),
}  # fmt: skip


@linux
def test_refused_soon_and_in_little_memory(tmp_path: Path) -> None:
    names = []
    for name, (text, _) in FILES.items():
        (tmp_path / name).write_bytes(text if isinstance(text, bytes) else text.encode())
        names.append(str(tmp_path / name))
    done = subprocess.run(
        [sys.executable, limited.__file__, str(MEMORY), *names],
        capture_output=True,
        text=True,
        timeout=300,  # of all together; `benchmarks/fuzz_files.py` measures each
        check=False,
    )
    results = [json.loads(line) for line in done.stdout.splitlines()]
    assert done.returncode == 0, (FILES.keys() - {name for name, _ in results}, done.stderr)
    for name, message in results:
        expected = FILES[name][1]
        if expected is None:
            assert message is None, (name, message)
        else:
            assert message is not None, name
            assert expected in message, (name, message)
            assert "\n" not in message
            assert len(message.replace(str(tmp_path), "")) < 400


@pytest.mark.parametrize(
    ("text", "suffix"),
    [(HEAD + BODY, ".pomdp"), (TEXT, ".pomdpx"), (document(rock=DIAGRAM), ".pomdpx")],
)
@pytest.mark.filterwarnings("ignore::coadapt.momdp.MOMDPWarning")  # some x may not be reachable
def test_cut_short_at_every_byte(tmp_path: Path, text: str, suffix: str) -> None:
    """An error, or for `.pomdp` at times a shorter problem; never anything else."""
    path = tmp_path / f"problem{suffix}"
    data = text.encode()
    read = 0
    for size in range(len(data)):
        path.write_bytes(data[:size])
        try:
            check_momdp(read_pomdp(path))
            read += 1
        except InputError as error:
            assert str(error).startswith(str(path))
    # XML says where it ends, up to white space; a `.pomdp` file does not.
    assert read <= 2 if suffix == ".pomdpx" else read < 20


SEEDS = [
    (TWO + BODY.replace("stay", "0").replace("swap", "1") + "R: * : 0 : 1 : * 2.5\n", ".pomdp"),
    (HEAD + "start include: left\n" + BODY + "R: stay : left\n1 2 3 4 5 6\n", ".pomdp"),
    (TEXT, ".pomdpx"),
    (document(rock=DIAGRAM), ".pomdpx"),
]
WORDS = [
    "*", "-", ":", "#", "T:", "0", "1", "-1", "nan", "1e309", "0.5", "identity", "uniform",
    "reset", "start:", "999999", "3000", "<Entry>", "</Entry>", "&amp;", "<DAG>", "null", "s0",
    "left", "\x00", "é", "\n", " ",
]  # fmt: skip


@pytest.mark.filterwarnings("ignore::coadapt.momdp.MOMDPWarning")  # some x may not be reachable
@given(
    st.sampled_from(SEEDS),
    st.lists(
        st.tuples(st.integers(0, 4000), st.integers(0, 60), st.sampled_from(WORDS)),
        min_size=1,
        max_size=4,
    ),
)
def test_mutations_give_a_problem_or_an_error(
    seed: tuple[str, str], changes: list[tuple[int, int, str]]
) -> None:
    text, suffix = seed
    for at, length, word in changes:
        place = at % len(text)
        text = text[:place] + word + text[place + length :]
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory) / f"problem{suffix}"
        path.write_text(text)
        try:
            problem = read_pomdp(path)
        except InputError as error:
            assert "\n" not in str(error)
        else:
            check_momdp(problem)


def test_bits_of_a_compact_policy(tmp_path: Path) -> None:
    write_policy(POLICY, tmp_path / "a.coadapt")
    data = bytearray((tmp_path / "a.coadapt").read_bytes())
    for i in range(0, len(data) * 8, 5):
        data[i // 8] ^= 1 << i % 8
        (tmp_path / "b.coadapt").write_bytes(data)
        data[i // 8] ^= 1 << i % 8
        try:
            read_policy(tmp_path / "b.coadapt")
        except InputError as error:
            assert "\n" not in str(error)


@pytest.mark.parametrize(
    "path", sorted((Path(__file__).parent / "seeds").iterdir()), ids=lambda path: path.name
)
def test_seeds_of_the_fuzzer_are_read(path: Path) -> None:
    (read_pomdp if "pomdp" in path.suffix else read_policy)(path)
