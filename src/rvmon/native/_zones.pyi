"""The extension that searches the zones of a model; `zones.h` explains its numbers."""

from collections.abc import Callable

source_hash: str

def search(
    plan: bytes,
    costs: bytes,
    goes_on: Callable[[int, int], int],
    diverges: Callable[[bytes, int, bytes], int],
    most_states: int,
    most_bytes: int,
    proper_only: bool,
    /,
) -> tuple[int, int, int, int, int, int, int, int, bytes, bytes, bytes]:
    """Search a plan.

    Args:
        plan: the plan as int32 in the byte order of the machine.
        costs: float64, one for each edge of the plan.
        goes_on: called from time to time with the numbers of states visited and waiting; 0 stops
            the search.
        diverges: called with the path to a loop, where the loop starts, and the zone there; returns
            whether time diverges on the loop.
        most_states: the most states to visit; -1: no limit.
        most_bytes: the most bytes of memory in use; -1: no limit.
        proper_only: whether only runs on which time diverges count.

    Returns:
        The state, ending and loop of the search; whether a run was skipped on which time stops; the
        numbers of states visited, states stored and discrete states; the most bytes in use; the
        path as int32; the parts and the spans as int64.

    Raises:
        ValueError: the plan is damaged.
        MemoryError: there is no memory for the plan itself.
    """
