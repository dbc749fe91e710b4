"""Names in a specification with their uses and declarations; the words of the language."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cache

from rvmon.diagnostics import Span
from rvmon.language.checked.functions import FUNCTIONS
from rvmon.language.checked.operators import OPERATORS
from rvmon.language.syntax.expressions import Call, Comparison, Group, Ident, Name
from rvmon.language.syntax.items import (
    ConstItem,
    CoverItem,
    CoverpointItem,
    CrossItem,
    Declarations,
    DefineItem,
    EventSyntax,
    ForEachClause,
    Item,
    LetClause,
    ParsedSpec,
    PropertyItem,
    RequirementItem,
    TypeSyntax,
)

_RUNS = "`in at least 95 % of runs`, `in at most 5 % of runs`: single runs are evaluated as usual"
_LINES = {
    ("spec",): '`spec NAME "title"`',
    ("time", "sampled", "every"): "`time held`, `time sampled`, `time sampled every 20 ms`",
    ("max delay",): "`max delay 50 ms`: late samples of a stream are sorted within that time, "
    "those of a file whatever their delay",
    ("import",): '`import "signals.rv"`, relative to the file, within the project',
    ("signal",): "`signal a, b : TYPE ROLE ignore NaN stale after D`",
    ("event",): "`event a, pick(id: int, x: real [m]) ROLE`; a payload field is read as `pick.id`",
    ("define",): "`define near = φ`, `define soon(p, d) = within d p`",
    ("const",): "`const T = 3 s`; `--const T=2s` replaces the value",
    ("requirement",): '`requirement ID "text"`, then its formula, then clauses',
    ("property",): "`property CTL`: for model checking, or for a `monitor as …`",
    ("cover",): "`cover ID = φ`: some run should show φ at some instant",
    ("coverpoint",): "`coverpoint NAME = expression {bin, bin: values, ignore bin: value, "
    "illegal bin: value => value}`",
    ("cross",): "`cross NAME = point, point`",
    ("bool", "int", "real"): "type `bool`, `int`, `real [unit]`, `{label, label}`",
    ("input", "output"): "role `input` (environment) or `output` (system)",
    ("stale after",): "A signal that is `stale after D` is unknown when its last update is longer "
    "ago than D.",
    ("ignore NaN",): "`updated`, `age`, `rate`, `changed` and staleness consider only the known "
    "values.",
    (
        "upon",
        "then",
    ): "`upon θ then ψ`: ψ is required each time θ becomes true; of an event: each time it occurs",
    ("now",): "`now` is the time since the first instant, compared with a duration",
    ("if", "else"): "`if φ then x else y` is a number or a formula",
    ("whenever",): "`whenever θ then ψ`: ψ is required at every instant at which θ holds",
    ("monitor as response",): "`monitor as response within D`: derived from the requirement's "
    "`property E<> (…)`: upon its `input` part, its `output` part is required within D",
    ("monitor as written",): "`monitor as written`: checks the requirement's `property` itself on "
    "every run",
    ("monitor as cover",): "`monitor as cover`: the requirement's `property E<> …` is a goal that "
    "some run should show",
    ("source", "rationale", "severity", "tags"): '`source "…"`, `rationale "…"`, `severity high`, '
    "`tags a, b`: shown in tables",
    ("let",): "`let v = expression`: v is the value at the trigger, for use in the consequent",
    ("for each",): "`for each x in event.field`: one instance of the requirement for each value",
    ("at end",): "`at end: strict`: the policy for attempts that are undecided at the end",
    ("in at least", "in at most", "of runs"): _RUNS,
    ("scope", "before", "after", "between"): "`scope before (r)`, `scope after (q)`, `scope "
    "between (q) and (r)`, `scope after (q) until (r)`",
    ("start", "end"): "`start` is the first instant. `end` can only be a trigger by itself",
    ("within", "for"): "`within D φ`, `for D φ`: `F[0, D]`, `G[0, D]`: φ at some instant, at all "
    "of the next D",
    ("immediately",): "`immediately φ`: φ itself, to state that one instant is meant",
    ("inf",): "`[1 s, inf)` (or `∞`)",
    ("AG", "AF", "AX", "EG", "EF", "EX"): "Properties are CTL: `AG AF AX EG EF EX A[φ U ψ] "
    "E[φ U ψ]`",
    ("goal",): "`goal` the hits that each bin needs (default: 1)",
    ("weight",): "`weight` the weight of a coverpoint or cross in the total",
    ("ignore", "illegal"): "ignored and illegal combinations",
}


@cache
def meanings() -> Mapping[str, str]:
    """A line of explanation for each word and sign of the language."""
    return {
        **{word: line for words, line in _LINES.items() for word in words},
        **{text: f"`{text}`: {op.entry.doc}" for op in OPERATORS for text in op.spellings},
        **{name: f"`{name}(…)`: {function.doc}" for name, function in FUNCTIONS.items()},
    }


@cache
def _word() -> re.Pattern[str]:
    """Matches a word or sign of the language, or a name; consumes comments and texts whole."""
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
    """The word at a place with its explanation, which is empty for what may be a name."""
    text = place.source.text
    first = text.rfind("\n", 0, place.start) + 1
    stop = text.find("\n", place.start)
    for match in _word().finditer(text, first, len(text) if stop < 0 else stop):
        if match.lastgroup and match.start() <= place.start <= match.end():
            word = " ".join(match[0].split())
            return Span(place.source, *match.span()), meanings().get(word, "")
    return None


Use = tuple[Span, Ident]  # the place of a name, and the identifier in its declaration

_GOALS = (RequirementItem, PropertyItem, CoverItem, CoverpointItem, CrossItem)


class Names:
    """The names of a file and of its imports."""

    def __init__(self, files: Sequence[ParsedSpec]) -> None:
        # the declarations of names in formulas; payload fields as `event.field`
        self.declared: dict[str, Ident] = {}
        # the places of requirements, properties and coverage goals
        self.goals: dict[str, Ident] = {}
        self.types: dict[str, TypeSyntax] = {}  # of signals and of payload fields, as written
        self.owners: dict[int, Item] = {}  # the declaring item, by the `id` of the identifier
        self._files = files
        for file in files:
            for item in file.items:
                self._declare(item)

    def _declare(self, item: Item) -> None:
        match item:
            case Declarations(each=each):
                for one in each:
                    self._add(one.name.text, one.name, item)
                    if not isinstance(one, EventSyntax):
                        self.types.setdefault(one.name.text, one.type)
                        continue
                    for field in one.fields:
                        key = f"{one.name.text}.{field.name.text}"
                        self._add(key, field.name, item)
                        self.types.setdefault(key, field.type)
            case DefineItem(name=name) | ConstItem(name=name):
                self._add(name.text, name, item)
            case _ if isinstance(item, _GOALS):
                self.goals.setdefault(item.name.text, item.name)
                self.owners[id(item.name)] = item
            case _:
                pass

    def _add(self, key: str, name: Ident, item: Item) -> None:
        self.declared.setdefault(key, name)
        self.owners[id(name)] = item

    def item_at(self, place: Span) -> Item | None:
        """The item that contains a place or ends there."""
        files = (file for file in self._files if file.source is place.source)
        items = (item for file in files for item in file.items)
        return next((i for i in items if i.span.start <= place.start <= i.span.end), None)

    def at(self, place: Span) -> Use | None:
        """The name that a place touches; `pick.id` is two."""
        item = self.item_at(place)
        if item is None:  # the item cannot be parsed, but names of the file are known
            span, meaning = about_word(place) or (place, "none")
            known = {**self.goals, **self.declared}.get(span.text.strip("`"))
            return (span, known) if known and not meaning else None
        touched = (use for use in self.of(item) if use[0].start <= place.start <= use[0].end)
        return max(touched, key=lambda use: use[0].start, default=None)

    def all(self) -> Iterator[Use]:
        """Every place of a name in all files."""
        for file in self._files:
            for item in file.items:
                yield from self.of(item)

    def of(self, item: Item) -> Iterator[Use]:
        """Every place of a name in an item."""
        nodes = list(_nodes(item))
        local = _own(item)
        labels = {id(name) for node in nodes for name in self._labels(node)}
        places = {id(name) for name in local.values()}
        for node in nodes:
            match node:
                case Ident() if id(node) in places or id(node) in self.owners:
                    yield node.span, node
                case Call(function=function) if function.text in self.declared:
                    yield function.span, self.declared[function.text]
                case CrossItem(points=points):
                    yield from (
                        (p.span, self.goals[p.text]) for p in points if p.text in self.goals
                    )
                case Name(text=text) if text in local:
                    yield node.span, local[text]
                case Name(text=text) if isinstance(item, CrossItem):
                    if text in self.goals:
                        yield node.span, self.goals[text]
                case Name() if id(node) not in labels:
                    yield from self._declared(node)
                case _:
                    pass

    def _declared(self, name: Name) -> Iterator[Use]:
        """The declaration of a name of the file; the name of a field also uses its event."""
        target = self.declared.get(name.text)
        if target is None:
            return
        event = name.text.removesuffix(target.text).removesuffix(".")
        if event in self.declared and name.span.text == name.text:
            source, start, end = name.span.source, name.span.start, name.span.end
            yield Span(source, start, start + len(event)), self.declared[event]
            yield Span(source, end - len(target.text), end), target
        else:
            yield name.span, target

    def _labels(self, node: object) -> Iterator[Name]:
        """Names that are labels, as they are compared with a signal that has them."""
        match node:
            case Comparison(left=left, right=right):
                pairs: list[tuple[object, object]] = [(left, right), (right, left)]
            case CoverpointItem(expression=expression, bins=bins):
                pairs = [(expression, bins)]
            case _:
                return
        for signal, values in pairs:
            type_ = self.types.get(_signal(signal))
            known = {label.text for label in type_.labels} if type_ is not None else set()
            yield from (n for n in _nodes(values) if isinstance(n, Name) and n.text in known)


def _own(item: Item) -> dict[str, Ident]:
    """The local names of an item: parameters, captured values, the value of `for each`."""
    match item:
        case DefineItem(parameters=parameters):
            return {name.text: name for name in parameters or ()}
        case RequirementItem(clauses=clauses):
            names = [c.name for c in clauses if isinstance(c, LetClause | ForEachClause)]
            return {name.text: name for name in names}
        case _:
            return {}


def _signal(expression: object) -> str:
    """The signal whose labels an expression has as values; empty if unknown."""
    match expression:
        case Name(text=text):
            return text
        case Group(inner=inner) | Call(args=(inner,)):
            return _signal(inner)
        case _:
            return ""


def _nodes(whole: object) -> Iterator[object]:
    """All nodes of a syntax tree, in the order of the text."""
    waiting = [whole]
    while waiting:
        node = waiting.pop()
        if isinstance(node, tuple):
            waiting += reversed(node)
        elif not isinstance(node, Span):
            names: tuple[str, ...] | None = getattr(type(node), "__match_args__", None)
            if names is not None:
                yield node
                waiting += [getattr(node, name) for name in reversed(names)]
