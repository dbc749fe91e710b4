"""Pipes, closed streams, full disks and limits of memory."""

import json
import os
import subprocess
import sys
from threading import Thread

import pytest

pytestmark = pytest.mark.process

SPEC = """
spec door
signal closed : bool
requirement D1
  always closed
"""
LINES = '{"t":0,"closed":true}\n{"t":1,"closed":false}\n'


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "door.rv").write_text(SPEC)
    (tmp_path / "run.jsonl").write_text(LINES)
    return tmp_path


def rvmon(folder, *words, stdout=subprocess.PIPE, **options):
    command = [sys.executable, "-m", "rvmon", *words]
    streams = {"stdout": stdout, "stderr": subprocess.PIPE}
    return subprocess.run(command, cwd=folder, timeout=60, check=False, **streams, **options)  # noqa: S603


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no named pipes")
def test_a_pipe_of_json_lines_is_read_and_one_of_csv_refused(folder):
    pipe = folder / "pipe.jsonl"
    os.mkfifo(pipe)
    writer = Thread(target=pipe.write_text, args=(LINES,))
    writer.start()
    done = rvmon(folder, "run", "door.rv", "pipe.jsonl")
    writer.join()
    assert done.returncode == 1, done.stderr
    os.mkfifo(folder / "pipe.csv")
    done = rvmon(folder, "run", "door.rv", "pipe.csv")
    assert done.returncode == 2
    assert b"pipe.csv: is a pipe" in done.stderr


def test_a_reader_that_closes_the_pipe_ends_the_run_silently(folder):
    """As `head` does. The exit code is no success, as the rest may have failed."""
    (folder / "good.jsonl").write_text(LINES.replace("false", "true"))
    for form in ("text", "json"):
        reading, writing = os.pipe()
        os.close(reading)
        with open(writing, "w") as gone:
            done = rvmon(folder, "run", "door.rv", "good.jsonl", "--format", form, stdout=gone)
        assert (done.returncode, done.stderr) == (141, b"")


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no full device")
@pytest.mark.parametrize("words", [("run", "door.rv", "run.jsonl"), ("--help",), ("run", "--help")])
def test_a_full_disk_is_reported(folder, words, monkeypatch):
    monkeypatch.delenv("PYTHONUNBUFFERED", raising=False)  # argparse ignores errors of writing
    with open("/dev/full", "w") as full:
        done = rvmon(folder, *words, stdout=full)
    assert done.returncode == 2
    assert b"error: the output cannot be written" in done.stderr


@pytest.mark.skipif(os.name != "posix", reason="closes a descriptor")
@pytest.mark.parametrize(
    ("closed", "trace", "told"),
    [
        (0, "-", (2, b"", b"error: -: holds no sample\n")),
        (1, "run.jsonl", (1, b"", b"")),
        (2, "run.jsonl", (1, b"run.jsonl", b"")),
    ],
)
def test_a_run_with_a_closed_descriptor_loses_only_that_stream(folder, closed, trace, told):
    words = ("run", "door.rv", trace)
    done = rvmon(folder, *words, preexec_fn=lambda: os.close(closed))
    assert (done.returncode, done.stdout[:9], done.stderr) == told


@pytest.mark.skipif(sys.platform != "linux", reason="file names are bytes")
def test_bytes_of_a_file_name_that_are_no_text_are_replaced(folder):
    name = os.fsencode(folder) + b"/n\xff.jsonl"
    with open(name, "w") as file:
        file.write(LINES)
    done = rvmon(folder, "run", "door.rv", os.fsdecode(name), "--format", "json")
    assert json.loads(done.stdout)["trace"].endswith("n\ufffd.jsonl")


@pytest.mark.skipif(sys.platform != "linux", reason="limits of memory are not kept elsewhere")
@pytest.mark.parametrize("jobs", ["1", "2"])
def test_max_memory_ends_a_run_that_needs_more(folder, jobs):
    (folder / "big.jsonl").write_text('{"t":0,"x":[[]' + ",[]" * 20_000_000 + "]}\n")
    words = ("--max-memory", "512", "--jobs", jobs, "door.rv", "run.jsonl", "big.jsonl")
    done = rvmon(folder, "run", *words)
    assert (done.returncode, done.stdout) == (2, b"")
    assert done.stderr == b"error: the memory is not enough, of 512 MB: raise --max-memory\n"
    done = rvmon(folder, "run", "--max-memory", "5", "door.rv", "run.jsonl")
    assert done.returncode == 2
    assert b"at least 512 MB" in done.stderr


@pytest.mark.skipif(sys.platform != "linux", reason="limits of memory are not kept elsewhere")
def test_a_parquet_file_that_needs_more_memory_is_not_called_damaged(folder):
    """One cell unpacks to 300 MB; a small file needs no more than the limit."""
    pa, pc = pytest.importorskip("pyarrow"), pytest.importorskip("pyarrow.compute")
    pq = pytest.importorskip("pyarrow.parquet")
    (folder / "said.rv").write_text("spec s\nsignal l : {a, b}\nrequirement R1\n  always l == b\n")
    for name, label, times in (("big", "a", 300_000_000), ("small", "b", 1)):
        labels = pc.binary_repeat(pa.array([label, "b"], pa.large_string()), pa.array([times, 1]))
        plain = {"use_dictionary": False, "write_statistics": False, "compression_level": -5}
        table = pa.table({"t": [0.0, 1.0], "l": labels})
        pq.write_table(table, folder / f"{name}.parquet", compression="zstd", **plain)
    words = ("run", "--max-memory", "768", "said.rv")
    done = rvmon(folder, *words, "big.parquet")
    assert done.stderr == b"error: the memory is not enough, of 768 MB: raise --max-memory\n"
    assert done.returncode == 2
    done = rvmon(folder, *words, "small.parquet")
    assert (done.returncode, done.stderr) == (0, b"")


@pytest.mark.parametrize("name", ["zero.csv", "zero.jsonl"])
def test_an_endless_line_is_refused(folder, name):
    (folder / name).symlink_to("/dev/zero")
    done = rvmon(folder, "run", "door.rv", name)
    assert (done.returncode, done.stdout) == (2, b"")
    assert b"line 1: longer than 67,108,864 characters" in done.stderr
