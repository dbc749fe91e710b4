"""The driver, which plays an abstract test against a robot in the simulated world."""

from handover.driver.play import Run, run_test

__all__ = ["Run", "run_test"]
