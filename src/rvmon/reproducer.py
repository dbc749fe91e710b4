"""Reproducers: one file that holds an attempt, the recording around it, and what judged it.

They are zip files of a description, `case.json`, and of the files that it names. Nothing in one is
executed; it is unpacked to a folder of its own, which no name in it can leave.
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
"""Version of the description; what a later one says is not guessed."""

MOST_BYTES = 1 << 31
"""The most bytes of all files together when they are unpacked."""

MOST_FILES = 1000

_DESCRIPTION = "case.json"
_MOST_DESCRIBED = 1 << 20
_BLOCK = 1 << 20
_LEADS_OUT = frozenset("\\:\0")
"""Characters that no name may contain: on some systems they would lead out of the folder."""


class Case(msgspec.Struct, frozen=True):
    """An attempt to be reproduced.

    Attributes:
        rvmon: the version that judged it.
        law: the version of the law.
        attempt: its name on the recording here.
        verdict: of it.
        triggered: ticks.
        decided: ticks; `None` if it is not.
        spec: path of the specification.
        recording: path of the recording around the attempt.
        binding: path of the binding, if there is one.
        const: constants that were overridden, as `NAME=VALUE`.
        time: an option of `rvmon run` for reading the recording; so are the next.
        map: see there.
        nan: see there.
        clock: see there.
        allow_missing: see there.
        format: of the description.
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
    """Write a reproducer, whole or not at all.

    Args:
        out: the file.
        case: names files that are there; those that they name come along.

    Raises:
        RvmonError: a file cannot be read or written, or a name in it leads out of the reproducer.
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
    """Folder in the reproducer, file, and the files that it names."""
    yield "spec", case.spec, imported_files(case.spec)
    yield "recording", case.recording, []
    if case.binding is not None:
        yield "binding", case.binding, definition_files(case.binding)


def files_under(part: str, main: str, others: Sequence[str]) -> list[tuple[str, Path]]:
    """A file and those that it names, each with its place in an archive; the file comes first.

    Args:
        part: folder of the archive; in it they lie to each other as they do here.
        main: path of the file.
        others: paths of those that it names.
    """
    paths = [Path(os.path.abspath(one)) for one in (main, *others)]
    root = Path(os.path.commonpath([path.parent for path in paths]))
    return [(f"{part}/{path.relative_to(root).as_posix()}", path) for path in paths]


def imported_files(spec: str) -> list[str]:
    """The files that a specification imports; what rvmon brings along itself is none."""
    read = load_files(Source(spec, text_of_file(spec)), Path(spec).parent, Findings())
    return [
        parsed_spec.source.name
        for parsed_spec in read[1:]
        if os.path.isfile(parsed_spec.source.name)
    ]


def definition_files(binding: str) -> list[str]:
    """The files of definitions that a binding names."""
    return [str(Path(binding).parent / definition) for definition in _definitions(binding)]


def _definitions(binding: str) -> list[str]:
    """The files that a binding names, as it does."""
    return list(tomllib.loads(text_of_file(binding)).get("definitions", []))


def _files_at(name: str, path: Path) -> Iterator[tuple[str, Path]]:
    """A file; or those of a folder, as a bag of ROS 2 is one."""
    if path.is_dir():
        for one in sorted(path.iterdir()):
            yield from _files_at(f"{name}/{one.name}", one)
    else:
        yield name, path


def _expect_inside(case: Case) -> None:
    """See that the files which are named by others are there.

    Raises:
        RvmonError: one is outside.
    """
    findings = Findings()
    load_files(Source(case.spec, text_of_file(case.spec)), Path(case.spec).parent, findings)
    for finding in findings.diagnostics:
        raise RvmonError(f"{finding.message}: import it by a path from the file that does")


@contextmanager
def opened_case(path: str) -> Iterator[Case]:
    """The contents of a reproducer; its files last as long as it is open.

    Raises:
        RvmonError: it cannot be read, is none, a damaged one, one of a later rvmon, or too large;
            or a name in it leads out of it.
    """
    with TemporaryDirectory(prefix="rvmon-") as temporary:
        folder = Path(temporary, "case")
        folder.mkdir()
        try:
            with zipfile.ZipFile(path) as packed:
                case = _described(packed)
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
        # Specifications may import what lies in their project: here that is this folder.
        (folder / "pyproject.toml").touch()
        places = {
            part: str(placed(folder, name))
            for part in ("spec", "recording", "binding")
            if (name := getattr(case, part)) is not None
        }
        case = msgspec.structs.replace(case, **places)
        if case.binding is not None:
            expect_definitions_inside(folder, case.binding)
        yield case


def _described(packed: zipfile.ZipFile) -> Case:
    """The description.

    Raises:
        RvmonError: it is of a later version.
        KeyError, MsgspecError: there is none.
    """
    with packed.open(_DESCRIPTION) as file:
        text = file.read(_MOST_DESCRIBED)
    version = msgspec.json.decode(text, type=_Version)
    if version.format != FORMAT:
        raise RvmonError(
            f"a reproducer of a later form ({version.format}), made by rvmon {version.rvmon}: "
            "install that or a later one"
        )
    return msgspec.json.decode(text, type=Case)


def _unpack(packed: zipfile.ZipFile, folder: Path) -> None:
    entries = [entry for entry in packed.infolist() if not entry.is_dir()]
    if len(entries) > MOST_FILES:
        raise RvmonError(f"holds more than {MOST_FILES} files, and is no reproducer")
    left = MOST_BYTES
    for entry in entries:
        target = placed(folder, entry.filename)
        target.parent.mkdir(parents=True, exist_ok=True)
        with packed.open(entry) as file, target.open("xb") as made:
            # What an entry says of its size need not be true.
            while block := file.read(min(_BLOCK, left + 1)):
                left -= len(block)
                if left < 0:
                    raise RvmonError(f"is larger than {MOST_BYTES >> 30} GB when it is unpacked")
                made.write(block)


def placed(folder: Path, name: str) -> Path:
    """The path of a name in an archive.

    Raises:
        RvmonError: elsewhere.
    """
    path = PurePosixPath(name)
    if path.is_absolute() or ".." in path.parts or not path.parts or _LEADS_OUT & set(name):
        raise RvmonError(f"the name `{name}` leads out of it")
    return folder / path


def expect_definitions_inside(folder: Path, binding: str) -> None:
    """See that the files which a binding names lie in its archive.

    Raises:
        RvmonError: one does not.
    """
    try:
        named = _definitions(binding)
    except (OSError, ValueError, TypeError):  # whoever reads the binding says what is wrong
        return
    for one in named:
        place = Path(binding).parent / str(one)
        if not place.resolve().is_relative_to(folder.resolve()):
            raise RvmonError(f"the definition `{one}` leads out of it: name it by a relative path")
