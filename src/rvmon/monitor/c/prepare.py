"""What the engine `c` would have compiled at its first use, compiled ahead."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from rvmon.codegen.c_batch import batch_build
from rvmon.codegen.c_build import built
from rvmon.codegen.c_online import online_build
from rvmon.monitor.c.prepared import prepare_beside, prepare_measuring
from rvmon.monitor.compiled.code_plan import plan_alone

if TYPE_CHECKING:
    from rvmon.monitor.compiled.specification import CompiledSpec


@dataclass(frozen=True, slots=True)
class Prepared:
    """One file that lies ready in the cache.

    Attributes:
        use: `auto`: the engine that takes it in streams; `streams` or `columns`: what
            the engine `c` judges by it; `robustness`: what both measure by it.
        path: of the file.
        size: bytes.
        seconds: that it took, few if it was there.
    """

    use: str
    path: Path
    size: int
    seconds: float


USES = ("auto", "streams", "columns", "robustness")


def prepare(
    compiled: CompiledSpec,
    only: Sequence[str] | None,
    ready: Callable[[Prepared], object],
    robustness: bool = False,
) -> tuple[Prepared, ...]:
    """Compile what is not in the cache.

    Args:
        compiled: the specification.
        only: ids of the requirements; `None`: all.
        ready: called with each file when it is there.
        robustness: whether that will be measured as well.

    Raises:
        RvmonError: there is no compiler or no cache, or a requirement is beyond generated code.
    """
    plan, chosen = plan_alone(compiled, only), compiled.chosen(only)
    makers: tuple[Callable[[], Path | None], ...] = (
        lambda: prepare_beside(compiled, chosen),
        lambda: built(online_build(plan)),
        lambda: built(batch_build(plan)),
        lambda: prepare_measuring(compiled, chosen) if robustness else None,
    )
    found: list[Prepared] = []
    for use, make in zip(USES, makers, strict=True):
        started = time.perf_counter()
        path = make()
        if path is None:
            continue
        seconds = time.perf_counter() - started
        found.append(Prepared(use, path, path.stat().st_size, seconds))
        ready(found[-1])
    return tuple(found)
