"""Measure with coverage.py which statements and branches of named blocks each test runs."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from types import TracebackType
from typing import TYPE_CHECKING

from rvmon.cdv.code import Code
from rvmon.coverage.hits import Hit
from rvmon.coverage.model import Group, Item, Subject, group_of
from rvmon.errors import RvmonError, not_installed

if TYPE_CHECKING:
    from coverage import Coverage


class Meter:
    """One measurement for many tests, one after the other, each with its own context.

    It is a context, to be entered again and again, which measures while it is entered.

    Args:
        code: what is measured.

    Raises:
        RvmonError: coverage.py is not installed.
    """

    def __init__(self, code: Code) -> None:
        self._code = code
        self._coverage = _coverage(code)
        self._tests = 0

    def begin(self) -> None:
        """From now on, what runs belongs to a new test."""
        self._tests += 1
        self._coverage.start()
        self._coverage.switch_context(str(self._tests))
        self._coverage.stop()

    def __enter__(self) -> None:
        self._coverage.start()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        place: TracebackType | None,
    ) -> None:
        self._coverage.stop()

    def hits(self) -> dict[str, dict[str, Hit]]:
        """The statements, and branches, that this test ran: by group of the model and item."""
        data = self._coverage.get_data()
        data.set_query_context(str(self._tests))
        ran: dict[str, set[str]] = {}
        for path in _paths(self._code):
            ran[path] = {str(line) for line in data.lines(path) or ()}
            if self._code.branches:
                ran[path].update(self._files[path].branches_of(data.arcs(path) or ()))
        found = {}
        for group, path in self._groups:
            items = {name: Hit(1) for name in group.items if name in ran[path]}
            if items:
                found[group.name] = items
        return found

    @cached_property
    def _files(self) -> Mapping[str, _File]:
        return {path: _File(self._coverage, path) for path in _paths(self._code)}

    @cached_property
    def _groups(self) -> list[tuple[Group, str]]:
        return _groups(self._code, self._files)


def code_groups(code: Code) -> list[Group]:
    """What there is to be covered: statements of each block, and branches where it has some.

    Args:
        code: the blocks.

    Raises:
        RvmonError: coverage.py is not installed, or a file is no Python.
    """
    meter = _coverage(code)
    files = {path: _File(meter, path) for path in _paths(code)}
    return [group for group, _ in _groups(code, files)]


def statements_name(block: str) -> str:
    """The name of the group of a block's statements."""
    return f"statements of {block}"


def branches_name(block: str) -> str:
    """The name of the group of a block's branches."""
    return f"branches of {block}"


def _groups(code: Code, files: Mapping[str, _File]) -> list[tuple[Group, str]]:
    """The groups with the path of each."""
    groups = []
    for block in code.blocks:
        file = files[block.path]
        items = [
            Item(str(line), text=file.text(line)) for line in sorted(file.statements & block.lines)
        ]
        group = group_of(statements_name(block.name), Subject.STATEMENTS, items)
        groups.append((group, block.path))
        if code.branches:
            items = [
                Item(_arc(*arc), text=" → ".join(map(file.text, arc)))
                for arc in sorted(file.branches)
                if arc[0] in block.lines
            ]
            if items:
                group = group_of(branches_name(block.name), Subject.BRANCHES, items)
                groups.append((group, block.path))
    return groups


class _File:
    """What coverage.py says of a file: its statements, and the ways on from those with several."""

    def __init__(self, meter: Coverage, path: str) -> None:
        from coverage.exceptions import CoverageException
        from coverage.python import PythonFileReporter

        self._reporter = PythonFileReporter(path, meter)
        try:
            self.statements = frozenset(self._reporter.lines())
            self._branching = {
                line for line, exits in self._reporter.exit_counts().items() if exits > 1
            }
            possible = self._reporter.arcs()
            self._lines = self._reporter.source().splitlines()
        except (CoverageException, OSError) as error:
            raise RvmonError(f"{path}: its code cannot be measured: {error}") from None
        self.branches = {arc for arc in possible if arc[0] in self._branching}

    def text(self, line: int) -> str:
        """A line as it is written; the way out of a function has no line."""
        return self._lines[line - 1].strip() if line > 0 else "exit"

    def branches_of(self, arcs: object) -> set[str]:
        """The names of the branches among the ways that were gone."""
        gone = self._reporter.translate_arcs(arcs)  # type: ignore[arg-type]
        return {_arc(*arc) for arc in gone if arc in self.branches}


def _arc(first: int, last: int) -> str:
    return f"{first} → {last if last > 0 else 'exit'}"


def _paths(code: Code) -> list[str]:
    return list(dict.fromkeys(block.path for block in code.blocks))


def _coverage(code: Code) -> Coverage:
    """A fresh measurement of the files, kept in memory, whatever the user's settings."""
    try:
        from coverage import Coverage
    except ImportError:
        raise not_installed("a campaign that measures code", "coverage") from None
    paths = _paths(code)
    meter = Coverage(data_file=None, config_file=False, include=paths, branch=code.branches)
    meter.set_option("run:core", "ctrace")  # the newer core knows no contexts
    meter.set_option("run:disable_warnings", ["no-data-collected"])
    return meter
