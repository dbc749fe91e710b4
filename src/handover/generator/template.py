"""A test template: what the human does, and within which limits of time, as a readable file."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import msgspec

from handover.generator.abstract_test import Action
from handover.generator.files import AbstractTestError
from rvmon.writing import write_whole

PolicyName = Literal["shortest", "fastest", "likely"]
"""How a witness is chosen among several."""


class Wait(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The units of time between two instants: at least, and at most if there is a limit."""

    at_least: int
    at_most: int | None = None


class TemplateStep(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """One instant of a witness, seen from the human.

    Attributes:
        does: the edges of the human's and the sensors' automata that are taken.
        wait: since the step before, or since the start.
        action: what the human's script does; `None` if the instant only bounds others.
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


class Template(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """A witness of a query, projected on the human and the sensors.

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
    steps: tuple[TemplateStep, ...]
    limits: tuple[Limit, ...] = ()


def template_to_json(template: Template) -> bytes:
    """A template as indented JSON."""
    return msgspec.json.format(msgspec.json.encode(template), indent=2) + b"\n"


def load_template(path: str | Path) -> Template:
    """Read a template.

    Raises:
        AbstractTestError: the file cannot be read, or holds no template.
    """
    try:
        return msgspec.json.decode(Path(path).read_bytes(), type=Template)
    except OSError as error:
        raise AbstractTestError(f"{path}: {error.strerror}") from None
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise AbstractTestError(f"{path}: not a test template: {error}") from None


def save_template(template: Template, folder: str | Path) -> Path:
    """Write a template to `folder/<name>.json` and return that path."""
    path = Path(folder) / f"{template.name}.json"
    write_whole(path, template_to_json(template))
    return path
