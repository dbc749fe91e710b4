"""Convert a `.lark` grammar to EBNF in the notation of the W3C."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from lark import Lark, Token, Tree

_LOOKAHEAD = re.compile(
    r"@END@|\(\?[!=](?:\\.|\[[^\]]*\]|[^()\[\\]|\([^()]*\))*\)",
)
_PLAIN = re.compile(
    r"(?P<word>[^\W\d_]+)|(?P<space>\\s\+)|(?P<group>[()|])|(?P<sign>(?:[-<>=!&^∞]|\\[|*])+)"
)


def productions(text: str) -> Iterator[tuple[str, str]]:
    """Each production's name, and its right side with every alternative on a line.

    A terminal that is one word or sign stands where it is used; the others are productions.

    Args:
        text: a grammar of Lark.
    """
    meta = Lark.open_from_package(
        "lark", "lark.lark", ["grammars"], parser="lalr", maybe_placeholders=False
    )
    items = [item for item in meta.parse(f"{text}\n").children if isinstance(item, Tree)]
    names = [str(item.children[0]) for item in items if item.data in ("rule", "token")]
    shown = {name: _shown(name, names) for name in names}
    terminals = {
        str(item.children[0]): _alternatives(item.children[-1], {})
        for item in items
        if item.data == "token"
    }
    single = re.compile(r"'[^']*'( '[^']*')*")
    shown |= {name: right for name, right in terminals.items() if single.fullmatch(right)}
    for item in items:
        if item.data == "rule":
            yield shown[str(item.children[0])], _alternatives(item.children[-1], shown)
    for name, right in terminals.items():
        if not shown[name].startswith("'"):
            yield shown[name], right


def _shown(name: str, names: list[str]) -> str:
    """The name without the prefixes with which Lark builds trees, if the result is unique."""
    plain = name.strip("?!").removeprefix("_")
    return name if plain != name and plain in names else plain


def _alternatives(node: Any, shown: Mapping[str, str]) -> str:
    if isinstance(node, Tree) and node.data == "expansions":
        return "\n| ".join(_text(child, shown) for child in node.children)
    return _text(node, shown)


def _text(node: Tree[Token], shown: Mapping[str, str]) -> str:
    """A part of a right side, on one line."""
    parts = [_text(child, shown) for child in node.children if isinstance(child, Tree)]
    match node.data:
        case "alias":
            return parts[0]
        case "expansions":
            return f"({' | '.join(parts)})"
        case "expansion":
            return " ".join(parts)
        case "maybe":
            return _repeated(parts[0], "?")
        case "expr":
            return _repeated(parts[0], str(node.children[1]))
        case "name":
            name = str(node.children[0])
            return shown.get(name, name)
        case "literal":
            return _literal(str(node.children[0]))
    raise ValueError(f"EBNF of `{node.data}` in a grammar of Lark is not known")


def _repeated(inner: str, sign: str) -> str:
    single = re.fullmatch(r"\w+|'[^']*'|\([^()]*\)", inner)
    return f"{inner}{sign}" if single else f"({inner}){sign}"


def _literal(text: str) -> str:
    """Words and signs in quotes; any other regular expression unchanged."""
    if text.startswith('"'):
        return f"'{text[1:-1]}'"
    pattern = _LOOKAHEAD.sub("", text[1:-1])
    pattern = re.sub(r"^\(([^()]*)\)$", r"\1", pattern)
    written = []
    place = 0
    while place < len(pattern):
        found = _PLAIN.match(pattern, place)
        if found is None:
            return f"/{pattern}/"
        place = found.end()
        match found.lastgroup:
            case "word" | "sign":
                written.append("'" + found[0].replace("\\", "") + "'")
            case "group":
                written.append(found[0])
    return " ".join(written).replace("( ", "(").replace(" )", ")")
