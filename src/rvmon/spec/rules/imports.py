"""Rules on imports."""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.diagnostics.diagnostic import Diagnostic, Label, Severity
from rvmon.diagnostics.span import Span
from rvmon.spec.rules.rule import Rule, finding

DEEPEST = 20
"""Longer chains of imports are refused."""

IMPORT = Rule("RV016", "import", Severity.ERROR)

RULES = (IMPORT,)


def unreadable(span: Span, target: str, reason: str) -> Diagnostic:
    """A file that cannot be read."""
    return finding(
        IMPORT,
        f"cannot read `{target}`: {reason}",
        span,
        fix="the path is relative to the file that imports",
    )


def outside(span: Span, target: str, root: str) -> Diagnostic:
    """A file that does not belong to the project."""
    return finding(
        IMPORT,
        f"cannot read `{target}`: it lies outside {root}, the folder of the project",
        span,
        fix="copy it into the project, or name its folder in RVMON_ALLOW_IMPORTS",
    )


def unknown_library(span: Span, name: str, known: Sequence[str]) -> Diagnostic:
    """A library that does not exist."""
    return finding(
        IMPORT,
        f"no library named `{name}`",
        span,
        fix=f'there is {", ".join(known)}; a file is imported as "{name}.rv", in quotes',
    )


def circle(here: Span, first: Span) -> Diagnostic:
    """Files that import each other."""
    return finding(
        IMPORT,
        "files import each other in a circle",
        here,
        Label(first, "it starts here"),
        fix="move what both need into a third file",
    )


def too_deep(span: Span) -> Diagnostic:
    """A chain of imports that is too long."""
    return finding(
        IMPORT,
        f"imports are nested more than {DEEPEST} levels deep",
        span,
        fix="import the last file directly",
    )
