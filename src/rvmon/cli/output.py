"""Output of commands: text that is safe in any encoding and on any terminal, and progress."""

from __future__ import annotations

import codecs
import io
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from itertools import islice
from typing import TYPE_CHECKING, TypeVar

from rvmon.texts import escaped, escaped_json

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress

    from rvmon.diagnostics import Diagnostic
    from rvmon.recordings.recording import FileRecording

_SPELLED = str.maketrans(
    dict(zip("✓✗–−─·→▶▼●○◆◇■█▇▁░│├└╱╲×", "+x---.>>v*o*o###_.||`/\\x", strict=True))
    | {"…": "...", "≤": "<=", "≥": ">=", "≠": "!=", "∞": "inf"}
)


def say(text: str = "", *, end: str = "\n", flush: bool = False) -> None:
    """Print a text for people."""
    print(escaped(text), end=end, flush=flush)


def say_json(text: str) -> None:
    """Print JSON text."""
    print(escaped_json(text))


def spell() -> None:
    """Replace signs that the encoding of standard output lacks, instead of raising an error."""

    def spelled(error: UnicodeError) -> tuple[str, int]:
        assert isinstance(error, UnicodeEncodeError), "what is written is text"
        signs = error.object[error.start : error.end].translate(_SPELLED)
        return signs.encode("ascii", "replace").decode(), error.end

    if isinstance(sys.stdout, io.TextIOWrapper):
        codecs.register_error("rvmon", spelled)
        sys.stdout.reconfigure(errors="rvmon")


def rendered(findings: Sequence[Diagnostic]) -> str:
    """Diagnostics in full, as wide as the terminal."""
    from shutil import get_terminal_size  # imported late: most commands do not need it

    from rvmon.diagnostics import WIDEST, render_full

    return render_full(findings, get_terminal_size((WIDEST, 0)).columns)


def warn(text: str) -> None:
    """Print a message to standard error."""
    print(escaped(text), file=sys.stderr)


T = TypeVar("T")

PATIENCE_S = 1.0  # work shorter than this shows no bar
SAMPLES_PER_LOOK = 4096  # samples between two updates of the bar


@contextmanager
def bar(what: str, total: float) -> Iterator[Callable[[float], None]]:
    """A progress bar on a terminal, for work of over a second.

    Args:
        what: the words before the bar.
        total: the units of work.

    Yields:
        The function to call with the units done so far.
    """
    if not sys.stderr.isatty():
        yield lambda _: None
        return
    started = time.monotonic()
    progress: Progress | None = None

    def show(done: float) -> None:
        nonlocal progress
        if progress is None and time.monotonic() - started >= PATIENCE_S:
            from rich.markup import escape
            from rich.progress import Progress

            progress = Progress(console=_console(), transient=True)
            progress.add_task(escape(escaped(what)), total=total)
            progress.start()
        if progress is not None:
            progress.update(progress.task_ids[0], completed=done)

    try:
        yield show
    finally:
        if progress is not None:
            progress.stop()


def _console() -> Console:
    from rich.console import Console

    return Console(stderr=True, highlight=False, markup=False, emoji=False)


@contextmanager
def busy(what: str) -> Iterator[Callable[[str], None] | None]:
    """A spinner with a text on a terminal.

    Yields:
        The function that changes the text; `None` if standard error is no terminal.
    """
    if not sys.stderr.isatty():
        yield None
        return
    with _console().status(escaped(what)) as status:
        yield lambda text: status.update(escaped(text))


def shown_while_reading(recording: FileRecording, parts: Iterator[T]) -> Iterator[T]:
    """Pass on the parts of a recording as they are read, with a progress bar."""
    from rvmon.trace.sample import Sample  # imported late: help does not need it

    with bar(recording.path, 1.0) as show:
        for one in parts:
            yield one
            if isinstance(one, Sample):  # else it is a batch, which has thousands of rows
                yield from islice(parts, SAMPLES_PER_LOOK)
            show(recording.fraction_read)
