"""A flat scene over time, for a page to animate: data."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Outline:
    """The outline of a body: a convex polygon in the body's coordinates, metres.

    Attributes:
        body: the body it belongs to; one that is not among the scene's bodies never moves.
        corners: one for a disc, two for a bar, more for a polygon.
        radius: the radius of rounded corners.
        role: its class in the page's style sheet.
    """

    body: str
    corners: tuple[tuple[float, float], ...]
    radius: float
    role: str


@dataclass(frozen=True, slots=True)
class Scene:
    """The motion of bodies in a vertical plane; between frames they stand still.

    Attributes:
        bodies: in the order of each frame.
        outlines: drawn in this order.
        frames: `(ticks, (x, z, angle) of each body, flattened)`, metres and radians.
        view: the shown part: left, bottom, right, top in metres.
    """

    bodies: tuple[str, ...]
    outlines: tuple[Outline, ...]
    frames: tuple[tuple[int, tuple[float, ...]], ...]
    view: tuple[float, float, float, float]
