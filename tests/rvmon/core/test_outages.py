"""Names that are lost for a while: what the core says of them, by the sentences of SEMANTICS 1."""

from __future__ import annotations

import random
from dataclasses import replace
from typing import Any

import pytest
from tests.tools.differential import campaign, case_of
from tests.tools.forms import Compiler, Maker
from tests.tools.late import after_late
from tests.tools.law import judge

import rvmon
from rvmon import native
from rvmon.monitor.compiled_spec import CompiledSpec, compile_spec
from rvmon.monitor.planned import PlannedCore, planned_core
from rvmon.monitor.records import report_of_run
from rvmon.spec.checked.specification import TimeModel
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile
from rvmon.verdict.report import Report

NAMES = """
signal p, q : bool
signal x : real
signal s : bool stale after 2 ns
event e
event g(k: int)
"""


def planned(requirements: str, time: str = "held") -> PlannedCore:
    """The plan of some requirements over the names above."""
    spec = rvmon.loads(f'spec some "thing"\ntime {time}\n{NAMES}\n{requirements}')
    compiled: CompiledSpec = compile_spec(spec.checked)
    return planned_core(compiled)


class Run:
    """A run of the core, told in few words.

    Args:
        requirements: as text.
        time: the model of it.
    """

    def __init__(self, requirements: str, time: str = "held") -> None:
        self._planned = planned(requirements, time)
        self.core: native.Monitor = self._planned.monitor(frozenset())

    def sample(self, t: int, **values: Any) -> Run:
        """Take a sample; true is an occurrence of an event."""
        assert self.core.judge(t, values, True)
        return self

    def lost(self, names: str, first: int, last: int) -> Run:
        """Lose names, and find them again."""
        assert self.lose(names, first)
        assert self.found(names, last)
        return self

    def lose(self, names: str, since: int) -> bool:
        """Lose names; whether they can be."""
        return self.core.lose([self._planned.numbers[name] for name in names.split()], since)

    def found(self, names: str, at: int) -> bool:
        """Find them again; whether they can be."""
        return self.core.found([self._planned.numbers[name] for name in names.split()], at)

    def late(self, names: str | None, t: int) -> None:
        """Tell of a sample that came too late; `None`: it cannot be read."""
        numbers = None if names is None else [self._planned.numbers[one] for one in names.split()]
        assert self.core.late(numbers, t)

    def report(self, end: int | None = None) -> Report:
        """End the run."""
        return report_of_run(self._planned, self.core, 0, self.core.finish(end))

    def said(self, end: int | None = None) -> list[str]:
        """Of each attempt when it was triggered, its verdict, and when it was decided."""
        found = []
        for one in self.report(end).attempts:
            decided = "" if one.decided is None else f" {one.decided}"
            mark = "?" if one.in_doubt else ""
            found.append(f"{one.triggered}{mark} {one.verdict.value}{decided}")
        return found


def at_each(condition: str, count: int) -> str:
    """A requirement for each of the first instants: there the condition holds."""
    return "\n".join(
        f"requirement R{t}\n  upon start\n  then eventually[{t} ns, {t} ns] ({condition})"
        for t in range(count)
    )


def marks(report: Report, count: int) -> str:
    """`+`, `-`, or `?` where it is not known, for each of them."""
    of = {"P": "+", "F": "-", "I": "?"}
    return "".join(of[report.verdicts[f"R{t}"].value] for t in range(count))


@pytest.mark.parametrize(
    ("condition", "expected"),
    [
        ("p", "++???+"),
        ("e", "--???-"),
        ("updated(p)", "+-???-"),
        ("updated(e)", "--???-"),
        ("changed(p)", "--???-"),
        ("known(p)", "++???+"),
        ("q", "++++++"),
        ("p or q", "++++++"),
        ("once[0 s, 1 ns] e", "--????"),
        ("age(p) > 1 ns", "--????"),
        ("age(p) > 4 ns", "-----?"),
    ],
)
def test_within_it_at_every_tick_all_is_unknown(condition, expected):
    """From the tick behind it on, what bore the last instant counts."""
    run = Run(at_each(condition, 6)).sample(0, p=True, q=True)
    assert run.lose("p e", 2)
    run.sample(3, p=False, e=True)
    assert run.found("p e", 4)
    assert marks(run.sample(4, p=True, e=True).report(5), 6) == expected


@pytest.mark.parametrize(
    ("told", "expected"),
    [
        ([(6, True)], "++????+"),
        ([(3, False), (6, True)], "++????+"),
        ([(4, True)], "++???++"),
        ([], "++?????"),
    ],
)
def test_a_signal_is_known_from_its_first_update_on(told, expected):
    """One that was read within may have been followed by one that was lost."""
    run = Run(at_each("p", 7)).sample(0, p=True)
    assert run.lose("p", 2)
    found = False
    for t, value in told:
        if t >= 4 and not found:
            found = run.found("p", 4)
        run.sample(t, p=value)
    assert found or run.found("p", 4)
    assert marks(run.report(6), 7) == expected


def test_of_one_instant_nobody_knows_what_came_last():
    """What was read there may have come before and behind what was lost."""
    run = Run(at_each("p", 4)).sample(0, p=True).lost("p", 2, 2).sample(2, p=True)
    assert marks(run.report(3), 4) == "++??"


def test_another_update_ends_nothing():
    """It is a state of names, entered and left by whoever opens the door."""
    run = Run(at_each("p", 5)).sample(0, p=True)
    assert run.lose("p", 1)
    run.sample(2, q=True).sample(3, p=True)
    assert marks(run.report(4), 5) == "+????"


@pytest.mark.parametrize(
    ("condition", "expected"), [("known(s)", "++??????--"), ("s", "++????????")]
)
def test_what_would_be_stale_by_now_is_not_known(condition, expected):
    """`known` is unknown behind an outage until the last possible loss would be stale."""
    run = Run(at_each(condition, 10)).sample(0, s=True).lost("s", 2, 5)
    assert marks(run.report(9), 10) == expected


@pytest.mark.parametrize("function", ["prev", "delta", "rate"])
def test_two_updates_behind_it_are_known_by_the_second(function):
    """As long as they depend on it they are unknown."""
    run = Run(at_each(f"{function}(x) >= 0", 8)).sample(0, x=1.0).sample(1, x=1.0)
    run.lost("x", 2, 3).sample(5, x=2.0).sample(7, x=3.0)
    assert marks(run.report(7), 8) == "?+?????+"


def test_an_update_behind_it_may_be_no_change():
    """What came before it is not known."""
    run = Run(at_each("changed(p)", 6)).sample(0, p=True).lost("p", 2, 3)
    assert marks(run.sample(4, p=False).sample(5, p=True).report(5), 6) == "--??" + "?+"


def test_what_was_lost_is_born():
    """What is not there yet is excused, what was lost is not."""
    always = "requirement R\n  whenever true\n  then q"
    assert Run(always).sample(0, p=True).sample(2, q=True).said(3) == ["0 P 3"]
    run = Run(always).sample(0, p=True).lost("q", 1, 1)
    assert run.sample(2, q=True).said(3) == ["0 I"]


def test_what_an_outage_swallowed_may_not_be_born():
    """A `since` of which all was lost is unknown, though its left side be false."""
    text = "requirement R\n  upon start\n  then eventually[4 ns, 4 ns] (q since[1 ns, {}] p)"
    short = Run(text.format("2 ns")).sample(0, q=False).lost("p", 1, 2)
    assert short.said(5) == ["0 I"]
    long = Run(text.format("4 ns")).sample(0, q=False, p=True).lost("p", 1, 2)
    assert long.said(5) == ["0 F 5"]


@pytest.mark.parametrize(("time", "first"), [("held", -8), ("sampled every 4 ns", -8)])
def test_a_trace_may_begin_in_an_outage(time, first):
    """Before the first sample there may be a position; `start` is there, or here."""
    lost = ("q", -8, -7)
    run = Run("requirement R\n  upon start\n  then p", time).lost(*lost)
    assert run.sample(0, p=True).said(4) == [f"{first}? I"]
    run = Run("requirement R\n  whenever p\n  then not p", time).lost(*lost)
    assert run.sample(0, p=True).said(4) == [f"{first} F 0"]


def test_an_outage_that_ends_where_the_trace_begins_hides_no_position():
    """The first sample is at its last instant: nothing can have come before that."""
    assert Run("requirement R\n  upon start\n  then q").lost("p", 0, 0).sample(
        0, q=True
    ).said() == ["0 P 0"]


def test_a_trace_without_samples_is_not_known():
    """There may be one; the trace reaches to the last instant."""
    run = Run("requirement R\n  upon start\n  then p").lost("p", 0, 5)
    report = run.report()
    assert (report.end, report.verdicts["R"].value) == (5, "I")


def test_a_trace_reaches_to_the_last_instant():
    """That time went on was not lost, and policies know nothing better."""
    within = "requirement R\n  upon start\n  then within 3 ns p"
    assert Run(within).sample(0, p=False).lost("q", 2, 5).said() == ["0 F 4"]
    always = "requirement R\n  always p"
    assert Run(always).sample(0, p=True).lost("q", 2, 5).said() == ["0 P 5"]
    assert Run(always).sample(0, p=True).lost("p", 5, 5).said() == ["0 I"]
    settled = f"{always}\n  at end: pass"
    assert Run(settled).sample(0, p=True).lost("p", 5, 5).said() == ["0 I"]


def test_what_is_lost_at_the_end_is_lost_up_to_there():
    """Nobody has to say that it was found."""
    run = Run("requirement R\n  always p").sample(0, p=True)
    assert run.lose("p", 3)
    assert run.said(7) == ["0 I"]


def test_a_trigger_may_be_hidden():
    """All positions at which it may be make one attempt in doubt."""
    run = Run("requirement R\n  upon e\n  then q").sample(0, q=False).lost("e", 2, 4)
    assert run.said(6) == ["2? I"]
    run = Run("requirement R\n  upon e\n  then q").sample(0, q=True).lost("e", 2, 4)
    assert run.report(6).verdicts["R"].value == "NT"


def test_an_occurrence_that_was_lost_may_be_of_any_key():
    """Also of one never seen: it has an instance of its own, in doubt."""
    text = "requirement R\n  upon g.k == id\n  then q\n  for each id in g.k"
    run = Run(text).sample(0, q=False, g={"k": 3}).lost("g", 2, 3)
    found = [(one.triggered, one.in_doubt, one.captured["id"]) for one in run.report(5).attempts]
    assert sorted(found, key=str) == [(0, False, 3), (2, True, 3), (2, True, None)]


def test_of_a_clock_an_event_that_was_lost_counts_at_the_next_tick():
    """Held values read outside of the outage, in the same period, still count."""
    text = "requirement R\n  upon e\n  then {}"
    run = Run(text.format("q"), "sampled every 4 ns").sample(0, q=False).lost("e", 5, 6)
    assert run.said(12) == ["8? I"]
    run = Run(text.format("p"), "sampled every 4 ns").sample(0, p=False).lost("p", 5, 6)
    assert run.sample(7, p=True, e=True).said(12) == ["8 P 8"]


def test_what_was_judged_cannot_be_lost_any_more():
    """It is refused, and nothing happens."""
    run = Run(at_each("p", 4)).sample(0, p=True).sample(2, p=True)
    assert not run.lose("p", 2)
    assert not run.lose("p", -1)
    assert marks(run.report(3), 4) == "++++"


def test_the_end_is_an_advance_to_the_tick_behind_it():
    """A window that ends at the end is over."""
    text = "requirement R\n  upon start\n  then {}"
    assert Run(text.format("always[0 s, 0 s] p"), "sampled").sample(0, p=True).said() == ["0 P 1"]
    assert Run(text.format("within 2 ns p")).sample(0, p=False).said(2) == ["0 F 3"]


@pytest.mark.parametrize("names", [[99], [-1]])
def test_what_is_no_name_cannot_be_lost(names):
    """Names are told by their numbers in the plan."""
    run = planned("requirement R\n  always p").monitor(frozenset({"q"}))
    with pytest.raises(ValueError, match="no such name"):
        run.lose(names, 0)


def test_names_come_as_numbers():
    """Whatever can be gone through will do; of names without a source nothing is lost."""
    run = planned("requirement R\n  always p").monitor(frozenset({"q"}))
    assert run.lose(iter([1]), 0)
    assert run.found((), 0)
    with pytest.raises(TypeError):
        run.lose(3, 1)
    with pytest.raises(TypeError):
        run.lose(["p"], 1)


def test_of_samples_each_tick_may_be_a_position_or_none():
    """Whatever was read there, every formula is unknown, constants too."""
    text = "requirement R\n  upon start\n  then {}"
    for formula in ("eventually[2 ns, 3 ns] true", "next p", "always[1 ns, 4 ns] p"):
        run = Run(text.format(formula), "sampled").sample(0, p=True).lost("q", 2, 2)
        assert run.sample(5, p=True).said(9) == ["0 I"], formula
    run = Run(text.format("eventually[6 ns, 8 ns] p"), "sampled").sample(0, p=True).lost("q", 2, 2)
    assert run.sample(7, p=True).said(9) == ["0 P 7"]


def test_of_samples_what_was_read_within_is_held_behind():
    """Of names that were not lost; it is no update there."""
    text = "requirement R\n  upon e\n  then {}"
    for formula, expected in (("p", "8 P 8"), ("updated(p)", "8 F 8"), ("q", "8 I")):
        run = Run(text.format(formula), "sampled").sample(0, p=False, q=True)
        assert run.lose("q", 2)
        run.sample(3, p=True, q=True)
        assert run.found("q", 5)
        assert expected in run.sample(8, e=True).said(), formula


def test_of_samples_before_the_first_there_may_be_another():
    """`start` is there, or here."""
    run = Run("requirement R\n  upon start\n  then p", "sampled").lost("q", -8, -7)
    assert run.sample(0, p=True).sample(1).said() == ["-8? I"]


@pytest.mark.parametrize(("last", "expected"), [(18, "NT"), (19, "I")])
def test_of_samples_a_trigger_can_be_hidden_from_the_second_tick_on(last, expected):
    """At the first one there is no edge if it was true before."""
    run = Run("requirement R\n  upon p\n  then true", "sampled").sample(0, p=False)
    run.sample(1, p=None).sample(4, p=True).lost("", 18, last)
    assert run.report().verdicts["R"].value == expected


def test_of_samples_nothing_is_captured_within():
    """What is captured there is not known, though the value was read."""
    text = "requirement R\n  upon end\n  then true\n  let v = x"
    report = Run(text, "sampled").sample(0, x=1.0).lost("", 3, 3).report()
    assert [dict(one.captured) for one in report.attempts] == [{"v": None}]


def test_of_a_clock_a_key_that_came_before_a_lost_tick_is_not_known():
    """It counts at the tick, at which whatever occurred is unknown; the next time it is known."""
    text = "requirement R\n  upon start\n  then true\n  for each id in g.k"
    run = Run(text, "sampled every 4 ns").sample(1, g={"k": 0}).lost("g", 3, 4)
    assert run.report().verdicts["R"].value == "NT"
    text = "requirement R\n  upon g.k == id\n  then true\n  for each id in g.k"
    run = Run(text, "sampled every 4 ns").sample(1, g={"k": 0}).lost("g", 3, 4)
    found = run.sample(6, g={"k": 0}).report(8).attempts
    assert [(one.triggered, one.captured["id"]) for one in found if not one.in_doubt] == [(8, 0)]


def test_behind_an_outage_of_sampled_time_each_instance_sees_the_next_sample():
    """Also one that the sample says nothing of."""
    text = "requirement R\n  upon p\n  then p\n  for each id in g.k"
    run = Run(text, "sampled").sample(6, g={"k": -2}).sample(8, p=False).lost("", 17, 17)
    found = run.sample(18).sample(19, p=None).report().attempts
    assert (19, -2) in [(one.triggered, one.captured["id"]) for one in found]


@pytest.mark.parametrize("time", ["held", "sampled"])
@pytest.mark.parametrize(
    ("requirement", "expected"),
    [
        ("upon e\n  then within 3 {0} p", "I"),
        ("upon e\n  then within 8 {0} p", "P"),
        ("upon e\n  then always[0 {0}, 1 {0}] p", "F"),
        ("upon e\n  then always[0 {0}, 9 {0}] within 4 {0} p", "I"),
        ("upon e\n  then (p until[0 {0}, 3 {0}] q) or eventually[4 {0}, 5 {0}] p", "P"),
        ("upon p\n  then historically[5 {0}, 6 {0}] p", "I"),
        ("whenever p\n  then not q", "F"),
    ],
)
def test_long_outages_are_as_short_ones(time, requirement, expected):
    """However many ticks they have; of samples each of them may have been a trigger, too."""
    for unit, scale in (("ns", 1), ("s", 1_000_000_000)):
        run = Run(f"requirement R\n  {requirement.format(unit)}", time)
        run.sample(0, p=False, q=True, e=True).lost("p", 2 * scale, 5 * scale)
        found = run.sample(7 * scale, p=True).report(20 * scale)
        in_doubt = time == "sampled" and expected == "P"
        assert found.verdicts["R"].value == ("I" if in_doubt else expected), unit


def test_of_many_ticks_a_network_says_nothing():
    """Better than something wrong, also of what looks back at them later."""
    text = "requirement R\n  upon e\n  then once[0 s, 4 {0}] (eventually[0 s, 1 {0}] p)"
    for unit, scale in (("ns", 1), ("s", 1_000_000_000)):
        run = Run(text.format(unit), "sampled").sample(0, p=False).lost("q", 2 * scale, 5 * scale)
        found = run.sample(7 * scale, p=False, e=True).sample(9 * scale).said()
        assert found == [f"{7 * scale} I", f"{2 * scale}? I"]


TWO = "requirement A1\n  always p\nrequirement B1\n  upon e\n  then q"


@pytest.mark.parametrize(
    ("names", "t", "expected"),
    [
        ("p", 1, "I P"),
        ("q", 1, "P I"),
        ("e", 1, "P I"),
        ("x s", 1, "P P"),
        ("", 1, "P P"),
        (None, 1, "I I"),
        ("x", -1, "I I"),
    ],
)
def test_what_comes_too_late_leaves_nothing_green_that_it_would_have_touched(names, t, expected):
    """What reads one of its names, or all if it cannot be read, or the trace would begin there."""
    run = Run(TWO).sample(0, p=True, q=True).sample(2, e=True)
    run.late(names, t)
    verdicts = run.report().verdicts
    assert " ".join(verdicts[name].value for name in ("A1", "B1")) == expected


def test_what_comes_too_late_takes_back_no_alarm():
    """An attempt that begins behind it fails as ever, and the next run knows nothing of it."""
    run = Run(TWO).sample(0, p=True, q=False)
    run.late("p q", 0)
    report = run.sample(2, e=True).report()
    assert [report.verdicts[name].value for name in ("A1", "B1")] == ["I", "F"]
    run.core.reset()
    assert run.sample(0, p=True, q=True).report().verdicts["A1"].value == "P"


@pytest.mark.law
def test_random_samples_too_late_leave_what_the_law_leaves():
    """Of each requirement the verdict."""
    traces = TraceProfile(unknowns=False, advances=False, fewest=3)
    changed = 0
    for number in range(90):
        case = case_of(f"late/{number}", Profile(captures=False), traces)
        rng = random.Random(number)
        if len(case.samples) < 3:
            continue
        late = rng.choice(case.samples[:-1])
        kept = replace(case, actions=tuple(one for one in case.samples if one is not late))
        compiled = compile_spec(case.spec)
        plan = planned_core(compiled)
        run = plan.monitor(frozenset())
        for sample in kept.samples:
            assert run.judge(sample.t, plan.plain(sample.t, sample.values), True)
        without = judge(kept).verdicts
        assert run.late([plan.numbers[name] for name in late.values], late.t)
        verdicts = report_of_run(plan, run, 0, run.finish(kept.end)).verdicts
        expected = after_late(case.spec, without, kept.samples, [late])
        first = case.spec.time is TimeModel.SAMPLED or late.t < kept.samples[0].t
        for name, one in compiled.requirements.items():
            if not first and one.reads.isdisjoint(late.values):
                expected[name] = without[name]  # what a formula does not depend on is not read
        assert verdicts == expected
        changed += verdicts != without
    assert changed > 15


@pytest.mark.law
@pytest.mark.parametrize("time", TimeModel)
def test_random_outages_are_judged_as_the_law_has_it(time):
    """Step by step and by rows; what looks back at the future is tried elsewhere."""
    seeds = [f"outages/{time.name}/{number}" for number in range(20)]
    profile = Profile(time=time, crowded=5, mixed=False)
    compiler = Compiler()
    makers = {form: Maker(form, compiler) for form in ("c", "c rows")}
    traces = TraceProfile(sparse=10, outages=80)
    found = campaign(makers, seeds, profile, traces, each=5)
    assert not found.disagreements, found.disagreements[0]
    assert found.counts["pairs with outages"] > 60


def test_what_was_learnt_of_a_value_before_all_was_born_is_no_news_in_an_outage() -> None:
    """A trigger that rises while another signal is lost starts an attempt, whatever came before."""
    run = Run("requirement R upon p then immediately once[0, 9 ns] q and x > 1")
    run.sample(4, p=True).sample(5, p=True, q=False).sample(7, p=False)
    assert run.lose("x", 12)
    report = run.sample(12, p=True).report()
    assert [(one.triggered, one.verdict.value) for one in report.attempts] == [
        (12, "F"),
        (4, "I"),
    ]


def test_what_was_learnt_of_a_value_in_one_outage_is_no_news_in_the_next() -> None:
    """A limit that was passed between two outages is kept, and passed again, in the second."""
    run = Run("requirement R upon x > 1 then immediately q")
    run.sample(1, x=0.5, q=False, p=False).lost("q", 2, 3).sample(3, x=0.7).sample(6, q=False)
    assert run.sample(8, x=2.0).lose("q", 10)
    report = run.sample(11, x=0.5).sample(12, x=2.0).report()
    assert [(one.triggered, one.verdict.value) for one in report.attempts] == [
        (8, "F"),
        (12, "I"),
    ]
