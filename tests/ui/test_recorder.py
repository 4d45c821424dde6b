"""The record button as a state machine: 10,000 random events, no illegal state, no empty take."""

import random
from itertools import pairwise

import pytest

from studio.ui.models.recorder import SHORTEST, Phase, Recorder

LEGAL = {
    Phase.IDLE: {Phase.COUNTDOWN, Phase.STARTING},
    Phase.COUNTDOWN: {Phase.IDLE, Phase.STARTING},
    Phase.STARTING: {Phase.RECORDING, Phase.IDLE},
    Phase.RECORDING: {Phase.SAVING, Phase.IDLE},
    Phase.SAVING: {Phase.SAVED, Phase.IDLE},
    Phase.SAVED: {Phase.IDLE, Phase.COUNTDOWN, Phase.STARTING},
}


class Session:
    """Answers the recorder's wishes after a while, as the real one does, and keeps book."""

    def __init__(self, recorder, chance):
        self.recorder = recorder
        self.chance = chance
        self.pending = []
        self.now = 0.0
        self.recording_since = None
        self.takes = []
        recorder.start_wanted.connect(self.start)
        recorder.stop_wanted.connect(self.stop)

    def start(self):
        assert self.recording_since is None, "started twice"
        assert not self.pending, "started while an answer is due"
        self.pending.append((self.now + self.chance.uniform(0, 0.3), "start"))

    def stop(self):
        assert self.recording_since is not None, "stopped what never started"
        self.takes.append(self.now - self.recording_since)
        self.recording_since = None
        self.pending.append((self.now + self.chance.uniform(0, 0.5), "save"))

    def answer(self):
        for due in [p for p in self.pending if p[0] <= self.now]:
            self.pending.remove(due)
            if due[1] == "start":
                if self.chance.random() < 0.1:
                    self.recorder.failed()
                else:
                    self.recording_since = self.now
                    self.recorder.started(self.now)
            elif self.chance.random() < 0.05:
                self.recorder.failed()
            else:
                self.recorder.saved(self.now)


@pytest.mark.parametrize("seed", range(4))
def test_ten_thousand_random_events_leave_no_illegal_state_and_no_empty_take(qtbot, seed):
    chance = random.Random(seed)
    recorder = Recorder()
    session = Session(recorder, chance)
    phases = [recorder.phase]
    closed = []
    recorder.phase_changed.connect(phases.append)
    recorder.close_ready.connect(lambda: closed.append(recorder.phase))

    for _ in range(10_000):
        session.now += chance.uniform(0, 0.4)
        session.answer()
        event = chance.choice(["press", "press", "esc", "tick", "tick", "tick", "close", "confirm", "disk"])
        if event == "press":
            recorder.press(session.now, chance.choice([0, 0, 3, 5]))
        elif event == "esc":
            before = recorder.phase
            recorder.cancel()
            assert before is Phase.COUNTDOWN or recorder.phase is before
        elif event == "close":
            may = recorder.close(session.now)
            assert may == (not recorder.is_busy)
        elif event == "confirm" and recorder.is_busy and chance.random() < 0.2:
            recorder.stop_and_close(session.now)
        elif event == "disk" and chance.random() < 0.05 and recorder.phase is Phase.RECORDING:
            recorder.ended(session.now)
        recorder.tick(session.now)

    assert all(after in LEGAL[before] for before, after in pairwise(phases))
    assert len(session.takes) > 100
    short = sum(length < SHORTEST for length in session.takes)
    assert short <= 0.05 * len(session.takes)  # a full disk only
    assert all(phase in (Phase.IDLE, Phase.SAVED) for phase in closed)


def test_a_stop_in_the_first_moment_waits_until_there_is_something_to_keep(qtbot):
    recorder = Recorder()
    stops = []
    recorder.stop_wanted.connect(lambda: stops.append(recorder.elapsed))
    recorder.press(0.0, 0)
    recorder.press(0.05, 0)  # before the session has even started
    recorder.started(0.1)

    recorder.tick(0.3)
    assert stops == []
    recorder.tick(0.7)

    assert stops == [pytest.approx(0.6)]


def test_the_countdown_is_told_second_by_second(qtbot):
    recorder = Recorder()
    told: list[int] = []
    recorder.second_counted.connect(told.append)
    recorder.press(0.0, 3)
    for tenth in range(1, 31):
        recorder.tick(tenth / 10)

    assert told == [3, 2, 1]
    assert recorder.phase is Phase.STARTING


def test_esc_never_stops_a_recording(qtbot):
    recorder = Recorder()
    recorder.press(0.0, 0)
    recorder.started(0.1)

    recorder.cancel()

    assert recorder.phase is Phase.RECORDING


def test_closing_while_saving_waits_for_the_take(qtbot):
    recorder = Recorder()
    ready = []
    recorder.close_ready.connect(lambda: ready.append(True))
    recorder.press(0.0, 0)
    recorder.started(0.0)
    recorder.press(1.0, 0)
    assert recorder.phase is Phase.SAVING

    assert not recorder.close(1.1)
    assert ready == []
    recorder.saved(1.5)

    assert ready == [True]
