"""Whether time passes on without bound when a loop is gone round for ever.

If it does not, the longest time that rounds can take together stops growing: more rounds than there
are clocks show it. One round is a relation between the instants at which the clocks were 0 before
and after it; relations of many rounds are put together from those of fewer.

Source: Comon and Jurski, Timed Automata and the Theory of Real Numbers, CONCUR 1999 (loops as
relations); Tripakis, Verifying Progress in Timed Systems, 1999 (strong non-Zenoness).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from math import inf
from typing import TYPE_CHECKING

from rvmon.models.runs.run import Zone, close, universe
from rvmon.models.runs.timing import TimedStep, on_grid, timing_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def time_passes(loop: Sequence[TimedStep], head: Zone, dim: int) -> bool:
    """Whether time passes without bound on a loop: going round more often can take longer.

    Args:
        loop: its steps, at least one; each waits only as long as some clock allows, for else the
            loop would not be needed for staying on it.
        head: the symbolic state in which it starts and ends.
        dim: of the head.
    """
    sure = surely_passes(loop)
    if sure is not None:
        return sure
    # 2^doublings rounds are more than there are clocks: if the longest time still grows then, it
    # grows for ever.
    doublings = dim.bit_length()
    rounds = 2 << doublings
    relation, scale = _one_round(loop, dim, rounds)
    for _ in range(doublings):
        relation = _both(relation, relation)
    fewer = _longest(relation, head, dim, scale)
    return fewer < _longest(_both(relation, relation), head, dim, scale)


def surely_passes(loop: Sequence[TimedStep]) -> bool | None:
    """Whether time passes without bound on a loop, where its bounds alone say so."""
    highest: dict[int, float] = {}
    for step in loop:
        for clock, value in step.resets:
            highest[clock] = max(value, highest.get(clock, 0.0))
    bounds = [bound for step in loop for bound in (*step.leave, *step.enter)]
    if any(x == 0 and y not in highest for x, y, _ in bounds):
        return False  # a clock that is never set stays below a number
    if any(y == 0 and x in highest and -bound >= highest[x] + 1 for x, y, bound in bounds):
        return True  # between being set and the bound each round takes a unit of time
    return None


def _one_round(loop: Sequence[TimedStep], dim: int, rounds: int) -> tuple[NDArray[np.float64], int]:
    """The instants now and when each clock was 0, before and after a round; grid steps in a unit.

    Returns:
        float64[2·dim, 2·dim]: entry (p, q) bounds instant q − instant p from above, closed; the
        first `dim` are before the round, now first.
    """
    import numpy as np

    timing = timing_of(loop, universe(dim), rounds=rounds)
    assert timing is not None, "a loop of symbolic states can be gone round"
    before = [0, *range(len(loop) + 1, len(loop) + dim)]
    after, earlier = before[:], [0.0] * dim
    after[0] = len(loop)
    for now, step in enumerate(loop, start=1):
        for clock, value in step.resets:
            after[clock], earlier[clock] = now, value * timing.scale
    shift = np.array([*[0.0] * dim, *earlier])
    relation = timing.relation([*before, *after]) + shift[:, None] - shift[None, :]
    return relation, timing.scale


def _both(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    """One relation after the other."""
    import numpy as np

    dim = len(first) // 2
    bounds = np.full((3 * dim, 3 * dim), inf)
    bounds[: 2 * dim, : 2 * dim] = first
    np.minimum(bounds[dim:, dim:], second, out=bounds[dim:, dim:])
    close(bounds)
    ends = np.r_[0:dim, 2 * dim : 3 * dim]
    together: NDArray[np.float64] = bounds[np.ix_(ends, ends)]
    return together


def _longest(relation: NDArray[np.float64], head: Zone, dim: int, scale: int) -> float:
    """The longest time from a head that a relation can take, in whole units; it may be inf."""
    bounds = relation.copy()
    for x, y in product(range(dim), repeat=2):
        if head[x * dim + y] < inf:
            # Clock y − clock x is the instant at which x was 0 less that at which y was.
            bounds[y, x] = min(bounds[y, x], on_grid(head[x * dim + y], scale))
    close(bounds)
    longest = float(bounds[0, dim])
    return longest if longest == inf else -(-longest // scale)
