"""Build drawings, in HTML and SVG, as a tree: no text of a spec or a trace can become markup."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping

from rvmon.texts import shown

Child = ET.Element | str | None


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
