"""Options that several commands take."""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from rvmon.cli.parser import TIME_FORMS, Parser, instant_s, positive, span_s
from rvmon.errors import RvmonError, UnknownNameError
from rvmon.trace import READINGS_OF_NAN

if TYPE_CHECKING:
    from rvmon.models.search.budget import Budget
    from rvmon.session import Spec


_LEAST = 512  # megabytes; with less, C libraries abort while loading, without a clear message


def _megabytes(text: str) -> int:
    if (number := positive(text)) < _LEAST:
        message = f"expected at least {_LEAST} MB, which Python and its libraries need, not {text}"
        raise argparse.ArgumentTypeError(message)
    return number


_ABOUT = {
    "SPEC": "a .rv file",
    "DATA": "a recording, as `rvmon run` takes it",
    "MODEL": "a .ta or .xml file",
    "--only IDS": "only these requirements: R1,R3",
    "--severity LEVELS": "only requirements with one of these severities: high,medium",
    "--tag TAGS": "only requirements with one of these tags: stop,arm; if given twice, with one "
    "tag of each list",
    "--const NAME=VALUE": "set a constant of the specification to another value",
    "--until TIME": f"evaluate up to TIME ({TIME_FORMS}), whether the recording is longer or "
    "shorter",
    "--time COLUMN[:UNIT]": "the column of time stamps, and their unit: s, ms, us, ns, iso "
    "(ISO 8601), or a date format such as %%d.%%m.%%Y %%H:%%M:%%S; SEC+NANOSEC names two columns "
    "(default: t in seconds, or t_ns)",
    "--map NAME=COLUMN": "read the declared NAME from this column, or topic and field; repeatable",
    "--nan": "the meaning of NaN: unknown (default), or no update, for tables merged from several "
    "topics",
    "--binding FILE": "TOML file that maps topics and fields of messages (bags, MCAP) to declared "
    "names; `rvmon init DATA --for SPEC` proposes one",
    "--clock": "time stamp of messages for which the binding names none: the time of recording "
    "(log, default) or the stamp in the header",
    "--allow-missing [=NAMES]": "accept recordings that have no column for these names (default: "
    "any); requirements that read them are I, and the exit code is 1",
    "--dask ADDRESS": "distribute the work over the workers of this Dask scheduler, instead of "
    "--jobs",
    "--format": "text for people (default), or JSON",
    "--max-memory MB": "memory limit of each process (default: none)",
}
_WORDS = {words.partition(" ")[0]: words for words in _ABOUT}
_MORE: dict[str, dict[str, Any]] = {
    **{name: {"action": "append", "default": []} for name in ("--tag", "--const", "--map")},
    "--until": {"type": instant_s},
    "--nan": {"choices": [reading.replace(" ", "-") for reading in READINGS_OF_NAN]},
    "--clock": {"choices": ("log", "header")},
    "--format": {"choices": ("text", "json"), "default": "text"},
    "--max-memory": {"dest": "most_megabytes", "type": _megabytes},
}
ONLY = ("--only", "--severity", "--tag")  # the options that select requirements
READING = ("--time", "--map", "--nan", "--binding", "--clock")  # the options for reading recordings
EVALUATED = ("--const", "--until", *READING, "--allow-missing")
"""The options for evaluating recordings."""


def declare(parser: Parser, *names: str) -> None:
    """Declare options and arguments that several commands share."""
    for name in names:
        parser.option(words := _WORDS[name], _ABOUT[words], **_MORE.get(name, {}))


def chosen_ids(arguments: argparse.Namespace, spec: Spec) -> tuple[str, ...] | None:
    """The requirements selected by the options `ONLY`; `None`: all."""
    from rvmon.language.checked.names_read import labelled

    ids = ids_of(arguments.only, spec)
    severities = [] if arguments.severity is None else [names_in(arguments.severity)]
    tags = [names_in(one) for one in arguments.tag]
    return labelled(spec.checked, ids, severities, tags) if severities or tags else ids


def names_in(text: str) -> list[str]:
    """The names in a comma-separated list."""
    return [name.strip() for name in text.split(",") if name.strip()]


def ids_of(listed: str | None, spec: Spec) -> tuple[str, ...] | None:
    """The requirements in a comma-separated list; `None`: all.

    Raises:
        UnknownNameError: one does not exist, or the list is empty.
    """
    from rvmon.language.checked.names_read import requirement_ids

    if listed is None:
        return None
    ids = names_in(listed)
    if not ids:
        known = ", ".join(spec.requirements)
        raise UnknownNameError(f"the list of requirements is empty: there are {known}")
    return requirement_ids(spec.checked, ids)


def add_budget(parser: Parser) -> None:
    """Declare `--max-states`, `--max-seconds` and `--max-memory`."""
    parser.option("--max-states N", "stop the search after N states", type=positive)
    parser.option("--max-seconds TIME", f"stop the search after TIME ({TIME_FORMS})", type=span_s)
    parser.option("--max-memory MB", "memory limit (default: 2048)", type=positive, default=2048)


def budget_of(arguments: argparse.Namespace) -> Budget:
    """The budget of a search, from the options of `add_budget`."""
    from rvmon.models.search.budget import Budget

    return Budget(arguments.max_states, arguments.max_seconds, arguments.max_memory)


def constants_of(texts: Iterable[str]) -> dict[str, str]:
    """The values of `--const` by name.

    >>> constants_of(["T=2 s"])
    {'T': '2 s'}
    """
    pairs = named_values("--const", texts, "NAME=VALUE, such as T=2s")
    return {name: value.strip() for name, value in pairs}


def model_constants_of(texts: Iterable[str]) -> dict[str, int]:
    """The values of `--const` by name for a model, whose constants are whole numbers."""
    constants = {}
    for name, value in named_values("--const", texts, form := "NAME=NUMBER, such as N=4"):
        digits = value.strip().removeprefix("-")
        if not digits.isdecimal() or len(digits) > 10:
            raise RvmonError(f"--const {name}={value}: expected {form}")
        constants[name] = int(value)
    return constants


def named_values(option: str, texts: Iterable[str], form: str) -> Iterator[tuple[str, str]]:
    """Split the texts of an option into names and values.

    Args:
        option: its name, for the message.
        texts: as `NAME=VALUE`.
        form: the expected form with an example, for the message.

    Raises:
        RvmonError: a text has another form.
    """
    for text in texts:
        name, _, value = text.partition("=")
        if not name.strip() or not value.strip():
            raise RvmonError(f"{option} {text}: expected {form}")
        yield name.strip(), value


def refuse_over(written: Iterable[str | None], read: Iterable[str | None]) -> None:
    """Refuse, before any work is done, outputs that would overwrite an input or each other.

    Raises:
        RvmonError: an output is such a file.
    """
    known = list(filter(None, read))
    taken = set()
    for one in filter(None, written):
        if any(_is_same_file(one, other) for other in known):
            raise RvmonError(f"cannot write {one}: it is an input: name another")
        place = os.path.realpath(one)
        if place in taken:
            raise RvmonError(f"cannot write {one}: two results would go there: name another")
        taken.add(place)


def _is_same_file(one: str, other: str) -> bool:
    try:
        return os.path.samefile(one, other)
    except (OSError, ValueError):
        return False


@contextmanager
def at_most(megabytes: int | None) -> Iterator[None]:
    """Limit the memory of this process and of those that it starts; `None`: no limit.

    Raises:
        RvmonError: the memory is not enough, with or without a limit.
    """
    try:
        with _limited(megabytes):
            yield
    except (MemoryError, ImportError) as error:
        # "failed to map segment": a shared library found no memory.
        if isinstance(error, ImportError) and "failed to map segment" not in str(error):
            raise
        limit = "" if megabytes is None else f", of {megabytes:,} MB: raise --max-memory"
        raise RvmonError(f"the memory is not enough{limit}") from None


@contextmanager
def _limited(megabytes: int | None) -> Iterator[None]:
    if megabytes is None:
        yield
        return
    try:
        import resource
    except ImportError:
        raise RvmonError("--max-memory: this system has no such limit: leave it out") from None
    before = resource.getrlimit(resource.RLIMIT_AS)
    most = megabytes << 20
    if before[1] != resource.RLIM_INFINITY:
        most = min(most, before[1])
    resource.setrlimit(resource.RLIMIT_AS, (most, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)
