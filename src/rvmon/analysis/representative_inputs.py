"""Chooses representative samples: values of the inputs that formulas can distinguish.

For a comparison these are values at, between and beyond the points where both sides are equal.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from enum import Enum
from itertools import combinations, islice, pairwise, product
from typing import TypeVar, assert_never

from msgspec import Struct, structs

from rvmon.language.checked.formula import (
    Arithmetic,
    Captured,
    Compare,
    CompareOp,
    EventAtom,
    FieldValue,
    Literal,
    Measured,
    NowValue,
    Numeric,
    Probe,
    ProbeAtom,
    SignalAtom,
    SignalValue,
    UpdateValue,
    WindowValue,
    itself,
    windows_in,
)
from rvmon.language.checked.names_read import names_read
from rvmon.language.checked.specification import CheckedSpec, Type
from rvmon.logic.formula import Factory, Sense
from rvmon.logic.state_formula import FALSE, TRUE, UNKNOWN, Leaf, operands
from rvmon.logic.state_graph import captured_names, names_of
from rvmon.monitor.formula_truths import Known, known_truths
from rvmon.trace.sample import Sample, Scalar, Value, calculated
from rvmon.trace.schema import Kind
from rvmon.trace.time import TICKS_PER_SECOND

Variable = SignalValue | FieldValue

LARGEST = 1e15  # roots of greater magnitude are dismissed as artefacts of rounding


def turning_values(
    variable: Variable, comparisons: Iterable[Compare], *, whole: bool
) -> list[float]:
    """Values at, between and beyond the values at which comparisons change, greatest first.

    Args:
        variable: a signal or field; other variables of a comparison are set to 0.
        comparisons: the comparisons; those that do not read the variable are ignored.
        whole: whether its values are integers.

    >>> from rvmon.language.checked.formula import CompareOp
    >>> limit = Compare(CompareOp.LT, SignalValue("x"), Literal(0.5, "m"))
    >>> turning_values(SignalValue("x"), [limit], whole=False)
    [0.6, 0.5, 0.4]
    """
    roots = {
        root for leaf in comparisons if _reads(leaf, variable) for root in _turning(leaf, variable)
    }
    if whole:
        near = {round(root) for root in roots}
        return sorted({n + d for n in near for d in (-1, 0, 1)} or {0, 1}, reverse=True)
    ordered = sorted(roots)
    if not ordered:
        return [0.0, 1.0]
    between = [(low + high) / 2 for low, high in pairwise(ordered)]
    outer = [ordered[0] - _stride(ordered[0]), ordered[-1] + _stride(ordered[-1])]
    return sorted({_tidy(value) for value in (*ordered, *between, *outer)}, reverse=True)


def is_solved(comparison: Compare) -> bool:
    """Whether `turning_values` of its only variable certainly cause all its truth values."""
    sides = {type(comparison.left), type(comparison.right)}
    return Literal in sides and not sides.isdisjoint((SignalValue, FieldValue))


def _stride(value: float) -> float:
    """A visible step away from a value: between a tenth of the value and the value itself."""
    return 1.0 if value == 0 else 10.0 ** math.floor(math.log10(abs(value)))


def _tidy(value: float) -> float:
    return float(f"{value:.12g}")


def _reads(leaf: Compare, variable: Variable) -> bool:
    return any(
        _is(part, variable) or (isinstance(part, WindowValue) and _adds(part, variable))
        for part in operands(leaf.left, leaf.right)
    )


def _is(part: Numeric, variable: Variable | WindowValue) -> bool:
    """Whether a part reads the variable; a function of the updates of a signal reads the signal."""
    if isinstance(part, UpdateValue) and isinstance(variable, SignalValue):
        return part.name == variable.name
    return part == variable


def _adds(window: WindowValue, variable: Variable) -> bool:
    return window.value is not None and _reads(itself(window.value), variable)


def _turning(leaf: Compare, variable: Variable) -> Iterator[float]:
    """The values at which a comparison changes; in a window, all members have the value."""
    yield from _roots(leaf, variable)
    for window in windows_in(leaf.left, leaf.right):
        if window.value is not None and _adds(window, variable):
            for root in _roots(leaf, window):
                full = Compare(CompareOp.EQ, window.value, Literal(_full(window, root)))
                yield from _roots(full, variable)


def _full(window: WindowValue, comes_to: float) -> float:
    """The value of all members of a window with a given result; for a variance, of every second."""
    if window.measured.of_time:
        return comes_to * TICKS_PER_SECOND / (window.window or TICKS_PER_SECOND)
    return 2 * abs(comes_to) ** 0.5 if window.measured is Measured.VARIANCE else comes_to


def _roots(leaf: Compare, variable: Variable | WindowValue) -> Iterator[float]:
    """The values at which both sides are equal; exact if they are linear below and above 0."""
    for first, second in ((1.0, 2.0), (-1.0, -2.0)):
        one, two = _difference(leaf, variable, first), _difference(leaf, variable, second)
        if one is None or two is None or one == two:
            continue
        root = first - one * (second - first) / (two - one)
        if math.isfinite(root) and abs(root) < LARGEST:
            yield _tidy(root)


def _difference(leaf: Compare, variable: Variable | WindowValue, value: float) -> float | None:
    left, right = (_with(side, variable, value) for side in (leaf.left, leaf.right))
    if isinstance(left, int | float) and isinstance(right, int | float):
        return float(left) - float(right)
    return None


def _with(numeric: Numeric, variable: Variable | WindowValue, value: float) -> Scalar:
    """The value of an expression with the variable at `value` and all others at 0."""
    match numeric:
        case Literal(value=constant):
            return constant
        case SignalValue() | FieldValue() | UpdateValue() | Captured() | NowValue() | WindowValue():
            return value if _is(numeric, variable) else 0.0
        case Arithmetic(op=op, args=args):
            return calculated(op.entry.apply, *(_with(arg, variable, value) for arg in args))
        case _:
            assert_never(numeric)


def truths_tried(
    spec: CheckedSpec, leaves: Sequence[Leaf], tried: Sequence[Mapping[str, Value]]
) -> list[tuple[int, ...]]:
    r"""The truth value of each leaf, for each valuation of `tried`.

    Leaves must read present values only, and each valuation must have all names that they read.

    Cost: one pass in C.

    >>> from rvmon import loads
    >>> from rvmon.language.checked.formula import SignalAtom
    >>> spec = loads("signal p : bool\nrequirement R\n always p").checked
    >>> truths_tried(spec, [SignalAtom("p")], [{"p": True}, {"p": None}, {"p": False}])
    [(2,), (1,), (0,)]
    """
    if not leaves or not tried:
        return [()] * len(tried)
    names = frozenset().union(*map(names_of, leaves))
    spec = structs.replace(  # a plan includes all names of its specification, even if not read
        spec,
        signals={name: one for name, one in spec.signals.items() if name in names},
        events={name: one for name, one in spec.events.items() if name in names},
    )
    factory = Factory()
    cores = [factory.literal(factory.leaf(leaf), Sense.TRUE) for leaf in leaves]
    # One position per valuation: a sample each, at consecutive ticks or periods.
    gap = spec.gap or 1
    samples = [Sample(place * gap, values) for place, values in enumerate(tried)]
    known_by_leaf = known_truths(spec, cores, samples, samples[-1].t)
    columns = [_column(known, len(tried)) for known in known_by_leaf]
    return list(zip(*columns, strict=True))


def _column(known: Known, count: int) -> list[int]:
    """The truth value at each of the first `count` positions."""
    column = [UNKNOWN] * count
    for truth, ranges in (TRUE, known.true), (FALSE, known.false):
        for first, last in ranges.tolist():
            for place in range(max(first, 0), min(last, count - 1) + 1):
                column[place] = truth
    return column


MOST_VALUATIONS = 240
"""The most valuations kept; those with the fewest or the most departures come first."""

MOST_TRIED = 20 * MOST_VALUATIONS
MOST_PAYLOADS = 24  # the most payloads tried for an event with several fields


class Silence(Enum):
    """The marker of a name that a sample does not update."""

    SILENT = "silent"


T = TypeVar("T")
SILENT = Silence.SILENT
Valuation = Mapping[str, Value | Silence]
"""The value of each read name in a sample; `False` for an event that does not occur."""


class Choices(Struct, frozen=True):
    """The samples to choose from at each instant."""

    names: tuple[str, ...]  # the signals and events that are read
    # each two are distinguished by some formula; ordered as by `_defaults_first`
    valuations: tuple[Valuation, ...]
    remembered: frozenset[str]  # the signals whose updates matter, not only their values
    complete: bool  # whether no combination was left out


def choices_of(
    spec: CheckedSpec,
    leaves: Sequence[Leaf],
    read: Collection[str],
    captured: Sequence[Numeric] = (),
    windows: Sequence[Compare] = (),
) -> Choices:
    """The samples worth trying; they are never complete if there are comparisons of `windows`."""
    names = tuple(name for name in (*spec.signals, *spec.events) if name in read)
    remembered = frozenset(_remembered(spec, leaves)) & spec.signals.keys() & {*names}
    options = _Options(spec, leaves, captured, remembered, windows)
    added = {name for window in windows for name in names_read(window) if name in read}
    seen = _Keys(spec, leaves, remembered | added)
    kept: dict[tuple[object, ...], Valuation] = {}
    waiting = _defaults_first([options.of(name) for name in names])
    for _ in range(MOST_TRIED // MOST_VALUATIONS):
        tried = [
            dict(zip(names, chosen, strict=True)) for chosen in islice(waiting, MOST_VALUATIONS)
        ]
        for key, valuation in zip(seen.keys(tried), tried, strict=True):
            if key not in kept and len(kept) == MOST_VALUATIONS:
                return Choices(names, tuple(kept.values()), remembered, False)
            kept.setdefault(key, valuation)
    complete = next(waiting, None) is None and not windows
    return Choices(names, tuple(kept.values()), remembered, complete)


def values_of(spec: CheckedSpec, leaves: Sequence[Leaf], name: str) -> list[Value | Silence]:
    """The values of a name that some leaf distinguishes; `False`: an event does not occur."""
    return _Options(spec, leaves, (), frozenset()).of(name)


def _remembered(spec: CheckedSpec, leaves: Iterable[Leaf]) -> Iterator[str]:
    """The names whose updates matter, not only their values."""
    yield from (name for name, signal in spec.signals.items() if signal.stale_after is not None)
    for leaf in leaves:
        if isinstance(leaf, ProbeAtom) and leaf.probe is not Probe.KNOWN:
            yield leaf.name
        elif isinstance(leaf, Compare):
            parts = operands(leaf.left, leaf.right)
            yield from (part.name for part in parts if isinstance(part, UpdateValue))


class _Options:
    """The values to try for a name; the default comes first."""

    def __init__(
        self,
        spec: CheckedSpec,
        leaves: Sequence[Leaf],
        captured: Sequence[Numeric],
        remembered: frozenset[str],
        windows: Sequence[Compare] = (),
    ) -> None:
        self.spec = spec
        self.leaves = leaves
        self.remembered = remembered
        self.compared = [leaf for leaf in leaves if isinstance(leaf, Compare)] + [*windows]
        # A comparison with a captured value changes where the captured expression equals the other
        # side, so the expression is put in the place of the value.
        self.compared += [
            Compare(leaf.op, numeric, leaf.right) for leaf in self.compared for numeric in captured
        ]

    def of(self, name: str) -> list[Value | Silence]:
        """The options of a name."""
        if name in self.spec.events:
            return [False, *self._payloads(name)]
        values: list[Value | Silence] = [
            *self._scalars(SignalValue(name), self.spec.signals[name].type)
        ]
        if ProbeAtom(Probe.KNOWN, name) in self.leaves and name not in self.spec.ignoring:
            values.append(None)
        return [SILENT, *values] if name in self.remembered else values

    def _payloads(self, event: str) -> list[Value]:
        fields = self.spec.events[event].fields
        values = [self._scalars(FieldValue(event, name), fields[name]) for name in fields]
        most = MOST_PAYLOADS if len(fields) > 1 else None
        chosen = islice(_defaults_first(values), most)
        return [dict(zip(fields, one, strict=True)) or True for one in chosen]

    def _scalars(self, variable: Variable, type_: Type) -> Sequence[Scalar]:
        match type_.kind:
            case Kind.BOOL:
                return [False, True]
            case Kind.LABEL:
                return self._labels(variable, type_.labels)
            case Kind.INT | Kind.REAL:
                return turning_values(variable, self.compared, whole=type_.kind is Kind.INT)
            case _:
                assert_never(type_.kind)

    def _labels(self, variable: Variable, labels: Sequence[str]) -> list[str]:
        """One label that no comparison names, then the named ones; all if signals are compared."""
        sides = [
            (leaf.left, leaf.right) for leaf in self.compared if variable in (leaf.left, leaf.right)
        ]
        if any(
            not isinstance(side, Literal) and side != variable for pair in sides for side in pair
        ):
            return list(labels)
        named = {side.value for pair in sides for side in pair if isinstance(side, Literal)}
        rest = [label for label in labels if label not in named]
        return [*rest[:1], *(label for label in labels if label in named)]


def _defaults_first(options: Sequence[Sequence[T]]) -> Iterator[tuple[T, ...]]:
    """All combinations, ordered by departures from the first options: 0, n, 1, n − 1 and so on."""
    low, high = 0, len(options)
    while low <= high:
        yield from _departing(options, low)
        if high > low:
            yield from _departing(options, high)
        low, high = low + 1, high - 1


def _departing(options: Sequence[Sequence[T]], count: int) -> Iterator[tuple[T, ...]]:
    """The combinations in which exactly `count` entries are not the first option."""
    for places in combinations(range(len(options)), count):
        yield from product(
            *(
                choices[1:] if place in places else choices[:1]
                for place, choices in enumerate(options)
            )
        )


class _Keys:
    """Makes keys of valuations: equal for valuations that no formula distinguishes."""

    def __init__(
        self, spec: CheckedSpec, leaves: Iterable[Leaf], remembered: frozenset[str]
    ) -> None:
        self.spec = spec
        self.plain: list[Leaf] = []
        self.raw: set[str] = set(remembered)
        for leaf in leaves:
            names = names_of(leaf)
            if captured_names(leaf) or names & remembered or isinstance(leaf, ProbeAtom):
                self.raw |= names
            elif isinstance(leaf, SignalAtom | EventAtom | Compare):
                self.plain.append(leaf)

    def keys(self, valuations: Sequence[Valuation]) -> Iterator[tuple[object, ...]]:
        """The keys of valuations, in order."""
        spoken = [
            {name: value for name, value in valuation.items() if not isinstance(value, Silence)}
            for valuation in valuations
        ]
        truths = truths_tried(self.spec, self.plain, spoken)
        for leaf_truths, valuation in zip(truths, valuations, strict=True):
            raw = (_hashable(value) for name, value in valuation.items() if name in self.raw)
            yield (*leaf_truths, *raw)


def _hashable(value: Value | Silence) -> object:
    return tuple(value.items()) if isinstance(value, Mapping) else value
