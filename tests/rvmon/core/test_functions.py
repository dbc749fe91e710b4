"""Numeric functions of the core agree with the oracle to the last bit."""

import random

import pytest
from tests.tools.each import each

import rvmon
from rvmon.language.checked.arithmetic import NumericOp, UnitRule
from rvmon.language.checked.formula import Arithmetic, Literal
from rvmon.testing.law.numbers import number

ANGLES = (UnitRule.OF_ANGLE, UnitRule.TURN, UnitRule.PLACES)
EDGES = (0.0, -0.0, 0.5, 1.0, -1.0, 1.5, 2.5, 1e300, -1e300, 5e-324, float("inf"), 180.0, 360.0)
WHOLE_EDGES = (0, 1, -1, 2, 63, 64, 2**62, 2**63 - 1, -(2**63), 2**53 + 1, -7)


def drawn(rng, kind):
    """A random number, often an edge case."""
    if kind == "int":
        any_one = rng.randint(-(2**63), 2**63 - 1) if rng.random() < 0.3 else rng.randint(-70, 70)
        return rng.choice(WHOLE_EDGES) if rng.random() < 0.4 else any_one
    any_one = rng.uniform(-10, 10) if rng.random() < 0.7 else rng.uniform(-1e6, 1e6)
    return rng.choice(EDGES) if rng.random() < 0.2 else any_one


def pairs():
    """Each function with each kind of number that it takes."""
    for op in NumericOp:
        rule = op.entry.unit
        if op.is_function and op is not NumericOp.BIT:
            kinds = ["real"] * (rule is not UnitRule.BITS) + ["int"] * (rule not in ANGLES)
            yield from ((op, kind) for kind in kinds)


@pytest.mark.law
@each(("op", "kind"), [*pairs()])
def test_a_function_agrees_with_the_oracle(op, kind):
    """On 200 random arguments, including infinities and the limits of 64 bits."""
    rng = random.Random(f"{op} {kind}")
    unit = " [rad]" if op.entry.unit in ANGLES else ""
    names = "abcd"[: op.entry.least]
    spec = rvmon.loads(
        f"spec s\nsignal {', '.join(names)} : {kind}{unit}\nevent e\n"
        f"requirement R\n  upon e\n  then immediately not e\n  let v = {op}({', '.join(names)})\n"
    )
    turn = [Literal(6.283185307179586)] if op is NumericOp.ANGLE_BETWEEN else []
    monitor = spec.monitor()
    for t in range(200):
        values = {name: drawn(rng, kind) for name in names}
        (record,) = monitor.step(float(t), {**values, "e": True})
        args = (*map(Literal, values.values()), *turn)
        wanted = number(Arithmetic(op, args), None, {}, {})
        found = record.captured["v"]
        assert (type(found), found) == (type(wanted), wanted), values


def test_bit_reads_twos_complement():
    spec = rvmon.loads(
        "spec s\nsignal a, b : int\nevent e\n"
        "requirement R\n  upon e\n  then immediately bit(a, b)\n"
    )
    monitor, rng = spec.monitor(), random.Random(1)
    for t in range(600):
        a, b = drawn(rng, "int"), rng.randint(-1, 65)
        records = monitor.step(float(t), {"a": a, "b": b, "e": True})
        wanted = "I" if not 0 <= b < 64 else "P" if a % 2**64 >> b & 1 else "F"
        assert [one.verdict.value for one in records] == [wanted] * (wanted != "I"), (a, b)
