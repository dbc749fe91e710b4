"""Archives of evidence: every byte counts, and a hostile one is refused."""

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
    """Writes bytes to a file."""

    def written(data):
        path = tmp_path / "e.zip"
        path.write_bytes(data)
        return str(path)

    return written


def zipped(entries, compression=zipfile.ZIP_STORED):
    """A zip file that somebody else wrote."""
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", compression) as packed:
        for name, body in entries:
            packed.writestr(name, body)
    return made.getvalue()


def test_it_comes_back_as_it_was(file):
    """Whatever the order in which entries are given; `sha256sum --check` can read the sums."""
    data = pack(ENTRIES)
    assert data == pack(dict(reversed(ENTRIES.items())))
    assert unpack(file(data)) == ENTRIES
    with zipfile.ZipFile(io.BytesIO(data)) as packed:
        assert packed.testzip() is None
        assert len(packed.read("SHA256SUMS").splitlines()) == len(ENTRIES)


@pytest.mark.slow
def test_every_byte_counts(file):
    data = pack({"é": b"1"})
    draw = random.Random(1)
    for place in range(len(data)):
        other = bytearray(data)
        other[place] ^= 1 << draw.randrange(8)
        with pytest.raises(RvmonError):
            unpack(file(bytes(other)))


def test_what_was_changed_is_named_and_nothing_hides_beside_the_entries(file):
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
    one = bytearray(index[:size])
    assert struct.unpack_from("<I", one, 42) == (first.header_offset,)
    many = b"".join(bytes(one[:46]) + b"%04d" % number + bytes(one[50:]) for number in range(999))
    end = struct.pack(
        "<4s4H2LH", b"PK\5\6", 0, 0, 999, 999, len(many), len(data) - 22 - len(index), 0
    )
    return data[: -22 - len(index)] + many + end


@pytest.mark.parametrize(
    ("data", "told"),
    [
        (zipped([("a", b"0" * 1_000_000)], zipfile.ZIP_DEFLATED), "compressed, doubled or overlap"),
        (zipped([("a", b"1"), ("b", b"2")]).replace(b"b", b"a"), "compressed, doubled or overlap"),
        (overlapping(), "compressed, doubled or overlap"),
        (b"", "no evidence"),
        (b"PK\5\6" + b"\xff" * 18, "no evidence"),
        (pack(ENTRIES)[:-30], "no evidence"),
    ],
)
def test_a_hostile_one_is_refused(file, data, told):
    with pytest.raises(RvmonError, match=told):
        unpack(file(data))


def test_one_that_is_too_large_is_not_read(file, monkeypatch):
    data = pack(ENTRIES)
    monkeypatch.setattr(keep, "MOST_BYTES", 100)
    with pytest.raises(RvmonError, match="larger than"):
        unpack(file(data))
    with pytest.raises(RvmonError, match="too large"):
        pack(ENTRIES)
