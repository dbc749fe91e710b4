"""The words of the language, a line on each from its reference."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache

from rvmon.diagnostics.span import Span
from rvmon.spec.checked.functions import FUNCTIONS
from rvmon.spec.checked.operators import OPERATORS

_RUNS = "`in at least 95 % of runs`, `in at most 5 % of runs`: single runs are judged as always"
_LINES = {
    ("spec",): '`spec NAME "title"`',
    ("time", "sampled", "every"): "`time held`, `time sampled`, `time sampled every 20 ms`",
    ("max delay",): "`max delay 50 ms`: late samples are put in order within that time",
    ("import",): '`import "signals.rv"`, relative to the file, within the project',
    ("signal",): "`signal a, b : TYPE ROLE ignore NaN stale after D`",
    ("event",): "`event a, pick(id: int, x: real [m]) ROLE`; a payload field is read as `pick.id`",
    ("define",): "`define near = φ`, `define soon(p, d) = within d p`",
    ("const",): "`const T = 3 s`; `--const T=2s` replaces the value",
    ("requirement",): '`requirement ID "text"`, then what is demanded, then clauses',
    ("property",): "`property CTL`: for model checking, or for a `monitor as …`",
    ("cover",): "`cover ID = φ`: some run should show φ at some instant",
    ("coverpoint",): "`coverpoint NAME = expression {bin, bin: values, ignore bin: value, "
    "illegal bin: value => value}`",
    ("cross",): "`cross NAME = point, point`",
    ("bool", "int", "real"): "type `bool`, `int`, `real [unit]`, `{label, label}`",
    ("input", "output"): "role `input` (environment) or `output` (system)",
    ("stale after",): "A signal that is `stale after D` is unknown when its last update is longer "
    "ago than D.",
    ("ignore NaN",): "`updated`, `age`, `rate`, `changed` and staleness go by the good values "
    "alone.",
    (
        "upon",
        "then",
    ): "`upon θ then ψ`: ψ is owed each time θ becomes true; if θ is an event, each time it occurs",
    ("whenever",): "`whenever θ then ψ`: ψ is owed at every instant at which θ holds",
    ("monitor as response",): "`monitor as response within D`: derived from the requirement's "
    "`property E<> (…)`: upon its `input` part, its `output` part is owed within D",
    ("monitor as written",): "`monitor as written`: the requirement's `property` itself, on every "
    "run",
    ("source", "rationale", "severity", "tags"): '`source "…"`, `rationale "…"`, `severity high`, '
    "`tags a, b`: kept and shown",
    ("let",): "`let v = expression`: the value at the trigger, for the consequent",
    ("for each",): "`for each x in event.field`: one instance of the requirement for each value",
    ("at end",): "`at end: strict`: what becomes of an attempt that is undecided at the end",
    ("in at least", "in at most", "of runs"): _RUNS,
    ("scope", "before", "after", "between"): "`scope before (r)`, `scope after (q)`, `scope "
    "between (q) and (r)`, `scope after (q) until (r)`",
    ("start", "end"): "`start` is the first instant; `end` stands alone as a trigger",
    ("within", "for"): "`within D φ`, `for D φ`: `F[0, D]`, `G[0, D]`: φ at some instant, at all "
    "of the next D",
    ("immediately",): "`immediately φ`: φ itself, said on purpose",
    ("inf",): "`[1 s, inf)` (or `∞`)",
    ("AG", "AF", "AX", "EG", "EF", "EX"): "Properties are CTL: `AG AF AX EG EF EX A[φ U ψ] "
    "E[φ U ψ]`",
    ("goal",): "`goal` how often each has to be hit (default: once)",
    ("weight",): "`weight` how much a coverpoint or cross counts in the total beside others",
    ("ignore", "illegal"): "what it ignores and what must not occur",
}


@cache
def meanings() -> Mapping[str, str]:
    """A line on each word and sign."""
    return {
        **{word: line for words, line in _LINES.items() for word in words},
        **{text: f"`{text}`: {op.entry.doc}" for op in OPERATORS for text in op.spellings},
        **{name: f"`{name}(…)`: {function.doc}" for name, function in FUNCTIONS.items()},
    }


@cache
def _word() -> re.Pattern[str]:
    """A word or sign of the language, else a name; comments and texts are passed over whole."""
    longest = sorted(meanings(), key=len, reverse=True)
    words = "|".join(
        re.escape(one).replace(r"\ ", r"[ \t]+") for one in longest if one[0].isalpha()
    )
    signs = "|".join(re.escape(one) for one in longest if not one[0].isalpha())
    return re.compile(
        rf'#.*|"(?:[^"\\\n]|\\.)*"|\d[\w.]*[ \t]*\w*|(?P<known>(?:{words})(?![\w.])|{signs})|'
        r"(?P<name>[^\W\d]\w*(?:\.\w+)*|`[^`\n]+`)|-->"
    )


def about_word(place: Span) -> tuple[Span, str] | None:
    """The word at a place, and the line on it; of what may be a name the line is empty."""
    text = place.source.text
    first = text.rfind("\n", 0, place.start) + 1
    stop = text.find("\n", place.start)
    for found in _word().finditer(text, first, len(text) if stop < 0 else stop):
        if found.lastgroup and found.start() <= place.start <= found.end():
            word = " ".join(found[0].split())
            return Span(place.source, *found.span()), meanings().get(word, "")
    return None
