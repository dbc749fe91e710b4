"""Asking a program in a process of its own."""

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
    module = tmp_path / "shy.py"
    module.write_text(MODULE)
    with Peer(Path(sys.executable), "Shy", module) as asked:
        yield asked


def test_a_peer_is_asked_on_whatever_it_prints_raises_or_dies_of(peer: Peer) -> None:
    """What it raises is an error that says so, its death one with the exit code."""
    assert peer.ask("judge", values=[True, False])["values"] == [False, True]
    with pytest.raises(PeerError, match="ValueError: not today"):
        peer.ask("refuse")
    assert peer.ask("judge", values=[True])["values"] == [False]
    with pytest.raises(PeerError, match="code 7"):
        peer.ask("die")
    assert peer.ask("judge", values=[False])["values"] == [True]
