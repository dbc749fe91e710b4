"""All report pages are legible, fit their window, and name their controls."""

from dataclasses import replace

from msgspec import structs
from tests.rvmon.report.test_run_page import content, door, scene
from tests.tools.covered import fill
from tests.tools.looked_at import faults

from rvmon.coverage.database import Database
from rvmon.report.coverage_page import coverage_page
from rvmon.report.coverage_summary import Summary
from rvmon.report.run_html import run_page
from rvmon.report.run_pages import Listed, run_index
from rvmon.report.trace_matrix import Traced, matrix_page
from rvmon.verdicts.known_failures import NONE_KNOWN


def test_pages_are_fit_for_everybody(chromium, tmp_path):
    spec, run = door(answer=2.02, gap=0.01)
    long = f"{'a-long-name-of-a-robot-' * 3}monday.csv"
    listed = [
        Listed(f"week/{long}", "x.html", run.report),
        Listed("week/y.csv", "y.html", door(answer=1.0)[1].report),
        Listed("week/z.csv", "", None, "there is no column `gap`"),
    ]
    severe = {n: replace(r, severity="high") for n, r in spec.checked.requirements.items()}
    shown = [
        Traced("", "D1", "Knocking opens the door", "ISO 13482", f"week/{long}", letter, "`a` < 1")
        for letter in ("P", "F", "NT", "I", "")
    ]
    with Database.in_memory() as database:
        fill(database)
        covered = coverage_page(Summary("door.cov", database.coverage(), None, "old.cov"))
    pages = {
        "run": run_page(content((spec, run), scene=scene(), others=[door(answer=1.0)[1]])),
        "passed": run_page(content(door(answer=1.0))),
        "index": run_index(structs.replace(spec.checked, requirements=severe), listed, NONE_KNOWN),
        "matrix": matrix_page("door", {"judged by": "rvmon"}, shown).decode(),
        "coverage": covered,
        "bad": '<p style="color:#999;width:500px">pale <input> <i tabindex=-1></i></p>',
    }
    found = faults(chromium, tmp_path, pages)
    assert [fault for fault in found if not fault.startswith("bad")] == []
    for fault in ("contrast", "wider", "no language", "no title", "without a name", "no viewport"):
        assert fault in "\n".join(found)
