"""What the input health of a run has to say, worked out from its samples (SEMANTICS 1 and 6)."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

from rvmon.language.checked.formula import BoundAtom, Constant, Literal, Passed
from rvmon.language.checked.specification import CheckedSpec, Requirement, TimeModel
from rvmon.testing.generate.trace import Case
from rvmon.testing.law.sample_words import without_ignored
from rvmon.testing.law.syntax import subformulas
from rvmon.testing.law.word import Word
from rvmon.trace.sample import Health, HealthKind, Value
from tests.tools.law import names_read


def expected_health(case: Case, word: Word) -> list[Health]:
    """The findings on the inputs of a case, without remarks."""
    case = replace(case, actions=tuple(without_ignored(case.spec, case.samples)))
    readers = readers_of(case.spec)
    found = [*_unknown(case), *_stale(case, word), *_unfed(case, readers)]
    return [
        Health(kind, shown, count, first, readers.get(name, ()))
        for kind, shown, name, count, first in sorted(found, key=lambda one: (one[1], one[0]))
    ]


def readers_of(spec: CheckedSpec) -> dict[str, tuple[str, ...]]:
    """The requirements that speak of a name, by name."""
    readers: dict[str, tuple[str, ...]] = {}
    for requirement in spec.requirements.values():
        for name in names_read(requirement, keys=False):
            readers[name] = (*readers.get(name, ()), requirement.id)
    return readers


def health_differences(
    spec: CheckedSpec, expected: Sequence[Health], found: Sequence[Health]
) -> list[str]:
    """One line per difference between the expected input health of a case and what was reported.

    A requirement that can be simplified may not depend on all that it names: it may be left out.
    """
    simple = {r.id for r in spec.requirements.values() if not may_be_simplified(r, spec.time)}
    wanted = {(one.kind, one.name): one for one in expected}
    got = {(one.kind, one.name): one for one in found}
    lines = []
    if list(got) != sorted(got, key=lambda key: (key[1], key[0])) or len(got) != len(found):
        lines.append("input health is not in order, or says things twice")
    for key in sorted({*wanted, *got}):
        due, actual = wanted.get(key), got.get(key)
        if actual is None and due is not None:
            spared = key[0] in (HealthKind.MISSING, HealthKind.ABSENT, HealthKind.STALE)
            agree = spared and not simple.intersection(due.requirements)
        else:
            agree = due is not None and actual is not None and _agree(due, actual, simple)
        if not agree:
            lines.append(f"input health: expected {due}, got {actual}")
    return lines


def _agree(expected: Health, actual: Health, simple: set[str]) -> bool:
    must = simple.intersection(expected.requirements)
    return (
        (expected.count, expected.first) == (actual.count, actual.first)
        and must <= set(actual.requirements) <= set(expected.requirements)
        and list(actual.requirements)
        == [name for name in expected.requirements if name in actual.requirements]
    )


def may_be_simplified(requirement: Requirement, time: TimeModel) -> bool:
    """Whether it has a constant in it, or a window that may hold no tick of a clock.

    So has time that has passed beside a constant: nothing is read for it.
    """
    return any(
        isinstance(part, Constant)
        or (isinstance(part, Passed) and isinstance(part.after, Literal))
        or (isinstance(part, BoundAtom) and part is not requirement.trigger)
        or (time is TimeModel.CLOCKED and getattr(part, "interval", None) is not None)
        for formula in (requirement.trigger, requirement.consequent)
        for part in subformulas(formula)
    )


Found = tuple[HealthKind, str, str, int, int | None]
"""Kind, what is shown, the name, how often, the first instant."""


def _unknown(case: Case) -> Iterator[Found]:
    seen: dict[tuple[HealthKind, str, str], list[int]] = {}
    for sample in case.samples:
        for shown, name, value in _scalars(sample.values):
            kind = HealthKind.NONE if value is None else HealthKind.NAN
            seen.setdefault((kind, shown, name), []).append(sample.t)
    for (kind, shown, name), instants in seen.items():
        yield kind, shown, name, len(instants), instants[0]


def _scalars(values: Mapping[str, Value]) -> Iterator[tuple[str, str, Value]]:
    """Place, name and value of what is unknown in a sample."""
    for name, value in values.items():
        payloads = value if isinstance(value, tuple) else (value,)
        for payload in payloads:
            fields = payload.items() if isinstance(payload, Mapping) else [("", payload)]
            for field, scalar in fields:
                if scalar is None or scalar != scalar:
                    yield (f"{name}.{field}" if field else name), name, scalar


def _stale(case: Case, word: Word) -> Iterator[Found]:
    """A signal is stale where a position comes too late after an update, and before the next."""
    for name, signal in case.spec.signals.items():
        if signal.stale_after is None:
            continue
        updates = [sample.t for sample in case.samples if name in sample.values]
        ends = [
            earlier + signal.stale_after + 1
            for earlier, later in pairwise([*updates, None])
            if earlier is not None
            and any(
                letter.instant > earlier + signal.stale_after
                and (later is None or letter.instant < later)
                for letter in word.letters
            )
        ]
        if ends:
            yield HealthKind.STALE, name, name, len(ends), ends[0]


def _unfed(case: Case, readers: Mapping[str, tuple[str, ...]]) -> Iterator[Found]:
    for name in readers:
        if case.names is not None and name not in case.names:
            yield HealthKind.ABSENT, name, name, 1, None
        elif name in case.spec.signals and case.samples and name not in case.samples[0].values:
            yield HealthKind.MISSING, name, name, 1, case.samples[0].t
