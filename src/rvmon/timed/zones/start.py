"""Whether a network can start at all."""

from __future__ import annotations

from rvmon.diagnostics import Label
from rvmon.timed.model.expressions import TRUE
from rvmon.timed.model.network import Network
from rvmon.timed.model.rules import model_error
from rvmon.timed.zones.dbm import normalise, zero
from rvmon.timed.zones.deadlock import Deadlocks, is_time_bounded
from rvmon.timed.zones.symbolic import Steps, settle_in


def check_start(network: Network) -> None:
    """Refuse a network in which time stops before anything can happen.

    Raises:
        ModelError: the initial state breaks an invariant, or no edge can ever be taken from it
            though time may not pass for ever.
    """
    places = [a.locations[a.initial] for a in network.automata]
    spans = [place.span for place in places if place.span is not None]
    span, others = (spans[0] if spans else None), [Label(other) for other in spans[1:]]
    steps = Steps(network, TRUE)
    state = steps.space.initial()
    zone = zero(steps.dim)
    if state is None or not settle_in(state, zone, steps.dim):
        message = "an invariant of the initial locations is false at time 0"
        mend = "weaken it, or start elsewhere"
        raise model_error("TA014", message, span, mend, others=others)
    beginning = zero(steps.dim)
    if is_time_bounded(state) and Deadlocks(steps.space).dead(state, normalise(beginning)):
        message = "time stops in the initial state: no edge can ever be taken, nor time pass on"
        mend = "weaken the invariant, or the guards of the edges from here"
        raise model_error("TA014", message, span, mend, others=others)
