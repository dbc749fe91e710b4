"""Abstract tests: their type, their files, and the strategies that make them."""

from handover.generator.abstract_test import (
    AbstractTest,
    Action,
    ReceiveSignal,
    SendSignal,
    SetParam,
    Withdraw,
)

__all__ = ["AbstractTest", "Action", "ReceiveSignal", "SendSignal", "SetParam", "Withdraw"]
