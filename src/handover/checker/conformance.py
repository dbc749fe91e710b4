"""Simulated runs held against the network: does the robot do what the model says it does?"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from handover.driver.run import Run
    from rvmon.timed.conformance.outcome import Conformance, Recorded
    from rvmon.timed.model.network import Network

OBSERVED = (
    "grip_closed",
    "informed",
    "sensed",
    "decided",
    "withheld",
    "released",
    "timed_out",
)
"""The robot's messages that are labels of the network; what the human does is not watched.

So a run conforms if some human of the model would have made the robot of the model say the same
things at the same times.
"""

TOLERANCE_NS = 110_000_000
"""The robot looks for signals ten times a second, the network's robot hears them at once."""


def actions_of(run: Run) -> list[Recorded]:
    """The robot's observed messages in a run, in order."""
    from rvmon.timed.conformance.outcome import Recorded

    return [
        Recorded(t_ns, name) for t_ns, values in run.samples for name in OBSERVED if name in values
    ]


def check_run(network: Network, run: Run) -> Conformance:
    """Hold a simulated run against the handover network."""
    from rvmon.timed.conformance.conform import conform

    return conform(
        network,
        actions_of(run),
        observed=frozenset(OBSERVED),
        end=run.end_ns,
        tolerance=TOLERANCE_NS,
    )
