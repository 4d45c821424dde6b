"""The last minute, copied for display."""

import numpy as np

from studio.capture.live_buffer import FASTEST, KEPT, LiveBuffer
from studio.core.sample import NAN, Flag, Sample, SensorId

A, B = SensorId("tag:0000000a"), SensorId("tag:0000000b")


def sample(sensor, frame, time, flags=Flag.AT_REST):
    turning, force = (0.1, 0.2, frame), (0.0, 0.0, 9.8)
    return Sample(sensor, 0, frame, time, time, time, (1.0, 0.0, 0.0, 0.0), turning, force, flags, NAN, NAN, NAN)


def test_only_what_is_asked_for_is_copied():
    buffer = LiveBuffer()
    for frame in range(500):
        buffer.add(sample(A, frame, frame * 0.02))
        buffer.add(sample(B, frame, frame * 0.02))

    windows = buffer.snapshot([A], 2.0)

    assert list(windows) == [A]
    np.testing.assert_allclose(windows[A].time[[0, -1]], [499 * 0.02 - 2.0, 499 * 0.02])
    assert windows[A].rate[-1].tolist() == [0.1, 0.2, 499.0]


def test_lost_frames_are_marked_where_they_are_missing():
    buffer = LiveBuffer()
    for frame in (0, 1, 2, 6, 7):
        buffer.add(sample(A, frame, frame * 0.02))

    assert buffer.snapshot([A], 10.0)[A].lost_before.tolist() == [0, 0, 0, 3, 0]


def test_readings_at_the_end_of_the_range_are_marked():
    buffer = LiveBuffer()
    for frame in range(4):
        buffer.add(sample(A, frame, frame * 0.02, Flag.CLIPPED | Flag.OFFSET_OK if frame == 2 else Flag.OFFSET_OK))

    assert buffer.snapshot([A], 10.0)[A].clipped.tolist() == [False, False, True, False]


def test_the_ring_keeps_the_newest():
    buffer = LiveBuffer()
    size = int(KEPT * FASTEST)
    for frame in range(size + 10):
        buffer.add(sample(A, frame, frame / FASTEST))

    window = buffer.snapshot([A], 2 * KEPT)[A]

    assert len(window.time) == size
    assert window.rate[0, 2] == 10
    assert (np.diff(window.time) > 0).all()


def test_a_copy_does_not_change_when_more_arrives():
    buffer = LiveBuffer()
    buffer.add(sample(A, 0, 0.0))
    window = buffer.snapshot([A], 1.0)[A]

    buffer.add(sample(A, 1, 0.02))

    assert len(window.time) == 1


def test_unknown_sensors_are_simply_not_there():
    assert LiveBuffer().snapshot([A], 1.0) == {}
