"""Abstract tests: the human's behaviour as a sequence of high-level actions."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import resources
from typing import Annotated, ClassVar, Literal, Self

import msgspec
from msgspec import structs

from handover.world.faults import SceneFaults, SensorFaults
from rvmon.cdv import Test
from rvmon.cdv.test import from_json

HumanSignal = Literal["activateRobot", "humanIsReady", "setv"]
RobotSignal = Literal["informHumanOfHandoverStart", "setv"]
Posture = Literal["hgazeOk", "hlocationOk", "hpressureOk"]
Switch = Literal[
    "honTask", "hgazeOk", "setg", "h_undefGaze", "hpressureOk", "setp", "h_undefPress",
    "hlocationOk", "setl", "h_undefLoc",
]  # fmt: skip
"""Parameters that are 0 or 1."""

Parameter = Literal[Switch, "time"]
Strategy = Literal[
    "pseudorandom", "constrained", "model-based", "model-based-shortest", "model-based-fastest",
    "disturbed", "directed", "closed",
]  # fmt: skip

SEND_DELAY_S = 2.0
"""Seconds that the human takes to send a signal."""

SEND_PAUSE_S = 0.2
"""Seconds of pause after a signal."""


class SendSignal(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="send_signal"):
    """The human sends a signal to the robot; `setv` sends nothing."""

    signal: HumanSignal


class ReceiveSignal(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="receive_signal"):
    """The human waits for a signal from the robot; `setv` waits for nothing."""

    signal: RobotSignal


class SetParam(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="set_param"):
    """The human takes a posture (0 bad, 1 ok), or waits: `time` is in units of 0.05 s."""

    param: Parameter
    value: Annotated[int, msgspec.Meta(ge=0, le=4000)]

    def __post_init__(self) -> None:
        if self.param != "time" and self.value > 1:
            raise ValueError(f"`{self.param}` is 0 or 1, not {self.value}")


class Withdraw(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="withdraw"):
    """The human loses interest: lets go, takes the hand back to the chest and looks away."""


Action = SendSignal | ReceiveSignal | SetParam | Withdraw


class AbstractTest(Test, frozen=True, kw_only=True):
    """A test of a handover.

    Attributes:
        strategy: the generator that made it.
        actions: in order; each starts when the previous one is over.
        robot: the robot that it is written for; `None`: any.
        mutation: a name from `handover.robot.mutants.MUTATIONS`; `None`: no planted fault.
        postures: whether they are drawn from their ranges, or from the ends of these, where sensors
            may err.
        horizon_s: simulated seconds.
        arrives_s: the instant at which the human starts; default: drawn, after the robot is up.
        startup_loss: whether the human's signals may get lost when the processes start.
        faults: faults of the sensors.
        scene: faults of the scene.
    """

    strategy: Strategy
    actions: tuple[Action, ...]
    robot: Literal["correct", "legacy"] | None = None
    postures: Literal["in_range", "at_limits"] = "in_range"
    horizon_s: Annotated[float, msgspec.Meta(gt=0, le=3600)] = 200.0
    arrives_s: Annotated[float, msgspec.Meta(ge=0, le=60)] | None = None
    startup_loss: bool = True
    faults: SensorFaults = SensorFaults()
    scene: SceneFaults = SceneFaults()

    removable: ClassVar[tuple[str, ...]] = ("actions",)

    def simpler(self) -> Iterator[Self]:
        """Simpler tests: first without one fault each, then with one wait cut by at least 1/4."""
        if self.startup_loss:
            yield structs.replace(self, startup_loss=False)
        for disturbance in ("faults", "scene"):
            present = getattr(self, disturbance)
            for fault in structs.fields(present):
                if getattr(present, fault.name) != fault.default:
                    fixed = structs.replace(present, **{fault.name: fault.default})
                    yield structs.replace(self, **{disturbance: fixed})
        for at, action in enumerate(self.actions):
            if isinstance(action, SetParam) and action.param == "time":
                for units in sorted({1, action.value // 2, action.value * 3 // 4}):
                    if 0 < units < action.value:
                        wait = SetParam("time", units)
                        shorter = (*self.actions[:at], wait, *self.actions[at + 1 :])
                        yield structs.replace(self, actions=shorter)


def directed() -> tuple[AbstractTest, ...]:
    """The directed tests that come with the testbench, sorted by name."""
    folder = resources.files("handover.generator") / "directed"
    files = sorted(
        (entry for entry in folder.iterdir() if entry.name.endswith(".json")),
        key=lambda entry: entry.name,
    )
    return tuple(from_json(entry.read_bytes(), AbstractTest, source=entry.name) for entry in files)
