"""Two campaigns held against each other."""

from __future__ import annotations

from collections.abc import Iterator

from rvmon.coverage.answers import Comparison, VerdictChange
from rvmon.coverage.questions import goals_of, illegal_hits, scores, share_of, totals
from rvmon.coverage.record import Coverage, TestRecord

Names = tuple[str, str]


def compare(before: Coverage, after: Coverage) -> Comparison:
    """What is different from an earlier campaign.

    Tests are the same that have the same name, strategy and seed, whatever system they tested; of
    several that have, the first is held against the first.
    """
    old_covered, old_illegal, old_share = _state(before)
    covered, illegal, share = _state(after)
    return Comparison(
        old_share,
        share,
        gained=[item for item, is_so in covered.items() if is_so and not old_covered.get(item)],
        lost=[
            item for item, was_so in old_covered.items() if was_so and not covered.get(item, True)
        ],
        illegal=[item for item in illegal if item not in old_illegal],
        dropped=[item for item in old_covered if item not in covered],
        verdicts=list(_changes(before, after)),
    )


def _state(coverage: Coverage) -> tuple[dict[Names, bool], list[Names], float]:
    """Of each item that is wanted whether it is covered; the illegal ones that are hit; a share."""
    counts = totals(coverage).counts
    goals = goals_of(coverage)
    covered = {
        coverage.items[place]: bool(counts[place] >= goals.goal[place])
        for place in goals.wanted.nonzero()[0].tolist()
    }
    illegal = [coverage.items[place] for place in illegal_hits(coverage, counts)]
    return covered, illegal, share_of(coverage, scores(coverage, counts))


def _changes(before: Coverage, after: Coverage) -> Iterator[VerdictChange]:
    earlier: dict[tuple[object, ...], list[TestRecord]] = {}
    for entry in reversed(before.entries):
        earlier.setdefault(_key(entry.record), []).append(entry.record)
    for entry in after.entries:
        record = entry.record
        same = earlier.get(_key(record))
        if not same:
            continue
        old = same.pop()
        for name in dict.fromkeys((*old.verdicts, *record.verdicts)):
            was, now = old.verdicts.get(name), record.verdicts.get(name)
            if was is not now:
                yield VerdictChange(record.name, name, was, now)


def _key(record: TestRecord) -> tuple[object, ...]:
    return record.name, record.strategy, record.seed
