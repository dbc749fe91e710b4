"""Commands as a person can type them where the campaign was run."""

from __future__ import annotations

import os
import shlex
import shutil
import sys
from collections.abc import Iterable
from pathlib import Path

NAME = "handover"


def typed(words: Iterable[object]) -> str:
    """The words behind `handover`, as one line for a shell.

    An environment that is not activated is named by its path.

    >>> typed(["replay", "a b.json"]).endswith("handover replay 'a b.json'")
    True
    """
    beside = Path(sys.executable).with_name(NAME)
    program = NAME if shutil.which(NAME) or not beside.exists() else os.path.relpath(beside)
    return shlex.join([program, *map(str, words)])
