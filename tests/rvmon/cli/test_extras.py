"""A missing package is reported with the command that installs it."""

import re
import shutil
import sys
import tomllib
from pathlib import Path

import pytest
from fsspec.registry import _registry

import handover.cli
from rvmon.cli import main
from rvmon.errors import EXTRAS
from rvmon.recordings.messages.ros import bag_readers

ROOT = Path(__file__).parents[3]
LACKING = [
    ("pyarrow", "run base.rv base.parquet", "arrow"),
    ("pyarrow", "run base.rv base.csv --out v.parquet", "arrow"),
    ("pyarrow", "compare v.parquet v.parquet", "arrow"),
    ("mcap", "run base.rv base.csv --mcap v.mcap", "mcap"),
    ("rosbags", "run base.rv base.bag", "ros"),
    ("rosbags", "init base.bag --for base.rv", "ros"),
    ("backports", "run base.rv base.csv.zst", "zstd"),
    ("distributed", "run base.rv base.csv --dask localhost:1", "dask"),
    ("paho", "watch base.rv mqtt://localhost/robot", "mqtt"),
    ("cyclonedds", "watch base.rv dds:0", "dds"),
    ("fsspec", "run base.rv https://localhost/base.csv", "remote"),
    ("s3fs", "run base.rv s3://bucket/base.csv", "s3"),
    ("pymunk", "demo --out demo", "handover"),
    ("pymunk", "replay test.json", "handover"),
]


@pytest.mark.parametrize(("package", "words", "extra"), LACKING)
def test_a_missing_package_is_reported_with_the_command_that_installs_it(
    tmp_path, monkeypatch, capsys, package, words, extra
):
    monkeypatch.chdir(tmp_path)
    for name in ("base.rv", "base.csv"):
        shutil.copy(ROOT / "examples" / name, tmp_path)
    for name in ("v.parquet", "base.parquet", "base.bag", "base.csv.zst", "test.json"):
        (tmp_path / name).write_bytes(b"(\xb5/\xfd" if name.endswith("zst") else b"PAR1")
    for name in [name for name in sys.modules if name.partition(".")[0] == package]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, package, None)
    monkeypatch.setitem(sys.modules, "compression", None)
    monkeypatch.delitem(_registry, "s3", raising=False)  # from another test
    bag_readers.cache_clear()
    program = handover.cli.main if extra == "handover" else main
    assert program(words.split()) == 2
    told = capsys.readouterr()
    assert told.err.startswith("error: ")
    assert told.err.endswith(f": pip install 'rvmon[{extra}]'\n")
    assert told.out == ""


def test_every_package_is_in_its_extra():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    extras = project["optional-dependencies"]
    for package, extra in EXTRAS.items():
        assert package in {re.split(r"[<>=\[]", line)[0] for line in extras[extra]}
