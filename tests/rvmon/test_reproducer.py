"""Reproducers are evaluated anywhere; damaged and hostile ones do no harm."""

import io
import json
import zipfile
from pathlib import Path

import pytest
from tests.tools.bags import write_shop
from tests.tools.each import each

import rvmon
from rvmon import reproducer
from rvmon.cli import main

SPEC = """
spec base
import "../common.rv"
import patterns
requirement R1
  upon go
  then within T speed < 1
requirement R2
  always speed < 9
"""


@pytest.fixture
def base(tmp_path, monkeypatch):
    """A project with a specification that imports another, and a recording."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / ".git").mkdir()
    (tmp_path / "specs").mkdir()
    (tmp_path / "common.rv").write_text("signal speed : real\nevent go\nconst T = 2 s\n")
    (tmp_path / "specs" / "base.rv").write_text(SPEC)
    (tmp_path / "a.csv").write_text("stamp,v,go\n0,2,\n9000,3,1\n11500,0.5,\n15000,,\n")
    return tmp_path


def clip(data, *words):
    """The exit code of writing `a.rvcase`."""
    return main(["clip", "specs/base.rv", data, "R1", "-o", "a.rvcase", *words])


READING = ["--time", "stamp:ms", "--map", "speed=v", "--const", "T=2 s"]


@pytest.mark.slow
def test_a_reproducer_is_evaluated_and_explained_in_any_folder(
    base, tmp_path_factory, monkeypatch, says
):
    assert clip("a.csv", *READING) == 0
    monkeypatch.chdir(tmp_path_factory.mktemp("elsewhere"))
    path = str(base / "a.rvcase")
    told = says(1, "run", path, "--format", "json", "--out", "v.csv")
    report = json.loads(told.out)
    assert report["trace"] == "a.csv"
    assert report["requirements"]["R1"]["attempts"][0]["decided"] == 11_000_000_001
    assert told.err == "R1#1 is F, as when this was recorded\n"
    assert "R1#1  F" in says(0, "why", path).out
    assert main(["run", path, "--report", "pages", "--quiet"]) == 1
    for written in (*Path("pages").rglob("*.html"), Path("v.csv")):
        assert b"rvmon-" not in written.read_bytes(), "the name of a temporary folder"


@pytest.mark.slow
def test_a_reproducer_contains_bag_binding_and_definitions(base, says):
    pytest.importorskip("rosbags")
    write_shop(base)
    assert clip("bag", "--binding", "base.toml") == 0
    needed = {"binding/msgs/shop_msgs/msg/Pick.msg", "recording/bag/metadata.yaml"}
    assert needed <= {*zipfile.ZipFile("a.rvcase").namelist()}
    assert "R1#1 is F, as when this was recorded" in says(1, "run", "a.rvcase", "--quiet").err


def test_piece_and_reproducer_are_written_together(base):
    words = ["clip", "specs/base.rv", "a.csv", "R1", "-o", "b.csv"]
    assert main([*words, "--reproducer", "b.rvcase", *READING]) == 0
    assert (base / "b.csv").exists()
    with zipfile.ZipFile(base / "b.rvcase") as packed:
        assert packed.read("recording/b.csv") == (base / "b.csv").read_bytes()


def test_no_reproducer_is_written_if_the_piece_has_another_verdict(base, capsys):
    text = SPEC.replace("within T speed < 1", "O[0, 9 s] (speed < 1)")
    (base / "specs" / "base.rv").write_text(text)
    (base / "a.csv").write_text("stamp,v,go\n0,0.2,\n5000,3,\n8000,,1\n15000,,\n")
    assert clip("a.csv", *READING, "--before", "1s") == 1
    assert not (base / "a.rvcase").exists()
    assert "a longer --before" in capsys.readouterr().err


def made(path, files, **case):
    """Write a reproducer with these files and return its path."""
    described = {"format": 1, "rvmon": "9.9", "law": 2, "attempt": "R#1", "verdict": "F"}
    described |= {"triggered": 0, "decided": 1, "spec": "a.rv", "recording": "a.csv"}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as packed:
        packed.writestr("case.json", json.dumps(described | case))
        for name, text in files.items():
            packed.writestr(name, text)
    return str(path)


RV = "spec a\nsignal p : bool\nrequirement R\n  always p\n"


def test_a_changed_verdict_or_law_is_reported(tmp_path, says):
    path = made(tmp_path / "a.rvcase", {"a.rv": RV, "a.csv": "t,p\n0,1\n5,0\n"}, law=1)
    told = says(1, "run", path, "--quiet").err
    assert "was made under law 1" in told
    assert "R#1 was F, as rvmon 9.9 (law 1) decided: it is F now" in told
    path = made(tmp_path / "b.rvcase", {"a.rv": RV, "a.csv": "t,p\n0,1\n5,1\n"})
    told = says(0, "run", path, "--quiet").err
    assert "R#1 was F, as rvmon 9.9 (law 2) decided: it is P now" in told


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    ["../a.rv", "/rvmon-escaped", "x/../../a.rv", "..\\a.rv", "C:/a.rv", "x\0y", "a.rv/", "."],
)
def test_no_name_of_an_entry_leads_out_of_the_folder(tmp_path, capsys, says, name):
    outside = {*tmp_path.parent.iterdir()}
    path = made(tmp_path / "a.rvcase", {name: "x", "a.rv": RV, "a.csv": "t,p\n0,1\n"})
    code = main(["run", path, "--quiet"])
    assert {*tmp_path.parent.iterdir()} == outside
    if name in ("x\0y", "a.rv/"):  # zipfile cuts the first name, and the second is a folder
        assert code in (0, 2)
    else:
        assert code == 2
        assert "leads out of it" in capsys.readouterr().err
    (tmp_path / "a.rv").write_text(RV)
    path = made(tmp_path / "b.rvcase", {"a.csv": "t,p\n0,1\n"}, spec=f"../{tmp_path.name}/a.rv")
    assert "leads out of it" in says(2, "run", path).err
    path = made(tmp_path / "c.rvcase", {"a.rv": RV}, recording=str(tmp_path / "a.rv"))
    assert "leads out of it" in says(2, "run", path).err


def test_imports_and_definitions_do_not_lead_out_of_the_folder(tmp_path, says, monkeypatch):
    """Not even if the reproducer is unpacked within a project."""
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    (tmp_path / ".git").mkdir()
    (tmp_path / "secret.rv").write_text("signal q : bool\n")
    text = f'import "{tmp_path}/secret.rv"\n' + RV
    path = made(tmp_path / "a.rvcase", {"a.rv": text, "a.csv": "t,p\n0,1\n"})
    assert "secret.rv" in says(2, "run", path).err
    binding = f'definitions = ["{tmp_path}/shop/msg/A.msg"]\n'
    files = {"a.rv": RV, "a.csv": "t,p\n0,1\n", "b.toml": binding}
    path = made(tmp_path / "b.rvcase", files, binding="b.toml")
    assert "leads out of it" in says(2, "run", path).err


def test_size_and_number_of_files_are_limited(tmp_path, monkeypatch, says):
    monkeypatch.setattr(reproducer, "MOST_BYTES", 1 << 20)
    monkeypatch.setattr(reproducer, "MOST_FILES", 9)
    path = made(tmp_path / "a.rvcase", {"a.rv": RV, "a.csv": "t,p\n" + "0,1\n" * (1 << 19)})
    assert "is larger than" in says(2, "run", path).err
    path = made(tmp_path / "b.rvcase", {f"{number}": "" for number in range(10)})
    assert "contains more than 9 files" in says(2, "why", path).err


@each(
    ("case", "told"),
    [
        ({"format": 2}, "of a later format (2), made by rvmon 9.9: install that"),
        ({"format": "x"}, "no reproducer, or a damaged one"),
        ({"attempt": None}, "no reproducer, or a damaged one"),
        ({"spec": "b.rv"}, "b.rv"),
        ({"recording": "b.csv"}, "b.csv"),
        ({"attempt": "Q#1"}, "no requirement `Q`"),
    ],
)
def test_a_wrong_or_newer_description_is_refused(tmp_path, says, case, told):
    path = made(tmp_path / "a.rvcase", {"a.rv": RV, "a.csv": "t,p\n0,1\n"}, **case)
    assert told in says(2, "why", path).err


@pytest.mark.slow
def test_a_damaged_reproducer_is_refused(base, says):
    assert clip("a.csv", *READING) == 0
    whole = (base / "a.rvcase").read_bytes()
    for place in range(0, len(whole), 37):
        damaged = bytearray(whole)
        damaged[place] ^= 0xFF
        (base / "b.rvcase").write_bytes(damaged)
        assert main(["run", "b.rvcase", "--quiet"]) in (0, 1, 2)
    empty = io.BytesIO()
    zipfile.ZipFile(empty, "w").close()
    for data in (b"", b"PK", whole[: len(whole) // 2], b"t,p\n0,1\n", empty.getvalue()):
        (base / "b.rvcase").write_bytes(data)
        assert "b.rvcase: no reproducer, or a damaged one" in says(2, "run", "b.rvcase").err


def test_a_specification_can_be_shown_by_another_name(tmp_path):
    (tmp_path / "a.rv").write_text("signal p : bool\nrequirement R\n  always q\n")
    with pytest.raises(rvmon.SpecError, match=r"--> base\.rv:3"):
        rvmon.load(tmp_path / "a.rv", name="base.rv")
