"""Rules on imports and names."""

from __future__ import annotations

from collections.abc import Sequence

from rvmon.diagnostics import Diagnostic, Severity, Span
from rvmon.language.rules import Breach, Rule, finding
from rvmon.texts import did_you_mean

DEEPEST = 20  # longer chains of imports are refused

IMPORT = Rule("RV016", "import", Severity.ERROR)

unreadable = Breach(
    IMPORT, "cannot read `{1}`: {2}", "the path is relative to the file that imports"
)
outside = Breach(
    IMPORT,
    "cannot read `{1}`: it lies outside {2}, the folder of the project",
    "copy it into the project, or name its folder in RVMON_ALLOW_IMPORTS",
)
unknown_library = Breach(
    IMPORT, "no library named `{1}`", 'there is {2}; a file is imported as "{1}.rv", in quotes'
)
circle = Breach(
    IMPORT,
    "files import each other in a circle",
    "move what both need into a third file",
    "it starts here",
)
too_deep = Breach(
    IMPORT, f"imports are nested more than {DEEPEST} levels deep", "import the last file directly"
)

RESERVED_NAME = Rule("RV010", "reserved-name", Severity.ERROR)

reserved = Breach(
    RESERVED_NAME,
    "`{}` is a word of the language, expected a name",
    "choose another name or quote it: `` `{}` ``",
)
DOUBLE_NAME = Rule("RV011", "double-name", Severity.ERROR)
UNKNOWN_NAME = Rule("RV012", "unknown-signal", Severity.ERROR)
UNKNOWN_LABEL = Rule("RV013", "unknown-label", Severity.ERROR)
UNKNOWN_FUNCTION = Rule("RV014", "unknown-function", Severity.ERROR)
RECURSIVE = Rule("RV015", "recursive-definition", Severity.ERROR)
UNUSED = Rule("RV017", "unused-name", Severity.WARNING)

double = Breach(DOUBLE_NAME, "{2} `{1}` is declared twice", "rename one of them", "first here")
"""A second declaration. Arguments: its name, and the kind of thing, such as `requirement`."""


def unknown(span: Span, name: str, close: str) -> Diagnostic:
    """An undeclared name; `close` describes a similar declared name, or is empty."""
    declared = f"`signal {name} : bool`, `signal {name} : real [m]` or `event {name}`"
    fix = close or f"declare it, as {declared}"
    return finding(UNKNOWN_NAME, f"no signal or event named `{name}`", span, fix=fix)


def unknown_constant(name: str, known: Sequence[str]) -> Diagnostic:
    """An override of a constant that does not exist."""
    listed = f"there are {', '.join(known)}" if known else "the file declares none"
    return finding(UNKNOWN_NAME, f"no constant named `{name}` to override", fix=listed)


def unknown_label(span: Span, name: str, labels: tuple[str, ...]) -> Diagnostic:
    """A label that the signal does not have."""
    listed = ", ".join(labels[:12]) + (", …" if len(labels) > 12 else "")
    fix = did_you_mean(name, labels, f"the labels are {listed}")
    return finding(UNKNOWN_LABEL, f"no label named `{name}`", span, fix=fix)


unknown_function = Breach(UNKNOWN_FUNCTION, "no function or macro named `{1}`", "{2}")
recursive = Breach(
    RECURSIVE,
    "`{1}` is defined by itself: {2}",
    "for a condition without end use `always`, `until` and the like",
)
double_item = Breach(DOUBLE_NAME, "a file has one `{1}` item", other="first here")
built_in = Breach(DOUBLE_NAME, "`{}` is a function of the language", "choose another name")
unused = Breach(UNUSED, "`{1} {2}` is never used", "remove it, or look for what should use it")
"""An unused `define`, `const` or `let`. Arguments: which of the three, and its name."""
