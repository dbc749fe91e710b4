"""Topics of ROS 1 in a process of their own, by a real master: connections that are lost."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

from benchmarks.lossy.live import Topics
from benchmarks.lossy.trial import Trial, Verdicts, batches
from benchmarks.lossy.wires import until_told
from tests.tools.servers import SYSTEM, master_of_ros1, until

from rvmon.session import Spec
from rvmon.testing.generate.trace import Case

_TOGETHER = 25

_Given = tuple[str, Case, range, Path]
"""A trial, as another process gets it."""


def through_ros1(trials: Iterator[Trial]) -> Iterator[Verdicts]:
    """Runs by one master, some each in a process: rospy is begun once in one."""
    with master_of_ros1() as address, closing(_Begun(address)) as process:
        for batch in batches(trials, _TOGETHER):
            for trial, (how, verdicts) in zip(batch, process.judged(batch), strict=True):
                trial.is_named = how != "down"
                yield verdicts


class _Begun:
    """A process that has rospy, and begins others, which have it, too."""

    def __init__(self, master: str) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "benchmarks.lossy.ros1"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env={**os.environ, "ROS_MASTER_URI": master, "ROS_IP": "127.0.0.1"},
        )

    def judged(self, trials: Sequence[Trial]) -> list[tuple[str, Verdicts]]:
        """How each loses something, and its verdicts."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        given = [(trial.name, trial.case, trial.lost, trial.folder) for trial in trials]
        pickle.dump(given, self._process.stdin)
        self._process.stdin.flush()
        judged: list[tuple[str, Verdicts]] = pickle.load(self._process.stdout)  # noqa: S301 - own
        return judged

    def close(self) -> None:
        self._process.communicate()


class _Talker(Topics):
    """One run: a topic for each name, and what hears them."""

    def __init__(self, number: int, trial: Trial) -> None:
        from rvmon.adapters.messages import MessageFeed
        from rvmon.adapters.ros1 import Ros1Source

        super().__init__(trial, f"/r{number}")
        self._publishers: dict[str, Any] = {}
        self.source = Ros1Source(MessageFeed(self.driver, self.reading.schema))
        is_plain = all(name in trial.case.spec.signals for name in trial.names)
        self.how = trial.rng.choice(("down", "damaged" if is_plain else "down", "flood"))

    def advertise(self) -> None:
        """Begin to publish what is heard, each name by itself."""
        import rospy

        for name, topic in self.topics.items():
            if self.trial.case.names is None or name in self.trial.case.names:
                kind = self._type(name)
                self._publishers[name] = rospy.Publisher(topic, kind, queue_size=100)

    def _type(self, name: str) -> Any:
        from std_msgs import msg

        return getattr(msg, self.kind(name))

    def is_connected(self) -> bool:
        """Whether each topic is heard."""
        return all(one.get_num_connections() > 0 for one in self._publishers.values())

    def send(self, place: int, *, is_damaged: bool = False) -> None:
        """Publish a sample, name by name, and wait until it is here."""
        before, values = self.driver.waiting, self.samples[place].values
        for name, value in values.items():
            kind = self._type(name)
            if is_damaged:
                kind = type(kind.__name__, (kind,), {"serialize": lambda *_: None})
            is_signal = name in self.trial.case.spec.signals
            self._publishers[name].publish(kind(self.said(name, value)) if is_signal else kind())
        until_told(self.driver, before + len(values))

    def play(self, places: range) -> None:
        """Publish samples in their time, those that are to be lost in their way."""
        for place in places:
            is_lost = place in self.trial.lost
            self.clock.set_ns(self.samples[place].t)
            if is_lost and self.how == "down":
                continue
            if is_lost and self.how == "flood":
                self.flood(place)
            else:
                self.send(place, is_damaged=is_lost)
            if self.trial.rng.random() < 0.3:
                self.driver.work()

    def break_off(self) -> None:
        """Close all connections, as a network does that goes away; nobody leaves."""
        self.driver.work()
        for publisher in self._publishers.values():
            for connection in tuple(publisher.impl.connections):
                connection.close()

    def come_back(self) -> None:
        """Have them made anew."""
        for publisher in self._publishers.values():
            publisher.unregister()
        self.advertise()


def main() -> None:
    """Judge the trials that come in, some each in a process of their own."""
    sys.path.append(SYSTEM)
    import rospy  # noqa: F401 - for all of them

    out, sys.stdout = sys.stdout.buffer, sys.stderr
    while True:
        try:
            given = pickle.load(sys.stdin.buffer)  # noqa: S301 - of our own
        except EOFError:
            return
        if os.fork() == 0:
            try:
                out.write(pickle.dumps(_verdicts(given)))
                out.flush()
            finally:
                os._exit(0)  # what rospy has begun ends by itself in seconds
        os.wait()


def _verdicts(given: Sequence[_Given]) -> list[tuple[str, Verdicts]]:
    import rospy

    os.environ["ROS_HOME"] = str(given[0][-1])
    rospy.init_node("rvmon", anonymous=True, disable_signals=True)
    talkers = [
        _Talker(number, Trial(name, Spec(case.spec), case, lost, folder))
        for number, (name, case, lost, folder) in enumerate(given)
    ]
    for talker in talkers:
        talker.source.__enter__()
        talker.advertise()
    down = [talker for talker in talkers if talker.how == "down"]
    for talker in talkers:
        until(talker.is_connected)
    time.sleep(0.5)  # each has looked at its connections
    for talker in talkers:
        talker.play(range(talker.trial.lost.start if talker in down else len(talker.samples)))
    for talker in down:
        talker.break_off()
    for talker in down:  # as many topics are lost as were heard
        until_told(talker.driver, len(talker._publishers))
        talker.clock.set_ns(talker.samples[talker.trial.lost[-1]].t)
        talker.driver.work()
        talker.come_back()
    for talker in down:
        until(talker.is_connected)
        until_told(talker.driver, len(talker._publishers))
        talker.play(range(talker.trial.lost.stop, len(talker.samples)))
    return [(one.how, dict(one.verdicts())) for one in talkers]


if __name__ == "__main__":
    main()
