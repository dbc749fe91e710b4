"""All rules by code, and the page of each in the documentation."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from functools import cache

from rvmon.diagnostics.diagnostic import Diagnostic
from rvmon.diagnostics.render import render_full
from rvmon.spec.rules import (
    goals,
    imports,
    names,
    properties,
    syntax,
    time,
    traps,
    triggers,
    types,
)
from rvmon.spec.rules.rule import Rule

WIDTH = 80
"""Columns of the text, which is read in terminals as well."""

_OF_WHAT = (
    "`RV` is found in specifications (`RV070` to `RV074` by `rvmon check --analyse`), `TA` in "
    "[models](../timed-models.md) and their queries. `rvmon explain CODE` shows the same page."
)

MOST_FINDINGS = 5
"""Of more findings the first and the last are shown."""


def rule_page(rule: Rule, found: Sequence[Diagnostic]) -> str:
    """A rule's page as Markdown: what, why, an example with its message, the same fixed."""
    language = "rv" if rule.code.startswith("RV") else "ta"
    return "\n".join(
        (
            f"# {rule.code} {rule.name}",
            "",
            textwrap.fill(f"*{rule.severity}* · {rule.what}", WIDTH),
            "",
            textwrap.fill(rule.why, WIDTH, break_on_hyphens=False),
            "",
            "## Example",
            "",
            *_fenced(_cut(rule.example), language),
            "",
            *_fenced(message_about(found), "text"),
            "",
            "## Instead",
            "",
            *_fenced(rule.instead, language),
            "",
        )
    )


def index_page(rules: Mapping[str, Rule]) -> str:
    """The list of all codes as Markdown."""
    rows = [
        f"| [{rule.code}]({rule.code}.md) | {rule.name} | {rule.severity} | {rule.what} |"
        for rule in rules.values()
    ]
    head = (
        "# Diagnostic codes",
        "",
        _OF_WHAT,
        "",
        "| code | name | kind | what |",
        "|---|---|---|---|",
    )
    navigation = _fenced(":hidden:\n:glob:\n\n[RT]*", "{toctree}")
    return "\n".join((*head, *rows, "", *navigation, ""))


def message_about(found: Sequence[Diagnostic]) -> str:
    """What is written about an example; of a long list the beginning and the end."""
    if len(found) <= MOST_FINDINGS:
        return render_full(found)
    return f"{render_full(found[:1])}\n\n…\n\n{render_full(found[-1:])}"


def _cut(text: str) -> str:
    lines = text.splitlines()
    return "\n".join(line if len(line) <= WIDTH else f"{line[: WIDTH - 1]}…" for line in lines)


def _fenced(text: str, language: str) -> tuple[str, ...]:
    return (f"```{language}", text.rstrip("\n"), "```")


@cache
def all_rules() -> Mapping[str, Rule]:
    """Every rule by its code, in order of codes."""
    families = (syntax, names, imports, types, time, triggers, traps, properties, goals)
    rules = sorted((rule for family in families for rule in family.RULES), key=lambda r: r.code)
    return {rule.code: rule for rule in rules}
