"""The command line. Each command lives in a module of its own, imported only when it is used."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from io import TextIOWrapper

import click

from coadapt import __version__
from coadapt.cli.lazy import LazyGroup
from coadapt.errors import InputError, printable

COMMANDS = {
    "analyse": "Analyse the data of a study: statistics, figures, report.",
    "evaluate": "Evaluate a policy by simulation and exactly.",
    "fit": "Adaptability of people and populations, from logs.",
    "partners": "List the kinds of simulated people.",
    "play": "Steer the robot with the arrow keys, in this terminal.",
    "power": "How many participants a study needs, from simulated experiments.",
    "replay": "Run a recorded log of human inputs through a robot.",
    "reproduce": "Write the report of the published results, or of a task.",
    "robustness": "Measure what a robot loses with people who break its model.",
    "simulate": "Run a robot with simulated people.",
    "solve": "Plan for a problem: a policy with certified bounds.",
    "study": "Studies that people take part in.",
    "sweep": "Run a grid of simulations, on this machine or a cluster.",
    "tasks": "List the tasks, or show one.",
}
"""Every command with its one-line summary; ``coadapt.cli.NAME`` holds it as ``command``."""

INPUT_ERROR = 2
INTERRUPTED = 128 + 2  # as if ended by SIGINT
BROKEN_PIPE = 128 + 13  # as if ended by SIGPIPE


@click.group(
    cls=LazyGroup,
    package="coadapt.cli",
    summaries=COMMANDS,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)
@click.version_option(__version__, message="coadapt %(version)s")
@click.pass_context
def program(ctx: click.Context) -> None:
    """Human-robot mutual adaptation in shared autonomy."""
    if ctx.invoked_subcommand is None:
        click.echo(ctx.get_help())


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Args:
        arguments: what follows the program's name; by default this process's arguments.

    Returns:
        The exit code: 0, or 1 if what was asked for is not so, 2 after an error in what the user
        gave, 130 after an interrupt.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            # What the terminal cannot show must not end the program.
            stream.reconfigure(errors="backslashreplace")
    try:
        code = _run(sys.argv[1:] if arguments is None else list(arguments))
        sys.stdout.flush()
    except click.ClickException as error:
        return _refuse(_in_one_line(error))
    except InputError as error:
        return _refuse(str(error))
    except (click.Abort, KeyboardInterrupt):
        return INTERRUPTED
    except BrokenPipeError:
        # The reader has gone. What is still buffered must not fail again at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE
    except OSError as error:
        place = "" if error.filename is None else f"{error.filename}: "
        return _refuse(f"{place}{error.strerror or error}")
    return code


def _run(arguments: list[str]) -> int:
    if "_COADAPT_COMPLETE" in os.environ:  # the shell asks for completions
        program.main(arguments, prog_name="coadapt")
    # Not `program.main`: it has its own ideas of exit codes after an interrupt or a broken pipe.
    try:
        with program.make_context("coadapt", arguments) as context:
            code: object = program.invoke(context)
    except click.exceptions.Exit as end:
        return end.exit_code
    return code if isinstance(code, int) else 0


def _in_one_line(error: click.ClickException) -> str:
    message = " ".join(error.format_message().split())
    if isinstance(error, click.UsageError) and error.ctx is not None:
        return f"{message.removesuffix('.')}; see {error.ctx.command_path} --help"
    return message


def _refuse(message: str) -> int:
    click.echo(f"coadapt: error: {printable(message)}", err=True)
    return INPUT_ERROR
