"""The core against the semantics computed on arrays, on traces too long for the oracle.

Random formulas with windows of up to some hundred ticks are required from the start or upon a
signal, in held and in sampled time; nothing is unknown. The instant at which a formula is decided
at a position follows from the decision instants of its operands. It is computed for all positions
at once, and shares nothing with the core: no automata, queues or networks. For every attempt the
trigger, and verdict and instant if a prefix decides it, are compared, step by step and by rows.
"""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray
from tests.tools.build import p, requirement, scaled, spec_over, start
from tests.tools.common_fragment import EVER, to_core
from tests.tools.differential import Campaign
from tests.tools.drive import drive
from tests.tools.forms import FORMS, Compiler, Maker
from tests.tools.random_specs import random_mtl

from rvmon.language.checked import formula as rv
from rvmon.language.checked.specification import TimeModel
from rvmon.language.print import format_formula
from rvmon.testing.generate import BOOLS
from rvmon.testing.generate.trace import Case
from rvmon.trace.sample import Sample
from rvmon.trace.schema import Kind
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Decision
from rvmon.verdicts.report import Report

Instants = NDArray[np.int64]
Decided = tuple[Instants, Instants]
"""For each position, the instants at which a formula is known to be true, and to be false."""

NEVER = np.iinfo(np.int64).max
LENGTHS = (1, 7, 40)
"""The factors by which windows of a few ticks are scaled."""

Told = Mapping[int, tuple[int, int | None, Verdict | None]]
"""By number of an attempt: trigger, and decision instant and verdict if a prefix decides it."""


class Decisions:
    """The decision instants of formulas at each position of a trace.

    Args:
        case: has one requirement, and no unknown values.
    """

    def __init__(self, case: Case) -> None:
        stamps = np.array([one.t for one in case.samples], np.int64)
        is_held = case.spec.time is TimeModel.HELD
        self.times = np.arange(stamps[0], stamps[-1] + 1) if is_held else stamps
        # A window that ends with the trace is known to be over one tick after the end.
        self._last = int(stamps[-1]) + 1
        self._row_at = np.searchsorted(stamps, self.times, "right") - 1
        self._samples = case.samples

    def of(self, formula: rv.Formula) -> Decided:
        """The decision instants of a formula that has only the operators of `to_core`."""
        match formula:
            case rv.SignalAtom(name=name):
                told = np.array([one.values[name] for one in self._samples], bool)[self._row_at]
                return np.where(told, self.times, NEVER), np.where(told, NEVER, self.times)
            case rv.Unary(op=rv.UnaryOp.NOT, operand=operand):
                true, false = self.of(operand)
                return false, true
            case rv.Unary(op=rv.UnaryOp.ALWAYS, operand=operand, interval=interval):
                true, false = self.of(operand)
                failed, kept = self._until(None, (false, true), interval or EVER)
                return kept, failed
            case rv.Unary(op=rv.UnaryOp.EVENTUALLY, operand=operand, interval=interval):
                return self._until(None, self.of(operand), interval or EVER)
            case rv.Binary(op=op, left=left, right=right, interval=interval):
                one, other = self.of(left), self.of(right)
                if op is rv.BinaryOp.UNTIL:
                    return self._until(one, other, interval or EVER)
                joins = [np.maximum, np.minimum]
                first, second = joins if op is rv.BinaryOp.AND else joins[::-1]
                return first(one[0], other[0]), second(one[1], other[1])
        raise AssertionError(f"no such formula is drawn: {formula}")

    def _until(self, left: Decided | None, right: Decided, window: rv.Interval) -> Decided:
        """The decision instants of `left U right`; without `left`, of `F right`.

        The formula is known to be true once `right` is at some position of the window, and `left`
        at all positions before it. It is known to be false once one of the two excludes each
        position; positions to come are excluded by `left` or by the end of the window.
        """
        times, count = self.times, len(self.times)
        always = np.full(count, times[0]), np.full(count, NEVER)
        kept, broken = left or always
        met, missed = right
        first = np.searchsorted(times, times + window.low)
        end = first
        if window.high is not None:
            end = np.searchsorted(times, times + window.high, "right")
        else:  # unbounded: position k depends on k + 1 in the same way, so compute backwards
            later: Decided = np.full(count + 1, NEVER), np.full(count + 1, NEVER)
            for k in range(count - 1, -1, -1):
                later[0][k] = min(met[k], max(kept[k], later[0][k + 1]))
                later[1][k] = max(missed[k], min(broken[k], later[1][k + 1]))
        true, false = np.full(count, NEVER), np.full(count, times[0])
        held, gone = (one.copy() for one in always)  # of `left` up to the offset
        place = np.arange(count)
        for offset in range(int((end - place).max())):
            size = count - offset
            at = place[:size] + offset
            inside, within = (at >= first[:size]) & (at < end[:size]), at < end[:size]
            found = np.maximum(met[offset:], held[:size])
            passed = np.minimum(missed[offset:], gone[:size])
            np.minimum(true[:size], found, out=true[:size], where=inside)
            np.maximum(false[:size], passed, out=false[:size], where=inside)
            np.maximum(held[:size], kept[offset:], out=held[:size], where=within)
            np.minimum(gone[:size], broken[offset:], out=gone[:size], where=within)
        if window.high is None:
            return np.maximum(held, later[0][first]), np.minimum(gone, later[1][first])
        over = times + window.high + 1
        over[over > self._last] = NEVER
        return true, np.maximum(false, np.minimum(over, gone))


def by_law(case: Case) -> Told:
    """The attempts of a case according to the semantics."""
    (asked,) = case.spec.requirements.values()
    decisions = Decisions(case)
    true, false = decisions.of(to_core(asked.consequent))
    told: dict[int, tuple[int, int | None, Verdict | None]] = {}
    before = False
    for sample in case.samples:
        starts = sample.t == 0 if asked.trigger == start else bool(sample.values["p"])
        if starts and not before:
            place = int(np.searchsorted(decisions.times, sample.t))
            ends = [(int(true[place]), Verdict.PASS), (int(false[place]), Verdict.FAIL)]
            at, verdict = min(ends, key=lambda end: end[0])
            told[len(told) + 1] = (sample.t, *((None, None) if at == NEVER else (at, verdict)))
        before = starts
    return told


def of_report(report: Report) -> Told:
    """The attempts of a report."""
    return {
        one.number: (one.triggered, *(ended if one.decision is Decision.PREFIX else (None, None)))
        for one in report.attempts
        for ended in [(one.decided, one.verdict)]
    }


def _case(seed: int, number: int, samples: int) -> Case:
    """A random case with one requirement."""
    rng = random.Random(f"{seed}/{number}")
    formula = scaled(random_mtl(rng, rng.randint(2, 4)), rng.choice(LENGTHS))
    trigger = rng.choice((p, p, start))
    model = (TimeModel.HELD, TimeModel.SAMPLED)[number % 2]
    kinds = dict.fromkeys(BOOLS, Kind.BOOL)
    spec = spec_over(kinds, requirement(formula, upon=trigger), model)
    return Case(spec, tuple(_samples(rng, samples)))


def _samples(rng: random.Random, count: int) -> Iterator[Sample]:
    t, values = 0, dict.fromkeys(BOOLS, False)
    chances = {name: rng.choice((0.01, 0.1, 0.5)) for name in BOOLS}
    for _ in range(count):
        for name, chance in chances.items():
            values[name] = values[name] is not (rng.random() < chance)
        yield Sample(t, dict(values))
        t += rng.choice((1, 1, 1, 2, 3, 8, 41))


def judge_long(found: Campaign, seed: int, numbers: range, *, samples: int = 10_000) -> None:
    """The core against the law on arrays, on traces too long for the oracle."""
    for number in numbers:
        case = _case(seed, number, samples)
        wanted = by_law(case)
        found.counts.update(traces=1, samples=len(case.samples))
        for _, _, verdict in wanted.values():
            found.counts[f"attempts {'open' if verdict is None else verdict.value}"] += 1
        compiler = Compiler()
        automaton = compiler(case.spec).requirements["R"].automaton
        found.counts[f"judged by {'a network' if automaton is None else 'an automaton'}"] += 1
        for form in FORMS:
            got = of_report(drive(Maker(form, compiler)(case), case)[0])
            wrong = [k for k in sorted(wanted.keys() | got.keys()) if wanted.get(k) != got.get(k)]
            if wrong:
                text = format_formula(case.spec.requirements["R"].consequent)
                found.disagreements.append(
                    f"number {number}, {case.spec.time.value}, {text}: attempt {wrong[0]}: "
                    f"{wanted.get(wrong[0])}, {form} {got.get(wrong[0])}"
                )
