"""`rvmon watch --state FILE`: a watch that goes on where it was when its process was killed."""

from __future__ import annotations

import argparse
import itertools
import sys
from collections import Counter
from typing import TYPE_CHECKING

import msgspec

from rvmon.cli.output import say, say_json, warn
from rvmon.errors import RvmonError, TraceError
from rvmon.verdict.verdict import Verdict

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rvmon.live.durable import DurableMonitor
    from rvmon.session import Spec
    from rvmon.verdict.attempt import Attempt

_KEEP = 1000
"""So many records of each verdict are kept per requirement, as by a watch without a state."""


def refuse_others(arguments: argparse.Namespace) -> None:
    """Refuse options that a watch with a state does without.

    Raises:
        RvmonError: there is one.
    """
    if "://" in arguments.source or arguments.source.startswith(("ros1:", "dds:")):
        raise RvmonError("--state: a run that is kept is of lines: a pipe or a file")
    for name in ("realtime", "robot", "publish"):
        if getattr(arguments, name) is not None:
            raise RvmonError(
                f"--state and --{name}: a run that is kept is of one robot whose lines have stamps "
                f"and are evaluated at them: leave --{name} out"
            )
    if arguments.format == "view":
        raise RvmonError("--state and --format view: verdicts are numbered lines: text or json")


def watch_kept(
    arguments: argparse.Namespace,
    spec: Spec,
    only: Iterable[str] | None,
    lines: Iterable[bytes],
    *,
    is_file: bool,
) -> int:
    """Judge lines until there are no more, and return the exit code.

    Args:
        arguments: of the command.
        spec: what the robot must do.
        only: ids of the requirements; default all.
        lines: what comes.
        is_file: whether they begin anew with each process: those that were taken are passed over.
    """
    from rvmon.live.durable import DurableMonitor

    def report(number: int, attempt: Attempt) -> None:
        if attempt.verdict is not Verdict.FAIL and arguments.failures:
            return
        if arguments.format == "json":
            from rvmon.live import Judgement

            record = {"number": number, **Judgement("", 1, attempt).to_dict()}
            say_json(msgspec.json.encode(record).decode())
            sys.stdout.flush()
        else:
            say(f"{number}  {attempt}", flush=True)

    try:
        monitor = DurableMonitor(
            spec, arguments.state, report, only=only, keep=_KEEP, settle="next"
        )
        if monitor.taken:
            warn(f"{arguments.state}: the run goes on behind {monitor.taken:,} lines")
        try:
            _feed(monitor, spec, lines, skipped=monitor.taken if is_file else 0)
        finally:
            monitor.save()
    except BrokenPipeError:
        raise
    except OSError as error:
        raise RvmonError(f"--state {arguments.state}: {error.strerror}") from None
    except KeyboardInterrupt:
        warn("ended; the run goes on with --state")
    return int(Verdict.FAIL in monitor.monitor.verdicts.values())


def _feed(monitor: DurableMonitor, spec: Spec, lines: Iterable[bytes], *, skipped: int) -> None:
    from rvmon.adapters.json_objects import decoded_object
    from rvmon.readers.jsonl_rows import read_object

    ignored: Counter[str] = Counter()
    filled = ((number, line) for number, line in enumerate(lines, 1) if line.strip())
    for number, line in itertools.islice(filled, skipped, None):
        try:
            t, values = read_object(decoded_object(line), spec.schema, ignored)
        except TraceError as error:
            warn(f"line {number} is not taken: {error}")
            monitor.miss()
            continue
        try:
            monitor.step_ns(t, values)
        except TraceError as error:
            warn(f"line {number} is not taken: {error}")
    for name in ignored:
        warn(f"ignored: {name} is not declared in the spec")
