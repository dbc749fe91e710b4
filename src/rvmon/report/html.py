"""HTML pages from templates; all text is escaped, and control characters in it are made visible.

Drawings have computed attributes, so they are built element by element (`e`) and inserted as they
are.
"""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable, Mapping
from functools import cache
from importlib import resources
from typing import TYPE_CHECKING

from markupsafe import Markup

from rvmon.confidence import interval_text
from rvmon.report.verdict_table import VerdictTable, checked_text
from rvmon.report.wording import MARKS, verdict_colours
from rvmon.texts import counted, escaped, percent_text, share_text
from rvmon.verdicts import Verdict

if TYPE_CHECKING:
    from jinja2 import Environment


Child = ET.Element | str | None


def e(tag: str, attributes: Mapping[str, object] | None = None, *children: Child) -> ET.Element:
    """An element with its children: elements, texts (escaped when written), `None` for nothing.

    Attributes that are `None` or `False` are left out, `True` is written without value.

    >>> to_html(e("p", {"class": "x"}, "a < b ", e("code", None, "c")))
    '<p class="x">a &lt; b <code>c</code></p>'
    """
    element = ET.Element(tag)
    for name, value in (attributes or {}).items():
        if value is not None and value is not False:
            element.set(name, "" if value is True else escaped(str(value)))
    for child in children:
        if isinstance(child, ET.Element):
            element.append(child)
        elif child is not None and len(element):
            element[-1].tail = (element[-1].tail or "") + escaped(child.expandtabs(4))
        elif child is not None:
            element.text = (element.text or "") + escaped(child.expandtabs(4))
    return element


def to_html(element: ET.Element) -> str:
    """The tree as HTML text."""
    return ET.tostring(element, encoding="unicode", method="html")


_UNIT = re.compile(r"(?<=\d) (?=(s|ns|us|ms|min|h|m|cm|mm)\b)")
"""The space between a number and its unit, at which a line must not break."""


def render(name: str, **values: object) -> str:
    """Fill in a template of this package."""
    return _environment().get_template(name).render(**values)


def component(name: str, *values: object, **options: object) -> Markup:
    """The output of one macro of `components.html`, to show a fragment of a page alone."""
    macro = getattr(_environment().get_template("components.html").module, name)
    return Markup(macro(*values, **options))  # noqa: S704 - a template escapes


def asset(name: str) -> Markup:
    """The text of a style sheet or script, to be inlined in a self-contained page."""
    path = resources.files("rvmon.report") / "assets" / name
    return Markup(path.read_text(encoding="utf-8").strip())  # noqa: S704 - our own


def with_code(sentence: str) -> Markup:
    """A sentence whose `quoted` words become code.

    >>> with_code("saw `x < 1` twice")
    Markup('saw <code>x &lt; 1</code> twice')
    """
    parts = _UNIT.sub("\N{NO-BREAK SPACE}", escaped(sentence.expandtabs(4))).split("`")
    if len(parts) % 2 == 0:  # an odd number of quotes quotes nothing
        return Markup.escape(escaped(sentence))
    code = Markup("<code>{}</code>").format
    return Markup().join(code(part) if index % 2 else part for index, part in enumerate(parts))


def data(value: object) -> Markup:
    r"""Data for a script, as JSON that cannot close the enclosing element.

    Control characters in strings are made visible as in the page's text, so that both are equal.

    >>> data({"</script>": 1})
    Markup('{"\\u003c/script\\u003e":1}')
    """
    text = json.dumps(_as_shown(value), separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return Markup(text)  # noqa: S704 - without the signs of markup


@cache
def _environment() -> Environment:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("rvmon.report"),
        autoescape=True,
        # A misspelt name in a template fails instead of writing nothing.
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=_finished,
    )
    environment.filters.update(
        code=with_code, counted=counted, data=data, grouped="{:,}".format, share=share_text
    )
    environment.globals.update(
        asset=asset, colours=verdict_colours, marks=MARKS, percent=percent_text, verdicts=[*Verdict]
    )
    return environment


def _finished(value: object) -> object:
    """The output of a template expression."""
    if isinstance(value, ET.Element):
        return Markup(to_html(value))  # noqa: S704 - escaped as it is written
    if value is None or isinstance(value, Markup):
        return value or ""
    return escaped(str(value))


def _as_shown(value: object) -> object:
    match value:
        case str():
            return escaped(value)
        case dict():
            return {escaped(key): _as_shown(part) for key, part in value.items()}
        case list() | tuple():
            return [_as_shown(part) for part in value]
        case _:
            return value


Link = Callable[[str, str, Verdict], str | None]
"""Returns the address of an example, given group, requirement and verdict; or `None`."""


def table_html(
    table: VerdictTable,
    *,
    further: Mapping[str, VerdictTable] | None = None,
    link: Link | None = None,
    witnesses: Mapping[str, str] | None = None,
) -> Markup:
    """A table of counts as HTML, with a line per requirement.

    Args:
        table: the counts.
        further: tables by label, whose counts are added as further lines of each requirement.
        link: gives the link of a count.
        witnesses: addresses of runs found by model checking, by requirement.
    """
    others = further or {}
    text = render(
        "counts.html",
        table=table,
        others=others,
        link=link,
        witnesses=witnesses or {},
        has_checked=any(verdict_table.checked for verdict_table in (table, *others.values())),
        checked_text=checked_text,
        interval_text=interval_text,
    )
    return Markup(text)  # noqa: S704 - a template escapes
