"""What commands print of others is shown, and not obeyed."""

import re
from pathlib import Path

from tests.tools.each import each

from rvmon.cli import output as say

ESCAPE = "a\x1b[31m\x9b8m\u202e"


def test_commands_print_through_one_place():
    """No file of the command line but that one prints; what was rendered before is known."""
    files = Path(say.__file__).parent.glob("*.py")
    bare = {one.name for one in files if re.search(r"(?<![\w.])print\(", one.read_text())}
    assert bare == {"output.py"}


@each(
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
def test_names_of_files_and_values_of_options_are_shown(words, says):
    told = says(2, *words).err
    assert r"a\x1b[31m\x9b8m\u202e" in told
    assert "\x1b" not in told


def test_a_tag_in_a_text_is_no_markup(tmp_path, says):
    spec = tmp_path / "s.rv"
    spec.write_text('signal b : bool\nrequirement `[bold]` "[/red] :smile:"\n  always b\n')
    trace = tmp_path / "t.csv"
    trace.write_text("t,b\n0,0\n")
    told = says(1, "run", spec, trace).out
    assert "[bold]" in told
    assert "[/red] :smile:" in told
