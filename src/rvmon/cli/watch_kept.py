"""`rvmon watch --state`: a run kept in a file, which the same command continues."""

from __future__ import annotations

import argparse
import sys
import zlib
from collections import Counter
from collections.abc import Iterable, Iterator

import msgspec

from rvmon.adapters.json_objects import decoded_object
from rvmon.cli.options import refuse_over
from rvmon.cli.output import say, say_json, warn
from rvmon.cli.watch_output import line_of
from rvmon.errors import RvmonError, TraceError
from rvmon.live import Judgement
from rvmon.live.durable import DurableMonitor
from rvmon.recordings.jsonl_rows import read_object
from rvmon.report.wording import health_facts
from rvmon.session import Spec
from rvmon.trace.sample import HealthKind
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Attempt, Decision

_LOSSES = (HealthKind.DROPPED, HealthKind.LATE)
_KEEP = 1000  # the most records per requirement and verdict, as without `--state`


def refuse_others(arguments: argparse.Namespace) -> None:
    """Refuse options that do not go with `--state`."""
    refuse_over([arguments.state], [arguments.spec, arguments.source, arguments.binding])
    if "://" in arguments.source or arguments.source.startswith(("ros1:", "dds:")):
        raise RvmonError("--state: only lines can be kept: from a pipe or a file")
    for name in ("realtime", "robot", "publish", "sim_time"):
        if getattr(arguments, name) not in (None, False):
            option = f"--{name.replace('_', '-')}"
            raise RvmonError(
                f"--state and {option}: a kept run has one robot, whose lines have stamps and are "
                f"evaluated at these: leave {option} out"
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
    """Judge lines until they end, and return the exit code.

    `is_file`: the lines are those of a file, which a new process reads from its start; lines that
    were judged before are skipped.
    """
    is_untold = False

    def report(number: int, attempt: Attempt) -> None:
        nonlocal is_untold
        if attempt.verdict is not Verdict.FAIL and arguments.failures:
            return
        is_untold = True
        if arguments.format == "json":
            record = {"number": number, **Judgement("", 1, attempt).to_dict()}
            say_json(msgspec.json.encode(record).decode())
            sys.stdout.flush()
        else:
            say(f"{number}  {line_of(Judgement('', 1, attempt))}", flush=True)
        is_untold = False

    try:
        monitor = DurableMonitor(
            spec, arguments.state, report, only=only, keep=_KEEP, settle="next"
        )
        kept = monitor.monitor.verdicts.keys()
        if kept != spec.monitor(only=only).verdicts.keys():
            raise RvmonError(
                f"--state {arguments.state}: its run evaluates only {', '.join(kept)}: give the "
                "same --only, or name another --state"
            )
        if monitor.taken:
            count = f" after {monitor.taken:,} lines"
            how = count if is_file else "; lines that arrived after its last one are lost"
            warn(f"{arguments.state}: the run continues{how}")
        try:
            if is_file:
                lines = _after_judged_lines(monitor, lines, arguments)
            elif monitor.taken:
                lines = _after_gap(monitor, lines)
            _feed(monitor, spec, lines)
        finally:
            # If a verdict could not be printed, the next process reports it from the old file.
            if not is_untold:
                monitor.save()
    except BrokenPipeError:
        raise
    except OSError as error:
        what = "the output cannot be written" if is_untold else f"--state {arguments.state}"
        raise RvmonError(f"{what}: {error.strerror}") from None
    except KeyboardInterrupt:
        warn("ended; the same command continues the run")
    if not monitor.taken:
        raise no_line(arguments.source)
    # The losses of all processes of the run so far. A copy of the monitor is finished, so that the
    # run itself can continue.
    at_end = spec.restore(monitor.monitor.snapshot()).finish_ns()
    lost = [health for health in at_end.health if health.kind in _LOSSES and health.requirements]
    for names, fact in health_facts(lost, at_end.origin):
        warn(f"{names}: {fact}")
    before = {name for name, verdict in monitor.monitor.verdicts.items() if verdict is Verdict.FAIL}
    failed = {
        attempt.requirement
        for attempt in at_end.attempts
        if attempt.verdict is Verdict.FAIL and attempt.decision is Decision.PREFIX
    }
    if new := sorted(failed - before):
        # Not reported yet, as another line may have the same stamp.
        warn(f"{', '.join(new)}: fails at the last line; reported once a later stamp arrives")
    return int(bool(lost or before or failed))


def no_line(source: str) -> RvmonError:
    """The error that no line came, which is no success."""
    return RvmonError(f"error: {source}: it has no lines: nothing was evaluated")


def _after_judged_lines(
    monitor: DurableMonitor, lines: Iterable[bytes], arguments: argparse.Namespace
) -> Iterator[bytes]:
    """The lines of a file, with blanks instead of those that were judged before.

    The mark covers all lines but the last, which may still be incomplete.

    Raises:
        RvmonError: the file does not start with the lines that were judged.
    """
    taken, (count, known) = monitor.taken, monitor.mark
    other = RvmonError(
        f"{arguments.source} is not the file whose first {taken:,} lines were evaluated: "
        f"name another --state, or delete {arguments.state} to start again"
    )
    number = check = 0
    for line in lines:
        if line.strip():
            if number == count and check != known:
                raise other
            if number >= taken:
                monitor.mark = number, check
            number, check = number + 1, zlib.crc32(line, check)
        yield line if number > taken else b""
    if number < taken:
        raise other


def _after_gap(monitor: DurableMonitor, lines: Iterable[bytes]) -> Iterator[bytes]:
    """The lines of a pipe; before the first, reports a loss, as no process read meanwhile."""
    has_come = False
    for line in lines:
        if line.strip() and not has_come:
            monitor.miss()
            has_come = True
        yield line


def _feed(monitor: DurableMonitor, spec: Spec, lines: Iterable[bytes]) -> None:
    ignored: Counter[str] = Counter()
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        try:
            t, values = read_object(decoded_object(line), spec.schema, ignored)
        except TraceError as error:
            warn(f"line {number} is rejected: {error}")
            monitor.miss()
            continue
        try:
            monitor.step_ns(t, values)
        except TraceError as error:
            warn(f"line {number} is rejected: {error}")
    for name in ignored:
        warn(f"ignored: {name} is not declared in the spec")
