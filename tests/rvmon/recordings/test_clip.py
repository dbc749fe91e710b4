"""Clips in every format: entries are copied unchanged, and verdicts agree with the whole."""

import gzip
import json
import random

import pytest
from tests.rvmon.recordings.shop import HEADER, OF_MESSAGES, SHOP, sent_at_random, write_csv
from tests.tools.bags import START, write_json_mcap, write_ros2

import rvmon
from rvmon.cli import main
from rvmon.recordings import places

pytest.importorskip("rosbags")
pytest.importorskip("mcap_protobuf")
pytest.importorskip("pyarrow")

FAST = "spec s\nsignal speed : real\nrequirement R\n  always speed < {}\n"


def clipped(folder, spec, path, *words, out=None):
    """A piece of a recording, clipped with a specification."""
    (folder / "s.rv").write_text(spec)
    out = folder / (out or f"out{path.suffix}")
    assert main(["clip", str(folder / "s.rv"), str(path), *words, "-o", str(out)]) == 0
    return out


def write_parquet(path, sent):
    """The messages as Parquet, by way of CSV."""
    from pyarrow import csv, parquet

    text = write_csv(path.with_suffix(".csv"), sent, HEADER)
    options = csv.ConvertOptions(strings_can_be_null=True)
    parquet.write_table(csv.read_csv(text, convert_options=options), path)
    return path


def write_jsonl(path, sent):
    """The messages as lines, one for each."""
    lines = []
    for topic, t, content in sent:
        name = topic.strip("/").replace("/", ".")
        value = content if name == "pick" else content.get("data", True)
        lines.append(json.dumps({"t_ns": t, name: value}))
    path.write_text("\n".join(lines))
    return path


def write_packed(path, sent):
    plain = write_csv(path.with_suffix(""), sent, HEADER)
    path.write_bytes(gzip.compress(plain.read_bytes()))
    return path


FORMATS = {
    "a.csv": lambda path, sent: write_csv(path, sent, HEADER),
    "a.csv.gz": write_packed,
    "a.jsonl": write_jsonl,
    "a.parquet": write_parquet,
    **OF_MESSAGES,
}
"""By the name of a recording."""


@pytest.mark.slow
@pytest.mark.parametrize("name", FORMATS)
def test_a_clip_keeps_the_verdict_or_reports_the_difference(tmp_path, capsys, name):
    """The clip's verdict of the attempt is that of the whole, or the exit code tells."""
    (tmp_path / "shop.rv").write_text(SHOP)
    spec = rvmon.loads(SHOP)
    codes = []
    for seed in (0, 2):
        folder = tmp_path / str(seed)
        folder.mkdir()
        path = FORMATS[name](folder / name, sent_at_random(random.Random(seed), 120))
        failed = [one for one in spec.evaluate(path).attempts if one.verdict == "F"]
        for number, attempt in enumerate(failed[:4]):
            out = folder / f"out{number}{''.join(path.suffixes)}"
            words = ["clip", tmp_path / "shop.rv", path, attempt.name]
            words += ["--before", "30ms", "--after", "40ms", "-o", out]
            codes.append(main([str(word) for word in words]))
            again = spec.evaluate(out)
            found = {
                (one.requirement, one.triggered, one.decided, one.verdict, str(one.captured))
                for one in again.attempts
            }
            wanted = attempt.triggered, attempt.decided, attempt.verdict, str(attempt.captured)
            is_there = (attempt.requirement, *wanted) in found
            if attempt.requirement != "R2":  # its episodes may start with the clip
                assert is_there == (codes[-1] == 0)
            if codes[-1] == 0:
                assert any((one[0], one[2]) == (attempt.requirement, wanted[1]) for one in found)
            assert again.end <= attempt.decided + 60_000_000
    assert codes.count(0) >= 0.8 * len(codes) > 4
    told = capsys.readouterr()
    assert "carried to its start: `" in told.out


def messages(path):
    """All messages as bytes with their topics, types and stamps."""
    if path.suffix == ".mcap":
        from mcap.reader import make_reader

        with path.open("rb") as file:
            return [
                (channel.topic, schema.name, schema.data, one.publish_time, one.log_time, one.data)
                for schema, channel, one in make_reader(file).iter_messages()
            ]
    from rosbags import rosbag1, rosbag2

    reader = rosbag1.Reader if path.suffix == ".bag" else rosbag2.Reader
    with reader(path) as bag:
        return [
            (one.topic, one.msgtype, one.msgdef, one.digest, t, data)
            for one, t, data in bag.messages()
        ]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["a.bag", "sqlite3", "mcap", "b.mcap", "c.mcap"])
def test_messages_are_copied_byte_for_byte(tmp_path, name):
    sent = sent_at_random(random.Random(1), 300)
    path = FORMATS[name](tmp_path / name, sent)
    place = sorted(t for _, t, _ in sent)
    start, stop = place[100], place[200]
    words = ["--from", f"{start}ns", "--to", f"{stop}ns"]
    piece = messages(clipped(tmp_path, FAST.format(9), path, *words))
    whole = [one for one in messages(path) if start <= one[4] <= stop]
    carried = [one for one in piece if one not in whole]
    assert [(one[0], one[4]) for one in carried] in ([], [("/speed", start)])
    assert [one for one in piece if one not in carried] == whole


@pytest.mark.slow
@pytest.mark.parametrize("name", ["a.bag", "sqlite3", "mcap"])
def test_what_serves_late_subscribers_is_brought_along(tmp_path, monkeypatch, name):
    from rosbags import rosbag1, rosbag2
    from rosbags.interfaces import (
        Qos,
        QosDurability,
        QosHistory,
        QosLiveliness,
        QosReliability,
        QosTime,
    )

    never = QosTime(0, 0)
    qos = Qos(
        QosHistory.KEEP_LAST, 1, QosReliability.RELIABLE, QosDurability.TRANSIENT_LOCAL, never,
        never, QosLiveliness.AUTOMATIC, never, False,
    )  # fmt: skip
    writer = rosbag1.Writer if name == "a.bag" else rosbag2.Writer
    latched = {"latching": 1} if name == "a.bag" else {"offered_qos_profiles": [qos]}
    plain = writer.add_connection

    def add(self, topic, *rest, **more):
        return plain(self, topic, *rest, **more, **(latched if topic == "/mode" else {}))

    sent = [("/mode", START + t, {"data": said}) for t, said in enumerate(("old", "new"))]
    sent += [("/speed", START + t * 10**9, {"data": float(t)}) for t in range(2, 9)]
    with monkeypatch.context() as patched:
        patched.setattr(writer, "add_connection", add)
        path = FORMATS[name](tmp_path / name, sent)
    words = ["R", "--before", "0", "--after", "1s"]
    found = messages(clipped(tmp_path, FAST.format(6), path, *words, out=f"out-{name}"))
    assert [one[0] for one in found] == ["/mode", "/speed", "/speed"]
    assert found[0][4] == START + 6 * 10**9
    assert b"new" in found[0][5]


RISING = [("/speed", START + t * 10**9, {"data": t / 2}) for t in range(9)]


def write_bare(path):
    """MCAP without an index; channels are found by reading its messages."""
    from mcap.writer import IndexType

    bare = {"index_types": IndexType.NONE, "use_summary_offsets": False, "use_statistics": False}
    bare |= {"repeat_channels": False, "repeat_schemas": False}
    return write_json_mcap(path / "a.mcap", RISING, schemas=False, **bare)


def write_database(path):
    """A `.db3` without its bag's folder."""
    folder = write_ros2(path / "bag", RISING, "sqlite3")
    return next(folder.glob("*.db3")).rename(path / "a.db3")


@pytest.mark.slow
@pytest.mark.parametrize("write", [write_bare, write_database])
def test_a_part_of_what_there_should_be_is_cut(tmp_path, write):
    words = ["R", "--before", "1s", "--after", "1s"]
    out = clipped(tmp_path, FAST.format(2), write(tmp_path), *words)
    assert rvmon.loads(FAST.format(2)).evaluate(out).end == START + 5 * 10**9


@pytest.mark.slow
@pytest.mark.parametrize("late", [0, 3])
def test_stamps_of_headers_are_cut_by_what_was_recorded(tmp_path, late):
    sent = []
    for t in range(12):
        header = {"stamp": {"sec": 100 + t, "nanosec": 0}}
        at = START + (t + late) * 10**9
        sent.append(("/base/scan", at, {"header": header, "ranges": [t / 2], "state": t}))
    path = write_ros2(tmp_path / "bag", sent, "mcap")
    spec = "spec s\nsignal state : int\nrequirement R\n  always state < 6\n"
    words = ["R", "--map", "state=/base/scan.state", "--clock"]
    out = clipped(tmp_path, spec, path, *words, "header", "--before", "2s", "--after", "1s")
    stamps = [one[4] - START for one in messages(out)]
    assert stamps[-4:] == [(t + late) * 10**9 for t in (4, 5, 6, 7)]


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["float64", "timestamp[us, UTC]", "int64", "string"])
def test_parquet_keeps_its_types(tmp_path, kind):
    """With all kinds of stamps; carried values have the stamp of the start, or the one before."""
    import pyarrow as pa
    from pyarrow import parquet

    second = 1_700_000_000
    stamps = {
        "float64": [second + one / 8 for one in range(9)],
        "timestamp[us, UTC]": [second * 10**6 + one * 125_000 for one in range(9)],
        "int64": [second * 10**9 + one * 125_000_000 for one in range(9)],
        "string": [f"2023-11-14T22:13:{20 + one // 8}.{one % 8 * 125:03d}Z" for one in range(9)],
    }[kind]
    times = pa.array(stamps)
    if kind.startswith("timestamp"):
        times = times.cast(pa.timestamp("us", "UTC"))
    speed = pa.array([1.5] + [None] * 8, pa.float32())
    go = pa.array([None] * 4 + [True] + [None] * 4)
    path = tmp_path / "a.parquet"
    mode = pa.array(["a"] * 9).dictionary_encode()
    parts = pa.array([{"x": 1.0}] * 9)
    columns = [times, speed, go, pa.array(range(9)), mode, parts]
    names = ["stamp", "speed", "go", "other", "mode", "parts"]
    table = pa.table(columns, names)
    required = pa.field("other", pa.int64(), nullable=False)
    table = table.cast(table.schema.set(3, required))
    parquet.write_table(table, path)
    spec = "signal speed : real\nsignal mode : {a, b}\nevent go\nrequirement R\n  upon go then "
    unit = {"float64": "s", "int64": "ns"}.get(kind, "iso")
    words = ["R#1", "--time", f"stamp:{unit}", "--before", "100ms", "--after", "125ms"]
    piece = parquet.read_table(clipped(tmp_path, spec + "speed < 1\n", path, *words))
    assert piece.schema.types == table.schema.types
    assert piece.column("other").to_pylist() == [None, 4, 5]
    assert piece.column("speed").to_pylist() == [1.5, None, None]
    assert piece.column("mode").to_pylist() == ["a", "a", "a"]


@pytest.mark.law
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_rows_of_a_piece_are_copied_wherever_blocks_and_lines_end(tmp_path, monkeypatch, end):
    """Each row includes the lines after the previous one: blank ones, and those within quotes."""
    for seed in range(40):
        rng = random.Random(seed)
        rows = []
        for t in range(rng.randint(2, 40)):
            note = rng.choice(["", "plain", f'"two{end}lines"', f'"{end}"', '"a ""b"""'])
            rows.append(f"{end * rng.randint(0, 1)}{t},{rng.random():.3f},{note}{end}")
        path = tmp_path / f"{seed}.csv"
        header = rng.choice([f"t,speed,note{end}", f't,speed,"no{end}te"{end}'])
        path.write_text(header + "".join(rows), newline="")
        monkeypatch.setattr(places, "BLOCK", rng.choice([50, 200, 1 << 20]))
        first = rng.randrange(len(rows))
        last = rng.randrange(first, len(rows))
        out = clipped(tmp_path, FAST.format(9), path, "--from", str(first), "--to", str(last))
        with out.open(newline="") as file:
            assert file.read() == header + "".join(rows[first : last + 1])
