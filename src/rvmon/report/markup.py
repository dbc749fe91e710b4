"""Build HTML and SVG as a tree, so that no text of a spec or a trace can become markup."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping
from importlib import resources

from rvmon.diagnostics.shown import shown
from rvmon.report.style import verdict_colours

Child = ET.Element | str | None

_UNIT = re.compile(r"(?<=\d) (?=(s|ns|us|ms|min|h|m|cm|mm)\b)")
"""The space between a number and its unit, where no line should end."""

_UNSAFE_IN_SCRIPT = {"<": r"\u003c", ">": r"\u003e", "&": r"\u0026"}


def e(tag: str, attributes: Mapping[str, object] | None = None, *children: Child) -> ET.Element:
    """An element with its children: elements, texts (escaped when written), `None` for nothing.

    Args:
        tag: of HTML or SVG.
        attributes: by name; `None` and `False` leave one out, `True` writes it without value.
        children: in order.

    >>> to_html(e("p", {"class": "x"}, "a < b ", e("code", None, "c")))
    '<p class="x">a &lt; b <code>c</code></p>'
    """
    element = ET.Element(tag)
    for name, value in (attributes or {}).items():
        if value is not None and value is not False:
            element.set(name, "" if value is True else shown(str(value)))
    extend(element, children)
    return element


def extend(element: ET.Element, children: Iterable[Child]) -> None:
    """Append children to an element."""
    for child in children:
        if child is None:
            continue
        if isinstance(child, ET.Element):
            element.append(child)
            continue
        text = shown(child.expandtabs(4))
        if len(element):
            element[-1].tail = (element[-1].tail or "") + text
        else:
            element.text = (element.text or "") + text


def to_html(element: ET.Element) -> str:
    """The tree as HTML text."""
    return ET.tostring(element, encoding="unicode", method="html")


def page(
    title: str, body: Iterable[Child], *, styles: Iterable[str], scripts: Iterable[str]
) -> str:
    """A whole page that needs nothing but itself.

    Args:
        title: of the window.
        body: its content.
        styles: names of style sheets of this package, put into the page.
        scripts: names of its scripts, put at the page's end.
    """
    head = e(
        "head",
        None,
        e("meta", {"charset": "utf-8"}),
        e("meta", {"name": "viewport", "content": "width=device-width, initial-scale=1"}),
        e("meta", {"name": "color-scheme", "content": "light dark"}),
        e("title", None, title),
        e("style", None, verdict_colours(), *(asset(name) for name in styles)),
    )
    content = e("body", None, *body, *(e("script", None, asset(name)) for name in scripts))
    return "<!DOCTYPE html>\n" + to_html(e("html", {"lang": "en"}, head, content)) + "\n"


def data(identifier: str, value: object) -> ET.Element:
    """Data for a script, as JSON that cannot end the element it stands in.

    Texts and keys in it are those that the page shows and has in its attributes.
    """
    text = json.dumps(_as_shown(value), separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    for character, escape in _UNSAFE_IN_SCRIPT.items():
        text = text.replace(character, escape)
    return e("script", {"type": "application/json", "id": identifier}, text)


def asset(name: str) -> str:
    """The text of a file beside this module's `assets`."""
    return (resources.files("rvmon.report") / "assets" / name).read_text(encoding="utf-8").strip()


def scroll(table: ET.Element) -> ET.Element:
    """A table that is scrolled, by keys too, where it is wider than the page."""
    return e("div", {"class": "scroll", "tabindex": 0, "role": "group"}, table)


def with_code(sentence: str) -> list[Child]:
    """A sentence whose `quoted` words become code.

    >>> to_html(e("p", None, *with_code("saw `x` twice")))
    '<p>saw <code>x</code> twice</p>'
    """
    parts = _UNIT.sub("\N{NO-BREAK SPACE}", sentence).split("`")
    if len(parts) % 2 == 0:  # an odd number of quotes quotes nothing
        return [sentence]
    return [e("code", None, part) if index % 2 else part for index, part in enumerate(parts)]


def _as_shown(value: object) -> object:
    match value:
        case str():
            return shown(value)
        case dict():
            return {shown(key): _as_shown(part) for key, part in value.items()}
        case list() | tuple():
            return [_as_shown(part) for part in value]
        case _:
            return value
