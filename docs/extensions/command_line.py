"""The reference of the commands as Markdown, generated from their parsers."""

from __future__ import annotations

import argparse
import os
import re
from collections.abc import Iterator

from handover.cli import _parser as handover_parser
from rvmon.cli import COMMANDS, GROUPS
from rvmon.cli import _parser as rvmon_parser


def commands(program: str) -> str:
    """Every subcommand of a program with its usage, arguments and example."""
    os.environ["COLUMNS"] = "80"
    is_ours = program == "rvmon"
    parsers = [rvmon_parser([name]) for name in COMMANDS] if is_ours else [handover_parser()]
    groups = GROUPS if is_ours else {}
    parts = [f"* {group}: {', '.join(map(_link, names))}" for group, names in groups.items()]
    return "\n".join(
        [
            *parts,
            "",
            *(
                line
                for parser in parsers
                for command in _subcommands(parser)
                for line in _section(command)
            ),
        ]
    )


def _link(name: str) -> str:
    return f"[{name}](#rvmon-{name})"


def _subcommands(parser: argparse.ArgumentParser) -> Iterator[argparse.ArgumentParser]:
    """All parsers that have no subcommands, each once."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for command in dict.fromkeys(action.choices.values()):
                yield from _subcommands(command)
            return
    yield parser


def _section(parser: argparse.ArgumentParser) -> Iterator[str]:
    yield f"## {parser.prog}\n"
    yield f"{_escaped(parser.description or '')}\n"
    heading = "usage: "
    usage = parser.format_usage().removeprefix(heading).replace("\n" + " " * len(heading), "\n")
    yield f"```text\n{usage.rstrip()}\n```\n"
    for action in parser._actions:
        if action.help not in (None, argparse.SUPPRESS) and action.dest != "help":
            yield f"`{_named(action)}`\n: {_escaped(_help(parser, action))}\n"
    if parser.epilog:
        yield _examples(parser.epilog)


def _named(action: argparse.Action) -> str:
    """The notation of an option or argument."""
    value = action.metavar or ("" if action.nargs == 0 else action.dest.upper())
    if action.choices is not None and action.metavar is None:
        value = "{" + ",".join(map(str, action.choices)) + "}"
    value = " ".join(value) if isinstance(value, tuple) else str(value)
    if not action.option_strings:
        return f"{value}…" if action.nargs in ("+", "*") else value
    between = "" if value.startswith("[") else " "
    return ", ".join(f"{option}{between}{value}".rstrip() for option in action.option_strings)


def _help(parser: argparse.ArgumentParser, action: argparse.Action) -> str:
    return parser._get_formatter()._expand_help(action)


def _examples(epilog: str) -> str:
    """The text below the help: commands after the word `example`, otherwise prose."""
    shown = re.fullmatch(r"examples?:\s+(.*)", epilog, re.DOTALL)
    if shown is None:
        return f"{_escaped(epilog)}\n"
    commands = re.split(r";\s+|\n\s*", shown[1])
    return "\n".join(("```console", *(f"$ {command}" for command in commands), "```\n"))


def _escaped(text: str) -> str:
    """Escape text for Markdown; options and text in backticks become code."""
    parts = text.split("`")
    for index in range(0, len(parts), 2):
        for sign in "\\*_<[":
            parts[index] = parts[index].replace(sign, f"\\{sign}")
        parts[index] = re.sub(r"(?<![\w-])--[a-z][\w-]*", r"`\g<0>`", parts[index])
    return "`".join(parts)
