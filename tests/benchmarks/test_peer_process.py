"""Asking a program in a process of its own."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from benchmarks.peers.client import Peer, PeerError

pytestmark = pytest.mark.process

MODULE = """
import os

class Shy:
    def judge(self, values):
        print("noise on standard output")
        return {"values": [not value for value in values]}

    def refuse(self):
        raise ValueError("not today")

    def die(self):
        os._exit(7)
"""


@pytest.fixture
def peer(tmp_path: Path):
    """A peer with an answer, an error and an accident."""
    module = tmp_path / "shy.py"
    module.write_text(MODULE)
    with Peer(Path(sys.executable), "Shy", module) as asked:
        yield asked


def test_answer(peer: Peer) -> None:
    """An answer comes back, whatever the peer prints."""
    assert peer.ask("judge", values=[True, False])["values"] == [False, True]


def test_error(peer: Peer) -> None:
    """What the peer raises is an error that says so, and the peer can be asked again."""
    with pytest.raises(PeerError, match="ValueError: not today"):
        peer.ask("refuse")
    assert peer.ask("judge", values=[True])["values"] == [False]


def test_death(peer: Peer) -> None:
    """A peer that dies is an error with its exit code, and is started anew."""
    with pytest.raises(PeerError, match="code 7"):
        peer.ask("die")
    assert peer.ask("judge", values=[False])["values"] == [True]
