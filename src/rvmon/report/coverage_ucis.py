"""Coverage as UCIS XML, for coverage tools of hardware verification.

Source: Unified Coverage Interoperability Standard (UCIS), version 1.0, Accellera, 2012, chapter 9.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from datetime import UTC, datetime

from rvmon.coverage import Group, Item, Subject, TestRecord
from rvmon.coverage.holes import cross_parts
from rvmon.language.checked.properties import BinKind
from rvmon.report.coverage_summary import Summary, not_fine
from rvmon.texts import escaped

_CODE = (Subject.STATEMENTS, Subject.BRANCHES)
_TYPES = {BinKind.GOAL: "bins", BinKind.IGNORE: "ignore", BinKind.ILLEGAL: "illegal"}
_OURS = {"ucisVersion": "1.0", "vendorId": "rvmon", "vendorTool": "rvmon"}


def coverage_ucis(summary: Summary, version: str) -> str:
    """Functional coverage as one covergroup, with a coverpoint or cross per group.

    Unreachable items are ignore bins, with the reason. Code coverage is left out: it is in the LCOV
    and Cobertura files.
    """
    now = datetime.now(UTC).isoformat(timespec="seconds")
    root = ET.Element("UCIS", ucisVersion="1.0", writtenBy="rvmon", writtenTime=now)
    ET.SubElement(root, "sourceFiles", fileName=escaped(summary.name), id="1")
    records = [entry.record for entry in summary.coverage.entries]
    # The schema demands at least one history node.
    for number, record in enumerate(records or [TestRecord("no test")]):
        ET.SubElement(root, "historyNodes", _history(number, record, version))
    name = ", ".join(summary.coverage.campaigns) or summary.name
    instance = ET.SubElement(root, "instanceCoverages", name=escaped(name), key="0")
    ET.SubElement(instance, "id", _PLACE)
    covered = ET.SubElement(instance, "covergroupCoverage")
    group = ET.SubElement(covered, "cgInstance", name=escaped(name), key="0")
    ET.SubElement(group, "options")
    place = ET.SubElement(group, "cgId", cgName=escaped(name), moduleName=escaped(name))
    ET.SubElement(place, "cginstSourceId", _PLACE)
    ET.SubElement(place, "cgSourceId", _PLACE)
    functional = [
        group
        for group in summary.coverage.model.groups.values()
        if group.items and group.subject not in _CODE
    ]
    for one in sorted(functional, key=lambda group: bool(group.axes)):  # crosses stand last
        _cross(group, summary, one) if one.axes else _coverpoint(group, summary, one)
    ET.indent(root)
    return ET.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


_PLACE = {"file": "1", "line": "1", "inlineCount": "1"}


def _history(number: int, record: TestRecord, version: str) -> dict[str, str]:
    when = datetime.fromtimestamp((record.when or 0) / 1e9, UTC)
    return {
        "historyNodeId": str(number),
        "logicalName": escaped(record.name),
        **({"physicalName": escaped(record.recording)} if record.recording else {}),
        "kind": "HISTORYNODE_TEST",
        "testStatus": "false" if not_fine(record) else "true",
        "cpuTime": f"{record.seconds:.3f}",
        **({} if record.seed is None else {"seed": str(record.seed)}),
        "date": when.isoformat(timespec="seconds"),
        "toolCategory": "rvmon",
        **_OURS,
        "vendorToolVersion": version,
    }


def _options(parent: ET.Element, group: Group) -> None:
    # UCIS has one goal for all bins of a point. With the greatest, no hole counts as covered.
    goal = str(max(item.goal for item in group.items.values()))
    weight, comment = str(group.weight), escaped(group.title)
    ET.SubElement(parent, "options", weight=weight, at_least=goal, comment=comment)


def _coverpoint(parent: ET.Element, summary: Summary, group: Group) -> None:
    point = ET.SubElement(parent, "coverpoint", name=escaped(group.name), key="0")
    _options(point, group)
    for number, (place, item) in enumerate(summary.places(group)):
        one = ET.SubElement(point, "coverpointBin", _bin(summary, place, item))
        # Our bins are formulas, but the schema demands a range of values: the bin's number.
        values = ET.SubElement(one, "range", {"from": str(number), "to": str(number)})
        _contents(values, summary, place)
        _remarks(one, summary, group, item)


def _cross(parent: ET.Element, summary: Summary, group: Group) -> None:
    cross = ET.SubElement(parent, "cross", name=escaped(group.name), key="0")
    _options(cross, group)
    for axis in group.axes:
        ET.SubElement(cross, "crossExpr").text = escaped(axis)
    axes: Sequence[Sequence[str]] = [*group.axes.values()]
    for place, item in summary.places(group):
        one = ET.SubElement(cross, "crossBin", _bin(summary, place, item))
        for bins, name in zip(axes, cross_parts(item.name), strict=True):
            ET.SubElement(one, "index").text = str(bins.index(name))
        _contents(one, summary, place)
        _remarks(one, summary, group, item)


def _bin(summary: Summary, place: int, item: Item) -> dict[str, str]:
    return {"name": escaped(item.name), "key": "0", "type": _TYPES[summary.kind(place, item)]}


def _contents(parent: ET.Element, summary: Summary, place: int) -> None:
    ET.SubElement(parent, "contents", coverageCount=str(int(summary.totals.counts[place])))


def _remarks(parent: ET.Element, summary: Summary, group: Group, item: Item) -> None:
    why = "; ".join(summary.coverage.unreachable.get((group.name, item.name), ()))
    for key, text in (("text", item.text), ("unreachable", why)):
        if text:
            ET.SubElement(parent, "userAttr", key=key, type="str").text = escaped(text)
