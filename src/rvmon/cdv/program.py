"""Commands as a person can type them where the campaign was run."""

from __future__ import annotations

import os
import shlex
import shutil
import sys
from collections.abc import Iterable
from pathlib import Path


def typed(program: str, words: Iterable[object]) -> str:
    """A command as one line for a shell.

    Args:
        program: that is installed; one of an environment that is not activated is named by its
            path. Empty: the Python script that was started.
        words: behind it.

    >>> typed("handover", ["replay", "a b.json"]).endswith("handover replay 'a b.json'")
    True
    """
    if not program:
        return shlex.join(["python", os.path.relpath(sys.argv[0]), *map(str, words)])
    beside = Path(sys.executable).with_name(program)
    name = program if shutil.which(program) or not beside.exists() else os.path.relpath(beside)
    return shlex.join([name, *map(str, words)])
