"""Unused declarations get a warning in files with requirements."""

from tests.tools.each import each

from rvmon.language.compile import compile_text

DEMAND = "event a, b\nrequirement R\n  upon a\n  then within T b\n"


def warned(text):
    """The codes and marked names of all warnings."""
    _, findings = compile_text(text)
    return [(found.code, found.spans[0].span.text) for found in findings]


@each(
    ("text", "expected"),
    [
        (f"const T = 3 s\ndefine near = a\n{DEMAND}", [("RV017", "near")]),
        (f"const T = 3 s\ndefine soon(p) = within T p\n{DEMAND}", [("RV017", "soon")]),
        (f"const D = 1 s\nconst T = 3 * D\n{DEMAND}", []),
        (f"const T = 3 s\nconst `a b` = 1 s\n{DEMAND}", [("RV017", "`a b`")]),
        (f"const T = 3 s\nsignal z : real\n{DEMAND}  let v = z\n", [("RV017", "v")]),
        (f"const T = 3 s\nevent c\n{DEMAND}", [("RV046", "c")]),
        (f"const T = 3 s\nsignal p : bool\n{DEMAND}", [("RV046", "p")]),
        (f"const T = 3 s\nevent c\n{DEMAND}cover C = b and c\n", []),
        # A file with declarations only may be imported by others.
        ("event a\nconst T = 3 s\ndefine soon(p) = within T p\n", []),
    ],
)
def test_unused(text, expected):
    assert warned(text) == expected


def test_imported_names_may_be_unused(tmp_path):
    (tmp_path / "names.rv").write_text("event a, b, c\nconst T = 3 s\nconst D = 1 s\n")
    text = 'import "names.rv"\nrequirement R\n  upon a\n  then within T b\n'
    assert compile_text(text, directory=tmp_path)[1] == ()


def test_many_warnings_stop_nothing():
    names = ", ".join(f"s{number}" for number in range(300))
    spec, findings = compile_text(f"signal {names} : bool\nrequirement R always s0")
    assert len(spec.signals) == 300
    assert {found.severity for found in findings} == {"warning"}
    assert [found.code for found in findings] == ["RV046"] * 100 + ["RV006"]
