"""The rules for specifications, one module per family.

A rule has a code, a name and a severity. A breach of a rule becomes a finding with a place and a
fix.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from msgspec import Struct, field

from rvmon.diagnostics import Diagnostic, Label, Severity, Span


class Rule(Struct, frozen=True):
    """A rule, explained in `rvmon/analysis/pages`. A code is never reused for another rule."""

    code: str
    name: str
    severity: Severity


class Refusal(Exception):  # noqa: N818 - it carries a finding through a parser, no caller sees it
    """Raised to abandon an item, expression or declaration; carries the finding that says why."""

    def __init__(self, finding: Diagnostic) -> None:
        super().__init__(finding.message)
        self.finding = finding


class Reported(Exception):  # noqa: N818 - it never leaves this package
    """Raised to abandon something wrong whose finding is already recorded."""


def finding(rule: Rule, message: str, *places: Span | Label, fix: str = "") -> Diagnostic:
    """A finding at the first of `places`, with one sentence on what is wrong, and a fix."""
    labels = tuple(place if isinstance(place, Label) else Label(place) for place in places)
    return Diagnostic(rule.code, rule.name, rule.severity, message, labels, fix)


def short(text: str) -> str:
    """A piece of the file on one line, with the middle left out if it is long."""
    line = " ".join(text.split())
    return line if len(line) <= 60 else f"{line[:48]} … {line[-9:]}"


class Breach(Struct, frozen=True):
    """One way to break a rule; calling it with a place makes the finding."""

    rule: Rule
    # one sentence on what is wrong; `{}` and `{0}` are the shortened text of the place, `{1}` and
    # so on the further arguments of the call
    message: str
    fix: str = ""  # a way to fix it, formatted like the message; may be empty
    other: str = ""  # a note at each further place

    def __call__(self, *given: object) -> Diagnostic:
        """The finding at the first span among the arguments."""
        place, *others = [one for one in given if isinstance(one, Span)]
        words = [short(place.text), *(one for one in given if not isinstance(one, Span))]
        labels = [Label(other, self.other) for other in others]
        message, fix = self.message.format(*words), self.fix.format(*words)
        return finding(self.rule, message, place, *labels, fix=fix)


MOST = 100  # after this many errors the check stops; of warnings, further ones are dropped


class TooManyErrors(Exception):  # noqa: N818 - never leaves this package
    """Raised to stop the check when there are too many errors."""


class Findings(Struct):
    """Collects findings in order, without duplicates: at most `MOST` errors and `MOST` warnings."""

    diagnostics: list[Diagnostic] = field(default_factory=list)
    more: bool = False  # whether there were more findings than are kept
    _seen: set[tuple[object, ...]] = field(default_factory=set)
    _counts: Counter[Severity] = field(default_factory=Counter)

    def add(self, finding: Diagnostic) -> None:
        """Add a finding, unless there is one with the same code at the same place.

        Raises:
            TooManyErrors: there are too many errors.
        """
        place = finding.spans[0].span if finding.spans else None
        key = (finding.code, place and (place.source.name, place.start, place.end))
        # An error in a macro is found once per use, but reported only once.
        if place is not None and key in self._seen:
            return
        if self._counts[finding.severity] >= MOST:
            self.more = True
            if finding.severity is Severity.ERROR:
                raise TooManyErrors
            return
        self._seen.add(key)
        self._counts[finding.severity] += 1
        self.diagnostics.append(finding)

    def extend(self, findings: Iterable[Diagnostic]) -> None:
        """Add several findings."""
        for finding in findings:
            self.add(finding)
