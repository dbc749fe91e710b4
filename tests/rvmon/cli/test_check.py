"""`rvmon check`: findings, forms, exit codes."""

import io
import json

from rvmon.cli import main

GOOD = "spec demo\nevent a, b\nrequirement R upon a then within 3 s b\n"
WRONG = "spec demo\nevent a, b\nrequirement R upon a then within 3 s bb\n"


def test_what_is_in_order_and_warnings_cost_nothing_unless_that_is_asked(put, says):
    assert says(0, "check", put("a.rv", GOOD)).out == "1 file: nothing to report\n"
    path = put("b.rv", "spec demo\nevent a, b, c\nrequirement R upon a then within 3 s b\n")
    shown = says(0, "check", path)
    assert "warning[RV046 never-read]: event `c`" in shown.err
    assert shown.out == "1 file: 1 warning\n"
    assert main(["check", "--strict", path]) == 1


def test_concise_and_json(put, says):
    path = put("a.rv", WRONG)
    shown = says(2, "check", "--format", "concise", path)
    assert shown.err.startswith(f"{path}:3:38: error[RV012 unknown-signal]")
    (finding,) = json.loads(says(2, "check", "--format", "json", path).out)
    assert finding["spans"][0]["start"]["line"] == 3
    assert json.loads(says(0, "check", "--format", "json", put("b.rv", GOOD)).out) == []


def test_an_imported_file_is_reported_once(put, says):
    put("names.rv", "signal a : boool\n")
    paths = [put(name, f'import "names.rv"\nevent e{name[0]}\n') for name in ("a.rv", "b.rv")]
    shown = says(2, "check", *paths)
    assert shown.err.count("error[RV001 syntax]") == 1
    assert "names.rv:1:12" in shown.err
    assert "did you mean `bool`?" in shown.err
    assert shown.out == "2 files: 1 error\n"


def test_constants(put, says):
    path = put("a.rv", "const T = 3 s\nevent a\nrequirement R upon a then within T not a\n")
    assert main(["check", "--const", "T=2 s", path]) == 0
    assert "no-duration" in says(2, "check", "--const", "T=2 m", path).err


def test_standard_input(monkeypatch, says):
    monkeypatch.setattr("sys.stdin", io.StringIO(WRONG))
    assert "<stdin>:3:38" in says(2, "check", "-").err
