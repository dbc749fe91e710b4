"""Robots with one known fault each, which a testbench has to find."""

from __future__ import annotations

from dataclasses import replace

from handover.robot.handover import END, HANDOVER_POINT, HandoverRobot
from handover.robot.ports import Steps

FAR_OUT = (0.0, -0.42, -1.15)
"""rad: the grip at (0.32, 0.20) m."""

FAR_OUT_S = 4.0


class MindsNoHand(HandoverRobot):
    """Closes the gripper wherever a hand is."""

    def hand_is_close(self) -> bool:
        """See no hand."""
        return False


class ReleasesAnyway(HandoverRobot):
    """Decides without looking at the sensors."""

    def decide(self) -> Steps[str]:
        """Decide as always, then release whatever was decided."""
        yield from super().decide()
        return "release"


class IgnoresPressure(HandoverRobot):
    """Takes gaze and location for enough."""

    def decide(self) -> Steps[str]:
        """Release if gaze and location are all right."""
        next_state = yield from super().decide()
        reading = self.reading
        return "release" if reading.gaze and reading.location else next_state


class ForgetsToRelease(HandoverRobot):
    """Decides to release and then does nothing."""

    def release(self) -> Steps[str]:
        """Wait without opening the gripper."""
        yield self.behaviour.release_s
        return "done"


class ReleasesLate(HandoverRobot):
    """Opens the gripper four seconds after the decision."""

    def release(self) -> Steps[str]:
        """Hesitate, then release."""
        yield 4.0
        return (yield from super().release())


class NeverDecides(HandoverRobot):
    """Waits for a better reading for ever."""

    def sense(self) -> Steps[str]:
        """Look at the sensors and never be content."""
        yield self.behaviour.sense_poll_s
        self.sensors.sense()
        return "sense"


class WaitsForEver(HandoverRobot):
    """Never gives up waiting for the human."""

    def poll_signal(self) -> Steps[str | None]:
        """Poll without counting."""
        signal = yield from super().poll_signal()
        self.polls = 0
        return signal


class EndsSilently(HandoverRobot):
    """Gives up without telling anybody."""

    def receive_activation(self) -> Steps[str]:
        """Wait for a single poll and leave."""
        yield self.behaviour.poll_s
        return END


class DropsWhatItWithholds(HandoverRobot):
    """Decides to keep the piece, and opens the gripper."""

    def decide(self) -> Steps[str]:
        """Open the gripper all the same."""
        next_state = yield from super().decide()
        if next_state == "done":
            self.gripper.open()
        return next_state


class Hurries(HandoverRobot):
    """Goes to its start pose a hundredth faster than it may near a person."""

    def reset(self) -> Steps[str]:
        """Take less time for it."""
        self.behaviour = replace(self.behaviour, reset_s=1.6)
        return (yield from super().reset())


class SwingsBlindly(HandoverRobot):
    """Swings the piece out to a fixed posture first, without regard to people in the way."""

    def go_to(self, x: float, z: float) -> Steps[bool]:
        """Reach far out before the handover point, without a plan."""
        if (x, z) == HANDOVER_POINT:
            yield from self.arm.follow(self.arm.interpolate(FAR_OUT, FAR_OUT_S))
        return (yield from super().go_to(x, z))


class Crashes(HandoverRobot):
    """Divides by zero when it should sense."""

    def sense(self) -> Steps[str]:
        """Crash."""
        yield self.behaviour.sense_poll_s / (self.polls - self.polls)
        return "decide"


MUTATIONS: dict[str, type[HandoverRobot]] = {
    "crashes": Crashes,
    "drops-what-it-withholds": DropsWhatItWithholds,
    "ends-silently": EndsSilently,
    "forgets-to-release": ForgetsToRelease,
    "hurries": Hurries,
    "ignores-pressure": IgnoresPressure,
    "minds-no-hand": MindsNoHand,
    "never-decides": NeverDecides,
    "releases-anyway": ReleasesAnyway,
    "releases-late": ReleasesLate,
    "swings-blindly": SwingsBlindly,
    "waits-for-ever": WaitsForEver,
}
"""The mutated robots by name."""
