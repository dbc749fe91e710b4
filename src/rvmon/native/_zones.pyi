"""The extension that searches through zones; what its numbers mean stands in `zones.h`."""

from collections.abc import Callable

source_hash: str

def search(
    plan: bytes,
    costs: bytes,
    goes_on: Callable[[int, int], int],
    counts: Callable[[bytes, int, bytes], int],
    most_states: int,
    most_bytes: int,
    proper_only: bool,
    /,
) -> tuple[int, int, int, int, int, int, int, int, bytes, bytes, bytes]:
    """Search a plan.

    Args:
        plan: int32 of the machine.
        costs: float64, one of each edge of the plan.
        goes_on: called now and then with states visited and waiting; 0 stops the search.
        counts: called with the path to a loop, where that starts, and the zone there; whether time
            passes on it without bound.
        most_states: to visit; -1: no limit.
        most_bytes: of memory; -1: no limit.
        proper_only: whether a way to stay counts only if time passes on it without bound.

    Returns:
        State, ending, loop, whether a way was passed by, states visited, stored, discrete ones,
        most bytes in use; the path as int32, the parts and the spans as int64.

    Raises:
        ValueError: the plan is damaged.
        MemoryError: there is none for the plan itself.
    """
