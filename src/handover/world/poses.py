"""The scene over time, in compact form for an animation."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Outline:
    """What a body looks like: a convex polygon in its own coordinates, metres.

    A round body has one corner, its centre, and a `radius`; a polygon's radius rounds its corners.
    """

    body: str
    corners: tuple[tuple[float, float], ...]
    radius: float = 0.0


@dataclass(frozen=True, slots=True)
class Poses:
    """Frames, taken only while something moves; between two frames the scene stands still.

    Attributes:
        bodies: names, in the order of each frame.
        outlines: shapes of the bodies; the body `"ground"` never moves and has no pose.
        frames: `(t_ns, (x, z, angle) of each body, flattened)`, metres and radians.
    """

    bodies: tuple[str, ...]
    outlines: tuple[Outline, ...]
    frames: tuple[tuple[int, tuple[float, ...]], ...]
