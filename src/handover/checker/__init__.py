"""The checker: the specification files of the robots."""

from __future__ import annotations

from pathlib import Path

__all__ = ["SPECS", "situations_path", "spec_path"]


SPECS = {"correct": "specs/handover_correct.rv", "legacy": "specs/handover_legacy.rv"}
"""The specification of each robot. That of the correct one follows the words of the paper and also
checks the true state of the world; that of the legacy one has the triggers of its testbench."""


def spec_path(robot: str) -> Path:
    """The file of a robot's requirements, in the installed package or in the source tree.

    >>> spec_path("correct").name
    'handover_correct.rv'
    """
    return _placed(SPECS[robot])


def situations_path() -> Path:
    """The file with the situations that a campaign should show.

    >>> situations_path().name
    'handover_situations.rv'
    """
    return _placed("specs/handover_situations.rv")


def _placed(name: str) -> Path:
    package = Path(__file__).parents[1]
    packaged = package / name
    path = packaged if packaged.exists() else package.parents[1] / name
    here = Path.cwd()
    return path.relative_to(here) if path.is_relative_to(here) else path  # short in messages
