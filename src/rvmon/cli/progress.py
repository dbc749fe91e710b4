"""A bar on standard error while a long recording is read."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rvmon.readers.recording import FileRecording
    from rvmon.trace.sample import Sample

PATIENCE_S = 1.0
"""Work shorter than this shows no bar."""

SAMPLES_PER_LOOK = 4096
"""Samples between two looks at the clock."""


def shown_while_reading(recording: FileRecording) -> Iterator[Sample]:
    """The recording's samples; after a second of reading, a bar shows how far it is.

    Only a terminal sees the bar.
    """
    samples = iter(recording)
    if not sys.stderr.isatty():
        yield from samples
        return
    started = time.monotonic()
    for count, sample in enumerate(samples, 1):
        yield sample
        if count % SAMPLES_PER_LOOK == 0 and time.monotonic() - started > PATIENCE_S:
            break
    else:
        return
    from rich.progress import Progress

    from rvmon.report.terminal import Terminal

    with Progress(console=Terminal(stderr=True), transient=True) as progress:
        task = progress.add_task(recording.path, total=1.0)
        for count, sample in enumerate(samples):
            yield sample
            if count % SAMPLES_PER_LOOK == 0:
                progress.update(task, completed=recording.fraction_read)
