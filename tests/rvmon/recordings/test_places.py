"""Recordings that are compressed, in folders, or at addresses."""

import gzip
import http.server
import os
from errno import EACCES
from functools import partial
from pathlib import Path
from threading import Thread

import pytest

import rvmon
from rvmon.cli import main
from rvmon.errors import TraceError
from rvmon.recordings.places import found_recordings

SPEC = """
spec door
signal width : real
requirement D1
  always width < 3
"""
ROWS = 5_000
CSV = "t,width\n" + "".join(f"{t / 100},{t % 7 / 2}\n" for t in range(ROWS))
LINES = "".join(f'{{"t": {t / 100}, "width": {t % 7 / 2}}}\n' for t in range(ROWS))


def zst(data: bytes) -> bytes:
    zstd = pytest.importorskip("backports.zstd")
    return zstd.compress(data, options={zstd.CompressionParameter.checksum_flag: 1})


PACKERS = {".gz": gzip.compress, ".zst": zst}


@pytest.fixture
def spec():
    return rvmon.loads(SPEC)


@pytest.mark.slow
@pytest.mark.parametrize("ending", PACKERS)
@pytest.mark.parametrize(("name", "text"), [("a.csv", CSV), ("a.jsonl", LINES)])
def test_a_packed_recording_gives_the_records_of_the_plain_one(tmp_path, spec, name, text, ending):
    plain, packed = tmp_path / name, tmp_path / (name + ending)
    plain.write_text(text)
    packed.write_bytes(PACKERS[ending](text.encode()))
    report = spec.evaluate(plain)
    assert report.verdicts["D1"] == "F"
    assert spec.evaluate(packed) == report
    assert list(spec.recording(packed)) == list(spec.recording(plain))


@pytest.mark.slow
@pytest.mark.parametrize("ending", PACKERS)
def test_a_packed_file_that_was_cut_off_is_told(tmp_path, ending, says):
    good, bad = tmp_path / "good.csv", tmp_path / f"bad.csv{ending}"
    good.write_text(CSV)
    bad.write_bytes(PACKERS[ending](CSV.encode())[:-200])
    (tmp_path / "door.rv").write_text(SPEC)
    told = says(2, "run", tmp_path / "door.rv", bad, good)
    assert "bad.csv" + ending in told.err
    assert "was it cut off?" in told.err
    assert "good.csv" in told.out.replace("\n", "")


@pytest.mark.parametrize("ending", PACKERS)
def test_damaged_compression_is_reported(tmp_path, spec, ending):
    """The checksum is at the end, after all data that could be unpacked."""
    path = tmp_path / f"a.csv{ending}"
    data = bytearray(PACKERS[ending](CSV.encode()))
    data[{".gz": -8, ".zst": -1}[ending]] ^= 1
    for content, why in ((data, r"\(.*(CRC|checksum)"), (CSV.encode(), ".* as its ending says")):
        path.write_bytes(content)
        with pytest.raises(TraceError, match=rf"a\.csv\.\w+: cannot be unpacked {why}"):
            spec.evaluate(path)


def test_only_text_is_read_packed(tmp_path, spec):
    with pytest.raises(TraceError, match="unpack it first"):
        spec.evaluate(tmp_path / "a.parquet.gz")


def test_a_starter_is_written_from_a_packed_recording(tmp_path, says):
    path = tmp_path / "a.csv.gz"
    path.write_bytes(gzip.compress(CSV.encode()))
    assert "signal width : real" in says(0, "init", path, "-o", "-").out


def test_a_folder_stands_for_the_recordings_in_it(tmp_path):
    for name in ("b.csv", "a.jsonl.gz", "notes.txt", "more/c.csv"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    found = [str(tmp_path / name) for name in ("a.jsonl.gz", "b.csv", "more/c.csv")]
    assert list(found_recordings([str(tmp_path)])) == found
    assert list(found_recordings([f"{tmp_path}/**"])) == found
    assert list(found_recordings([f"{tmp_path}/[ab]*", "-", "x.csv"])) == [*found[:2], "-", "x.csv"]


def test_a_folder_leaves_out_no_recording_in_silence(tmp_path, spec):
    for name in ("a.csv.xz", "b.bag.active", "c.csv"):
        (tmp_path / name).write_text("t,x\n0,1\n")
    found = list(found_recordings([str(tmp_path)]))
    assert [Path(one).name for one in found] == ["a.csv.xz", "b.bag.active", "c.csv"]
    for path in found[:2]:
        with pytest.raises(TraceError, match="use one of"):
            spec.evaluate(path)


def test_a_folder_that_cannot_be_listed_is_told(tmp_path, spec, monkeypatch):
    for name in ("a.csv", "closed/b.csv"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("t,x\n0,1\n")
    real = os.listdir

    def refuse(path):
        if Path(path).name == "closed":
            raise PermissionError(EACCES, "Permission denied", str(path))
        return real(path)

    monkeypatch.setattr(os, "listdir", refuse)  # whoever runs the tests may list every folder
    found = list(found_recordings([str(tmp_path)]))
    assert found == [str(tmp_path / "a.csv"), str(tmp_path / "closed")]
    with pytest.raises(TraceError, match=r"closed: Permission denied"):
        spec.evaluate(found[1])


@pytest.mark.parametrize(
    ("name", "fix"),
    [
        ("b.rv", "it is a specification, and a recording is expected here"),
        ("metadata.yaml", "a ROS 2 bag is named by its folder"),
        ("a.json", "an object per line, to a .jsonl file"),
        ("a.tsv", "name a table of text .csv"),
    ],
)
def test_a_file_that_is_no_recording_is_told_with_the_fix(tmp_path, spec, name, fix):
    (tmp_path / name).touch()
    with pytest.raises(TraceError, match=fix):
        spec.evaluate(tmp_path / name)


def test_a_folder_that_links_to_one_above_is_looked_through_once(tmp_path):
    for name in ("runs/a.csv", "more/b.csv"):
        (tmp_path / name).parent.mkdir()
        (tmp_path / name).touch()
    (tmp_path / "runs/again").symlink_to("..")
    (tmp_path / "runs/more").symlink_to("../more")
    found = list(found_recordings([str(tmp_path / "runs")]))
    assert [Path(one).name for one in found] == ["a.csv", "b.csv", "b.csv"]


@pytest.mark.parametrize("pattern", ["", "/*.csv"])
def test_a_folder_without_recordings_is_told(tmp_path, pattern):
    with pytest.raises(TraceError, match=r"there is no recording: one ends in \.csv"):
        list(found_recordings([f"{tmp_path}{pattern}"]))


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *words):
        """Logs nothing."""


@pytest.fixture
def server(tmp_path):
    pytest.importorskip("fsspec")
    pytest.importorskip("aiohttp")
    handler = partial(Quiet, directory=str(tmp_path))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as served:
        thread = Thread(target=served.serve_forever, args=(0.01,))  # shutdown time
        thread.start()
        yield f"http://127.0.0.1:{served.server_port}"
        served.shutdown()
        thread.join()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["a.csv", "a.csv.gz", "a.jsonl", "a.parquet"])
def test_an_address_is_read_as_the_file_there(tmp_path, spec, server, name):
    path = tmp_path / name
    path.write_bytes((LINES if name == "a.jsonl" else CSV).encode())
    if name == "a.csv.gz":
        path.write_bytes(gzip.compress(CSV.encode()))
    if name == "a.parquet":
        table = pytest.importorskip("pyarrow.csv").read_csv(path)
        pytest.importorskip("pyarrow.parquet").write_table(table, path)
    assert spec.evaluate(f"{server}/{name}") == spec.evaluate(path)
    assert list(spec.recording(f"{server}/{name}")) == list(spec.recording(path))


@pytest.mark.slow
def test_what_is_put_at_an_address_anew_is_read_anew(tmp_path, spec, server):
    for text, verdict in ((CSV, "F"), ("t,width\n0,1\n1,1\n", "P")):
        (tmp_path / "a.csv").write_text(text)
        assert spec.evaluate(f"{server}/a.csv").verdicts["D1"] == verdict


@pytest.mark.slow
def test_an_address_without_a_recording_does_not_stop_the_others(tmp_path, server, says):
    """It counts as a bad recording, like a missing file."""
    (tmp_path / "door.rv").write_text(SPEC)
    (tmp_path / "a.csv").write_text(CSV)
    words = ["run", str(tmp_path / "door.rv"), f"{server}/none.csv", f"{server}/a.csv"]
    told = says(2, *words)
    assert f"error: {server}/none.csv: there is nothing at this address" in told.err
    assert "a.csv" in told.out


def test_a_kind_of_address_that_is_not_known_is_told(spec):
    pytest.importorskip("fsspec")
    with pytest.raises(TraceError, match=r"nowhere://x/a\.csv: cannot be read .*nowhere"):
        spec.evaluate("nowhere://x/a.csv")


@pytest.mark.slow
def test_a_bucket_is_read_by_names_and_by_patterns(tmp_path, monkeypatch, capsys, says):
    pytest.importorskip("s3fs")
    server = pytest.importorskip("moto.server").ThreadedMotoServer(port=0)
    server.start()
    try:
        host, port = server.get_host_and_port()
        for name, value in {
            "AWS_ENDPOINT_URL": f"http://{host}:{port}",
            "AWS_ACCESS_KEY_ID": "none",
            "AWS_SECRET_ACCESS_KEY": "none",
            "AWS_DEFAULT_REGION": "us-east-1",
        }.items():
            monkeypatch.setenv(name, value)
        bucket = pytest.importorskip("fsspec").filesystem("s3", skip_instance_cache=True)
        bucket.mkdir("runs")
        for name in ("monday.csv", "tuesday.csv"):
            bucket.pipe(f"runs/{name}", CSV.encode())
        (tmp_path / "door.rv").write_text(SPEC)
        told = says(1, "run", tmp_path / "door.rv", "s3://runs/*.csv").out
        assert "s3://runs/monday.csv" in told
        assert "s3://runs/tuesday.csv" in told
        assert main(["run", str(tmp_path / "door.rv"), "s3://runs/none.csv"]) == 2
        assert "there is nothing at this address" in capsys.readouterr().err
    finally:
        server.stop()
