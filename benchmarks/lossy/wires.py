"""MQTT by a broker that goes and comes back, damaged payloads, floods: several runs at once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from benchmarks.lossy.live import Heard, damaged, object_of
from benchmarks.lossy.trial import Trial, Verdicts, batches
from tests.tools.servers import Broker, until

from rvmon.adapters.json_objects import JsonObjects
from rvmon.adapters.mqtt import MqttSource, address_of
from rvmon.live import Driver
from rvmon.trace.sample import Sample


def until_told(driver: Driver, least: int = 1) -> None:
    """Wait until so much waits for a driver to work."""
    until(lambda: driver.waiting >= least)


class _Counted(JsonObjects):
    """Objects that are counted as they come."""

    came = 0

    def take(self, fields: Any, robot: str = "", **how: bool) -> None:
        super().take(fields, robot, **how)
        self.came += 1

    def lose(self, where: str, why: Exception, robot: str | None) -> None:
        super().lose(where, why, robot)
        self.came += 1


class _Subscribed(Heard):
    """One run that is heard over MQTT."""

    def __init__(
        self, trial: Trial, how: Sequence[str], number: int, port: int, publish: Any
    ) -> None:
        super().__init__(trial)
        self.how = trial.rng.choice(how)
        self.objects = _Counted(self.driver)
        self.source = MqttSource(self.objects, address_of(f"mqtt://127.0.0.1:{port}/r{number}/#"))
        self._topic, self._publish, self._sent = f"r{number}", publish, 0

    def send(self, sample: Sample, *, stamped: bool = False, is_damaged: bool = False) -> None:
        """Publish a sample, and wait until it is here."""
        text = object_of(sample, stamped=stamped)
        if is_damaged:
            text = damaged(self.trial.rng, text)
        self._sent += 1
        self._publish(self._topic, text)
        until(lambda: self.objects.came == self._sent)

    def play(self, places: range) -> None:
        """Publish samples in their time, those that are to be lost in their way."""
        self.trial.is_late = self.how in ("late", "down late")
        self.trial.is_named = self.how in ("late", "flood")
        if self.how == "flood":
            self.driver._waiting.room = 1
        for place in places:
            sample = self.samples[place]
            is_lost = place in self.trial.lost
            self.clock.set_ns(sample.t)
            if not (is_lost and self.how in ("late", "down", "down late")):
                if self.how != "flood" or not is_lost:
                    self.driver.work()
                self.send(sample, is_damaged=is_lost and self.how == "damaged")
            if self.trial.rng.random() < 0.3 and place + 1 not in self.trial.lost:
                self.driver.work()

    def verdicts(self) -> Verdicts:
        """Those of the end, behind what came late."""
        if self.how == "late":
            for place in self.trial.lost:
                self.driver.work()
                self.send(self.samples[place], stamped=True)
        return super().verdicts()


_TOGETHER = 25


def through_mqtt(trials: Iterator[Trial]) -> Iterator[Verdicts]:
    """Some runs each by one broker."""
    for batch in batches(trials, _TOGETHER):
        yield from _by_one_broker(batch)


def _by_one_broker(trials: Sequence[Trial]) -> Iterator[Verdicts]:
    """Runs by a broker which goes and comes back once; some hear of it late."""
    from paho.mqtt.client import Client
    from paho.mqtt.enums import CallbackAPIVersion

    broker = Broker(Path(trials[0].folder).parent)
    client = Client(CallbackAPIVersion.VERSION2)
    _hurry(client)

    def publish(topic: str, text: bytes) -> None:
        until(client.is_connected)
        until(client.publish(topic, text, qos=1).is_published)

    goes = trials[0].rng.random() < 0.4
    how = ("down", "down late") if goes else ("damaged", "late", "flood")
    with ExitStack() as open_:
        open_.callback(broker.stop)
        client.connect("127.0.0.1", broker.port)
        client.loop_start()
        open_.callback(client.loop_stop)
        runs = [_Subscribed(trial, how, n, broker.port, publish) for n, trial in enumerate(trials)]
        for run in runs:
            _hurry(run.source._client)
            open_.enter_context(run.source)
            if not goes:
                run.play(range(len(run.samples)))
        if goes:
            _go_and_come_back(broker, runs)
        yield from [run.verdicts() for run in runs]
        client.disconnect()


def _hurry(client: Any) -> None:
    """Have it look for the broker again after less than the least second that its types know."""
    client.reconnect_delay_set(0.05, 0.2)


def _go_and_come_back(broker: Broker, runs: Sequence[_Subscribed]) -> None:
    """Lose samples of all runs while the broker is away; of some it is known only later that it is.

    Those wait meanwhile as if nothing were to come.
    """
    for run in runs:
        run.play(range(run.trial.lost.stop if run.how == "down late" else run.trial.lost.start))
        run.driver.work()
    broker.stop()
    for run in runs:
        until_told(run.driver)
        run.clock.set_ns(run.samples[run.trial.lost[-1]].t)
        run.driver.work()
    broker.start()
    for run in runs:
        until_told(run.driver)
        run.play(range(run.trial.lost.stop, len(run.samples)))
