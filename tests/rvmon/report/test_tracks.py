"""Timelines of signals and events."""

import random
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rvmon
from rvmon.recordings import places
from rvmon.recordings.held_recording import HeldRecording
from rvmon.report.changes import Course, Looks, changes_of
from rvmon.report.time_axis import View, round_instants, view_of
from rvmon.report.tracks import (
    PLACES,
    Threshold,
    Track,
    TrackKind,
    blamed_names,
    names_of_requirement,
    occurrences,
    polylines,
    readable,
    stretches,
    thresholds,
    tracks_of,
)
from rvmon.trace.sample import Outage, Sample
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Attempt, Blame
from rvmon.verdicts.report import report_of

SECOND = 1_000_000_000
SPEC_TEXT = """
spec arm
signal ok, other : bool input
signal gap : real [m] input stale after 200 ms
signal mode : {idle, moving} output
event go input
event pick(id: int) output
requirement R1
  upon go and mode == moving
  then within 2 s (gap >= 5 cm and 1 m > gap and pick.id == 3)
requirement R2
  upon ok
  then for 1 s not other
"""
SPEC = rvmon.loads(SPEC_TEXT).checked
R1, R2 = SPEC.requirements.values()


def track(name, samples, requirement=R1, absent=()):
    """The track of one name."""
    tracks = tracks_of(SPEC, requirement, changes_of(SPEC, samples), absent)
    return next(one for one in tracks if one.name == name)


def test_names_of_a_requirement_have_tracks_with_all_thresholds():
    """Names of the trigger come first; an event without a source is not drawn as absent."""
    assert names_of_requirement(R1) == ("go", "mode", "gap", "pick")
    assert names_of_requirement(R2) == ("ok", "other")
    assert thresholds(R1, "gap") == (Threshold(">=", 0.05), Threshold("<", 1.0))
    assert thresholds(R1, "mode") == ()
    assert track("go", [], absent={"go"}).absent
    assert not track("pick", [], absent={"go"}).absent


def test_unknown_is_shown_as_unknown():
    samples = [
        Sample(0, {"gap": 1.0}),
        Sample(100_000_000, {"gap": 1.0}),
        Sample(1 * SECOND, {"gap": float("nan")}),
        Sample(2 * SECOND, {"gap": 2.0}),
        Sample(2 * SECOND + 200_000_001, {"gap": None}),
    ]
    assert track("gap", samples).changes == (
        (0, 1.0),
        (300_000_001, None),
        (2 * SECOND, 2.0),
        (2 * SECOND + 200_000_001, None),
    )


def test_events_and_labels():
    samples = [
        Sample(0, {"mode": "idle", "pick": {"id": 3}}),
        Sample(1, {"pick": False}),
        Sample(2, {"pick": None, "mode": "moving"}),
    ]
    assert track("pick", samples).changes == ((0, True), (2, None))
    assert track("mode", samples).kind is TrackKind.LABEL
    assert track("mode", samples).value_at(1) == "idle"


def test_blame_names_only_what_failed():
    text = R1.span.source.text
    start = text.index("gap >= 5 cm")
    blame = Blame("gap >= 5 cm", start, start + 11, (0, 1))
    assert blamed_names(R1, blame) == {"gap"}
    assert blamed_names(R1, Blame("?", 0, 0, (0, 1))) == {"gap", "pick"}


def test_the_view_holds_the_whole_attempt():
    blame = Blame("x", 0, 1, (2 * SECOND, 9 * SECOND), (1 * SECOND,))
    attempt = Attempt(
        "R1", 1, 3 * SECOND, 7 * SECOND, Verdict.FAIL, deadline=12 * SECOND, blame=blame
    )
    view = view_of(attempt, report_of(["R1"], [attempt], end=60 * SECOND))
    assert view.start < 1 * SECOND
    assert view.end > 12 * SECOND


@pytest.mark.slow
@settings(deadline=None)
@given(st.integers(-(10**18), 10**18), st.integers(1, 10**15), st.integers(-(10**18), 10**18))
def test_an_axis_has_a_few_round_instants(start, length, origin):
    view = View(start, start + length)
    instants = round_instants(view, origin)
    assert 1 <= len(instants) <= 8 or length < 6
    assert all(view.start <= one <= view.end for one in instants)
    steps = {b - a for a, b in pairwise(instants)}
    assert len(steps) <= 1
    assert all((one - origin) % step == 0 for one in instants for step in steps)


@pytest.mark.slow
@settings(deadline=None)
@given(st.lists(st.tuples(st.integers(1, 10**6), st.integers(-50, 50)), max_size=3000))
def test_dense_numbers_keep_their_peaks(steps):
    times, t = [], 0
    for gap, _ in steps:
        t += gap
        times.append(t)
    known = ((t, float(value)) for t, (_, value) in zip(times, steps, strict=True))
    changes = Course.of([(0, 0.0), *known])
    end = (times[-1] if times else 0) + 10
    view = View(0, end)
    pieces = stretches(Track("x", TrackKind.NUMBER, changes), view, end)
    (line,) = polylines(pieces, -60.0, 60.0)
    assert len(line) <= 4 * PLACES + 4
    values = [piece.value for piece in pieces]
    heights = [60 - 120 * y for _, y in line]
    assert abs(max(heights) - max(values)) < 1e-6
    assert abs(min(heights) - min(values)) < 1e-6
    assert line == sorted(line, key=lambda point: point[0])


@pytest.mark.slow
def test_a_fast_switch_is_busy_not_lost():
    changes = Course.of([(t, bool(t % 2)) for t in range(10_000)])
    view = View(0, 20_000)
    drawn = readable(stretches(Track("x", TrackKind.SWITCH, changes), view, 20_000))
    assert [piece.busy for piece in drawn] == [True, False]
    assert drawn[0].right == drawn[1].left


@pytest.mark.slow
def test_many_events_keep_their_places():
    events = Track("x", TrackKind.EVENT, Course.of([(t, True) for t in range(100_000)]))
    shown = [place for place, _ in occurrences(events, View(0, 99_999))]
    assert len(shown) <= PLACES + 1
    assert min(shown) < 0.01
    assert max(shown) == 1


def test_nothing_is_drawn_behind_the_end_of_the_run():
    pieces = stretches(Track("x", TrackKind.SWITCH, Course.of([(0, True)])), View(0, 100), 40)
    assert [(piece.left, piece.right) for piece in pieces] == [(0, 0.4)]


@pytest.mark.law
def test_held_columns_give_the_tracks_of_samples(tmp_path, monkeypatch):
    for seed in range(30):
        rng, t, rows = random.Random(seed), 0, ["t,gap,mode,go,pick,pick.id"]
        for _ in range(60):
            t += rng.choice([0, 1, 100_000_000, 200_000_000, 200_000_001, SECOND])
            gap = rng.choice(["1.0", "2", "nan", ""])
            mode = rng.choice([*SPEC.signals["mode"].type.labels, ""])
            cells = [gap, mode, rng.choice(["0", "1", ""]), rng.choice("01"), rng.choice(["3", ""])]
            rows.append(f"{t // SECOND}.{t % SECOND:09d}," + ",".join(cells))
        (tmp_path / "a.csv").write_text("\n".join(rows))
        monkeypatch.setattr(places, "BLOCK", rng.choice([100, 1 << 20]))
        recording = rvmon.loads(SPEC_TEXT).recording(tmp_path / "a.csv")
        lost = [
            Outage(at, at + rng.randint(0, SECOND), "lost") for at in rng.sample(range(t), seed % 3)
        ]
        held = HeldRecording(recording.pieces(), lost)
        samples = HeldRecording(list(recording), lost)
        assert repr(list(held)) == repr(list(samples))
        looked_at = [
            (at, at + rng.randint(0, SECOND)) for at in rng.sample(range(t + 5 * SECOND), 2)
        ]
        looks = Looks(looked_at, {"mode"})
        for requirement in (R1, R2):
            tracks = tracks_of(SPEC, requirement, changes_of(SPEC, samples))
            assert tracks_of(SPEC, requirement, changes_of(SPEC, held)) == tracks
            seen = [
                tracks_of(SPEC, requirement, changes_of(SPEC, run, looks))
                for run in (held, samples)
            ]
            for whole, *parts in zip(tracks, *seen, strict=True):
                for first, last in [(0, t)] if whole.name == "mode" else looked_at:
                    for part in parts:
                        assert part.between(first + 1, last) == whole.between(first + 1, last)
                        if whole.kind is not TrackKind.EVENT:
                            assert part.value_at(first) == whole.value_at(first)


@pytest.mark.parametrize("at", [7, 13, 30])
def test_where_nothing_comes_a_look_sees_what_came_last(at):
    samples = [Sample(t, {"gap": t / 10}) for t in (0, 2, 5, 10, 12, 20, 22)]
    whole = changes_of(SPEC, samples)["gap"].ended()
    changes = changes_of(SPEC, samples, Looks([(at, at + 2)]))["gap"].ended()
    assert changes[changes.count_until(at) - 1] == whole[whole.count_until(at) - 1]
    assert len(changes) < len(whole)


def test_a_switch_that_goes_stale_is_on_or_off(tmp_path):
    """Also from rows of a file: its values are truth values, not numbers."""
    spec = rvmon.loads("signal p : bool stale after 2 s\nrequirement R always p")
    (tmp_path / "a.csv").write_text("t,p\n0,true\n1,false\n2,true\n8,true\n")
    held = HeldRecording(spec.recording(tmp_path / "a.csv").pieces(), [])
    (track,) = tracks_of(spec.checked, spec.requirements["R"], changes_of(spec.checked, held))
    assert [str(value) for _, value in track.changes] == (
        ["True", "False", "True", "None", "True", "None"]
    )


def test_while_it_is_lost_nothing_is_drawn_as_known():
    """Until the first update at or after the end of the outage, even with the same value."""
    samples = [Sample(t, {"gap": 2.0, "go": True}) for t in (0, 4, 6, 9)]
    own = HeldRecording(samples, [Outage(3, 8, "lost", frozenset({"gap"}))])
    changes = changes_of(SPEC, own)
    assert list(changes["gap"].ended()) == [(0, 2.0), (3, None), (9, 2.0), (200_000_010, None)]
    assert [t for t, _ in changes["go"].ended()] == [0, 4, 6, 9]


def test_many_numbers_are_drawn_by_their_extremes():
    import numpy as np

    count = 100_000
    values, hidden = np.zeros(count), np.zeros(count, bool)
    values[12_345], values[54_321], hidden[70_000] = 9.0, -9.0, True
    values[hidden] = np.nan
    course = Course(np.arange(count) * 1000, values, hidden)
    drawn = course.outlined(PLACES)
    assert len(drawn) < 4 * PLACES + 10
    assert {9.0, -9.0, None} <= {value for _, value in drawn}
    assert [t for t, _ in drawn] == sorted(t for t, _ in drawn)
    assert course[:5].outlined(PLACES) == (
        (0, 0.0),
        (1000, 0.0),
        (2000, 0.0),
        (3000, 0.0),
        (4000, 0.0),
    )
