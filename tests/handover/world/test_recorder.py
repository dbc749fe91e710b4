"""Samples: one for each instant, in order, signals only on change."""

from handover.world.recorder import Recorder, SampleValue


def test_one_instant_is_one_sample() -> None:
    recorder = Recorder(None)
    recorder.event(5, "closed")
    recorder.signal(5, "speed", 0.1)
    recorder.signal(5, "speed", 0.2)
    recorder.event(7, "opened")
    recorder.finish()
    assert recorder.samples == [(5, {"closed": True, "speed": 0.2}), (7, {"opened": True})]


def test_signals_are_kept_on_change_and_events_always() -> None:
    recorder = Recorder(None)
    for t in (1, 2, 3):
        recorder.signal(t, "ok", False)
    recorder.refresh(4, "ok", False)
    recorder.event(5, "tick")
    recorder.event(6, "tick")
    recorder.finish()
    assert [t for t, _ in recorder.samples] == [1, 4, 5, 6]


def test_observer_sees_whole_samples_in_order() -> None:
    seen: list[tuple[int, dict[str, SampleValue]]] = []
    recorder = Recorder(lambda t, values: seen.append((t, dict(values))))
    recorder.event(1, "a")
    recorder.event(1, "b")
    assert seen == []
    recorder.event(2, "c")
    assert seen == [(1, {"a": True, "b": True})]
    recorder.finish()
    assert seen == recorder.samples
