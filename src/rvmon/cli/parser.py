"""The command-line parser, and the types of numbers and times on the command line."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any, NoReturn, TypeAlias

from rvmon.errors import TraceError
from rvmon.execute import Shard
from rvmon.texts import did_you_mean, escaped
from rvmon.trace.time import TICKS_PER_SECOND, TICKS_PER_UNIT, ticks_of_text

Subparsers: TypeAlias = "argparse._SubParsersAction[Parser]"  # the commands of a program

_CHOICE = re.compile(r"invalid choice: '(.*)' \(choose from (.*)\)", re.DOTALL)


class _Help(argparse.HelpFormatter):
    """Keeps the lines of lists, and puts each example on its own line, to be copied."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        if "\n" in text:
            return text
        heading, sign, commands = text.partition(": ")
        if heading not in ("example", "examples"):
            return super()._fill_text(text, width, indent)
        return "\n".join(
            [f"{heading}{sign.rstrip()}", *(f"  {one}" for one in commands.split("; "))]
        )


class Parser(argparse.ArgumentParser):
    """A parser with short error messages that name the fix and contain no terminal escapes."""

    def __init__(self, **options: Any) -> None:
        super().__init__(formatter_class=_Help, **options)

    def parse_known_args(  # type: ignore[override]  # of its overloads one is what is called
        self, args: Sequence[str] | None = None, namespace: Any = None
    ) -> Any:
        """Parse as argparse does, but let the subcommand report arguments that it does not know."""
        parsed, rest = super().parse_known_args(args, namespace)
        if rest:
            meant = did_you_mean(rest[0].partition("=")[0], self._option_string_actions)
            self.error(f"unrecognized arguments: {' '.join(rest)}{meant and f': {meant}'}")
        return parsed, rest

    def option(self, words: str, about: str, **how: Any) -> None:
        """Declare an option or a positional argument.

        Args:
            words: its names and the word for its value, as in `-o --out FILE`. Without that word
                it is a flag, or has `choices`. A positional argument is that word alone: `FILE`.
            about: its help text.
            how: further arguments of `add_argument`.
        """
        *names, last = words.split(" ")
        if words == last and not last.startswith("-"):
            names = [how.pop("dest", last.lower())]
        if not last.startswith("-"):
            how["metavar"] = last
        else:
            names.append(last)
            if "choices" not in how:
                how["action"] = "store_true"
        self.add_argument(*names, help=about, **how)

    def error(self, message: str) -> NoReturn:
        """Print what is wrong, with an example, and exit with code 2."""
        if message.endswith("required: COMMAND"):
            self.print_help(sys.stderr)
            sys.exit(2)
        if choice := _CHOICE.search(message):
            meant = did_you_mean(choice[1], re.split(r"[', ]+", choice[2]))
            message += meant and f": {meant}"
        formatter = self._get_formatter()
        formatter.add_text(self.epilog)
        text = f"{self.prog}: error: {message}\n{formatter.format_help()}"
        self.exit(2, f"{escaped(text)}{self.prog} --help says more\n")


def positive(text: str) -> int:
    """Read a whole number of at least 1.

    >>> positive("3")
    3
    """
    number = int(text) if text.isascii() and text.isdigit() and len(text) < 20 else 0
    if number < 1:
        raise argparse.ArgumentTypeError(f"expected a whole number of at least 1, not {text}")
    return number


def shard(text: str) -> Shard:
    """Read a shard, as number and total.

    >>> shard("2/4")
    Shard(number=2, total=4)
    """
    number, slash, count = text.partition("/")
    if slash and positive(number) <= positive(count):
        return Shard(int(number), int(count))
    raise argparse.ArgumentTypeError(
        f"expected a share such as 2/4, the second of four, not {text}"
    )


def number_or_folder(text: str) -> int | Path:
    """Read a number of tests, or a folder of tests.

    >>> number_or_folder("3")
    3
    """
    if text.isascii() and text.isdigit():
        return positive(text)
    if not Path(text).is_dir():
        raise argparse.ArgumentTypeError(f"expected a number, or a folder of tests, not {text}")
    return Path(text)


TIME_FORMS = "seconds, or a number with its unit: 12.5, 500ms"
"""The forms of instants and durations, for help texts."""

_TIME = re.compile(r"\s*([+-]?[\d.]+(?:e[+-]?\d+)?)\s*([a-z]*)\s*", re.ASCII)


def ticks(text: str) -> int:
    """Read an instant, exactly: seconds, or a number with its unit.

    >>> ticks("10 s"), ticks("1700000000.000000001"), ticks("500ms")
    (10000000000, 1700000000000000001, 500000000)
    """
    written = _TIME.fullmatch(text)
    number, unit = written.groups() if written else ("", "")
    try:
        if unit and unit not in TICKS_PER_UNIT:
            raise TraceError("no unit of time")
        return ticks_of_text(number, unit or "s")
    except TraceError:
        raise argparse.ArgumentTypeError(f"expected {TIME_FORMS}, not {text}") from None


def span(text: str) -> int:
    """Read a duration of at least 0, as `ticks` reads instants.

    >>> span("2 min")
    120000000000
    """
    duration = ticks(text)
    if duration < 0:
        raise argparse.ArgumentTypeError(f"expected a duration of at least 0, not {text}")
    return duration


def instant_s(text: str) -> float:
    """Read an instant as `ticks` does, in seconds.

    >>> instant_s("12.5"), instant_s("-500ms")
    (12.5, -0.5)
    """
    return ticks(text) / TICKS_PER_SECOND


def span_s(text: str) -> float:
    """Read a duration as `span` does, in seconds.

    >>> span_s("0.1"), span_s("2min")
    (0.1, 120.0)
    """
    return span(text) / TICKS_PER_SECOND


def percentage(text: str) -> float:
    """Read a percentage, with or without its sign, as a share from 0 to 1.

    >>> percentage("95%"), percentage("99.5")
    (0.95, 0.995)
    """
    number = text.removesuffix("%").strip()
    plain = number.isascii() and number.replace(".", "", 1).isdecimal() and len(number) < 20
    share = Fraction(number) / 100 if plain else Fraction(-1)
    if not 0 <= share <= 1:
        raise argparse.ArgumentTypeError(f"expected a percentage, such as 95%, not {text}")
    return float(share)
