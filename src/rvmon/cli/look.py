"""`rvmon look`: what a recording holds, before a requirement is written."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from rvmon.cli.options import constants_of
from rvmon.cli.output import busy, say
from rvmon.cli.reading import reading_spec
from rvmon.files import write_file
from rvmon.recordings.starter.observed_values import Profile
from rvmon.recordings.starter.profile import bound_profile, profile_of
from rvmon.report.look_page import look_page, print_look
from rvmon.report.printer import Printer

if TYPE_CHECKING:
    from rvmon.session import Spec


def run(arguments: argparse.Namespace) -> int:
    """Look, show or write, and return the exit code."""
    from rvmon.session import load

    spec = None
    if arguments.spec is not None:
        loaded = load(arguments.spec, const=constants_of(arguments.const))
        spec = reading_spec(loaded, arguments)
    with busy(f"reading {arguments.data}"):
        profile = _looked(arguments, spec)
    requirements = () if spec is None else tuple(spec.requirements.values())
    if arguments.output is not None:
        write_file(arguments.output, look_page(profile, requirements))
        say(f"wrote {arguments.output}: {len(profile.columns):,} names")
        return 0
    print_look(profile, requirements, Printer())
    return 0


def _looked(arguments: argparse.Namespace, spec: Spec | None) -> Profile:
    """The recording, looked over; what a specification reads as it reads it."""
    if spec is None:
        return profile_of(arguments.data, arguments.time)
    return bound_profile(arguments.data, spec.schema)
