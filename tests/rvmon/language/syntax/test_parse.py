"""Imports are relative to the file and read once; circles and duplicate names show both places."""

import os

import pytest
from tests.tools.findings import codes_of, findings_of

from rvmon import load
from rvmon.errors import SpecError
from rvmon.language.compile import compile_text


@pytest.fixture
def compile_file(tmp_path):
    """Write files and compile the first of them."""

    def compile_them(**texts):
        for name, text in texts.items():
            path = tmp_path / f"{name.replace('__', '/')}.rv"
            path.parent.mkdir(exist_ok=True)
            path.write_text(text, encoding="utf-8")
        first = tmp_path / f"{next(iter(texts))}.rv"
        return compile_text(first.read_text(), name=str(first), directory=tmp_path)

    return compile_them


def test_import_brings_declarations_and_requirements(compile_file):
    spec, warnings = compile_file(
        main='spec main "M"\nimport "sub/signals.rv"\nrequirement R upon e then within 1 s a',
        sub__signals='spec other\nimport "more.rv"\nsignal a, b : bool\nrequirement R0 always b',
        sub__more="event e, unread",
    )
    assert (spec.name, spec.title) == ("main", "M")
    assert list(spec.requirements) == ["R", "R0"]
    assert set(spec.events) == {"e", "unread"}
    assert warnings == ()


def test_file_is_read_once(compile_file):
    spec, _ = compile_file(
        main='import "one.rv"\nimport "two.rv"\nimport "./one.rv"\nrequirement R always a',
        one='import "base.rv"\nsignal b : bool',
        two='import "base.rv"',
        base="signal a : bool",
    )
    assert set(spec.signals) == {"a", "b"}


@pytest.mark.parametrize(
    ("code", "files", "texts"),
    [
        ("RV016", 1, {"main": 'import "main.rv"'}),
        (
            *("RV016", 2),
            {"main": 'import "one.rv"', "one": 'import "two.rv"', "two": 'import "one.rv"'},
        ),
        ("RV016", 2, {"main": 'import "one.rv"', "one": 'import "main.rv"'}),
        ("RV011", 2, {"main": 'import "one.rv"\nsignal a : bool', "one": "event a"}),
    ],
)
def test_a_circle_and_a_duplicate_name_show_both_places(compile_file, code, files, texts):
    (finding,) = findings_of(compile_file, **texts)
    assert (finding.code, len(finding.spans)) == (code, 2)
    assert len({label.span.source.name for label in finding.spans}) == files


@pytest.mark.parametrize("target", ['"missing.rv"', '"."', "nolibrary", '"a\x00b"'])
def test_unreadable_imports_are_reported(compile_file, target):
    assert codes_of(compile_file, main=f"import {target}") == ["RV016"]


def test_a_binary_file_is_reported(compile_file, tmp_path):
    (tmp_path / "one.rv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(SpecError, match="it is not UTF-8 text"):
        compile_file(main='import "one.rv"')


def test_an_imported_file_may_declare_the_time_model(compile_file):
    """A second declaration is an error, also in another file."""
    spec, _ = compile_file(main='import "one.rv"', one="time sampled")
    assert spec.time == "sampled"
    with pytest.raises(SpecError, match="RV011"):
        compile_file(main='time held\nimport "one.rv"', one="time sampled")


@pytest.mark.parametrize("target", ["/dev/zero", "/etc/passwd", "../secret.rv", "link.rv"])
def test_nothing_outside_the_project_is_read(compile_file, tmp_path, target):
    folder = tmp_path.parent / "secret.rv"
    folder.write_text("password")
    (tmp_path / "link.rv").symlink_to(folder)
    with pytest.raises(SpecError, match="outside") as caught:
        compile_file(main=f'import "{target}"')
    assert [finding.code for finding in caught.value.diagnostics] == ["RV016"]
    assert "password" not in str(caught.value)
    assert "root:" not in str(caught.value)


@pytest.mark.parametrize("allowed", [".git", "pyproject.toml", "RVMON_ALLOW_IMPORTS"])
def test_a_project_shares_its_specifications(tmp_path, monkeypatch, allowed):
    """A folder may be allowed by name."""
    if allowed == "RVMON_ALLOW_IMPORTS":
        monkeypatch.setenv(allowed, str(tmp_path / "common"))
    else:
        (tmp_path / allowed).touch()
    (tmp_path / "common").mkdir()
    (tmp_path / "robot").mkdir()
    (tmp_path / "common" / "x.rv").write_text("signal a : bool")
    text = 'import "../common/x.rv"\nrequirement R always a'
    spec, _ = compile_text(text, directory=tmp_path / "robot")
    assert set(spec.signals) == {"a"}


def test_pipes_and_large_files_are_no_specifications(compile_file, tmp_path, monkeypatch):
    os.mkfifo(tmp_path / "pipe.rv")
    with pytest.raises(SpecError, match="a regular file is expected"):
        compile_file(main='import "pipe.rv"')
    with pytest.raises(SpecError, match="a regular file is expected"):
        load(tmp_path / "pipe.rv")
    monkeypatch.setenv("RVMON_MAX_TEXT", "1")
    (tmp_path / "large.rv").write_text("# large\n" * (1 << 18))
    with pytest.raises(SpecError, match="larger than 1 MB"):
        load(tmp_path / "large.rv")
