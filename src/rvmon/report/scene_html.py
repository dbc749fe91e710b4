"""A scene as an SVG drawing at one instant, and its frames for the page's script."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from bisect import bisect_right

from rvmon.report.markup import e
from rvmon.report.scene import Outline, Scene

UNITS = 1000
"""Units of the drawing per metre, and of an angle per radian."""

MILLISECOND = 1_000_000
"""Ticks."""


def scene_svg(scene: Scene, instant: int) -> ET.Element:
    """Draw a scene as it was at an instant, ticks."""
    left, bottom, right, top = (round(edge * UNITS) for edge in scene.view)
    drawing = e(
        "svg",
        {"viewBox": f"{left} {-top} {right - left} {top - bottom}", "role": "img"},
        e("title", None, "The scene at the cursor's instant"),
    )
    index = max(bisect_right(scene.frames, instant, key=lambda frame: frame[0]) - 1, 0)
    pose = scene.frames[index][1] if scene.frames else ()
    for outline in scene.outlines:
        group = e("g", {"class": f"body {outline.role}"}, _shape(outline))
        if outline.body in scene.bodies and pose:
            body = scene.bodies.index(outline.body)
            x, z, angle = pose[3 * body : 3 * body + 3]
            group.set("data-body", str(body))
            group.set("transform", _transform(x, z, angle))
        drawing.append(group)
    return drawing


def scene_data(scene: Scene, origin: int) -> dict[str, object]:
    """The frames as small integers: each the difference to the one before.

    Times are milliseconds since `origin`, places millimetres, angles milliradians.
    """
    times = [(t - origin) // MILLISECOND for t, _ in scene.frames]
    columns = zip(*(pose for _, pose in scene.frames), strict=True)
    values = [[round(value * UNITS) for value in column] for column in columns]
    return {"times": _differences(times), "values": [_differences(column) for column in values]}


def _shape(outline: Outline) -> ET.Element:
    corners = [(round(x * UNITS), round(-z * UNITS)) for x, z in outline.corners]
    radius = round(outline.radius * UNITS)
    match corners:
        case [(x, y)]:
            return e("circle", {"cx": x, "cy": y, "r": radius})
        case [(x1, y1), (x2, y2)]:
            width = 2 * radius
            style = f"stroke-width:{width}" if width else None
            return e("line", {"x1": x1, "y1": y1, "x2": x2, "y2": y2, "style": style})
        case _:
            points = " ".join(f"{x},{y}" for x, y in corners)
            return e("polygon", {"points": points})


def _transform(x: float, z: float, angle: float) -> str:
    return f"translate({x * UNITS:.0f} {-z * UNITS:.0f}) rotate({-math.degrees(angle):.1f})"


def _differences(values: list[int]) -> list[int]:
    return [value - before for before, value in zip([0, *values], values, strict=False)]
