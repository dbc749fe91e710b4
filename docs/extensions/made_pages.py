"""What Sphinx asks of this folder: parts of pages that are made from the code at each build."""

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
    """`{made} NAME`: Markdown that the function of that name writes."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """The nodes of that Markdown."""
        return self.parse_text_to_nodes(_MADE[self.arguments[0]](), allow_section_headings=True)


class Timeline(SphinxDirective):
    """`{timeline}` draws the specification and the recording within it, and shows both."""

    has_content = True

    def run(self) -> list[nodes.Node]:
        """The picture, and the text that it was made from."""
        text = "\n".join(self.content)
        specification, _, table = text.partition("\n---\n")
        source = self.parse_text_to_nodes(f"```rv\n{specification}\n```\n\n```csv\n{table}\n```\n")
        return [*source, nodes.raw("", timeline.timeline(text), format="html")]


def short_names(
    _app: Sphinx, _what: str, _name: str, _of: object, _options: object, *shown: str | None
) -> tuple[str, str | None] | None:
    """A signature without the modules of its types, as `autodoc_typehints_format` has others."""
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
