"""The core against progression, on traces too long for the law: what is kept over time stays right.

    python -m benchmarks.long_traces --traces 100 --samples 10000 --seed 1

Random formulas with windows of up to some hundred ticks, owed from the start or upon a signal, in
held and in sampled time; nothing is unknown. What an attempt owes is taken on by
`tests.tools.progression`, which has the formula's core form in common with the core, and neither
automata, queues, networks nor chains of windows. Compared are, of every attempt, trigger, verdict
and instant of what the prefix decides, stepped and by rows. Prints every disagreement, with its
number, and exits 1 if there is one.
"""

from __future__ import annotations

import argparse
import random
import sys
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from benchmarks.ours import scaled
from rvmon.monitor.compiled.costs import compile_report
from tests.tools.core_forms import ByRows, Stepped
from tests.tools.drive import drive
from tests.tools.generate_ltl import random_mtl
from tests.tools.progression import Progression, TooManyObligationsError
from tests.tools.stepped import run, settle

from rvmon.automaton.location import PASSED, Token
from rvmon.formula.alphabet import Alphabet, alphabet_of
from rvmon.formula.factory import Factory
from rvmon.formula.lower import lower
from rvmon.formula.state import FALSE, TRUE, Elapsed, State, StateOp
from rvmon.monitor import compile_spec
from rvmon.spec.checked.formula import Bound, BoundAtom, Constant, SignalAtom
from rvmon.spec.checked.specification import CheckedSpec, Mode, Requirement, Signal, TimeModel, Type
from rvmon.spec.print.printer import format_formula
from rvmon.testing.case import Case
from rvmon.testing.generate.choices import BOOLS
from rvmon.trace.sample import Sample
from rvmon.trace.schema import Kind
from rvmon.verdict.attempt import Decision
from rvmon.verdict.report import Report
from rvmon.verdict.verdict import Verdict

TRIGGER = SignalAtom("p")
LENGTHS = (1, 7, 40)
"""What the windows of a few ticks are multiplied by."""

Told = Mapping[int, tuple[int, int | None, Verdict | None]]
"""By number of an attempt its trigger, and instant and verdict if the prefix decides it."""


@dataclass(slots=True)
class Compared:
    """What came of some traces.

    Attributes:
        traces: so many were judged by both.
        samples: in them.
        attempts: in them, by verdict of the prefix.
        judges: of the core, by the traces that each had.
        passed_over: traces of which progression would owe too much at once.
        found: one text for each disagreement.
    """

    traces: int = 0
    samples: int = 0
    attempts: Counter[str] = field(default_factory=Counter)
    judges: Counter[str] = field(default_factory=Counter)
    passed_over: int = 0
    found: list[str] = field(default_factory=list)


def long_cases(seed: object, samples: int) -> Iterator[Case]:
    """Random cases without end, each of one requirement and so many samples."""
    for number in range(sys.maxsize):
        rng = random.Random(f"{seed}/{number}")
        formula = scaled(random_mtl(rng, rng.randint(2, 4)), rng.choice(LENGTHS))
        trigger = rng.choice((TRIGGER, TRIGGER, BoundAtom(Bound.START)))
        model = (TimeModel.HELD, TimeModel.SAMPLED)[number % 2]
        requirement = Requirement("R", Mode.UPON, trigger, formula)
        signals = {name: Signal(name, Type(Kind.BOOL)) for name in BOOLS}
        spec = CheckedSpec("long", "", model, signals, {}, {"R": requirement})
        yield Case(spec, tuple(_samples(rng, samples)))


def _samples(rng: random.Random, count: int) -> Iterator[Sample]:
    t, values = 0, dict.fromkeys(BOOLS, False)
    chances = {name: rng.choice((0.01, 0.1, 0.5)) for name in BOOLS}
    for _ in range(count):
        for name, chance in chances.items():
            values[name] = values[name] is not (rng.random() < chance)
        yield Sample(t, dict(values))
        t += rng.choice((1, 1, 1, 2, 3, 8, 41))


def by_progression(case: Case) -> Told:
    """What progression makes of a case; attempts that owe the same go on together.

    Raises:
        TooManyObligationsError: one owes too much at once.
    """
    (requirement,) = case.spec.requirements.values()
    is_held = case.spec.time is TimeModel.HELD
    factory = Factory()
    owed = lower(requirement, factory, sampled=not is_held).owed
    alphabet = alphabet_of(owed)
    machine = Progression(factory.next(owed), alphabet)
    told: dict[int, tuple[int, int | None, Verdict | None]] = {}
    going: dict[Token, list[int]] = {}
    last = case.samples[-1].t
    before = False
    for sample, until in zip(case.samples, _until(case.samples, last), strict=True):
        starts = sample.t == 0 if requirement.trigger != TRIGGER else bool(sample.values["p"])
        if starts and not before:
            number = len(told) + 1
            told[number] = sample.t, None, None
            going.setdefault(machine.start, []).append(number)
        before = starts
        letter = _letter(alphabet, sample)
        behind: dict[Token, list[int]] = {}
        for token, numbers in going.items():
            after, at = _taken(machine, token, letter, sample.t, until, is_held=is_held)
            if after[0] > PASSED:
                behind.setdefault(after, []).extend(numbers)
                continue
            verdict = Verdict.PASS if after[0] == PASSED else Verdict.FAIL
            told.update({one: (told[one][0], at, verdict) for one in numbers})
        going = behind
    return told


def _until(samples: Sequence[Sample], last: int) -> Iterator[int]:
    """For each sample the last instant before the next one."""
    yield from (later.t - 1 for _, later in pairwise(samples))
    yield last


def _letter(alphabet: Alphabet, sample: Sample) -> int:
    letter = 0
    for proposition, entry in zip(alphabet.propositions, alphabet.pessimistic, strict=True):
        letter += entry[TRUE if _holds(proposition, sample) else FALSE]
    return letter


def _holds(state: State, sample: Sample) -> bool:
    """Whether a formula without operators of the past is true; all is known."""
    match state.op, state.leaf:
        case StateOp.LEAF, SignalAtom(name=name):
            return bool(sample.values[name])
        case StateOp.LEAF, Constant(value=value):
            return value
        case StateOp.LEAF, Elapsed(duration=0):  # each sample is a position
            return True
        case StateOp.NOT, _:
            return not _holds(state.args[0], sample)
        case StateOp.AND, _:
            return all(_holds(one, sample) for one in state.args)
        case StateOp.OR, _:
            return any(_holds(one, sample) for one in state.args)
    raise AssertionError(f"nothing of these formulas is lowered to {state.op}, {state.leaf}")


def _taken(
    machine: Progression, token: Token, letter: int, t: int, until: int, *, is_held: bool
) -> tuple[Token, int]:
    """A token after a sample and the time behind it, and the instant if that decided it."""
    if is_held:
        after, at, _ = run(machine, token, letter, t, until, 1)
        return after, at
    after = machine.step(token, t, letter)
    return (after, t) if after[0] <= PASSED else settle(machine, after, t, until)


def of_report(report: Report) -> Told:
    """What a report says of its attempts."""
    return {
        one.number: (
            (one.triggered, one.decided, one.verdict)
            if one.decision is Decision.PREFIX
            else (one.triggered, None, None)
        )
        for one in report.attempts
    }


def compared(cases: Iterator[Case], traces: int) -> Compared:
    """Have both judge, until so many traces are judged."""
    total = Compared()
    for number, case in enumerate(cases):
        if total.traces >= traces:
            break
        try:
            wanted = by_progression(case)
        except TooManyObligationsError:
            total.passed_over += 1
            continue
        total.traces += 1
        total.samples += len(case.samples)
        total.attempts.update("open" if v is None else v.value for _, _, v in wanted.values())
        compiled = compile_spec(case.spec)
        total.judges[compile_report(compiled.requirements["R"]).judge] += 1
        for form in (Stepped, ByRows):
            got = of_report(drive(form(compiled, case), case)[0])
            for one in sorted(wanted.keys() | got.keys()):
                if wanted.get(one) != got.get(one):
                    text = format_formula(case.spec.requirements["R"].consequent)
                    total.found.append(
                        f"case {number}, {case.spec.time.value}, {text}: attempt {one}: "
                        f"{wanted.get(one)}, {form.__name__} {got.get(one)}"
                    )
                    break
    return total


def main(words: list[str]) -> int:
    """Compare, and print."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.long_traces")
    parser.add_argument("--traces", type=int, default=100)
    parser.add_argument("--samples", type=int, default=10_000, help="of a trace")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args(words)
    began = time.process_time()
    total = compared(long_cases(options.seed, options.samples), options.traces)
    for text in total.found:
        print(text)
    verdicts = ", ".join(f"{name} {count:,}" for name, count in sorted(total.attempts.items()))
    judges = ", ".join(f"{name} {count}" for name, count in sorted(total.judges.items()))
    print(
        f"{total.traces} traces ({judges}), {total.samples:,} samples, attempts {verdicts}; "
        f"{total.passed_over} passed over; disagreements {len(total.found)}; "
        f"{time.process_time() - began:.0f} s of CPU time"
    )
    return 1 if total.found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
