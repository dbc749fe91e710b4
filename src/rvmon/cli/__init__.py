"""The command `rvmon`.

The work of a subcommand is in the module of its name; one module per group declares the arguments.

Exit codes: 0 fine, 1 a requirement failed or could not be judged, 2 wrong input or spec,
3 internal error, 130 interrupted (Ctrl-C, SIGTERM), 141 nobody reads the output any more.
"""

from __future__ import annotations

import errno
import gc
import os
import sys
from collections.abc import Callable, Sequence
from functools import partial
from importlib import import_module
from typing import TYPE_CHECKING

from rvmon import __version__
from rvmon.cli.options import at_most
from rvmon.cli.output import rendered, spell, warn
from rvmon.cli.reading import relax, with_values
from rvmon.errors import EXTRAS, DiagnosedError, RvmonError, not_installed
from rvmon.execute import interrupted_by_sigterm

if TYPE_CHECKING:
    import argparse

GROUPS = {
    "write requirements": {
        "look": "show the signals and events of a recording over time",
        "init": "write a first specification, binding or campaign",
        "check": "find errors, warnings and conflicts in specifications",
        "explain": "explain a requirement or a diagnostic code in words",
        "format": "rewrite specifications in the canonical layout",
    },
    "evaluate": {
        "run": "evaluate recordings against a specification",
        "watch": "monitor a running robot: verdicts as they are decided",
        "why": "explain why an attempt passed, failed or stayed open",
        "clip": "cut a recording around an attempt, or make a reproducer",
        "compare": "compare two files of verdicts",
        "cover": "show what tests have covered, and what is missing",
        "evidence": "check an evidence archive",
    },
    "models and export": {
        "verify": "model-check a network of timed automata",
        "conform": "check whether recordings are runs of such a network",
        "export": "write C monitors, automata, or models for UPPAAL",
    },
}
"""The purpose of each command, by group, as listed by `rvmon --help`."""

_ARGUMENTS = {
    "write requirements": "specification_commands",
    "evaluate": "evaluate_commands",
    "models and export": "specification_commands",
}
"""By group, the module that declares the arguments of its commands."""

_MODULES = {
    **{name: _ARGUMENTS[heading] for heading, group in GROUPS.items() for name in group},
    "lsp": "specification_commands",  # started by editors, so the help does not list it
}
"""By command, the module that declares its arguments."""

COMMANDS = tuple(_MODULES)

_WORK_OF = {"format": "check", "init": "look"}
"""The commands whose work is in the module of another command."""


_READER_LEFT = 128 + 13
"""The exit code of a program that SIGPIPE ended: partly read output is no success."""

_MANY = 50_000  # garbage collections start at so many new objects, as imports make no cycles


def program() -> int:
    """Run `main` as the process `rvmon`, tuned for a short life."""
    # NumPy's linear algebra, which is not used, would start a thread per core.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    gc.set_threshold(_MANY)
    code = main()
    gc.freeze()  # skips the final garbage collection: the process ends anyway
    return code


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line, default `sys.argv[1:]`, and return its exit code.

    >>> main(["--version"])
    rvmon 0.1.0, law 3
    0
    """
    words = sys.argv[1:] if arguments is None else list(arguments)
    return guarded(lambda: _parser(words).parse_args(with_values(words)))


def guarded(parsed: Callable[[], argparse.Namespace]) -> int:
    """Run the parsed subcommand; errors become a message and an exit code, never a traceback."""
    _open_closed()
    spell()
    try:
        with interrupted_by_sigterm():
            try:
                namespace = parsed()
            except SystemExit as stop:  # argparse has printed an error or the help
                sys.stdout.flush()
                return stop.code if isinstance(stop.code, int) else 2
            with at_most(getattr(namespace, "most_megabytes", None)):
                code = namespace.run(namespace)
                sys.stdout.flush()
    except RvmonError as error:
        findings = error.diagnostics if isinstance(error, DiagnosedError) else ()
        text = rendered(findings) if findings else str(error)
        headed = text.startswith(("error", "warning"))  # diagnostics have their own heading
        warn(text if headed else f"error: {text}")
        return 2
    except KeyboardInterrupt:
        return _interrupted()
    except (BrokenPipeError, SystemExit):
        # The reader of our output left, as `head` does; rich raises SystemExit when it notices.
        _drop_output()
        return _READER_LEFT
    except Exception as error:
        package = str(getattr(error, "name", "")).partition(".")[0]
        if isinstance(error, ModuleNotFoundError) and package in EXTRAS:
            warn(f"error: {not_installed('this', package)}")
            return 2
        if isinstance(error, OSError) and error.errno == errno.ENOSPC:
            warn(f"error: the output cannot be written: {error.strerror}")
            _drop_output()
            return 2
        if os.environ.get("RVMON_TRACEBACK"):
            raise
        warn(
            f"internal error: {type(error).__name__}: {error}\n"
            "This is a bug in rvmon. RVMON_TRACEBACK=1 shows where it happened."
        )
        return 3
    return int(code)


def _open_closed() -> None:
    """Open `os.devnull` for each standard stream that the caller has closed.

    A newly opened file gets the lowest free descriptor. Otherwise a recording could get that of
    standard error, and libraries would write their warnings into it.
    """
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            stream = open(os.devnull, mode, encoding="utf-8")  # noqa: SIM115 - as long as the process
            setattr(sys, name, stream)


def _drop_output() -> None:
    """Discard unwritten output, about which the interpreter would complain when it ends."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _interrupted() -> int:
    warn("interrupted")
    # If an interrupt passed through an `exec` of text, which dataclasses use, the interpreter
    # remembers it, and `python -m` would end by the signal. Another `exec` clears that.
    exec("")  # noqa: S102 - nothing is run
    return 130


def _parser(words: Sequence[str]) -> argparse.ArgumentParser:
    """The parser with the subcommand that `words` name; without one, with the names of all."""
    import argparse

    from rvmon.cli.parser import Parser
    from rvmon.verdicts import LAW

    listed = [
        line
        for group, commands in GROUPS.items()
        for line in (f"{group}:", *(f"  {name:<9} {text}" for name, text in commands.items()))
    ]
    parser = Parser(
        prog="rvmon",
        usage="rvmon [--version] COMMAND ...",
        description="\n".join(listed),
        epilog="example: rvmon run examples/base.rv examples/base.csv",
        add_help=False,
    )
    hidden = argparse.SUPPRESS
    version = f"rvmon {__version__}, law {LAW}"
    parser.add_argument("-h", "--help", action="help", help=hidden)
    parser.add_argument("--version", action="version", version=version, help=hidden)
    subparsers = parser.add_subparsers(metavar="COMMAND", required=True, help=hidden, prog="rvmon")
    command = next((word for word in words if not word.startswith("-")), "")
    if command not in COMMANDS:
        for name in COMMANDS:
            subparsers.add_parser(name)
        return parser
    getattr(import_module(f"rvmon.cli.{_MODULES[command]}"), f"add_{command}")(subparsers)
    subparsers.choices[command].set_defaults(run=partial(_run, command))
    if command in ("run", "why"):
        relax(subparsers.choices[command], words)
    return parser


def _run(command: str, namespace: argparse.Namespace) -> int:
    """Import the module of a command and run it; the help of the command needs no such import."""
    module = import_module(f"rvmon.cli.{_WORK_OF.get(command, command)}")
    code: int = getattr(module, f"run_{command}")(namespace)
    return code
