"""`rvmon watch`: monitor a running robot."""

from __future__ import annotations

import argparse
import itertools
import os
import shlex
import stat
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from io import FileIO
from typing import TYPE_CHECKING

from rvmon.adapters.json_objects import JsonObjects, feed_lines, first_lines, read_lines
from rvmon.cli.options import chosen_ids, constants_of
from rvmon.cli.output import warn
from rvmon.cli.reading import mapped_names, refuse_empty
from rvmon.cli.watch_kept import no_line, refuse_others, watch_kept
from rvmon.cli.watch_output import Output, output_named
from rvmon.errors import RvmonError, SpecError
from rvmon.language.rules import TooManyErrors
from rvmon.live import Clock, Judgement, Live, SimulatedClock, WallClock
from rvmon.recordings import FORMATS, form_of_folder
from rvmon.recordings.places import endings_of
from rvmon.session import Spec, load
from rvmon.verdicts import Verdict

if TYPE_CHECKING:
    from rvmon.adapters.dds import DdsSource
    from rvmon.adapters.ros1 import Ros1Source
    from rvmon.adapters.ros2 import Ros2Source

_TURN = 0.25  # seconds between two checks whether the specification has changed
_LAST_DOMAIN = 232  # the last DDS domain that has ports


def run_watch(arguments: argparse.Namespace) -> int:
    """Monitor until the stream ends or the user interrupts, and return the exit code."""
    # Before the files are read, so that no change is missed.
    arguments.ages = _ages(arguments.spec)
    spec = _loaded(arguments)
    if arguments.state is not None:
        return _watch_kept(arguments, spec)
    shown = output_named(arguments.format, failures_only=arguments.failures)
    scheme = next((known for known in _SOURCES if arguments.source.startswith(known)), "")
    watch, idle = _SOURCES[scheme]
    for option, instead in idle.items():
        if getattr(arguments, option):
            name = option.replace("_", "-")
            raise RvmonError(f"--{name} does not apply to {arguments.source}: {instead}")
    live = watch(arguments, spec, shown)
    shown.ended(live)
    verdicts = [
        verdict for status in live.status().values() for verdict in status.verdicts.values()
    ]
    unseen = (
        live.turned_away
        or shown.has_failed
        or any(verdict in (Verdict.FAIL, Verdict.INCONCLUSIVE) for verdict in verdicts)
    )
    return int(unseen or not verdicts)  # no verdicts: no robot has sent anything


def _watch_kept(arguments: argparse.Namespace, spec: Spec) -> int:
    refuse_others(arguments)
    with _opened(arguments) as file:
        lines = read_lines(file.fileno())
        is_file = stat.S_ISREG(os.fstat(file.fileno()).st_mode)
        only = chosen_ids(arguments, spec)
        return watch_kept(arguments, spec, only, lines, is_file=is_file)


def _watch_lines(arguments: argparse.Namespace, spec: Spec, shown: Output) -> Live:
    with _opened(arguments) as file:
        lines = read_lines(file.fileno())
        first, began = first_lines(lines, spec.schema)
        if not any(line.strip() for line in first):
            raise no_line(arguments.source)
        followed = None
        clock = _own_clock()
        is_stamped = began is not None or arguments.time is not None
        if is_stamped and arguments.realtime is None:
            # Unreadable lines above the first stamp count as earlier than it.
            clock = followed = SimulatedClock(0 if began is None else began - 1)
        live = _live(arguments, spec, clock, shown.judged)
        objects = JsonObjects(live, clock=followed)
        every = itertools.chain(first, lines)
        faults: list[str] = []

        def feed() -> None:
            try:
                feed_lines(objects, every, arguments.robot)
            except Exception as error:  # noqa: BLE001 - any error ends the input
                why = getattr(error, "strerror", None) or f"{type(error).__name__} {error}".strip()
                faults.append(f"{arguments.source}: {why}")
                live.lose(why=faults[0])

        feeding = threading.Thread(target=feed, daemon=True)
        with live, shown:
            feeding.start()
            _follow(arguments, live, shown, feeding)
        for fault in faults:
            warn(f"{fault}: nothing more was received")
    _warn_ignored(objects)
    return live


def _warn_ignored(objects: JsonObjects) -> None:
    for name in objects.ignored:
        warn(f"ignored: {name} is not declared in the spec")


def _watch_mqtt(arguments: argparse.Namespace, spec: Spec, shown: Output) -> Live:
    from rvmon.adapters.mqtt import MqttSource, address_of

    address = address_of(arguments.source)
    live, hear = _live_and_listeners(arguments, spec, shown, _own_clock())
    objects = JsonObjects(live)
    source = MqttSource(objects, address, verdicts=arguments.publish)
    hear(source.publish)
    with live, source, shown:
        _follow(arguments, live, shown)
    _warn_ignored(objects)
    return live


def _watch_topics(arguments: argparse.Namespace, spec: Spec, shown: Output) -> Live:
    from rvmon.adapters.messages import CLOCK, MessageFeed

    domain = _domain_of(arguments.source)
    if arguments.source.startswith("ros1:"):
        from rvmon.adapters.ros1 import uses_sim_time

        arguments.sim_time = arguments.sim_time or uses_sim_time()
    followed = None
    if arguments.sim_time:
        if arguments.realtime is not None:
            raise RvmonError(f"--realtime: the time comes from {CLOCK} already: leave it out")
        followed = SimulatedClock()
    live, hear = _live_and_listeners(arguments, spec, shown, followed or _own_clock())
    feed = MessageFeed(live, spec.schema, clock=followed)
    source: Ros1Source | Ros2Source | DdsSource
    if domain is not None:
        from rvmon.adapters.dds import DdsSource

        definitions = spec.schema.binding.definitions
        source = DdsSource(feed, domain=domain, definitions=definitions, verdicts=arguments.publish)
    elif arguments.source.startswith("ros1:"):
        from rvmon.adapters.ros1 import Ros1Source

        source = Ros1Source(feed, verdicts=arguments.publish)
    else:
        from rvmon.adapters.ros2 import Ros2Source

        source = Ros2Source(feed, verdicts=arguments.publish)
    hear(source.publish)
    with live, source, shown:
        if followed is not None:
            shown.note(
                f"the time comes from {CLOCK}: nothing is evaluated before its first message"
            )
        _follow(arguments, live, shown)
    return live


def _domain_of(source: str) -> int | None:
    """The DDS domain that a source names; `None` if it is no DDS source."""
    if not source.startswith("dds:"):
        return None
    domain = source.partition(":")[2] or os.environ.get("ROS_DOMAIN_ID", "0")
    if not domain.isdecimal() or int(domain) > _LAST_DOMAIN:
        raise RvmonError(f"{source}: expected a DDS domain, 0 to {_LAST_DOMAIN}")
    return int(domain)


_ONE_ROBOT = "a domain or a master is one robot; start one watch for each"
_NO_CLOCK = "there is no topic /clock; lines with stamps (t, t_ns, --time) have their own time"
_STAMPS = "a binding (--binding) names the field of the stamp"
_TOPICS = ("ros1:", "ros2:", "dds:")
_SOURCES: dict[str, tuple[Callable[..., Live], dict[str, str]]] = {
    "mqtt:": (
        _watch_mqtt,
        {"robot": "the first + of the filter is the robot", "sim_time": _NO_CLOCK},
    ),
    **dict.fromkeys(_TOPICS, (_watch_topics, {"robot": _ONE_ROBOT, "time": _STAMPS})),
    "": (
        _watch_lines,
        {"publish": "verdicts go to standard output (--format json)", "sim_time": _NO_CLOCK},
    ),
}
"""By the scheme of a source, the function that watches it, and the options that do not apply to it,
each with the alternative."""


def _live_and_listeners(
    arguments: argparse.Namespace, spec: Spec, shown: Output, clock: Clock
) -> tuple[Live, Callable[[Callable[[Judgement], object]], object]]:
    """The monitors, and the function that registers a further listener for their verdicts."""
    hearing: list[Callable[[Judgement], object]] = [shown.judged]

    def judged(judgement: Judgement) -> None:
        for one in hearing:
            one(judgement)

    return _live(arguments, spec, clock, judged), hearing.append


def _own_clock() -> Clock:
    return WallClock(since_1970=True)


def _live(
    arguments: argparse.Namespace, spec: Spec, clock: Clock, judged: Callable[[Judgement], object]
) -> Live:
    return Live(
        spec,
        clock=clock,
        only=chosen_ids(arguments, spec),
        lag_ns=arguments.realtime,
        room=arguments.room,
        on_judged=judged,
    )


def _loaded(arguments: argparse.Namespace) -> Spec:
    spec = load(arguments.spec, const=constants_of(arguments.const))
    refuse_empty(spec)
    columns = mapped_names(arguments.map)
    return spec.reading(time=arguments.time, columns=columns, binding=arguments.binding)


def _follow(
    arguments: argparse.Namespace,
    live: Live,
    shown: Output,
    feeding: threading.Thread | None = None,
) -> None:
    """Update the output and reload a changed specification, until the input ends or Ctrl-C."""
    try:
        while feeding is None or feeding.is_alive():
            if feeding is None:
                time.sleep(_TURN)
            else:
                feeding.join(_TURN)
            if shown.broken is not None:
                raise shown.broken
            ages = arguments.ages
            if changed := [file for file in ages if _age(file) != ages[file]]:
                arguments.ages = _ages(arguments.spec, *ages)
                try:
                    _replace(arguments, live)
                    shown.note(f"{changed[0]} has changed: the new one applies from here on")
                except (SpecError, RvmonError) as error:
                    shown.note(f"{error}\nThe previous specification stays in use.")
            shown.show(live)
    except KeyboardInterrupt:
        shown.note("ended")


def _replace(arguments: argparse.Namespace, live: Live) -> None:
    """Continue with the specification as the file is now.

    Raises:
        RvmonError: it has errors, or needs topics that are not subscribed to.
    """
    spec = _loaded(arguments)
    if arguments.source.startswith(_TOPICS):
        known = live.spec.schema
        fresh = [
            *(spec.schema.signals.keys() - known.signals),
            *(spec.schema.events.keys() - known.events),
        ]
        if fresh or spec.schema.binding != known.binding:
            raise RvmonError(
                f"{f'`{min(fresh)}` is new, and ' if fresh else ''}topics are chosen when the "
                "watch starts: end it, and start another"
            )
    live.replace_spec(spec)


def _is_recording(path: str) -> bool:
    """Whether a path is a recording in another format than JSON lines."""
    if form_of_folder(path):
        return True
    ending, packed = endings_of(path)
    if not os.path.isfile(path) or (FORMATS.get(ending, "jsonl") == "jsonl" and not packed):
        return False
    with open(path, "rb") as file:
        return not file.read(1024).lstrip().startswith(b"{")  # a `.log` may hold anything


def _ages(spec: str, *others: str) -> dict[str, tuple[int, int] | None]:
    """The results of `_age` for a specification, its imports, and `others`, by path."""
    from rvmon.reproducer import imported_files

    files = [spec, *others]
    with suppress(OSError, UnicodeDecodeError, TooManyErrors):
        files += imported_files(spec)
    return {file: _age(file) for file in files}


def _age(path: str) -> tuple[int, int] | None:
    """Modification time and inode of a file, one of which changes when it is written.

    `None` while the file does not exist.
    """
    try:
        status = os.stat(path)
    except OSError:
        return None
    return status.st_mtime_ns, status.st_ino


def _opened(arguments: argparse.Namespace) -> FileIO:
    """Open the stream of JSON lines.

    Raises:
        RvmonError: it cannot be opened, or is a recording in another format.
    """
    source: str = arguments.source
    try:
        if not _is_recording(source):
            return FileIO(0, closefd=False) if source == "-" else FileIO(source)
    except OSError as error:
        raise RvmonError(f"error: {source}: {error.strerror}") from None
    command = f"rvmon run {shlex.join([arguments.spec, source])}"
    raise RvmonError(f"error: {source} is a recording, not JSON lines: evaluate it by `{command}`")
