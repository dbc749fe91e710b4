"""Coverage-driven verification of any system that can play a test.

An engineer with a simulator writes a `System`, a type of `Test`, a strategy that makes some, and
requirements; `rvmon.cli.campaign.main(campaign)` is then the command line of the campaign. What is
made of it, in order: `plan` (tests), `execute` (on all cores: `play` judges and measures),
`summarise` (figures), tables, pages, and `gate`: is all as expected? `close` makes its own tests.
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
