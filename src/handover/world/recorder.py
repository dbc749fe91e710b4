"""Record messages and measurements of the scene as samples."""

from __future__ import annotations

from collections.abc import Callable

from handover.world import measures
from handover.world import parameters as p
from handover.world.human import Human
from handover.world.scene import Scene

SampleValue = bool | float | None
Sample = tuple[int, dict[str, SampleValue]]


class Recorder:
    """Collects samples in time order; a signal is kept only when it changes, an event always."""

    def __init__(self, observer: Callable[[int, dict[str, SampleValue]], None] | None) -> None:
        # Complete samples; that of the current instant is not among them.
        self.samples: list[Sample] = []
        self._observer = observer
        self._t_ns = 0
        self._values: dict[str, SampleValue] = {}
        self._last: dict[str, SampleValue] = {}

    def event(self, t_ns: int, name: str) -> None:
        """Record an event."""
        self._at(t_ns)[name] = True

    def has(self, t_ns: int, name: str) -> bool:
        """Whether this name was already recorded at this instant."""
        return t_ns == self._t_ns and name in self._values

    def signal(self, t_ns: int, name: str, value: SampleValue) -> None:
        """Record the value of a signal if it has changed."""
        if name not in self._last or self._last[name] != value:
            self.refresh(t_ns, name, value)

    def refresh(self, t_ns: int, name: str, value: SampleValue) -> None:
        """Record the value of a signal even if it is unchanged, as its source is alive."""
        self._last[name] = value
        self._at(t_ns)[name] = value

    def finish(self) -> None:
        """Complete the sample of the last instant."""
        if self._values:
            values, self._values = self._values, {}
            self.samples.append((self._t_ns, values))
            if self._observer is not None:
                self._observer(self._t_ns, values)

    def _at(self, t_ns: int) -> dict[str, SampleValue]:
        if t_ns != self._t_ns:
            self.finish()
            self._t_ns = t_ns
        return self._values


Forces = tuple[float, float, float]
"""Forces (N) on the taking hand, the forearm and the other hand."""

_NO_FORCE: Forces = (0.0, 0.0, 0.0)


def _greatest(forces: Forces, other: Forces) -> Forces:
    return max(forces[0], other[0]), max(forces[1], other[1]), max(forces[2], other[2])


class Truth:
    """Measures the bodies without error, for requirements and for people, not for the robot."""

    def __init__(self, scene: Scene, human: Human) -> None:
        self._scene = scene
        self._human = human
        self._peaks = _NO_FORCE
        self._shown = (-1, _NO_FORCE)

    def step(self) -> None:
        """Update the largest forces on the human since the last measurement."""
        now = self._human.hand_force(), *self._human.arm_forces()
        if now != _NO_FORCE:
            self._peaks = _greatest(self._peaks, now)

    def measure(self, t_ns: int) -> dict[str, SampleValue]:
        """All signals at an instant: lengths in m to 1 mm, forces in N, speeds in m/s."""
        self.step()
        shown_ns, shown = self._shown
        peaks = _greatest(self._peaks, shown) if shown_ns == t_ns else self._peaks
        self._shown, self._peaks = (t_ns, peaks), _NO_FORCE
        hand, forearm, other_hand = peaks
        scene = self._scene
        grip = measures.gripper_force(scene)
        to_hand, to_person = measures.person_distances(scene)
        return {
            "piece_height": round(scene.piece.position.y, 3),
            "gripper_holds": grip >= p.PRESSURE_MIN,
            "person_holds": self._human.holds(),
            "gripper_opening": round(measures.gripper_opening(scene), 3),
            "hand_force": round(max(hand, other_hand)),
            "other_hand_force": round(other_hand),
            "forearm_force": round(forearm),
            "true_distance": round(to_hand, 3),
            "person_distance": round(to_person, 3),
            **self._person_distance(),
            "true_gaze": measures.gaze_is_ok(scene),
            "true_pressure": self._human.shares_piece(),
            "true_location": measures.location_is_ok(scene),
            "tool_speed": round(measures.tool_speed(scene), 3),
        }

    def _person_distance(self) -> dict[str, SampleValue]:
        if self._scene.arms is None:
            return {}
        distance = measures.beside_distance(self._scene, *measures.tool_point(self._scene))
        return {"beside_distance": round(distance, 3)}

    def places(self) -> dict[str, SampleValue]:
        """The piece's position along x, and the grip's distance behind and above it: m to 1 mm."""
        piece, grip = self._scene.piece.position, measures.tool_point(self._scene)
        return {
            "piece_x": round(piece.x, 3),
            "grip_behind": round(piece.x - grip[0], 3),
            "grip_above": round(grip[1] - piece.y, 3),
        }
