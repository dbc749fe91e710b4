"""Topics of ROS 2 over DDS: more messages than wait within it, or than there is room for."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, closing
from threading import Event
from typing import Any

from benchmarks.lossy.live import Topics
from benchmarks.lossy.trial import Trial, Verdicts, batches
from benchmarks.lossy.wires import until_told
from tests.tools.servers import LOOPBACK, until

from rvmon.adapters import dds
from rvmon.adapters.messages import MessageFeed
from rvmon.readers.messages.topic import Topic


def domain() -> int:
    """One of this process alone."""
    return 100 + os.getpid() % 100


class _Gate(MessageFeed):
    """Takes a message when the gate is open, as one does that has much to do."""

    gate: Event
    at_gate = False

    def take(self, topic: Topic, content: Any) -> None:
        self.at_gate = True
        self.gate.wait()
        self.at_gate = False
        super().take(topic, content)


class _Talker(Topics):
    """One run: a topic for each name, and what hears them."""

    def __init__(self, home: str, trial: Trial, mouth: _Mouth) -> None:
        super().__init__(trial, home)
        self.feed = _Gate(self.driver, self.reading.schema)
        self.feed.gate = Event()
        self.feed.gate.set()
        self.source = dds.DdsSource(self.feed, domain=domain())
        self.mouth = mouth
        for name, topic in self.topics.items():
            mouth.say([topic, f"std_msgs/msg/{self.kind(name)}"])
        heard = {name for one in self.samples[: trial.lost.start] for name in one.values}
        signals = trial.case.spec.signals.keys()
        is_full = {*self.samples[trial.lost.start].values} <= heard & signals
        self.how = trial.rng.choice(("depth", "flood")) if is_full else "flood"
        trial.is_named = True
        if self.how == "depth":
            trial.lost = range(trial.lost.start, trial.lost.start + 1)

    def is_connected(self) -> bool:
        """Whether each topic is heard."""
        return len(self.source._readers) == len(self.topics) and all(
            self.mouth.is_heard(topic) for topic in self.topics.values()
        )

    def write(self, name: str, value: Any) -> None:
        """Publish what is said of a name."""
        self.mouth.say([self.topics[name], None, self.said(name, value)])

    def play(self) -> None:
        """Publish samples in their time, those that are to be lost in their way."""
        for place, sample in enumerate(self.samples):
            self.clock.set_ns(sample.t)
            if place in self.trial.lost and self.how == "depth":
                self._fill(place)
            elif place in self.trial.lost:
                self.flood(place)
            else:
                least = self.driver.waiting + len(sample.values)
                for name, value in sample.values.items():
                    self.write(name, value)
                until_told(self.driver, least)
            if self.trial.rng.random() < 0.3:
                self.driver.work()

    def _fill(self, place: int) -> None:
        """Have the messages of a sample find no room, as others of their instant wait.

        Those repeat what was said before; of two values of an instant the last counts.
        """
        for name, value in self.samples[place].values.items():
            known = (s.values[name] for s in self.samples[place - 1 :: -1] if name in s.values)
            former = next(known)
            self.feed.gate.clear()
            before = self.driver.waiting
            self.write(name, former)
            until(lambda: self.feed.at_gate)
            self.write(name, former)
            self.write(name, value)
            until_told(self.driver, before + 1)
            self.feed.gate.set()
            until_told(self.driver, before + 4)  # lost, twice the former, found


class _Mouth:
    """A process that publishes: what is said there goes over the wire."""

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "benchmarks.lossy.dds", str(domain())],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def say(self, words: list[Any]) -> None:
        """Have a topic, with its type; or something published on it.

        One word: look at that topic; none: have none any more.
        """
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps(words) + "\n")
        self._process.stdin.flush()

    def is_heard(self, topic: str) -> bool:
        """Whether somebody reads a topic."""
        assert self._process.stdout is not None
        self.say([topic])
        return self._process.stdout.readline() == "True\n"

    def close(self) -> None:
        self._process.kill()
        self._process.communicate()


_TOGETHER = 8
"""A domain of one machine has room for few participants more."""


def through_dds(trials: Iterator[Trial]) -> Iterator[Verdicts]:
    """Runs in one domain, in which one process publishes, and this one reads."""
    os.environ.setdefault("CYCLONEDDS_URI", LOOPBACK)
    depth, dds._DEPTH = dds._DEPTH, 1
    try:
        with closing(_Mouth()) as mouth:
            for number, batch in enumerate(batches(trials, _TOGETHER)):
                # Two processes may come to share a domain.
                yield from _heard(f"/p{os.getpid()}b{number}", batch, mouth)
    finally:
        dds._DEPTH = depth


def _heard(home: str, trials: Sequence[Trial], mouth: _Mouth) -> Sequence[Verdicts]:
    with ExitStack() as open_:
        talkers = [_Talker(f"{home}r{n}", trial, mouth) for n, trial in enumerate(trials)]
        for talker in talkers:
            open_.enter_context(talker.source)
        for talker in talkers:
            until(talker.is_connected)
            talker.play()
    mouth.say([])
    return [one.verdicts() for one in talkers]


def main() -> None:
    """Publish what is said on standard input."""
    from cyclonedds.domain import DomainParticipant
    from cyclonedds.pub import DataWriter
    from cyclonedds.topic import Topic as DdsTopic

    participant = DomainParticipant(int(sys.argv[1]))
    writers: dict[str, tuple[Any, Any]] = {}
    for line in sys.stdin:
        match json.loads(line):
            case []:
                writers.clear()
            case [topic]:
                print(_has_reader(writers[topic][0]), flush=True)
            case [topic, name]:
                kind = dds._idl_type(name, ())
                writer = DataWriter(participant, DdsTopic(participant, f"rt{topic}", kind))
                writers[topic] = writer, kind
            case [topic, _, value]:
                writer, kind = writers[topic]
                field = next(iter(kind.__annotations__))
                is_empty = field != "data"
                writer.write(kind(**{field: 0 if is_empty else value}))


def _has_reader(writer: Any) -> bool:
    try:
        return bool(writer.get_matched_subscriptions())
    except IndexError:  # one came while they were counted
        return True


if __name__ == "__main__":
    main()
