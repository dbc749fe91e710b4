"""`rvmon evidence`: does evidence that was kept still hold?"""

from __future__ import annotations

import argparse
import random
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING

from rvmon.cli.numbers import positive
from rvmon.cli.say import say, warn

if TYPE_CHECKING:
    from rvmon.cdv.campaign import Campaign
    from rvmon.evidence.about import Stamp
    from rvmon.evidence.keep import Kept
    from rvmon.evidence.matrix import Row
    from rvmon.verdict.rows import VerdictRow

SAMPLE = 10
"""Recordings, or tests, that are judged again unless something else is said."""

Again = Callable[["Kept", Sequence[str], int], Iterable["VerdictRow"]]
"""Judges recordings, or plays tests, again, on so many processes."""


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
    add_evidence(subparsers, None)


def add_evidence(
    subparsers: argparse._SubParsersAction[argparse.ArgumentParser],
    campaign: Callable[[], Campaign] | None,
) -> None:
    """Declare the subcommand, also for a campaign, which plays tests again.

    Args:
        subparsers: take it.
        campaign: makes the campaign, if there is one.
    """
    parser = subparsers.add_parser(
        "evidence",
        help="see whether evidence that was kept still holds",
        description="Evidence is what `rvmon run … --evidence FILE`, or a campaign, has kept.",
    )
    parser.set_defaults(run=run, made=campaign)
    verify = parser.add_subparsers(metavar="COMMAND", required=True).add_parser(
        "verify",
        help="see whether it holds",
        description="See that nothing in it was changed, that recordings are those that were "
        "judged, and judge a sample again. Exit codes: 0 it holds, 1 it does not, 2 something "
        "could not be checked.",
        epilog="example: rvmon evidence verify monday.zip --sample all",
    )
    verify.add_argument("file", metavar="FILE", help="the evidence")
    verify.add_argument(
        "--sample",
        metavar="N",
        type=lambda text: None if text == "all" else positive(text),
        default=SAMPLE,
        help="judge so many recordings or tests again, or all (%(default)s)",
    )
    verify.add_argument("--seed", metavar="S", type=int, default=1, help="of the sample (1)")
    verify.add_argument("--jobs", metavar="N", type=positive, default=1, help="processes (1)")


def run(arguments: argparse.Namespace) -> int:
    """Verify, say what was found, and return the exit code."""
    from rvmon.evidence.archive import TamperedError
    from rvmon.evidence.keep import opened_evidence

    try:
        with opened_evidence(arguments.file) as kept:
            differ, unchecked = _verified(kept, arguments)
    except TamperedError as error:
        differ, unchecked = [str(error)], []
    for one in differ:
        warn(f"differs: {one}")
    for one in unchecked:
        warn(f"not checked: {one}")
    if differ:
        say("It does not hold.")
        return 1
    say("What could be checked holds." if unchecked else "It holds.")
    return 2 if unchecked else 0


def _verified(kept: Kept, arguments: argparse.Namespace) -> tuple[list[str], list[str]]:
    """What differs, and what could not be checked."""
    from rvmon.cli.run_evidence import judged_again
    from rvmon.evidence.about import own_program
    from rvmon.evidence.keep import VERDICTS
    from rvmon.evidence.matrix import rows_by_item
    from rvmon.loading import load
    from rvmon.verdict.verdict import LAW

    about = kept.about
    say(f"{arguments.file}: {about.name}, rvmon {about.rvmon}, law {about.law}")
    say(f"SHA-256 of the file: {kept.sha256}")
    if about.law != LAW:
        return [], [f"verdicts: they are of law {about.law}, and this rvmon has law {LAW}"]
    programs = {"rvmon": own_program()}
    again: Again | None = judged_again
    if about.judging is None:
        again = None
        if arguments.made is not None:
            from rvmon.cli.campaign_evidence import played_again, program_of, with_robots

            campaign = with_robots(arguments.made(), kept)
            again, programs = partial(played_again, campaign), programs | program_of(campaign)
    changed = [name for name, now in programs.items() if about.programs.get(name) != now]
    items = rows_by_item(kept.entries[VERDICTS])
    if changed:
        say(f"made by another {' and '.join(changed)}: reasons may be put otherwise")
    else:
        from rvmon.cli.options import constants_of

        const = constants_of(about.judging.const if about.judging else ())
        kept.expect_matrix({name: load(path, const=const) for name, path in kept.specs.items()})
    say(f"as it was written: {len(kept.entries):,} entries, {len(items):,} recordings or tests")
    differ, gone = _other_recordings(about.recordings)
    if again is None:
        program = f"{about.command[0]} evidence verify {arguments.file}"
        return differ, [f"tests: what played them plays them again: `{program}`"]
    there = sorted(item for item in items if item not in differ and item not in gone)
    size = len(there) if arguments.sample is None else min(arguments.sample, len(there))
    chosen = random.Random(arguments.seed).sample(there, size)  # noqa: S311 - no secret
    now = _as_kept(again(kept, chosen, arguments.jobs))
    passed_over = ("reason", "error") if changed else ()
    found = [
        line
        for item in chosen
        for line in _differences(item, items[item], now.get(item, []), passed_over)
    ]
    say(f"judged again: {size:,} of {len(items):,}, {len(found):,} differences")
    others = [f"{name} is not what was judged" for name in differ]
    return [*others, *found], [f"{name} is not there" for name in gone]


def _other_recordings(recordings: Mapping[str, Stamp]) -> tuple[list[str], list[str]]:
    """Recordings that are others now, and those that are gone."""
    from rvmon.evidence.about import stamp_of
    from rvmon.readers.places import is_address

    differ, gone = [], []
    for name, stamp in recordings.items():
        try:
            now = None if is_address(name) else stamp_of(name)
        except (OSError, ValueError):
            now = None
        if now is None:
            gone.append(name)
        elif now != stamp:
            differ.append(name)
    if recordings:
        same = len(recordings) - len(differ) - len(gone)
        say(f"recordings: {same:,} of {len(recordings):,} are what was judged")
    return differ, gone


def _as_kept(rows: Iterable[VerdictRow]) -> dict[str, list[Row]]:
    from rvmon.evidence.matrix import rows_by_item
    from rvmon.results.write import csv_bytes

    return rows_by_item(csv_bytes(rows))


def _differences(
    item: str, before: Sequence[Row], now: Sequence[Row], passed_over: Sequence[str]
) -> Iterator[str]:
    """What is judged otherwise of a recording or a test, a sentence for each attempt."""
    was, found = _by_attempt(before), _by_attempt(now)
    for name in {**was, **found}:
        old, new = was.get(name), found.get(name)
        if old is None or new is None:
            yield f"{name} in {item} {'was not there before' if old is None else 'is gone'}"
            continue
        columns = sorted(old.keys() - {*passed_over}, key=lambda column: column != "verdict")
        other = [column for column in columns if old[column] != new.get(column)]
        if other:
            yield f"{name} in {item}: {other[0]} was {old[other[0]]}, is {new.get(other[0])}"


def _by_attempt(rows: Sequence[Row]) -> dict[str, Row]:
    return {
        row["attempt"] or row["requirement"] or row["reason"] or row["error"]: row for row in rows
    }
