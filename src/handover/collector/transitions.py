"""The transitions between the robot's states that its code allows."""

from __future__ import annotations

TRANSITIONS = (
    ("reset", "receive_activation"),
    ("receive_activation", "receive_activation"),
    ("receive_activation", "move"),
    ("receive_activation", "done"),
    ("move", "send_signal"),
    ("move", "done"),
    ("send_signal", "receive_readiness"),
    ("receive_readiness", "receive_readiness"),
    ("receive_readiness", "sense"),
    ("receive_readiness", "done"),
    ("sense", "sense"),
    ("sense", "decide"),
    ("sense", "done"),
    ("decide", "release"),
    ("decide", "done"),
    ("release", "done"),
)
"""From, to; loops and failures included, in the order of a handover."""
