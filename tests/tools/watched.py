"""Random specifications with coverpoints and crosses, and plans of what judges nothing."""

from __future__ import annotations

from dataclasses import replace

from rvmon.language.checked.formula import (
    Bound,
    BoundAtom,
    Compare,
    CompareOp,
    Formula,
    Literal,
    SignalValue,
)
from rvmon.language.checked.properties import Bin, BinKind, Coverpoint, Cross
from rvmon.language.checked.specification import CheckedSpec, Mode, Requirement, TimeModel
from rvmon.logic.plan import Plan, plan_of_truths
from rvmon.monitor.compiled_spec import CompiledSpec
from rvmon.testing.generate import NUMBERS, Rng, chance, pick
from rvmon.testing.generate.formula import formula
from rvmon.testing.generate.numbers import Shape
from rvmon.testing.generate.spec import Profile, random_spec


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
    return replace(spec, requirements=requirements, coverpoints=points, crosses=crosses)


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
