"""What live doors bear: latency from publishing to the callback, rates, and what is lost above.

    python -m benchmarks.live_latency --seconds 600
    python -m benchmarks.live_latency mqtt dds

Each door in turn, with real servers, in a process of its own that another process publishes to (a
thread, for those within a program). At `--hertz` messages per second: how long it took from before
the message was published until `on_judged` was called with its verdict, and whether all verdicts
are those of the same data as CSV. Then at doubled rates, from 1,000 on, each for `--step` seconds:
the highest at which every message was judged, and at the first at which not, how many messages
were counted as lost, how many nobody has seen (`unseen`: they were lost before they came here), and
the verdict of a requirement that nothing violates: it should be I where anything was lost.
`limit` says that the publisher could not publish faster.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import logging
import os
import platform
import subprocess
import sys
import tempfile
import time
from collections import Counter, deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path

from tests.tools.servers import LOOPBACK, SYSTEM, Broker, master_of_ros1, mosquitto

import rvmon
from rvmon.adapters.json_objects import JsonObjects, feed_lines, read_lines
from rvmon.adapters.messages import MessageFeed
from rvmon.live import Judgement, Live, LiveTasks

SPEC = """
spec live
signal sent : int
signal speed : real
requirement LATENCY
  upon updated(sent)
  then sent >= 0
  let s = sent
requirement SPEED
  always speed <= 1
requirement SAFE
  always speed <= 9
"""
DOORS = ("threads", "asyncio", "pipe", "mqtt", "ros1", "dds")
COMMAND = (sys.executable, "-m", "benchmarks.live_latency")
FASTEST = 128_000
QUIET_S = 1.0
"""Nothing has come for so long: nothing is under way any more."""

Send = Callable[[str, float], object]


def value_of(number: int) -> tuple[str, float]:
    """What message so many says: now and then a speed that is too high, or when it was sent."""
    if number % 2:
        return "speed", 1.5 if number % 97 == 0 else 0.5
    return "sent", time.monotonic_ns()


def publish(send: Send, hertz: float, seconds: float) -> tuple[int, float]:
    """Publish at a rate; how many messages, and in how many seconds."""
    began, number = time.monotonic(), 0
    while (now := time.monotonic() - began) < seconds:
        while number <= now * hertz:
            send(*value_of(number))
            number += 1
        time.sleep(max(0.0, began + number / hertz - time.monotonic()))
    return number, time.monotonic() - began


# --- publishers in processes of their own ----------------------------------------------------


@contextmanager
def _pipe(_: str) -> Iterator[Send]:
    out = sys.stdout.buffer
    yield lambda name, value: (out.write(b'{"%s": %r}\n' % (name.encode(), value)), out.flush())


@contextmanager
def _mqtt(address: str) -> Iterator[Send]:
    from paho.mqtt.client import CallbackAPIVersion, Client

    client = Client(CallbackAPIVersion.VERSION2)
    client.max_queued_messages_set(0)
    client.connect("127.0.0.1", int(address))
    client.loop_start()
    under_way = deque([client.publish("begin", "0", qos=1)])

    def send(name: str, value: float) -> None:
        under_way.append(client.publish(f"door/{name}", repr(value), qos=1))
        if len(under_way) > 1_000:  # or they would wait here, and not be published
            under_way.popleft().wait_for_publish()

    yield send
    under_way[-1].wait_for_publish()
    time.sleep(QUIET_S)
    client.disconnect()
    client.loop_stop()


@contextmanager
def _ros1(_: str) -> Iterator[Send]:
    sys.path.append(SYSTEM)
    import rospy
    from std_msgs.msg import Float64, Int64

    rospy.init_node("talker", disable_signals=True)
    kinds = {"sent": Int64, "speed": Float64}
    found = {name: rospy.Publisher(name, kind, queue_size=1_000) for name, kind in kinds.items()}
    while not all(one.get_num_connections() for one in found.values()):
        time.sleep(0.02)
    time.sleep(0.3)
    yield lambda name, value: found[name].publish(value)
    time.sleep(QUIET_S)


@contextmanager
def _dds(address: str) -> Iterator[Send]:
    from cyclonedds.core import Policy, Qos
    from cyclonedds.domain import DomainParticipant
    from cyclonedds.pub import DataWriter
    from cyclonedds.topic import Topic

    from rvmon.adapters.dds import _idl_type

    here = DomainParticipant(int(address))
    qos = Qos(Policy.Reliability.Reliable(10**9), Policy.History.KeepLast(1_000))
    kinds = {
        name: _idl_type(f"std_msgs/msg/{kind}64", ())
        for name, kind in (("sent", "Int"), ("speed", "Float"))
    }
    found = {
        name: DataWriter(here, Topic(here, f"rt/{name}", kind), qos=qos)
        for name, kind in kinds.items()
    }
    while not all(one.get_matched_subscriptions() for one in found.values()):
        time.sleep(0.02)
    time.sleep(0.3)
    yield lambda name, value: found[name].write(kinds[name](data=value))
    time.sleep(QUIET_S)


PUBLISHERS = {"pipe": _pipe, "mqtt": _mqtt, "ros1": _ros1, "dds": _dds}


# --- what is measured ------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Passage:
    """What came of messages that were published at a rate.

    Attributes:
        sent: so many were published.
        seconds: in so many.
        judged: so many were judged.
        lost: so many were counted as lost.
        cpu: of the monitor's process, s.
        latencies: from before the publishing to the callback, s, sorted.
        counts: the attempts by requirement and verdict.
        safe: the verdict of the requirement that nothing violates.
    """

    sent: int
    seconds: float
    judged: int
    lost: int
    cpu: float
    latencies: list[float]
    counts: dict[str, int]
    safe: str

    @property
    def unseen(self) -> int:
        """So many were lost before they came here."""
        return self.sent - self.judged - self.lost

    @property
    def hertz(self) -> float:
        """The rate at which they were published."""
        return self.sent / self.seconds


def passed(door: str, address: str, hertz: float, seconds: float) -> Passage:
    """Have messages published and judged: once in a process, as rospy is a node once."""
    spec = rvmon.loads(SPEC)
    latencies: list[float] = []

    def hear(one: Judgement) -> None:
        if one.attempt.requirement == "LATENCY":
            latencies.append((time.monotonic_ns() - one.attempt.captured["s"]) / 1e9)

    cpu = time.process_time()
    if door == "asyncio":
        live: Live | LiveTasks = LiveTasks(spec, on_judged=hear)
        sent = asyncio.run(_in_loop(live, hertz, seconds))
    else:
        live = Live(spec, on_judged=hear)
        with live:
            sent = _through(door, address, live, hertz, seconds)
    cpu = time.process_time() - cpu
    status = live.status()[""]
    counts = {f"{name} {verdict}": count for (name, verdict), count in status.counts.items()}
    safe = status.verdicts["SAFE"].value
    return Passage(*sent, status.samples, status.lost, cpu, sorted(latencies), counts, safe)


def _through(
    door: str, address: str, live: Live, hertz: float, seconds: float
) -> tuple[int, float]:
    if door == "threads":
        return _published(live, hertz, seconds)
    schema = live.spec.schema
    objects = JsonObjects(live, schema)
    source: AbstractContextManager[object] = nullcontext()
    if door == "mqtt":
        from rvmon.adapters.mqtt import MqttSource, address_of

        source = MqttSource(objects, address_of(f"mqtt://127.0.0.1:{address}/door/#"))
    elif door == "ros1":
        from rvmon.adapters.ros1 import Ros1Source

        source = Ros1Source(MessageFeed(live, schema))
    elif door == "dds":
        from rvmon.adapters.dds import DdsSource

        source = DdsSource(MessageFeed(live, schema), domain=int(address))
    words = [*COMMAND, "--publish", door, address, str(hertz), str(seconds)]
    with source, subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        if door == "pipe" and process.stdout is not None:
            feed_lines(objects, read_lines(process.stdout.fileno()))
        said = process.communicate()[1].decode()
        _wait_until_quiet(live)
    count, took = json.loads(said.splitlines()[-1])
    return count, took


def _published(live: Live | LiveTasks, hertz: float, seconds: float) -> tuple[int, float]:
    sent = publish(lambda name, value: live.offer({name: value}), hertz, seconds)
    _wait_until_quiet(live)
    return sent


def _wait_until_quiet(live: Live | LiveTasks) -> None:
    before = -1
    while (now := sum(one.samples for one in live.status(most_open=1).values())) != before:
        before = now
        time.sleep(QUIET_S)


async def _in_loop(live: LiveTasks, hertz: float, seconds: float) -> tuple[int, float]:
    async with live:
        return await asyncio.to_thread(_published, live, hertz, seconds)


@contextmanager
def served(door: str) -> Iterator[str]:
    """The server of a door, and what leads to it."""
    with ExitStack() as stack:
        address = "none"
        if door == "mqtt":
            broker = Broker(Path(stack.enter_context(tempfile.TemporaryDirectory())))
            stack.callback(broker.stop)
            address = str(broker.port)
        elif door == "ros1":
            os.environ["ROS_MASTER_URI"] = stack.enter_context(master_of_ros1())
            os.environ["ROS_IP"] = "127.0.0.1"
        elif door == "dds":
            os.environ["CYCLONEDDS_URI"] = LOOPBACK
            address = str(100 + os.getpid() % 100)
        yield address


def as_csv(messages: int, hertz: float) -> dict[str, int]:
    """The attempts by requirement and verdict of the same data as CSV, as `rvmon run` has it."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "same.csv")
        with path.open("w") as file:
            file.write("t_ns,sent,speed\n")
            for number in range(messages):
                row = dict([value_of(number)])
                t = round(number * 1e9 / hertz)
                file.write(f"{t},{row.get('sent', '')},{row.get('speed', '')}\n")
        report = rvmon.loads(SPEC).evaluate(path)
    return dict(Counter(f"{one.requirement} {one.verdict}" for one in report.attempts))


def _at(latencies: Sequence[float], share: float) -> str:
    if not latencies:
        return "none"
    return f"{1e3 * latencies[min(len(latencies) - 1, int(share * len(latencies)))]:.2f}"


def measure(door: str, hertz: float, seconds: float, step: float) -> str:
    """A row of the table."""

    def found(hertz: float, seconds: float) -> Passage:
        words = [*COMMAND, "--judge", door, address, str(hertz), str(seconds)]
        said = subprocess.run(words, stdout=subprocess.PIPE, check=True).stdout
        return Passage(**json.loads(said.splitlines()[-1]))

    with served(door) as address:
        first = found(hertz, seconds)
        best, above = 0.0, "limit"
        rate = 1_000
        while rate <= FASTEST:
            one = found(rate, step)
            if one.lost or one.unseen:
                above = f"{one.hertz:,.0f}/s: {one.lost:,} / {one.unseen:,} {one.safe}"
                break
            best = max(best, one.hertz)
            if one.hertz < 0.9 * rate:
                break
            rate *= 2
    latency = "  ".join(f"{_at(first.latencies, one):>8}" for one in (0.5, 0.99, 1))
    equal = "equal" if first.counts == as_csv(first.sent, hertz) else "DIFFER"
    cpu = 100 * first.cpu / first.seconds
    lost = f"{first.lost:>6,}  {first.unseen:>6,}"
    return f"{door:8}  {latency}  {equal:>6}  {lost}  {cpu:>4.0f}  {best:>11,.0f}  {above}"


def versions() -> str:
    """Of what took part."""
    words = [f"Python {platform.python_version()}, rvmon {rvmon.__version__}"]
    words += [f"{name} {version(name)}" for name in ("paho-mqtt", "cyclonedds", "rosbags")]
    if (program := mosquitto()) is not None:
        told = subprocess.run([program, "-h"], capture_output=True, text=True, check=False)
        words.append(told.stdout.splitlines()[0])
    found = subprocess.run(
        ["dpkg-query", "-W", "-f", "${Version}", "python3-rospy"],  # noqa: S607
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    words.append(f"python3-rospy {found.stdout or 'none'}")
    return ", ".join(words)


def main(argv: Sequence[str]) -> int:
    """Measure the doors in turn."""
    if argv[:1] in (["--publish"], ["--judge"]):
        what, door, address, hertz, seconds = argv
        if what == "--publish":
            with PUBLISHERS[door](address) as send:
                sent = publish(send, float(hertz), float(seconds))
            print(json.dumps(sent), file=sys.stderr)
        else:
            sys.path.append(SYSTEM)
            logging.getLogger("rvmon.live").setLevel(logging.CRITICAL)
            found = passed(door, address, float(hertz), float(seconds))
            print(json.dumps(asdict(found)))
        return 0
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("doors", nargs="*", default=DOORS, metavar="DOOR", help=", ".join(DOORS))
    parser.add_argument("--seconds", type=float, default=10.0, help="at that rate")
    parser.add_argument("--hertz", type=float, default=1_000.0)
    parser.add_argument("--step", type=float, default=2.0, help="seconds of each doubled rate")
    options = parser.parse_args(argv)
    print(versions())
    print(
        f"load {os.getloadavg()[0]:.1f} of {os.cpu_count()} cores; {options.seconds:g} s at "
        f"{options.hertz:g}/s: ms from publishing to callback, CPU % of the monitor's process\n"
        f"{'door':8}  {'p50':>8}  {'p99':>8}  {'max':>8}  {'as CSV':>6}  {'lost':>6}  {'unseen':>6}"
        f"  {'CPU':>4}  {'sustained/s':>11}  above: lost / unseen, verdict"
    )
    for door in options.doors:
        print(measure(door, options.hertz, options.seconds, options.step), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
