"""Coverage-driven verification of any system that can play a test.

An engineer with a simulator writes a `System`, a subclass of `Test`, strategies that generate such
tests, and requirements; `rvmon.cli.campaign.main(campaign)` is then the command line of the
campaign. Its stages, in order: `plan` generates tests, `execute` plays, judges and measures them on
all cores, `summarise` computes figures, then come tables and pages, and `gate` compares the results
with what is expected. `close` generates its own tests until no hole is left.
"""

from rvmon.cdv.campaign import (
    Campaign,
    Closing,
    ClosingModel,
    Control,
    ExpectedFailure,
    Gate,
    Robot,
    Strategy,
    Unreachable,
)
from rvmon.cdv.system import Block, Code, Observer, Run, System, blocks_of
from rvmon.cdv.test import Test, TestError

__all__ = [
    "Block",
    "Campaign",
    "Closing",
    "ClosingModel",
    "Code",
    "Control",
    "ExpectedFailure",
    "Gate",
    "Observer",
    "Robot",
    "Run",
    "Strategy",
    "System",
    "Test",
    "TestError",
    "Unreachable",
    "blocks_of",
]
