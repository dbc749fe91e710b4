"""All mistakes of a text that cannot be read: parts that have one are left out in turn."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

from rvmon.diagnostics import Diagnostic, Span
from rvmon.errors import ModelError

Place = Callable[[int, int], Span]
"""From the characters `[start, end)` of a text to their line and column in the file."""

MOST = 20
"""Behind so many, nothing more is looked for: the text is read again for each."""

LONGEST = 100_000
"""In a longer text only the first mistake is reported, as each further one needs another parse."""

_FIRM = "automaton|(?:(?:urgent|committed)[ \t]+)?location|edge|start|query|signal|unit|system"
_LOOSE = "clock|broadcast|urgent|chan|int|bool|const|meta|struct|typedef|void"
_DECLARED = (
    r'//[^\n]*|/\*.*?\*/|"[^"\n]*"|(?P<open>[{(\[])|(?P<close>[})\]])|(?P<end>;)'
    rf"|^[ \t]*(?P<loose>{_LOOSE})\b"
)
_TOKENS = {
    rule: re.compile(pattern, re.MULTILINE | re.DOTALL)
    for rule, pattern in (
        ("declarations", _DECLARED),
        ("system", _DECLARED),
        ("document", rf"{_DECLARED}|^[ \t]*(?P<firm>{_FIRM})\b"),
    )
}
"""The patterns at which parts begin and end, by the rule that reads them; others read one part."""


def all_mistakes(
    text: str, rule: str, place: Place, read: Callable[[str, Place], object]
) -> tuple[Diagnostic, ...]:
    """The mistakes that are found when each part with one is left out in turn.

    Args:
        text: the text that could not be read.
        rule: of the grammar, that should have read it.
        place: maps offsets of the text to spans.
        read: raises `ModelError` for the first mistake of a text.
    """
    starts = dict[int, int]()

    def noted(start: int, end: int) -> Span:
        span = place(start, end)
        starts[span.start] = start
        return span

    def first_mistake(text: str) -> ModelError | None:
        try:
            read(text, noted)
        except ModelError as error:
            return error
        return None

    def offset(error: ModelError) -> int:
        spans = error.diagnostics[0].spans
        return starts.get(spans[0].span.start, -1) if spans else -1

    found, error = list[Diagnostic](), first_mistake(text)
    while error is not None:
        found += error.diagnostics
        at, rest, error = offset(error), text, None
        if len(found) >= MOST or len(text) > LONGEST:
            break
        # A part that is cut short shows only behind it, as a word that begins a part is a name too:
        # without the part that is wrong, reading goes on farthest.
        farthest = at
        for start, end in [part for part in _parts(text, rule) if part[0] <= at][-4:]:
            left = text[:start] + re.sub(r"\S", " ", text[start:end]) + text[end:]
            following = first_mistake(left)
            reached = len(text) if following is None else offset(following)
            if reached > farthest:
                farthest, rest, error = reached, left, following
                if following is None:
                    break
        text = rest
    return tuple(found)


def _parts(text: str, rule: str) -> Iterator[tuple[int, int]]:
    """Parts that can be left out, and the rest is still a text: declarations, edges, queries."""
    if rule not in _TOKENS:
        return
    begun, word, is_body, brackets = 0, "", False, list[str]()
    for token in _TOKENS[rule].finditer(text):
        kind = token.lastgroup
        if kind == "end" and "{" not in brackets:
            brackets.clear()  # they were never closed
        while brackets[-1:] == ["["] and (kind == "loose" or token[0] in ("{", "}", ")")):
            brackets.pop()
        match kind:
            case "firm" | "loose" if kind == "firm" or not brackets:
                if word != "automaton":
                    yield begun, token.start()
                begun, word = token.start(), token[kind]
                brackets.clear()
            case "open" if word == "automaton" and token[0] == "{":
                begun, word = token.end(), ""
                brackets.clear()
            case "open":
                if not brackets:
                    is_body = token[0] == "{" and text[: token.start()].rstrip().endswith(")")
                brackets.append(token[0])
            case "close" if brackets:
                brackets.pop()
                if not brackets and is_body and token[0] == "}":
                    yield begun, token.end()
                    begun, word = token.end(), ""
            case "close" if token[0] == "}" and rule == "document":  # of an automaton
                yield begun, token.start()
                begun, word = token.end(), ""
            case "end" if not brackets:
                if word != "automaton":
                    yield begun, token.end()
                begun, word = token.end(), ""
            case _:
                pass
    yield begun, len(text)
