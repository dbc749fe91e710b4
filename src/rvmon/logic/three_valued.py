"""Translates formulas of the present and past from four truth values to three.

Before its signals are born a proposition has a fourth value, unborn. No monitor represents it: the
context of a formula fixes the value that replaces unborn, and the formula is rewritten for it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rvmon.language.checked import formula as rv
from rvmon.language.checked.operators import Reading, Tense
from rvmon.language.checked.rewrite import read, rewritten, without_spans
from rvmon.logic import state_formula as sf
from rvmon.logic.formula import Factory
from rvmon.logic.four_valued import Four


class Reader(Reading[Four]):
    """Translates formulas of the present and past to state formulas.

    Args:
        factory: makes the state formulas.
        period: the D of `sampled every D`, ticks; past intervals are cut to its multiples.
        measured: whether the result must preserve the robustness of the formula, not only its
            truth value; that takes larger formulas.
        held: whether every tick is a position.

    Source: SEMANTICS, sections 1 (Birth) and 2; decision record 4.
    """

    def __init__(
        self, factory: Factory, period: int | None, *, measured: bool = False, held: bool = False
    ) -> None:
        self.factory = factory
        self.period = period
        self.measured = measured
        self.held = held
        self._truth_reader = Reader(factory, period) if measured else self
        self._literals: dict[tuple[int, int], tuple[rv.Formula, sf.State]] = {}

    def literal(self, formula: rv.Formula, unborn: int) -> sf.State:
        """The state formula with each unborn proposition replaced by `unborn`.

        A proposition is an atom or a past operator with its operands. It is each proposition that
        is replaced, not the value of the whole formula.
        """
        key = id(formula), unborn
        if key not in self._literals:  # rewriting `<->` duplicates its operands
            self._literals[key] = formula, self._literal(formula, unborn)
        return self._literals[key][1]

    def _literal(self, formula: rv.Formula, unborn: int) -> sf.State:
        factory = self.factory
        match formula:
            case rv.Unary(op=rv.UnaryOp.NOT, operand=operand):
                # Under a negation the opposite value counts in favour.
                return factory.negation(self.literal(operand, sf.TRUE - unborn))
            case rv.Binary(op=rv.BinaryOp.AND | rv.BinaryOp.OR as op, left=left, right=right):
                join = factory.state_all if op is rv.BinaryOp.AND else factory.state_any
                return join([self.literal(left, unborn), self.literal(right, unborn)])
            case rv.Binary(op=op) if op.entry.tense is Tense.PRESENT:
                return self.literal(rewritten(formula), unborn)
            case _:
                return self.four(formula).read(unborn)

    def four(self, formula: rv.Formula) -> Four:
        """The four-valued reading of a formula."""
        match formula:
            # Rewriting these would lose the birth at the previous position, or of the window.
            case rv.Unary(op=rv.UnaryOp.RISE, operand=operand):
                arg = self.four(operand)
                return self._all([arg, self.no(self._before(arg))])
            case rv.Unary(op=rv.UnaryOp.FALL, operand=operand):
                arg = self.four(operand)
                return self._all([self.no(arg), self._before(arg)])
            case rv.Unary(op=rv.UnaryOp.HELD, operand=operand, interval=interval):
                return self._held(self.four(operand), self._truth_reader.four(operand), interval)
            case rv.Unary() | rv.Binary():
                return read(formula, self.four, self)
            case rv.Amount() if self.measured and formula.has_distance(held=self.held):
                return self._compared(formula.comparison)
            case rv.Amount():
                return self._amount(formula)
            case rv.Compare(left=left, right=right) if rv.windows_in(left, right):
                return self._compared(formula)
            case rv.Passed(known=known):
                value = self.factory.passed(formula, self.four(known).read(sf.UNKNOWN))
                return self._unborn_until(value, (self._unborn(known),))
            case rv.Constant(value=value):
                return self.constant(value)
            case _:
                return self._atom(formula)

    def _amount(self, formula: rv.Amount) -> Four:
        """A window against a limit: unborn members add nothing; unborn until the limit is born."""
        states = [
            self._truth_reader.four(part).read(sf.UNKNOWN if part is formula.known else sf.FALSE)
            for part in formula.operands
        ]
        value = self.factory.amount(formula, *states)
        return self._unborn_until(value, map(self._unborn, formula.born_with))

    def _compared(self, formula: rv.Compare) -> Four:
        """A comparison of windows: unknown where a side has no known number."""
        factory, leaf = self.factory, without_spans(formula)
        parts = sf.operands(leaf.left, leaf.right)
        known = [rv.itself(part) for part in parts if isinstance(part, rv.Read)]
        states = [self.four(comparison).read(sf.UNKNOWN) for comparison in known]
        parts_unborn = [*map(self._unborn, known)]
        for window in rv.windows_in(leaf.left, leaf.right):
            own = (self._truth_reader.four(part).read(sf.FALSE) for part in window.operands)
            states.append(factory.window(window, *own))
            for unborn in map(self._unborn, window.born_with):
                if window.measured is rv.Measured.AGO:  # the birth must lie that far back
                    ago, born = window.window or 0, factory.negation(unborn)
                    early = factory.since(factory.state_true, born, ago, ago)
                    unborn = factory.negation(early)
                parts_unborn.append(unborn)
        return self._unborn_until(factory.compared(leaf, *dict.fromkeys(states)), parts_unborn)

    def _unborn(self, part: rv.SignalAtom | rv.Compare) -> sf.State:
        """Two-valued: some signal that `part` reads is unborn."""
        if isinstance(part, rv.Compare) and rv.windows_in(part.left, part.right):
            return self._compared(part).unborn
        signals = tuple(sorted(sf.signals_of(part).items()))
        return self.factory.leaf(sf.Unborn(signals)) if signals else self.factory.state_false

    def _unborn_until(self, value: sf.State, parts_unborn: Iterable[sf.State]) -> Four:
        """A value that is unborn while any of `parts_unborn`, each two-valued, is true."""
        factory = self.factory
        unborn = self._some_unborn(parts_unborn)
        if unborn is factory.state_false:
            return self._always_born(value)

        def read(reading: int) -> sf.State:
            if reading == sf.UNKNOWN:
                return value
            if reading == sf.TRUE:
                return factory.state_any([value, unborn])
            return factory.state_all([value, factory.negation(unborn)])

        return Four(factory, read, stays_born=True, unborn=unborn)

    def _atom(self, atom: rv.Atom) -> Four:
        factory = self.factory
        leaf = without_spans(atom)
        if not isinstance(leaf, rv.SignalAtom | rv.Compare) or not sf.signals_of(leaf):
            return self._always_born(factory.leaf(leaf))
        unborn = None if sf.reads_fields(leaf) else self._unborn(leaf)
        return Four(
            factory,
            lambda reading: factory.leaf(leaf, reading),
            stays_born=unborn is not None,
            unborn=unborn,
        )

    # The primitive operators of `Reading`; the others are rewritten to them.

    def constant(self, value: bool) -> Four:
        """A constant."""
        return self._always_born(self.factory.state_true if value else self.factory.state_false)

    def _always_born(self, state: sf.State) -> Four:
        return Four(self.factory, lambda _: state, born_late=False)

    def no(self, arg: Four) -> Four:
        """Negation: unborn where its operand is."""
        if arg.negated is not None:
            return arg.negated
        negation = self.factory.negation
        made = Four(
            self.factory, lambda unborn: negation(arg.read(sf.TRUE - unborn)),
            born_late=arg.born_late, stays_born=arg.stays_born, unborn=arg._unborn,
        )  # fmt: skip
        made.negated = arg
        return made

    def both(self, left: Four, right: Four) -> Four:
        """Conjunction: unborn where an operand is, and none is false or unknown."""
        return self._all([left, right])

    def until(self, *_: object) -> Four:
        """Unreachable: formulas here have no future operators."""
        raise AssertionError("future operators were sorted out")

    next = until

    def _all(self, args: Sequence[Four]) -> Four:
        factory = self.factory
        args = [part for arg in args for part in arg.parts]
        # Unborn and unknown is unknown: lost input is not excused by a signal yet to be born.
        unborn = self._some_unborn(arg.unborn for arg in args)

        def read(reading: int) -> sf.State:
            joined = factory.state_all([arg.read(reading or sf.TRUE) for arg in args])
            if reading == sf.FALSE and self.measured:
                return self._measured(args, joined, unborn)
            if reading != sf.FALSE or unborn is factory.state_false:
                return joined
            born_or_not_true = [factory.negation(unborn), factory.negation(joined)]
            return factory.state_all([joined, factory.state_any(born_or_not_true)])

        return Four(factory, read, born_late=any(arg.born_late for arg in args), parts=args)

    def _measured(self, args: Sequence[Four], joined: sf.State, unborn: sf.State) -> sf.State:
        """A conjunction, FALSE where an operand is unborn, with its robustness preserved.

        `joined` is the conjunction with unborn replaced by TRUE; `unborn` is TRUE where some
        operand is unborn.
        """
        factory = self.factory
        lost = factory.state_all([joined, factory.negation(joined)])
        born = factory.state_any([factory.negation(unborn), lost])
        return factory.state_all([*(arg.read(sf.UNKNOWN) for arg in args), born])

    def _some_unborn(self, unborn: Iterable[sf.State]) -> sf.State:
        """Two-valued: some of `unborn` is true; all `Unborn` leaves are merged into one."""
        factory = self.factory
        states, signals = [], dict[str, bool]()
        for state in unborn:
            if isinstance(state.leaf, sf.Unborn):
                for name, moved in state.leaf.signals:
                    signals[name] = signals.get(name, False) or moved
            else:
                states.append(state)
        if signals:
            states.append(factory.leaf(sf.Unborn(tuple(sorted(signals.items())))))
        return factory.state_any(states)

    def since(self, left: Four, right: Four, interval: rv.Interval) -> Four:
        """`since`, which skips positions where an operand is unborn."""
        factory = self.factory
        low, high = self._window(interval)
        if high is not None and low > high:
            return self.constant(False)
        value = factory.since(left.read(sf.TRUE), right.read(sf.FALSE), low, high)
        if low > 0 or right.born_late:
            value = self._or_lost(value, left, right, low, high)
        if not right.born_late:
            return self._always_born(value)
        # If the operand stays born once it is, the present position tells. Otherwise each position
        # of the window has to be tested.
        if right.stays_born and low == 0:
            # `sure` is needed because an outage before the first sample may hide the birth.
            unborn = factory.state_all([right.unborn, factory.sure(factory.negation(value))])
        else:
            born = factory.since(factory.state_true, factory.negation(right.unborn), low, high)
            some = factory.since(factory.state_true, factory.state_true, low, high)
            unborn = factory.state_all([factory.negation(born), some])
        return self._unborn_where(value, unborn)

    def _or_lost(
        self, value: sf.State, left: Four, right: Four, low: int, high: int | None
    ) -> sf.State:
        """`value`, but unknown where the right side is born yet nowhere known in the window.

        There a false left side does not make `since` false: the lost positions may have been
        unborn, and unborn positions are skipped.
        """
        factory = self.factory
        if left.read(sf.TRUE) is factory.state_true:
            return value

        def once(state: sf.State) -> sf.State:
            return factory.since(factory.state_true, state, low, high)

        is_false = factory.negation(right.read(sf.TRUE))
        known = factory.state_any([factory.sure(right.read(sf.FALSE)), factory.sure(is_false)])
        never = factory.negation(once(known))
        lost = factory.state_all([never, once(factory.negation(right.unborn))])
        return factory.state_any([value, self._at_most_unknown(lost)])

    def _at_most_unknown(self, state: sf.State) -> sf.State:
        """UNKNOWN where `state` is not FALSE, without its robustness, which would span outages."""
        factory = self.factory
        if self.measured:
            state = factory.negation(factory.sure(factory.negation(state)))
        return factory.state_all([state, factory.unknown])

    def _unborn_where(self, value: sf.State, unborn: sf.State) -> Four:
        """The formula that is unborn where `unborn` is TRUE; `value` must be FALSE there."""
        factory = self.factory

        def read(reading: int) -> sf.State:
            if reading == sf.FALSE:
                return value
            there = unborn if reading == sf.TRUE else factory.state_all([unborn, factory.unknown])
            return factory.state_any([value, there])

        return Four(factory, read, unborn=unborn)

    def previous(self, arg: Four) -> Four:
        """`previous` is unborn where its operand was."""
        factory = self.factory
        value = factory.previous(arg.read(sf.FALSE))
        if not arg.born_late:
            return self._always_born(value)
        return self._unborn_where(value, factory.previous(arg.unborn))

    def _before(self, arg: Four) -> Four:
        """The value at the previous position; FALSE if unborn there, or if there is none."""
        return self._always_born(self.previous(arg).read(sf.FALSE))

    def _held(self, arg: Four, truth: Four, interval: rv.Interval | None) -> Four:
        """`held` is unborn unless its operand was born throughout."""
        factory = self.factory
        elapsed = factory.leaf(sf.Elapsed(interval.high if interval and interval.high else 0))
        value = factory.state_all([self._historically(arg.read(sf.FALSE), interval), elapsed])
        missing = self._historically(truth.missing, interval)
        if not arg.born_late:
            lost = factory.state_all([missing, factory.negation(missing)])
            return self._always_born(factory.state_any([value, lost]))

        def read(unborn: int) -> sf.State:
            if unborn == sf.TRUE:
                return factory.state_any([value, missing])
            other = factory.unknown if unborn == sf.UNKNOWN else factory.negation(missing)
            return factory.state_any([value, factory.state_all([missing, other])])

        return Four(factory, read)

    def _historically(self, arg: sf.State, interval: rv.Interval | None) -> sf.State:
        factory = self.factory
        low, high = self._window(interval)
        if high is not None and low > high:
            return factory.state_true
        return factory.negation(factory.since(factory.state_true, factory.negation(arg), low, high))

    def _window(self, interval: rv.Interval | None) -> tuple[int, int | None]:
        low, high = (interval.low, interval.high) if interval else (0, None)
        if self.period:
            low = -(-low // self.period) * self.period
            high = None if high is None else high // self.period * self.period
        return low, high
