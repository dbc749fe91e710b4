"""The page of one run: what failed, why, when, and how to see it again."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence

from rvmon.report.choose import opening
from rvmon.report.headline import headline
from rvmon.report.markup import Child, data, e, page
from rvmon.report.panel import Panel
from rvmon.report.panel_html import panel_section
from rvmon.report.panels_of import panel_id, panels_of
from rvmon.report.run_data import script_data
from rvmon.report.run_page import RunPage
from rvmon.report.scene_html import scene_svg
from rvmon.report.style import MARKS
from rvmon.verdict.verdict import Verdict


def run_page(content: RunPage) -> str:
    """Write the page of a run.

    Without a script it shows all attempts one below the other; the script shows one at a time,
    moves the cursor and plays the scene. An address that ends in `#R2` opens on requirement R2.
    """
    panels = panels_of(content)
    requirement, attempt = opening(content.run.report)
    first = next(panel for panel in panels if panel.id == panel_id(requirement, attempt))
    sections = [panel_section(panel, panels, content) for panel in panels]
    sentence = headline(content.run.name, first, content.run.report.origin)
    body = (
        _navigation(content, panels),
        e("main", {"data-open": first.id}, *sections, _aside(content, first)),
        data("run", script_data(content, panels)),
    )
    return page(sentence.replace("`", ""), body, styles=["base.css", "run.css"], scripts=["run.js"])


def _navigation(content: RunPage, panels: Sequence[Panel]) -> ET.Element:
    """A letter and a sign per requirement, each leading to its worst attempt."""
    links: list[Child] = []
    if content.back:
        links.append(e("a", {"class": "back", "href": content.back}, "← all tests"))
    order = (Verdict.FAIL, Verdict.INCONCLUSIVE, Verdict.PASS)
    for name, verdict in content.run.report.verdicts.items():
        own = [panel for panel in panels if panel.requirement == name]
        worst = min(own, key=lambda panel: order.index(panel.verdict) if panel.attempt else 0)
        links.append(
            e(
                "a",
                {"class": "chip", "href": f"#{worst.id}", "data-verdict": verdict.value},
                e("b", None, name),
                f" {verdict.value} {MARKS[verdict].sign}",
            )
        )
    return e("nav", {"aria-label": "requirements"}, *links)


def _aside(content: RunPage, first: Panel) -> ET.Element:
    parts: list[Child] = []
    if content.scene is not None:
        parts.append(e("figure", {"class": "scene"}, scene_svg(content.scene, first.instant)))
    parts.append(
        e(
            "div",
            {"class": "command"},
            e("span", None, "see it again"),
            e("code", {"id": "command"}, *_words(content.command)),
            e("button", {"type": "button", "class": "copy"}, "copy"),
        )
    )
    facts: list[Child] = []
    for name, value in content.facts:
        facts += [e("dt", None, name), e("dd", None, value)]
    if facts:
        parts.append(e("dl", {"class": "facts"}, *facts))
    parts.append(_health(content))
    return e("aside", None, *parts)


def _words(command: str) -> list[Child]:
    """A command that breaks anywhere but within an option."""
    words: list[Child] = []
    for word in command.split(" "):
        words += [e("span", None, word) if word.startswith("-") else word, " "]
    return words[:-1]


def _health(content: RunPage) -> ET.Element | None:
    findings = []
    for one in content.run.report.health:
        times = "" if one.count == 1 else f", {one.count} times"
        remark = f": {one.remark}" if one.remark else ""
        findings.append(
            e("li", None, e("code", None, one.name), f" {one.kind.value}{times}{remark}")
        )
    findings += [e("li", None, str(one)) for one in content.run.report.illegal]
    if not findings:
        return None
    return e("div", {"class": "health"}, e("h2", None, "Input health"), e("ul", None, *findings))
