"""`rvmon conform`: check whether recordings are runs of a network of timed automata."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict

from rvmon.cli.options import budget_of, names_in
from rvmon.cli.output import busy, say, say_json, warn
from rvmon.errors import TraceError, UnknownNameError
from rvmon.models.conform import Allowed, Conformance, actions_in, conform, labels_of
from rvmon.models.language.load import load_network
from rvmon.models.network import Network
from rvmon.recordings.places import found_recordings
from rvmon.recordings.recording import FileRecording
from rvmon.texts import counted
from rvmon.trace.schema import Schema, Stamps
from rvmon.trace.stamps import stamps_of


def run_conform(arguments: argparse.Namespace) -> int:
    """Compare recordings with the model, print the answers, and return the exit code."""
    network = load_network(arguments.model)
    labels = labels_of(network)
    chosen = _chosen(arguments.observe, labels)
    stamps = None if arguments.time is None else stamps_of(arguments.time)
    answers: dict[str, Conformance] = {}
    broken = False
    for path in found_recordings(arguments.traces):
        try:
            with busy(f"comparing {path}"):
                answers[path] = _compare(network, path, stamps, labels, chosen, arguments)
        except TraceError as error:
            warn(f"error: {error}")
            broken = True
            continue
        if arguments.format == "text":
            _print(path, answers[path])
    if arguments.format == "json":
        say_json(json.dumps({path: _data(answer) for path, answer in answers.items()}, indent=2))
    return 2 if broken else int(any(not answer.conforms for answer in answers.values()))


def _chosen(listed: str | None, labels: tuple[str, ...]) -> frozenset[str] | None:
    if listed is None:
        return None
    names = frozenset(names_in(listed))
    for name in sorted(names - set(labels)):
        raise UnknownNameError(f"no label `{name}` in the model: there are {', '.join(labels)}")
    return names


def _compare(
    network: Network,
    path: str,
    stamps: Stamps | None,
    labels: tuple[str, ...],
    chosen: frozenset[str] | None,
    arguments: argparse.Namespace,
) -> Conformance:
    wanted = frozenset(labels) if chosen is None else chosen
    recording = FileRecording(path, Schema({}, {name: {} for name in wanted}, stamps=stamps))
    actions, length, occurred = actions_in(recording, wanted)
    shown = occurred if recording.names is None else wanted & recording.names
    if chosen is None:
        chosen = _some(shown, path, labels)
    elif recording.names is not None and (missing := sorted(chosen - shown)):
        raise TraceError(f"{path}: there is no column `{missing[0]}` to observe")
    end = length if arguments.until is None else arguments.until
    later = sum(action.t > end for action in actions)
    if later:
        what = "is" if later == 1 else "are"
        warn(f"{path}: {counted(later, 'later action')} {what} ignored, because of --until")
    actions = [action for action in actions if action.t <= end]
    return conform(
        network,
        actions,
        observed=chosen,
        end=end,
        tolerance=arguments.tolerance,
        budget=budget_of(arguments),
    )


def _some(shown: frozenset[str], path: str, labels: tuple[str, ...]) -> frozenset[str]:
    """The labels that a recording shows; with none, any model would explain it.

    Raises:
        TraceError: it shows no label.
    """
    if not shown:
        known = f"its actions are {', '.join(labels)}" if labels else "no edge of it has a label"
        raise TraceError(
            f"{path}: nothing in it is an action of the model: {known}; "
            "name columns or events after them, or list with --observe those that would be seen"
        )
    return shown


def _print(path: str, answer: Conformance) -> None:
    count = f"{counted(answer.explained, 'action')} explained"
    divergence = answer.divergence
    if divergence is None:
        word = f"not decided: {answer.undecided}" if answer.undecided else "conforms"
        say(f"{path}: {word}; {count}")
        return
    what = f"`{divergence.label}`" if divergence.label else "nothing more happens"
    say(f"{path}: diverges at {divergence.at / 1e9:g} s, {count} before: {what}")
    say("  no run of the model does that; here the model allows:")
    for allowed in divergence.allowed:
        say(f"    {_allowed_text(allowed)}")
    if not divergence.allowed:
        say("    nothing")


def _allowed_text(allowed: Allowed) -> str:
    if not allowed.label:
        return "nothing, until the end"
    latest = "" if allowed.latest is None else f" to {allowed.latest / 1e9:g}"
    return f"`{allowed.label}` from {allowed.earliest / 1e9:g}{latest} s"


def _data(answer: Conformance) -> dict[str, object]:
    divergence = answer.divergence
    return {
        "conforms": answer.conforms,
        "explained": answer.explained,
        "remark": answer.undecided,
        "divergence": None if divergence is None else asdict(divergence),
    }
