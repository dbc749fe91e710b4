"""The gates of each strategy, and the known failures."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

from rvmon.cdv import ExpectedFailure, Gate

_MODEL_BASED = ("model-based", "model-based-shortest", "model-based-fastest")

_NEEDS = {
    "a release": ("R1", "T1", "T2", "T3", "T4", "T5", "T6", "T31", "T45", "T46"),
    "a reading": ("R2", "T7", "T9", "T10", "T11", "T17", "T43", "T44", "T47", "T57"),
    "a scene that surprises": ("T36", "T38", "T52", "T53", "T54", "T55", "T56"),
    "a person beside the way": ("T63", "T65", "T66"),
    "a human who does not come": ("T22", "T24", "T49", "T50"),
    "a robot that gives up": ("T1", "T26", "T48", "T51"),
}
"""Requirements that only some tests trigger, by the situation that these tests must show."""

_SURPRISES = ("a scene that surprises", "a person beside the way")

_LACKS: Mapping[str, Collection[str]] = {
    "pseudorandom": ("a release", "a reading", *_SURPRISES),
    "constrained": ("a release", "a human who does not come", *_SURPRISES),
    **dict.fromkeys(
        _MODEL_BASED, ("a human who does not come", "a robot that gives up", *_SURPRISES)
    ),
}
"""By strategy, the situations that its tests show only by chance."""

_COVERAGE = {
    "pseudorandom": 45.0,
    "constrained": 55.0,
    **dict.fromkeys(_MODEL_BASED, 65.0),
    "disturbed": 90.0,
    "directed": 97.0,
}
"""Percentage of the correct robot's coverage model that 100 tests cover with any seed."""

_SELDOM = ("T54", "T55", "T65", *_NEEDS["a human who does not come"])
"""Requirements that at most two of 100 disturbed tests trigger."""


def gates(robots: Collection[str]) -> dict[str, Gate]:
    """The gate of each strategy that need not trigger all requirements.

    The legacy robot is judged only by R1 to R5.

    >>> gates(["legacy"])["constrained"].untriggered
    ('R1',)
    """
    found = {
        strategy: Gate(
            tuple(
                name
                for need in lacks
                for name in _NEEDS[need]
                if "correct" in robots or name.startswith("R")
            ),
            # The polls of a robot that nobody activates slow down so much that the horizon comes
            # before it gives up.
            inconclusive=("R4",) if "legacy" in robots else (),
        )
        for strategy, lacks in _LACKS.items()
    }
    if "legacy" in robots:  # it reads too late for some of the model's runs
        for strategy in _MODEL_BASED:
            lacks = (*found[strategy].untriggered, "R2")
            found[strategy] = replace(found[strategy], untriggered=lacks)
    if "correct" in robots:
        found["disturbed"] = Gate(_SELDOM, inconclusive=("R5",))  # the distance sensor may be dead
    if "legacy" not in robots:
        for strategy, percent in _COVERAGE.items():
            found[strategy] = replace(found.get(strategy, Gate()), coverage=percent)
    return found


def expected_failures(robots: Collection[str]) -> tuple[ExpectedFailure, ...]:
    """The known failures."""
    hidden = "noise of the tracker hides a hand, and the gripper feels nothing: a risk that remains"
    shown = "noise of the tracker shows a hand where none is, as the gripper has closed"
    known = (
        ExpectedFailure("T58", hidden, robot="correct", seldom=True),
        ExpectedFailure("T59", hidden, robot="correct", seldom=True),
        *(
            ExpectedFailure("R5", shown, strategy=strategy, robot="correct", seldom=True)
            for strategy in ("disturbed", "closed")
        ),
        ExpectedFailure(
            "R5",
            "the robot of the paper's testbench closes its gripper whoever is near",
            robot="legacy",
            seldom=True,
        ),
    )
    return tuple(failure for failure in known if failure.robot in robots)
