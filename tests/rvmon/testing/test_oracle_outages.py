"""What an outage hides: worked out by hand from SEMANTICS 1."""

from typing import Any

import pytest
from tests.tools.build import (
    always,
    compared,
    e,
    end,
    eventually,
    following,
    held,
    k,
    no,
    once,
    p,
    previous,
    probe,
    q,
    requirement,
    true,
    two,
    x,
)
from tests.tools.each import each

from rvmon.language.checked.formula import Captured, Formula, UpdateFunction, UpdateValue
from rvmon.language.checked.specification import Capture, EndPolicy, ForEach, TimeModel
from rvmon.testing.law.word import Outage

pytestmark = pytest.mark.slow

SAMPLED = {"time": TimeModel.SAMPLED}
EVERY_4 = {"time": TimeModel.CLOCKED, "period": 4}


def at(t: int, formula: Formula) -> Formula:
    return eventually(formula, t, t)


UPDATES = {"p": "11...0.1", "lost": [("p", 2, 3)], "end": 8}
TWO_UPDATES = {"x": "11...2.3", "lost": [("x", 2, 3)], "end": 8}


@each(
    ("formula", "told", "expected"),
    [
        # Within it, whatever was read there; behind it, from the first update at its end or later.
        (p, {"p": "1....1", "lost": [("p", 2, 3)]}, "PPIIIP"),
        (p, {"p": "1..1", "lost": [("p", 2, 3)], "end": 5}, "PPIIPP"),
        (p, {"p": "1..1", "lost": [("p", 3, 3)], "end": 5}, "PPPIII"),
        # What ends one outage may lie in another.
        (p, {"p": "1..1.1", "lost": [("p", 2, 3), ("p", 3, 5)], "end": 6}, "PPIIIIP"),
        # `known` is unknown until what was lost last would be stale.
        (
            probe("known", "p"),
            {"p": "1", "lost": [("p", 2, 3)], "stale": {"p": 2}, "end": 8},
            "PPIIIIFF",
        ),
        # An event is unknown within, seen or not, and known again at once.
        (e, {"p": "1.....", "e": "..1", "lost": [("e", 1, 3)], "end": 5}, "FIIIFF"),
        # What is asked of updates is unknown within; the first one behind it may be no change.
        (probe("updated", "p"), UPDATES, "PPIIFPFP"),
        (probe("changed", "p"), UPDATES, "FFIIFIFP"),
        (probe("known", "p"), UPDATES, "PPIIIPPP"),
        # `prev`, `delta` and `rate` are unknown until the second update behind it.
        *(
            (compared(UpdateValue(function, "x"), ">=", 0), TWO_UPDATES, "IPIIIIIP")
            for function in UpdateFunction
        ),
    ],
)
def test_when_it_is_known_again(judge: Any, formula: Formula, told: Any, expected: str) -> None:
    """What is so at each instant from 0 on: what passes is decided there, what fails behind it."""
    found = [judge(at(t, formula), **told)[0] for t in range(len(expected))]
    decided = {"P": " {0}", "F": " {1}", "I": ""}
    assert found == [f"0 {one}{decided[one].format(t, t + 1)}" for t, one in enumerate(expected)]


def test_an_attempt_may_begin_within(judge: Any) -> None:
    told = {"p": "1.....", "e": "..1", "lost": [("e", 1, 3)], "end": 5}
    assert judge(requirement(q, upon=e), **told) == ["1 I"]
    assert judge(requirement(q, upon=e), **told, q="1") == []


def test_an_age_is_an_interval(judge: Any) -> None:
    """It lies between the time since the outage and that since the last update read."""
    told = {"p": "1", "lost": [("p", 4, 6)], "end": 11}
    older = [no(once(probe("updated", "p"), 0, age)) for age in range(12)]
    assert [judge(at(10, one), **told)[0][2] for one in older] == list("PPPPIIIIIIFF")


def test_what_was_lost_is_born(judge: Any) -> None:
    """What is not there yet is excused, what was lost is not."""
    told = {"p": "1", "q": "..1", "end": 3}
    always_q = requirement(q, whenever=true)
    assert judge(always_q, **told) == ["0 P 3 held"]
    assert judge(always_q, **told, lost=[("q", 1, 1)]) == ["0 I"]
    assert judge(always_q, **told, lost=[("p", 1, 1)]) == ["0 P 3 held"]


def test_what_was_lost_may_not_be_born(judge: Any) -> None:
    """`q since p` is unborn if `p` is throughout the window, whatever `q` is."""
    told = {"q": "0", "end": 5, "lost": [("p", 1, 2)]}
    assert judge(at(4, two(q, "S", p, 1, 2)), **told) == ["0 I"]
    assert judge(at(4, two(q, "S", p, 1, 4)), **told, p="1") == ["0 F 5"]


@pytest.mark.parametrize("time", [{}, EVERY_4, SAMPLED])
def test_a_trace_may_begin_in_an_outage(judge: Any, time: Any) -> None:
    """Before the first sample there may be a position; `start` is there or here."""
    told = {"p": "1...1...1", "lost": [("q", -8, -7)], **time}
    assert judge(p, **told) == ["-8 I"]
    assert judge(requirement(no(p), whenever=p), **told) == ["-8 F 0"]
    # The first sample is at its last instant: nothing can have come before that.
    assert judge(p, p="1", lost=[("q", 0, 0)]) == ["0 P 0"]


def test_how_long_a_trace_has_lasted(judge: Any) -> None:
    """It may have begun in an outage, so that `held` is neither true nor false."""
    told = {"p": "1", "e": "...11", "lost": []}
    held_4 = requirement(held(p, 4), upon=e)
    assert judge(held_4, **told) == ["3 F 3", "4 P 4"]
    assert judge(held_4, **{**told, "lost": [("q", -1, -1)]}) == ["4 P 4", "3 I", "-1 I"]
    told = {"p": "1.1", "e": "..1", **SAMPLED}
    assert judge(requirement(held(p, 4), upon=e), **told) == ["2 F 2"]
    assert judge(requirement(held(p, 4), upon=e), **told, lost=[("q", -8, -8)]) == ["2 I", "-8 I"]


def test_a_trace_without_samples(judge: Any) -> None:
    """There may be one, and nothing is known of it."""
    assert judge(eventually(p, 0, 2), lost=[("p", 0, 5)]) == ["0 I"]


@pytest.mark.parametrize("time", [{}, EVERY_4])
def test_a_trace_reaches_to_the_end_of_an_outage(judge: Any, time: Any) -> None:
    """That time went on was not lost."""
    assert judge(eventually(p, 0, 3), p="0", lost=[("q", 2, 5)], **time) == ["0 F 4"]
    assert judge(always(p), p="1", lost=[("q", 2, 5)], **time) == ["0 P 5 held"]
    for policy in (EndPolicy.DEFAULT, EndPolicy.PASS):
        required = requirement(always(p), at_end=policy)
        assert judge(required, p="1", lost=[("p", 5, 5)]) == ["0 I"]


@pytest.mark.parametrize("lost", ["q", ""])
def test_sampled_time_may_have_positions_within(judge: Any, lost: str) -> None:
    """Whether there are is unknown, and so is every formula, of whatever names."""
    told = {"p": "1....1.1", "lost": [(lost, 2, 3)], **SAMPLED}
    # The trigger may hold there, for the first time behind position 0: one attempt in doubt.
    assert judge(eventually(true, 2, 3), **told) == ["0 I", "3 I"]
    assert judge(always(p, 0, 4), **told) == ["0 I", "3 I"]
    assert judge(following(p), **told) == ["0 I", "3 I"]
    assert judge(no(eventually(p, 1, 5)), **told) == ["0 F 5", "3 I"]
    assert judge(requirement(true, upon=p), **told) == ["0 P 0", "3 I"]
    looks_back = requirement(previous(p), upon=probe("updated", "p"))
    assert judge(looks_back, **told) == ["0 F 0", "7 P 7", "5 I", "2 I"]


@pytest.mark.parametrize(
    ("explicit", "short"),
    [
        (two(true, "U", p), eventually(p)),
        (two(two(true, "or", q), "U", p), eventually(p)),
    ],
)
def test_what_is_always_true_asks_for_no_position(
    judge: Any, explicit: Formula, short: Formula
) -> None:
    """`F` is `true U` where there may be positions, too."""
    for rows in ("1....1.0", "0....0.1", "1....1.1", "0.....0.0"):
        told = {"p": rows, "e": "......11", "lost": [("q", 2, 3)], **SAMPLED}
        assert judge(requirement(explicit, upon=e), **told) == judge(
            requirement(short, upon=e), **told
        )


def test_clocked_time_counts_what_was_lost_at_the_tick_behind(judge: Any) -> None:
    """An event or update between ticks belongs to the next one."""
    told = {"p": "1", "e": "1", "x": "1.....2..3", "end": 12, "lost": [("e x", 5, 5)], **EVERY_4}
    assert judge(at(4, e), **told) == ["0 F 5"]
    assert judge(at(8, e), **told) == ["0 I"]
    assert judge(requirement(p, upon=probe("changed", "x")), **told) == ["12 P 12"]
    assert judge(at(8, compared(x, "==", 2)), **told) == ["0 P 8"]


@pytest.mark.parametrize(
    ("read", "expected"), [(p, "P 8"), (probe("updated", "p"), "F 8"), (q, "I")]
)
def test_sampled_time_holds_behind_it_what_was_read_within(
    judge: Any, read: Formula, expected: str
) -> None:
    """Of names that were not lost; it is no update there."""
    told = {"p": "0..1", "q": "1..1", "e": "........1", "lost": [("q", 2, 5)], **SAMPLED}
    assert f"8 {expected}" in judge(requirement(read, upon=e), **told)


def test_sampled_time_hides_a_trigger_from_the_second_tick_on(judge: Any) -> None:
    """At the first one there is no edge if it was true before."""
    for last, expected in ((8, []), (9, ["1 I"])):
        told = {"p": "0u..1", "lost": [("", 8, last)], **SAMPLED}
        assert judge(requirement(true, upon=p), **told) == expected


def test_what_was_lost_may_be_of_any_key(judge: Any) -> None:
    """Also of one never seen: it has an instance of its own, in doubt."""
    its = {"for_each": ForEach("id", k)}
    own = compared(k, "==", Captured("id"))
    told = {"q": "0", "g": "3", "lost": [("g", 2, 3)], "end": 5}
    assert judge(requirement(q, upon=own, **its), **told) == ["0 F 0", "2 I", "2 I"]
    # A key that comes before a lost tick of a clock is not known; the next time it is.
    told = {"g": ".0....0", "lost": [("g", 3, 4)], "end": 8, **EVERY_4}
    assert judge(requirement(true, **its), g=".0", lost=[("g", 3, 4)], **EVERY_4) == []
    assert "8 P 8" in judge(requirement(true, upon=own, **its), **told)
    # Behind an outage of sampled time the next sample is one of each instance.
    told = {"g": "......2", "p": "........0.........1u", "lost": [("", 17, 17)], **SAMPLED}
    assert judge(requirement(p, upon=p, **its), **told)


def test_nothing_is_captured_within(judge: Any) -> None:
    """What is captured there is not known, though the value was read."""
    required = requirement(true, upon=end, captures=(Capture("v", x),))
    assert judge(required, x="1", lost=[("", 3, 3)], **SAMPLED) == ["3 I"]


def test_what_was_learnt_of_a_value_is_no_news_in_the_next_outage(judge: Any) -> None:
    """Neither before all was born, nor between two: a limit that is passed again triggers."""
    late = {"p": "....11.0....1", "q": ".....0", "lost": [("x", 12, 13)], "end": 12}
    required = requirement(two(once(q, 0, 9), "and", compared(x, ">", 1)), upon=p)
    assert judge(required, **late) == ["12 F 12", "4 I"]
    told = {"x": ".0.0....2..02", "q": ".0....0", "p": ".0", "lost": [("q", 2, 3), ("q", 10, 12)]}
    assert judge(requirement(q, upon=compared(x, ">", 1)), **told) == ["8 F 8", "12 I"]


def test_an_outage_takes_time() -> None:
    with pytest.raises(ValueError, match="no time at all"):
        Outage(frozenset(), 3, 2)
