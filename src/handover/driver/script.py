"""The human's script: an abstract test's actions become signals, waits and postures."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import assert_never

from handover.generator.abstract_test import (
    SEND_DELAY_S,
    SEND_PAUSE_S,
    Action,
    ReceiveSignal,
    SendSignal,
    SetParam,
    Withdraw,
)
from handover.world import parameters as p
from handover.world.bus import Node
from handover.world.human import Human
from handover.world.process import Program
from handover.world.world import HUMAN_SIGNALS

POLL_S = 0.2
POLL_LIMIT = 500
TIME_UNIT_S = 0.05
INFORMED = "informed"


@dataclass(frozen=True, slots=True)
class Script:
    """Plays actions one after the other; each starts when the previous one is over."""

    actions: Iterable[Action]  # of the abstract test
    node: Node  # the human's connection to the bus
    human: Human  # the body that takes the postures
    draw: Callable[[float, float], float]  # draws a number of a posture from its range
    start_s: float  # seconds until the script starts
    connected: bool  # whether signals reach the robot

    def run(self) -> Program:
        """Wait until the process is up, then play the actions; stop if a wait times out."""
        yield self.start_s
        for action in self.actions:
            match action:
                case SendSignal(signal="setv") | ReceiveSignal(signal="setv"):
                    continue
                case SendSignal(signal=signal):
                    yield from self._send(signal)
                case ReceiveSignal():
                    yield from self._wait_for_robot()
                    if self.node.receive(INFORMED) is None:
                        return
                case SetParam(param="time", value=units):
                    yield units * TIME_UNIT_S
                case SetParam(param=param, value=value):
                    self._take_posture(param, ok=value != 0)
                case Withdraw():
                    self.human.withdraw()
                case _:
                    assert_never(action)

    def _send(self, signal: str) -> Program:
        yield SEND_DELAY_S
        if self.connected:
            self.node.publish(HUMAN_SIGNALS, signal, latched=True)
        yield SEND_PAUSE_S

    def _wait_for_robot(self) -> Program:
        self.node.publish("person_waits", True)
        for _ in range(POLL_LIMIT):
            self.node.subscribe(INFORMED)
            yield POLL_S
            if self.node.receive(INFORMED) is not None:
                self.node.publish("person_told")
                self.node.publish("person_waits", False)
                return

    def _take_posture(self, param: str, *, ok: bool) -> None:
        """Draw a posture from its range and take it; other parameters have no effect."""
        match param:
            case "hgazeOk":
                self._look(ok=ok)
            case "hlocationOk":
                self._reach(ok=ok)
            case "hpressureOk":
                self.human.grasp(closed=ok)
            case "honTask" if not ok:
                self._look(ok=False)
                self._reach(ok=False)
                self.human.grasp(closed=False)
            case _:
                pass

    def _look(self, *, ok: bool) -> None:
        offset, distance, angle = p.GAZE_OK if ok else p.GAZE_BAD
        self.human.look(self.draw(*offset), self.draw(*distance), self.draw(*angle))

    def _reach(self, *, ok: bool) -> None:
        if ok:
            self.human.reach(*p.LOCATION_OK, near=True)
        else:
            away = self.draw(*p.LOCATION_BAD)
            self.human.reach(away, away, near=False)
