"""Evidence written, and opened again."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import msgspec

from rvmon.coverage.hits import Hits, count_of, merged, share
from rvmon.coverage.model import Model
from rvmon.errors import RvmonError
from rvmon.evidence.about import FORMAT, About
from rvmon.evidence.archive import TamperedError, pack, unpack
from rvmon.evidence.matrix import Row, matrix_csv, matrix_page, rows_by_item, trace_matrix
from rvmon.reproducer import (
    definition_files,
    expect_definitions_inside,
    files_under,
    imported_files,
    placed,
)
from rvmon.results.write import csv_bytes
from rvmon.session import Spec
from rvmon.verdict.rows import VerdictRow
from rvmon.writing import write_whole

ABOUT, VERDICTS, COVERAGE = "evidence.json", "verdicts.csv", "coverage.json"
"""Entries, beside the requirements and the tests."""

_FOLDERS = ("spec/", "binding/")
"""Entries that are read as files."""


@dataclass(frozen=True, slots=True)
class Texts:
    """The requirements as their files say them, with all that these name.

    Attributes:
        entries: by name.
        specs: entry of the requirements, by robot.
        binding: entry of the binding, if there is one.
    """

    entries: Mapping[str, bytes]
    specs: dict[str, str]
    binding: str | None = None


def texts_of(specs: Mapping[str, str | Path], binding: str | None = None) -> Texts:
    """Read the files of requirements.

    Args:
        specs: paths, by robot; of recordings by an empty name.
        binding: path.

    Raises:
        RvmonError: one cannot be read.
    """
    try:
        found, places = [], {}
        for robot, spec in specs.items():
            own = files_under(f"spec/{robot}".rstrip("/"), str(spec), imported_files(str(spec)))
            found += own
            places[robot] = own[0][0]
        bound = None
        if binding is not None:
            own = files_under("binding", binding, definition_files(binding))
            found += own
            bound = own[0][0]
        return Texts({name: path.read_bytes() for name, path in found}, places, bound)
    except (OSError, ValueError) as error:
        raise RvmonError(f"evidence cannot be kept of these files: {error}") from None


def coverage_json(covered: Mapping[str, tuple[Model, Iterable[Hits]]]) -> bytes:
    """What was hit of coverage models, by robot: the share, and each item with its hits."""
    document = {}
    for robot, (model, several) in covered.items():
        hits = merged(several)
        groups = {
            group.name: {
                item.name: {
                    "kind": item.kind,
                    "goal": item.goal,
                    "hits": count_of(hits, group.name, item.name),
                }
                for item in group.items.values()
            }
            for group in model.groups.values()
        }
        document[robot] = {"share": share(hits, model), "groups": groups}
    return msgspec.json.format(msgspec.json.encode(document))


def write_evidence(
    path: str,
    about: About,
    entries: Mapping[str, bytes],
    specs: Mapping[str, Spec],
    rows: Iterable[VerdictRow],
) -> None:
    """Write evidence; the same verdicts on the same inputs give the same bytes.

    Args:
        path: of the file.
        about: what it was made of.
        entries: the texts of the requirements, and what else it holds.
        specs: the requirements, by robot.
        rows: the verdicts.

    Raises:
        RvmonError: it cannot be written.
    """
    verdicts = csv_bytes(rows)
    told = msgspec.json.format(msgspec.json.encode(about)) + b"\n"
    derived = matrix_entries(about, specs, verdicts)
    try:
        write_whole(path, pack({**entries, **derived, ABOUT: told, VERDICTS: verdicts}))
    except OSError as error:
        raise RvmonError(f"cannot write {path}: {error.strerror or error}") from None


def matrix_entries(about: About, specs: Mapping[str, Spec], verdicts: bytes) -> dict[str, bytes]:
    """The entries that follow from requirements and verdicts.

    Args:
        about: what the evidence was made of.
        specs: the requirements, by robot.
        verdicts: as CSV.

    Raises:
        ValueError: they are none.
    """
    checked = {robot: spec.checked for robot, spec in specs.items()}
    matrix = trace_matrix(checked, rows_by_item(verdicts), about)
    return {"matrix.csv": matrix_csv(matrix), "matrix.html": matrix_page(matrix, about)}


@dataclass(frozen=True, slots=True)
class Kept:
    """Evidence that is open.

    Attributes:
        about: what it was made of.
        entries: all that it holds, by name.
        folder: of the requirements as files, as long as it is open.
    """

    about: About
    entries: Mapping[str, bytes]
    folder: Path

    @property
    def specs(self) -> dict[str, Path]:
        """The files of the requirements, by robot."""
        return {name: placed(self.folder, place) for name, place in self.about.specs.items()}

    @property
    def binding(self) -> str | None:
        """Path of the binding, if there is one."""
        if self.about.judging is None or self.about.judging.binding is None:
            return None
        path = str(placed(self.folder, self.about.judging.binding))
        expect_definitions_inside(self.folder, path)
        return path

    @property
    def items(self) -> dict[str, list[Row]]:
        """The verdicts by recording; of a campaign by robot and test.

        Raises:
            TamperedError: they are none, or of other recordings.
        """
        try:
            found = rows_by_item(self.entries[VERDICTS])
        except (ValueError, csv.Error) as error:
            raise TamperedError(f"{VERDICTS} holds no verdicts: {error}") from None
        other = found.keys() - self.about.recordings.keys()
        if self.about.judging is not None and other:
            raise TamperedError(f"{VERDICTS} is of other recordings: {', '.join(sorted(other))}")
        return found

    def expect_matrix(self, specs: Mapping[str, Spec]) -> None:
        """See that the matrix follows from requirements and verdicts.

        Raises:
            TamperedError: it does not.
        """
        try:
            derived = matrix_entries(self.about, specs, self.entries[VERDICTS])
        except ValueError as error:
            raise TamperedError(f"{VERDICTS} holds no verdicts: {error}") from None
        for name, body in derived.items():
            if self.entries.get(name) != body:
                raise TamperedError(f"{name} does not follow from requirements and verdicts")


class _Version(msgspec.Struct):
    format: int
    rvmon: str = "another version"


@contextmanager
def opened_evidence(path: str) -> Iterator[Kept]:
    """What evidence holds.

    Raises:
        RvmonError: it cannot be read, is none, or one of a later rvmon.
        TamperedError: it was changed since it was written.
    """
    entries = unpack(path)
    try:
        told = entries[ABOUT]
        _ = entries[VERDICTS]
        found = msgspec.json.decode(told, type=_Version)
        if found.format != FORMAT:
            raise RvmonError(
                f"{path}: evidence of a later form ({found.format}), by rvmon {found.rvmon}: "
                "install that or a later one"
            )
        about = msgspec.json.decode(told, type=About)
    except (KeyError, msgspec.MsgspecError, UnicodeDecodeError) as error:
        raise RvmonError(f"{path} is no evidence of rvmon: {error}") from None
    with TemporaryDirectory(prefix="rvmon-") as temporary:
        folder = Path(temporary, "evidence")
        folder.mkdir()
        try:
            for name, body in entries.items():
                if name.startswith(_FOLDERS):
                    target = placed(folder, name)
                    target.parent.mkdir(parents=True, exist_ok=True)
                    target.write_bytes(body)
        except OSError as error:
            raise RvmonError(f"{path}: {error.strerror or error}") from None
        # Specifications may import what lies in their project: here that is this folder.
        (folder / "pyproject.toml").touch()
        yield Kept(about, entries, folder)
