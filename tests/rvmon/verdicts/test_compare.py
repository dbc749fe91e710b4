"""Differences between two files of verdicts."""

from tests.tools.each import each

from rvmon.verdicts.compare import Change, compare
from rvmon.verdicts.serialise import VerdictRow


def rows(*verdicts, recording="a.csv", requirement="R1", error=""):
    """The rows of one requirement in one recording, one for each attempt."""
    return [
        VerdictRow(
            recording,
            requirement,
            f"{requirement}#{number}",
            verdict=verdict,
            reason=f"r{number}",
            error=error,
        )
        for number, verdict in enumerate(verdicts, start=1)
    ]


def broken(recording="a.csv"):
    """The row of a recording that cannot be evaluated."""
    return [VerdictRow(recording, error="it is cut off")]


@each(
    ("before", "after", "change"),
    [
        ("P", "F", Change.BROKE),
        ("NT", "F", Change.BROKE),
        ("I", "F", Change.BROKE),
        ("P", "I", Change.NO_LONGER_SHOWN),
        ("P", "NT", Change.NO_LONGER_SHOWN),
        ("F", "P", Change.FIXED),
        ("F", "NT", Change.NO_LONGER_FAILS),
        ("I", "P", Change.NEWLY_SHOWN),
        ("NT", "I", Change.OTHERWISE),
    ],
)
def test_each_change_has_its_name(before, after, change):
    [found] = compare(rows(before), rows(after)).differences
    assert (found.change, found.before, found.after) == (change, before, after)


def test_a_requirement_has_the_verdict_of_its_worst_attempt():
    [found] = compare(rows("P", "F", "I"), rows("P", "P", "P")).differences
    assert (found.change, found.failures) == (Change.FIXED, (1, 0))
    [found] = compare(rows("P", "P"), rows("P", "F", "F")).differences
    assert (found.failures, found.reason) == ((0, 2), "R1#2: r2")


def test_what_still_fails_is_no_difference():
    found = compare(rows("F"), rows("F", "F"))
    assert (found.differences, found.failing, found.same) == ([], {"a.csv": ["R1"]}, 1)


def test_a_recording_that_became_unreadable_is_a_loss():
    """One that became readable is a gain; its verdicts are not compared."""
    [found] = compare(rows("F"), [*broken(), *rows("P", error="it is cut off")]).differences
    assert (found.change, found.reason) == (Change.UNREADABLE, "it is cut off")
    [found] = compare(broken(), rows("F")).differences
    assert found.change is Change.READABLE
    assert compare(broken(), broken()).differences == []


def test_what_only_one_has_is_told():
    old = rows("P") + rows("P", requirement="R2") + rows("P", recording="gone.csv")
    new = rows("P") + rows("F", requirement="R3") + rows("F", recording="new.csv")
    found = compare(old, new)
    assert found.only_before == ["gone.csv", "R2 in a.csv"]
    assert found.only_after == ["new.csv", "R3 in a.csv"]
    assert found.differences == []


def test_moved_recordings_are_the_same():
    """The common folder is ignored if no name is in both files."""
    old = rows("P", recording="/monday/x/1.csv") + rows("P", recording="/monday/y/1.csv")
    new = rows("F", recording="logs/x/1.csv") + rows("P", recording="logs/y/1.csv")
    found = compare(old, new)
    assert [one.recording for one in found.differences] == ["x/1.csv"]
    assert (found.only_before, found.only_after) == ([], [])
    mixed = rows("P", recording="/m/1.csv") + rows("P", recording="n/1.csv")
    assert len(compare(mixed, new).only_before) == 2


def test_losses_come_first():
    old = rows("F") + rows("P", recording="b") + rows("P", recording="c")
    new = rows("P") + rows("F", recording="c") + rows("F", recording="b")
    assert [one.recording for one in compare(old, new).differences] == ["b", "c", "a.csv"]
