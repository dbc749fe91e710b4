"""Who judges alike, asked of a peer that is played."""

from pathlib import Path
from typing import Any

import pytest
from benchmarks.peers.client import Peer
from benchmarks.peers.ways import RTAMT_STEPPED
from benchmarks.timing.agreement import Agreement, compare
from benchmarks.timing.race import Figure, Theirs
from benchmarks.timing.workload import Workload
from tests.tools.build import once, p

BOUND = 500
SECONDS = 90
ROWS = 3 * BOUND
COLUMN = [row % 7 == 0 for row in range(2 * BOUND)] + [False] * (2 * BOUND)


class Played(Peer):
    """Answers `once` in bounded time as rtamt does: a robustness at every row."""

    def __init__(self, *, blind: bool = False) -> None:
        super().__init__(Path("nobody"), "Rtamt")
        self.kinds: list[str] = []
        self.rows = 0
        self._blind = blind

    def ask(self, do: str, **request: Any) -> dict[str, Any]:
        assert do == "judge"
        self.kinds.append(request["kind"])
        column = request["columns"]["v_p"]
        self.rows += len(column)
        last, values = -BOUND - 1, []
        for row, cell in enumerate(column):
            last = row if cell else last
            values.append(0.5 if row - last <= BOUND or self._blind else -0.5)
        return {"values": values}


def check(peer: Played, ns_per_row: float) -> Agreement:
    """What is found on `once` within a bound above what is asked offline."""
    workload = Workload("online", "Recur", "past", (once(p, 0, BOUND),), {"p": COLUMN})
    timed = Figure("rtamt", ROWS, ns_per_row, ns_per_row, ns_per_row, (None,))
    (found,) = compare(workload, [timed], [Theirs(peer, "rtamt", RTAMT_STEPPED)], SECONDS)
    return found


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rows", "blind"), [(ROWS, False), (ROWS, True), (ROWS // 2, False), (BOUND, False)]
)
def test_past_is_stepped_as_far_as_fits_and_disagreement_is_seen(rows: int, blind: bool) -> None:
    """A peer is asked for so many rows as it steps in the time, the last of them.

    Ours is FALSE among these; where they are no more than the bound nothing is compared.
    """
    peer = Played(blind=blind)
    found = check(peer, SECONDS * 1e9 / rows)
    if rows == BOUND:
        assert (peer.rows, found.compared) == (0, 0)
        assert found.remark.startswith("past: no bound fails")
        return
    assert set(peer.kinds) == {"discrete online"}
    assert peer.rows == found.compared == 2 * rows
    assert (found.equal == found.compared) is not blind
    assert 0 < found.false < found.compared + (rows < ROWS)
