"""Checks that a recording has the names that requirements read, and suggests mappings if not."""

from __future__ import annotations

import re
import shlex
from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import islice
from typing import TYPE_CHECKING

from rvmon.errors import MissingNameError
from rvmon.language.checked.names_read import names_of_coverage, names_of_requirement, source_names
from rvmon.language.checked.specification import CheckedSpec
from rvmon.recordings.recording import FileRecording
from rvmon.texts import MOST_NAMES, nearest, shorten

if TYPE_CHECKING:
    from rvmon.recordings.joined import Joined
    from rvmon.recordings.table_recording import TableRecording

_SHOWN = 8  # the most unread columns listed if none resembles a missing name


def names_read(
    spec: CheckedSpec, only: Collection[str] | None, *, coverage: bool = False
) -> dict[str, tuple[str, ...]]:
    """The signals and events that are read, each with the ids of the requirements that read it.

    `coverage`: whether to include the coverpoints and crosses that read it.
    """
    readers: dict[str, list[str]] = {}
    for name, requirement in spec.requirements.items():
        if only is None or name in only:
            for read in sorted({*names_of_requirement(requirement)}):
                readers.setdefault(read, []).append(name)
    for name, reads in names_of_coverage(spec) if coverage else ():
        for read in sorted({*reads}):
            readers.setdefault(read, []).append(name)
    return {read: tuple(names) for read, names in readers.items()}


def expect_names(
    spec: CheckedSpec,
    recording: FileRecording | TableRecording | Joined,
    mapped: Mapping[str, str],
    *,
    only: Sequence[str] | None,
    allowed: bool | Iterable[str],
    coverage: bool = False,
) -> tuple[str, ...]:
    """Refuse a recording that lacks a name that is read.

    `mapped` is, by declared name, the column or topic that the user mapped to it; `allowed` are the
    names that the recording may lack, True for all; `coverage` is as for `names_read`.

    Returns:
        The names that the recording lacks, all of which are allowed.

    Raises:
        MissingNameError: it lacks a name that is not allowed; the message suggests columns.
        UnknownNameError: a name in `allowed` is not declared.
    """
    some = None if isinstance(allowed, bool) else source_names(spec, allowed)
    names = recording.names
    if names is None or names >= {*spec.signals, *spec.events}:
        return ()
    lacking = {
        name: ids
        for name, ids in names_read(spec, only, coverage=coverage).items()
        if name not in names
    }
    refused = [] if allowed is True else [name for name in lacking if name not in (some or ())]
    if refused:
        place, what, free = "", "column", list(recording.ignored)
        if isinstance(recording, FileRecording):
            place, free = f"{recording.path}: ", list(recording.unread)
            what = "topic" if recording.is_of_messages else what
        close = {name: most_like(mapped.get(name, name), free) for name in refused}
        paths = [column for column in free if "/" in column or "." in column]
        if len(refused) == len(paths) == 1 and not close[refused[0]]:
            close[refused[0]] = paths[0]  # one missing name and one unread topic: probably the same
        raise MissingNameError(place + "\n".join(_listed(lacking, close, free, mapped, what)))
    return tuple(lacking)


def _listed(
    lacking: Mapping[str, tuple[str, ...]],
    close: Mapping[str, str],
    others: Sequence[str],
    mapped: Mapping[str, str],
    what: str,
) -> Iterable[str]:
    yield f"there is no {what} for these names, which requirements read:"
    for name, column in close.items():
        meant = f": did you mean `{shorten(column)}`?" if column else ""
        wanted = f" (as `{shorten(mapped[name])}`)" if name in mapped else ""
        yield f"  `{name}`{wanted}, read by {', '.join(lacking[name])}{meant}"
    if not all(close.values()):
        shown = ", ".join(f"`{shorten(column)}`" for column in others[:_SHOWN]) or "none"
        more = f" and {len(others) - _SHOWN} more" if len(others) > _SHOWN else ""
        yield f"  {what}s that are not used: {shown}{more}"
    maps = [shlex.quote(f"{name}={column or what.upper()}") for name, column in close.items()]
    which, them = (f"which {what} it is", "it") if len(maps) == 1 else ("which they are", "them")
    bind = ", or `rvmon init DATA --for SPEC` in a file" if what == "topic" else ""
    yield f"  name {which}: {' '.join(f'--map {pair}' for pair in maps)}, in Python columns=…{bind}"
    yield (
        f"  or leave requirements that read {them} inconclusive: "
        f"--allow-missing={','.join(close)}, in Python allow_missing=…"
    )


def most_like(name: str, columns: Sequence[str]) -> str:
    """The column that a name probably refers to; "" if none resembles it.

    Case, separators, text in brackets, leading path segments and trailing units are ignored.

    >>> most_like("speed", ["t2", "/base/Speed [m/s]"]), most_like("speed", ["speed_m_s"])
    ('/base/Speed [m/s]', 'speed_m_s')
    >>> most_like("obstacle", ["obstacel"]), most_like("speed", ["door"])
    ('obstacel', '')
    """
    wanted = _forms(name)
    ranks = []
    by_form: dict[str, str] = {}
    for column in islice(columns, MOST_NAMES):
        for place, form in enumerate(_forms(column)):
            by_form.setdefault(form, column)
            if form in wanted:
                ranks.append((wanted.index(form) + place, column))
    if ranks:
        return min(ranks)[1]
    return by_form.get(nearest(wanted[0], by_form), "")


def _forms(name: str) -> list[str]:
    """Normalised forms of a name, the most specific first."""
    plain = re.sub(r"(?<=.)\s*[\[({<].*", "", name).strip().casefold()
    segments = [part for part in re.split(r"[/.:\\]", plain) if part] or [plain]
    forms = ["".join(segments[start:]) for start in range(len(segments))]
    words = re.split(r"[_\-\s]+", segments[-1])
    forms += ["".join(words[:count]) for count in range(len(words) - 1, 0, -1)]
    bare = (re.sub(r"[_\-\s]", "", form) for form in forms)
    return list(dict.fromkeys(form for form in bare if form)) or [plain]
