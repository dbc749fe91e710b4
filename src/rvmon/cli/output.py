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

from rvmon.texts import shown, shown_json

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
    print(shown(text), end=end, flush=flush)


def say_json(text: str) -> None:
    """Print JSON text."""
    print(shown_json(text))


def spell() -> None:
    """Let signs that the encoding of the output lacks be spelled with those that it has."""

    def spelled(error: UnicodeError) -> tuple[str, int]:
        assert isinstance(error, UnicodeEncodeError), "what is written is text"
        signs = error.object[error.start : error.end].translate(_SPELLED)
        return signs.encode("ascii", "replace").decode(), error.end

    if isinstance(sys.stdout, io.TextIOWrapper):
        codecs.register_error("rvmon", spelled)
        sys.stdout.reconfigure(errors="rvmon")


def rendered(findings: Sequence[Diagnostic]) -> str:
    """Findings in full, as wide as the terminal is."""
    from shutil import get_terminal_size  # which most starts have no need of

    from rvmon.diagnostics import WIDEST, render_full

    return render_full(findings, get_terminal_size((WIDEST, 0)).columns)


def warn(text: str) -> None:
    """Print to standard error what a person should know."""
    print(shown(text), file=sys.stderr)


T = TypeVar("T")

PATIENCE_S = 1.0  # work shorter than this shows no bar
SAMPLES_PER_LOOK = 4096  # samples between two looks at the clock


@contextmanager
def bar(what: str, total: float) -> Iterator[Callable[[float], None]]:
    """Gives what is told the units done so far; a terminal sees work of over a second."""
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
            progress.add_task(escape(shown(what)), total=total)
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
    """Gives what takes other words for what is done; `None` where nobody sees them."""
    if not sys.stderr.isatty():
        yield None
        return
    with _console().status(shown(what)) as status:
        yield lambda text: status.update(shown(text))


def shown_while_reading(recording: FileRecording, parts: Iterator[T]) -> Iterator[T]:
    """The parts of a recording as they are read, with a progress bar."""
    from rvmon.trace.sample import Sample  # which help has no need of

    with bar(recording.path, 1.0) as show:
        for one in parts:
            yield one
            if isinstance(one, Sample):
                yield from islice(parts, SAMPLES_PER_LOOK)
            show(recording.fraction_read)
