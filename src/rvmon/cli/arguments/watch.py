"""The arguments of `rvmon watch`."""

from __future__ import annotations

import argparse

from rvmon.cli.options import ONLY, declare
from rvmon.cli.parser import TIME_FORMS, positive, span

_LAG_NS = 500_000_000


def add_parser(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Declare the subcommand's arguments."""
    parser = subparsers.add_parser(
        "watch",
        description="Evaluate JSON lines as they arrive, and report each verdict as soon as it "
        "is decided; a missed deadline is reported when it has passed, not at the next line. A "
        "changed specification is loaded at once. Ends with the stream, or with Ctrl-C. Exit "
        "code 0: every requirement is P or NT; 1: one failed or is I; 2: wrong input.",
        epilog='example: printf \'{"t":0,"speed":0.5,"obstacle":0.4}\\n\' | '
        "rvmon watch examples/base.rv",
    )
    add = parser.add_argument
    add("spec", metavar="SPEC", help="a .rv file")
    add(
        "source",
        metavar="SOURCE",
        nargs="?",
        default="-",
        help="a pipe or file of JSON lines (default: standard input), or mqtt://HOST/TOPICS, "
        "whose first + names the robot, such as mqtt://localhost/robots/+/#, ros1: (ROS 1 "
        "topics), ros2: (ROS 2 topics) or dds:DOMAIN (ROS 2 topics without an installation of "
        "ROS). Lines with a time stamp (t, t_ns, --time) are evaluated at that time, others when "
        "they arrive",
    )
    declare(parser, *ONLY, "--const", "--time", "--map", "--binding")
    add(
        "--robot",
        metavar="FIELD",
        help="the field that names the robot; each robot has its own monitors",
    )
    add(
        "--publish",
        metavar="TOPIC",
        help="publish each verdict as JSON: over MQTT under TOPIC/REQUIREMENT, over ROS on TOPIC",
    )
    add(
        "--realtime",
        metavar="TIME",
        nargs="?",
        type=span,
        const=_LAG_NS,
        help="the stamps of the lines are the time of day since 1970, and lines arrive at most "
        f"TIME later ({TIME_FORMS}; default: 500ms): deadlines pass while no line comes, too",
    )
    add(
        "--sim-time",
        action="store_true",
        help="take the time from the topic /clock (`use_sim_time`); the default of ros1: if the "
        "parameter of that name is true",
    )
    add(
        "--room",
        metavar="N",
        type=positive,
        default=10_000,
        help="length of the input queue in lines (default: 10000); further lines are counted as "
        "lost",
    )
    add(
        "--state",
        metavar="FILE",
        help="keep the run in a file: after a crash the same command continues it. Verdicts are "
        "numbered; the latest may be reported twice",
    )
    add("--failures", action="store_true", help="report failures only")
    add(
        "--format",
        choices=("view", "text", "json"),
        help="a live table (default on a terminal), a line for each verdict, or JSON lines",
    )
