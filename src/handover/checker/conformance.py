"""Simulated runs compared with the network: does the robot do what the model says it does?"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from handover.driver.play import Run
    from rvmon.models.conform import Conformance, Recorded
    from rvmon.models.network import Network

OBSERVED = ("grip_closed", "informed", "sensed", "decided", "withheld", "released", "timed_out")
"""The robot's messages that are labels of the network.

Of what the human does only the readiness is watched, where the model's human has it: a run conforms
if some human who gets ready then would have made the robot of the model say the same things at the
same times.
"""

READY = "humanIsReady"
READY_AFTER_NS = (500_000_000, 20_000_000_000)
"""The earliest and latest delay after which the model's human, once informed, gets ready."""

TOLERANCE_NS = 110_000_000
"""The robot looks for signals ten times a second, the network's robot hears them at once."""


def actions_of(run: Run) -> tuple[list[Recorded], frozenset[str]]:
    """The observed actions of a run, in order, and the labels that are observed at all.

    The robot hears the first readiness after it has informed the human; it is an input of the model
    that the robot has to go by. One at an instant at which the model's human has none, such as
    before, is not observed: whether the robot heard it is left open.
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
