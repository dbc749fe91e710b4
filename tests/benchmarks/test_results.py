"""The page of results."""

from collections.abc import Iterable
from dataclasses import replace

import pytest
from benchmarks.results import content, page
from benchmarks.timing.agreement import Agreement
from benchmarks.timing.race import Figure, Result

OURS = Figure("rvmon step", 1000, 100.0, 90.0, 130.0, (999,))
REELAY = Figure("reelay", 1000, 900.0, 880.0, 950.0, (999,))
RESULT = Result("online", "AbsentAQ 10", "past", 1000, 0.25, (OURS, REELAY))
ALIKE = Agreement("reelay", "AbsentAQ 10", "past", equal=300, compared=300, false=20)
STEP = "| online, one step from Python | rvmon step |"
GOAL = "≥ 8.0×, least ≥ 5.0×"


AGAIN = replace(RESULT, name="AbsentAQ 100", figures=(replace(OURS, median=200.0), REELAY))


def page_of(results: list[Result], agreements: list[Agreement]) -> list[str]:
    """The lines of a page."""
    run = {"command": "it", "minutes": 1, "machine": "M", "versions": {"rvmon": "1"}, "absent": {}}
    return page(run | content(results, agreements)).splitlines()


def line(page: Iterable[str], start: str) -> str:
    """The line of a page that starts so, and is about reelay if it is of the goals."""
    found = [text for text in page if text.startswith(start)]
    return next((text for text in found if "| reelay |" in text), found[0])


@pytest.mark.parametrize(
    ("results", "agreements", "told"),
    [
        (
            [RESULT],
            [ALIKE],
            f"{STEP} 100 ns | reelay | 900 ns | 1 | 9.0× (9.0× to 9.0×) | {GOAL} | yes |",
        ),
        # Verdicts that were not compared, or differ; another first violation in the timed passes.
        ([RESULT], [], "not measured"),
        ([RESULT], [replace(ALIKE, equal=299)], "not measured"),
        (
            [replace(RESULT, figures=(OURS, replace(REELAY, violated=(500,))))],
            [ALIKE],
            "not measured",
        ),
        (
            [replace(RESULT, figures=(replace(OURS, median=600.0), REELAY))],
            [ALIKE],
            f"| 1.5× (1.5× to 1.5×) | {GOAL} | no |",
        ),
        # The least ratio counts as much as the median.
        (
            [RESULT, RESULT, AGAIN],
            [ALIKE, replace(ALIKE, name="AbsentAQ 100")],
            f"| 3 | 9.0× (4.5× to 9.0×) | {GOAL} | no |",
        ),
    ],
)
def test_goals(results: list[Result], agreements: list[Agreement], told: str) -> None:
    """A peer's time over ours, where both say the same, and whether that is enough."""
    assert told in line(page_of(results, agreements), STEP)


def test_tables() -> None:
    """Every contender with its spread, who judged fewer rows, and where sides differ."""
    fewer = replace(REELAY, rows=50)
    other = replace(ALIKE, name="AbsentBR 10", equal=299)
    lines = page_of([replace(RESULT, figures=(OURS, fewer))], [ALIKE, other])
    row = line(lines, "| AbsentAQ 10 |")
    assert "| 1,000 | 25 % | 100 ns (90 ns–130 ns) | 900 ns (880 ns–950 ns), 50 rows |" in row
    assert "| reelay | past | 2 | 2 | 599 | 600 | 40 |" in lines
    assert "reelay disagrees on AbsentBR 10, past: 299 of 300." in lines
