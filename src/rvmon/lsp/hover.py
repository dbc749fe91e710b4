"""What a word of a specification means, as Markdown."""

from __future__ import annotations

from rvmon.diagnostics.span import Span
from rvmon.explain.words import requirement_in_words
from rvmon.lsp.keywords import about_word
from rvmon.lsp.names import Names
from rvmon.spec.checked.specification import CheckedSpec
from rvmon.spec.syntax.expressions import Ident
from rvmon.spec.syntax.items import RequirementItem


def hover(names: Names, checked: CheckedSpec | None, place: Span) -> tuple[Span, str] | None:
    """The word at a place and what it means; `None` if that is nothing."""
    if found := names.at(place):
        return found[0], _about(names, checked, found[1])
    word = about_word(place)
    return word if word and word[1] else None


def _about(names: Names, checked: CheckedSpec | None, name: Ident) -> str:
    """A requirement in words; of all else how it is declared: type, unit, role, staleness."""
    item = names.item_at(name.span)
    own = checked.requirements.get(name.text) if checked else None
    if own is not None and isinstance(item, RequirementItem) and name is item.name:
        kept = {"source": own.source, "rationale": own.rationale, "severity": own.severity}
        clauses = [f"*{word}*: {text}" for word, text in kept.items() if text]
        words = "  \n".join(requirement_in_words(own))
        return "\n\n".join([f"**{own.id}** {own.text}", words, *clauses])
    clauses_ = item.clauses if isinstance(item, RequirementItem) else ()
    spans = (clause.span for clause in clauses_)
    whole = item.span if item else name.span
    declaring = next((s for s in spans if s.start <= name.span.start < s.end), whole)
    return f"```rv\n{declaring.text}\n```"
