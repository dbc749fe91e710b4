"""The rules for specifications: a module for each family.

A rule has a code, a name and a severity; a breach of it becomes a finding with a place and a fix.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from msgspec import Struct, field

from rvmon.diagnostics import Diagnostic, Label, Severity, Span


class Rule(Struct, frozen=True):
    """A rule; `rvmon/analysis/pages` says why it matters. Its code never comes to mean another."""

    code: str
    name: str
    severity: Severity


class Refusal(Exception):  # noqa: N818 - it carries a finding through a parser, no caller sees it
    """An item, expression or declaration cannot be read further."""

    def __init__(self, finding: Diagnostic) -> None:
        super().__init__(finding.message)
        self.finding = finding


class Reported(Exception):  # noqa: N818 - it never leaves this package
    """Something is wrong, and the finding about it is recorded already."""


def finding(rule: Rule, message: str, *places: Span | Label, fix: str = "") -> Diagnostic:
    """A breach of a rule at the first of some places: what is wrong, in one sentence, and a fix."""
    labels = tuple(place if isinstance(place, Label) else Label(place) for place in places)
    return Diagnostic(rule.code, rule.name, rule.severity, message, labels, fix)


def short(text: str) -> str:
    """A piece of the file on one line, its middle left out if it is long."""
    line = " ".join(text.split())
    return line if len(line) <= 60 else f"{line[:48]} … {line[-9:]}"


class Breach(Struct, frozen=True):
    """One way to break a rule; called with the place of it, it makes the finding."""

    rule: Rule
    # one sentence: what is wrong; `{}` is the text of the place, shortened, `{1}` and so on what
    # else is given
    message: str
    fix: str = ""  # a way to fix it, or empty; filled in like the message
    other: str = ""  # a note at a second place

    def __call__(self, *given: object) -> Diagnostic:
        """The finding at the first place that is given."""
        place, *others = [one for one in given if isinstance(one, Span)]
        words = [short(place.text), *(one for one in given if not isinstance(one, Span))]
        labels = [Label(other, self.other) for other in others]
        message, fix = self.message.format(*words), self.fix.format(*words)
        return finding(self.rule, message, place, *labels, fix=fix)


MOST = 100  # after so many errors nothing more is looked at; of warnings no more are kept


class Enough(Exception):  # noqa: N818 - never leaves this package
    """There are so many findings already that the rest of the file is not looked at."""


class Findings(Struct):
    """Findings in the order in which they were made, none twice."""

    # at most so many errors, and as many warnings
    diagnostics: list[Diagnostic] = field(default_factory=list)
    more: bool = False  # whether there were more
    _seen: set[tuple[object, ...]] = field(default_factory=set)
    _counts: Counter[Severity] = field(default_factory=Counter)

    def add(self, finding: Diagnostic) -> None:
        """Keep a finding, unless the same was made at the same place.

        Raises:
            Enough: there are too many errors.
        """
        place = finding.spans[0].span if finding.spans else None
        key = (finding.code, place and (place.source.name, place.start, place.end))
        # A macro used twice is reported once.
        if place is not None and key in self._seen:
            return
        if self._counts[finding.severity] >= MOST:
            self.more = True
            if finding.severity is Severity.ERROR:
                raise Enough
            return
        self._seen.add(key)
        self._counts[finding.severity] += 1
        self.diagnostics.append(finding)

    def extend(self, findings: Iterable[Diagnostic]) -> None:
        """Keep several."""
        for finding in findings:
            self.add(finding)
