"""`rvmon check`: findings, output formats, exit codes."""

import io
import json

GOOD = "spec demo\nevent a, b\nrequirement R upon a then within 3 s b\n"
WRONG = "spec demo\nevent a, b\nrequirement R upon a then within 3 s bb\n"


def test_warnings_fail_only_a_strict_check(put, says):
    assert says(0, "check", put("a.rv", GOOD)).out == "1 file: nothing to report\n"
    path = put("b.rv", "spec demo\nevent a, b, c\nrequirement R upon a then within 3 s b\n")
    for code, strict in ((0, []), (1, ["--strict"])):
        shown = says(code, "check", *strict, path)
        assert "warning[RV046 never-read]: event `c`" in shown.err
        assert shown.out == "1 file: 1 warning\n"


def test_findings_are_shown_concisely_and_as_json(put, says, monkeypatch):
    path = put("a.rv", WRONG)
    shown = says(2, "check", "--format", "concise", path)
    assert shown.err.startswith(f"{path}:3:38: error[RV012 unknown-signal]")
    (finding,) = json.loads(says(2, "check", "--format", "json", path).out)
    assert finding["spans"][0]["start"]["line"] == 3
    assert json.loads(says(0, "check", "--format", "json", put("b.rv", GOOD)).out) == []
    monkeypatch.setattr("sys.stdin", io.StringIO(WRONG))
    assert "<stdin>:3:38" in says(2, "check", "-").err


def test_an_imported_file_is_reported_once(put, says):
    put("names.rv", "signal a : boool\n")
    paths = [put(name, f'import "names.rv"\nevent e{name[0]}\n') for name in ("a.rv", "b.rv")]
    shown = says(2, "check", *paths)
    assert shown.err.count("error[RV001 syntax]") == 1
    assert "names.rv:1:12" in shown.err
    assert "did you mean `bool`?" in shown.err
    assert shown.out == "2 files: 1 error\n"


def test_constants_are_replaced_and_checked(put, says):
    path = put("a.rv", "const T = 3 s\nevent a\nrequirement R upon a then within T not a\n")
    says(0, "check", "--const", "T=2 s", path)
    assert "no-duration" in says(2, "check", "--const", "T=2 m", path).err
