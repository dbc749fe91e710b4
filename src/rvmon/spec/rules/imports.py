"""Rules on imports."""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.diagnostics.diagnostic import Diagnostic, Severity
from rvmon.diagnostics.span import Span
from rvmon.spec.rules.rule import Breach, Rule, finding

DEEPEST = 20
"""Longer chains of imports are refused."""

IMPORT = Rule("RV016", "import", Severity.ERROR)

RULES = (IMPORT,)


unreadable = Breach(
    IMPORT, "cannot read `{1}`: {2}", "the path is relative to the file that imports"
)


outside = Breach(
    IMPORT,
    "cannot read `{1}`: it lies outside {2}, the folder of the project",
    "copy it into the project, or name its folder in RVMON_ALLOW_IMPORTS",
)


def unknown_library(span: Span, name: str, known: Sequence[str]) -> Diagnostic:
    """A library that does not exist."""
    return finding(
        IMPORT,
        f"no library named `{name}`",
        span,
        fix=f'there is {", ".join(known)}; a file is imported as "{name}.rv", in quotes',
    )


circle = Breach(
    IMPORT,
    "files import each other in a circle",
    "move what both need into a third file",
    "it starts here",
)
too_deep = Breach(
    IMPORT,
    f"imports are nested more than {DEEPEST} levels deep",
    "import the last file directly",
)
