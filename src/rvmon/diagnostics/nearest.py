"""The name that was probably meant where one is unknown."""

from __future__ import annotations

import difflib
import os
import re
from collections.abc import Iterable
from contextlib import suppress
from itertools import islice
from pathlib import Path

MOST_NAMES = 1_000
"""Names that a misspelt one is compared with."""


def nearest(name: str, known: Iterable[str], likeness: float = 0.6) -> str:
    """The known name that is most alike; empty if none is.

    Args:
        name: as written.
        known: those that exist; the first thousand are looked at.
        likeness: from 0 to 1, how much alike it has to be (`difflib.SequenceMatcher.ratio`).

    >>> nearest("gaze_okay", ["gaze_ok", "pressure_ok"])
    'gaze_ok'
    """
    found = difflib.get_close_matches(name, list(islice(known, MOST_NAMES)), 1, likeness)
    return found[0] if found else ""


def did_you_mean(name: str, known: Iterable[str], otherwise: str = "") -> str:
    """A question after the known name that is most alike, else `otherwise`.

    >>> did_you_mean("relased", ["released"])
    'did you mean `released`?'
    """
    close = nearest(name, known)
    return f"did you mean `{close}`?" if close else otherwise


def cannot_read(path: str | Path, error: OSError) -> str:
    """Why a file cannot be read, and if there is none, the one in its folder most alike.

    >>> cannot_read("nowhere/base.csv", FileNotFoundError(2, "No such file or directory"))
    'nowhere/base.csv: No such file or directory'
    """
    why = f"{path}: {error.strerror or error}"
    if isinstance(error, FileNotFoundError):
        with suppress(OSError), os.scandir(Path(path).parent) as entries:
            others = (entry.name for entry in entries if entry.name != Path(path).name)
            if close := nearest(Path(path).name, others):
                return f"{why}: did you mean `{Path(path).with_name(close)}`?"
    return why


_PROPOSED = re.compile(r"did you mean `([^`]+)`\?|write `([^`\d{]+)`\Z")


def proposed(help_: str) -> str:
    """What a help proposes to write in place of what is wrong; empty if that is not all of it.

    >>> proposed("did you mean `released`?  (event, line 9)"), proposed("put brackets around it")
    ('released', '')
    """
    found = _PROPOSED.match(help_)
    return found[1] or found[2] if found else ""
