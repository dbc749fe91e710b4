"""What makes cases hard for an engine: of which kinds is one?"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from rvmon.spec.checked.specification import CheckedSpec
from rvmon.testing.case import Case
from rvmon.testing.generate.choices import WIDE
from rvmon.testing.law.syntax import numerics
from rvmon.verdict.report import Report
from tests.tools.health import names_in

KINDS = (
    *("held", "sampled", "sampled every"),
    *("late birth", "doubt", "for each", "let", "many", "wide"),
    *("many samples", "long silence", "unknown values", "no source", "stale", "advance", "outage"),
)
"""All of them, the models of time first."""

_MANY = 20
"""Requirements, or samples, that are many."""


def kinds_of(case: Case, report: Report) -> Iterator[str]:
    """The kinds that a case is of.

    Args:
        case: any.
        report: what is to be said of it.
    """
    spec = case.spec
    names = {name for one in spec.requirements.values() for name in names_in(one)}
    found = {
        "late birth": any(_is_born_late(case, name) for name in names & spec.signals.keys()),
        "doubt": any(attempt.in_doubt for attempt in report.attempts),
        "for each": any(one.for_each for one in spec.requirements.values()),
        "let": any(one.captures for one in spec.requirements.values()),
        "many": len(spec.requirements) >= _MANY,
        "wide": _is_wide(spec),
        "many samples": len(case.samples) >= _MANY,
        "long silence": any(b.t - a.t > 8 for a, b in pairwise(case.samples)),
        "unknown values": any(None in sample.values.values() for sample in case.samples),
        "no source": case.names is not None and not names <= case.names,
        "stale": any(spec.signals[name].stale_after for name in names & spec.signals.keys()),
        "advance": bool(case.advances),
        "outage": bool(case.outages),
    }
    yield spec.time.value
    yield from (kind for kind, is_of in found.items() if is_of)


def _is_born_late(case: Case, name: str) -> bool:
    known = (sample.t for sample in case.samples if _is_known(sample.values.get(name)))
    first = next(known, None)
    return first is not None and first > case.samples[0].t


def _is_known(value: object) -> bool:
    return value is not None and value == value


def _is_wide(spec: CheckedSpec) -> bool:
    literals = (
        getattr(part, "value", 0)
        for one in spec.requirements.values()
        for formula in (one.trigger, one.consequent)
        for part in numerics(formula)
    )
    return any(value and value in WIDE for value in literals)
