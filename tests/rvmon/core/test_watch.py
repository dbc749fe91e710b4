"""What the core records besides verdicts: truths, hits of coverage bins, and moves of attempts."""

import struct

import pytest
from msgspec.structs import replace
from tests.rvmon.core.plan_reader import Plan, layouts, with_numbers
from tests.tools.each import each
from tests.tools.random_specs import truths_plan

import rvmon
from rvmon.core.pack import pack
from rvmon.core.sections import Section
from rvmon.coverage.monitor import Bins
from rvmon.errors import RvmonError
from rvmon.logic.formula import Factory
from rvmon.logic.network_plan import plan_of_all
from rvmon.logic.normal_form import Lowering
from rvmon.logic.plan import WatchGroup
from rvmon.monitor.compiled_spec import Kept, compile_spec
from rvmon.monitor.formula_truths import known_truths
from rvmon.monitor.packed_plan import planned_as
from rvmon.monitor.requirement_plans import plan_alone
from rvmon.trace.sample import Sample

AHEAD = "signal p : bool\nsignal x : real\nrequirement R\n  upon p\n  then within 3 ns x > 1\n"


def truths(text, values, end):
    """Where the consequent is known to be true, and where to be false."""
    checked = rvmon.loads(text).checked
    consequent = checked.requirements["R"].consequent
    core = Lowering(Factory(), checked.period, False).core(consequent, True)
    samples = [Sample(t, one) for t, one in values.items()]
    (found,) = known_truths(checked, [core], samples, end)
    return tuple(tuple(map(tuple, one.tolist())) for one in (found.true, found.false))


VALUES = {2: {"x": 0.0}, 7: {"x": 2.0}, 10: {"x": 0.0}}
AT_START = "signal p : bool\nrequirement R\n  upon start\n  then p\n"


@each(
    ("text", "values", "end", "expected"),
    [
        # A future formula is known where the recording decides it, so not at its last instants.
        (f"time held\n{AHEAD}", VALUES, 12, (((4, 9),), ((2, 3),))),
        (f"time sampled every 2 ns\n{AHEAD}", VALUES, 12, (((3, 4),), ((1, 2),))),
        (f"time sampled\n{AHEAD}", VALUES, 12, (((1, 1),), ((0, 0),))),
        # An unknown value is neither true nor false.
        (
            *(AT_START, {0: {"p": True}, 4: {"p": None}, 6: {"p": False}}),
            *(8, (((0, 3),), ((6, 8),))),
        ),
    ],
)
def test_truths_reach_as_far_as_they_are_known(text, values, end, expected):
    assert truths(text, values, end) == expected


def truths_run(text):
    """A run that records the truth of one formula, and the formula's place."""
    checked = rvmon.loads(text).checked
    plan = truths_plan(compile_spec(checked))
    planned = planned_as(checked, (), Kept(pack(plan).data, frozenset(), frozenset()))
    place = plan_of_all(plan.truths, plan.gap).places[plan.truths[0]]
    return planned.monitor(frozenset()), place


def test_a_reset_clears_the_truths():
    run, place = truths_run(AT_START)
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
    for wrong in (-1, 99, 1 << 40):
        with pytest.raises(ValueError, match="keeps no truths"):
            run.truths(wrong)


BINS = """signal p, q : bool
event e
coverpoint level = p {yes: true, no: false}
coverpoint often {e: e, both: p and q}
coverpoint asked = p {yes: true, no: false}
  upon q
cross all = level, often
"""


def bins(text, **law):
    """The bins of a specification, and their plan."""
    made = Bins(rvmon.loads(text).checked)
    data = pack(made.plan, **law).data
    return made, planned_as(made.spec, (), Kept(data, frozenset(), frozenset()))


def changed(data, section, record, name, value):
    """A plan whose first record in a section has other numbers in a field."""
    fields = layouts()[record]
    names = [one for one, _ in fields]
    before = "".join(form for _, form in fields[: names.index(name)])
    at = Plan(data).places[section][0] + struct.calcsize(f"={before}")
    return with_numbers(data, {at + 4 * number: one for number, one in enumerate(value)})


def is_accepted(data):
    checked = rvmon.loads(BINS).checked
    planned = planned_as(checked, (), Kept(data, frozenset(), frozenset()))
    try:
        planned.monitor(frozenset())
    except ValueError:
        return False
    return True


WRONG = {
    ("PARTS", "part_plan"): {
        "truths": [(1,), (-2,)],
        "watches": [(1, 7), (0, -1)],
        "groups": [(0, 5)],
    },
    ("WATCHES", "watch_plan"): {
        "node": [(99,), (-1,)],
        "is_pulse": [(2,)],
        "groups": [(1 << 30, 1)],
    },
    ("GROUPS", "group_plan"): {
        "occasion": [(7,), (-2,)],
        "first": [(1,)],
        "axes": [(0, 0), (0, 1), (1 << 30, 2)],
    },
    ("LINKS", "link_plan"): {"judge": [(7,), (-1,)], "kind": [(9,), (1,)]},
}


@each("place", WRONG)
def test_a_plan_of_bins_with_dangling_references_is_refused(place):
    section, record = place
    data = pack(Bins(rvmon.loads(BINS).checked).plan).data
    assert is_accepted(data)
    for name, values in WRONG[place].items():
        for value in values:
            assert not is_accepted(changed(data, Section[section], record, name, value)), name


def test_a_cross_with_wrong_or_too_many_axes_is_refused():
    data = pack(Bins(rvmon.loads(BINS).checked).plan).data
    plan = Plan(data)
    first, count = plan.records["GROUPS"][-1]["axes"]
    at = plan.places[Section.LISTS][0] + 4 * first
    assert (count, plan.run("LISTS", first, count)) == (4, (0, 2, 2, 2))
    for axes in ((0, 0, 2, 2), (-1, 2, 2, 2), (6, 2, 2, 2), (0, 2, 2, 1 << 30)):
        wrong = with_numbers(data, {at + 4 * number: one for number, one in enumerate(axes)})
        assert not is_accepted(wrong)
    made = Bins(rvmon.loads(BINS).checked).plan
    large = replace(made, groups=(WatchGroup((range(7),) * 8, None),))
    with pytest.raises(RvmonError, match="combinations"):
        pack(large)


def counts(made, run):
    """Hits of each bin, by coverpoint or cross."""
    hits = made.hits(run.hits())
    return {name: {item: one.count for item, one in own.items()} for name, own in hits.items()}


def test_a_reset_clears_the_hits():
    made, planned = bins(BINS)
    run = planned.monitor(frozenset())
    for _ in range(2):
        assert not any(run.hits())
        for t, values in enumerate([{"p": True, "q": True, "e": True}, {"e": True}, {"p": False}]):
            assert run.judge(t, values, True)
        assert counts(made, run)["all"] == {"yes × e": 2, "yes × both": 1}
        assert [one.first for one in made.hits(run.hits())["level"].values()] == [0, 2]
        run.reset()


def test_a_loaded_run_goes_on_counting_hits():
    """A bin that was true before the snapshot is part of a cross hit after it."""
    made, planned = bins(BINS)
    run = planned.monitor(frozenset())
    assert run.judge(0, {"p": True, "q": False}, True)
    again = planned.monitor(frozenset())
    assert again.load(run.save())
    assert again.judge(1, {"q": True}, True)
    assert counts(made, again)["all"] == {"yes × both": 1}
    assert counts(made, again)["asked"] == {"yes": 1}


def test_a_late_sample_hits_no_bin():
    made, planned = bins(BINS)
    run = planned.monitor(frozenset())
    assert run.judge(0, {"p": True, "q": False}, True)
    assert run.judge(9, {"p": False}, True)
    assert run.late([0, 1], 5)
    assert counts(made, run)["level"] == {"yes": 1, "no": 1}


@pytest.mark.parametrize("time", ["held", "sampled", "sampled every 1 ns"])
def test_an_outage_hits_no_bin_and_ends_no_stretch(time):
    """After an outage nobody knows when an occasion came, nor whether a stretch had ended."""
    made, planned = bins(f"time {time}\n{BINS}")
    run = planned.monitor(frozenset())
    assert run.judge(0, {"p": True, "q": False}, True)
    assert run.lose([0, 1], 5)
    assert run.found([0, 1], 8)
    assert run.judge(9, {"p": True, "q": True}, True)
    assert run.judge(12, {"q": False}, True)
    assert run.judge(15, {"q": True}, True)
    run.finish(20)
    of_asked = {"level": {"yes": 1}, "often": {"both": 2}, "asked": {"yes": 1}}
    assert counts(made, run) == {**of_asked, "all": {"yes × both": 2}}
    assert made.hits(run.hits())["asked"]["yes"].first == 15


MANY = "signal a, b : bool\nrequirement {0}\n  upon a\n  then within {1} s b\n"


def traced(text):
    """The plan of requirements whose attempts are traced through their automata."""
    compiled = compile_spec(rvmon.loads(text).checked)
    plan = plan_alone(compiled, traced=list(compiled.requirements))
    data = pack(plan).data
    ids = tuple(compiled.requirements)
    return compiled, data, planned_as(compiled.checked, ids, Kept(data, frozenset(), frozenset()))


def moves(run, number):
    """How often, and when first, attempts moved from one location to another."""
    locations, counted = run.passages(number)
    return {
        divmod(place, locations): hit
        for place, hit in enumerate(struct.iter_unpack("=qq", counted))
        if hit[0]
    }


def test_a_run_of_attempts_that_moves_together_counts_all_of_them():
    text = MANY.format("R", 3000) + MANY.format("S", 5).partition("\n")[2]
    compiled, data, planned = traced(text)
    one, other = Plan(data).records["AUTOMATA"][:2]
    assert one["edges"] == other["edges"]
    automaton = compiled.requirements["R"].automaton
    start = automaton.initial
    (waiting,) = set(range(2, len(automaton.locations))) - {start}
    run = planned.monitor(frozenset())
    second = 10**9
    for k in range(100):
        assert run.judge(2 * k * second, {"a": True, "b": False}, True)
        assert run.judge((2 * k + 1) * second, {"a": False}, True)
    assert run.judge(200 * second, {"b": True}, True)
    run.finish(None)
    begun, fast, slow = {(start, start): (100, 0)}, 2, 98
    assert moves(run, 0) == begun | {(start, waiting): (100, 0), (waiting, 1): (100, 200 * second)}
    late = 5 * second + 1
    assert moves(run, 1) == begun | {
        (start, waiting): (100, 0),
        (waiting, 0): (slow, late),
        (waiting, 1): (fast, 200 * second),
    }
    run.reset()
    assert moves(run, 0) == {}


def test_an_attempt_whose_letter_is_unknown_makes_no_move():
    """An unknown value that changes nothing does not make the letter unknown."""
    text = "signal a, b, c : bool\nrequirement R\n  upon a\n  then within 2 s (b and not c)\n"
    compiled, _, planned = traced(text)
    start = compiled.requirements["R"].automaton.initial
    run = planned.monitor(frozenset())
    for t, values in enumerate(
        [{"a": True, "b": None, "c": False}, {"a": False, "b": False}, {"a": True, "c": None}]
    ):
        assert run.judge(t, values, True)
    run.finish(3)
    assert moves(run, 0)[start, start] == (1, 2)


def test_moves_are_counted_only_in_small_automata():
    compiled, data, planned = traced(MANY.format("R", 3))
    planned.monitor(frozenset())
    for section, record, name, value in (
        (Section.AUTOMATA, "automaton_plan", "locations", (65,)),
        (Section.JUDGES, "judge_plan", "automaton", (-1,)),
    ):
        wrong = Kept(changed(data, section, record, name, value), frozenset(), frozenset())
        with pytest.raises(ValueError, match="plan"):
            planned_as(compiled.checked, ("R",), wrong).monitor(frozenset())
