"""What commands print of others is shown, and not obeyed."""

import io
import json
import re
from pathlib import Path

import pytest
from rich.table import Table

import rvmon
from rvmon.cli import main
from rvmon.cli import output as say
from rvmon.errors import RvmonError, UnknownNameError
from rvmon.report.terminal import Terminal

ESCAPE = "a\x1b[31m\x9b8m\u202e"
SHOWN = r"a\x1b[31m\x9b8m\u202e"


def test_commands_print_through_one_place():
    """No file of the command line but that one prints; what was rendered before is known."""
    files = Path(say.__file__).parent.glob("*.py")
    bare = {one.name for one in files if re.search(r"(?<![\w.])print\(", one.read_text())}
    assert bare == {"output.py"}


@pytest.mark.parametrize(
    "words",
    [
        ["run", ESCAPE, "x.csv"],
        ["check", ESCAPE],
        ["format", ESCAPE],
        ["run", "x.rv", "y.csv", "--format", ESCAPE],
        ["run", "x.rv", "y.csv", f"--{ESCAPE}"],
        ["verify", ESCAPE],
        ["explain", ESCAPE],
    ],
)
def test_names_of_files_and_values_of_options_are_shown(words, capsys):
    """In what the reader of files says, and in what the parser of options says."""
    assert main(words) == 2
    told = capsys.readouterr().err
    assert SHOWN in told
    assert "\x1b" not in told


def test_a_tag_in_a_text_is_no_markup(tmp_path, capsys):
    """A requirement's text that looks like the end of a style is printed."""
    spec = tmp_path / "s.rv"
    spec.write_text('signal b : bool\nrequirement `[bold]` "[/red] :smile:"\n  always b\n')
    trace = tmp_path / "t.csv"
    trace.write_text("t,b\n0,0\n")
    assert main(["run", str(spec), str(trace)]) == 1
    told = capsys.readouterr().out
    assert "[bold]" in told
    assert "[/red] :smile:" in told


def test_cells_of_tables_are_as_wide_as_what_is_shown():
    """No part of a name is cut off."""
    table = Table()
    table.add_column("", no_wrap=True)
    table.add_row(ESCAPE)
    text = io.StringIO()
    Terminal(file=text, width=80).print(table)
    assert f" {SHOWN} " in text.getvalue()


def test_health_names_columns_as_they_are_shown(tmp_path, capsys):
    """A column that is not declared reaches text and JSON."""
    spec = tmp_path / "s.rv"
    spec.write_text("signal b : bool\nrequirement R\n  always b\n")
    trace = tmp_path / "t.csv"
    trace.write_text(f"t,b,{ESCAPE}\n0,1,2\n", encoding="utf-8")
    main(["run", str(spec), str(trace)])
    assert f"  {SHOWN}  ignored" in capsys.readouterr().out
    main(["run", str(spec), str(trace), "--format", "json"])
    text = capsys.readouterr().out
    assert json.loads(text)["health"][0]["name"] == ESCAPE
    assert "\x9b" not in text


def test_errors_as_text_are_shown():
    """Also where a program of a user prints them."""
    assert str(RvmonError(ESCAPE)) == SHOWN
    assert str(UnknownNameError(ESCAPE)) == SHOWN
    with pytest.raises(rvmon.SpecError) as error:
        rvmon.loads(f"signal `{ESCAPE}` : nothing\n")
    assert "\x1b" not in str(error.value)
