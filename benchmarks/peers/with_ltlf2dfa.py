"""ltlf2dfa: LTL on finite traces as a minimal automaton, by MONA."""

from __future__ import annotations

import re
from typing import Any

from ltlf2dfa.ltlf2dfa import to_dfa
from ltlf2dfa.parser.ltlf import LTLfParser


class Peer:
    """Answers requests by running words through MONA's automaton."""

    def accepts(self, formula: str, words: list[list[list[str]]]) -> dict[str, Any]:
        """Whether each word is a model; a word is the names that are true, position by position."""
        text = to_dfa(LTLfParser()(formula), mona_dfa_out=True)
        if not text:
            raise TimeoutError("mona took more than 30 s")
        automaton = _Automaton(text)
        return {"accepted": [automaton.accepts(word) for word in words], "states": automaton.size}


class _Automaton:
    """MONA's table: per state the guards in the order of its free variables, `X` for either."""

    def __init__(self, text: str) -> None:
        self.accepting: set[int] = set()
        self.names: list[str] = []
        self.edges: dict[int, list[tuple[str, int]]] = {}
        self.size = 1
        self.constant: bool | None = None
        if "Formula is unsatisfiable" in text:
            self.constant = False
            return
        if "Formula is valid" in text:
            self.constant = True
            return
        names = re.search(r"free variables:([^\n]*)\n", text)
        accepting = re.search(r"Accepting states:([^\n]*)\n", text)
        if names is None or accepting is None:
            raise ValueError(f"mona said: {text[:200]}")
        self.names = names.group(1).lower().split()
        self.accepting = {int(state) for state in accepting.group(1).split()}
        for state, guard, target in re.findall(r"State (\d+): (\S*) *-> state (\d+)", text):
            self.edges.setdefault(int(state), []).append((guard, int(target)))
        self.size = len(self.edges)

    def accepts(self, word: list[list[str]]) -> bool:
        """Run the word; state 0 is MONA's own beginning, 1 the automaton's."""
        if self.constant is not None:
            return self.constant
        state = 1
        for letter in word:
            bits = ["1" if name in letter else "0" for name in self.names]
            state = next(
                target
                for guard, target in self.edges[state]
                if all(wanted in ("X", bit) for wanted, bit in zip(guard, bits, strict=True))
            )
        return state in self.accepting
