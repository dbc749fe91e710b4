"""Compare simulated runs with the network: does the robot behave as the model says?"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from handover.driver.play import Run
    from rvmon.models.conform import Conformance, Recorded
    from rvmon.models.network import Network

OBSERVED = ("grip_closed", "informed", "sensed", "decided", "withheld", "released", "timed_out")
"""The robot's messages that are labels of the network.

Of the human, only the readiness is observed, and only where the model's human can be ready. So a
run conforms if some human who gets ready at that instant would make the robot of the model send the
same messages at the same times.
"""

READY = "humanIsReady"
READY_AFTER_NS = (500_000_000, 20_000_000_000)
"""The earliest and latest delay after which the model's human, once informed, gets ready."""

TOLERANCE_NS = 110_000_000
"""The robot polls for signals ten times a second; the network's robot receives them at once."""


def actions_of(run: Run) -> tuple[list[Recorded], frozenset[str]]:
    """The observed actions of a run, in order, and the set of observed labels.

    The human's first readiness is an input, to which the model's robot must react. If it comes when
    the model's human cannot be ready, for example before being informed, readiness is not an
    observed label: the model may then assume any readiness.
    """
    from rvmon.models.conform import Recorded

    found = {
        name: [t for t, values in run.samples if name in values] for name in (*OBSERVED, READY)
    }
    ready = found.pop(READY)
    informed = found["informed"][:1]
    observed = set(OBSERVED)
    if informed and ready:
        low, high = (informed[0] + after for after in READY_AFTER_NS)
        if low + TOLERANCE_NS <= ready[0] <= high - TOLERANCE_NS:
            found[READY] = ready[:1]
    if found.get(READY) or not ready:
        observed.add(READY)
    actions = (Recorded(t, name) for name, instants in found.items() for t in instants)
    return sorted(actions, key=lambda action: action.t), frozenset(observed)


def check_run(network: Network, run: Run) -> Conformance:
    """Compare a simulated run with the handover network."""
    from rvmon.models.conform import conform

    actions, observed = actions_of(run)
    return conform(network, actions, observed=observed, end=run.end_ns, tolerance=TOLERANCE_NS)
