"""`rvmon format`: in place, on standard output, or as a check."""

import io

UGLY = "requirement R G(a->F b)\n"
CANONICAL = "requirement R\n  always (a -> eventually b)\n"


def test_a_file_is_rewritten_once_and_never_by_check(tmp_path, put, says):
    path = tmp_path / put("a.rv", UGLY)
    for words, code, told, text in (
        (["--check"], 1, f"would change: {path}\n", UGLY),
        ([], 0, f"changed: {path}\n", CANONICAL),
        ([], 0, "", CANONICAL),
        (["--check"], 0, "", CANONICAL),
    ):
        assert (says(code, "format", *words, path).out, path.read_text()) == (told, text)


def test_other_files_are_formatted_although_one_is_wrong(tmp_path, put, says):
    put("a.rv", "requirement R upon")
    put("b.rv", UGLY)
    assert "RV001" in says(2, "format", "a.rv", "b.rv", "missing.rv").err
    texts = [(tmp_path / name).read_text() for name in ("a.rv", "b.rv")]
    assert texts == ["requirement R upon", CANONICAL]


def test_standard_input_is_formatted_to_standard_output(monkeypatch, says):
    monkeypatch.setattr("sys.stdin", io.StringIO(UGLY))
    assert says(0, "format", "-").out == CANONICAL
