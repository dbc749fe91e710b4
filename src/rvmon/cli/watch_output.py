"""The output of `rvmon watch`: a live table, lines for people, or JSON lines."""

from __future__ import annotations

import logging
import sys
from collections import Counter, deque
from collections.abc import Sequence
from io import StringIO

import msgspec
from rich.console import Console
from rich.live import Live as Screen
from rich.text import Text

from rvmon.cli.output import say, say_json, warn
from rvmon.diagnostics import wants_colour
from rvmon.live import Driver, Judgement, Status
from rvmon.report.printer import Cell, Printer
from rvmon.report.wording import MARKS, verdict_text
from rvmon.session import Spec
from rvmon.texts import counted, escaped
from rvmon.trace.time import NEVER, TICKS_PER_SECOND, format_stamped
from rvmon.verdicts import Verdict, fold

_TOLD = 5  # messages of a kind that are all printed; later ones only at 10, 100, …
_SHOWN_FAILURES = 5
_SHOWN_ROBOTS = 8
_MOST_OPEN = 100  # the most open attempts per robot that are queried
_FRAME = 5  # lines of a robot's table in addition to its rows
_FEW = 4  # rows of a robot that must fit before a further robot is shown


class Output(logging.Handler):
    """One line per verdict for people; problems of the input go to standard error.

    Args:
        failures_only: whether passed attempts are left out.
    """

    def __init__(self, *, failures_only: bool) -> None:
        super().__init__()
        self._failures_only = failures_only
        self._log = logging.getLogger("rvmon.live.input")
        self._counts = Counter[str]()
        # the error that prevents further output, such as a closed pipe
        self.broken: OSError | None = None
        # kept here because verdicts are discarded when the specification changes
        self.has_failed = False

    def __enter__(self) -> Output:
        self._log.addHandler(self)
        # Otherwise handlers of the root logger would print each line again. The logger of verdicts,
        # `rvmon.live`, needs some handler, or Python would print its warnings.
        self._log.propagate = False
        logging.getLogger("rvmon.live").addHandler(logging.NullHandler())
        return self

    def __exit__(self, *_: object) -> None:
        self._log.removeHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        """Print a problem of the input: the first few of a kind, then the 10th, 100th and so on."""
        self._counts[record.msg] += 1
        count = self._counts[record.msg]
        if count <= _TOLD:
            self.note(record.getMessage())
        elif count == 10 ** (len(str(count)) - 1):
            self.note(f"{record.getMessage()}  (the {count:,}th of this kind; most are left out)")

    def judged(self, judgement: Judgement) -> None:
        """Handle a verdict: print it unless it is filtered out."""
        self.has_failed |= judgement.attempt.verdict is Verdict.FAIL
        if judgement.attempt.verdict is not Verdict.FAIL and self._failures_only:
            return
        try:
            self.say(judgement)
        except OSError as error:  # this is the monitors' thread; the main thread raises it
            self.broken = error

    def say(self, judgement: Judgement) -> None:
        """Print a verdict."""
        say(line_of(judgement), flush=True)

    def note(self, text: str) -> None:
        """Print a message that is no verdict."""
        warn(text)

    def show(self, driver: Driver) -> None:
        """Update a display of the status; called a few times per second."""

    def ended(self, driver: Driver) -> None:
        """Print the final status."""
        print_status(driver, Printer())


class JsonOutput(Output):
    """A JSON line for each verdict, and at the end one for each robot."""

    def say(self, judgement: Judgement) -> None:
        """Print a verdict."""
        say_json(judgement.to_json())
        sys.stdout.flush()

    def ended(self, driver: Driver) -> None:
        """Print the final status."""
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
    """A table updated in place: verdicts, next deadlines, and the latest failures."""

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
        """Handle a verdict: remember failures."""
        if judgement.attempt.verdict is Verdict.FAIL:
            self.has_failed = True
            self._failures.append(line_of(judgement))

    def note(self, text: str) -> None:
        """Print a message above the table."""
        self._console.print(escaped(text))

    def show(self, driver: Driver) -> None:
        """Update the table, which is at most as high as the terminal."""
        lines = sum(-(-len(failure) // self._console.width) for failure in self._failures)
        height = max(1, self._console.height - lines - 1)
        self._screen.update(Text.from_ansi(self._drawn(driver, height)), refresh=True)

    def ended(self, driver: Driver) -> None:
        """Print the final table."""
        sys.stdout.write(self._drawn(driver))

    def _drawn(self, driver: Driver, height: int | None = None) -> str:
        text = StringIO()
        printer = Printer(text, self._console.width, has_colour=wants_colour(sys.stdout))
        print_status(driver, printer, height)
        for line in self._failures:
            printer.line((line, MARKS[Verdict.FAIL].terminal))
        return text.getvalue()


def output_named(name: str | None, *, failures_only: bool) -> Output:
    """The output for a value of `--format`; default: a live table on a terminal, else lines."""
    kinds = {"view": View, "text": Output, "json": JsonOutput}
    chosen = name or ("view" if sys.stdout.isatty() else "text")
    return kinds[chosen](failures_only=failures_only)


def line_of(judgement: Judgement) -> str:
    """A verdict as one line of text."""
    attempt = judgement.attempt
    robot = f"{judgement.robot}  " if judgement.robot else ""
    decided = attempt.triggered if attempt.decided is None else attempt.decided
    sign = MARKS[attempt.verdict].sign
    reason = f"  {attempt.reason}" if attempt.reason else ""
    when = format_stamped(decided, attempt.origin)
    return f"{robot}{when}  {attempt.name} {attempt.verdict} {sign}{reason}"


def print_status(driver: Driver, printer: Printer, height: int | None = None) -> None:
    """Print robots and their requirements, the most urgent first.

    `height`: the most lines; requirements that do not fit are only counted. `None`: no limit.
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
        printer.line("no input yet")


def _need(verdict: Verdict) -> int:
    """The sort key of a verdict: failed first, then inconclusive, then the rest."""
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
