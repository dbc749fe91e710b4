"""Coverage of states and transitions, and of code, by coverage.py; its export for other tools.

Sources: geninfo(1) of LCOV 2, section FILES; coverage-04.dtd of Cobertura.
"""

from __future__ import annotations

import os
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import permutations
from pathlib import Path
from typing import TYPE_CHECKING

import rvmon
from rvmon.cdv.campaign import Campaign
from rvmon.cdv.system import Code, Run
from rvmon.coverage import (
    PAIRS,
    STATES,
    TRANSITIONS,
    Group,
    Hit,
    Hits,
    Item,
    Model,
    Subject,
    count_of,
    group_of,
)
from rvmon.errors import RvmonError, needed

if TYPE_CHECKING:
    from coverage import Coverage


class Meter:
    """Measures the code coverage of many tests, one after the other.

    Use it as a context manager: it measures while entered, and can be entered repeatedly. Each test
    has its own context of coverage.py.

    Raises:
        RvmonError: coverage.py is not installed.
    """

    def __init__(self, code: Code) -> None:
        self._code = code
        self._coverage = _coverage(code)
        self._tests = 0

    def start(self) -> None:
        """Start a new test: all code measured from now on belongs to it."""
        self._tests += 1
        self._coverage.start()
        # Coverage.py switches contexts only while it measures.
        self._coverage.switch_context(str(self._tests))
        self._coverage.stop()

    def __enter__(self) -> None:
        self._coverage.start()

    def __exit__(self, *_: object) -> None:
        self._coverage.stop()

    def hits(self) -> dict[str, dict[str, Hit]]:
        """The statements and branches that the current test ran, by group and item."""
        data = self._coverage.get_data()
        data.set_query_context(str(self._tests))
        ran: dict[str, set[str]] = {}
        for path in _paths(self._code):
            ran[path] = {str(line) for line in data.lines(path) or ()}
            if self._code.branches:
                ran[path].update(self._files[path].branches_of(data.arcs(path) or ()))
        hits = {}
        for group, path in self.groups:
            items = {name: Hit(1) for name in group.items if name in ran[path]}
            if items:
                hits[group.name] = items
        return hits

    @cached_property
    def _files(self) -> Mapping[str, _File]:
        return {path: _File(self._coverage, path) for path in _paths(self._code)}

    @cached_property
    def groups(self) -> list[tuple[Group, str]]:
        """The groups to cover, each with the path of its block's file."""
        groups = []
        for block in self._code.blocks:
            file, lines = self._files[block.path], block.lines
            items = [Item(str(n), text=file.text(n)) for n in sorted(file.statements & lines)]
            group = group_of(statements_name(block.name), Subject.STATEMENTS, items)
            groups.append((group, block.path))
            items = [
                Item(_arc(*arc), text=" → ".join(map(file.text, arc)))
                for arc in (sorted(file.branches) if self._code.branches else ())
                if arc[0] in lines
            ]
            if items:
                group = group_of(branches_name(block.name), Subject.BRANCHES, items)
                groups.append((group, block.path))
        return groups


def code_groups(code: Code) -> list[Group]:
    """The groups to cover: the statements of each block, and its branches if it has any.

    Raises:
        RvmonError: coverage.py is not installed, or a file is not Python.
    """
    return [group for group, _ in Meter(code).groups]


def statements_name(block: str) -> str:
    """The name of the group of a block's statements."""
    return f"statements of {block}"


def branches_name(block: str) -> str:
    """The name of the group of a block's branches."""
    return f"branches of {block}"


class _File:
    """A file as coverage.py sees it: its statements and branches.

    A branch is a pair of lines `(from, to)` whose first line has several possible successors.
    """

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
        """The text of a line; a negative line number is the exit of a function."""
        return self._lines[line - 1].strip() if line > 0 else "exit"

    def branches_of(self, arcs: object) -> set[str]:
        """The names of the branches among the arcs that were executed."""
        gone = self._reporter.translate_arcs(arcs)  # type: ignore[arg-type]  # a set of pairs
        return {_arc(*arc) for arc in gone if arc in self.branches}


def _arc(first: int, last: int) -> str:
    return f"{first} → {last if last > 0 else 'exit'}"


def _paths(code: Code) -> list[str]:
    return list(dict.fromkeys(block.path for block in code.blocks))


def _coverage(code: Code) -> Coverage:
    """A new in-memory measurement that ignores the user's settings."""
    with needed("a campaign that measures code", "coverage"):
        from coverage import Coverage
    paths = _paths(code)
    meter = Coverage(data_file=None, config_file=False, include=paths, branch=code.branches)
    meter.set_option("run:core", "ctrace")  # the newer core knows no contexts
    meter.set_option("run:disable_warnings", ["no-data-collected"])
    return meter


_ARROW = " → "


def measured_groups(campaign: Campaign) -> list[Group]:
    """The groups of states, transitions and code; one for which nothing is declared has no items.

    Raises:
        RvmonError: code is measured, but coverage.py is not installed, or a file is not Python.
    """
    declared = campaign.transitions
    transitions = permutations(campaign.states, 2) if declared is None else declared
    return [
        group_of(STATES, Subject.STATES, [*map(Item, campaign.states)]),
        group_of(
            TRANSITIONS,
            Subject.TRANSITIONS,
            [Item(_ARROW.join(transition)) for transition in transitions],
        ),
        group_of(PAIRS, Subject.TRANSITIONS, [*map(Item, _pairs(declared or ()))]),
        *(code_groups(campaign.code) if campaign.code is not None else ()),
    ]


def _pairs(transitions: Sequence[tuple[str, str]]) -> list[str]:
    """The names of all pairs of transitions that can follow each other."""
    return [
        _ARROW.join((*first, second[1]))
        for first in transitions
        for second in transitions
        if first[1] == second[0]
    ]


def source_and_target(transition: str) -> tuple[str, str]:
    """The states of a transition, from its name."""
    source, _, target = transition.partition(_ARROW)
    return source, target


def hits_of_states(run: Run) -> dict[str, Mapping[str, Hit]]:
    """The hits of states, transitions and pairs of them, each with its count and first instant."""
    names = [state for _, state in run.states]
    hits = {STATES: _counted(run.states)}
    for group, length in ((TRANSITIONS, 2), (PAIRS, 3)):
        hits[group] = _counted(
            (t_ns, _ARROW.join(names[end - length : end]))
            for end, (t_ns, _) in enumerate(run.states, start=1)
            if end >= length
        )
    return {group: items for group, items in hits.items() if items}


def _counted(happened: Iterable[tuple[int, str]]) -> dict[str, Hit]:
    hits: dict[str, Hit] = {}
    for t_ns, name in happened:
        known = hits.get(name)
        hits[name] = Hit(1, t_ns) if known is None else Hit(known.count + 1, known.first)
    return hits


@dataclass(slots=True)
class _Counts:
    """The numbers of tests that ran the lines of a file, and that took its branches."""

    lines: dict[int, int] = field(default_factory=dict)  # tests by line
    ways: dict[int, list[int]] = field(default_factory=dict)  # tests per branch, by line


def lcov(code: Code, model: Model, hits: Hits) -> str:
    """The coverage of the blocks as an LCOV tracefile; its counts are numbers of tests.

    Args:
        code: the measured code.
        model: the coverage model; statements and branches that are not goals are left out.
        hits: the merged hits of all tests.
    """
    lines = []
    for path, file in _counts_by_path(code, model, hits).items():
        lines += ["TN:", f"SF:{path}"]
        for line, ways in file.ways.items():
            ran = file.lines.get(line, 0)
            lines += [
                f"BRDA:{line},0,{number},{taken if ran else '-'}"
                for number, taken in enumerate(ways)
            ]
        branches = [taken for ways in file.ways.values() for taken in ways]
        lines += [f"BRF:{len(branches)}", f"BRH:{sum(map(bool, branches))}"]
        lines += [f"DA:{line},{count}" for line, count in file.lines.items()]
        lines += [f"LF:{len(file.lines)}", f"LH:{sum(map(bool, file.lines.values()))}"]
        lines.append("end_of_record")
    return "\n".join(lines) + "\n"


def cobertura(code: Code, model: Model, hits: Hits) -> str:
    """The same as `lcov`, in the XML format of Cobertura."""
    files = _counts_by_path(code, model, hits)
    root = ET.Element("coverage", _rates([*files.values()], whole=True))
    root.set("version", rvmon.__version__)
    root.set("timestamp", "0")
    ET.SubElement(ET.SubElement(root, "sources"), "source").text = "."
    packages = ET.SubElement(root, "packages")
    package = ET.SubElement(packages, "package", {"name": "."} | _rates([*files.values()]))
    classes = ET.SubElement(package, "classes")
    for path, file in files.items():
        names = {"name": Path(path).stem, "filename": path}
        one = ET.SubElement(classes, "class", names | _rates([file]))
        ET.SubElement(one, "methods")
        lines = ET.SubElement(one, "lines")
        for line, count in file.lines.items():
            about = {"number": str(line), "hits": str(count)}
            if ways := file.ways.get(line):
                taken = sum(map(bool, ways))
                share = f"{100 * taken // len(ways)}% ({taken}/{len(ways)})"
                about |= {"branch": "true", "condition-coverage": share}
            ET.SubElement(lines, "line", about)
    ET.indent(root)
    head = (
        '<?xml version="1.0" ?>\n<!DOCTYPE coverage SYSTEM '
        '"http://cobertura.sourceforge.net/xml/coverage-04.dtd">\n'
    )
    return head + ET.tostring(root, encoding="unicode") + "\n"


def _counts_by_path(code: Code, model: Model, hits: Hits) -> Mapping[str, _Counts]:
    """The counts of each file, by its path relative to the working directory."""
    files: dict[str, _Counts] = {}
    for block in code.blocks:
        path = os.path.relpath(block.path)
        file = files.setdefault(path, _Counts())
        for name, item in model.goals_of(statements_name(block.name)):
            file.lines[int(item)] = count_of(hits, name, item)
        for name, item in model.goals_of(branches_name(block.name)):
            line = int(item.partition(_ARROW)[0])
            file.ways.setdefault(line, []).append(count_of(hits, name, item))
    return {
        path: _Counts(dict(sorted(file.lines.items())), dict(sorted(file.ways.items())))
        for path, file in sorted(files.items())
    }


def _rates(files: Sequence[_Counts], *, whole: bool = False) -> dict[str, str]:
    lines = [count for file in files for count in file.lines.values()]
    branches = [taken for file in files for ways in file.ways.values() for taken in ways]
    rates = {"complexity": "0"}
    for what, word, counts in (("line", "lines", lines), ("branch", "branches", branches)):
        covered = sum(map(bool, counts))
        rates[f"{what}-rate"] = f"{covered / len(counts) if counts else 1:.4g}"
        if whole:
            rates |= {f"{word}-covered": str(covered), f"{word}-valid": str(len(counts))}
    return rates
