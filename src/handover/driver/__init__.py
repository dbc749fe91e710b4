"""The driver: plays an abstract test against a robot in the simulated world."""

from handover.driver.play import run_test
from handover.driver.run import Run

__all__ = ["Run", "run_test"]
