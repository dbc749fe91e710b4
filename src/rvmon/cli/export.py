"""`rvmon export`: write a specification or model in the formats of other programs."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rvmon.cli.options import chosen_ids, constants_of, model_constants_of, refuse_over
from rvmon.cli.output import say, warn
from rvmon.errors import RvmonError
from rvmon.files import write_file
from rvmon.texts import escaped_json

if TYPE_CHECKING:
    from rvmon.session import Spec

_OF_MODELS = ("dot", "uppaal")


def run_export(arguments: argparse.Namespace) -> int:
    """Write or print the exported texts, and return the exit code."""
    refuse_over([arguments.output], [arguments.subject])
    if Path(arguments.subject).suffix in (".ta", ".xml"):
        text = _model_text(arguments)
    else:
        from rvmon.session import load

        if arguments.to == "uppaal":
            raise RvmonError(
                f"{arguments.subject} is not a model (.ta): UPPAAL has no specifications"
            )
        spec = load(arguments.subject, const=constants_of(arguments.const))
        ids = chosen_ids(arguments, spec)
        if not spec.requirements:
            raise RvmonError(f"{arguments.subject} has no requirement: there is nothing to export")
        if arguments.to == "c":
            _write_c(spec, ids, arguments.output)
            return 0
        text = _automata(spec, ids, arguments.to)
    if arguments.output is None:
        say(text, end="")
    else:
        write_file(arguments.output, text)
    return 0


def _model_text(arguments: argparse.Namespace) -> str:
    """The text of a network of timed automata; warns of queries that UPPAAL cannot express."""
    from rvmon.models.language.load import load_network
    from rvmon.models.uppaal_xml import left_out, network_dot, uppaal_xml

    if arguments.to not in _OF_MODELS:
        raise RvmonError(
            f"--to {arguments.to} is for specifications: {arguments.subject} is a model"
        )
    constants = model_constants_of(arguments.const)
    network = load_network(arguments.subject, constants=constants)
    if arguments.to == "dot":
        return network_dot(network)
    for query in left_out(network):
        name = f"`{query.id}`: " if query.id else ""
        warn(f"warning: not a query of UPPAAL, left out: {name}{query.text}")
    return uppaal_xml(network)


def _write_c(spec: Spec, ids: Sequence[str] | None, output: str | None) -> None:
    from rvmon.core.c_files import c_files
    from rvmon.monitor.compiled_spec import compile_spec
    from rvmon.monitor.requirement_plans import plan_alone

    if output is None:
        raise RvmonError("C is several files: name a folder with -o DIR")
    folder = Path(output)
    if folder.exists() and not folder.is_dir():
        raise RvmonError(f"cannot write to {folder}: C is several files: name a folder with -o DIR")
    texts = c_files(plan_alone(compile_spec(spec.checked), ids))
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RvmonError(f"cannot write to {folder}: {error.strerror}") from None
    for name, text in texts.items():
        write_file(folder / name, text)
        say(str(folder / name))


def _automata(spec: Spec, ids: Sequence[str] | None, form: str) -> str:
    """The automata of the requirements that have one; warns of the others, with the reasons.

    Raises:
        RvmonError: no requirement has one; the message gives the reason of the first.
    """
    from rvmon.analysis.hoa import automaton_dot, automaton_json, hoa
    from rvmon.monitor.compiled_spec import compile_spec

    write = {"dot": automaton_dot, "hoa": hoa, "json": automaton_json}[form]
    made, faults = [], []
    for compiled in compile_spec(spec.checked).chosen(ids):
        try:
            made.append(write(compiled, spec.checked))
        except RvmonError as error:
            faults.append(error)
    if not made:
        raise faults[0]
    for fault in faults:
        warn(f"left out: {str(fault).removeprefix('error: ')}")
    if form == "json":
        import msgspec

        encoded = msgspec.json.format(msgspec.json.encode(made), indent=1)
        return f"{escaped_json(encoded.decode())}\n"
    return "".join(map(str, made))
