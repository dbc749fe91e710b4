"""The page of each diagnostic code, made from its rule."""

from __future__ import annotations

from collections.abc import Mapping

from rvmon.diagnostics.render import render_full
from rvmon.errors import SpecError
from rvmon.spec.compile import compile_text
from rvmon.spec.rules.rule import Rule

MOST_FINDINGS = 5
"""Of more findings the first and the last are shown."""


def rule_page(rule: Rule) -> str:
    """A rule's page as Markdown: what, why, an example with its message, the same mended."""
    return "\n".join(
        (
            f"# {rule.code} {rule.name}",
            "",
            f"*{rule.severity}* · {rule.what}",
            "",
            rule.why,
            "",
            "## Example",
            "",
            *_fenced(_cut(rule.example), "rv"),
            "",
            *_fenced(example_message(rule), "text"),
            "",
            "## Instead",
            "",
            *_fenced(rule.instead, "rv"),
            "",
        )
    )


def index_page(rules: Mapping[str, Rule]) -> str:
    """The list of all codes as Markdown."""
    rows = [
        f"| [{rule.code}]({rule.code}.md) | {rule.name} | {rule.severity} | {rule.what} |"
        for rule in rules.values()
    ]
    head = ("# Diagnostic codes of specifications", "", "| code | name | kind | what |")
    return "\n".join((*head, "|---|---|---|---|", *rows, ""))


def example_message(rule: Rule) -> str:
    """What is said about the rule's example; of a long list the beginning and the end."""
    try:
        _, found = compile_text(rule.example, name="demo.rv")
    except SpecError as error:
        found = error.diagnostics
    if len(found) <= MOST_FINDINGS:
        return render_full(found)
    return f"{render_full(found[:1])}\n\n…\n\n{render_full(found[-1:])}"


def _cut(text: str) -> str:
    return "\n".join(line if len(line) <= 100 else f"{line[:99]}…" for line in text.splitlines())


def _fenced(text: str, language: str) -> tuple[str, ...]:
    return (f"```{language}", text.rstrip("\n"), "```")
