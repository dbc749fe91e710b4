"""A file and all that it imports, each read once."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from importlib import resources
from pathlib import Path

from rvmon.diagnostics import Source
from rvmon.language.rules import Findings, Refusal
from rvmon.language.rules import names as rules
from rvmon.language.syntax.items import ImportItem, ParsedSpec
from rvmon.language.syntax.parse import parse_spec
from rvmon.texts import ImportTree, text_of_file, tree_of

LIBRARIES = ("patterns",)
"""Folders of this package with specifications that can be imported by name."""


def load_files(
    source: Source,
    directory: Path | None,
    findings: Findings,
    read: Callable[[Path], str] = text_of_file,
) -> list[ParsedSpec]:
    """Read a file and those it imports.

    Args:
        source: the main file.
        directory: its folder; default the current one.
        findings: takes what is wrong with how they are written or imported.
        read: gives the text of an imported file.

    Returns:
        The main file, then the imported ones in the order of their first import.
    """
    loader = _Loader(findings, tree_of(directory or Path()), read)
    loader.read(source, directory or Path(), _key(Path(source.name)), ())
    return loader.files


class _Loader:
    def __init__(self, findings: Findings, tree: ImportTree, read: Callable[[Path], str]) -> None:
        self.files: list[ParsedSpec] = []
        self._findings = findings
        self._tree = tree
        self._text = read
        self._seen: set[str] = set()

    def read(
        self, source: Source, directory: Path, key: str, path: tuple[tuple[str, ImportItem], ...]
    ) -> None:
        """Read a file; `path` are the files that are being read, with the imports in them."""
        self._seen.add(key)
        parsed = parse_spec(source, self._findings)
        self.files.append(parsed)
        for item in parsed.items:
            if isinstance(item, ImportItem):
                self._import(item, directory, (*path, (key, item)))

    def _import(
        self, item: ImportItem, directory: Path, path: tuple[tuple[str, ImportItem], ...]
    ) -> None:
        try:
            for source, folder, key in self._sources(item, directory):
                circle = [step for _, step in path[_index(path, key) :]]
                if circle:
                    self._findings.add(rules.circle(item.span, circle[0].span))
                elif len(path) > rules.DEEPEST:
                    raise Refusal(rules.too_deep(item.span))
                elif key not in self._seen:
                    self.read(source, folder, key, path)
        except Refusal as refusal:
            self._findings.add(refusal.finding)

    def _sources(self, item: ImportItem, directory: Path) -> Iterator[tuple[Source, Path, str]]:
        """The texts that an import means, each with its folder and a key of its own."""
        if not item.library:
            path = directory / item.target
            yield Source(str(path), self._read(path, item)), path.parent, _key(path)
            return
        if item.target not in LIBRARIES:
            raise Refusal(rules.unknown_library(item.span, item.target, ", ".join(LIBRARIES)))
        folder = resources.files("rvmon.language") / item.target
        for file in sorted(folder.iterdir(), key=lambda entry: entry.name):
            if file.name.endswith(".rv"):
                name = f"{item.target}/{file.name}"
                text = file.read_text(encoding="utf-8")
                yield Source(name, text), Path(), f"library {name}"

    def _read(self, file: Path, item: ImportItem) -> str:
        try:
            if not self._tree.holds(file):
                raise Refusal(rules.outside(item.span, item.target, str(self._tree.root)))
            return self._text(file)
        except OSError as error:
            reason = error.strerror or str(error)
        except UnicodeDecodeError:
            reason = "it is not UTF-8 text"
        except ValueError as error:  # a null character in the name
            reason = str(error)
        raise Refusal(rules.unreadable(item.span, item.target, reason))


def _index(path: tuple[tuple[str, ImportItem], ...], key: str) -> int:
    keys = [step for step, _ in path]
    return keys.index(key) if key in keys else len(keys)


def _key(path: Path) -> str:
    return os.path.abspath(path)
