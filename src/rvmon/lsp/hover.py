"""What a word of a specification means, as Markdown."""

from __future__ import annotations

from rvmon.diagnostics.span import Span
from rvmon.explain.words import requirement_in_words
from rvmon.lsp.keywords import about_word
from rvmon.lsp.names import Names, own_names
from rvmon.spec.checked.specification import CheckedSpec, Role
from rvmon.spec.syntax.expressions import Ident
from rvmon.spec.syntax.items import DefineItem, EventItem, Item, RequirementItem, SignalItem

_SETS = {Role.INPUT: "Set by the environment.", Role.OUTPUT: "Set by the system."}


def hover(names: Names, checked: CheckedSpec | None, place: Span) -> tuple[Span, str] | None:
    """The word at a place and what it means; `None` if that is nothing."""
    if found := names.at(place):
        span, target = found
        return span, about_name(names, checked, target)
    word = about_word(place)
    return word if word and word[1] else None


def about_name(names: Names, checked: CheckedSpec | None, name: Ident) -> str:
    """A declaration with what can be said about it."""
    item = names.item_at(name.span)
    match item:
        case SignalItem():
            return _fenced(_signal(item, name)) + _about_signal(item)
        case EventItem():
            return _fenced(_event(item, name)) + (_SETS[item.role] if item.role else "")
        case DefineItem() if name.text in own_names(item) and name is not item.name:
            return f"A parameter of `{item.name.text}`."
        case RequirementItem() if name is item.name:
            return _requirement(item, checked)
        case _:
            return _fenced(_declaring(item, name) if item else name.text)


def _signal(item: SignalItem, name: Ident) -> str:
    role = f"  {item.role}" if item.role else ""
    return f"signal {name.span.text} : {item.type.span.text}{role}"


def _about_signal(item: SignalItem) -> str:
    said = [_SETS[item.role]] if item.role else []
    if item.ignored is not None:
        said.append("NaN and null are no update of it.")
    if item.stale_after is not None:
        said.append(f"Unknown {item.stale_after.span.text} after its last update.")
    return " ".join(said)


def _event(item: EventItem, name: Ident) -> str:
    role = f"  {item.role}" if item.role else ""
    for event in item.events:
        written = [f"{field.name.span.text}: {field.type.span.text}" for field in event.fields]
        if name is event.name:
            payload = f"({', '.join(written)})" if written else ""
            return f"event {name.span.text}{payload}{role}"
        for field, text in zip(event.fields, written, strict=True):
            if name is field.name:
                return f"{event.name.span.text}.{text}{role}"
    return name.text


def _requirement(item: RequirementItem, checked: CheckedSpec | None) -> str:
    known = checked.requirements.get(item.name.text) if checked else None
    if known is None:
        return _fenced(item.span.text)
    parts = [f"**{known.id}** {known.text}", "  \n".join(requirement_in_words(known))]
    told = {"source": known.source, "rationale": known.rationale, "severity": known.severity}
    parts += [f"*{word}*: {text}" for word, text in told.items() if text]
    return "\n\n".join(parts)


def _declaring(item: Item, name: Ident) -> str:
    """The part of an item that declares a name: a clause, or all of it."""
    clauses = item.clauses if isinstance(item, RequirementItem) else ()
    spans = (clause.span for clause in clauses)
    inside = (s for s in spans if s.start <= name.span.start < s.end)
    return next(inside, item.span).text


def _fenced(text: str) -> str:
    return f"```rv\n{text}\n```\n"
