"""The Foxglove layout for verdicts, numbers and attempts, and messages for scenes."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import Any

from rvmon.language.checked.specification import CheckedSpec
from rvmon.report.tracks import Outline, Scene, thresholds
from rvmon.trace.schema import Kind
from rvmon.trace.time import TICKS_PER_SECOND

SCENE = "/rvmon/scene"  # the topic of scenes

_THIN = 0.006  # the least thickness of a polygon's outline, metres

_LINE_STRIP, _LINE_LOOP = 0, 1

_COLOURS = {
    "link": (0.35, 0.5, 0.75),
    "gripper": (0.2, 0.3, 0.55),
    "piece": (0.95, 0.6, 0.1),
    "person": (0.85, 0.55, 0.45),
    "gaze": (0.9, 0.85, 0.3),
}
"""Red, green and blue by role of a body; other roles are grey."""


def scene_updates(scene: Scene) -> Iterator[tuple[int, dict[str, Any]]]:
    """The instant (ticks) and content of a message for each frame."""
    places = {name: place for place, name in enumerate(scene.bodies)}
    for t, flat in scene.frames:
        poses = {name: flat[3 * place : 3 * place + 3] for name, place in places.items()}
        drawings: dict[str, list[dict[str, Any]]] = {"lines": [], "spheres": []}
        for outline in scene.outlines:
            pose = _pose(*poses.get(outline.body, (0.0, 0.0, 0.0)))
            kind, drawn = _drawn(outline)
            rgba = (*_COLOURS.get(outline.role, (0.6, 0.6, 0.6)), 1.0)
            colour = dict(zip("rgba", rgba, strict=True))
            drawings[kind].append({"pose": pose, "color": colour, **drawn})
        entity = {
            "timestamp": seconds_and_rest(t),
            "frame_id": "world",
            "id": "scene",
            # 0 means: until the next message with this id.
            "lifetime": seconds_and_rest(0),
            "frame_locked": False,
            **drawings,
        }
        yield t, {"deletions": [], "entities": [entity]}


def seconds_and_rest(ticks: int) -> dict[str, int]:
    """An instant in the form of Foxglove's messages.

    >>> seconds_and_rest(1_500_000_000)
    {'sec': 1, 'nsec': 500000000}
    """
    seconds, rest = divmod(ticks, TICKS_PER_SECOND)
    return {"sec": seconds, "nsec": rest}


def _pose(x: float, z: float, angle: float) -> dict[str, Any]:
    """The 3D pose of a body in the vertical plane; its angle turns from x to z."""
    turned = {"x": 0.0, "y": -math.sin(angle / 2), "z": 0.0, "w": math.cos(angle / 2)}
    return {"position": {"x": x, "y": 0.0, "z": z}, "orientation": turned}


def _drawn(outline: Outline) -> tuple[str, Mapping[str, Any]]:
    """The drawing of an outline: a disc becomes a sphere, a bar or polygon becomes lines."""
    if len(outline.corners) == 1:
        return "spheres", {"size": dict.fromkeys("xyz", 2 * outline.radius)}
    return "lines", {
        "type": _LINE_STRIP if len(outline.corners) == 2 else _LINE_LOOP,
        "thickness": max(2 * outline.radius, _THIN),
        "scale_invariant": False,
        "points": [{"x": x, "y": 0.0, "z": z} for x, z in outline.corners],
        "colors": [],
        "indices": [],
    }


ATTEMPTS = "/rvmon/attempts"  # the topic of attempts, for the log panel

_PLAIN = re.compile(r"[\w/-]+", re.ASCII)
_NUMBERS = (Kind.INT, Kind.REAL)


def topic_of(kind: str, name: str) -> str:
    """The topic of a requirement or a signal.

    >>> topic_of("signals", "hand.distance")
    '/rvmon/signals/hand/distance'
    """
    return f"/rvmon/{kind}/{name.replace('.', '/')}"


def foxglove_layout(
    spec: CheckedSpec, requirements: Iterable[str], names: Collection[str], scene: Scene | None
) -> dict[str, Any]:
    """The layout: states of requirements, below them the numbers that they read, then attempts."""
    judged = list(requirements)
    states = [_path("requirements", name, "state", f"{name} {spec.requirements[name].text}")
              for name in judged]  # fmt: skip
    states += [
        _path("signals", name, "value", name)
        for name, signal in spec.signals.items()
        if name in names and signal.type.kind not in _NUMBERS
    ]
    panels: dict[str, Any] = {
        "StateTransitions!verdicts": {"title": "Verdicts", "isSynced": True, "paths": states},
        "Plot!values": {
            "title": "Values and their limits",
            "isSynced": True,
            "paths": list(_numbers(spec, judged, names)),
            "xAxisVal": "timestamp",
            "showXAxisLabels": True,
            "showYAxisLabels": True,
            "showLegend": True,
            "legendDisplay": "left",
            "showPlotValuesInLegend": True,
        },
        "Log!attempts": {"topicToRender": ATTEMPTS, "minLogLevel": 1, "searchTerms": []},
    }
    top, middle, bottom = panels
    below = {"direction": "column", "first": middle, "second": bottom, "splitPercentage": 60}
    left = {"direction": "column", "first": top, "second": below, "splitPercentage": 35}
    whole: dict[str, Any] = left
    if scene is not None:
        panels["3D!scene"] = _view(scene)
        whole = {"direction": "row", "first": left, "second": "3D!scene", "splitPercentage": 60}
    return {
        "configById": panels,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": whole,
    }


def _view(scene: Scene) -> dict[str, Any]:
    """A 3D panel that shows the plane of the scene from the side."""
    left, bottom, right, top = scene.view
    return {
        "topics": {SCENE: {"visible": True}},
        "fixedFrame": "world",
        "followMode": "follow-none",
        "cameraState": {
            "perspective": False,
            "phi": 90,
            "thetaOffset": 0,
            "distance": 2 * max(right - left, top - bottom),
            "targetOffset": [(left + right) / 2, 0, (bottom + top) / 2],
        },
    }


def _numbers(
    spec: CheckedSpec, requirements: Iterable[str], names: Collection[str]
) -> Iterator[dict[str, Any]]:
    """The plotted series: the numbers, and the constants that requirements compare them with."""
    judged = [spec.requirements[name] for name in requirements]
    for name, signal in spec.signals.items():
        if name in names and signal.type.kind in _NUMBERS:
            unit = f" [{signal.type.unit}]" if signal.type.unit else ""
            yield _path("signals", name, "value", f"{name}{unit}")
            limits = dict.fromkeys(
                threshold for each in judged for threshold in thresholds(each, name)
            )
            for threshold in limits:
                yield {
                    "value": str(threshold.value),
                    "label": f"{name} {threshold.op} {threshold.value:g}",
                    **_SHOWN,
                }


# Plotted by receive time, as only attempts carry their own stamp.
_SHOWN = {"enabled": True, "timestampMethod": "receiveTime"}


def _path(kind: str, name: str, field: str, label: str) -> dict[str, Any]:
    topic = topic_of(kind, name)
    quoted = topic if _PLAIN.fullmatch(topic) else f'"{topic}"'
    return {"value": f"{quoted}.{field}", "label": label.rstrip(), **_SHOWN}
