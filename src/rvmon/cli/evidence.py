"""`rvmon evidence`: does evidence that was kept still hold?"""

from __future__ import annotations

import argparse
import random
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING

from rvmon.cli.numbers import positive
from rvmon.cli.say import say
from rvmon.verdict.rows import VerdictRow

if TYPE_CHECKING:
    from rvmon.cdv.campaign import Campaign
    from rvmon.evidence.about import Stamp
    from rvmon.evidence.keep import Kept
    from rvmon.evidence.matrix import Row

SAMPLE = 10
"""Recordings, or tests, that are judged again unless something else is said."""

Again = Callable[["Kept", Sequence[str], int], Iterable[VerdictRow]]
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
        say(f"differs: {one}")
    for one in unchecked:
        say(f"not checked: {one}")
    if differ:
        say("It does not hold.")
        return 1
    say("What could be checked holds." if unchecked else "It holds.")
    return 2 if unchecked else 0


def _verified(kept: Kept, arguments: argparse.Namespace) -> tuple[list[str], list[str]]:
    """What differs, and what could not be checked."""
    from rvmon.cli.options import constants_of
    from rvmon.cli.run_evidence import judged_again
    from rvmon.evidence.about import own_program
    from rvmon.loading import load
    from rvmon.verdict.verdict import LAW

    about, items = kept.about, kept.items
    say(f"{arguments.file}: {about.name}, judged by rvmon {about.rvmon}, law {about.law}")
    differ, unchecked = _recordings(about.recordings)
    there = [item for item in items if item not in differ and item not in unchecked]
    differ = [f"{name} is not the recording that was judged" for name in differ]
    unchecked = [f"{name} is not there, or cannot be read" for name in unchecked]
    is_same = about.programs.get("rvmon") == own_program()
    if about.law != LAW:
        unchecked.append(f"verdicts, which are of law {about.law}: this rvmon has law {LAW}")
        return differ, unchecked
    if is_same:
        const = constants_of(about.judging.const if about.judging else ())
        kept.expect_matrix({name: load(path, const=const) for name, path in kept.specs.items()})
    else:
        unchecked.append("the matrix and the words of reasons: another rvmon wrote them")
    again: Again = judged_again
    if about.judging is None:
        if arguments.made is None:
            program = f"{(about.command or ['it'])[0]} evidence verify {arguments.file}"
            return differ, [*unchecked, f"tests: the program that played them does: `{program}`"]
        from rvmon.cli.campaign_evidence import played_again, program_of, with_robots

        campaign = with_robots(arguments.made(), kept)
        again = partial(played_again, campaign)
        if about.programs.get(campaign.name) != program_of(campaign):
            say(f"{campaign.name} has changed since: its tests are played as it is now")
    size = len(there) if arguments.sample is None else min(arguments.sample, len(there))
    chosen = random.Random(arguments.seed).sample(sorted(there), size)  # noqa: S311 - no secret
    now = _as_kept(again(kept, chosen, arguments.jobs))
    columns = [one for one in VerdictRow._fields if is_same or one not in ("reason", "error")]
    found = [
        line
        for item in chosen
        for line in _differences(item, items[item], now.get(item, []), columns)
    ]
    say(f"judged again: {size:,} of {len(items):,}, {len(found):,} differences")
    return [*differ, *found], unchecked


def _recordings(recordings: Mapping[str, Stamp]) -> tuple[list[str], list[str]]:
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
    item: str, before: Sequence[Row], now: Sequence[Row], columns: Sequence[str]
) -> Iterator[str]:
    """What is judged otherwise of a recording or a test, a sentence for each attempt."""
    was, found = _by_attempt(before), _by_attempt(now)
    for name in {**was, **found}:
        old, new = was.get(name), found.get(name)
        if old is None or new is None:
            yield f"{name} in {item} {'was not there before' if old is None else 'is gone'}"
            continue
        other = [column for column in columns if old[column] != new[column]]
        if other:
            column = "verdict" if "verdict" in other else other[0]
            yield f"{name} in {item}: {column} was {old[column]}, is {new[column]}"


def _by_attempt(rows: Sequence[Row]) -> dict[str, Row]:
    return {
        row["attempt"] or row["requirement"] or row["reason"] or row["error"]: row for row in rows
    }
