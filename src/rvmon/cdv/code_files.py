"""Coverage of the code under test for other tools: LCOV, and Cobertura's XML.

Sources: geninfo(1) of LCOV 2, section FILES; coverage-04.dtd of Cobertura.
"""

from __future__ import annotations

import os
import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import rvmon
from rvmon.cdv.code import Code
from rvmon.cdv.meter import branches_name, statements_name
from rvmon.coverage.hits import Hits, count_of
from rvmon.coverage.model import Model

_ARROW = " → "


@dataclass(slots=True)
class _File:
    """Tests that ran each line, and that went each way on from a line with several."""

    lines: dict[int, int] = field(default_factory=dict)
    ways: dict[int, list[int]] = field(default_factory=dict)


def lcov(code: Code, model: Model, hits: Hits) -> str:
    """The blocks of code as an LCOV tracefile; a count is the number of tests.

    Args:
        code: that was measured.
        model: with its statements and branches; those without a goal are left out.
        hits: of all tests.
    """
    lines = []
    for path, file in _files(code, model, hits).items():
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
    """The same as Cobertura's XML.

    Args:
        code: that was measured.
        model: with its statements and branches; those without a goal are left out.
        hits: of all tests.
    """
    files = _files(code, model, hits)
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


def _files(code: Code, model: Model, hits: Hits) -> Mapping[str, _File]:
    """By path, as people would write it here."""
    files: dict[str, _File] = {}
    for block in code.blocks:
        path = os.path.relpath(block.path)
        file = files.setdefault(path, _File())
        for name, item in model.goals_of(statements_name(block.name)):
            file.lines[int(item)] = count_of(hits, name, item)
        for name, item in model.goals_of(branches_name(block.name)):
            line = int(item.partition(_ARROW)[0])
            file.ways.setdefault(line, []).append(count_of(hits, name, item))
    return {
        path: _File(dict(sorted(file.lines.items())), dict(sorted(file.ways.items())))
        for path, file in sorted(files.items())
    }


def _rates(files: Sequence[_File], *, whole: bool = False) -> dict[str, str]:
    lines = [count for file in files for count in file.lines.values()]
    branches = [taken for file in files for ways in file.ways.values() for taken in ways]
    rates = {"complexity": "0"}
    for what, word, counts in (("line", "lines", lines), ("branch", "branches", branches)):
        covered = sum(map(bool, counts))
        rates[f"{what}-rate"] = f"{covered / len(counts) if counts else 1:.4g}"
        if whole:
            rates |= {f"{word}-covered": str(covered), f"{word}-valid": str(len(counts))}
    return rates
