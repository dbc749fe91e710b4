"""Reader of MAVLink telemetry (`.tlog`); needs pymavlink, the extra `mavlink`."""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from rvmon.errors import TraceError, needed
from rvmon.recordings.messages import Message, Messages, Topic
from rvmon.trace.sample import Outage
from rvmon.trace.schema import Kind
from rvmon.trace.time import TIME_LIMIT

_STAMP = 8  # bytes before each packet: microseconds since 1970

_MAGIC_1, _MAGIC_2 = 0xFE, 0xFD
_IS_SIGNED = 1
_Key = tuple[int, int, int, int]
"""Message number, system, component, and extra byte of the definition, which the checksum reveals
(or `_OURS`)."""

_OURS = -1  # the checksum agrees with the definition in the known dialect
_FAR = 3 * 24 * 3600 * 1_000_000  # microseconds; a stamp this far from the one before is invalid
_MOST = TIME_LIMIT // 1_000  # microseconds


class TelemetryMessages(Messages):
    """An open recording of telemetry; opening it reads it once to find all packets."""

    def __init__(self, path: Path) -> None:
        with needed("telemetry of MAVLink", "pymavlink"):
            from pymavlink.dialects.v10 import ardupilotmega as first
            from pymavlink.dialects.v20 import ardupilotmega
        self._dialect, self._first = ardupilotmega, first
        self._data = path.read_bytes()
        self.outages: list[Outage] = []  # where no packet has a valid checksum
        self._times, self._places, self._senders = array("q"), array("q"), array("q")
        self._keys: dict[_Key, int] = {}
        self._lost: set[_Key] = set()
        self._index()
        if not self._times:
            raise TraceError("holds no packet of MAVLink: is it telemetry?")
        self.count = len(self._times)  # of all packets
        # the last instant of packets and outages, ticks
        self.end = max(max(self._times), max((outage.until for outage in self.outages), default=0))
        senders = Counter(self._name_of(key) for key in self._keys if key not in self._lost)
        self._names = []
        for key in self._keys:
            name = "" if key in self._lost else self._name_of(key)
            sender = f"/sys{key[1]}_comp{key[2]}" if senders[name] > 1 else ""
            self._names.append(name and f"{sender}/{name}")
        # by name, one topic per message and sender; the name has the sender if there are several
        self.topics = {
            name: self._topic(name, key)
            for name, key in zip(self._names, self._keys, strict=True)
            if name
        }

    def _index(self) -> None:
        data, place, lost, last = self._data, 0, -1, -1
        while place + _STAMP < len(data):
            packet = self._packet_at(place)
            micros = int.from_bytes(data[place : place + _STAMP], "big")
            if packet is None or micros >= _MOST or (last >= 0 and abs(micros - last) > _FAR):
                lost = place if lost < 0 else lost
                place += 1
                continue
            if lost >= 0:
                self._note_loss(lost, last, micros)
                lost = -1
            size, key = packet
            last = micros
            self._times.append(micros * 1_000)
            self._places.append(place + _STAMP)
            self._senders.append(self._keys.setdefault(key, len(self._keys)))
            place += _STAMP + size
        self._drop_lone_packets()
        if self._times and (lost >= 0 or place < len(data)):
            end = max(self._times)
            self.outages.append(Outage(end, end + 1, "it ends within a packet"))

    def _drop_lone_packets(self) -> None:
        """Turn a lone packet that fits no known definition into an outage: it may be damaged.

        Other dialects send their messages repeatedly, so that several packets agree.
        """
        agreeing: Counter[tuple[int, int]] = Counter()
        for (message, _, _, extra), sender in self._keys.items():
            agreeing[message, extra] += self._senders.count(sender) if extra != _OURS else 2
        for key, sender in self._keys.items():
            if agreeing[key[0], key[3]] < 2:
                self._lost.add(key)
                one = self._senders.index(sender)
                near = self._times[max(0, one - 1) : one + 2]
                why = f"there is an unknown packet at byte {self._places[one]:,}"
                self.outages.append(Outage(min(near), max(near), why))
        self.outages.sort(key=lambda outage: outage.since)

    def _note_loss(self, place: int, last: int, micros: int) -> None:
        # A lost packet may have had the stamp of the packet before it.
        since = last * 1_000 if last >= 0 else micros * 1_000 - 1
        until = max(since, micros * 1_000)
        self.outages.append(Outage(since, until, f"there is no packet at byte {place:,}"))

    def _packet_at(self, place: int) -> tuple[int, _Key] | None:
        """The size and the key of the packet at a stamp's place; `None`: there is none."""
        data, start = self._data, place + _STAMP
        head = data[start : start + 10]
        if len(head) < 8 or head[0] not in (_MAGIC_1, _MAGIC_2):
            return None
        if head[0] == _MAGIC_1:
            header, signature = 6, 0
            system, component, number = head[3], head[4], head[5]
        else:
            if len(head) < 10:
                return None
            header, signature = 10, 13 if head[2] & _IS_SIGNED else 0
            system, component = head[5], head[6]
            number = head[7] | head[8] << 8 | head[9] << 16
        body_end = start + header + head[1]
        if body_end + 2 + signature > len(data):
            return None
        extra = self._extra(number, data[start + 1 : body_end], data[body_end : body_end + 2])
        if extra is None:
            return None
        return header + head[1] + 2 + signature, (number, system, component, extra)

    def _extra(self, number: int, body: bytes, checksum: bytes) -> int | None:
        """The extra byte of the definition that the checksum covers; `None`: no byte fits."""
        expected = int.from_bytes(checksum, "little")
        known, sum_of = self._dialect.mavlink_map.get(number), self._dialect.x25crc
        if known is not None and sum_of(body + bytes([known.crc_extra])).crc == expected:
            return _OURS
        # Try all extra bytes, each with one step of the X.25 checksum after the body's.
        before = sum_of(body).crc
        for extra in range(256):
            one = (extra ^ before) & 0xFF
            one ^= one << 4 & 0xFF
            if before >> 8 ^ one << 8 ^ one << 3 ^ one >> 4 == expected:
                return extra
        return None

    def _name_of(self, key: _Key) -> str:
        number, *_, extra = key
        known = self._dialect.mavlink_map.get(number) if extra == _OURS else None
        return f"message_{number}" if known is None else str(known.msgname)

    def _topic(self, name: str, key: _Key) -> Topic:
        number, _, _, extra = key
        known = self._dialect.mavlink_map.get(number)
        if known is None or extra != _OURS:
            fault = f"message {number} of MAVLink is of a dialect that is not ArduPilot's"
            return Topic(name, "", {}, fault)
        kinds = {"float": Kind.REAL, "double": Kind.REAL, "char": Kind.LABEL}
        places = [known.ordered_fieldnames.index(field) for field in known.fieldnames]
        leaves = {
            f"{field}[]" if known.array_lengths[place] and kind != "char" else field: kinds.get(
                kind, Kind.INT
            )
            for field, kind, place in zip(known.fieldnames, known.fieldtypes, places, strict=True)
        }
        return Topic(name, known.msgname, leaves, units=known.fieldunits_by_name)

    def read(self, topics: Collection[str]) -> Iterator[Message]:
        """Yield the packets of these topics in order of their stamps."""
        wanted = [place for place, name in enumerate(self._names) if name in topics]
        times, senders = np.asarray(self._times), np.asarray(self._senders)
        chosen = np.flatnonzero(np.isin(senders, wanted))
        chosen = chosen[np.argsort(times[chosen], kind="stable")]
        keys = list(self._keys)
        readers: dict[int, Callable[[int], Mapping[str, Any]]] = {}
        for one in chosen.tolist():
            sender = self._senders[one]
            if sender not in readers:
                readers[sender] = self._reader(keys[sender][0])
            yield self._names[sender], self._times[one], readers[sender](self._places[one])

    def _reader(self, number: int) -> Callable[[int], Mapping[str, Any]]:
        """Make a function from the offset of a valid packet to its fields by name.

        Trailing zeros of a packet are not sent. Packets of MAVLink 1 have no extension fields.
        """
        known = self._dialect.mavlink_map[number]
        first = self._first.mavlink_map.get(number, known)
        size, unpack, data = known.unpacker.size, known.unpacker.unpack, self._data
        slots: list[tuple[str, int, int, bool]] = []
        place = 0
        for field, length in zip(known.ordered_fieldnames, known.array_lengths, strict=True):
            is_text = known.fieldtypes[known.fieldnames.index(field)] == "char"
            slots.append((field, place, length, is_text))
            place += 1 if is_text or not length else length
        plain = [slot for slot in slots if slot[0] in first.fieldnames]

        def read(start: int) -> Mapping[str, Any]:
            is_first = data[start] == _MAGIC_1
            offset = start + (6 if is_first else 10)
            payload = data[offset : offset + data[start + 1]][:size].ljust(size, b"\0")
            parts = unpack(payload)
            return {
                field: parts[place].partition(b"\0")[0].decode("ascii", "replace")
                if is_text
                else list(parts[place : place + length])
                if length
                else parts[place]
                for field, place, length, is_text in (plain if is_first else slots)
            }

        return read
