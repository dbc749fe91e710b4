"""Evidence archives: their contents, writing, reading and checksums."""

from __future__ import annotations

import csv
import hashlib
import io
import platform
import re
import zipfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import cache
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Literal, NamedTuple

import msgspec

import rvmon
from rvmon.coverage import Hits, Model, count_of, merged, share
from rvmon.errors import RvmonError, writing
from rvmon.files import files_within, write_whole
from rvmon.report.trace_matrix import Row, matrix_csv, matrix_page, rows_by_item, trace_matrix
from rvmon.reproducer import (
    definition_files,
    expect_definitions_inside,
    files_under,
    imported_files,
    path_inside,
)
from rvmon.session import Spec
from rvmon.verdicts import LAW
from rvmon.verdicts.serialise import VerdictRow
from rvmon.verdicts.table_file import csv_bytes

SUMS = "SHA256SUMS"
"""The entry with the checksums of all others, in the format of `sha256sum --check`."""

MOST_BYTES = 1 << 30
"""The most bytes of an archive."""


class TamperedError(RvmonError):
    """An evidence archive was changed after it was written."""


def pack(entries: Mapping[str, bytes]) -> bytes:
    """The bytes of an archive of these entries and their checksums.

    The bytes depend only on the entries.

    Raises:
        RvmonError: the archive would be larger than `unpack` accepts.

    >>> pack({"b": b"1", "a": b"2"}) == pack({"a": b"2", "b": b"1"})
    True
    """
    sums = "".join(_sum(name, body) for name, body in sorted(entries.items()))
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as packed:
        for name, body in sorted({**entries, SUMS: sums.encode()}.items()):
            entry = zipfile.ZipInfo(name)
            # Unix on every system, so that the bytes are the same.
            entry.create_system, entry.external_attr = 3, 0o100644 << 16
            packed.writestr(entry, body)
    if made.tell() > MOST_BYTES:
        raise RvmonError(
            f"evidence of {made.tell():,} bytes is too large: evaluate fewer recordings at once"
        )
    return made.getvalue()


def _sum(name: str, body: bytes) -> str:
    return f"{hashlib.sha256(body).hexdigest()}  {name}\n"


def unpack(path: str) -> dict[str, bytes]:
    """The entries of an archive, without the checksums.

    Raises:
        RvmonError: the file cannot be read, or has entries that `pack` never writes.
        TamperedError: the file was changed after it was written, or is not an archive.
    """
    try:
        if Path(path).stat().st_size > MOST_BYTES or not Path(path).is_file():
            raise RvmonError(f"{path} is not a file, or is larger than {MOST_BYTES >> 30} GB")
        data = Path(path).read_bytes()
    except OSError as error:
        raise RvmonError(f"{path}: {error.strerror or error}") from None
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as packed:
            found = packed.infolist()
            # Entries that are stored without compression, each once, cannot be larger than the
            # file: this excludes zip bombs.
            is_packed = any(entry.compress_type != zipfile.ZIP_STORED for entry in found)
            is_doubled = len({entry.filename for entry in found}) < len(found)
            if is_packed or is_doubled or sum(entry.file_size for entry in found) > len(data):
                raise RvmonError(
                    f"{path} is not an evidence archive: entries are compressed, doubled or overlap"
                )
            entries = {entry.filename: packed.read(entry) for entry in found}
    except (zipfile.BadZipFile, EOFError, ValueError, NotImplementedError, RuntimeError) as error:
        raise TamperedError(f"{path} is not an evidence archive, or is damaged: {error}") from None
    sums = entries.pop(SUMS, b"").decode("utf-8", "replace")
    # `pack` depends only on the entries, so any other byte in the file is a change.
    if pack(entries) != data:
        other = [name for name, body in entries.items() if _sum(name, body) not in sums]
        names = ", ".join(other) or "its format, or a missing entry"
        raise TamperedError(f"{path} was changed since it was written: {names}")
    return entries


ABOUT, VERDICTS, COVERAGE = "evidence.json", "verdicts.csv", "coverage.json"


class Judging(msgspec.Struct, frozen=True):
    """The options of `rvmon run` under which recordings were judged."""

    only: str | None
    const: list[str]
    until: float | None
    time: str | None
    map: list[str]
    nan: str | None
    clock: str | None
    binding: str | None
    allow_missing: str | None
    robustness: bool
    severity: str | None = None
    tag: list[str] = []


class About(msgspec.Struct, frozen=True, kw_only=True):
    """The origin of evidence: either recordings that were judged, or a campaign.

    Attributes:
        name: of the specification, or of the campaign.
        rvmon: its version.
        law: version of the law.
        python: its version.
        packages: the installed versions of the packages that rvmon or the campaign can use.
        programs: SHA-256 of the sources of rvmon and, for a campaign, of its dependencies.
        specs: names of the entries with the requirements, by robot; for recordings, the only key
            is the empty string.
        command: for a campaign, the command line that runs it, as words.
        recordings: SHA-256 of each recording, by path.
        judging: the options for recordings; `None` for a campaign.
        timeout_s: for a campaign, the limit of a test in seconds.
        planted: for a campaign, the planted faults by robot and test (`ROBOT/TEST`).
        format: version of this description.
    """

    name: str
    rvmon: str = rvmon.__version__
    law: int = LAW
    python: str = msgspec.field(default_factory=platform.python_version)
    packages: dict[str, str]
    programs: dict[str, str]
    specs: dict[str, str]
    command: list[str] = []
    recordings: dict[str, str] = {}
    judging: Judging | None = None
    timeout_s: float | None = None
    planted: dict[str, str] = {}
    format: Literal[1] = 1


class Kept(NamedTuple):
    """An open evidence archive.

    Attributes:
        about: its origin.
        entries: all entries, by name.
        items: the verdicts by recording; for a campaign, by robot and test.
        specs: the unpacked files of the requirements, by robot; deleted when it is closed.
        binding: path of the unpacked binding, if there is one.
    """

    about: About
    entries: Mapping[str, bytes]
    items: Mapping[str, list[Row]]
    specs: Mapping[str, Path]
    binding: str | None


def sha256_of(path: Path, *more: Path) -> str:
    """The SHA-256 of a file; of a folder, the SHA-256 of what `sha256sum` prints for its files.

    Args:
        path: of the file or folder.
        more: further files of the same recording; the result is then the SHA-256 of the lines of
            all its files, in this order.

    Raises:
        OSError: a file cannot be read.
    """
    if more:
        both = "".join(f"{sha256_of(one)}  {one.name}\n" for one in (path, *more))
        return hashlib.sha256(both.encode()).hexdigest()
    if path.is_file():
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    files = [Path(entry) for entry in files_within(str(path))]
    lines = sorted(f"{sha256_of(file)}  {file.relative_to(path).as_posix()}\n" for file in files)
    return hashlib.sha256("".join(lines).encode()).hexdigest()


@cache
def own_program() -> str:
    """The SHA-256 of the sources of rvmon."""
    return sha256_of(Path(rvmon.__file__).parent)


def package_versions(further: Iterable[str] = ()) -> dict[str, str]:
    """The installed versions of the packages that rvmon can use, and of `further` packages."""
    needs: list[str] = []
    with suppress(PackageNotFoundError):
        needs = [require for require in requires("rvmon") or () if "'dev'" not in require]
    found: dict[str, str] = {}
    for name in sorted({re.split(r"[^\w.-]", need)[0] for need in needs} | {*further}):
        with suppress(PackageNotFoundError):
            found[name] = version(name)
    return found


def texts_of(
    specs: Mapping[str, str | Path], binding: str | None = None
) -> tuple[dict[str, bytes], list[str]]:
    """The archive entries of specifications with their imports, and of a binding.

    Args:
        specs: paths by robot; for recordings, the only key is the empty string.
        binding: path.

    Returns:
        The entries; and the entry names of the specifications and the binding, in this order.

    Raises:
        RvmonError: a file cannot be read.
    """
    try:
        parts = [
            files_under(f"spec/{robot}".rstrip("/"), str(path), imported_files(str(path)))
            for robot, path in specs.items()
        ]
        if binding is not None:
            parts.append(files_under("binding", binding, definition_files(binding)))
        return {name: path.read_bytes() for one in parts for name, path in one}, [
            one[0][0] for one in parts
        ]
    except (OSError, ValueError) as error:
        raise RvmonError(f"--evidence: these files cannot be archived: {error}") from None


def coverage_json(covered: Mapping[str, tuple[Model, Iterable[Hits]]]) -> bytes:
    """The coverage of each robot as JSON: its share, and the hits of each item."""
    document = {}
    for robot, (model, several) in covered.items():
        hits = merged(several)
        groups = {
            group: {item: count_of(hits, group, item) for item in model.groups[group].items}
            for group in model.groups
        }
        document[robot] = {"share": share(hits, model), "hits": groups}
    return msgspec.json.format(msgspec.json.encode(document))


def write_evidence(
    path: str,
    about: About,
    entries: Mapping[str, bytes],
    specs: Mapping[str, Spec],
    rows: Iterable[VerdictRow],
) -> None:
    """Write an evidence archive; the same verdicts on the same inputs give the same bytes.

    Raises:
        RvmonError: the file cannot be written.
    """
    verdicts = csv_bytes(rows)
    derived = derived_entries(about, specs, rows_by_item(verdicts))
    about_text = msgspec.json.format(msgspec.json.encode(about))
    with writing(path):
        write_whole(path, pack({**entries, **derived, ABOUT: about_text, VERDICTS: verdicts}))


def derived_entries(
    about: About, specs: Mapping[str, Spec], items: Mapping[str, list[Row]]
) -> dict[str, bytes]:
    """The entries computed from requirements and verdicts: the trace matrix as CSV and as page.

    Raises:
        ValueError: a row of `items` has an unknown verdict.
    """
    checked = {robot: spec.checked for robot, spec in specs.items()}
    matrix = trace_matrix(checked, items, about.planted)
    facts = {
        "evaluated by": f"rvmon {about.rvmon}, law {about.law}, Python {about.python}",
        "command": " ".join(about.command),
    }
    page = matrix_page(f"{about.name}: what shows its requirements", facts, matrix)
    return {"matrix.csv": matrix_csv(matrix), "matrix.html": page}


@contextmanager
def opened_evidence(path: str) -> Iterator[Kept]:
    """Open an evidence archive.

    Raises:
        RvmonError: the file cannot be read, is not evidence, or is of a later rvmon.
        TamperedError: the archive was changed after it was written.
    """
    entries = unpack(path)
    try:
        about = msgspec.json.decode(entries[ABOUT], type=About)
        items = rows_by_item(entries[VERDICTS])
        if about.judging is not None and about.specs.keys() != {""}:
            raise ValueError("recordings are checked against one specification")
    except (KeyError, ValueError, csv.Error) as error:
        raise RvmonError(
            f"{path} is not an evidence archive that this rvmon can read: {error}"
        ) from None
    judged = items.keys() if about.judging else {item.partition("/")[0] for item in items}
    known = about.recordings if about.judging else about.specs
    if other := judged - known.keys():
        raise TamperedError(f"{VERDICTS} has verdicts on others: {', '.join(sorted(other))}")
    with TemporaryDirectory(prefix="rvmon-") as temporary:
        folder = Path(temporary, "evidence")
        try:
            for name, body in entries.items():
                if name.startswith(("spec/", "binding/")):
                    target = path_inside(folder, name)
                    target.parent.mkdir(parents=True, exist_ok=True)
                    target.write_bytes(body)
            # Marks the folder as a project, so that the specifications may import from all of it.
            (folder / "pyproject.toml").touch()
        except OSError as error:
            raise RvmonError(f"{path}: {error.strerror or error}") from None
        specs = {robot: path_inside(folder, name) for robot, name in about.specs.items()}
        binding = about.judging.binding if about.judging is not None else None
        if binding is not None:
            binding = str(path_inside(folder, binding))
            expect_definitions_inside(folder, binding)
        yield Kept(about, entries, items, specs, binding)
