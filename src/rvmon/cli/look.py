"""`rvmon look` and `init`: show a recording, and write first files for it."""

from __future__ import annotations

import argparse
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from rvmon.cli.options import constants_of, refuse_over
from rvmon.cli.output import busy, say, warn
from rvmon.cli.reading import reading_spec, time_words
from rvmon.errors import RvmonError
from rvmon.files import write_file, write_whole
from rvmon.texts import counted

if TYPE_CHECKING:
    from rvmon.recordings.starter.observed_values import Profile


def run_look(arguments: argparse.Namespace) -> int:
    """Print the profile of a recording or write it as a page, and return the exit code."""
    from rvmon.recordings.starter.profile import bound_profile, profile_of
    from rvmon.report.look_page import look_page, print_look
    from rvmon.report.printer import Printer
    from rvmon.session import load

    _refuse_output(arguments)
    spec = None
    if arguments.spec is not None:
        loaded = load(arguments.spec, const=constants_of(arguments.const))
        spec = reading_spec(loaded, arguments)
    with busy(f"reading {arguments.data}"):
        if spec is None:
            profile = profile_of(arguments.data, arguments.time)
        else:
            profile = bound_profile(arguments.data, spec.schema)
    requirements = () if spec is None else tuple(spec.requirements.values())
    if arguments.output is not None:
        write_file(arguments.output, look_page(profile, requirements))
        say(f"wrote {arguments.output}: {len(profile.columns):,} names")
        return 0
    print_look(profile, requirements, Printer())
    return 0


def _refuse_output(arguments: argparse.Namespace) -> None:
    """Refuse, before the recording is read, an output that would overwrite an input."""
    from rvmon.recordings.places import files_of

    refuse_over([arguments.output], [arguments.spec, *files_of(arguments.data)])


def run_init(arguments: argparse.Namespace) -> int:
    """Write a first specification, binding or campaign, and return the exit code."""
    if (arguments.data is None) == (arguments.campaign is None):
        raise RvmonError("error: name a recording, or --campaign with a folder")
    if arguments.campaign is not None:
        return _write_campaign(Path(arguments.campaign), force=arguments.force)
    if arguments.spec is not None:
        return _print_binding(arguments)
    from rvmon.recordings.starter.profile import profile_of
    from rvmon.recordings.starter.skeletons import starter_text

    _refuse_output(arguments)
    output = arguments.output or Path(arguments.data).with_suffix(".rv").name
    if output != "-" and Path(output).exists() and not arguments.force:
        raise RvmonError(
            f"error: {output} exists already: name another file with -o, or --force to overwrite it"
        )
    with busy(f"reading {arguments.data}"):
        profile = profile_of(arguments.data, arguments.time)
    text = starter_text(profile)
    if output == "-":
        sys.stdout.write(text)
        return 0
    try:
        write_whole(output, text)
    except OSError as error:
        raise RvmonError(f"error: {output}: {error.strerror or error}") from None
    say(f"wrote {output}: {_contents(profile, text)}")
    words = ["rvmon", "run", output, arguments.data, *time_words(arguments)]
    say(f"try:   {shlex.join(words)}")
    return 0


def _print_binding(arguments: argparse.Namespace) -> int:
    """Print a proposed binding, and return the exit code: 1 if something is left open."""
    from rvmon.recordings.binding.propose import propose
    from rvmon.recordings.recording import messages_of
    from rvmon.session import load

    spec = load(arguments.spec, const=constants_of(arguments.const))
    with busy(f"reading {arguments.data}"):
        proposal = propose(spec.checked, messages_of(arguments.data))
    words = shlex.join(["rvmon", "run", arguments.spec, arguments.data, "--binding"])
    say(f"# Proposed: review it. {words} THIS_FILE")
    say(proposal.text, end="")
    if proposal.unmatched:
        names = ", ".join(f"`{name}`" for name in proposal.unmatched)
        where = f"nothing in {arguments.data} matches clearly"
        warn(f"warning: the source of {names} is left open: {where}")
    for name in proposal.unlabelled:
        warn(f"warning: `{name}` is a number in {arguments.data}: say in `labels` what each means")
    for group in proposal.shared:
        names = " and ".join(f"`{name}`" for name in group)
        warn(f"warning: {names} are fed by the same field: is that intended?")
    return int(bool(proposal.unmatched or proposal.unlabelled))


def _write_campaign(folder: Path, *, force: bool) -> int:
    from rvmon.recordings.starter import campaign_files

    files = campaign_files()
    existing = [name for name in files if (folder / name).exists()]
    if existing and not force:
        raise RvmonError(
            f"error: {folder / existing[0]} exists already: name another folder, or --force to "
            "overwrite it"
        )
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in files.items():
            write_whole(folder / name, text)
    except OSError as error:
        raise RvmonError(f"error: {folder}: {error.strerror or error}") from None
    say(f"wrote {folder}: {', '.join(files)}")
    say(f"try:   python {shlex.quote(str(folder / 'campaign.py'))} run --tests 20")
    return 0


def _contents(profile: Profile, text: str) -> str:
    events = sum(column.is_event for column in profile.columns)
    signals = len(profile.columns) - events
    parts = [
        counted(signals, "signal"),
        counted(events, "event"),
        counted(text.count("\nrequirement "), "requirement"),
    ]
    if profile.left_out:
        parts.append(f"{len(profile.left_out)} left out")
    return ", ".join(parts)
