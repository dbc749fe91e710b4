"""The simulated handover as a system that campaigns play tests on."""

from __future__ import annotations

from msgspec import structs

from handover.driver import run_test
from handover.driver.play import draw
from handover.generator.abstract_test import AbstractTest
from rvmon.cdv import Observer, Run

OUTCOMES = {
    "timed_out": "the robot timed out",
    "released": "the piece was released",
    "withheld": "the robot kept the piece",
}
"""The outcomes of a handover, by the event that reports each."""


class Handover:
    """One of the two robots with the human, in the simulated world.

    Args:
        robot: `correct` or `legacy`.
    """

    def __init__(self, robot: str) -> None:
        self._robot = robot

    def play(self, test: AbstractTest, observer: Observer) -> Run:
        """Play a test to its horizon; the run depends on the test's script and seed alone."""
        run = run_test(
            test,
            robot=self._robot,
            films=observer.wants_scene,
            observer=observer,
            around_robot_step=observer.code,
        )
        happened = {name for _, values in run.samples for name in values}
        outcome = next((text for event, text in OUTCOMES.items() if event in happened), "none")
        return Run(
            end_ns=run.end_ns,
            states=run.states,
            error=run.error,
            figures={"stepped_s": run.stepped_s},
            facts=[("outcome", outcome)],
            scene=run.scene,
        )


def without_loss(test: AbstractTest) -> AbstractTest | None:
    """The test without the loss of signals at start-up; `None` if it has none."""
    if draw(test.seed, startup_loss=test.startup_loss).connected:
        return None
    return structs.replace(test, startup_loss=False)
