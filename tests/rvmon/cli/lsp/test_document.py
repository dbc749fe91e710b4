"""Answers about an open document, asked without an editor."""

import re
from pathlib import Path
from types import MappingProxyType

import pytest
from lsprotocol.types import Position, Range
from pygls.uris import to_fs_path
from tests.tools.code_pages import page
from tests.tools.each import each

from rvmon.analysis.diagnostic_codes import every_rule, page_of
from rvmon.cli.lsp.completion import hover, proposals
from rvmon.cli.lsp.document import Document, Text
from rvmon.cli.lsp.names import _LINES, meanings
from rvmon.diagnostics import Source, Span
from rvmon.language.syntax.keywords import CLAUSE_WORDS, INFIX_WORDS, RESERVED, split_items
from rvmon.language.syntax.parse import grammar
from rvmon.language.syntax.syntax_errors import accepted_terminals

ROOT = Path(__file__).parents[4]
SPEC = """spec demo "😋 all kinds of names"
signal state : {idle, moving}  output
signal s : real [m]  input  stale after 200 ms
event moving, pick(id: int, `well done`: bool)  input
define soon(p, d) = within d p
const T = 3 s
requirement R1 "What is picked moves"
  upon pick and state == moving and age(s) < 5 s
  then soon(moving, T) and pick.id == v
  let v = pick.id + 1
  source "ISO 0000"
coverpoint phase = state {idle, moves: moving}
cross both = phase
  ignore phase == idle
"""


def document(text, files=MappingProxyType({})):
    """A document in a folder with other open files."""

    def read(path):
        if path.name in files:
            return files[path.name]
        raise FileNotFoundError(2, "no such file")

    return Document("file:///demo/main.rv", Text(text), read)


def after(text, words, number=0):
    """The position after the first letter of an occurrence of words."""
    offset = [found.start() for found in re.finditer(re.escape(words), text)][number]
    return Text(text).position(offset + 1)


def about(of, position):
    """The word and the text shown by hovering."""
    found = hover(of.names, of.compiled.checked, of.place(position))
    return (found[0].text, found[1]) if found else None


def offered(text):
    """The unfinished word at the end of a text, and its completions by kind."""
    of = document(SPEC)
    place = Span(Source("main.rv", SPEC + text), len(SPEC + text), len(SPEC + text))
    word, found = proposals(of.names, place)
    kinds = {kind: {text for text, k in found.items() if k == kind} for kind in found.values()}
    return word.text, kinds


USES = {
    ("moving, pick", 0): ["moving, pick", "moving, T"],
    ("pick(", 0): ["pick(", "pick and", "pick.id ==", "pick.id +"],
    ("id: int", 0): ["id: int", "id ==", "id +"],
    ("s : real", 0): ["s : real", "s) < 5"],
    ("T = 3", 0): ["T = 3", "T) and"],
    ("p, d", 0): ["p, d", "p\n"],
    ("v = pick", 0): ["v = pick", "v\n"],
    ("phase = state", 0): ["phase = state", "phase\n", "phase == idle"],
}


@pytest.mark.parametrize("place", USES, ids=lambda place: place[0].split()[0])
def test_all_uses_of_a_name_are_found_from_each_of_them(place):
    """A label is no event, a unit no signal, and a field belongs to its event."""
    of = document(SPEC)
    expected = {Span(of.source, SPEC.index(words), 0).start for words in USES[place]}
    for words in USES[place]:
        position = after(SPEC, words)
        found = of.key(position)
        starts = {span.start for span in of.uses(found)}
        assert starts == expected, words
        (definition,) = of.definitions(position)
        assert definition.range.start == Text(SPEC).position(SPEC.index(place[0]))


def test_definitions_in_other_files_are_found():
    text = 'import "signals.rv"\nimport patterns\nrequirement R\n  bounded_response(a, b, 2 s)\n'
    of = document(text, {"signals.rv": "# unsaved\nevent a, b\n"})
    assert [str(place) for place in of.definitions(after(text, "a, b"))] == [
        "file:///demo/signals.rv:1:6-1:7"
    ]
    (macro,) = of.definitions(after(text, "bounded"))
    line = (
        Path(to_fs_path(macro.uri)).read_text(encoding="utf-8").split("\n")[macro.range.start.line]
    )
    assert line.startswith("define bounded_response(")
    (file,) = of.definitions(after(text, "signals"))
    assert file.uri == "file:///demo/signals.rv"
    assert len(of.definitions(after(text, "patterns"))) > 1


def test_definitions_are_found_in_a_text_with_errors():
    text = f"{SPEC}requirement R2 upon pick then (within\n"
    of = document(text)
    (place,) = of.definitions(after(text, "pick then"))
    assert place.range == Text(text).range(SPEC.index("pick("), SPEC.index("pick(") + 4)


def test_hovering_shows_a_requirement_in_words_and_a_declaration():
    of = document(SPEC)
    word, text = about(of, after(SPEC, "R1"))
    assert word == "R1"
    assert "What is picked moves" in text
    assert "within 3 s, moving occurs" in text
    assert "ISO 0000" in text
    signal = "signal s : real [m]  input  stale after 200 ms"
    assert about(of, after(SPEC, "s) < 5")) == ("s", f"```rv\n{signal}\n```")
    assert about(of, after(SPEC, "v\n")) == ("v", "```rv\nlet v = pick.id + 1\n```")
    assert about(of, after(SPEC, "s\n  then")) is None, "a unit"
    text = 'event a # upon a\nrequirement R "upon a" always a\n'
    of = document(text)
    assert [about(of, after(text, "upon a", number)) for number in (0, 1)] == [None, None]


def test_hovering_over_a_word_shows_its_line_in_the_reference():
    page = (ROOT / "docs" / "reference" / "language.md").read_text(encoding="utf-8")
    flat = " ".join(page.replace(" | |", " |").split()).replace(" | ", ": ")
    assert not [line for line in _LINES.values() if line not in flat]
    parts = {part for word in meanings() for part in word.split()}
    words = (RESERVED | INFIX_WORDS | CLAUSE_WORDS) - {"A", "E", "true", "false"}
    assert words <= parts
    word, text = about(document(SPEC), after(SPEC, "after 200"))
    assert word == "stale after"
    assert text == meanings()["stale after"]


@pytest.mark.slow
def test_every_request_is_answered_in_unfinished_texts():
    for cut in range(0, len(SPEC), 37):
        for text in (SPEC[:cut], SPEC[:cut] + SPEC[cut + 9 :], f"{SPEC[:cut]}\0({SPEC[cut:]}"):
            of = document(text)
            place = Text(text).position(cut)
            assert of.diagnostics.keys() == {of.uri}
            list(of.symbols())
            about(of, place)
            of.definitions(place)
            proposals(of.names, of.place(place))
            assert all(0 <= use.start <= use.end <= len(text) for use, _ in of.names.all())


def test_findings_have_code_place_related_place_and_page():
    text = "event a\nevent a\nconst T = 3 s\nrequirement R upon a then within 2 s a\n"
    of = document(text)
    (double,) = of.diagnostics[of.uri]
    assert (double.code, str(double.range)) == ("RV011", "1:6-1:7")
    assert double.message == "name `a` is declared twice\nhelp: rename one of them"
    ((first, said),) = [(r.location, r.message) for r in double.related_information]
    assert (str(first), said) == (f"{of.uri}:0:6-0:7", "first here")
    page = Path(to_fs_path(double.code_description.href)).read_text(encoding="utf-8")
    assert page == page_of("RV011")
    (unused,) = document(text.replace("event a\n", "", 1)).diagnostics[of.uri]
    assert unused.tags, "an unused name is marked as unnecessary"


def test_the_page_of_a_code_is_written_once_there_is_a_cache(monkeypatch, tmp_path):
    """An editor runs for days, so a failed attempt is repeated."""

    def described():
        of = document("event a\nevent a\nrequirement R upon a then within 2 s a\n")
        return of.diagnostics[of.uri][0].code_description

    monkeypatch.setenv("RVMON_CACHE", "off")
    assert described() is None
    monkeypatch.delenv("RVMON_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert Path(to_fs_path(described().href)).is_relative_to(tmp_path)


@pytest.mark.slow
def test_a_fix_removes_its_finding():
    mended = set()
    for code in every_rule():
        example = page(code).example
        of = document(example)
        everywhere = Range(Position(0, 0), Position(999, 0))
        for fix in of.fixes(everywhere) if len(of.compiled.findings) < 9 else ():
            ((edit,),) = fix.edit.changes.values()
            start, end = of.text.offset(edit.range.start), of.text.offset(edit.range.end)
            better = document(example[:start] + edit.new_text + example[end:])
            (shown,) = fix.diagnostics
            before, after = (
                [finding.code for finding in one.compiled.findings].count(shown.code)
                for one in (of, better)
            )
            assert after < before
            mended.add(code)
    assert mended == {"RV012", "RV013", "RV014", "RV023", "RV030", "RV032", "RV045", "RV052"}
    sign = "event a, b\nrequirement R a → b\n"
    assert [fix.title for fix in document(sign).fixes(everywhere)] == ["Write `->`"]


OFFERED = {
    "requirement R\n  upon pi": (
        "pi",
        {"name": {"pick", "pick.id", "s"}, "function": {"soon(", "age("}},
    ),
    "requirement R upon pick then within ": ("", {"name": {"T"}}),
    "requirement R upon pick then within 5 m": ("m", {"unit": {"ms", "min"}}),
    "requirement R always s < 5 c": ("c", {"unit": {"cm", "kg"}, "keyword": {"and", "until"}}),
    "requirement R always state == mo": ("mo", {"label": {"idle", "moving"}}),
    "requirement R always s > 3 m\n  at": ("at", {"keyword": {"at end", "source", "requirement"}}),
    "requirement R always s > 3 m\n  at end: ": ("", {"keyword": {"strict", "fail"}}),
    "signal x : ": ("", {"keyword": {"bool", "int", "real"}}),
    "signal x : real [": ("", {"unit": {"m", "W"}}),
    "signal x : real [m] ": ("", {"keyword": {"input", "ignore NaN", "stale after"}}),
    "cross c = ": ("", {"name": {"phase"}}),
    "define f(u, w) = ": ("", {"name": {"u", "w"}}),
}


@each("text", OFFERED)
def test_completions_fit_their_place(text):
    word, expected = OFFERED[text]
    unfinished, kinds = offered(text)
    assert unfinished == word
    for kind, some in expected.items():
        assert some <= kinds[kind], kinds


def test_completions_that_do_not_fit_are_not_offered():
    for text in ("signal ", "requirement R # no", 'requirement R "no'):
        assert offered(text)[1] == {}, text
    assert "mm" not in offered("requirement R upon pick then within 5 m")[1]["unit"]
    assert offered("requirement R always state == ")[1].keys() == {"label"}
    assert "requirement" not in offered("requirement R always s > ")[1]["keyword"]


@pytest.mark.slow
def test_the_grammar_accepts_each_offered_keyword():
    for cut in range(0, len(SPEC), 29):
        text = SPEC[:cut]
        unfinished, found = proposals(document(SPEC).names, Span(Source("main.rv", text), cut, cut))
        before = text[: unfinished.start]
        start = split_items(before)[-1][0] if split_items(before) else 0
        if not accepted_terminals(grammar(), before[start:], "item")[1]:
            continue
        for word in (word for word, kind in found.items() if kind == "keyword"):
            whole = f"{before}{word} "
            start = split_items(whole)[-1][0]
            assert accepted_terminals(grammar(), whole[start:], "item")[1], word
