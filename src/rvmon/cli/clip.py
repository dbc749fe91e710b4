"""`rvmon clip`: cut a recording around an attempt."""

from __future__ import annotations

import argparse
import shlex
from bisect import bisect_left
from collections.abc import Iterable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from rvmon import __version__
from rvmon.cli import reading
from rvmon.cli.evaluation import Options, judge
from rvmon.cli.options import constants_of, refuse_over
from rvmon.cli.output import say, warn
from rvmon.errors import RvmonError
from rvmon.files import refuse_no_file
from rvmon.language.checked.specification import Mode
from rvmon.recordings.clip import clip, refuse_place
from rvmon.recordings.clip_piece import Copied, Piece, values_before
from rvmon.recordings.last_updates import last_of
from rvmon.recordings.places import name_of
from rvmon.session import Spec, load
from rvmon.trace.sample import Sample
from rvmon.trace.time import TIME_LIMIT, format_stamp, format_stamped
from rvmon.verdicts import LAW
from rvmon.verdicts.attempt import Attempt, Decision
from rvmon.verdicts.report import Report, report_of

if TYPE_CHECKING:
    from rvmon.recordings.batch import Batch


def run_clip(arguments: argparse.Namespace) -> int:
    """Find the attempt, cut the recording, judge the cut, and return the exit code."""
    data = arguments.data
    out, case = _places(arguments)
    if case is not None and arguments.attempt is None:
        raise RvmonError("a reproducer shows an attempt: name it, such as R1#3")
    if arguments.attempt is None and arguments.start is None and arguments.stop is None:
        raise RvmonError("name what to cut out: an attempt such as R1#3, or --from T and --to T")
    spec = reading.reading_spec(
        load(arguments.spec, const=constants_of(arguments.const)), arguments
    )
    refuse_place(data, out)
    refuse_over([out, case], [data, arguments.spec, arguments.binding])
    for one in (out, case):
        if one is not None:
            refuse_no_file(one)
    attempt = None
    if arguments.attempt is not None:
        name, exact = reading.named_attempt(arguments.attempt, spec)
        attempt = reading.chosen_attempt(_report(spec, arguments, data, name), name, exact)
    piece = _piece(spec, arguments, attempt)
    with TemporaryDirectory(prefix="rvmon-") as folder:
        place = out or str(Path(folder, name_of(data)))
        copied = clip(data, piece, place)
        size = f"{copied.count} {'entry' if copied.count == 1 else 'entries'} of {data}"
        span = f"{format_stamp(copied.first)} to {format_stamp(copied.last)}"
        say(f"{out or case}: {size}, {span}")
        if piece.held:
            say(f"carried to its start: {', '.join(f'`{name}`' for name in piece.held)}")
        if attempt is None:
            return 0
        again = _report(spec, arguments, place, attempt.requirement)
        same = _same(spec, attempt, again, piece)
        if same is None:
            _warn_of_another(data, place, attempt, again, copied)
            return 1
        when = ""
        if same.decided is not None:
            when = f", decided at {format_stamped(same.decided, attempt.origin)}"
        made = Path(out or case or place).name
        say(f"{attempt.name} is {same.name} in {made}: {same.verdict}{when}, as in {data}")
        if case is not None:
            _write_case(arguments, case, place, same)
    return 0


def _places(arguments: argparse.Namespace) -> tuple[str | None, str | None]:
    out, case = arguments.out, arguments.reproducer
    if out is not None and out.endswith(reading.ENDING) and case is None:
        out, case = None, out
    if out is None and case is None:
        raise RvmonError("name the output: -o FILE, or --reproducer FILE.rvcase")
    if case is not None and not case.endswith(reading.ENDING):
        raise RvmonError(f"cannot write {case}: the name of a reproducer ends in {reading.ENDING}")
    return out, case


def _write_case(arguments: argparse.Namespace, out: str, place: str, attempt: Attempt) -> None:
    from rvmon.reproducer import Case, write_case

    case = Case(
        __version__,
        LAW,
        attempt.name,
        attempt.verdict.value,
        attempt.triggered,
        attempt.decided,
        arguments.spec,
        place,
        arguments.binding,
        tuple(arguments.const),
        arguments.time,
        tuple(arguments.map),
        arguments.nan,
        arguments.clock,
        arguments.allow_missing,
    )
    write_case(out, case)
    named = shlex.quote(out)
    say(f"{out}: `rvmon why {named}` explains {attempt.name}, `rvmon run {named}` evaluates it")


def _report(spec: Spec, arguments: argparse.Namespace, trace: str, name: str) -> Report:
    """The report of a recording; if it breaks off, of the attempts decided before."""
    options = Options((name,), allow_missing=reading.allowed_names(arguments.allow_missing))
    judged = judge(spec, trace, options, is_alone=True)
    if judged.report is not None:
        return judged.report
    if not judged.before:
        raise RvmonError(judged.error)
    warn(f"warning: {judged.error}; attempts decided before that count")
    return report_of([name], judged.before)


def _piece(spec: Spec, arguments: argparse.Namespace, attempt: Attempt | None) -> Piece:
    """The piece to cut out, with the values carried to its start."""
    recording = reading.opened(spec, arguments.data)
    ordered = spec.checked.max_delay is None
    start, stop = -TIME_LIMIT, TIME_LIMIT
    if attempt is not None:
        start = _start_of(spec, attempt) - arguments.before
        decided = attempt.decided
        if decided is not None:
            # In a recording only a sample advances time, so the cut needs one after the decision.
            stop = max(decided + arguments.after, _first_from(decided, recording.pieces()))
    start = start if arguments.start is None else arguments.start
    stop = stop if arguments.stop is None else arguments.stop
    stale_after = {
        name: signal.stale_after
        for name, signal in spec.checked.signals.items()
        if signal.stale_after is not None
    }
    held = values_before(recording.pieces(), start, spec.schema, stale_after, ordered=ordered)
    return Piece(start, stop, spec.schema, ordered, held)


def _first_from(instant: int, pieces: Iterable[Batch | Sample]) -> int:
    """The first instant of a recording at or after `instant`; `instant` itself if there is none."""
    for piece in pieces:
        if last_of(piece) >= instant:
            times = [piece.t] if isinstance(piece, Sample) else piece.times
            return int(times[bisect_left(times, instant)])
    return instant


def _start_of(spec: Spec, attempt: Attempt) -> int:
    """The trigger; in an episode, which may have lasted for hours, the start of what failed."""
    blame = attempt.blame
    if blame is None or spec.requirements[attempt.requirement].mode is Mode.UPON:
        return attempt.triggered
    return max(attempt.triggered, min(blame.at, default=blame.window[0]))


def _same(spec: Spec, attempt: Attempt, report: Report, piece: Piece) -> Attempt | None:
    """The attempt on the piece that equals `attempt` on the whole recording; `None` if none does.

    An episode that started before the piece starts with it. An attempt settled by the end of the
    recording is settled by the end of the piece.
    """
    is_episode = spec.requirements[attempt.requirement].mode is Mode.WHENEVER
    by_end = attempt.decision is not Decision.PREFIX
    first = max(piece.start, attempt.triggered) if is_episode else attempt.triggered
    for one in report.attempts:
        triggered = max(piece.start, one.triggered) if is_episode else one.triggered
        if (
            one.verdict is attempt.verdict
            and one.in_doubt is attempt.in_doubt
            and one.captured == attempt.captured
            and one.decision is attempt.decision
            and (by_end or one.decided == attempt.decided)
            and (triggered == first or (is_episode and one.triggered <= _start_of(spec, attempt)))
        ):
            return one
    return None


def _warn_of_another(
    data: str, place: str, attempt: Attempt, report: Report, copied: Copied
) -> None:
    """Warn that the attempt differs on the piece, with the option that may help."""
    verdict = report.verdicts[attempt.requirement]
    if attempt.decided is not None and copied.last < attempt.decided:
        why = f"it was decided at {format_stamped(attempt.decided, attempt.origin)}: a later --to"
    else:
        why = "it depends on earlier data: a longer --before"
    warn(
        f"warning: {attempt.name} is {attempt.verdict} in {data}, but not in "
        f"{Path(place).name}, where {attempt.requirement} is {verdict}; {why} may fix it"
    )
