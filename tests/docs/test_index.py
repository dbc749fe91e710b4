"""The first page: what it says to type for each kind of data is typed."""

import re
import shlex

import pytest
from tests.docs.pages import ROOT
from tests.rvmon.recordings.messages import logs
from tests.tools import bags
from tests.tools.logs import write_ulog

import rvmon
from rvmon.cli import main

SPEC = "signal speed : real [m/s]\nrequirement B1\n  always speed <= 1 m/s\n"
ROWS = [(0, 0.25, 1), (1_000_000, 0.5, 1), (2_000_000, 0.0, 2)]
TABLE = (ROOT / "docs" / "index.md").read_text().partition("## Your data")[2].partition("\n## ")[0]
TYPED = [text.replace(r"\|", "|") for text in re.findall(r"`([^`]+)`", TABLE)]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with data of each kind."""
    for name in ("rosbags", "mcap", "pyarrow", "pyulog", "pymavlink", "asammdf", "h5py", "scipy"):
        pytest.importorskip(name)
    from pyarrow import csv, parquet

    monkeypatch.chdir(tmp_path)
    (tmp_path / "base.rv").write_text(SPEC)
    (tmp_path / "monday.csv").write_text("t,speed\n0,0.25\n1,0.5\n")
    (tmp_path / "other.csv").write_text("stamp,v_mean\n0,0.25\n1000,0.5\n")
    (tmp_path / "odom.csv").write_text("t,speed\n0,0.25\n1,0.5\n")
    (tmp_path / "status.csv").write_text("t,armed\n0.5,1\n")
    (tmp_path / "monday.jsonl").write_text('{"t": 0.1, "speed": 0.5}\n')
    parquet.write_table(csv.read_csv(tmp_path / "monday.csv"), tmp_path / "monday.parquet")
    driven = bags.drive(stops_in_s=0.4)
    bags.write_ros1(tmp_path / "monday.bag", driven)
    bags.write_ros2(tmp_path / "monday", driven, "sqlite3")
    bags.write_json_mcap(tmp_path / "monday.mcap", driven)
    write_ulog(tmp_path / "flight.ulg", ROWS)
    logs.write_dataflash(tmp_path / "flight.bin", ROWS)
    logs.write_mdf(tmp_path / "drive.mf4", ROWS)
    logs.write_hdf5(tmp_path / "drive.h5", ROWS)
    logs.write_mat(tmp_path / "drive.mat", ROWS)
    (tmp_path / "runs").mkdir()
    (tmp_path / "runs" / "monday.csv").write_text("t,speed\n0,0.25\n1,0.5\n")
    return tmp_path


@pytest.mark.slow
def test_what_is_to_be_typed_for_recordings_works(folder, capsys):
    """All recordings pass; of what is live the options are those that there are."""
    seen = []
    for command in [text for text in TYPED if text.startswith(("rvmon ", "./"))]:
        words = shlex.split(command.rpartition("| ")[2])[1:]
        to_file = words[words.index(">") + 1] if ">" in words else None
        if "watch" in words:
            assert main([*words, "--none-such"]) == 2
            assert "unrecognized arguments: --none-such\n" in capsys.readouterr().err, command
            continue
        code = main(words[: words.index(">")] if to_file else words)
        told = capsys.readouterr()
        assert code == 0, f"{command}\n{told.out}{told.err}"
        if to_file:
            (folder / to_file).write_text(told.out)
        seen.append(words[0])
    assert seen.count("run") > 10
    assert {"run", "init", "look", "export"} <= {*seen}


@pytest.mark.slow
def test_what_is_to_be_typed_in_python_works(folder):
    pandas = pytest.importorskip("pandas")
    known = {"spec": rvmon.load("base.rv"), "frame": pandas.read_csv("monday.csv")}
    typed = [text for text in TYPED if text.startswith("spec.")]
    assert len(typed) == 3
    for text in typed:
        assert eval(text, known) is not None, text  # noqa: S307 - our own page
