"""Table 1 of the paper, as published: what our own is held against.

Source: D. Araiza-Illan, D. Western, A. Pipe, K. Eder, "Coverage-Driven Verification: An approach
to verify code for robots that directly interact with humans", Haifa Verification Conference 2015,
section 5, Table 1 (there the requirements are numbered 1 to 5).
"""

from __future__ import annotations

from rvmon.report.table import RunGroup, VerdictTable
from rvmon.verdict.verdict import Verdict

SOURCE = "Araiza-Illan et al., Coverage-Driven Verification, HVC 2015, Table 1"

_CHECKED = {"R1": True, "R2": True, "R3": True, "R4": True, "R5": None}

_PSEUDORANDOM = {
    "R1": (0, 0, 100, 0),
    "R2": (33, 0, 67, 0),
    "R3": (33, 0, 67, 0),
    "R4": (98, 0, 0, 2),
    "R5": (46, 0, 54, 0),
}
_CONSTRAINED = {
    "R1": (0, 0, 100, 0),
    "R2": (87, 0, 13, 0),
    "R3": (87, 0, 13, 0),
    "R4": (98, 0, 0, 2),
    "R5": (93, 0, 7, 0),
}
_MODEL_BASED = {
    "R1": (3, 0, 1, 0),
    "R2": (1, 0, 3, 0),
    "R3": (4, 0, 0, 0),
    "R4": (4, 0, 0, 0),
    "R5": (4, 0, 0, 0),
}

FITTED_BY_LOSS = {("constrained", "R5")}
"""Cells that the fitted start-up loss reproduces by construction."""

FITTED_BY_SLOWNESS = {("pseudorandom", "R4"), ("constrained", "R4")}
"""Cells from which the slowness of polls was taken."""

FITTED = FITTED_BY_LOSS | FITTED_BY_SLOWNESS
"""Cells that are no evidence."""


def paper_table() -> VerdictTable:
    """The paper's table."""
    published = {
        "pseudorandom": _PSEUDORANDOM,
        "constrained": _CONSTRAINED,
        "model-based": _MODEL_BASED,
    }
    groups = tuple(
        RunGroup(
            name,
            sum(rows["R1"]),
            {
                requirement: dict(zip(Verdict, row, strict=True))
                for requirement, row in rows.items()
            },
        )
        for name, rows in published.items()
    )
    return VerdictTable(
        title="As published",
        requirements=dict.fromkeys(_CHECKED, ""),
        groups=groups,
        checked=_CHECKED,
        notes=(f"Source: {SOURCE}",),
    )
