"""A test template: what is done to the system, and within which limits of time, as a file."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Generic, Literal, TypeVar

import msgspec

from rvmon.cdv.files import TestError
from rvmon.writing import write_whole

Action = TypeVar("Action")
"""What a test does at an instant; the tests' own type."""

PolicyName = Literal["shortest", "fastest", "likely"]
"""How a witness is chosen among several."""


class Wait(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The units of time between two instants: at least, and at most if there is a limit."""

    at_least: int
    at_most: int | None = None


class TemplateStep(
    msgspec.Struct, Generic[Action], frozen=True, forbid_unknown_fields=True, omit_defaults=True
):
    """One instant of a witness, seen from the automata that a test stands for.

    Attributes:
        does: the edge of these automata that is taken.
        wait: since the step before, or since the start.
        action: what the test does; `None` if the instant only bounds others.
    """

    does: str
    wait: Wait
    action: Action | None = None


class Limit(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Units of time between two steps that are no neighbours; step 0 is the start.

    Only limits that the waits between do not imply are written.
    """

    first: int
    last: int
    wait: Wait


class Template(
    msgspec.Struct, Generic[Action], frozen=True, forbid_unknown_fields=True, omit_defaults=True
):
    """A witness of a query, projected on the automata that a test stands for.

    Attributes:
        name: the query's id.
        remark: the query in words.
        query: its text.
        policy: how the witness was chosen among several.
        unit_s: seconds in one unit of time.
        steps: in order.
        limits: beyond the waits of the steps.
    """

    name: str
    remark: str
    query: str
    policy: PolicyName
    unit_s: float
    steps: tuple[TemplateStep[Action], ...]
    limits: tuple[Limit, ...] = ()


def template_to_json(template: Template[Any]) -> bytes:
    """A template as indented JSON."""
    return msgspec.json.format(msgspec.json.encode(template), indent=2) + b"\n"


def load_template(path: str | Path, action: Any) -> Template[Any]:
    """Read a template.

    Args:
        path: of the file.
        action: the type of what tests do.

    Raises:
        TestError: the file cannot be read, or holds no template.
    """
    try:
        return msgspec.json.decode(Path(path).read_bytes(), type=Template[action])
    except OSError as error:
        raise TestError(f"{path}: {error.strerror}") from None
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise TestError(f"{path}: not a test template: {error}") from None


def save_template(template: Template[Any], folder: str | Path) -> Path:
    """Write a template to `folder/<name>.json` and return that path."""
    path = Path(folder) / f"{template.name}.json"
    write_whole(path, template_to_json(template))
    return path
