"""Networks written to files: UPPAAL's XML, and drawings."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from rvmon.errors import RvmonError
from rvmon.export.network_dot import network_dot
from rvmon.export.uppaal import uppaal_xml
from rvmon.timed.model.network import Network
from rvmon.writing import write_whole

PATIENCE_S = 120
"""Seconds that a drawing may take."""


def write_network(network: Network, path: str | Path) -> None:
    """Write a network in the form that the file's name ends with: `.xml`, `.dot` or `.svg`.

    Raises:
        RvmonError: the name ends otherwise, the file cannot be written, or there is no Graphviz to
            draw with.
    """
    match Path(path).suffix.lower():
        case ".xml":
            text = uppaal_xml(network)
        case ".dot":
            text = network_dot(network)
        case ".svg":
            text = network_svg(network)
        case _:
            raise RvmonError(f"{path}: end the name in .xml (for UPPAAL), .dot or .svg")
    try:
        write_whole(path, text)
    except OSError as error:
        raise RvmonError(f"{path}: {error.strerror or error}") from None


def network_svg(network: Network) -> str:
    """The drawing of `network_dot`, laid out by Graphviz.

    Raises:
        RvmonError: its program `dot` is not installed, or fails.
    """
    program = shutil.which("dot")
    if program is None:
        mend = "install Graphviz (such as: apt-get install graphviz), or write a .dot file"
        raise RvmonError(f"there is no program `dot` to draw with: {mend}")
    try:
        drawn = subprocess.run(  # noqa: S603 - the model is its input, never an argument
            [program, "-Tsvg"],
            input=network_dot(network).encode("utf-8"),
            capture_output=True,
            check=True,
            timeout=PATIENCE_S,
        )
    except subprocess.TimeoutExpired:
        mend = "write a .dot file and lay it out by another program"
        raise RvmonError(f"drawing took more than {PATIENCE_S} s: {mend}") from None
    except subprocess.CalledProcessError as error:
        reason = error.stderr.decode("utf-8", errors="replace").strip()
        raise RvmonError(f"`dot` cannot draw this: {reason}") from None
    return drawn.stdout.decode("utf-8")
