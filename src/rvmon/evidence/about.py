"""What evidence says of how it was made: versions, programs, requirements, inputs, options."""

from __future__ import annotations

import hashlib
import platform
import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from functools import cache
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path

import msgspec

import rvmon
from rvmon.cache import file_stamps
from rvmon.readers.messages.forms import is_bag_folder
from rvmon.verdict.verdict import LAW

FORMAT = 1
"""Version of the description; what a later one says is not guessed."""


class Stamp(msgspec.Struct, frozen=True):
    """What tells a file, or a folder of files, from any other.

    Attributes:
        bytes: of all files.
        sha256: of the file; of a folder, that of the lines `sha256sum` has for its files.
    """

    bytes: int
    sha256: str


class Judging(msgspec.Struct, frozen=True):
    """How recordings were judged, as the options of `rvmon run` say it."""

    only: str | None
    const: list[str]
    until: float | None
    time: str | None
    map: list[str]
    nan: str | None
    clock: str | None
    binding: str | None
    allow_missing: str | None
    engine: str
    strict_columns: bool
    robustness: bool


class About(msgspec.Struct, frozen=True, kw_only=True):
    """How evidence was made.

    Attributes:
        name: of the specification, or of the campaign.
        rvmon: the version that judged.
        law: the version of the law.
        python: the version.
        packages: the versions of those that have a part in reading and judging.
        programs: SHA-256 of the sources of rvmon and, of a campaign, of what it tests.
        specs: entries with the requirements, by robot; of recordings by an empty name.
        command: of a campaign, the words that run it.
        recordings: by path.
        judging: how recordings were judged; `None` of a campaign.
        timeout_s: of a campaign, seconds that a test could take.
        planted: of a campaign, the faults of tests on a robot that had one, by robot and test.
        format: of this description.
    """

    name: str
    rvmon: str = rvmon.__version__
    law: int = LAW
    python: str = msgspec.field(default_factory=platform.python_version)
    packages: dict[str, str]
    programs: dict[str, Stamp]
    specs: dict[str, str]
    command: list[str] = []
    recordings: dict[str, Stamp] = {}
    judging: Judging | None = None
    timeout_s: float | None = None
    planted: dict[str, str] = {}
    format: int = FORMAT


def stamp_of(path: str) -> Stamp | None:
    """The stamp of a recording, a file or a bag in a folder; `None` if there is none."""
    if is_bag_folder(path):
        return stamp_of_files(path, [Path(path)])
    if not Path(path).is_file():
        return None
    with open(path, "rb") as file:
        return Stamp(Path(path).stat().st_size, hashlib.file_digest(file, "sha256").hexdigest())


def stamp_of_files(root: str | Path, paths: Iterable[Path]) -> Stamp:
    """The stamp of files, and of those in folders, by their names from a folder on.

    Args:
        root: that folder; a file elsewhere goes by its last name.
        paths: of files and folders.
    """
    found: set[tuple[str, Stamp]] = set()
    for path in _files(paths):
        name = path.relative_to(root).as_posix() if path.is_relative_to(root) else path.name
        if (one := stamp_of(str(path))) is not None:
            found.add((name, one))
    lines = sorted(f"{one.sha256}  {name}\n" for name, one in found)
    size = sum(one.bytes for _, one in found)
    return Stamp(size, hashlib.sha256("".join(lines).encode()).hexdigest())


def _files(paths: Iterable[Path]) -> Iterator[Path]:
    for path in paths:
        if path.is_dir():
            yield from (Path(name) for name, _, _ in file_stamps(str(path)))
        else:
            yield path


@cache
def own_program() -> Stamp:
    """The stamp of the sources of rvmon, of which this process has read some."""
    folder = Path(rvmon.__file__).parent
    return stamp_of_files(folder, [folder])


def package_versions(further: Iterable[str] = ()) -> Mapping[str, str]:
    """The versions of the packages that rvmon can make use of, and of further ones."""
    needs: list[str] = []
    with suppress(PackageNotFoundError):
        needs = [one for one in requires("rvmon") or () if "'dev'" not in one]
    names = {re.split(r"[^\w.-]", one)[0] for one in needs} | {*further}
    found: dict[str, str] = {}
    for name in sorted(names - {"rvmon"}):
        with suppress(PackageNotFoundError):
            found[name] = version(name)
    return found
