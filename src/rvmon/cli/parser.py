"""The parser of the command line."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Sequence
from typing import Any, NoReturn

from rvmon.texts import did_you_mean, shown

_CHOICE = re.compile(r"invalid choice: '(.*)' \(choose from (.*)\)", re.DOTALL)


class _Help(argparse.HelpFormatter):
    """Lists and examples keep their lines; the latter so that they can be copied."""

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
    """A parser whose complaints are short, say how it is done, and obey nothing that was given."""

    def __init__(self, **options: Any) -> None:
        super().__init__(formatter_class=_Help, **options)

    def parse_known_args(  # type: ignore[override]  # of its overloads one is what is called
        self, args: Sequence[str] | None = None, namespace: Any = None
    ) -> Any:
        """As argparse does; but what a subcommand does not know, that one complains of."""
        found, rest = super().parse_known_args(args, namespace)
        if rest:
            meant = did_you_mean(rest[0].partition("=")[0], self._option_string_actions)
            self.error(f"unrecognized arguments: {' '.join(rest)}{meant and f': {meant}'}")
        return found, rest

    def error(self, message: str) -> NoReturn:
        """Say what is wrong and how it is done, and leave with code 2."""
        if message.endswith("required: COMMAND"):
            self.print_help(sys.stderr)
            sys.exit(2)
        if choice := _CHOICE.search(message):
            meant = did_you_mean(choice[1], re.split(r"[', ]+", choice[2]))
            message += meant and f": {meant}"
        formatter = self._get_formatter()
        formatter.add_text(self.epilog)
        text = f"{self.prog}: error: {message}\n{formatter.format_help()}"
        self.exit(2, f"{shown(text)}{self.prog} --help says more\n")
