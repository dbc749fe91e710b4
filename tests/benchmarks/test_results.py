"""The page of results."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import pytest
from benchmarks.page import Findings, render
from benchmarks.timing.agreement import Agreement
from benchmarks.timing.measure import Figure, Result

OURS = Figure("rvmon step", 1000, 100.0, 90.0, 130.0, (999,))
REELAY = Figure("reelay", 1000, 900.0, 880.0, 950.0, (999,))
RESULT = Result("online", "AbsentAQ 10", "past", 1000, 0.25, (OURS, REELAY))
ALIKE = Agreement("reelay", "AbsentAQ 10", "past", equal=300, compared=300, false=20)
FINDINGS = Findings(
    "python -m benchmarks.results",
    {"reelay": "1.0"},
    (RESULT,),
    (ALIKE,),
)


STEP = "| online, one step from Python | rvmon step |"
GOAL = "≥ 8.0×, least ≥ 5.0×"


AGAIN = replace(RESULT, name="AbsentAQ 100", figures=(replace(OURS, median=200.0), REELAY))


def line(page: str, start: str) -> str:
    """The line of a page that starts so, and is about reelay if it is of the goals."""
    found = [text for text in page.splitlines() if text.startswith(start)]
    return next((text for text in found if "| reelay |" in text), found[0])


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({}, f"{STEP} 100 ns | reelay | 900 ns | 1 | 9.0× (9.0× to 9.0×) | {GOAL} | yes |"),
        # Verdicts that were not compared, or differ; another first violation in the timed passes.
        ({"agreements": ()}, "not measured"),
        ({"agreements": (replace(ALIKE, equal=299),)}, "not measured"),
        (
            {"results": (replace(RESULT, figures=(OURS, replace(REELAY, violated=(500,)))),)},
            "not measured",
        ),
        (
            {"results": (replace(RESULT, figures=(replace(OURS, median=600.0), REELAY)),)},
            f"| 1.5× (1.5× to 1.5×) | {GOAL} | no |",
        ),
        # The least ratio counts as much as the median.
        (
            {
                "results": (RESULT, RESULT, AGAIN),
                "agreements": (ALIKE, replace(ALIKE, name="AbsentAQ 100")),
            },
            f"| 3 | 9.0× (4.5× to 9.0×) | {GOAL} | no |",
        ),
    ],
)
def test_goals(changes: Mapping[str, Any], told: str) -> None:
    """A peer's time over ours, where both say the same, and whether that is enough."""
    assert told in line(render(replace(FINDINGS, **changes)), STEP)


def test_tables() -> None:
    """Every contender with its spread, who judged fewer rows, and where sides differ."""
    fewer = replace(REELAY, rows=50)
    other = replace(ALIKE, name="AbsentBR 10", equal=299)
    results = (replace(RESULT, figures=(OURS, fewer)),)
    page = render(replace(FINDINGS, results=results, agreements=(ALIKE, other)))
    row = line(page, "| AbsentAQ 10 |")
    assert "| 1,000 | 25 % | 100 ns (90 ns–130 ns) | 900 ns (880 ns–950 ns), 50 rows |" in row
    assert "| reelay | past | 2 | 2 | 599 | 600 | 40 |" in page
    assert "reelay disagrees on AbsentBR 10, past: 299 of 300." in page


def test_further() -> None:
    """What is no race stands below a title of its own; what was not measured has its reason."""
    tables = (("Whole files", ("| a |", "|---|")),)
    page = render(replace(FINDINGS, tables=tables, absent={"mstlo-python": "no wheel"}))
    assert "## Whole files\n\n| a |\n|---|\n" in page
    assert "* Not measured: mstlo-python: no wheel" in page
