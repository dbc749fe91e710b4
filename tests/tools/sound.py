"""Green never hides a failure: the law on what was lost (SEMANTICS 7), to be tried on any judge.

What a random case lost is filled in at random; so filled it is a case that differs from the first
only in what that did not know.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from msgspec import structs

from rvmon.language.checked import formula as rv
from rvmon.language.checked.formula import Probe, ProbeAtom, UpdateValue
from rvmon.language.checked.specification import CheckedSpec, Event, Type
from rvmon.testing.generate import Rng, chance, pick
from rvmon.testing.generate.trace import Case
from rvmon.testing.law.syntax import numerics, subformulas
from rvmon.trace.sample import Payload, Sample, Scalar, Value
from rvmon.trace.schema import Kind
from rvmon.verdicts import Verdict
from rvmon.verdicts.report import Report
from tests.tools.law import judge as oracle
from tests.tools.law import names_read, word

_NUMBERS = (-2, -1, 0, 1, 2, 3)


def refilled(rng: Rng, case: Case, *, whole: bool = True) -> Case:
    """The case with a random value wherever one was lost, and whatever may have come in an outage.

    Signals keep their births: before its first known value nothing of a signal was lost, but in an
    outage. Where a signal became stale, updates may be put in, if nothing in the specification
    counts updates; events without a source may occur. NaN of a signal that ignores it is no update:
    nothing is lost there.
    """
    through = _through_outages(rng, case)
    return _with_values(rng, case, through) if whole else through


def _through_outages(rng: Rng, case: Case) -> Case:
    """The case with samples and values wherever an outage may have swallowed some.

    That the trace reached to the end of each was known, and stays so.
    """
    if not case.outages:
        return case
    lost = _Lost(rng, case.spec)
    told: dict[int, dict[str, Value]] = {s.t: dict(s.values) for s in case.samples}
    # Of two values with one stamp the last counts; those that end an outage came behind it.
    for outage in sorted(case.outages, key=lambda outage: outage.first):
        names = outage.names if case.names is None else outage.names & case.names
        often = pick(rng, (10, 40, 80))
        for t in range(outage.first, outage.last + 1):
            if not chance(rng, often):
                continue
            values = told.setdefault(t, {})
            for name in sorted(names):
                if chance(rng, 60):
                    lost.put(values, name, over=_may_be_overwritten(case, name, t))
    advances = [(t, index) for index, t in enumerate(case.actions) if isinstance(t, int)]
    samples = [Sample(t, values) for t, values in sorted(told.items())]
    actions: list[Sample | int] = []
    for sample in samples:
        while advances and advances[0][0] <= sample.t:
            actions.append(advances.pop(0)[0])
        actions.append(sample)
    actions += [t for t, _ in advances]
    return replace(case, actions=tuple(actions), end=word(case).end, outages=())


def _may_be_overwritten(case: Case, name: str, t: int) -> bool:
    """Whether what was read of a name at an instant may have been followed by what was lost.

    That is everywhere in an outage, but at its end: what was read there ended it. An outage that
    begins where it ends is read before and behind.
    """
    of_name = [outage for outage in case.outages if name in outage.names]
    return any(o.first <= t < o.last or o.first == t == o.last for o in of_name)


def _with_values(rng: Rng, case: Case, through: Case) -> Case:
    """A case with a value wherever it says that it is unknown, or says nothing for want of one."""
    lost = _Lost(rng, case.spec)
    read = {sample.t: sample.values for sample in case.samples}
    actions: list[Sample | int] = []
    born: set[str] = set()
    updated: dict[str, int] = {}
    for action in through.actions:
        if isinstance(action, int):
            actions.append(action)
            continue
        born |= {name for o in case.outages if o.first <= action.t for name in o.names}
        values: dict[str, Value] = {}
        for name, value in action.values.items():
            if name in case.spec.ignoring and not _is_known(value):
                continue
            known = name not in read.get(action.t, {})
            values[name] = value if known else lost.filled(name, value, born=name in born)
            if name in case.spec.signals:
                updated[name] = action.t
                if _is_known(value):
                    born.add(name)
        for name, event in case.spec.events.items():
            if case.names is not None and name not in case.names and chance(rng, 30):
                values[name] = lost.occurrence(event)
        for name, signal in case.spec.signals.items():
            is_stale = action.t > updated.get(name, action.t) + (signal.stale_after or 0)
            if signal.stale_after is not None and is_stale and name in born:
                values[name] = lost.scalar(signal.type)
        actions.append(Sample(action.t, values))
    names = None if case.names is None else case.names | case.spec.events.keys()
    return replace(through, actions=tuple(actions), names=names)


def _is_known(value: Value) -> bool:
    return value is not None and value == value


@dataclass(frozen=True, slots=True)
class _Lost:
    """Draws what was lost."""

    rng: Rng
    spec: CheckedSpec

    def put(self, values: dict[str, Value], name: str, *, over: bool) -> None:
        """Add what may have come of a name in an outage to what a sample says."""
        read = values.get(name)
        if name in self.spec.signals:
            if name not in values or over:
                unknown = chance(self.rng, 10)
                values[name] = None if unknown else self.scalar(self.spec.signals[name].type)
            return
        event = self.spec.events[name]
        if not read:
            values[name] = None if chance(self.rng, 5) else self.occurrence(event)
        elif event.fields and self._distinguishes(event):
            one = read if isinstance(read, Mapping) else {}
            values[name] = (
                *(read if isinstance(read, tuple) else (one,)),
                self._payload(event, {}),
            )

    def _distinguishes(self, event: Event) -> bool:
        """Whether two payloads of an event at one instant are no error."""
        found = [requirement.for_each for requirement in self.spec.requirements.values()]
        return all(one is not None and one.value.event == event.name for one in found)

    def filled(self, name: str, value: Value, *, born: bool) -> Value:
        if name in self.spec.signals:
            return (
                value if not born or _is_known(value) else self.scalar(self.spec.signals[name].type)
            )
        event = self.spec.events[name]
        if isinstance(value, tuple):
            return tuple(self._payload(event, one) for one in value)
        if value is None:
            return self.occurrence(event)
        if value is False or not event.fields:
            return value
        return self._payload(event, value if isinstance(value, Mapping) else {})

    def occurrence(self, event: Event) -> Value:
        if chance(self.rng, 50):
            return False
        return self._payload(event, {}) if event.fields else True

    def _payload(self, event: Event, payload: Payload) -> Payload:
        return {
            name: payload[name] if _is_known(payload.get(name)) else self.scalar(type_)
            for name, type_ in event.fields.items()
        }

    def scalar(self, type_: Type) -> Scalar:
        match type_.kind:
            case Kind.BOOL:
                return chance(self.rng, 50)
            case Kind.LABEL:
                return pick(self.rng, type_.labels)
            case Kind.INT | Kind.REAL:
                return pick(self.rng, _NUMBERS)


def is_spoken_of(spec: CheckedSpec) -> bool:
    """Whether the law speaks of a specification: not if it asks what is known.

    Nor if it counts updates of a signal that becomes stale: updates are what was lost then.
    """
    stale = {name for name, signal in spec.signals.items() if signal.stale_after is not None}
    for requirement in spec.requirements.values():
        wholes = (requirement.trigger, requirement.consequent)
        for part in (part for whole in wholes for part in subformulas(whole)):
            if isinstance(part, ProbeAtom) and (part.probe is Probe.KNOWN or part.name in stale):
                return False
        values = [value for whole in wholes for value in numerics(whole)]
        values += [value for one in requirement.captures for value in rv.numbers_in(one.value)]
        if any(isinstance(value, UpdateValue) and value.name in stale for value in values):
            return False
    return True


def narrowed(case: Case) -> Case:
    """The case without the names that no requirement reads: the same to judge, and sooner."""
    spec = case.spec
    read = {name for one in spec.requirements.values() for name in names_read(one)}
    actions = tuple(
        replace(action, values={n: v for n, v in action.values.items() if n in read})
        if isinstance(action, Sample)
        else action
        for action in case.actions
    )
    signals = {name: signal for name, signal in spec.signals.items() if name in read}
    events = {name: event for name, event in spec.events.items() if name in read}
    outages = tuple(replace(outage, names=outage.names & read) for outage in case.outages)
    return replace(
        case,
        spec=structs.replace(spec, signals=signals, events=events),
        actions=actions,
        outages=outages,
    )


@dataclass(frozen=True, slots=True)
class Tried:
    """What came of filling in what a case lost.

    Attributes:
        verdicts: on the case itself.
        overturning: a filling that overturns one of them, if any was found.
        is_split: whether fillings with and without a failure were found; then only `I` is right.
    """

    verdicts: Mapping[str, Verdict]
    overturning: Case | None
    is_split: bool


def overturned(
    rng: Rng,
    case: Case,
    fillings: int,
    judge: Callable[[Case], Report] = oracle,
    *,
    whole: bool = True,
) -> Tried:
    """The verdicts on a case, against those with what it lost filled in at random.

    Source: SEMANTICS, section 7.
    """
    before = judge(case).verdicts
    seen: dict[str, set[bool]] = {name: set() for name in before}
    for _ in range(fillings):
        filled = refilled(rng, case, whole=whole)
        after = judge(filled).verdicts
        for name, verdict in before.items():
            green = verdict in (Verdict.PASS, Verdict.NOT_TRIGGERED)
            failed = after[name] is Verdict.FAIL
            seen[name].add(failed)
            if (green and failed) or (verdict is Verdict.FAIL and not failed):
                return Tried(before, filled, len(seen[name]) > 1)
    return Tried(before, None, any(len(kinds) > 1 for kinds in seen.values()))
