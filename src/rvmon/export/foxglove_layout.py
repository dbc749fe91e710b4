"""The layout by which Foxglove shows verdicts: states, numbers, attempts."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator
from typing import Any

from rvmon.export.foxglove_scene import SCENE
from rvmon.report.scene import Scene
from rvmon.report.tracks import thresholds
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.schema import Kind

ATTEMPTS = "/rvmon/attempts"
"""The topic of attempts, for the panel of logs."""

_PLAIN = re.compile(r"[\w/-]+", re.ASCII)
_NUMBERS = (Kind.INT, Kind.REAL)


def topic_of(kind: str, name: str) -> str:
    """The topic of a requirement or a signal.

    >>> topic_of("signals", "hand.distance")
    '/rvmon/signals/hand/distance'
    """
    return f"/rvmon/{kind}/{name.replace('.', '/')}"


def foxglove_layout(
    spec: CheckedSpec,
    requirements: Iterable[str],
    names: Collection[str],
    scene: Scene | None,
) -> dict[str, Any]:
    """The states of requirements above the numbers that they read above the log of attempts."""
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
            "title": "Values and what they are compared with",
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
    """A panel that looks at the scene's plane from the side."""
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
    """The numbers, and as lines what requirements compare them with."""
    judged = [spec.requirements[name] for name in requirements]
    for name, signal in spec.signals.items():
        if name in names and signal.type.kind in _NUMBERS:
            unit = f" [{signal.type.unit}]" if signal.type.unit else ""
            yield _path("signals", name, "value", f"{name}{unit}")
            found = dict.fromkeys(one for each in judged for one in thresholds(each, name))
            for one in found:
                yield {"value": str(one.value), "label": f"{name} {one.op} {one.value:g}", **_SHOWN}


_SHOWN = {"enabled": True, "timestampMethod": "receiveTime"}


def _path(kind: str, name: str, field: str, label: str) -> dict[str, Any]:
    topic = topic_of(kind, name)
    quoted = topic if _PLAIN.fullmatch(topic) else f'"{topic}"'
    return {"value": f"{quoted}.{field}", "label": label.rstrip(), **_SHOWN}
