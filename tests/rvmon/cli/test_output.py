"""What commands print of others is shown, and not obeyed."""

import re
from pathlib import Path

from rvmon.cli import output as say


def test_commands_print_through_one_place():
    """No file of the command line but that one prints; what was rendered before is known."""
    files = Path(say.__file__).parent.glob("*.py")
    bare = {one.name for one in files if re.search(r"(?<![\w.])print\(", one.read_text())}
    assert bare == {"output.py"}


def test_a_tag_in_a_text_is_no_markup(tmp_path, says):
    spec = tmp_path / "s.rv"
    spec.write_text('signal b : bool\nrequirement `[bold]` "[/red] :smile:"\n  always b\n')
    trace = tmp_path / "t.csv"
    trace.write_text("t,b\n0,0\n")
    told = says(1, "run", spec, trace).out
    assert "[bold]" in told
    assert "[/red] :smile:" in told
