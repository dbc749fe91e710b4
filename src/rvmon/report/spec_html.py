"""The lines of a requirement as they stand in the spec, with what failed underlined."""

from __future__ import annotations

import xml.etree.ElementTree as ET

from rvmon.report.markup import Child, e
from rvmon.spec.checked.specification import Requirement
from rvmon.verdict.attempt import Blame


def spec_lines(requirement: Requirement, blame: Blame | None) -> ET.Element | None:
    """The requirement's text with line numbers; `None` if its place is not known."""
    span = requirement.span
    if span is None:
        return None
    text = span.source.text
    first = text.rfind("\n", 0, span.start) + 1
    last = span.start + len(text[span.start : span.end].rstrip())
    block = e("pre", {"class": "spec"})
    position = first
    lines = text[first:last].split("\n")
    for number, line in enumerate(lines, span.line):
        if number == span.line and len(lines) > 1 and line.endswith(f'"{requirement.text}"'):
            position += len(line) + 1  # only id and text, which the page has already
            continue
        content = _marked(line, position, blame)
        gutter = e("span", {"class": "gutter", "aria-hidden": "true"}, f"{number:>3}  ")
        block.append(e("span", {"class": "line"}, gutter, *content))
        position += len(line) + 1
    place = f"{span.source.name}:{span.line}"
    return e("figure", {"class": "source"}, e("figcaption", None, place), block)


def _marked(line: str, position: int, blame: Blame | None) -> list[Child]:
    """A line that starts at `position` of the text, in three parts if it is to blame."""
    if blame is None:
        return [line]
    start = min(max(blame.start - position, 0), len(line))
    end = min(max(blame.end - position, 0), len(line))
    if not line[start:end].strip():
        return [line]
    failed = e("mark", {"title": "this part failed"}, line[start:end])
    return [line[:start], failed, line[end:]]
