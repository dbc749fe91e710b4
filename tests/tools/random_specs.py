"""Random formulas and specifications that the general generator seldom makes, or never.

Future formulas over truth values, windows within windows, many letters, coverpoints and crosses;
traces in which little is new.
"""

import random
from dataclasses import replace

from msgspec import structs

import rvmon
from rvmon.language.checked.formula import (
    Binary,
    Bound,
    BoundAtom,
    Compare,
    CompareOp,
    Formula,
    Interval,
    Literal,
    SignalAtom,
    SignalValue,
    Unary,
)
from rvmon.language.checked.properties import Bin, BinKind, Coverpoint, Cross
from rvmon.language.checked.specification import CheckedSpec, Mode, Requirement, TimeModel
from rvmon.logic.plan import Plan, plan_of_truths
from rvmon.monitor.compiled_spec import CompiledSpec
from rvmon.testing.generate import BOOLS, NUMBERS, Rng, chance, pick
from rvmon.testing.generate.formula import formula
from rvmon.testing.generate.numbers import Shape
from rvmon.testing.generate.spec import Profile, random_spec
from rvmon.testing.generate.trace import Case
from rvmon.trace.sample import Sample, Value
from tests.tools.build import with_operands

_SHAPE = Shape(past=False, numbers=False, events=False, constants=0, longest=3)


def random_ltl(rng: Rng, depth: int) -> Formula:
    """A random untimed formula of future operators, at most `depth` of them nested."""
    return _over_signals(rng, formula(rng, replace(_SHAPE, step=True), depth), is_timed=False)


def random_mtl(rng: Rng, depth: int) -> Formula:
    """A random formula of future operators with windows of a few ticks, without `X`."""
    return _over_signals(rng, formula(rng, _SHAPE, depth), is_timed=True)


def _over_signals(rng: Rng, made: Formula, *, is_timed: bool) -> Formula:
    """The formula without `start`, and perhaps without bounds."""
    if isinstance(made, BoundAtom):
        return SignalAtom(pick(rng, BOOLS))
    if isinstance(made, Unary | Binary) and made.interval is not None and not is_timed:
        made = structs.replace(made, interval=Interval())
    return with_operands(made, lambda operand: _over_signals(rng, operand, is_timed=is_timed))


_SIGNALS = """signal p, q, r : bool
signal x : real
signal y : int
signal mode : {red, green}
event e, f
event g(k: int)
requirement R
"""

_HEADS = (
    "always ({})",
    "whenever p then {}",
    "upon e then {}",
    "upon start then {}",
    "upon g then {}\n  for each k in g.k",
    "upon p then {}\n  let v = x",
)
_CHAIN_HEADS = (
    *_HEADS,
    "always (p -> {})",
    "whenever p and r then {}",
    "whenever p or {} then {}",
    "upon p then {}",
    "upon p then r R {}",
)

_TAILS = ("", "  at end: strict\n", "  at end: strong\n")


def random_chain(rng: random.Random, *, untils: bool = False) -> CheckedSpec:
    """A specification with such a requirement, in any model of time."""
    time = rng.choice(("held", "sampled", f"sampled every {rng.randint(1, 3)} ns"))
    formula = rng.choice(("q", "not q", "(q and r)", "(q or r)", "x > 1"))
    for _ in range(rng.choice((1, 2, 2, 3, 3, 4))):
        low = rng.choice((0, 0, 1, 3)) if time != "sampled" or rng.random() < 0.2 else 0
        high = low + rng.choice((0, 1, 2, 5, 9))
        bounds = f"[{low} ns, {high} ns]"
        if untils and rng.random() < 0.6:
            left = rng.choice(("q", "not r", "p", f"F[0 ns, {rng.randint(0, 3)} ns] r"))
            formula = f"(({left}) {rng.choice('UR')}{bounds} ({formula}))"
        else:
            formula = f"{rng.choice('FG')}{bounds} {formula}"
    head = rng.choice(_CHAIN_HEADS)
    text = head.format(*(("r", formula) if head.count("{") > 1 else (formula,)))
    return rvmon.loads(f"time {time}\n{_SIGNALS}  {text}\n{rng.choice(_TAILS)}").checked


_ATOMS = (
    *("p", "q", "r", "e", "f", "changed(x)", "known(x)", "updated(y)", "mode == red"),
    *("x > 0", "x > 1", "x <= 2", "y > 0", "y >= 2", "y < 3", "x == y", "g.k > 0", "g.k > 1"),
)


def random_letters(rng: random.Random) -> CheckedSpec:
    """A specification with such a requirement, of 17 or 18 propositions, in any model of time."""
    time = rng.choice(("held", "sampled", f"sampled every {rng.randint(1, 3)} ns"))
    window, joint = rng.choice((("F", " or "), ("G", " and ")))
    parts = rng.sample(_ATOMS, rng.randint(17, 18))
    formula = joint.join(f"{window}[0 ns, {n} ns] ({part})" for n, part in enumerate(parts))
    text = rng.choice(_HEADS).format(formula)
    return rvmon.loads(f"time {time}\n{_SIGNALS}  {text}\n").checked


def with_random_coverage(rng: Rng, profile: Profile) -> CheckedSpec:
    """A random specification that has coverpoints and, if there are several, a cross.

    What bins ask for is asked for by its requirements, too, so that traces are drawn for it.
    """
    spec = random_spec(rng, profile)
    shape = Shape(step=spec.time is not TimeModel.HELD, future=False)
    points = {
        name: Coverpoint(name, _bins(rng, shape), _upon(rng, shape), rng.randint(1, 3))
        for name in (f"C{place}" for place in range(rng.randint(1, 3)))
    }
    crosses = {}
    if len(points) > 1:
        crosses["X"] = Cross("X", tuple(points), upon=_upon(rng, shape))
    asked = {
        f"{point.name}.{one.name}": one.formula for point in points.values() for one in point.bins
    }
    requirements = {
        name: Requirement(name, Mode.UPON, BoundAtom(Bound.START), wanted)
        for name, wanted in asked.items()
    }
    return structs.replace(spec, requirements=requirements, coverpoints=points, crosses=crosses)


def _bins(rng: Rng, shape: Shape) -> tuple[Bin, ...]:
    """A few bins of any formulas, or many that compare one signal."""
    kinds = (BinKind.GOAL, BinKind.GOAL, BinKind.IGNORE, BinKind.ILLEGAL)
    if chance(rng, 30):
        value = SignalValue(pick(rng, NUMBERS))
        wanted: list[Formula] = [
            Compare(pick(rng, tuple(CompareOp)), value, Literal(rng.randint(-1, 7)))
            for _ in range(rng.randint(5, 9))
        ]
    else:
        wanted = [formula(rng, shape, rng.randint(0, 2)) for _ in range(rng.randint(1, 3))]
    return tuple(Bin(f"b{place}", one, pick(rng, kinds)) for place, one in enumerate(wanted))


def _upon(rng: Rng, shape: Shape) -> Formula | None:
    return formula(rng, shape, rng.randint(0, 2)) if chance(rng, 40) else None


def truths_plan(compiled: CompiledSpec) -> Plan:
    """The plan of who asks where all that is required is true; what is captured is 1."""
    required = dict.fromkeys(one.obligation.required for one in compiled.requirements.values())
    captured: dict[str, float | None] = {}
    for requirement in compiled.checked.requirements.values():
        each = requirement.for_each
        names = [one.name for one in requirement.captures]
        captured |= dict.fromkeys(names if each is None else [each.name, *names], 1)
    return plan_of_truths(compiled.checked, list(required), captured)


def with_few_news(rng: random.Random, case: Case) -> Case:
    """A case in which most samples say again what was said, and events seldom occur."""
    news = rng.choice([0.02, 0.1, 0.5])
    now: dict[str, Value] = {}
    actions: list[Sample | int] = []
    for action in case.actions:
        if isinstance(action, Sample):
            told = {**action.values}
            for name in case.spec.signals.keys() & told.keys():
                if name not in now or rng.random() < news:
                    now[name] = told[name]
                told[name] = now[name]
            gone = [n for n in told if n not in case.spec.signals and rng.random() > news]
            action = Sample(action.t, {n: one for n, one in told.items() if n not in gone})
        actions.append(action)
    return replace(case, actions=tuple(actions))
