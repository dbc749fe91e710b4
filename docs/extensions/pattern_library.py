"""The pattern library as Markdown: meaning, formula, and runs with verdicts of each pattern."""

from __future__ import annotations

import re
from collections.abc import Iterator
from importlib import resources

_PATTERN = re.compile(
    r"^# (?P<title>[^\n:]+): (?P<says>[^\n]+?)(?:  |\n# )(?P<logic>[A-Z]+: [^\n]+)\n"
    r"(?P<runs>(?:#[^\n]*\n)+)(?P<define>define [^\n]+(?:\n  [^\n]+)*)",
    re.MULTILINE,
)
_RUN = re.compile(r"\b(P|F|NT|I) (everywhere|before r|after q until r|after q|between q r):\s*")


def patterns() -> str:
    """All patterns, in the order of their files."""
    files = resources.files("rvmon.language") / "patterns"
    texts = [(files / f"{name}.rv").read_text("utf-8") for name in _FILES]
    count = sum(text.count("\ndefine ") for text in texts)
    shown = [line for text in texts for line in _family(text)]
    found = sum(line.startswith("### ") for line in shown)
    if found != count:
        raise ValueError(f"{found} of {count} patterns are in the form that this page is made of")
    return "\n".join(shown)


_FILES = ("occurrence", "order", "real_time")


def _family(text: str) -> Iterator[str]:
    head = re.match(r"# (.+)\.\n#\n# Source: ((?:.+\n# )*?.+?)\.\s", text)
    if head is None:
        raise ValueError("a file of patterns begins with what it holds and its source")
    yield f"## {head[1]}\n"
    for found in _PATTERN.finditer(text):
        yield f"### {found['title']}\n"
        yield f"{found['says']} `{found['logic']}`\n"
        yield f"```rv\n{found['define']}\n```\n"
        yield "| scope | runs, a word per second, with their verdicts |\n|---|---|"
        runs = _RUN.split(found["runs"].replace("#", " "))[1:]
        by_scope: dict[str, list[str]] = {}
        for verdict, scope, run in zip(runs[::3], runs[1::3], runs[2::3], strict=True):
            by_scope.setdefault(scope, []).append(f"**{verdict}** `{' '.join(run.split())}`")
        yield from (f"| {scope} | {', '.join(shown)} |" for scope, shown in by_scope.items())
        yield ""
