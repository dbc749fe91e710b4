"""Forces where bodies touch."""

from __future__ import annotations

import pymunk

from handover.world.parameters import NS, STEP_NS


def contact_force(body: pymunk.Body, other: pymunk.Body) -> float:
    """N between two bodies in the last physics step, by contact alone; 0 if they do not touch."""
    impulses: list[float] = []

    def collect(arbiter: pymunk.Arbiter) -> None:
        if other in arbiter.bodies:
            impulses.append(arbiter.total_impulse.length)

    body.each_arbiter(collect)
    return sum(impulses) / (STEP_NS / NS)
