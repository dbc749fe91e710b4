"""Sphinx extension: directives for parts of pages that are generated from the code."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial

import codes
import command_line
import pattern_library
import specification_language
import timeline
from docutils import nodes
from pygments.lexers.data import JsonLexer
from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

_MADE: dict[str, Callable[[], str]] = {
    "codes": codes.codes,
    "grammar": specification_language.grammar,
    "operations": specification_language.operations,
    "windows": specification_language.windows,
    "grammar-of-models": specification_language.model_grammar,
    "patterns": pattern_library.patterns,
    "words": specification_language.reserved_words,
    "commands-rvmon": partial(command_line.commands, "rvmon"),
    "commands-handover": partial(command_line.commands, "handover"),
}


class Made(SphinxDirective):
    """`{made} NAME` inserts the Markdown that the function registered as NAME returns."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """The nodes of the generated Markdown."""
        return self.parse_text_to_nodes(_MADE[self.arguments[0]](), allow_section_headings=True)


class Timeline(SphinxDirective):
    """`{timeline}` shows the specification and recording in its body, and draws the verdicts."""

    has_content = True

    def run(self) -> list[nodes.Node]:
        """The nodes of the text, and of the picture."""
        text = "\n".join(self.content)
        specification, _, table = text.partition("\n---\n")
        source = self.parse_text_to_nodes(f"```rv\n{specification}\n```\n\n```csv\n{table}\n```\n")
        return [*source, nodes.raw("", timeline.timeline(text), format="html")]


def short_names(
    _app: Sphinx, _what: str, _name: str, _of: object, _options: object, *shown: str | None
) -> tuple[str, str | None] | None:
    """Remove modules from the types of a signature, like `autodoc_typehints_format` elsewhere."""
    signature, result = shown
    return (re.sub(r"~(\w+\.)+", "", signature), result) if signature else None


def setup(app: Sphinx) -> dict[str, bool]:
    """Register directive and lexers."""
    app.add_directive("made", Made)
    app.add_directive("timeline", Timeline)
    app.connect("autodoc-process-signature", short_names)
    app.add_lexer("rv", specification_language.SpecificationLexer)
    app.add_lexer("csv", TextLexer)
    app.add_lexer("ta", TextLexer)
    app.add_lexer("jsonl", JsonLexer)
    return {"parallel_read_safe": True}
