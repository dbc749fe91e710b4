"""Output in notebooks, and the example notebook."""

import ast
import json
import re
from pathlib import Path

import pytest

import rvmon
from rvmon.report.notebook import DRAWN

FOLDER = Path(__file__).parents[3] / "examples" / "notebook"
HOSTILE = "</style><script>alert(1)</script>"


def shown(book):
    """The output of each code cell, executed in order as a kernel does."""
    names = {}
    for cell in book["cells"]:
        if cell["cell_type"] == "code":
            lines = ast.parse("".join(cell["source"])).body
            last = lines.pop() if isinstance(lines[-1], ast.Expr) else None
            exec(compile(ast.Module(lines, []), "cell", "exec"), names)  # noqa: S102 - ours
            if last is not None:
                code = compile(ast.Expression(last.value), "cell", "eval")
                yield eval(code, names)._repr_html_()  # noqa: S307 - ours


def test_the_notebook_runs(monkeypatch):
    monkeypatch.chdir(FOLDER)
    spec, report, failed, decided = shown(json.loads((FOLDER / "verdicts.ipynb").read_text()))
    assert "then within 500 ms for 1 s speed &lt;= 1 mm/s" in spec
    assert "B1 failed, B2 failed" in report
    assert report.count('class="on"') == 3  # one bar for each attempt
    assert "deadline" in failed
    assert "B1#1" in decided
    assert max(map(len, (spec, report, failed, decided))) < 20_000


def test_a_fragment_does_not_affect_the_notebook():
    """Its styles are scoped, it has no script, and text of files is escaped."""
    text = (
        f'spec s\nsignal b : bool\nrequirement R "{HOSTILE}"\n  always b\n  severity "{HOSTILE}"\n'
    )
    spec = rvmon.loads(text)
    report = spec.evaluate({"t": [0, 1], "b": [True, False]})
    pieces = (spec, report, report.attempts[0])
    for piece in (one._repr_html_() for one in pieces):
        (style,) = re.findall(r"<style>(.*?)</style>", piece, re.DOTALL)
        assert style.startswith("@scope (.rvmon){")
        assert not re.search(r":root|(?<![.\w-])body[ {>]", style)
        assert "<script" not in piece


def test_the_theme_of_a_notebook_takes_precedence():
    """The colours of verdicts and of the page follow the notebook first, then the system."""
    piece = rvmon.loads("signal b : bool\nrequirement R\n  always b\n")._repr_html_()
    assert piece.count("[data-jp-theme-light=false]") == 2
    assert piece.count(":not([data-jp-theme-light=true] *)") == 2


@pytest.mark.parametrize("failures", [1, DRAWN + 7])
def test_many_attempts_are_counted(failures):
    spec = rvmon.loads("event go\nrequirement R\n  upon go\n  then false\n")
    report = spec.evaluate([(t, {"go": True}) for t in range(failures)])
    piece = report._repr_html_()
    assert piece.count('class="on"') == min(failures, DRAWN)
    assert piece.count("<details") == min(failures, 4)
    assert (f"… and {failures - 4:,} more of R" in piece) == (failures > 4)
