"""Archives of evidence: every changed byte is found, and hostile archives are refused."""

import io
import random
import struct
import zipfile

import pytest

from rvmon import evidence as keep
from rvmon.errors import RvmonError
from rvmon.evidence import TamperedError, pack, unpack

ENTRIES = {"verdicts.csv": b"R1,P\n", "spec/a.rv": "requirement é\n".encode(), "empty": b""}


@pytest.fixture
def file(tmp_path):
    """Write bytes to a file and return its path."""

    def written(data):
        path = tmp_path / "e.zip"
        path.write_bytes(data)
        return str(path)

    return written


def zipped(entries, compression=zipfile.ZIP_STORED):
    """A zip file written by another program."""
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", compression) as packed:
        for name, body in entries:
            packed.writestr(name, body)
    return made.getvalue()


def test_entries_are_read_back_whatever_their_order(file):
    """`sha256sum --check` can read the sums."""
    data = pack(ENTRIES)
    assert data == pack(dict(reversed(ENTRIES.items())))
    assert unpack(file(data)) == ENTRIES
    with zipfile.ZipFile(io.BytesIO(data)) as packed:
        assert packed.testzip() is None
        assert len(packed.read("SHA256SUMS").splitlines()) == len(ENTRIES)


@pytest.mark.slow
def test_a_change_of_any_byte_is_found(file):
    data = pack({"é": b"1"})
    draw = random.Random(1)
    for place in range(len(data)):
        other = bytearray(data)
        other[place] ^= 1 << draw.randrange(8)
        with pytest.raises(RvmonError):
            unpack(file(bytes(other)))


def test_a_changed_entry_is_named_and_hidden_bytes_are_refused(file):
    data = pack(ENTRIES)
    sums = zipfile.ZipFile(io.BytesIO(data)).read("SHA256SUMS")
    for name, entries in {
        "verdicts.csv": {**ENTRIES, "verdicts.csv": b"R1,F\n"},
        "more": {**ENTRIES, "more": b""},
        "its format, or a missing entry": {k: body for k, body in ENTRIES.items() if k != "empty"},
    }.items():
        with pytest.raises(TamperedError, match=f"changed since it was written: {name}"):
            unpack(file(zipped([*entries.items(), ("SHA256SUMS", sums)])))
    same = zipped([*sorted({**ENTRIES, "SHA256SUMS": sums}.items())])
    for other in (b"x" + data, data + b"x", data[:-2] + b"\1\0x", same):
        with pytest.raises(RvmonError):
            unpack(file(other))


def overlapping():
    """Thousands of entries that share the same bytes."""
    data = zipped([(f"{number:04}", b"x" * 10_000) for number in range(3)])
    with zipfile.ZipFile(io.BytesIO(data)) as packed:
        first = packed.infolist()[0]
        index = data[packed.start_dir : -22]
    size = len(index) // 3
    entry = index[:size]
    assert struct.unpack_from("<I", entry, 42) == (first.header_offset,)
    many = b"".join(entry[:46] + b"%04d" % number + entry[50:] for number in range(999))
    start = len(data) - 22 - len(index)
    end = struct.pack("<4s4H2LH", b"PK\5\6", 0, 0, 999, 999, len(many), start, 0)
    return data[:start] + many + end


ODD = "compressed, doubled or overlap"


@pytest.mark.parametrize(
    ("data", "told"),
    [
        pytest.param(zipped([("a", b"0" * 10**6)], zipfile.ZIP_DEFLATED), ODD, id="compressed"),
        pytest.param(zipped([("a", b"1"), ("b", b"2")]).replace(b"b", b"a"), ODD, id="doubled"),
        pytest.param(overlapping(), ODD, id="overlapping"),
        pytest.param(b"", "or is damaged", id="empty"),
        pytest.param(b"PK\5\6" + b"\xff" * 18, "or is damaged", id="no entries"),
        pytest.param(pack(ENTRIES)[:-30], "or is damaged", id="cut"),
    ],
)
def test_a_hostile_archive_is_refused(file, data, told):
    with pytest.raises(RvmonError, match=told):
        unpack(file(data))


def test_an_archive_that_is_too_large_is_not_read(file, monkeypatch):
    data = pack(ENTRIES)
    monkeypatch.setattr(keep, "MOST_BYTES", 100)
    with pytest.raises(RvmonError, match="larger than"):
        unpack(file(data))
    with pytest.raises(RvmonError, match="too large"):
        pack(ENTRIES)
