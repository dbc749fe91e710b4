"""Recordings of other tools, message by message beside what each format's own tool says of them.

    python -m benchmarks.formats [--only FORMAT ...] FILE ...

The tools are found in the environment that runs this: `ulog2csv`, `mavlogdump.py`, asammdf's export
to CSV, `can_logconvert` with `cantools decode`, the decoders of mcap, h5py, scipy and pandas. Files
are named by the start of their SHA-256. A value is equal if the tool's text is what it rounds to.
"""

from __future__ import annotations

import argparse
import csv
import hashlib
import json
import math
import re
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import Any

import numpy as np
from benchmarks.output import show

from rvmon.recordings.messages.columns import path_of
from rvmon.recordings.messages.file import MessageFile
from rvmon.recordings.messages.forms import databases_beside
from rvmon.recordings.recording import format_of
from rvmon.recordings.values import shorten
from rvmon.trace.schema import Schema

Record = tuple[str, Any, Any]
"""Topic, stamp in ticks or as text in seconds, fields: mappings, objects, lists and values."""

Tool = Callable[[Path, Path, MessageFile], Iterator[Record]]


def ulog2csv(path: Path, folder: Path, ours: MessageFile) -> Iterator[Record]:
    """A file for each topic and instance; what has no stamp (0) is an outage here."""
    _called("ulog2csv", "-o", folder, path)
    for name in ours.topics:
        topic, _, number = name[1:].rpartition("_")
        first = folder / f"{path.stem}_{name[1:]}_0.csv"
        made = first if first.exists() else folder / f"{path.stem}_{topic}_{number}.csv"
        for row in _rows_of(made):
            if stamp := int(row.pop("timestamp")):
                yield name, stamp * 1000, row


def mavlogdump(path: Path, folder: Path, ours: MessageFile) -> Iterator[Record]:
    """An object for each message; of logs each says its time itself."""
    made = folder / "dump.json"
    with made.open("w") as file:
        source = ("--show-source",) if path.suffix.lower() == ".tlog" else ()
        command = ("mavlogdump.py", "--format", "json", *source, str(path))
        subprocess.run(command, stdout=file, stderr=subprocess.DEVNULL, check=True)
    for line in made.read_text().splitlines():
        if not line.startswith("{"):
            continue
        found = json.loads(line)
        meta, data = found["meta"], found["data"]
        kind, names = meta["type"], [f"/{meta['type']}"]
        names += [f"/{kind}_{value}" for value in data.values() if isinstance(value, int | str)]
        names += [f"/sys{meta.get('srcSystem')}_comp{meta.get('srcComponent')}/{kind}"]
        name = next((one for one in names if one in ours.topics), "")
        if not name or kind == "BAD_DATA":
            continue
        stamp: Any = f"{meta['timestamp']:.6f}"
        if path.suffix.lower() == ".bin":
            own = next(one for one in ("TimeUS", "TimeMS", "T") if one in data)
            stamp = data.pop(own) * (1_000 if own == "TimeUS" else 1_000_000)
        yield name, stamp, data


def asammdf(path: Path, folder: Path, ours: MessageFile) -> Iterator[Record]:
    """A file for each group of channels that has records; frames of CAN are decoded."""
    from asammdf import MDF

    if databases_beside(path):
        yield from cantools(path, folder, ours)
        return
    file: Any
    with MDF(path, use_display_names=False) as file:
        full = [one for one, group in enumerate(file.groups) if group.channel_group.cycles_nr]
        file.export(
            "csv", folder / "made.csv", single_time_base=False, time_from_zero=False, overwrite=True
        )
    for name, group in zip(ours.topics, full, strict=True):
        for made in folder.glob(f"made.ChannelGroup_{group}_*.csv"):
            for row in _rows_of(made):
                stamp = row.pop("timestamps")
                texts = {key: re.sub(r"^b'(.*)'$", r"\1", text) for key, text in row.items()}
                short = {key.rpartition(".")[2]: text for key, text in texts.items()}
                yield name, stamp, {path_of(key): one for key, one in (short | texts).items()}


_DECODED = re.compile(r"\((?P<t>[\d.]+)\) (?P<bus>\S+) .* :: (?P<name>\w+)\((?P<values>.*)\)")
_NUMBER = re.compile(r"^(-?\d\S*) .*")  # and its unit


def cantools(path: Path, folder: Path, ours: MessageFile) -> Iterator[Record]:
    """A line for each frame that the database beside the log knows."""
    [database] = [one for one in path.parent.iterdir() if one.suffix == ".dbc"]
    log = folder / "made.log"
    mask = []
    if path.suffix.lower() == ".mf4":
        _as_candump(path, log)
    else:
        _called("can_logconvert", path, log)
    if re.search(r" [0-9A-F]{8}#", log.read_text()) and "J1939" in database.read_text("latin-1"):
        mask = ["--frame-id-mask", hex(0x03FFFF00)]
    command = ["cantools", "decode", "--single-line", "--no-strict", *mask, str(database)]
    with log.open() as frames:
        told = subprocess.run(command, stdin=frames, capture_output=True, text=True, check=True)
    for line in told.stdout.splitlines():
        found = _DECODED.match(line)
        if found is None:
            continue
        bus = re.sub(r"\D", "", found["bus"])
        names = f"/{found['name']}", f"/can{bus}/{found['name']}"
        name = next((one for one in names if one in ours.topics), "")
        pairs = (one.partition(": ") for one in re.split(r", (?=\w+: )", found["values"]))
        values = {key: _NUMBER.sub(r"\1", text).strip("'") for key, _, text in pairs}
        yield name, found["t"], values


def _as_candump(path: Path, log: Path) -> None:
    """The frames of a measurement as candump writes them, by python-can; from its start."""
    import can
    from asammdf import MDF

    with MDF(path) as file:
        start = file.header.start_time.timestamp()
    with can.MF4Reader(path) as frames, can.CanutilsLogWriter(log) as made:
        for frame in frames:
            frame.timestamp -= start
            made.on_message_received(frame)


def bag_decoders(path: Path, _: Path, __: MessageFile) -> Iterator[Record]:
    """Bags: the messages as the decoders of mcap read them, by definitions of the bag or of ROS."""
    from mcap.records import Schema as Described
    from mcap_ros1.decoder import DecoderFactory as First
    from mcap_ros2.decoder import DecoderFactory as Second
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    encoding, factory = ("ros1", First()) if path.suffix == ".bag" else ("cdr", Second())
    latest = get_typestore(Stores.LATEST)
    with AnyReader([path], default_typestore=latest) as bag:
        decoders = {}
        for one in bag.connections:
            text = one.msgdef.data or bag.typestore.generate_msgdef(one.msgtype, ros_version=2)[0]
            form = "ros1msg" if encoding == "ros1" else "ros2msg"
            kind = one.msgtype.replace("/msg/", "/") if encoding == "ros1" else one.msgtype
            described = Described(one.id + 1, text.encode(), form, kind)
            decoders[one.id] = factory.decoder_for(encoding, described)
        for connection, t, raw in bag.messages():
            yield connection.topic, t, decoders[connection.id](raw)


def mcap_decoders(path: Path, _: Path, ours: MessageFile) -> Iterator[Record]:
    """MCAP: the messages as the libraries of each encoding decode them."""
    from mcap.reader import make_reader
    from mcap_protobuf.decoder import DecoderFactory as Buffers
    from mcap_ros1.decoder import DecoderFactory as First
    from mcap_ros2.decoder import DecoderFactory as Second

    factories = [First(), Second(), Buffers()]
    with path.open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            topic = ours.topics.get(channel.topic)
            if topic is None or topic.fault:
                continue
            if channel.message_encoding == "json":
                yield channel.topic, message.log_time, json.loads(message.data)
                continue
            made = [one.decoder_for(channel.message_encoding, schema) for one in factories]
            decode = next(one for one in made if one is not None)
            yield channel.topic, message.log_time, decode(message.data)


def h5py(path: Path, _: Path, ours: MessageFile) -> Iterator[Record]:
    """HDF5: the arrays of each group that is a topic."""
    import h5py

    with h5py.File(path) as file:
        for name in ours.topics:
            group = file if name == "/data" else file[name]
            yield from _by_rows(name, {key: one[()] for key, one in group.items() if one.shape})


def scipy(path: Path, _: Path, ours: MessageFile) -> Iterator[Record]:
    """MATLAB: the arrays of each structure that is a topic; newer files are HDF5."""
    from scipy.io import loadmat

    content = loadmat(path, squeeze_me=True, simplify_cells=True)
    for name in ours.topics:
        found = content if name == "/data" else content[name.strip("/")]
        yield from _by_rows(name, {key: one for key, one in found.items() if key[0] != "_"})


def _by_rows(name: str, arrays: Mapping[str, Any]) -> Iterator[Record]:
    time = next(key for key in arrays if key.lower() in ("t", "time", "timestamp", "timestamps"))
    stamps = arrays[time].reshape(-1).tolist()
    kept = {key: one for key, one in arrays.items() if key != time and len(one) == len(stamps)}
    for row, stamp in enumerate(stamps):
        yield name, f"{stamp:.9f}", {key: one[row] for key, one in kept.items()}


TOOLS: Mapping[str, Tool] = {
    "ulog": ulog2csv,
    "dataflash": mavlogdump,
    "tlog": mavlogdump,
    "mdf": asammdf,
    "can": cantools,
    "ros1": bag_decoders,
    "ros2": bag_decoders,
    "mcap": mcap_decoders,
    "hdf5": h5py,
    "mat": scipy,
}
"""What says what is in a file, by its format."""


def _called(*words: object) -> None:
    subprocess.run([str(one) for one in words], check=True, capture_output=True)


def _rows_of(path: Path) -> Iterator[dict[str, Any]]:
    with path.open(newline="") as file:
        for row in csv.DictReader(file):
            yield {str(key): value for key, value in row.items()}


def flat(content: Any, prefix: str = "") -> Iterator[tuple[str, Any]]:
    """The values of a message by the path of each; `a[0]` is an element."""
    if hasattr(content, "tolist"):
        content = content.tolist()
    if isinstance(content, bytes):
        content = content.decode("utf-8", "replace") if prefix.count("[") else list(content)
    if isinstance(content, Mapping):
        pairs: Iterable[tuple[str, Any]] = content.items()
    elif isinstance(content, Sequence) and not isinstance(content, str):
        for place, inner in enumerate(content):
            yield from flat(inner, f"{prefix}[{place}]")
        return
    elif hasattr(content, "ListFields"):
        pairs = [(one.name, getattr(content, one.name)) for one in content.DESCRIPTOR.fields]
    elif is_dataclass(content):
        pairs = [(one.name, getattr(content, one.name)) for one in fields(content)]
    elif names := getattr(content, "__slots__", None) or getattr(content, "__dict__", None):
        pairs = [(one, getattr(content, one)) for one in names]
    else:
        yield prefix, content
        return
    for key, value in pairs:
        if not key.startswith("__") and not (is_dataclass(content) and key.isupper()):  # constants
            yield from flat(value, f"{prefix}.{key}" if prefix else str(key))


def is_same(ours: Any, theirs: Any) -> bool:
    """Whether what a tool says of a value is this one; a text may be rounded."""
    if ours is None or (isinstance(ours, float) and math.isnan(ours)):
        return theirs in (None, "", "nan", "NaN") or bool(theirs != theirs)
    if isinstance(theirs, str) and not isinstance(ours, str):
        return _rounds_to(float(ours), theirs)
    if isinstance(ours, str):
        return str(theirs).strip("\0 ") == ours.strip("\0 ")
    return bool(ours == theirs)


def _rounds_to(value: float, text: str) -> bool:
    words = {"true": "1", "True": "1", "false": "0", "False": "0"}
    try:
        said = Decimal(words.get(text, text))
    except InvalidOperation:
        return False
    if float(said) == value or np.float32(text if text not in words else said) == np.float32(value):
        return float(said) == value or float(np.float32(said)) == value
    return abs(said - Decimal(value)) * 2 <= Decimal(1).scaleb(int(said.as_tuple().exponent))


class Compared:
    """Records of a file beside those of its own tool.

    Attributes:
        equal: records of which each field is the same.
        different: the others, and those that one of the two lacks.
        first: the first difference in words.
    """

    def __init__(self, ours: MessageFile, theirs: Iterable[Record]) -> None:
        self.equal, self.different, self.first = 0, 0, ""
        by_topic: dict[str, list[tuple[Any, Any]]] = defaultdict(list)
        for topic, stamp, content in theirs:
            by_topic[topic].append((stamp, content))
        self._wanted = by_topic
        read = {name for name, one in ours.topics.items() if not one.fault}
        places: dict[str, int] = defaultdict(int)
        for topic, t, content in ours.read(read):
            place, own = places[topic], by_topic[topic]
            places[topic] += 1
            if place >= len(own):
                self._note(f"{topic} at {t}: the tool has no such record")
            else:
                self._note(self._difference(topic, t, content, *own[place]))
        for topic, own in by_topic.items():
            for stamp, _ in own[places[topic] :]:
                self._note(f"{topic} at {stamp}: only the tool has it")

    def _note(self, difference: str) -> None:
        self.equal += not difference
        self.different += bool(difference)
        self.first = self.first or difference

    def _difference(self, topic: str, t: int, content: Any, stamp: Any, theirs: Any) -> str:
        is_at = t == stamp if isinstance(stamp, int) else _rounds_to_seconds(t, stamp)
        if not is_at:
            return f"{topic}: at {t}, and of the tool at {stamp}"
        ours, said = dict(flat(content)), dict(flat(theirs))
        by_name = {_as_ours(one): value for one, value in said.items()}
        for path, value in ours.items():
            name = path if path in by_name else path_of(path)
            longer = [one for one in by_name if one.endswith(f"_{name}")]
            if name not in by_name and len(longer) == 1:
                [name] = longer
            if name not in by_name and value is not None:
                return f"{topic}.{path} at {t}: of the tool there are {sorted(by_name)[:4]}"
            if name in by_name and not is_same(value, by_name[name]):
                return f"{topic}.{path} at {t}: {value!r}, of the tool {by_name[name]!r}"
        return ""


def _rounds_to_seconds(t: int, stamp: str) -> bool:
    said = Decimal(stamp)
    digit = Decimal(1).scaleb(int(said.as_tuple().exponent))
    return abs(said - Decimal(t).scaleb(-9)) * 2 <= max(digit, Decimal(1).scaleb(-9))


_OF_ROS_1 = {"secs": "sec", "nsecs": "nanosec"}


def _as_ours(path: str) -> str:
    """The path of a field as it is read here: rosbags calls the parts of stamps as ROS 2 does."""
    above, dot, last = path.rpartition(".")
    return f"{above}{dot}{_OF_ROS_1.get(last, last)}"


def measured(path: Path, form: str) -> Sequence[str]:
    digest = hashlib.sha256(path.read_bytes()).hexdigest()[:12]
    schema = Schema({}, {})
    start = time.process_time()
    ours = MessageFile(str(path), form, schema)
    read = {name for name, one in ours.topics.items() if not one.fault}
    count = sum(1 for _ in ours.read(read))
    seconds = time.process_time() - start
    with tempfile.TemporaryDirectory() as folder:
        found = Compared(ours, TOOLS[form](path, Path(folder), ours))
    figures = (f"{one:,.0f}" for one in (count, found.equal, found.different, count / seconds))
    return form, path.name, digest, *figures, shorten(found.first, 200)


def main(argv: list[str]) -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=TOOLS, default=TOOLS, metavar="FORMAT")
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE")
    options = parser.parse_args(argv)
    titles = "format", "file", "SHA-256", "messages", "equal", "different", "messages/s", "first"
    forms = {path: format_of(str(path)) for path in options.files}
    show(titles, (measured(path, form) for path, form in forms.items() if form in options.only))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
