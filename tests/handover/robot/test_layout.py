"""The map from robot states to lines of code."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

from handover.robot.handover import STATES
from handover.robot.layout import COMMON, code_blocks


def test_every_state_has_its_function() -> None:
    """Each state owns the function of its name."""
    owners = {block.function: block.state for block in code_blocks()}
    assert {state: owners[state] for state in STATES} == {state: state for state in STATES}


def test_helpers_belong_to_their_only_caller() -> None:
    """A helper of one state is counted with it, a helper of several with none."""
    owners = {block.function: block.state for block in code_blocks()}
    assert owners["go_to"] == "move"
    assert owners["poll_signal"] == COMMON


def test_blocks_are_where_the_code_is() -> None:
    """The first line of each block is the `def` of its function; blocks do not overlap."""
    blocks = sorted(code_blocks(), key=lambda block: block.first)
    for block in blocks:
        lines = Path(block.path).read_text(encoding="utf-8").splitlines()
        assert lines[block.first - 1].strip().startswith(f"def {block.function}(")
        assert lines[block.last - 1].strip()
    assert all(a.last < b.first for a, b in pairwise(blocks))
