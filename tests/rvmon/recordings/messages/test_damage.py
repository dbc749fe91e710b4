"""Bags and MCAP files that cannot be read, or lack what is read: place, cause, fix."""

import sqlite3
import struct
from contextlib import closing

import pytest
from tests.rvmon.recordings.shop import OF_MESSAGES
from tests.tools.bags import START, write_json_mcap, write_ros1, write_ros2

import rvmon
from rvmon.cli import main
from rvmon.errors import UnknownNameError

pytest.importorskip("rosbags")
writer = pytest.importorskip("mcap.writer")
CompressionType, IndexType = writer.CompressionType, writer.IndexType

SPEC = """
spec base
signal speed : real
event go
requirement R1
  always speed < 3
requirement R2
  upon go
  then within 1 s speed < 1
"""
SENT = [
    part
    for t in range(400)
    for part in (
        ("/speed", START + t * 10**7, {"data": t / 300}),
        ("/mode", START + t * 10**7, {"data": "idle"}),
        ("/base/scan", START + t * 10**7, {"ranges": [1.0, 2.0], "state": 1}),
        ("/go", START + t * 10**7, {}),
    )
]


def written(folder, name):
    """A recording, and its file to damage."""
    path = OF_MESSAGES[name](folder / name, SENT)
    return path, next(iter(path.glob(f"{name}.*"))) if path.is_dir() else path


@pytest.fixture
def spec():
    return rvmon.loads(SPEC)


@pytest.mark.slow
@pytest.mark.parametrize("kept", [0.999, 0.5, 0.02])
@pytest.mark.parametrize(
    ("name", "fix"),
    [
        ("a.bag", "rosbag reindex"),
        ("sqlite3", "ros2 bag reindex"),
        ("mcap", "ros2 bag reindex"),
        ("b.mcap", "mcap recover"),
    ],
)
def test_what_was_cut_off_is_told_and_the_others_are_judged(tmp_path, name, fix, kept, says):
    whole = write_ros1(tmp_path / "whole.bag", SENT)
    path, file = written(tmp_path, name)
    data = file.read_bytes()
    file.write_bytes(data[: int(len(data) * kept)])
    (tmp_path / "base.rv").write_text(SPEC)
    told = says(2, "run", tmp_path / "base.rv", path, whole)
    assert f"error: {path}: cannot be read as" in told.err
    assert fix in told.err
    assert "whole.bag" in told.out.replace("\n", "")
    assert "Traceback" not in told.err


@pytest.mark.slow
@pytest.mark.parametrize("name", ["a.bag", "sqlite3", "mcap", "b.mcap"])
def test_damage_anywhere_is_told_or_harmless(tmp_path, spec, name):
    path, file = written(tmp_path, name)
    data = file.read_bytes()
    for place in range(0, len(data), max(1, len(data) // 20)):
        file.write_bytes(data[:place] + bytes([data[place] ^ 0x55]) * 30 + data[place + 30 :])
        try:
            told = ", ".join(spec.evaluate(path).verdicts)
        except rvmon.TraceError as error:
            told = str(error)
        assert told == "R1, R2" or told.startswith(str(path))


@pytest.mark.parametrize("name", ["a.bag", "a.db3", "a.mcap"])
@pytest.mark.parametrize("data", [b"", b"t,speed\n0,1\n" * 90, None], ids=["empty", "text", "none"])
def test_what_is_no_bag_is_told(tmp_path, spec, name, data):
    why = "No such file" if data is None else "(cannot be read as|is an empty|is not an? )"
    if data is not None:
        (tmp_path / name).write_bytes(data)
    with pytest.raises(rvmon.TraceError, match=f"{name}: {why}"):
        spec.evaluate(tmp_path / name)


@pytest.mark.slow
@pytest.mark.parametrize("is_folder", [True, False])
def test_a_bag_of_a_killed_recorder_is_reported(tmp_path, spec, is_folder):
    """Its last data is in a second file that readers of bags ignore."""
    folder, file = written(tmp_path, "sqlite3")
    with closing(sqlite3.connect(file)) as bag:
        bag.execute("PRAGMA journal_mode = WAL")
        bag.execute("DELETE FROM messages WHERE timestamp > ?", (START + 10**9,))
        bag.commit()
        path = folder if is_folder else file
        with pytest.raises(rvmon.TraceError, match=rf"a part of it is in {file.name}-wal"):
            spec.evaluate(path)
    folder.joinpath("metadata.yaml").unlink()  # SQLite closed it, which takes precedence
    assert spec.evaluate(file).verdicts["R1"] == "P"


def test_an_encrypted_bag_is_reported(tmp_path, spec):
    """ROS 1 can encrypt bags; the key is not available."""
    fields = {
        "op": b"\3",
        "index_pos": struct.pack("<Q", 4117),
        "conn_count": struct.pack("<I", 1),
        "chunk_count": struct.pack("<I", 1),
        "encryptor": b"rosbag/AesCbcEncryptor",
    }
    header = b"".join(
        struct.pack("<I", len(name) + 1 + len(value)) + name.encode() + b"=" + value
        for name, value in fields.items()
    )
    data = struct.pack("<I", len(header)) + header + struct.pack("<I", 0)
    (tmp_path / "a.bag").write_bytes(b"#ROSBAG V2.0\n" + data)
    with pytest.raises(rvmon.TraceError, match=r"AesCbcEncryptor.*decrypt it first"):
        spec.evaluate(tmp_path / "a.bag")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["a.bag", "sqlite3", "mcap", "b.mcap"])
def test_a_topic_that_is_missing_is_told_with_the_nearest(tmp_path, name, says):
    path, _ = written(tmp_path, name)
    (tmp_path / "base.rv").write_text(SPEC.replace("speed", "sped"))
    words = ["run", str(tmp_path / "base.rv"), str(path)]
    told = says(2, *words).err
    assert "there is no topic for these names, which requirements read:" in told
    assert "`sped`, read by R1, R2: did you mean `/speed`?" in told
    assert main([*words, "--map", "sped=/speed"]) == 0
    assert main([*words, "--allow-missing"]) == 1


@pytest.mark.slow
@pytest.mark.parametrize(
    ("declared", "column", "message"),
    [
        ("real", "/mode", "declared real, and `data` of topic /mode .* holds text"),
        ("bool", "/speed", "declared bool, and `data` of topic /speed .* holds numbers: compare"),
        ("{idle, busy}", "/base/scan.state", "whole numbers: name in a binding which `labels`"),
        ("real", "/base/scan.stat", "has no field `stat`: did you mean `state`"),
        ("real", "/base/scan.ranges", r"`ranges` is an array: .* `ranges\[0\]`"),
        ("real", "/base/scan.header.stamp", "is a message: name a field of it: `header.stamp.sec`"),
    ],
)
def test_a_field_that_does_not_fit_is_told(tmp_path, declared, column, message):
    path, _ = written(tmp_path, "sqlite3")
    spec = rvmon.loads(f"spec s\nsignal x : {declared}\nrequirement R\n  always known(x)\n")
    with pytest.raises(rvmon.TraceError, match=message):
        spec.evaluate(path, columns={"x": column})


def test_a_topic_of_several_fields_is_no_signal(tmp_path, spec):
    sent = [("/speed", START, {"now": 0.5, "wanted": 1.0})]
    path = write_json_mcap(tmp_path / "a.mcap", sent)
    with pytest.raises(rvmon.TraceError, match="is a message: name a field of it: `now"):
        spec.evaluate(path, columns={"speed": "/speed"})


def test_a_recording_without_messages_is_told(tmp_path, spec):
    write_ros1(tmp_path / "a.bag", [])
    with pytest.raises(rvmon.TraceError, match="there is no topic"):
        spec.evaluate(tmp_path / "a.bag")
    with pytest.raises(rvmon.TraceError, match="holds no topic that is read"):
        spec.evaluate(tmp_path / "a.bag", allow_missing=True)


def test_options_of_columns_are_none_of_messages(tmp_path, spec):
    path, _ = written(tmp_path, "a.bag")
    with pytest.raises(rvmon.TraceError, match="use --clock"):
        spec.evaluate(path, time="t")
    (tmp_path / "a.csv").write_text("t,speed,go\n0,1,0\n")
    with pytest.raises(rvmon.TraceError, match="use --map"):
        spec.evaluate(tmp_path / "a.csv", clock="header")
    with pytest.raises(UnknownNameError, match="expected log or header"):
        spec.evaluate(path, clock="wall")


def test_json_of_the_wrong_type_is_reported_with_its_message(tmp_path, spec):
    """JSON messages of a topic may differ."""
    sent = [("/speed", START, {"data": 1.0}), ("/speed", START + 1, {"data": "fast"})]
    path = write_json_mcap(tmp_path / "a.mcap", sent)
    with pytest.raises(rvmon.TraceError, match=r"message 2 of /speed: `speed`: `fast` is not"):
        spec.evaluate(path, allow_missing=True)


def test_a_size_beyond_the_memory_is_reported(tmp_path, spec):
    """In the first record of an MCAP file of ROS 2: the error names the file."""
    path, file = written(tmp_path, "mcap")
    data = bytearray(file.read_bytes())
    # An opcode and eight bytes of length, little-endian, follow the magic number.
    data[8 + 8] = 0x1E
    file.write_bytes(data)
    with pytest.raises(rvmon.TraceError, match="a size in it is beyond the memory"):
        spec.evaluate(path)


@pytest.mark.parametrize(
    "options",
    [{}, {"index_types": IndexType.NONE}, {"use_chunking": False, "enable_data_crcs": True}],
    ids=["listed chunks", "chunks", "no chunks"],
)
def test_a_value_with_a_wrong_checksum_is_reported(tmp_path, spec, options):
    """MCAP has checksums of chunks or of all data; the damaged value would be a valid number."""
    options = {"compression": CompressionType.NONE, **options}
    path = write_json_mcap(tmp_path / "a.mcap", SENT, **options)
    data = path.read_bytes()
    assert data.count(b'{"data": 0.5}') == 1
    path.write_bytes(data.replace(b'{"data": 0.5}', b'{"data": 9.5}'))
    with pytest.raises(rvmon.TraceError, match=r"a\.mcap: cannot be read as MCAP \(crc"):
        spec.evaluate(path)


@pytest.mark.parametrize("lacking", ["repeat_channels", "repeat_schemas"])
def test_a_summary_may_lack_what_the_file_has(tmp_path, spec, lacking):
    whole = spec.evaluate(write_json_mcap(tmp_path / "a.mcap", SENT))
    path = write_json_mcap(tmp_path / "b.mcap", SENT, **{lacking: False})
    found = spec.evaluate(path)
    assert (found.attempts, found.end) == (whole.attempts, whole.end)


@pytest.mark.slow
def test_a_bag_with_more_files_or_a_later_end_than_listed_is_reported(tmp_path, capsys, says):
    """As from a recorder that was killed in its second file."""
    fast = ("/speed", START + 9 * 10**9, {"data": 9.0})
    path, file = written(tmp_path, "sqlite3")
    other = write_ros2(tmp_path / "other", [*SENT, fast], "sqlite3")
    (tmp_path / "base.rv").write_text(SPEC)
    command = ["run", str(tmp_path / "base.rv"), str(path)]
    assert main(command) == 0
    file.write_bytes((other / "other.db3").read_bytes())
    capsys.readouterr()
    assert "`speed < 3` became false at 9 s" in says(1, *command).out
    (path / "sqlite3_1.db3").write_bytes(file.read_bytes())
    assert "metadata.yaml does not list sqlite3_1.db3" in says(2, *command).err


def test_a_summary_with_a_wrong_checksum_is_reported(tmp_path, spec):
    """The summary has the number of messages and the end of the recording."""
    path = write_json_mcap(tmp_path / "a.mcap", SENT)
    data = bytearray(path.read_bytes())
    data[-60] ^= 1
    path.write_bytes(data)
    with pytest.raises(rvmon.TraceError, match=r"a\.mcap: its summary is damaged"):
        spec.evaluate(path)


@pytest.mark.slow
def test_a_bag_with_fewer_messages_than_counted_is_reported(tmp_path, spec):
    """A database of ROS 2 does not show that rows are missing; `metadata.yaml` has the number."""
    path, file = written(tmp_path, "sqlite3")
    with closing(sqlite3.connect(file)) as database, database:
        database.execute("delete from messages where id > 1500")
    with pytest.raises(rvmon.TraceError, match=r"holds 7\d\d messages of .* counts 800: copy"):
        spec.evaluate(path)


@pytest.mark.parametrize("lost", ["/stop", "/temp"])
def test_a_topic_without_its_counted_messages_is_reported(tmp_path, monkeypatch, lost):
    """An MCAP index without the chunks of a topic; its statistics count all messages."""
    from mcap.writer import Writer

    sent = [
        (topic, START + 1000 * n, {"data": value})
        for n in range(5)
        for topic, value in (("/stop", True), ("/temp", 1.0))
    ]
    finish = Writer.finish

    def without_chunks(writer):
        writer._Writer__finalize_chunk()
        numbers = {one.topic: one.id for one in writer._Writer__channels.values()}
        chunks = writer._Writer__chunk_indices
        chunks[:] = [one for one in chunks if numbers[lost] not in one.message_index_offsets]
        finish(writer)

    spec = rvmon.loads(
        "event stop\nsignal temp : real\nrequirement R\n  always (stop -> temp > 2)\n"
    )
    path = write_json_mcap(tmp_path / "a.mcap", sent, chunk_size=1)
    assert spec.evaluate(path).verdicts["R"] == "F"
    monkeypatch.setattr(Writer, "finish", without_chunks)
    path = write_json_mcap(tmp_path / "a.mcap", sent, chunk_size=1)
    with pytest.raises(rvmon.TraceError, match=r"holds 5 messages of .* counts 10: copy"):
        spec.evaluate(path)
