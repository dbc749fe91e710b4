"""Change tests a little, guided by the types of their fields, and learn which changes pay off."""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Collection, Hashable, Iterable, Mapping, Sequence
from typing import Any, TypeVar

import msgspec
from msgspec import inspect

from rvmon.cdv.test import Test

_Option = TypeVar("_Option", bound=Hashable)

Draw = tuple[str, Hashable]
"""The name of a choice, and the option that was drawn."""


class Learned:
    """Weights of the options of each choice; they grow with the success of tests that drew them.

    An option is drawn in proportion to the share of its tests that paid off. Each option starts
    with one success and one failure, so that none is ever given up.

    Source: Thompson, On the Likelihood that One Unknown Probability Exceeds Another, Biometrika 25,
    1933 (draw options by what is known of them, here the mean of the posterior); Rubinstein, The
    Cross-Entropy Method for Combinatorial and Continuous Optimization, 1999 (and by what the best
    tests drew).
    """

    def __init__(self) -> None:
        self._tries: Counter[Draw] = Counter()
        self._gains: Counter[Draw] = Counter()

    def choose(
        self,
        rng: random.Random,
        choice: str,
        options: Sequence[_Option],
        drawn: list[Draw],
        near: Sequence[Collection[Draw]] = (),
    ) -> _Option:
        """Draw one of several options.

        Args:
            rng: the source of randomness.
            choice: name of the choice.
            options: at least one; an option that is listed twice is twice as likely.
            drawn: the draw is appended to this list.
            near: the draws of tests that came near to the goal; these options are more likely.
        """
        weights = [self._weight((choice, option), near) for option in options]
        found = rng.choices(options, weights)[0]
        drawn.append((choice, found))
        return found

    def _weight(self, draw: Draw, near: Sequence[Collection[Draw]]) -> float:
        share = (1 + self._gains[draw]) / (2 + self._tries[draw])
        return share + sum(draw in one for one in near) / max(1, len(near))

    def learn(self, drawn: Iterable[Draw], *, paid: bool) -> None:
        """Learn whether a test that was made by these draws paid off."""
        for draw in dict.fromkeys(drawn):
            self._tries[draw] += 1
            self._gains[draw] += paid


ATTEMPTS = 50
"""The most changes tried until one gives a valid test; types cannot express all constraints."""

CHANGES = (1, 1, 2, 3)
"""The numbers of changes made at once; one is as likely as two and three together."""

_DESCRIPTIVE = frozenset({"name", "strategy", "text", "robot", "mutation", "expected"})
"""Fields that describe a test and do not affect its run."""

DEEPEST = 5
"""The depth to which nested structures are changed or made."""

_WIDEST = 100.0
"""Unbounded numbers are drawn at most this far from 0, or from their only bound."""

_SEEDS = 1 << 32


class Mutator:
    """Changes tests of one type.

    Args:
        kind: the type of the tests.
        fixed: fields that are never changed, such as `horizon_s` or `faults.noise_m`.
        learned: draws the changes.
    """

    def __init__(self, kind: type[Test], fixed: Collection[str], learned: Learned) -> None:
        described = inspect.type_info(kind)
        assert isinstance(described, inspect.StructType), "as all tests"
        self._kind = kind
        self._learned = learned
        self._type = described
        self._fixed = fixed
        self._fields = {
            field.encode_name: field.type
            for field in described.fields
            if field.name not in (*fixed, *_DESCRIPTIVE)
            and _can_change(field.type)
            and not described.array_like
        }

    def mutated(
        self, test: Test, others: Sequence[Test], rng: random.Random, drawn: list[Draw]
    ) -> Test | None:
        """A test with up to three changes, some borrowed from others; `None` if none is valid.

        The draws of the changes are appended to `drawn`.
        """
        for _ in range(ATTEMPTS if self._fields else 0):
            choices: list[Draw] = []
            value = _as_plain(test, self._type)
            for _ in range(rng.choice(CHANGES)):
                field = self._learned.choose(rng, "field", self._weighted_fields(value), choices)
                donor = _as_plain(rng.choice(others), self._type) if others else value
                kind = self._fields[field]
                value[field] = (
                    rng.randrange(_SEEDS)
                    if field == "seed"
                    else self._changed(value[field], kind, donor[field], field, rng, choices)
                )
            try:
                changed = msgspec.convert(value, self._kind)
            except msgspec.ValidationError:
                continue
            if changed != test:
                drawn.extend(choices)
                return changed
        return None

    def _weighted_fields(self, value: Mapping[str, Any]) -> list[str]:
        """The fields that can be changed; a sequence is listed once per element."""
        sizes = {
            name: len(whole) if isinstance(whole := value[name], list | tuple) else 1
            for name in self._fields
        }
        return [name for name, size in sizes.items() for _ in range(max(1, size))]

    def _changed(
        self,
        value: Any,
        kind: inspect.Type,
        donor: Any,
        path: str,
        rng: random.Random,
        drawn: list[Draw],
    ) -> Any:
        """A value of some type, as plain data, with one change.

        `donor` is the value at the same place of another test. `path` is the address of this place;
        all elements of a sequence share one.
        """
        match kind:
            case inspect.StructType():
                fields = [
                    field
                    for field in kind.fields
                    if f"{path}.{field.name}" not in self._fixed and _can_change(field.type)
                ]
                if not fields:
                    return value
                names = [field.encode_name for field in fields]
                name = self._learned.choose(rng, path, names, drawn)
                of = next(field.type for field in fields if field.encode_name == name)
                whole = _with_defaults(value, kind)
                members = _with_defaults(donor, kind) if isinstance(donor, dict) else whole
                inner = members.get(name, whole[name])
                new = self._changed(whole[name], of, inner, f"{path}.{name}", rng, drawn)
                return {**whole, name: new}
            case inspect.VarTupleType() | inspect.ListType():
                others = list(donor) if isinstance(donor, list | tuple) else []
                return self._changed_sequence(list(value), kind.item_type, others, path, rng, drawn)
            case inspect.UnionType():
                member = _member(value, kind)
                if member is not None and _can_change(member) and rng.random() < 0.5:
                    return self._changed(value, member, donor, path, rng, drawn)
                options = [one for one in kind.types if _can_make(one)]
                return (
                    self._random_value(rng.choice(options), path, rng, drawn) if options else value
                )
            case inspect.IntType() | inspect.FloatType() if rng.random() < 0.5:
                return _number_near(value, kind, rng)
            case _:
                return self._random_value(kind, path, rng, drawn)

    def _changed_sequence(
        self,
        values: list[Any],
        kind: inspect.Type,
        donor: list[Any],
        path: str,
        rng: random.Random,
        drawn: list[Draw],
    ) -> list[Any]:
        """A sequence with one element inserted, removed, moved or changed, or a tail of `donor`."""
        ways = ["insert", *(["borrow", "tail"] if donor else [])]
        ways += ["remove", "move", *["change"] * len(values)] if values else []
        way = self._learned.choose(rng, f"{path}[]", ways, drawn)
        place = rng.randrange(len(values) + (way in ("insert", "borrow", "tail")))
        match way:
            case "insert":
                values.insert(place, self._random_value(kind, f"{path}[]", rng, drawn))
            case "borrow":
                values.insert(place, rng.choice(donor))
            case "tail":
                return values[:place] + donor[rng.randrange(len(donor)) :]
            case "remove":
                del values[place]
            case "move":
                values.insert(rng.randrange(len(values)), values.pop(place))
            case _:
                other = rng.choice(donor) if donor else values[place]
                values[place] = self._changed(values[place], kind, other, f"{path}[]", rng, drawn)
        return values

    def _random_value(
        self, kind: inspect.Type, path: str, rng: random.Random, drawn: list[Draw]
    ) -> Any:
        match kind:
            case inspect.NoneType():
                return None
            case inspect.BoolType():
                return self._learned.choose(rng, path, [False, True], drawn)
            case inspect.LiteralType():
                return self._learned.choose(rng, path, list(kind.values), drawn)
            case inspect.EnumType():
                options = [enum.value for enum in kind.cls]
                return self._learned.choose(rng, path, options, drawn)
            case inspect.IntType() | inspect.FloatType():
                return _random_number(kind, rng)
            case inspect.StructType():
                values = {
                    field.encode_name: self._random_value(
                        field.type, f"{path}.{field.encode_name}", rng, drawn
                    )
                    for field in kind.fields
                    if _can_make(field.type)
                }
                return {kind.tag_field: kind.tag, **values} if kind.tag_field else values
            case inspect.UnionType():
                options = [one for one in kind.types if _can_make(one)]
                return self._random_value(rng.choice(options), path, rng, drawn)
            case inspect.VarTupleType() | inspect.ListType():
                few = range(rng.randint(0, 1))
                return [self._random_value(kind.item_type, f"{path}[]", rng, drawn) for _ in few]
            case _:
                return ""


_SIMPLE = (
    inspect.NoneType, inspect.BoolType, inspect.LiteralType, inspect.EnumType, inspect.IntType,
    inspect.FloatType,
)  # fmt: skip


def _can_make(kind: inspect.Type, depth: int = 0) -> bool:
    match kind:
        case inspect.UnionType():
            return any(_can_make(one, depth) for one in kind.types)
        case inspect.StructType():
            needed = [field.type for field in kind.fields if field.required]
            # Without a limit of depth, a recursive structure would never end.
            return (
                not kind.array_like
                and depth < DEEPEST
                and all(_can_make(one, depth + 1) for one in needed)
            )
        case inspect.VarTupleType() | inspect.ListType():
            return _can_make(kind.item_type, depth)
        case _:
            return isinstance(kind, _SIMPLE)


def _can_change(kind: inspect.Type, depth: int = 0) -> bool:
    """Whether values of a type can be changed; text cannot, as similar text means nothing."""
    if isinstance(kind, inspect.StructType):
        inner = (_can_change(field.type, depth + 1) for field in kind.fields)
        return not kind.array_like and depth < DEEPEST and any(inner)
    return not isinstance(kind, inspect.NoneType) and _can_make(kind, depth)


def _as_plain(test: Test, kind: inspect.StructType) -> dict[str, Any]:
    """A test as plain data, including fields at their defaults."""
    return _with_defaults(msgspec.to_builtins(test), kind)


def _with_defaults(value: Mapping[str, Any], kind: inspect.StructType) -> dict[str, Any]:
    """A structure as plain data, with the defaults of fields that were left out."""
    whole = dict(value)
    for field in kind.fields:
        if field.encode_name not in whole and not field.required:
            default = field.default
            if default is msgspec.NODEFAULT:
                default = field.default_factory() if callable(field.default_factory) else None
            whole[field.encode_name] = msgspec.to_builtins(default)
    return whole


def _member(value: Any, kind: inspect.UnionType) -> inspect.Type | None:
    """The member type of a union to which a structure or sequence belongs; else `None`."""
    for one in kind.types:
        match one:
            case inspect.StructType() if isinstance(value, dict):
                if not one.tag_field or value.get(one.tag_field) == one.tag:
                    return one
            case inspect.VarTupleType() | inspect.ListType() if isinstance(value, list | tuple):
                return one
    return None


def _bounds(kind: inspect.IntType | inspect.FloatType) -> tuple[float | None, float | None]:
    low = kind.ge if kind.ge is not None else kind.gt
    high = kind.le if kind.le is not None else kind.lt
    return low, high


def _random_number(kind: inspect.IntType | inspect.FloatType, rng: random.Random) -> float:
    """A random number within the bounds of its type; small ones are as likely as large ones."""
    low, high = _bounds(kind)
    spread: float = _WIDEST ** rng.random()
    if low is None and high is None:
        number = rng.uniform(-1, 1) * spread
    elif high is None or low is None:
        sign, start = (1, low) if high is None else (-1, high)
        assert start is not None, "one of both is"
        number = start + sign * rng.uniform(0, spread)
    else:
        number = low + (high - low) * rng.random() * rng.choice((1.0, rng.random()))
    return round(number) if isinstance(kind, inspect.IntType) else number


def _number_near(
    value: float, kind: inspect.IntType | inspect.FloatType, rng: random.Random
) -> float:
    """A random number near another one, within the bounds of its type."""
    low, high = _bounds(kind)
    number = value + rng.gauss(0, 1) * rng.choice((0.01, 0.1, 0.5)) * (abs(value) or 1.0)
    if isinstance(kind, inspect.IntType):
        number = round(number) if round(number) != value else value + rng.choice((-1, 1))
    above = number if low is None else max(number, low)
    nearby: float = above if high is None else min(above, high)
    return nearby
