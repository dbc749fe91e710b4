"""A Gymnasium wrapper that judges requirements; needs gymnasium (extra `gym`)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, SupportsFloat, TypeVar

from rvmon.errors import RvmonError, needed

with needed("an environment", "gymnasium"):
    import gymnasium

if TYPE_CHECKING:
    from rvmon.monitor.robustness import Measured
    from rvmon.session import Spec
    from rvmon.verdicts.attempt import Attempt

_Observation = TypeVar("_Observation")
_Action = TypeVar("_Action")

Values = Mapping[str, Any]
Observe = Callable[[Any, Any, Values], Values | Iterable[tuple[int, Values]]]
"""Computes, from an observation, the action before it and its info, the values of signals and
events; or several samples since the previous step, each with its instant (ns since the start of
the episode)."""


class Judged(
    gymnasium.Wrapper[_Observation, _Action, _Observation, _Action],
    gymnasium.utils.RecordConstructorArgs,
):
    """Judges the episodes of an environment: an episode is a run, and its steps are samples.

    After each step `info["rv"]` contains `verdicts` (so far, by requirement), `decided` (the
    attempts decided by this step) and, with `shaping`, `margins` (the robustness figures that
    became final). The last step of an episode ends the run; `verdicts` are then those of its
    report.

    Args:
        env: any environment.
        spec: the specification.
        observe: computes the values of a step; after `reset` the action is `None`.
        step_s: seconds per step.
        ends_on_failure: whether a failed requirement terminates the episode.
        shaping: computes the term added to the reward from the robustness figures of a step;
            `None`: robustness is not measured.

    Raises:
        RvmonError: `step_s` is not positive.

    Source: reward by robustness: Li, Vasile and Belta 2017 (Reinforcement Learning with Temporal
    Logic Rewards).
    """

    def __init__(
        self,
        env: gymnasium.Env[_Observation, _Action],
        spec: Spec,
        observe: Observe,
        *,
        step_s: float = 1.0,
        ends_on_failure: bool = False,
        shaping: Callable[[Sequence[Measured]], float] | None = None,
    ) -> None:
        gymnasium.utils.RecordConstructorArgs.__init__(
            self,
            spec=spec,
            observe=observe,
            step_s=step_s,
            ends_on_failure=ends_on_failure,
            shaping=shaping,
        )
        gymnasium.Wrapper.__init__(self, env)
        from rvmon.trace.time import ticks_of_seconds

        self._step_ns = ticks_of_seconds(step_s)
        if self._step_ns <= 0:
            raise RvmonError(f"step_s={step_s!r}: expected seconds, more than 0")
        self._spec = spec
        self._observe = observe
        self._ends_on_failure = ends_on_failure
        self._shaping = shaping
        self._monitor = spec.monitor()
        self._decided: list[Attempt] = []
        self._monitor.on_decided(self._decided.append)
        self._start_run()

    def _start_run(self) -> None:
        self._monitor.reset()
        self._measuring = None if self._shaping is None else self._spec.robustness_monitor()
        self._t = 0

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[_Observation, dict[str, Any]]:
        """Start an episode, and a run."""
        observation, info = self.env.reset(seed=seed, options=options)
        self._start_run()
        judged, _ = self._judge(self._observe(observation, None, info), over=False)
        return observation, {**info, "rv": judged}

    def step(
        self, action: _Action
    ) -> tuple[_Observation, SupportsFloat, bool, bool, dict[str, Any]]:
        """Take a step and judge it."""
        observation, reward, terminated, truncated, info = self.env.step(action)
        self._t += self._step_ns
        values = self._observe(observation, action, info)
        judged, added = self._judge(values, over=terminated or truncated)
        if self._ends_on_failure and "F" in judged["verdicts"].values():
            terminated = True
        return observation, float(reward) + added, terminated, truncated, {**info, "rv": judged}

    def _judge(
        self, observed: Values | Iterable[tuple[int, Values]], *, over: bool
    ) -> tuple[dict[str, Any], float]:
        """The value of `info["rv"]`, and the term added to the reward."""
        samples = [(self._t, observed)] if isinstance(observed, Mapping) else [*observed]
        self._decided.clear()
        for t, values in samples:
            self._monitor.step_ns(t, values)
        # All samples may be earlier than this step; this decides the deadlines up to now.
        self._monitor.advance_ns(self._t)
        verdicts = self._monitor.finish_ns(self._t).verdicts if over else self._monitor.verdicts
        judged: dict[str, Any] = {"verdicts": dict(verdicts), "decided": [*self._decided]}
        if self._measuring is None or self._shaping is None:
            return judged, 0.0
        figures: list[Measured] = []
        for t, values in samples:
            figures += self._measuring.step_ns(t, values)
        figures += self._measuring.advance_ns(self._t)
        if over:
            figures += self._measuring.finish_ns(self._t)
        judged["margins"] = figures
        return judged, float(self._shaping(figures))
