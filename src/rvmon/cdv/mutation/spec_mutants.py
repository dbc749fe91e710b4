"""Mutants of requirements, which judge the recorded runs of a suite.

Sources of the operators, with the abbreviations used in comments:

* **BOY** Black, Okun, Yesha 2000, Mutation Operators for Specifications.
* **ALN** Aichernig, Lorber, Ničković 2013, Time for Mutants: Model-Based Mutation Testing with
  Timed Automata.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from msgspec import structs

from rvmon.analysis.conflicts import starts_with
from rvmon.analysis.product import Together
from rvmon.analysis.vacuity import Subject
from rvmon.cdv.mutation.python_mutants import third_of
from rvmon.cdv.mutation.python_operators import either_way
from rvmon.cdv.mutation.survivors import Score
from rvmon.cdv.play import Recorded
from rvmon.cdv.system import Checker
from rvmon.language.checked import formula as rv
from rvmon.language.checked.classify import is_pulse
from rvmon.language.checked.specification import CheckedSpec, Requirement
from rvmon.language.print import format_duration, format_formula
from rvmon.logic.formula import horizon
from rvmon.monitor.compiled_spec import CompiledSpec
from rvmon.session import Spec
from rvmon.trace.time import TICKS_PER_UNIT
from rvmon.verdicts import Verdict

_CONNECTIVES = {
    rv.BinaryOp.AND: rv.BinaryOp.OR,
    rv.BinaryOp.OR: rv.BinaryOp.AND,
    rv.BinaryOp.IMPLIES: rv.BinaryOp.AND,
}
_TEMPORAL = either_way(
    (rv.UnaryOp.EVENTUALLY, rv.UnaryOp.ALWAYS),
    (rv.UnaryOp.ONCE, rv.UnaryOp.HISTORICALLY),
)
_EQUALITIES = (rv.CompareOp.EQ, rv.CompareOp.NE)
_BOUNDARIES = either_way(
    (rv.CompareOp.LT, rv.CompareOp.LE),
    (rv.CompareOp.GT, rv.CompareOp.GE),
    _EQUALITIES,
)


def _own_changes(formula: rv.Formula) -> Iterator[tuple[str, rv.Formula]]:
    """The changes of a formula's outermost operator."""
    match formula:
        # LRO, logical operator reference; MCO, missing condition (BOY)
        case rv.Binary(op=op, left=left, right=right):
            if op in _CONNECTIVES:
                yield "connective", structs.replace(formula, op=_CONNECTIVES[op])
                yield "dropped operand", left
                yield "dropped operand", right
            for moved in _bounds_moved(formula):
                yield "bound", moved
        # ENO, expression negation (BOY)
        case rv.Unary(op=rv.UnaryOp.NOT, operand=operand):
            yield "dropped not", operand
        # Changing a guard's constant, or dropping the guard (ALN)
        case rv.Unary(op=op, interval=interval):
            if op in _TEMPORAL:
                yield "temporal operator", structs.replace(formula, op=_TEMPORAL[op])
            for moved in _bounds_moved(formula):
                yield "bound", moved
            if op in _TEMPORAL and interval is not None and interval.high is not None:
                unbounded = structs.replace(formula, interval=rv.Interval(interval.low))
                yield "no deadline", unbounded
        # SNO, simple expression negation (BOY)
        case rv.SignalAtom() | rv.EventAtom() | rv.ProbeAtom():
            yield "negated", rv.Unary(rv.UnaryOp.NOT, formula)
        # RRO, relational operator reference (BOY)
        case rv.Compare(op=op, left=left, right=right):
            is_label = isinstance(right, rv.Literal) and isinstance(right.value, bool | str)
            if not is_label or op in _EQUALITIES:
                yield "comparison", structs.replace(formula, op=_BOUNDARIES[op])
            for number in _moved(right):
                yield "threshold", structs.replace(formula, right=number)
            for number in _moved(left):
                yield "threshold", structs.replace(formula, left=number)


def _moved(numeric: rv.Numeric) -> Iterator[rv.Numeric]:
    match numeric:
        case rv.Literal(value=bool() | str()):
            return
        case rv.Literal(value=int() as value):
            yield replace(numeric, value=value + 1)
            yield replace(numeric, value=value - 1)
        case rv.Literal(value=float() as value):
            step = abs(value) / 10 or 0.1
            yield replace(numeric, value=float(f"{value + step:.12g}"))
            yield replace(numeric, value=float(f"{value - step:.12g}"))


def _bounds_moved(formula: rv.Unary | rv.Binary) -> Iterator[rv.Formula]:
    """Each bound moved up and down by one of the unit in which it is printed, such as 1 s."""
    if formula.interval is None:
        return
    low, high = formula.interval.low, formula.interval.high
    if high is not None:
        for other in (high + _unit(high), high - _unit(high)):
            if other >= low:
                yield structs.replace(formula, interval=rv.Interval(low, other))
    if low:
        for other in (low + _unit(low), low - _unit(low)):
            if high is None or other <= high:
                yield structs.replace(formula, interval=rv.Interval(other, high))


def _unit(ticks: int) -> int:
    return TICKS_PER_UNIT[format_duration(ticks).split()[1]]


def changes(formula: rv.Formula) -> Iterator[tuple[str, rv.Formula]]:
    """All changes of a formula and its parts, each as operator name and changed formula.

    >>> from rvmon.language.print import format_formula
    >>> gone = rv.EventAtom("released")
    >>> within = rv.Unary(rv.UnaryOp.EVENTUALLY, gone, rv.Interval(0, 3 * 10**9))
    >>> [format_formula(changed) for name, changed in changes(within) if name == "bound"]
    ['within 4 s released', 'within 2 s released']
    """
    yield from _own_changes(formula)
    match formula:
        case rv.Unary(operand=operand):
            for name, changed in changes(operand):
                yield name, structs.replace(formula, operand=changed)
        case rv.Amount(of=rv.WindowValue(value=None, operand=operand) as window):
            for name, changed in changes(operand):
                yield name, structs.replace(formula, of=structs.replace(window, operand=changed))
        case rv.Binary(left=left, right=right):
            for name, changed in changes(left):
                yield name, structs.replace(formula, left=changed)
            for name, changed in changes(right):
                yield name, structs.replace(formula, right=changed)


@dataclass(frozen=True, slots=True)
class SpecMutant:
    """One change of one requirement."""

    requirement: Requirement  # the original
    kind: str  # the name of the mutation operator
    ordinal: int  # its number among the changes of this kind to this requirement, from 1
    changed: Requirement

    @property
    def identity(self) -> str:
        """Its name in lists: requirement, kind and ordinal."""
        return f"{self.requirement.id}:{self.kind}:{self.ordinal}".replace(" ", "-")

    @property
    def third(self) -> str:
        """The third to which it belongs, by its identity."""
        return third_of(self.identity)

    @property
    def brief(self) -> str:
        """The change on one line."""
        return f"{self.before} => {self.after}"

    @property
    def before(self) -> str:
        """The original requirement, as text of the language."""
        return _text(self.requirement)

    @property
    def after(self) -> str:
        """The changed requirement, as text of the language."""
        return _text(self.changed)


@dataclass(frozen=True, slots=True)
class SpecTried:
    """A mutant of a requirement, judged on the recorded runs."""

    mutant: SpecMutant
    test: str = ""  # the first test whose recorded run gets another verdict; empty: none
    was: Verdict | None = None  # the original verdict on that run
    now: Verdict | None = None  # the mutant's verdict
    proved: bool = False  # whether it is proved equivalent; only tried if no verdict differs


def spec_scored(tried: Iterable[SpecTried]) -> Score:
    """The score on mutants of requirements."""
    counted = list(tried)
    killed = sum(bool(spec_tried.test) for spec_tried in counted)
    return Score(len(counted), sum(spec_tried.proved for spec_tried in counted), killed, killed, 0)


def spec_mutants(spec: CheckedSpec) -> list[SpecMutant]:
    r"""All mutants of the requirements of a specification, without duplicates.

    >>> from rvmon import loads
    >>> spec = loads("event a, b\nrequirement R upon a then within 3 s b").checked
    >>> [one.after for one in spec_mutants(spec) if one.kind == "no deadline"]
    ['upon a then eventually b']
    """
    return [
        mutant
        for requirement in spec.requirements.values()
        for mutant in _of_requirement(requirement)
    ]


def _of_requirement(requirement: Requirement) -> Iterator[SpecMutant]:
    known = {_text(requirement)}
    ordinals: Counter[str] = Counter()
    for kind, changed in _changed(requirement):
        text = _text(changed)
        ordinals[kind] += 1
        if text not in known:
            known.add(text)
            yield SpecMutant(requirement, kind, ordinals[kind], changed)


def _changed(requirement: Requirement) -> Iterator[tuple[str, Requirement]]:
    if not isinstance(requirement.trigger, rv.BoundAtom):
        for kind, trigger in changes(requirement.trigger):
            yield kind, replace(requirement, trigger=trigger, pulse=is_pulse(trigger))
    for kind, consequent in changes(requirement.consequent):
        yield kind, replace(requirement, consequent=consequent)


def _text(requirement: Requirement) -> str:
    trigger, required = format_formula(requirement.trigger), format_formula(requirement.consequent)
    return f"{requirement.mode} {trigger} then {required}"


def try_spec_mutants(
    spec: Spec, mutants: Sequence[SpecMutant], recorded: Mapping[str, Recorded]
) -> list[SpecTried]:
    """Judge recorded runs by mutants of requirements, to find those with another verdict.

    For each mutant with no such run, the analysis tries to prove that none exists.

    Returns:
        The result of each mutant, in the given order.
    """
    named = {mutant.identity: mutant for mutant in mutants}
    every = structs.replace(
        spec.checked,
        requirements={name: replace(mutant.changed, id=name) for name, mutant in named.items()},
        properties={},
    )
    checker = Checker(Spec(every))
    killed: dict[str, SpecTried] = {}
    for test, run in recorded.items():
        checker.start()
        for t_ns, values in run.samples:
            checker.observe(t_ns, values)
        verdicts = checker.finish(run.run.end_ns).verdicts
        for name, mutant in named.items():
            was = run.verdicts[mutant.requirement.id]
            if verdicts[name] is not was and name not in killed:
                killed[name] = SpecTried(mutant, test, was, verdicts[name])
    together = Together(spec.checked)
    return [
        killed.get(name) or SpecTried(mutant, proved=_is_equivalent(spec.checked, mutant, together))
        for name, mutant in named.items()
    ]


def _is_equivalent(spec: CheckedSpec, mutant: SpecMutant, together: Together) -> bool:
    """Whether it is proved that, with known values, neither can fail where the other passes.

    Both must have a bounded horizon: one that stays open for ever neither passes nor fails.
    """
    pair = {"before": mutant.requirement, "after": mutant.changed}
    named = {name: replace(one, id=name) for name, one in pair.items()}
    compiled = [*CompiledSpec(structs.replace(spec, requirements=named)).requirements.values()]
    if any(horizon(one.obligation.required) is None or one.automaton is None for one in compiled):
        return False
    before, after = (
        Subject(one.requirement, one.obligation.trigger, one.automaton, one.reads)
        for one in compiled
    )
    return all(
        starts_with(together, other, subject)
        and together.can_reach([other, subject], [0, 0], passing=[0], failing=[1]) is False
        for other, subject in ((before, after), (after, before))
    )
