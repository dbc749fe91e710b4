"""One recording, judged in every way there is; a comparison per requirement.

In the spirit of Spot's `ltlcross`: Duret-Lutz et al., From Spot 2.0 to Spot 2.10, CAV 2022.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

from rvmon.errors import RvmonError
from rvmon.spec.checked.specification import TimeModel
from rvmon.testing.case import Case
from rvmon.testing.compare import differences
from rvmon.testing.drive import drive
from rvmon.testing.forms import FORMS, Maker
from rvmon.testing.peers.client import Peer, PeerError
from rvmon.testing.peers.core import UntranslatableError
from rvmon.testing.peers.judged import Unfit, disagreements
from rvmon.testing.peers.ways import WAYS
from rvmon.testing.scale import Compact, compact, in_units
from rvmon.trace.sample import Sample
from rvmon.trace.time import TICKS_PER_SECOND
from rvmon.verdict.report import Report

BASELINE = "auto"
"""What the others are compared with: the engine that `rvmon run` takes."""

SNAPSHOTS = 20
"""How often a run is frozen, evenly over its samples."""

MOST_TICKS = 3_000
MOST_WORK = 60_000
"""Ticks times attempts up to which the oracle is asked."""


@dataclass(frozen=True, slots=True)
class Answer:
    """What one way reported of one requirement.

    Attributes:
        skipped: why it was not asked, or could not answer; empty if it did.
        differences: where it disagrees with the baseline, a line each.
    """

    skipped: str = ""
    differences: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Crossing:
    """One requirement in every way.

    Attributes:
        requirement: its id.
        report: of the baseline; `None` if that could not judge it.
        answers: by way.
    """

    requirement: str
    report: Report | None
    answers: Mapping[str, Answer] = field(default_factory=dict)

    @property
    def agrees(self) -> bool:
        """Whether all that answered agree."""
        return not any(answer.differences for answer in self.answers.values())


def crossings(case: Case, peers: Mapping[str, Peer]) -> Iterator[Crossing]:
    """Judge a case in every way, requirement by requirement.

    Args:
        case: samples in order of time.
        peers: the peers that run, by the names of their workers.
    """
    for name, requirement in case.spec.requirements.items():
        spec = replace(case.spec, requirements={name: requirement}, max_delay=None)
        yield _crossing(name, replace(case, spec=spec), peers)


def _crossing(name: str, case: Case, peers: Mapping[str, Peer]) -> Crossing:
    try:
        report = _judged(BASELINE, case)
    except RvmonError as error:
        return Crossing(name, None, {BASELINE: Answer(_first_line(error))})
    if report is None:
        return Crossing(name, None, {BASELINE: Answer("cannot evaluate it")})
    answers = {"oracle": _oracle(case, report)}
    for form in FORMS:
        if form != BASELINE:
            answers[form] = _answer(form, case, report)
    answers["snapshot"] = _snapshot(case, report)
    answers["columns"] = _columns(case, report)
    for way in WAYS.values():
        peer = peers.get(way.worker)
        if peer is None or way.time is not case.spec.time:
            continue
        try:
            found = disagreements(way, peer, case, report)
            answers[way.name] = Answer(differences=tuple(found))
        except (Unfit, UntranslatableError, PeerError) as error:
            answers[way.name] = Answer(_first_line(error))
    return Crossing(name, report, answers)


def _answer(form: str, case: Case, baseline: Report) -> Answer:
    try:
        report = _judged(form, case)
    except RvmonError as error:
        return Answer(_first_line(error))
    if report is None:
        return Answer("does not evaluate such requirements")
    return Answer(differences=tuple(differences(baseline, report)))


def _snapshot(case: Case, baseline: Report) -> Answer:
    """A monitor that is frozen and made anew again and again on the way."""
    from rvmon.session import Spec

    spec = Spec(case.spec)
    monitor = spec.monitor(sources=case.names)
    every = max(len(case.actions) // SNAPSHOTS, 1)
    for number, action in enumerate(case.actions):
        if number % every == 0:
            monitor = spec.restore(monitor.snapshot())
        if isinstance(action, Sample):
            monitor.step_ns(action.t, action.values)
        else:
            monitor.advance_ns(action)
    report = spec.restore(monitor.snapshot()).finish_ns(case.end)
    return Answer(differences=tuple(differences(baseline, report)))


def _columns(case: Case, baseline: Report) -> Answer:
    """The samples as arrays, judged in bulk; only those that carry all values are like that."""
    from rvmon.session import Spec

    if case.advances:
        return Answer("arrays hold samples only")
    signals = [n for n in case.spec.signals if case.names is None or n in case.names]
    events = [n for n in case.spec.events if case.names is None or n in case.names]
    table: dict[str, list[object]] = {"t_ns": [sample.t for sample in case.samples]}
    for name in signals:
        table[name] = [sample.values.get(name) for sample in case.samples]
        if None in table[name]:
            return Answer(f"`{name}` is not in every sample")
    for name in events:
        occurrences = [sample.values.get(name, False) for sample in case.samples]
        if not all(isinstance(value, bool) for value in occurrences):
            return Answer(f"`{name}` has payloads")
        table[name] = list(occurrences)
    import numpy as np

    arrays = {name: np.array(column) for name, column in table.items()}
    if any(array.dtype.kind not in "bif" for array in arrays.values()):
        return Answer("labels are no arrays of numbers")
    until = None if case.end is None else case.end / TICKS_PER_SECOND
    report = Spec(case.spec).evaluate(arrays, time="t_ns", until=until)
    return Answer(differences=tuple(differences(baseline, report)))


def _judged(form: str, case: Case) -> Report | None:
    monitor = Maker(form)(case)
    return None if monitor is None else drive(monitor, case)[0]


def _oracle(case: Case, baseline: Report) -> Answer:
    """The oracle lays out every tick: it judges a case of the same order within fewer of them."""
    small = compact(case)
    if small is None:
        return Answer("it speaks of absolute durations, and ticks are too many")
    ticks = _ticks(small.case)
    if ticks > MOST_TICKS or ticks * max(len(baseline.attempts), 1) > MOST_WORK:
        return Answer(f"{ticks:,} ticks to lay out for {len(baseline.attempts)} attempts: too many")
    try:
        return _by_oracle(small, baseline)
    except RvmonError as error:
        return Answer(_first_line(error))


def _ticks(case: Case) -> int:
    last = max(case.samples[-1].t, case.end or 0)
    if case.spec.time is TimeModel.CLOCKED and case.spec.period:
        return last // case.spec.period
    return last


def _by_oracle(small: Compact, baseline: Report) -> Answer:
    from rvmon.testing.oracle import evaluate

    case = small.case
    report = evaluate(
        case.spec, case.samples, end=case.end, advances=case.advances, names=case.names
    )
    wanted = in_units(report, small.unit)
    if wanted == in_units(baseline, small.grain, small.origin):
        return Answer()
    shown = replace(
        report,
        attempts=tuple(
            replace(
                attempt,
                triggered=_back(attempt.triggered, small),
                decided=None if attempt.decided is None else _back(attempt.decided, small),
            )
            for attempt in report.attempts
        ),
    )
    return Answer(differences=tuple(differences(baseline, shown)) or ("other order of attempts",))


def _back(t: int, small: Compact) -> int:
    """An instant of the compact case as one of the case that it was made of."""
    whole = (t + small.unit // 2) // small.unit
    return whole * small.grain + (t - whole * small.unit) + small.origin


def _first_line(error: Exception) -> str:
    lines = str(error).splitlines()
    return lines[0] if lines else type(error).__name__
