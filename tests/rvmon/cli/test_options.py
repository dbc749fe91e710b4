"""What several commands are told in the same words."""

from pathlib import Path

import pytest

from rvmon.cli import main


@pytest.fixture
def folder(door):
    """An input of each kind."""
    (door / "a.csv").write_text("t,closed,knock\n0,true,false\n1,true,true\n2,false,false\n")
    (door / "b.csv").write_text("t,knock\n0,false\n")
    (door / "a.jsonl").write_text('{"t": 0, "closed": true}\n')
    (door / "lamp.ta").write_text("network lamp\n")
    (door / "known.toml").write_text("")
    (door / "link.rv").symlink_to("door.rv")
    assert main(["run", "door.rv", "a.csv", "--quiet", "--coverage", "a.cov"]) == 0
    return door


@pytest.mark.parametrize(
    ("words", "over"),
    [
        ("look a.csv -o a.csv", "a.csv"),
        ("look a.csv door.rv -o link.rv", "link.rv"),
        ("init a.csv -o a.csv --force", "a.csv"),
        ("export door.rv --to json -o door.rv", "door.rv"),
        ("export lamp.ta --to dot -o lamp.ta", "lamp.ta"),
        ("cover a.cov --report a.cov", "a.cov"),
        ("cover a.cov --ucis a.cov", "a.cov"),
        ("run door.rv a.csv b.csv --join --out b.csv", "b.csv"),
        ("run door.rv a.csv --known known.toml --junit known.toml", "known.toml"),
        ("watch door.rv a.jsonl --state door.rv", "door.rv"),
    ],
)
def test_no_command_writes_over_what_it_reads(folder, capsys, words, over):
    before = Path(over).read_bytes()
    assert main(words.split()) == 2
    assert f"cannot write {over}: it is an input: name another" in capsys.readouterr().err
    assert Path(over).read_bytes() == before


@pytest.mark.parametrize(
    "words",
    ["run door.rv a.csv --out v.csv --junit ./v.csv", "cover a.cov --report v.csv --ucis v.csv"],
)
def test_no_result_takes_the_place_of_another(folder, says, words):
    assert "v.csv: two results would go there" in says(2, *words.split()).err
    assert not Path("v.csv").exists()
