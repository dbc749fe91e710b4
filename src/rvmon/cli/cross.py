"""`rvmon cross`: a recording, judged in every way there is."""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from rvmon.cli.options import add_const, add_format, add_only, asked_ids, constants_of
from rvmon.cli.progress import busy
from rvmon.cli.reading import add_reading, opened, reading_spec
from rvmon.cli.say import say, say_json
from rvmon.errors import RvmonError

if TYPE_CHECKING:
    from rvmon.spec.checked.specification import CheckedSpec
    from rvmon.testing.cross import Crossing
    from rvmon.testing.peers.client import Peer
    from rvmon.trace.health import Health
    from rvmon.trace.sample import Recording, Sample

SHOWN = 5
"""Disagreements of one way on one requirement that are printed."""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
    parser = subparsers.add_parser(
        "cross",
        help="a recording, evaluated by every engine and installed peer: do they agree?",
        description="Evaluate a recording by every engine, by the reference oracle where it is "
        "small enough, by compiled C where there is a compiler, and by the other monitors that are "
        "installed (rtamt, reelay, mstlo, sentil) where they have such a formula. Prints who "
        "agrees; a disagreement is shown with attempt and instant, and exits with 1.",
        epilog="example: rvmon cross examples/base.rv examples/base.csv",
    )
    parser.add_argument("spec", metavar="SPEC", help="a .rv file")
    parser.add_argument("trace", metavar="TRACE", help="a recording, as `rvmon run` takes it")
    add_only(parser)
    add_const(parser)
    add_reading(parser)
    parser.add_argument(
        "--peers",
        metavar="PYTHON",
        default=sys.executable,
        help="the interpreter that has the peers (default: this one)",
    )
    add_format(parser)


def run(arguments: argparse.Namespace) -> int:
    """Judge, compare, show, and return the exit code."""
    from dataclasses import replace

    from rvmon.loading import load
    from rvmon.report.run_text import health_lines
    from rvmon.testing.case import Case
    from rvmon.testing.cross import crossings

    if arguments.trace == "-":
        raise RvmonError("error: standard input can be read once only: save the recording first")
    spec = reading_spec(load(arguments.spec, const=constants_of(arguments.const)), arguments)
    checked = spec.checked
    if not checked.requirements:
        raise RvmonError(f"error: {arguments.spec} has no requirement: there is nothing to compare")
    if (ids := asked_ids(arguments, spec)) is not None:
        chosen = {name: checked.requirements[name] for name in ids}
        checked = replace(checked, requirements=chosen)
    recording = opened(spec, arguments.trace)
    samples, late = _as_run_takes_them(recording, checked)
    if not samples:
        raise RvmonError(f"error: {arguments.trace} has no sample: nothing to compare")
    case = Case(checked, tuple(samples), recording.end, recording.names)
    with ExitStack() as stack:
        peers = {name: stack.enter_context(peer) for name, peer in _peers(arguments.peers)}
        with busy("judging in every way there is"):
            found = list(crossings(case, peers))
    if arguments.format == "json":
        say_json(_json(arguments, found, 0 if late is None else late[0], recording.health()))
    else:
        _print(arguments, found)
        for line in health_lines(recording.health()):
            say(line)
        if late is not None:
            say(f"  left out as `rvmon run` does, later than `max delay`: {_late_text(*late)}")
    judged = all(crossing.report is not None for crossing in found)
    return 0 if judged and all(crossing.agrees for crossing in found) else 1


def _as_run_takes_them(
    recording: Recording, spec: CheckedSpec
) -> tuple[list[Sample], tuple[int, int] | None]:
    """The samples in order of time, and how many came too late, with the first one's instant."""
    from rvmon.cli.post_analysis import in_order
    from rvmon.monitor.inputs.intake import Intake

    if not spec.max_delay:
        return in_order(recording), None
    intake = Intake(spec.max_delay, spec.events)
    samples = [ready for one in recording for ready in intake.take(one.t, one.values)]
    samples += intake.close()
    return samples, intake.late


def _late_text(count: int, first: int) -> str:
    from rvmon.trace.time import format_ticks

    if count == 1:
        return f"the sample at {format_ticks(first)}"
    return f"{count:,} samples, the first at {format_ticks(first)}"


def _peers(python: str) -> Iterator[tuple[str, Peer]]:
    """The peers that an interpreter has."""
    from rvmon.testing.peers.client import SHIPPED, Peer

    for name in SHIPPED:
        module = {"mstlo": "mstlo_python"}.get(name, name)
        code = f"import importlib.util, sys; sys.exit(not importlib.util.find_spec({module!r}))"
        try:
            done = subprocess.run([python, "-c", code], capture_output=True, check=False)  # noqa: S603 - our words
        except OSError as error:
            raise RvmonError(f"error: --peers {python}: {error.strerror or error}") from None
        if done.returncode == 0:
            yield name, Peer(Path(python), name)


def _json(
    arguments: argparse.Namespace, found: Sequence[Crossing], late: int, health: Sequence[Health]
) -> str:
    import msgspec

    document = {
        "spec": arguments.spec,
        "trace": arguments.trace,
        "left_out": late,
        "agree": all(crossing.agrees for crossing in found),
        "requirements": {
            crossing.requirement: {
                "verdict": crossing.report and crossing.report.verdicts[crossing.requirement],
                "attempts": 0 if crossing.report is None else len(crossing.report.attempts),
                "ways": {
                    way: {"skipped": answer.skipped}
                    if answer.skipped
                    else {"agrees": not answer.differences, "differences": answer.differences}
                    for way, answer in crossing.answers.items()
                },
            }
            for crossing in found
        },
        "health": health,
    }
    return msgspec.json.encode(document).decode()


def _print(arguments: argparse.Namespace, found: Sequence[Crossing]) -> None:
    from rich import box
    from rich.table import Table
    from rich.text import Text

    from rvmon.report.style import verdict_text
    from rvmon.report.terminal import Terminal
    from rvmon.testing.cross import BASELINE

    console = Terminal(soft_wrap=True)
    console.print(f"{arguments.trace}  by {arguments.spec}; compared with the engine `{BASELINE}`")
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("")
    for crossing in found:
        table.add_column(crossing.requirement, justify="right")
    shown = (
        verdict_text(one.report.verdicts[one.requirement]) if one.report else "–" for one in found
    )
    table.add_row("verdict", *shown)
    table.add_row(
        "attempts", *(str(len(one.report.attempts)) if one.report else "–" for one in found)
    )
    ways = dict.fromkeys(way for crossing in found for way in crossing.answers)
    for way in ways:
        table.add_row(way, *(_cell(crossing, way) for crossing in found))
    console.print(table)
    console.print("  = agrees   ≠ disagrees   – not asked")
    for line in _remarks(found, list(ways)):
        console.print(Text(line))


def _cell(crossing: Crossing, way: str) -> str:
    answer = crossing.answers.get(way)
    if answer is None or answer.skipped:
        return "–"
    return "≠" if answer.differences else "="


def _remarks(found: Sequence[Crossing], ways: Sequence[str]) -> Iterator[str]:
    """Why some were not asked, each reason once; then every disagreement."""
    for way in ways:
        reasons: dict[str, list[str]] = {}
        for crossing in found:
            answer = crossing.answers.get(way)
            if answer is not None and answer.skipped:
                reasons.setdefault(answer.skipped, []).append(crossing.requirement)
        for reason, names in reasons.items():
            yield f"  {way} – {', '.join(names)}: {reason}"
    for crossing in found:
        for way, answer in crossing.answers.items():
            for line in answer.differences[:SHOWN]:
                yield f"≠ {way}: {line}"
            if len(answer.differences) > SHOWN:
                yield f"≠ {way}: … and {len(answer.differences) - SHOWN} more"
