"""A recording with recorded losses, as samples and as columns, agrees with the oracle."""

import random
from dataclasses import dataclass, replace
from itertools import pairwise

import pytest
from tests.tools.compare import differences
from tests.tools.doors import content_of, whole
from tests.tools.each import each
from tests.tools.judgement import Judgement

import rvmon
from rvmon.recordings.batch import Batch
from rvmon.recordings.source import Source
from rvmon.recordings.table_recording import TableRecording
from rvmon.session import Spec
from rvmon.testing.generate.spec import Profile, random_spec
from rvmon.testing.generate.trace import TraceProfile, random_trace, show_case
from rvmon.trace.sample import Outage, Sample
from rvmon.trace.schema import Schema


@dataclass
class Lossy:
    """Pieces of a recording, and what it lost."""

    pieces_of: list[Batch | Sample]
    names: frozenset[str] | None
    end: int | None
    outages: tuple[Outage, ...]

    def pieces(self):
        return iter(self.pieces_of)


def in_columns(rng, case):
    """A case with samples of all names, and its pieces, cut anywhere."""
    content = whole(content_of(rng, case))
    samples = tuple(Sample(t, cells) for t, cells in content.rows)
    spec = case.spec
    columns = {"t_ns": [t for t, _ in content.rows]}
    columns |= {name: [cells[name] for _, cells in content.rows] for name in content.columns}
    kinds = {name: kind for name, kind in content.columns.items() if name in spec.signals}
    table = TableRecording(columns, Schema(kinds, {name: {} for name in content.events}))
    pieces = []
    for piece in table.pieces():
        if isinstance(piece, Sample):
            pieces.append(piece)
            continue
        cuts = sorted(rng.sample(range(len(piece.times) + 1), rng.randint(0, 1)))
        edges = [0, *cuts, len(piece.times)]
        pieces += [piece.cut(a, b) for a, b in pairwise(edges)]
    return replace(case, actions=samples, names=frozenset(content.columns)), pieces


@pytest.mark.law
@pytest.mark.parametrize("seed", range(2))
def test_what_a_recording_lost_counts_from_its_first_to_its_last_instant(seed):
    rng = random.Random(f"lossy {seed}")
    columns = 0
    for _ in range(25):
        spec = random_spec(rng, Profile(requirements=2, depth=2))
        case = random_trace(rng, spec, TraceProfile(outages=100, advances=False))
        whole_case, pieces = in_columns(rng, case)
        for own, found in ((case, list(case.samples)), (whole_case, pieces)):
            if not own.samples or not own.outages:
                continue
            outages = tuple(Outage(one.first, one.last, "lost", one.names) for one in own.outages)
            lost = Lossy(found, own.names, own.end, outages)
            told = Spec(spec).judge(Source(lost))
            assert not differences(Judgement(own).report, told), show_case(own)
            columns += any(isinstance(piece, Batch) for piece in found)
    assert columns > 8


@each("time", ["held", "sampled", "sampled every 1 ns"])
@each("last", [4, 5, 6])
def test_names_are_known_again_after_an_outage(time, last):
    """Whether its last instant is that of a sample or not."""
    spec = rvmon.loads(
        f"time {time}\nsignal x : real\nevent go\nrequirement R\n  upon go then x > 1\n"
    )
    samples = [Sample(t, {"x": 2.0, "go": t in (4, 9, 11)}) for t in range(1, 14)]
    told = spec.judge(Source(Lossy(samples, None, None, (Outage(3, last, "lost"),))))
    assert [one.verdict for one in told.attempts if one.triggered in (9, 11)] == ["P", "P"]
    assert [one.verdict for one in told.attempts if one.triggered < 9] == ["I"]
