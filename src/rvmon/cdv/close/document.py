"""What came of closing a campaign, as data for programs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from rvmon.cdv.close.outcome import Closed
from rvmon.coverage.nearest import Goal


def closed_document(closed: Closed) -> dict[str, object]:
    """The content of `closing.json`; a goal is a pair of group and item.

    All of it but `seconds` follows from the seed, unless seconds ended it.
    """
    return {
        "goals": closed.goals,
        "met": closed.met,
        "share": closed.share,
        "ended": closed.ended,
        "tests": [
            {
                "name": one.played.job.test.name,
                "made": one.origin,
                "ending": one.played.outcome.ending,
                "verdicts": one.played.outcome.verdicts,
                "added": one.goals,
                "met": one.met,
            }
            for one in closed.tests
        ],
        "suite": [one.job.test.name for one in closed.suite],
        "sizes": closed.sizes,
        "at_least": closed.fewest,
        "trade": closed.trade,
        "open": [{"goal": goal, "hole": hole} for goal, hole in closed.open.items()],
        "proved": _texts(closed.proved),
        "argued": _texts(closed.argued),
        "wrong": _texts(closed.wrong),
        "seconds": round(closed.seconds, 2),
    }


def _texts(texts: Mapping[Goal, str]) -> Iterable[object]:
    return [{"goal": goal, "text": text} for goal, text in texts.items()]
