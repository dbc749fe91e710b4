"""`rvmon format`: in place, on standard output, or as a check."""

import io

from rvmon.cli import main

UGLY = "requirement R G(a->F b)\n"
CANONICAL = "requirement R\n  always (a -> eventually b)\n"


def test_a_file_is_rewritten_once_and_not_by_a_check(tmp_path, says):
    path = tmp_path / "a.rv"
    path.write_text(UGLY)
    for words, code, told, text in (
        (["--check"], 1, f"would change: {path}\n", UGLY),
        ([], 0, f"changed: {path}\n", CANONICAL),
        ([], 0, "", CANONICAL),
        (["--check"], 0, "", CANONICAL),
    ):
        assert (says(code, "format", *words, path).out, path.read_text()) == (told, text)


def test_file_that_cannot_be_read(tmp_path, capsys):
    wrong, right = tmp_path / "a.rv", tmp_path / "b.rv"
    wrong.write_text("requirement R upon")
    right.write_text(UGLY)
    assert main(["format", str(wrong), str(right), str(tmp_path / "missing.rv")]) == 2
    assert wrong.read_text() == "requirement R upon"
    assert right.read_text() == CANONICAL
    assert "RV001" in capsys.readouterr().err


def test_standard_input(monkeypatch, says):
    monkeypatch.setattr("sys.stdin", io.StringIO(UGLY))
    assert says(0, "format", "-").out == CANONICAL
