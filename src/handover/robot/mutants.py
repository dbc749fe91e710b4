"""Robots with one planted fault each, which a testbench must find."""

from __future__ import annotations

from dataclasses import replace

from handover.robot.handover import END, HANDOVER_POINT, HandoverRobot
from handover.robot.ports import Steps

FAR_OUT = (0.0, -0.42, -1.15)
"""rad: the grip at (0.32, 0.20) m."""

FAR_OUT_S = 4.0


class MindsNoHand(HandoverRobot):
    """Closes the gripper even if a hand is in it."""

    def hand_is_close(self) -> bool:
        """Never see a hand."""
        return False


class ReleasesAnyway(HandoverRobot):
    """Releases regardless of the sensors."""

    def decide(self) -> Steps[str]:
        """Decide as usual, then release regardless of the decision."""
        yield from super().decide()
        return "release"


class IgnoresPressure(HandoverRobot):
    """Decides by gaze and location only."""

    def decide(self) -> Steps[str]:
        """Release if gaze and location are good."""
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
    """Senses for ever."""

    def sense(self) -> Steps[str]:
        """Read the sensors and ignore the reading."""
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
    """Ends without publishing anything."""

    def receive_activation(self) -> Steps[str]:
        """Wait for a single poll period and end."""
        yield self.behaviour.poll_s
        return END


class DropsWhatItWithholds(HandoverRobot):
    """Opens the gripper although it decides to keep the piece."""

    def decide(self) -> Steps[str]:
        """Decide as usual, and open the gripper if the piece should be withheld."""
        next_state = yield from super().decide()
        if next_state == "done":
            self.gripper.open()
        return next_state


class Hurries(HandoverRobot):
    """Moves to its start pose a hundredth faster than is allowed near a person."""

    def reset(self) -> Steps[str]:
        """Reset in less time."""
        self.behaviour = replace(self.behaviour, reset_s=1.6)
        return (yield from super().reset())


class SwingsBlindly(HandoverRobot):
    """Swings the piece to a fixed pose first, without regard to people in the way."""

    def go_to(self, x: float, z: float) -> Steps[bool]:
        """Before the handover point, reach far out without planning."""
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
