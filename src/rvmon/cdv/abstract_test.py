"""An abstract test: what is done to a system, as data that can be kept and played again."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from typing import Annotated, Any, ClassVar, Literal, Self

import msgspec

VerdictName = Literal["P", "F", "NT", "I"]


class Test(
    msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True, omit_defaults=True
):
    """A test that can be played again alone; derive from it and add what your tests vary.

    Attributes:
        name: unique within a campaign; also the file's name.
        strategy: which generator made it.
        seed: of everything that a run draws at random.
        text: what the test is for.
        robot: the only one of a campaign's robots that it is written for; `None`: any.
        mutation: the fault that is planted into the robot; `None`: it is as it is.
        expected: verdicts by requirement, for tests that know them.
        reaches: items of the coverage model, by group, that it is made to hit: else it is not what
            it says.
        removable: fields that are sequences whose parts a smaller test may lack, the one with the
            most to say first.

    >>> class Walk(Test):
    ...     people: int
    >>> Walk(name="a", strategy="random", seed=1, people=3).mutation is None
    True
    """

    __test__: ClassVar[bool] = False  # nothing that pytest should collect
    removable: ClassVar[tuple[str, ...]] = ()

    name: Annotated[str, msgspec.Meta(min_length=1)]
    strategy: str
    seed: Annotated[int, msgspec.Meta(ge=0)]
    text: str = ""
    robot: str | None = None
    mutation: str | None = None
    expected: dict[str, VerdictName] = {}
    reaches: dict[str, tuple[str, ...]] = {}

    def simpler(self) -> Iterable[Self]:
        """Tests in which one value is simpler, for `rvmon.cdv.shrink`; the simplest first."""
        return ()

    def __reduce__(self) -> tuple[Any, ...]:
        """To other processes it goes as to files: what has its default stays left out."""
        return partial(msgspec.json.decode, type=type(self)), (msgspec.json.encode(self),)
