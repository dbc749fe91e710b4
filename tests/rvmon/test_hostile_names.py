"""Hostile names in every output, which is parsed again: nothing is forged or interpreted.

Every writer gets names as ids, texts, columns, reasons and file names; commands get them in
specifications, models and recordings. `HOSTILE_NAMES=100000` in the environment tries that many.
"""

import contextlib
import csv
import io
import json
import os
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pytest
from msgspec import structs
from tests.tools.hostile import STEERING, hostile_names

import rvmon
from rvmon.cli import main as command
from rvmon.diagnostics import (
    Diagnostic,
    Label,
    Severity,
    Source,
    Span,
    render_concise,
    render_full,
    render_json,
)
from rvmon.errors import RvmonError, UnknownNameError
from rvmon.language.checked.specification import CheckedSpec
from rvmon.models.language.load import loads_network
from rvmon.models.uppaal_xml import uppaal_xml
from rvmon.report.html import component, data, e, table_html
from rvmon.report.junit import junit_xml
from rvmon.report.verdict_table import RunGroup, VerdictTable, table_latex, tables_csv
from rvmon.texts import escaped, escaped_json, escaped_line, quoted
from rvmon.trace.sample import Health, HealthKind
from rvmon.verdicts import Verdict
from rvmon.verdicts.report import Report, report_of

NAMES = int(os.environ.get("HOSTILE_NAMES", "40"))
BATCH = 1000
"""Names in one document."""

pytestmark = pytest.mark.slow

Names = Sequence[str]

_STRING = re.compile(r'"(?:[^"\\\n]|\\.)*"')
_LATEX = re.compile(r"\\text[a-z]+\{\}|\\[&%$#_{}]|\{[\[*]\}|[^\\&%$#_{}~^\[*\x00-\x1f]")
_NETWORK = """automaton A {
  location l
  start l
}
query q: A[] not deadlock
"""


class Documents:
    """The output of each writer for hostile names, with a check of it.

    Args:
        names: at most a few thousand.
    """

    def __init__(self, names: Names) -> None:
        base = rvmon.loads("spec s\nsignal b : bool\nrequirement R\n  always b\n")
        judged = base.evaluate([(0.0, {"b": True}), (1.0, {"b": False})])
        attempt, requirement = judged.attempts[0], base.requirements["R"]
        self.names = names
        self.spec: CheckedSpec = structs.replace(
            base.checked,
            name=names[0],
            requirements={n: replace(requirement, id=n, text=n) for n in names},
        )
        self.report: Report = report_of(
            tuple(names),
            [replace(attempt, requirement=n, reason=f"`{n}` was false") for n in names],
            health=[Health(HealthKind.IGNORED, n, 1, None, (), n) for n in names],
            trace=names[-1],
            end=judged.end,
        )
        counts = {name: dict.fromkeys(Verdict, 1) for name in names}
        groups = tuple(RunGroup(name, 4, counts) for name in names[:3])
        self.table = VerdictTable(names[0], dict(zip(names, names, strict=True)), groups)

    def junit(self) -> bool:
        """JUnit XML."""
        text = junit_xml([self.report], self.spec, [(name, name) for name in self.names])
        root = ET.fromstring(text.encode())  # noqa: S314 - written by our own writer a line above
        cases = [case.get("name") for case in root.iter("testcase")]
        ids = [escaped(name) for name in self.names]
        return _calm(text) and cases == ids + ["recording"] * len(ids)

    def csv(self) -> bool:
        """Tables as CSV in which no cell is a formula."""
        rows = list(csv.reader(io.StringIO(tables_csv({self.names[0]: self.table}), newline="")))
        ids = [row[2] for row in rows[1 : len(self.names) + 1]]
        texts = [escaped_line(name) for name in self.names]
        formulas = [cell for row in rows for cell in row if cell.startswith(tuple("=+-@\t\r"))]
        return not formulas and ids == [f"'{one}" if one[0] in "=+-@" else one for one in texts]

    def latex(self) -> bool:
        """Tables as LaTeX: names consist of escapes and harmless signs, rows are complete."""
        rows = [line for line in table_latex(self.table).split("\n") if line.endswith(r" \\")]
        ids = [row.split(" & 1")[0] for row in rows[2:]]
        return len(ids) == len(self.names) and not any(_LATEX.sub("", text) for text in ids)

    def html(self) -> bool:
        """Pages with the tags and attribute names that harmless names give."""
        text, harmless = self._html_page(), Documents(_harmless(self.names))._html_page()
        return _calm(text) and _outline(text) == _outline(harmless)

    def script_data(self) -> bool:
        """Data for the script of a page, equal to the shown names when read back."""
        text = data({"panels": {name: [name] for name in self.names}})
        return (
            "<" not in text
            and _calm(text)
            and json.loads(text) == {"panels": {name: [name] for name in map(escaped, self.names)}}
        )

    def _html_page(self) -> str:
        """A page with the table, texts and attributes."""
        texts = [(e("p", {"title": name}, name), name) for name in self.names]
        return component("facts", texts) + table_html(self.table)

    def strings(self) -> bool:
        """Strings of DOT and HOA."""
        found = [quoted(name) for name in self.names]
        return _calm("".join(found)) and all(map(_STRING.fullmatch, found))

    def uppaal(self) -> bool:
        """Networks as XML."""
        network = loads_network(_NETWORK)
        queries = [replace(network.queries[0], id="", remark=name) for name in self.names]
        text = uppaal_xml(replace(network, title=self.names[0], queries=tuple(queries)))
        root = ET.fromstring(text.encode())  # noqa: S314 - written by our own writer a line above
        found = [comment.text for comment in root.iter("comment")]
        return _calm(text) and found == [escaped(name) for name in self.names]

    def messages(self) -> bool:
        """Errors, and findings in all formats."""
        found = [
            Diagnostic("RV001", "syntax", Severity.ERROR, n, (Label(Span(Source(n, n), 0, 2), n),))
            for n in self.names
        ]
        errors = [str(kind(name)) for kind in (RvmonError, UnknownNameError) for name in self.names]
        as_json = escaped_json(render_json(found))
        texts = [render_full(found), render_concise(found), as_json, *errors]
        read = [finding["file"] for finding in json.loads(texts[2])]
        lines = len(texts[1].split("\n"))
        return _calm("".join(texts)) and read == list(self.names) and lines == len(self.names)


WRITERS: Sequence[Callable[[Documents], bool]] = [
    method for name, method in vars(Documents).items() if not name.startswith("_")
]


class _Outline(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.found: list[object] = []

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, *(name for name, _ in attributes)))

    def handle_comment(self, _: str) -> None:
        self.found.append("comment")


def _outline(text: str) -> list[object]:
    parser = _Outline()
    parser.feed(text)
    parser.close()
    return parser.found


def _harmless(names: Names) -> list[str]:
    return [f"n{number}" for number, _ in enumerate(names)]


def _calm(text: str) -> bool:
    return not STEERING.search(text)


def _printed(act: Callable[[], object]) -> str:
    """The text on standard output and error."""
    told = io.StringIO()
    with contextlib.redirect_stdout(told), contextlib.redirect_stderr(told):
        act()
    return told.getvalue()


def written(names: Names, folder: Path) -> tuple[Names, str, str, str, str]:
    """Write files with hostile names wherever possible, including the file name.

    Returns:
        The names, each the id and text of a requirement, and the paths of the specification, of a
        recording with names as a column and cells, of one with a name as a value, and of a network
        of timed automata with names as title, labels and remarks of queries.
    """
    ids = [name for name in names if "\r" not in name]  # it would end a line
    cell = next(name for name in ids if name == escaped_line(name) or "\x00" not in name)
    file = re.sub(r"[/\x00]", "_", ids[-1])[:60]
    ends = (".rv", ".csv", ".broken.csv", ".ta")
    spec, trace, broken, model = (str(folder / (file + end)) for end in ends)
    items = "".join(f"requirement `{n}` {json.dumps(n)}\n  always b\n" for n in ids)
    Path(spec).write_text(f"spec `{ids[0]}`\nsignal b : bool\n{items}", encoding="utf-8")
    for path, value in ((trace, "0"), (broken, cell)):
        with open(path, "w", newline="", encoding="utf-8") as out:
            csv.writer(out).writerows([("t", "b", ids[0]), (0, 1, cell), (1, value, cell)])
    # The first name is left out: it is a column whose cells are no truth values.
    quoted_ids = [f'"{name}"' for name in ids[1:] if '"' not in name and name != ids[0]]
    queries = "".join(f"query q{k} {name}: E<> A.m\n" for k, name in enumerate(quoted_ids[:20]))
    edges = "".join(f"  edge l -> m as {name}\n" for name in ("b", *quoted_ids[:20]))
    body = f"automaton A {{\n  location l\n  location m\n  start l\n{edges}}}\n"
    text = f"network N {quoted_ids[-1]}\nunit 50 ms\n{body}{queries}"
    Path(model).write_text(text, encoding="utf-8")
    return ids, spec, trace, broken, model


def through_commands(names: Names, folder: Path) -> Iterator[tuple[str, bool]]:
    """The names of commands, each with whether its output is harmless."""
    ids, spec, trace, broken, model = written(names, folder)
    run = ["run", spec, trace]
    words = {
        "run": run,
        "run, broken": ["run", spec, broken],
        "run, pages": [*run, trace, "--junit", str(folder / "j"), "--report", str(folder / "r")],
        "run, unknown": [*run, "--only", "no" + ids[0]],
        "run, options": [*run, "--no" + ids[0]],
        "check": ["check", spec],
        "check, none": ["check", spec + "none"],
        "format": ["format", "--check", spec],
        "explain": ["explain", spec, ids[0], "--runs", "10"],
        "why": ["why", spec, trace, ids[0] if "#" not in ids[0] else "x"],
        "init": ["init", trace, "-o", "-"],
        "export, dot": ["export", spec, "--to", "dot"],
        "export, hoa": ["export", spec, "--to", "hoa"],
        "verify": ["verify", model],
        "verify, json": ["verify", model, "--format", "json"],
        "verify, query": ["verify", model, "--query", ids[0]],
        "verify, spec": ["verify", model, "--spec", spec],
        "verify, const": ["verify", model, "--const", ids[0] + "=1"],
        "verify, suite": ["verify", model, "--suite", "edges"],
        "verify, no model": ["verify", trace],
        "conform": ["conform", model, trace],
        "conform, json": ["conform", model, trace, "--format", "json"],
        "conform, broken": ["conform", model, broken],
        "conform, labels": ["conform", model, trace, "--observe", ids[0]],
        "conform, time": ["conform", model, trace, "--time", ids[0]],
        "run, json": [*run, "--format", "json"],
        "export, json": ["export", spec, "--to", "json"],
    }
    texts = {name: _printed(lambda given=given: command(given)) for name, given in words.items()}
    for name, text in texts.items():
        fine = _calm(text) and "internal error" not in text
        yield name, fine and _holds(name, text, ids)


def _holds(name: str, text: str, ids: Names) -> bool:
    """Whether JSON output of a command reads back as the names."""
    if not name.endswith(", json"):
        return True
    try:
        document = json.loads(text)
    except ValueError:
        return False
    match name.partition(",")[0]:
        case "run":
            return list(document["requirements"]) == list(ids)
        case "export":
            return [automaton["requirement"] for automaton in document] == list(ids)
    return True


@pytest.fixture(scope="module")
def documents() -> list[Documents]:
    names = [*hostile_names(NAMES)]
    return [Documents(names[first : first + BATCH]) for first in range(0, NAMES, BATCH)]


@pytest.mark.parametrize("writer", WRITERS, ids=lambda writer: writer.__name__)
def test_written_names_are_harmless_and_read_back(documents, writer):
    assert all(map(writer, documents))


def test_every_command_prints_hostile_names_harmlessly(tmp_path):
    names = [*hostile_names(NAMES)]
    for first in range(0, NAMES, BATCH):
        found = dict(through_commands(names[first : first + BATCH], tmp_path))
        assert len(found) > 20
        assert [name for name, fine in found.items() if not fine] == []
