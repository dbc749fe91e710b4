"""Reproducers: an attempt, the recording around it and its specification in one file.

A reproducer is a zip file of a description, `case.json`, and the files that it names. Nothing in it
is executed. It is unpacked to a temporary folder, and no name in it can lead out of that folder.
"""

from __future__ import annotations

import os
import tomllib
import zipfile
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from tempfile import TemporaryDirectory

import msgspec

from rvmon.diagnostics import Source
from rvmon.errors import RvmonError, writing
from rvmon.files import staged
from rvmon.language.rules import Findings
from rvmon.language.syntax.parse import load_files
from rvmon.texts import cannot_read, text_of_file

FORMAT = 1
"""Version of the description; any other version is refused."""

MOST_BYTES = 1 << 31
"""The most bytes of all files together after unpacking."""

MOST_FILES = 1000

_DESCRIPTION = "case.json"
_MOST_DESCRIBED = 1 << 20
_BLOCK = 1 << 20
_LEADS_OUT = frozenset("\\:\0")
"""Characters that no name may contain; on some systems they would lead out of the folder."""


class Case(msgspec.Struct, frozen=True):
    """An attempt to reproduce.

    Attributes:
        rvmon: the version of rvmon that judged the attempt.
        law: the version of the law.
        attempt: the name of the attempt when the clipped recording is judged.
        verdict: of the attempt.
        triggered: ticks.
        decided: ticks; `None` if the attempt was not decided.
        spec: path of the specification.
        recording: path of the recording around the attempt.
        binding: path of the binding, if there is one.
        const: constants that were overridden, as `NAME=VALUE`.
        time: option of `rvmon run` for reading the recording, as are the next four.
        map: see `rvmon run`.
        nan: see `rvmon run`.
        clock: see `rvmon run`.
        allow_missing: see `rvmon run`.
        format: version of the description.
    """

    rvmon: str
    law: int
    attempt: str
    verdict: str
    triggered: int
    decided: int | None
    spec: str
    recording: str
    binding: str | None = None
    const: tuple[str, ...] = ()
    time: str | None = None
    map: tuple[str, ...] = ()
    nan: str | None = None
    clock: str | None = None
    allow_missing: str | None = None
    format: int = FORMAT


class _Version(msgspec.Struct):
    format: int
    rvmon: str = "another version"


def write_case(out: str, case: Case) -> None:
    """Write a reproducer, completely or not at all.

    Args:
        out: path of the file.
        case: the attempt, with paths of existing files; the files that these import or name are
            packed as well.

    Raises:
        RvmonError: a file cannot be read or written, or an import in it leads out of the
            reproducer.
    """
    with writing(out):
        names: dict[str, str] = {}
        files: list[tuple[str, Path]] = []
        for part, main, others in _parts(case):
            found = files_under(part, main, others)
            names[part] = found[0][0]
            files += [pair for name, path in found for pair in _files_at(name, path)]
        described = msgspec.json.format(msgspec.json.encode(msgspec.structs.replace(case, **names)))
        with staged(out) as made:
            with zipfile.ZipFile(
                made, "w", zipfile.ZIP_DEFLATED, strict_timestamps=False
            ) as packed:
                packed.writestr(zipfile.ZipInfo(_DESCRIPTION), described)
                for name, path in files:
                    packed.write(path, name)
            with opened_case(str(made)) as again:
                _expect_inside(again)


def _parts(case: Case) -> Iterator[tuple[str, str, list[str]]]:
    """For each part: its folder in the reproducer, its file, and the files that this one names."""
    yield "spec", case.spec, imported_files(case.spec)
    yield "recording", case.recording, []
    if case.binding is not None:
        yield "binding", case.binding, definition_files(case.binding)


def files_under(part: str, main: str, others: Sequence[str]) -> list[tuple[str, Path]]:
    """A file and the files that it names, as pairs of archive name and path; the file is first.

    Args:
        part: folder in the archive; the files keep their places relative to each other.
        main: path of the file.
        others: paths of the files that it names.
    """
    paths = [Path(os.path.abspath(one)) for one in (main, *others)]
    root = Path(os.path.commonpath([path.parent for path in paths]))
    return [(f"{part}/{path.relative_to(root).as_posix()}", path) for path in paths]


def imported_files(spec: str) -> list[str]:
    """The files that a specification imports, without the libraries that rvmon ships."""
    read = load_files(Source(spec, text_of_file(spec)), Path(spec).parent, Findings())
    return [
        parsed_spec.source.name
        for parsed_spec in read[1:]
        if os.path.isfile(parsed_spec.source.name)
    ]


def definition_files(binding: str) -> list[str]:
    """The paths of the definition files that a binding names."""
    return [str(Path(binding).parent / definition) for definition in _definitions(binding)]


def _definitions(binding: str) -> list[str]:
    """The definition files of a binding, as written there."""
    return list(tomllib.loads(text_of_file(binding)).get("definitions", []))


def _files_at(name: str, path: Path) -> Iterator[tuple[str, Path]]:
    """A file, or all files of a folder: a ROS 2 bag is a folder."""
    if path.is_dir():
        for one in sorted(path.iterdir()):
            yield from _files_at(f"{name}/{one.name}", one)
    else:
        yield name, path


def _expect_inside(case: Case) -> None:
    """Check that the specification can be loaded with its imports inside the reproducer.

    Raises:
        RvmonError: an imported file is missing.
    """
    findings = Findings()
    load_files(Source(case.spec, text_of_file(case.spec)), Path(case.spec).parent, findings)
    for finding in findings.diagnostics:
        raise RvmonError(f"{finding.message}: import it by a relative path")


@contextmanager
def opened_case(path: str) -> Iterator[Case]:
    """Open a reproducer; its unpacked files exist while the block runs.

    Raises:
        RvmonError: the file cannot be read, is not a reproducer, is damaged, too large or of a
            later rvmon; or a name in it leads out of it.
    """
    with TemporaryDirectory(prefix="rvmon-") as temporary:
        folder = Path(temporary, "case")
        folder.mkdir()
        try:
            with zipfile.ZipFile(path) as packed:
                case = _read_description(packed)
                _unpack(packed, folder)
        except OSError as error:
            raise RvmonError(cannot_read(path, error)) from None
        except (
            zipfile.BadZipFile,
            zlib.error,
            EOFError,
            KeyError,
            NotImplementedError,
            RuntimeError,
            msgspec.MsgspecError,
            UnicodeDecodeError,
        ) as error:
            reason = str(error.args[0]) if error.args else type(error).__name__
            raise RvmonError(f"{path}: no reproducer, or a damaged one ({reason})") from None
        except RvmonError as error:
            raise RvmonError(f"{path}: {error}") from None
        # Marks the folder as a project, so that the specification may import from all of it.
        (folder / "pyproject.toml").touch()
        places = {
            part: str(path_inside(folder, name))
            for part in ("spec", "recording", "binding")
            if (name := getattr(case, part)) is not None
        }
        case = msgspec.structs.replace(case, **places)
        if case.binding is not None:
            expect_definitions_inside(folder, case.binding)
        yield case


def _read_description(packed: zipfile.ZipFile) -> Case:
    """Read the description.

    Raises:
        RvmonError: its version is not `FORMAT`.
        KeyError, MsgspecError: it is missing or malformed.
    """
    with packed.open(_DESCRIPTION) as file:
        text = file.read(_MOST_DESCRIBED)
    version = msgspec.json.decode(text, type=_Version)
    if version.format != FORMAT:
        raise RvmonError(
            f"a reproducer of a later format ({version.format}), made by rvmon {version.rvmon}: "
            "install that version or a later one"
        )
    return msgspec.json.decode(text, type=Case)


def _unpack(packed: zipfile.ZipFile, folder: Path) -> None:
    entries = [entry for entry in packed.infolist() if not entry.is_dir()]
    if len(entries) > MOST_FILES:
        raise RvmonError(f"contains more than {MOST_FILES} files, and is not a reproducer")
    left = MOST_BYTES
    for entry in entries:
        target = path_inside(folder, entry.filename)
        target.parent.mkdir(parents=True, exist_ok=True)
        with packed.open(entry) as file, target.open("xb") as made:
            # Count the bytes that are read: the size that an entry declares may be false.
            while block := file.read(min(_BLOCK, left + 1)):
                left -= len(block)
                if left < 0:
                    raise RvmonError(f"is larger than {MOST_BYTES >> 30} GB when it is unpacked")
                made.write(block)


def path_inside(folder: Path, name: str) -> Path:
    """The path in `folder` of a name in an archive.

    Raises:
        RvmonError: the name leads out of the folder.
    """
    path = PurePosixPath(name)
    if path.is_absolute() or ".." in path.parts or not path.parts or _LEADS_OUT & set(name):
        raise RvmonError(f"the name `{name}` leads out of it")
    return folder / path


def expect_definitions_inside(folder: Path, binding: str) -> None:
    """Check that the definition files of an unpacked binding lie in the folder.

    Raises:
        RvmonError: one lies outside.
    """
    try:
        named = _definitions(binding)
    except (OSError, ValueError, TypeError):  # reported when the binding itself is read
        return
    for one in named:
        place = Path(binding).parent / str(one)
        if not place.resolve().is_relative_to(folder.resolve()):
            raise RvmonError(f"the definition `{one}` leads out of it: name it by a relative path")
