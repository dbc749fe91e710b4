"""A program that is run to its end, and ends with the process that began it.

Whoever dies closes its end of a pipe, on every system and however it dies; on the other end someone
waits.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import subprocess

_WATCHED = """
exec 3<&0
"$@" </dev/null 3<&- &
job=$!
{ read _; kill -9 0; } <&3 >/dev/null 2>&1 &
exec 3<&-
wait $job
code=$?
kill -9 $!
exit $code
"""
"""Run a command; when standard input ends before, kill it and all that it began."""


def run(words: Sequence[str], **options: Any) -> subprocess.CompletedProcess[str]:
    r"""Run a command to its end; one that is not over when this process ends, ends with it.

    Args:
        words: the command. It has no standard input.
        options: for `subprocess.run`.

    Returns:
        Its exit code, 128 and the signal's number if one ended it, and what it printed.

    Raises:
        OSError: it cannot be run.
        subprocess.TimeoutExpired: it took longer than the option `timeout` allows.

    >>> run(["echo", "hello"]).stdout
    'hello\n'
    """
    import subprocess

    options = {"capture_output": True, "encoding": "utf-8", "errors": "replace", **options}
    if os.name != "posix":
        return subprocess.run(words, stdin=subprocess.DEVNULL, check=False, **options)  # noqa: S603 - words, no shell
    # The system closes the pipe however this process ends, also by SIGKILL; then `read` returns,
    # and the shell kills its process group, which the new session makes its own.
    watched, held = os.pipe()
    shell = ["/bin/sh", "-c", _WATCHED, "sh", *words]
    try:
        return subprocess.run(  # noqa: S603 - the caller's words
            shell, stdin=watched, start_new_session=True, check=False, **options
        )
    finally:
        os.close(held)
        os.close(watched)
