"""Core formulas: negation normal form over propositions, and the factory that interns them.

The future operators are X, U and R. A past operator occurs here only above a future operator;
otherwise it belongs to a proposition (`rvmon.logic.state_formula`).

Formulas are hash-consed: equal formulas are the same object. The factory folds constants and
flattens `and`/`or`, but applies no law that could change the value of a prefix or of a finished
trace: `p or not p` stays (Kleene), and so does `G[0,3] true` (decided when its window closes).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from enum import StrEnum
from itertools import chain
from typing import Any, TypeVar, assert_never

from msgspec import Struct
from msgspec.structs import replace

from rvmon.language.checked.formula import Amount, Compare, Passed, WindowValue
from rvmon.language.checked.formula import Constant as ConstantLeaf
from rvmon.language.checked.formula import Literal as Zero
from rvmon.language.checked.rewrite import without_spans
from rvmon.logic.state_formula import UNKNOWN, Leaf, Lost, State, StateOp


class Sense(StrEnum):
    """The senses in which a literal reads its proposition; they are independent of each other."""

    TRUE = "is true"
    FALSE = "is false"
    KNOWN_FALSE = "is known to be false"
    """Two-valued: for an unknown proposition it is false in both the pessimistic and the optimistic
    run."""


class Constant(Struct, frozen=True, eq=False):
    """True or false."""

    id: int
    value: bool


class Literal(Struct, frozen=True, eq=False):
    """A proposition, read in one sense."""

    id: int
    proposition: State
    sense: Sense


class And(Struct, frozen=True, eq=False):
    """All of its operands; at least two, in order of `id`."""

    id: int
    args: tuple[Core, ...]


class Or(Struct, frozen=True, eq=False):
    """One of its operands; at least two, in order of `id`."""

    id: int
    args: tuple[Core, ...]


class Next(Struct, frozen=True, eq=False):
    """The operand at the next position."""

    id: int
    operand: Core


class Until(Struct, frozen=True, eq=False):
    """`left U[low, high] right`; `opened` is the same with `low` 0, used once the window opens."""

    id: int
    left: Core
    right: Core
    low: int
    high: int | None
    opened: Until | None


class Release(Struct, frozen=True, eq=False):
    """`left R[low, high] right`; `opened` is the same with `low` 0, used once the window opens."""

    id: int
    left: Core
    right: Core
    low: int
    high: int | None
    opened: Release | None


class Since(Struct, frozen=True, eq=False):
    """`left S[low, high] right`; if `dual`, `!(!left S[low, high] !right)`."""

    id: int
    left: Core
    right: Core
    low: int
    high: int | None
    dual: bool


class Previous(Struct, frozen=True, eq=False):
    """The operand at the previous position; at the first position, the constant `first`."""

    id: int
    operand: Core
    first: bool


Temporal = Next | Until | Release
Core = Constant | Literal | And | Or | Next | Until | Release | Since | Previous
N = TypeVar("N", bound=State | Core)
C = TypeVar("C", bound=Core)


def parts_of(node: Core) -> tuple[Core, ...]:
    """The operands of a formula."""
    match node:
        case Constant() | Literal():
            return ()
        case And(args=args) | Or(args=args):
            return args
        case Next(operand=operand) | Previous(operand=operand):
            return (operand,)
        case Until() | Release() | Since():
            return node.left, node.right
        case _:
            assert_never(node)


def nodes_of(formula: Core) -> Iterator[Core]:
    """A formula and its subformulas, each once, starting with the whole."""
    seen = {formula}
    stack = [formula]
    while stack:
        node = stack.pop()
        yield node
        fresh = [part for part in parts_of(node) if part not in seen]
        seen.update(fresh)
        stack += dict.fromkeys(fresh)


def literals(formula: Core) -> Iterator[Literal]:
    """The literals of a formula, each once."""
    return (node for node in nodes_of(formula) if isinstance(node, Literal))


def looks_back(formula: Core) -> bool:
    """Whether a past operator stands above a future one."""
    return any(isinstance(node, Since | Previous) for node in nodes_of(formula))


def horizon(formula: Core) -> int | None:
    """The ticks after the trigger within which an attempt is decided; `None` if unbounded.

    `Next` counts as unbounded: the time to the next position is not known.
    """
    reaches = [horizon(part) for part in parts_of(formula)]
    further = formula.high if isinstance(formula, Until | Release) else 0
    if isinstance(formula, Next) or further is None or None in reaches:
        return None
    return further + max((reach for reach in reaches if reach is not None), default=0)


class Factory:
    """The formulas of one specification; ids count from 0, operands before operators."""

    def __init__(self) -> None:
        self._known: dict[tuple[Any, ...], Any] = {}
        self._count = 0
        self.true = self._core(Constant, True)
        self.false = self._core(Constant, False)
        self.state_true = self.leaf(ConstantLeaf(True))
        self.state_false = self.leaf(ConstantLeaf(False))
        self.unknown = self.leaf(Lost())

    def _next_id(self) -> int:
        self._count += 1
        return self._count - 1

    # State formulas.

    def _state(
        self, op: StateOp, args: tuple[State, ...] = (), leaf: Leaf | None = None, **fields: Any
    ) -> State:
        key = (op, args, leaf, *fields.items())
        found: State | None = self._known.get(key)
        if found is None:
            found = self._known[key] = State(self._next_id(), op, args, leaf, **fields)
        return found

    def leaf(self, leaf: Leaf, unborn: int = UNKNOWN) -> State:
        """An atom over the input; `unborn` is its truth value before the birth of its signals."""
        return self._state(StateOp.LEAF, leaf=leaf, unborn=unborn)

    def negation(self, arg: State) -> State:
        """Not `arg`; double negation is dropped."""
        if arg is self.state_true:
            return self.state_false
        if arg is self.state_false:
            return self.state_true
        return arg.args[0] if arg.op is StateOp.NOT else self._state(StateOp.NOT, (arg,))

    def state_all(self, args: Iterable[State]) -> State:
        """All of `args`."""
        return self._lattice(StateOp.AND, args, self.state_true, self.state_false)

    def state_any(self, args: Iterable[State]) -> State:
        """One of `args`."""
        return self._lattice(StateOp.OR, args, self.state_false, self.state_true)

    def _lattice(self, op: StateOp, args: Iterable[State], unit: State, zero: State) -> State:
        parts = (arg.args if arg.op is op else (arg,) for arg in args)
        first, *more = found = _operands(parts, unit, zero)
        return self._state(op, tuple(found)) if more else first

    def previous(self, arg: State) -> State:
        """`arg` at the previous position; false at the first."""
        return self._state(StateOp.PREVIOUS, (arg,))

    def since(self, left: State, right: State, low: int, high: int | None) -> State:
        """`left S[low, high] right`."""
        return self._state(StateOp.SINCE, (left, right), low=low, high=high)

    def amount(self, amount: Amount, *args: State) -> State:
        """A measured window compared with a limit; `args` are its operands, members first.

        A window with constant members is not folded, because an outage still makes it unknown.
        """
        own = replace(amount, of=self._emptied(amount.of, args), known=None, span=None)
        return self._state(StateOp.AMOUNT, args, amount=without_spans(own))

    def window(self, window: WindowValue, *args: State) -> State:
        """The numeric value of a window; as a state it is TRUE where the value is known."""
        return self._state(StateOp.AMOUNT, args, amount=window)

    def _emptied(self, window: WindowValue, args: Sequence[State]) -> WindowValue:
        """A window with its operand formulas blanked: they are `args`, and must not split keys."""
        own = replace(window, operand=ConstantLeaf(True))
        if own.counted is not None:
            own = replace(own, counted=ConstantLeaf(True))
        if args[0] is self.state_false and own.value is not None:
            own = replace(own, value=Zero(0))  # a window without members never reads its value
        return own

    def compared(self, compared: Compare, *args: State) -> State:
        """A comparison between windows; `args` holds the windows and the other sides' `known`."""
        return self._state(StateOp.COMPARED, args, compared=compared)

    def passed(self, passed: Passed, known: State) -> State:
        """Time passed since an instant, compared with a duration; unknown where `known` is."""
        own = replace(passed, span=None, known=replace(passed.known, span=None))
        return self._state(StateOp.PASSED, (known,), passed=own)

    def sure(self, arg: State) -> State:
        """Two-valued: `arg` is TRUE."""
        if arg in (self.state_true, self.state_false) or arg.op is StateOp.SURE:
            return arg
        return self._state(StateOp.SURE, (arg,))

    def doubt(self, arg: State, *, pulse: bool, every: bool) -> State:
        """Whether a trigger may have been hidden; see `StateOp.DOUBT`."""
        return self._state(StateOp.DOUBT, (arg,), pulse=pulse, every=every)

    # Core formulas.

    def _core(self, kind: Callable[..., C], *fields: Any) -> C:
        key = (kind, *fields)
        found: C | None = self._known.get(key)
        if found is None:
            found = self._known[key] = kind(self._next_id(), *fields)
        return found

    def constant(self, value: bool) -> Constant:
        """True or false."""
        return self.true if value else self.false

    def literal(self, proposition: State, sense: Sense) -> Core:
        """A proposition read in one sense; negations move into the sense."""
        if proposition is self.state_true:
            return self.constant(sense is Sense.TRUE)
        if proposition is self.state_false:
            return self.constant(sense is not Sense.TRUE)
        if proposition.op is StateOp.NOT and sense is not Sense.KNOWN_FALSE:
            flipped = Sense.FALSE if sense is Sense.TRUE else Sense.TRUE
            return self.literal(proposition.args[0], flipped)
        return self._core(Literal, proposition, sense)

    def all_of(self, args: Iterable[Core]) -> Core:
        """All of `args`."""
        return self._junction(And, args, self.true, self.false)

    def any_of(self, args: Iterable[Core]) -> Core:
        """One of `args`."""
        return self._junction(Or, args, self.false, self.true)

    def _junction(self, kind: type[And | Or], args: Iterable[Core], unit: Core, zero: Core) -> Core:
        parts = (arg.args if isinstance(arg, kind) else (arg,) for arg in args)
        first, *more = found = _operands(parts, unit, zero)
        return self._core(kind, tuple(found)) if more else first

    def next(self, operand: Core) -> Next:
        """`operand` at the next position, undecided until there is one."""
        return self._core(Next, operand)

    def until(self, left: Core, right: Core, low: int, high: int | None) -> Core:
        """`left U[low, high] right`, or an equal simpler formula."""
        if left is self.false:
            return right if low == 0 else self.false
        if right is self.true and low == 0:
            return right
        opened = self._core(Until, left, right, 0, high, None) if low else None
        return self._core(Until, left, right, low, high, opened)

    def release(self, left: Core, right: Core, low: int, high: int | None) -> Core:
        """`left R[low, high] right`, or an equal simpler formula."""
        if left is self.true:
            return right if low == 0 else self.true
        if right is self.false and low == 0:
            return right
        opened = self._core(Release, left, right, 0, high, None) if low else None
        return self._core(Release, left, right, low, high, opened)

    def core_since(
        self, left: Core, right: Core, low: int, high: int | None, *, dual: bool
    ) -> Core:
        """`left S[low, high] right`, or its dual, with a future operator in an operand."""
        return self._core(Since, left, right, low, high, dual)

    def core_previous(self, operand: Core, *, first: bool) -> Core:
        """`operand` at the position before; at the first position, the constant `first`."""
        return self._core(Previous, operand, first)

    def rebuilt(self, node: Core, of: Callable[[Core], Core], *, positive: bool = True) -> Core:
        """A formula, or its dual, with its operands mapped by `of`; not for literals."""
        match node:
            case Constant(value=value):
                return self.constant(value is positive)
            case And(args=args) | Or(args=args):
                join = self.all_of if isinstance(node, And) is positive else self.any_of
                return join(map(of, args))
            case Next(operand=operand):
                return self.next(of(operand))
            case Previous(operand=operand, first=first):
                return self.core_previous(of(operand), first=first is positive)
            case Until(left=left, right=right) | Release(left=left, right=right):
                make = self.until if isinstance(node, Until) is positive else self.release
                return make(of(left), of(right), node.low, node.high)
            case Since(left=left, right=right, low=low, high=high, dual=dual):
                return self.core_since(of(left), of(right), low, high, dual=dual is positive)
            case Literal():
                raise AssertionError("a literal is read by whoever rebuilds")
            case _:
                assert_never(node)


def _operands(parts: Iterable[Sequence[N]], unit: N, zero: N) -> list[N]:
    """The operands of a lattice operator, flattened, each once, in order of `id`; at least one."""
    flat = dict.fromkeys(chain.from_iterable(parts))
    flat.pop(unit, None)
    return [zero] if zero in flat else sorted(flat, key=lambda node: node.id) or [unit]
