"""Text from files is printed literally, never interpreted."""

import re
from pathlib import Path

from rvmon.cli import output


def test_commands_print_through_one_module():
    files = Path(output.__file__).parent.glob("*.py")
    bare = {file.name for file in files if re.search(r"(?<![\w.])print\(", file.read_text())}
    assert bare == {"output.py"}


def test_a_tag_in_a_text_is_no_markup(put, says):
    put("s.rv", 'signal b : bool\nrequirement `[bold]` "[/red] :smile:"\n  always b\n')
    told = says(1, "run", "s.rv", put("t.csv", "t,b\n0,0\n")).out
    assert "[bold]" in told
    assert "[/red] :smile:" in told
