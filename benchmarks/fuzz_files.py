"""Reads mutated files: each must give a problem or an error, soon and in little memory.

    python benchmarks/fuzz_files.py --count 100000 FILE...

Seeds are the given files (`.pomdp`, `.pomdpx`, `.policyx`, `.coadapt`) of at most ``--largest``
bytes; each format is as frequent as the others. What is read must also pass `check_momdp`. Every
mutation is read in a child process whose memory is limited; a child reads a batch, and the parent
notices if it dies or takes too long. Prints the number of problems and errors for each format and
exits with 1 if anything else happened. What failed is kept in ``--keep``.
"""

from __future__ import annotations

import argparse
import random
import resource
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

SECONDS = 5.0
"""Longest time that reading one file may take, of the processor; a child that does nothing is ended
some time after."""

BYTES = 1 << 30
"""Memory that a child may map beyond what it has mapped after importing the readers."""

BATCH = 500
"""Mutations read by one child."""

LISTED = 20
"""Failures that are printed."""

PROBLEMS = (".pomdp", ".pomdpx")
"""Suffixes of problem files; the others are policies."""

TOKENS = [
    b"*", b"-", b":", b"#", b"T", b"O", b"R", b"T:", b"O:", b"R:", b"identity", b"uniform",
    b"reset", b"start:", b"start include:", b"start exclude:", b"states:", b"discount:",
    b"0", b"1", b"-1", b"1e308", b"1e-320", b"nan", b"inf", b"1_0", b"0.5", b".5", b"1000000000",
    b"99999", b"100000", b"3000", b"700", b"18446744073709551616", b"<Entry>", b"</Entry>",
    b"<Instance>", b"<DAG>", b"<Node var=\"a\">", b"&amp;", b"&#0;", b"<![CDATA[", b"<!--", b"]]>",
    b"<!DOCTYPE a>", b"<NumValues>3000</NumValues>", b"<NumValues>1000000000</NumValues>",
    b"\xff", b"\x00", b"\n", b"\xef\xbb\xbf", b"encoding='utf-16'", b"type=\"DD\"",
    b"fullyObs=\"true\"", b"null",
]  # fmt: skip
"""Words that mean something in one of the formats."""


def mutated(data: bytes, rng: random.Random) -> bytes:
    """``data`` with one to a few changes of one to many bytes, words or lines."""
    for _ in range(rng.choice((1, 1, 1, 2, 3, 8))):
        size = len(data)
        at = rng.randrange(size + 1)
        end = min(size, at + rng.choice((1, 2, 5, 20, 100, 1000)))
        kind = rng.randrange(9)
        if kind == 0:
            data = data[:at] + bytes([rng.randrange(256)]) + data[at + 1 :]
        elif kind == 1:
            data = data[:at] + data[end:]
        elif kind == 2:
            data = data[:at]
        elif kind == 3:
            to = rng.randrange(size + 1)
            data = data[:to] + data[at:end] + data[to:]
        elif kind == 4:
            data = data[:at] + b" " + rng.choice(TOKENS) + b" " + data[at:]
        elif kind in (5, 6):
            words = data.split(b" ")
            words[rng.randrange(len(words))] = rng.choice((*TOKENS, rng.choice(words)))
            data = b" ".join(words)
        elif kind == 7:
            lines = data.split(b"\n")
            i, j = rng.randrange(len(lines)), rng.randrange(len(lines))
            lines[i], lines[j] = lines[j], lines[i]
            data = b"\n".join(lines)
        else:
            numbers = [i for i, c in enumerate(data[at:end]) if 48 <= c <= 57]
            if numbers:
                i = at + rng.choice(numbers)
                data = data[:i] + rng.choice((b"9", b"0", b"99999", b"-", b"e9")) + data[i + 1 :]
    return data


def child(directory: Path, names: list[str]) -> None:
    """Read files and print for each its name, what came of it and the seconds taken."""
    import warnings

    from coadapt.errors import InputError
    from coadapt.momdp import MOMDP, check_momdp
    from coadapt.momdp.check import MOMDPWarning
    from coadapt.momdp.files import read_policy, read_pomdp

    warnings.simplefilter("ignore", MOMDPWarning)
    mapped = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (mapped + BYTES, mapped + BYTES))
    for name in names:
        path = directory / name
        start = time.process_time()
        try:
            problem = read_pomdp(path) if path.suffix in PROBLEMS else read_policy(path)
            seconds = time.process_time() - start
            outcome = "model"
        except InputError as error:
            problem, seconds = None, time.process_time() - start
            outcome = "error" if "\n" not in str(error) else "error of several lines"
        except Exception as error:
            problem, seconds = None, time.process_time() - start
            outcome = f"{type(error).__name__}: {error}".replace("\n", " ")[:200]
        try:
            if isinstance(problem, MOMDP):
                check_momdp(problem)
        except Exception as error:
            outcome = f"read, but {type(error).__name__}: {error}".replace("\n", " ")[:200]
        print(f"{name}\t{seconds:.3f}\t{outcome}", flush=True)


def run_batch(
    directory: Path, files: dict[str, bytes], outcomes: Counter[str], failures: list[str]
) -> float:
    """Read ``files`` in a child; the longest time one of them took."""
    for name, data in files.items():
        (directory / name).write_bytes(data)
    waiting, slowest = list(files), 0.0
    while waiting:
        command = [sys.executable, __file__, "--child", str(directory), *waiting]
        limit = SECONDS * 4 + 0.5 * len(waiting)
        try:
            done = subprocess.run(
                command, check=False, capture_output=True, text=True, timeout=limit
            )
            output, died = done.stdout, done.returncode != 0
            reason = f"exit code {done.returncode} {done.stderr[-300:]!r}"
        except subprocess.TimeoutExpired as late:
            output, died, reason = (late.stdout or b"").decode(), True, "no answer"
        lines = [line.split("\t") for line in output.splitlines() if line.count("\t") == 2]
        for name, seconds, outcome in lines:
            slowest = max(slowest, float(seconds))
            suffix = Path(name).suffix
            good = outcome in ("model", "error") and float(seconds) <= SECONDS
            outcomes[f"{suffix} {outcome if good else 'FAILED'}"] += 1
            if not good:
                failures.append(f"{name} {seconds} s: {outcome}")
        waiting = waiting[len(lines) :]
        if died and waiting:
            outcomes[f"{Path(waiting[0]).suffix} FAILED"] += 1
            failures.append(f"{waiting[0]}: {reason}")
            waiting = waiting[1:]
    return slowest


def main() -> int:
    """Fuzz the readers; the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("seeds", nargs="*", type=Path)
    parser.add_argument("--count", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--largest", type=int, default=50_000)
    parser.add_argument("--keep", type=Path, default=Path("fuzz-failures"))
    options = parser.parse_args()
    seeds = [(p, p.read_bytes()) for p in options.seeds]
    seeds = [(p, data) for p, data in seeds if 0 < len(data) <= options.largest]
    formats = sorted({p.suffix for p, _ in seeds})
    if not seeds:
        parser.error("no seed file is small enough")
    rng = random.Random(options.seed)
    outcomes: Counter[str] = Counter()
    slowest, done = 0.0, 0
    with tempfile.TemporaryDirectory() as name:
        directory = Path(name)
        while done < options.count:
            files: dict[str, bytes] = {}
            for i in range(min(BATCH, options.count - done)):
                suffix = rng.choice(formats)
                path, data = rng.choice([seed for seed in seeds if seed[0].suffix == suffix])
                files[f"{done + i}{path.suffix}"] = mutated(data, rng)
            failures: list[str] = []
            slowest = max(slowest, run_batch(directory, files, outcomes, failures))
            for failure in failures:
                file = failure.replace(":", " ").split()[0]
                options.keep.mkdir(parents=True, exist_ok=True)
                (options.keep / file).write_bytes(files[file])
                if outcomes.total() < LISTED or len(failures) < LISTED:
                    print(failure, file=sys.stderr)
            for file in files:
                (directory / file).unlink()
            done += len(files)
            print(f"\r{done} {dict(outcomes)} slowest {slowest:.2f} s", end="", file=sys.stderr)
    print(file=sys.stderr)
    print(f"{done} mutations, slowest {slowest:.2f} s")
    for outcome, count in sorted(outcomes.items()):
        print(f"{count:8d} {outcome}")
    return int(any(outcome.endswith("FAILED") for outcome in outcomes))


if __name__ == "__main__":
    if sys.argv[1:2] == ["--child"]:
        child(Path(sys.argv[2]), sys.argv[3:])
    else:
        sys.exit(main())
