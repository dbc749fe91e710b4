"""Command line and tables of a benchmark.

Commands are functions, and their parameters are the options. Tables are Markdown, for terminals and
documents alike.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable, Iterator, Sequence
from inspect import Parameter, signature
from types import NoneType
from typing import Any, TypeVar, get_args, get_origin

T = TypeVar("T")


def program(
    about: str | None, *commands: Callable[..., int | None], argv: Sequence[str] | None = None
) -> int:
    """Run the command that the first word names; a single command needs no name.

    A keyword-only parameter is an option of its annotation's type: `bool` is a flag, a sequence
    takes several words, restricted to those of its default unless that is empty. Other parameters
    are positional arguments. A trailing underscore is not part of the name.

    Args:
        about: the description, usually the docstring of the benchmark.
        commands: functions that return the exit code; `None` means 0.
        argv: the arguments; default: those of the process.
    """
    form = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=about, formatter_class=form)
    if len(commands) == 1:
        _add(parser, commands[0])
    else:
        kinds = parser.add_subparsers(required=True, metavar="COMMAND")
        for command in commands:
            _add(kinds.add_parser(command.__name__, help=command.__doc__), command)
    options = vars(parser.parse_args(argv))
    run = options.pop("run")
    return run(**options) or 0


def _add(parser: argparse.ArgumentParser, command: Callable[..., int | None]) -> None:
    parser.set_defaults(run=command)
    for name, one in signature(command, eval_str=True).parameters.items():
        is_option = one.kind is Parameter.KEYWORD_ONLY
        words: dict[str, Any] = {}
        if one.default is not Parameter.empty:
            words["default"] = one.default
            words["help"] = f"default: {one.default}" if one.default else None
        kind = one.annotation
        kind = get_args(kind)[0] if NoneType in get_args(kind) else kind
        if get_origin(kind) is Sequence:
            [kind] = get_args(kind)
            words["nargs"] = "+" if words.get("default", True) else "*"
            words["choices"] = words.get("default") or None
        word = name.strip("_")
        valued = {"type": kind, "metavar": word.upper()}
        words |= {"action": "store_true"} if kind is bool else valued
        words |= {"dest": name} if is_option else {}
        parser.add_argument(f"--{word.replace('_', '-')}" if is_option else name, **words)


def in_turn(contenders: Sequence[T], repeats: int) -> Iterator[tuple[int, T]]:
    """Yield all in `repeats` passes, each from another start: slow phases then affect all alike."""
    for number in range(repeats):
        first = number % max(len(contenders), 1)
        yield from ((number, one) for one in (*contenders[first:], *contenders[:first]))


def table(head: Sequence[str], rows: Iterable[Iterable[object]]) -> Iterator[str]:
    r"""The lines of a table, each as soon as its row is known.

    >>> [*table(["a", "b"], [["1|2", 2.5]])]
    ['| a | b |', '|---|---|', '| 1\\|2 | 2.5 |']
    """
    yield f"| {' | '.join(head)} |"
    yield "|---" * len(head) + "|"
    for row in rows:
        cells = (str(cell).replace("|", r"\|") for cell in row)
        yield f"| {' | '.join(cells)} |"
