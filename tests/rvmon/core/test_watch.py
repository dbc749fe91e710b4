"""What the core keeps beside what becomes of attempts."""

import random
import struct

import pytest
from tests.tools.plan_reader import Plan, layouts, walk
from tests.tools.watched import truths_plan

import rvmon
from rvmon.core import sections
from rvmon.core.plan import pack
from rvmon.core.sections import RECORDS, Section, hash_of
from rvmon.dataflow.network_plan import plan_of_all
from rvmon.formula.core_form import Lowering
from rvmon.formula.factory import Factory
from rvmon.monitor import compile_spec
from rvmon.monitor.core.packed_cache import Kept
from rvmon.monitor.core.planned import planned_as
from rvmon.monitor.core.watching import known_truths
from rvmon.testing.generate.spec import Profile, random_spec
from rvmon.trace.sample import Sample

AHEAD = "signal p : bool\nsignal x : real\nrequirement R\n  upon p\n  then within 3 ns x > 1\n"


@pytest.mark.parametrize("seed", range(20))
def test_every_index_of_a_plan_that_judges_nothing_is_in_its_bounds(seed):
    """What all requirements owe is kept the truths of."""
    compiled = compile_spec(random_spec(random.Random(seed), Profile(requirements=3, depth=3)))
    plan = Plan(pack(truths_plan(compiled)).data)
    assert plan.records["PARTS"][0]["truths"] == 0
    walk(plan)


def owed(text):
    """The specification, and what its requirement owes."""
    checked = rvmon.loads(text).checked
    consequent = checked.requirements["R"].consequent
    return checked, Lowering(Factory(), checked.period, False).core(consequent, True)


def truths(text, values, end):
    """Where what is owed is surely true, and surely false."""
    checked, core = owed(text)
    samples = [Sample(t, one) for t, one in values.items()]
    (found,) = known_truths(checked, [core], samples, end, None, {})
    return found.true, found.false


@pytest.mark.parametrize(
    ("time", "expected"),
    [
        ("held", (((4, 9),), ((2, 3),))),
        ("sampled every 2 ns", (((3, 4),), ((1, 2),))),
        ("sampled", (((1, 1),), ((0, 0),))),
    ],
)
def test_truths_reach_as_far_as_they_are_known(time, expected):
    """What looks ahead is known where the recording decides it: of its last instants it is not."""
    values = {2: {"x": 0.0}, 7: {"x": 2.0}, 10: {"x": 0.0}}
    assert truths(f"time {time}\n{AHEAD}", values, 12) == expected


def test_an_unknown_value_is_neither_true_nor_false():
    """It ends what is known, and parts the two readings."""
    text = "signal p : bool\nrequirement R\n  always p\n".replace(
        "always p", "upon start\n  then p"
    )
    values = {0: {"p": True}, 4: {"p": None}, 6: {"p": False}}
    assert truths(text, values, 8) == (((0, 3),), ((6, 8),))


def test_another_run_begins_anew():
    """Nothing is left of the one before, unknown values among it."""
    text = "signal p : bool\nrequirement R\n  upon start\n  then p\n"
    checked = rvmon.loads(text).checked
    compiled = compile_spec(checked)
    plan = truths_plan(compiled)
    planned = planned_as(checked, (), Kept(pack(plan).data, frozenset(), frozenset()))
    place = plan_of_all(plan.truths, plan.gap).places[plan.truths[0]]
    run = planned.monitor(frozenset())
    seen = []
    for values in ([None, True], [True, None], [None, True]):
        for t, value in enumerate(values):
            assert run.judge(t, {"p": value}, True)
        run.finish(3)
        seen.append(run.truths(place))
        run.reset()
    assert seen[0] == seen[2] != seen[1]
    assert seen[0] == (struct.pack("=qq", 1, 3), b"")
    assert run.truths(place) == (b"", b"")


@pytest.mark.parametrize("place", [-1, 99, 1 << 40])
def test_an_operator_that_is_none(place):
    """It is refused, and so is any of a plan that keeps no truths."""
    compiled = compile_spec(rvmon.loads(AHEAD).checked)
    planned = planned_as(
        compiled.checked, (), Kept(pack(truths_plan(compiled)).data, frozenset(), frozenset())
    )
    with pytest.raises(ValueError, match="keeps no truths"):
        planned.monitor(frozenset()).truths(place)


def test_a_form_that_is_none_is_refused():
    """A part of captured values keeps none; others name one of theirs."""
    compiled = compile_spec(rvmon.loads(AHEAD).checked)
    data = pack(truths_plan(compiled)).data
    fields = layouts()["part_plan"]
    names = [name for name, _ in fields]
    before = "".join(form for _, form in fields[: names.index("truths")])
    at = Plan(data).places[Section.PARTS][0] + struct.calcsize(f"={before}")
    assert struct.unpack_from("=i", data, at) == (0,)
    assert struct.calcsize(f"={before}") < RECORDS[Section.PARTS].size
    for number, is_taken in ((-1, True), (1, False), (-2, False), (1 << 30, False)):
        changed = bytearray(data)
        struct.pack_into("=i", changed, at, number)
        struct.pack_into("=Q", changed, 24, hash_of(bytes(changed[sections.HEADER.size :])))
        kept = Kept(bytes(changed), frozenset(), frozenset())
        planned = planned_as(compiled.checked, (), kept)
        if is_taken:
            planned.monitor(frozenset())
        else:
            with pytest.raises(ValueError, match="plan"):
                planned.monitor(frozenset())
