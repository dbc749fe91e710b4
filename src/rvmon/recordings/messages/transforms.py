"""Poses of one frame in another, composed of the transforms that a robot sends."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import Any

from msgspec import Struct

from rvmon.recordings.messages import Message, Messages, Topic
from rvmon.trace.schema import Kind

SOURCES = ("/tf", "/tf_static")
_SENT = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")

_TYPE = "geometry_msgs/msg/Transform"
_LEAVES = {
    **{f"translation.{axis}": Kind.REAL for axis in "xyz"},
    **{f"rotation.{axis}": Kind.REAL for axis in "xyzw"},
}

_Vector = tuple[float, float, float]
_Quaternion = tuple[float, float, float, float]


class Transform(Struct, frozen=True):
    """A rotation followed by a translation: the pose of a frame in its parent."""

    shift: _Vector = (0.0, 0.0, 0.0)  # translation: x, y, z
    turn: _Quaternion = (0.0, 0.0, 0.0, 1.0)  # rotation, a quaternion of length 1: x, y, z, w

    def then(self, inner: Transform) -> Transform:
        """The composition with a transform inside this frame, seen from the parent."""
        x, y, z = self._turned(inner.shift)
        shift = (self.shift[0] + x, self.shift[1] + y, self.shift[2] + z)
        return Transform(shift, _product(self.turn, inner.turn))

    def back(self) -> Transform:
        """The inverse transform.

        >>> Transform((1.0, 2.0, 0.0)).back().shift
        (-1.0, -2.0, -0.0)
        """
        x, y, z, w = self.turn
        turned = Transform(turn=(-x, -y, -z, w))
        back = turned._turned(self.shift)
        return Transform((-back[0], -back[1], -back[2]), turned.turn)

    def _turned(self, vector: _Vector) -> _Vector:
        x, y, z, w = self.turn
        a, b, c = vector
        # Twice the cross product of the quaternion's vector part and the vector.
        p, q, r = 2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)
        return a + w * p + y * r - z * q, b + w * q + z * p - x * r, c + w * r + x * q - y * p


def _product(a: _Quaternion, b: _Quaternion) -> _Quaternion:
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


class WithTransforms(Messages):
    """A recording with an additional topic for each requested pair of frames.

    `/tf/map/base_link` has the pose of `base_link` in `map`. It has a message whenever a transform
    on the path between the two frames is sent, using the last known transforms of the others.
    """

    def __init__(self, source: Messages, pairs: Iterable[tuple[str, str]]) -> None:
        self._source = source
        self._pairs = {f"/tf/{outer}/{inner}": (outer, inner) for outer, inner in pairs}
        made = {name: Topic(name, _TYPE, _LEAVES) for name in self._pairs}
        self.topics = {**source.topics, **made}
        self.end, self.count, self.outages = source.end, source.count, source.outages

    def read(self, topics: Collection[str]) -> Iterator[Message]:
        """Yield the messages of these topics, recorded and computed, in order of log stamps."""
        pairs = {name: pair for name, pair in self._pairs.items() if name in topics}
        wanted = {name for name in topics if name not in pairs}
        frames: dict[str, tuple[str, Transform]] = {}
        for name, t, content in self._source.read({*wanted, *SOURCES} if pairs else wanted):
            if name in wanted:
                yield name, t, content
            if not pairs or name not in SOURCES:
                continue
            received = {_take(transform, frames) for transform in content.transforms}
            for made, (outer, inner) in pairs.items():
                way = _way(outer, inner, frames)
                # A message about frames off the path changes nothing, so it is no update.
                if way is not None and not received.isdisjoint(way[1]):
                    shift, turn = way[0].shift, way[0].turn
                    yield (
                        made,
                        t,
                        {
                            "translation": dict(zip("xyz", shift, strict=True)),
                            "rotation": dict(zip("xyzw", turn, strict=True)),
                        },
                    )

    def close(self) -> None:
        """Close the files."""
        self._source.close()


def _take(message: Any, frames: dict[str, tuple[str, Transform]]) -> str:
    """Store the transform of a frame from a message, and return the frame's name."""
    own, outer = message.child_frame_id.lstrip("/"), message.header.frame_id.lstrip("/")
    shift, turn = message.transform.translation, message.transform.rotation
    way = Transform((shift.x, shift.y, shift.z), (turn.x, turn.y, turn.z, turn.w))
    frames[own] = outer, way
    return str(own)


def _way(
    outer: str, inner: str, frames: Mapping[str, tuple[str, Transform]]
) -> tuple[Transform, frozenset[str]] | None:
    """The pose of frame `inner` in `outer`, and the frames on the path; `None`: not connected."""
    above = _above(outer, frames)
    below = _above(inner, frames)
    common = next((frame for frame in below if frame in above), None)
    if common is None:
        return None
    found = above[common][0].back().then(below[common][0])
    return found, frozenset({*above[common][1], *below[common][1]})


def _above(
    frame: str, frames: Mapping[str, tuple[str, Transform]]
) -> dict[str, tuple[Transform, tuple[str, ...]]]:
    """By ancestor of a frame, from itself upwards: its pose there, and the frames on the path."""
    found: dict[str, tuple[Transform, tuple[str, ...]]] = {frame: (Transform(), ())}
    way, here = Transform(), frame
    names: tuple[str, ...] = ()
    while here in frames:
        outer, own = frames[here]
        if outer in found:
            break  # the frames form a cycle
        way, names = own.then(way), (*names, here)
        found[outer] = way, names
        here = outer
    return found


def sends_transforms(topics: Mapping[str, Topic]) -> bool:
    """Whether a recording holds transforms of frames."""
    return any(name in topics and topics[name].type in _SENT for name in SOURCES)


def requested_pairs(names: Iterable[str]) -> list[tuple[str, str]]:
    """The pairs of frames requested by topics and names of the form `/tf/OUTER/INNER`.

    >>> requested_pairs(["/tf/map/base", "tf.map.base.translation.x", "/odom"])
    [('map', 'base')]
    """
    found: dict[tuple[str, str], None] = {}
    for name in names:
        parts = name.strip("/").replace("/", ".").split(".")
        if len(parts) >= 3 and parts[0] == "tf":
            found[parts[1], parts[2]] = None
    return list(found)
