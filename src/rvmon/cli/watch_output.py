"""The output of `rvmon watch`: a view, lines for people, or JSON lines."""

from __future__ import annotations

import argparse
import logging
import sys
import zlib
from collections import Counter, deque
from collections.abc import Iterable, Iterator, Sequence
from io import StringIO

import msgspec
from rich.console import Console
from rich.live import Live as Screen
from rich.text import Text

from rvmon.adapters.json_objects import decoded_object
from rvmon.cli.options import refuse_over
from rvmon.cli.output import say, say_json, warn
from rvmon.diagnostics import wants_colour
from rvmon.errors import RvmonError, TraceError
from rvmon.live import Driver, Judgement, Status
from rvmon.live.durable import DurableMonitor
from rvmon.recordings.jsonl_rows import read_object
from rvmon.report.printer import Cell, Printer
from rvmon.report.wording import MARKS, health_facts, verdict_text
from rvmon.session import Spec
from rvmon.texts import counted, shown
from rvmon.trace.sample import HealthKind
from rvmon.trace.time import NEVER, TICKS_PER_SECOND, format_stamped
from rvmon.verdicts import Verdict, fold
from rvmon.verdicts.attempt import Attempt, Decision

_LOSSES = (HealthKind.DROPPED, HealthKind.LATE)
_TOLD = 5
_SHOWN_FAILURES = 5
_SHOWN_ROBOTS = 8
_MOST_OPEN = 100
_FRAME = 5  # lines of a robot's table in addition to its rows
_FEW = 4  # rows that a robot has at least, before another robot is shown


class Output(logging.Handler):
    """Lines for people, one for each verdict; what is wrong with the input goes to standard error.

    Args:
        failures_only: whether what passed is left out.
    """

    def __init__(self, *, failures_only: bool) -> None:
        super().__init__()
        self._failures_only = failures_only
        self._log = logging.getLogger("rvmon.live.input")
        self._counts = Counter[str]()
        # the reason why verdicts cannot be written any more, such as a reader that has left
        self.broken: OSError | None = None
        self.has_failed = False  # by any specification: their verdicts go when a new one comes

    def __enter__(self) -> Output:
        self._log.addHandler(self)
        # Without this, the root's handlers would print each line again; and the parent, the logger
        # of verdicts, has no handler, so Python would print warnings itself.
        self._log.propagate = False
        logging.getLogger("rvmon.live").addHandler(logging.NullHandler())
        return self

    def __exit__(self, *_: object) -> None:
        self._log.removeHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        """Say what is wrong with the input: of many of a kind the first, and each tenfold."""
        self._counts[record.msg] += 1
        count = self._counts[record.msg]
        if count <= _TOLD:
            self.note(record.getMessage())
        elif count == 10 ** (len(str(count)) - 1):
            self.note(f"{record.getMessage()}  (the {count:,}th of this kind; most are left out)")

    def judged(self, judgement: Judgement) -> None:
        """Say a verdict, if it is asked for."""
        self.has_failed |= judgement.attempt.verdict is Verdict.FAIL
        if judgement.attempt.verdict is not Verdict.FAIL and self._failures_only:
            return
        try:
            self.say(judgement)
        except OSError as error:  # in the thread of the monitors: others have to end
            self.broken = error

    def say(self, judgement: Judgement) -> None:
        """Say a verdict."""
        say(_line(judgement), flush=True)

    def note(self, text: str) -> None:
        """Say something that is no verdict."""
        warn(text)

    def show(self, driver: Driver) -> None:
        """Show how it stands; called a few times in a second."""

    def ended(self, driver: Driver) -> None:
        """Say what came of it."""
        print_status(driver, Printer())


class JsonOutput(Output):
    """A JSON line for each verdict, and at the end one for each robot."""

    def say(self, judgement: Judgement) -> None:
        """Say a verdict."""
        say_json(judgement.to_json())
        sys.stdout.flush()

    def ended(self, driver: Driver) -> None:
        """Say what came of it."""
        for name, status in driver.status().items():
            figures = {
                "robot": name,
                "runs": status.run,
                "verdicts": status.verdicts,
                "samples": status.samples,
                "lost": status.lost,
            }
            say_json(msgspec.json.encode(figures).decode())


class View(Output):
    """A table that stays in its place: verdicts, what is required until when, what failed last."""

    def __init__(self, *, failures_only: bool) -> None:
        super().__init__(failures_only=failures_only)
        self._failures: deque[str] = deque(maxlen=_SHOWN_FAILURES)
        self._console = Console(highlight=False, markup=False, emoji=False)
        self._screen = Screen(console=self._console, auto_refresh=False, transient=True)

    def __enter__(self) -> View:
        super().__enter__()
        self._screen.start()
        return self

    def __exit__(self, *ended: object) -> None:
        self._screen.stop()
        super().__exit__(*ended)

    def judged(self, judgement: Judgement) -> None:
        """Remember what failed."""
        if judgement.attempt.verdict is Verdict.FAIL:
            self.has_failed = True
            self._failures.append(_line(judgement))

    def note(self, text: str) -> None:
        """Say something above the table."""
        self._console.print(shown(text))

    def show(self, driver: Driver) -> None:
        """Show how it stands, no longer than the terminal is high."""
        lines = sum(-(-len(failure) // self._console.width) for failure in self._failures)
        height = max(1, self._console.height - lines - 1)
        self._screen.update(Text.from_ansi(self._drawn(driver, height)), refresh=True)

    def ended(self, driver: Driver) -> None:
        """Show how it stands at the end."""
        sys.stdout.write(self._drawn(driver))

    def _drawn(self, driver: Driver, height: int | None = None) -> str:
        text = StringIO()
        printer = Printer(text, self._console.width, has_colour=wants_colour(sys.stdout))
        print_status(driver, printer, height)
        for line in self._failures:
            printer.line((line, MARKS[Verdict.FAIL].terminal))
        return text.getvalue()


def output_named(name: str | None, *, failures_only: bool) -> Output:
    """The output of a name; by default a view on a terminal, and lines elsewhere."""
    kinds = {"view": View, "text": Output, "json": JsonOutput}
    chosen = name or ("view" if sys.stdout.isatty() else "text")
    return kinds[chosen](failures_only=failures_only)


def _line(judgement: Judgement) -> str:
    attempt = judgement.attempt
    robot = f"{judgement.robot}  " if judgement.robot else ""
    decided = attempt.triggered if attempt.decided is None else attempt.decided
    sign = MARKS[attempt.verdict].sign
    reason = f"  {attempt.reason}" if attempt.reason else ""
    when = format_stamped(decided, attempt.origin)
    return f"{robot}{when}  {attempt.name} {attempt.verdict} {sign}{reason}"


def print_status(driver: Driver, printer: Printer, height: int | None = None) -> None:
    """Print robots and their requirements, those first that need a look.

    `height`: the number of lines; requirements that do not fit are counted. `None`: all.
    """
    statuses = driver.status(most_open=_MOST_OPEN)
    robots = sorted(statuses.values(), key=lambda status: _need(fold(status.verdicts.values())))
    requirements = len(driver.spec.requirements)
    most, rows = _SHOWN_ROBOTS, requirements
    if height is not None:
        most = max(1, min(_SHOWN_ROBOTS, height // (_FRAME + min(requirements, _FEW))))
        rows = max(1, height // max(1, min(most, len(robots))) - _FRAME)
    for robot in robots[:most]:
        _print_robot(robot, driver.spec, rows, printer, is_cut=height is not None)
    _print_rest([fold(robot.verdicts.values()) for robot in robots[most:]], "robots", printer)
    if not robots:
        printer.line("nothing has come yet")


def _need(verdict: Verdict) -> int:
    """Failures before what is inconclusive before the rest."""
    return {Verdict.FAIL: 0, Verdict.INCONCLUSIVE: 1}.get(verdict, 2)


def _print_rest(verdicts: Sequence[Verdict], of: str, printer: Printer) -> None:
    counts = Counter(verdicts)
    listed = ", ".join(
        f"{counts[verdict]} {verdict.value}" for verdict in Verdict if counts[verdict]
    )
    if verdicts:
        printer.line(f"… and {len(verdicts)} more {of}: {listed}")


def _print_robot(status: Status, spec: Spec, rows: int, printer: Printer, *, is_cut: bool) -> None:
    heading = f"{status.robot}  " if status.robot else ""
    run = f"run {status.run}, " if status.run > 1 else ""
    lost = f", {status.lost:,} lost" if status.lost else ""
    until: dict[str, int] = {}
    for attempt in status.open:
        if attempt.deadline is not None:
            until[attempt.requirement] = min(
                until.get(attempt.requirement, attempt.deadline), attempt.deadline
            )
    names = [*status.verdicts]
    if len(names) > rows:
        rows = max(1, rows - 1)  # one line counts the rest
        names.sort(key=lambda name: (_need(status.verdicts[name]), until.get(name, NEVER)))
    cells: list[list[Cell]] = []
    for name in names[:rows]:
        left = ""
        if name in until:
            left = f"{max(0, until[name] - status.now) / TICKS_PER_SECOND:.1f} s"
        counts = [str(status.counts[name, one] or "") for one in (Verdict.PASS, Verdict.FAIL)]
        waiting = f"{status.open_counts[name]:,}" if status.open_counts.get(name) else ""
        text = (spec.requirements[name].text, "dim")
        cells.append([name, verdict_text(status.verdicts[name]), *counts, waiting, left, text])
    when = format_stamped(status.now, status.since or 0)
    printer.line(f"{heading}{run}to {when}, {counted(status.samples, 'sample')}{lost}")
    heads = ("", "verdict", "passed", "failed", "open", "until", "requirement")
    printer.table(heads, cells, is_cut=is_cut)
    _print_rest([status.verdicts[name] for name in names[rows:]], "requirements", printer)


_KEEP = 1000  # the records of each verdict kept per requirement, as in a watch without a state


def refuse_others(arguments: argparse.Namespace) -> None:
    """Refuse options that a watch with a state does without."""
    refuse_over([arguments.state], [arguments.spec, arguments.source, arguments.binding])
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

    `is_file`: lines begin anew with each process: those that were taken are passed over.
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
            say(f"{number}  {_line(Judgement('', 1, attempt))}", flush=True)
        is_untold = False

    try:
        monitor = DurableMonitor(
            spec, arguments.state, report, only=only, keep=_KEEP, settle="next"
        )
        if monitor.taken:
            count = f" after {monitor.taken:,} lines"
            how = count if is_file else "; what came since its last line is lost"
            warn(f"{arguments.state}: the run continues{how}")
        try:
            if is_file:
                lines = _behind_taken(monitor, lines, arguments)
            elif monitor.taken:
                lines = _behind_gap(monitor, lines)
            _feed(monitor, spec, lines)
        finally:
            if not is_untold:  # else the same command is to say it, from what the file has
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
    # Also what earlier processes of the run lost; what it goes on to is not known yet.
    # A copy is finished, so that the run can be continued.
    at_end = spec.restore(monitor.monitor.snapshot()).finish_ns()
    lost = [health for health in at_end.health if health.kind in _LOSSES and health.requirements]
    for names, fact in health_facts(lost, at_end.origin):
        warn(f"{names}: {fact}")
    told = {name for name, verdict in monitor.monitor.verdicts.items() if verdict is Verdict.FAIL}
    failed = {
        attempt.requirement
        for attempt in at_end.attempts
        if attempt.verdict is Verdict.FAIL and attempt.decision is Decision.PREFIX
    }
    if untold := sorted(failed - told):
        # Another line may have the same stamp.
        warn(f"{', '.join(untold)}: fails by the last line, reported when a later stamp comes")
    return int(bool(lost or told or failed))


def no_line(source: str) -> RvmonError:
    """Nothing came: that is no success."""
    return RvmonError(f"error: {source}: there is no line: nothing was evaluated")


def _behind_taken(
    monitor: DurableMonitor, lines: Iterable[bytes], arguments: argparse.Namespace
) -> Iterator[bytes]:
    """The lines of a file, blank in place of those that were taken.

    Those before the last one are marked, which may be one that is being written.
    """
    taken, (count, known) = monitor.taken, monitor.mark
    other = RvmonError(
        f"{arguments.source} is not the file of which {taken:,} lines were evaluated: "
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


def _behind_gap(monitor: DurableMonitor, lines: Iterable[bytes]) -> Iterator[bytes]:
    """The lines of a pipe; before the first one, what came to no process is reported as lost."""
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
            warn(f"line {number} is not taken: {error}")
            monitor.miss()
            continue
        try:
            monitor.step_ns(t, values)
        except TraceError as error:
            warn(f"line {number} is not taken: {error}")
    for name in ignored:
        warn(f"ignored: {name} is not declared in the spec")
