"""`rvmon format`: in place, on standard output, or as a check."""

import io

from rvmon.cli import main

UGLY = "requirement R G(a->F b)\n"
CANONICAL = "requirement R\n  always (a -> eventually b)\n"


def test_format_in_place(tmp_path, capsys):
    """The file is rewritten once, then left alone."""
    path = tmp_path / "a.rv"
    path.write_text(UGLY)
    assert main(["format", str(path)]) == 0
    assert path.read_text() == CANONICAL
    assert capsys.readouterr().out == f"changed: {path}\n"
    assert main(["format", str(path)]) == 0
    assert capsys.readouterr().out == ""


def test_check(tmp_path, capsys):
    """With --check nothing is written, and 1 says that something would be."""
    path = tmp_path / "a.rv"
    path.write_text(UGLY)
    assert main(["format", "--check", str(path)]) == 1
    assert path.read_text() == UGLY
    assert capsys.readouterr().out == f"would change: {path}\n"
    path.write_text(CANONICAL)
    assert main(["format", "--check", str(path)]) == 0


def test_file_that_cannot_be_read(tmp_path, capsys):
    """A file with syntax errors stays as it is; the others are laid out."""
    wrong, right = tmp_path / "a.rv", tmp_path / "b.rv"
    wrong.write_text("requirement R upon")
    right.write_text(UGLY)
    assert main(["format", str(wrong), str(right), str(tmp_path / "missing.rv")]) == 2
    assert wrong.read_text() == "requirement R upon"
    assert right.read_text() == CANONICAL
    assert "RV001" in capsys.readouterr().err


def test_standard_input(monkeypatch, capsys):
    """`-` goes from standard input to standard output."""
    monkeypatch.setattr("sys.stdin", io.StringIO(UGLY))
    assert main(["format", "-"]) == 0
    assert capsys.readouterr().out == CANONICAL
