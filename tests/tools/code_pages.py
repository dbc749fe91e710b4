"""The pages of diagnostic codes, taken apart: an example, what is said of it, the same fixed."""

import re
from dataclasses import dataclass

from rvmon.analysis.diagnostic_codes import every_page

_FORM = re.compile(
    r"# (?P<code>\w+) (?P<name>[\w-]+)\n\n\*(?P<severity>\w+)\* · (?P<what>[^\n]+(?:\n[^\n]+)*)\n\n"
    r"(?P<why>[^\n]+(?:\n[^\n]+)*)\n\n## Example\n\n```(?:rv|ta)\n(?P<example>.*?)```\n\n"
    r"```text\n(?P<message>.*?)\n```\n\n## Instead\n\n```(?:rv|ta)\n(?P<instead>.*?)```\n",
    re.DOTALL,
)


@dataclass(frozen=True)
class Page:
    """The page of a code; `text` is all of it."""

    text: str
    code: str
    name: str
    severity: str
    what: str
    why: str
    example: str
    message: str
    instead: str


def page(code: str) -> Page:
    """The page of a code; an assertion says that it has another form."""
    text = every_page()[code]
    found = _FORM.fullmatch(text)
    assert found, f"the page of {code} has not the form of its neighbours"
    parts = found.groupdict()
    parts |= {name: parts[name].removeprefix("\n") for name in ("example", "instead")}
    return Page(text, **parts)
