"""Walking as a Fourier series: joint angles over a stride, and the pelvis' way that keeps the feet on the floor."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.acquisition.synthetic.postures import ANGLE_SIGNS, JOINT_PLACES, smooth_step, smooth_step_integral
from studio.core.body import PLACES

Array = NDArray[np.float64]

WALKING_SPEED = 1.3  # m/s; comfortable walking of adults
STARTS_WALKING_IN = 1.8  # s; from standing to full stride
JOINT_HARMONICS = 6  # of the stride; enough for the knee's swing peak, and smooth enough for accelerations
PELVIS_HARMONICS = 2  # of the stride: once each step, once each stride
RIGHT_BALL_STANDS = (0.12, 0.5)  # of the stride; the right forefoot bears the body
SHIFT = -0.02  # m; the pelvis moves over the standing foot, to the right after the right heel strike
CONTACT_SOFTNESS = 0.006  # m; how softly the lowest of heel and ball is chosen

# Degrees at 0, 5, ... 95 % of the stride from heel strike on: the shape of adult curves in textbooks (Winter,
# "Biomechanics and Motor Control of Human Movement"), bent by least squares (hip and knee by up to 4 degrees, ankle 10)
# so that heel and ball of this skeleton neither sink nor slip. Hip flexion, knee flexion, ankle dorsiflexion.
_HIP = (
    *(23.9, 22.2, 20.1, 17.0, 12.6, 6.4, -0.7, -6.9, -11.8, -14.6),
    *(-14.6, -11.9, -5.9, 3.8, 14.7, 22.9, 27.6, 29.8, 29.3, 26.5),
)
_KNEE = (
    *(4.9, 9.6, 13.6, 16.6, 17.4, 14.3, 9.5, 6.1, 5.5, 8.8),
    *(16.4, 27.3, 39.9, 52.0, 59.4, 58.3, 48.1, 30.9, 13.4, 4.1),
)
_ANKLE = (
    *(-0.3, -4.3, -5.0, 0.2, 6.0, 8.7, 11.0, 13.3, 13.8, 14.1),
    *(12.5, 2.3, -12.9, -18.3, -10.4, -1.1, 1.5, 0.6, 0.6, 1.4),
)

_CURVES = {"hip": _HIP, "knee": _KNEE, "ankle": _ANKLE}

# (flexion, adduction, internal rotation) amplitudes in degrees and phases in strides of one cosine; order of magnitude
# of adult gait. The left side follows half a stride later, the trunk turns against the pelvis.
_Wave = tuple[int, float, float]  # harmonic, amplitude in degrees, phase in strides of the maximum
_RIGHT_WAVES: dict[tuple[str, int], tuple[_Wave, ...]] = {
    ("hip", 1): ((1, 1.3, 0.25),),
    ("ankle", 1): ((1, 1.0, 0.75), (2, 0.5, 0.75)),
    ("ankle", 2): ((1, 1.0, 0.75), (2, 0.5, 0.75)),
    ("shoulder", 0): ((1, 21.0, 0.5), (2, 2.0, 0.1)),
    ("shoulder", 1): ((1, 3.0, 0.45),),
    ("shoulder", 2): ((1, 5.0, 0.5),),
    ("elbow", 0): ((1, 11.0, 0.53),),
    ("elbow", 2): ((1, 4.0, 0.5),),
    ("wrist", 0): ((1, 4.0, 0.55),),
}
_AXIAL_WAVES: dict[tuple[str, int], tuple[_Wave, ...]] = {
    ("pelvis", 0): ((2, 1.5, 0.05),),
    ("pelvis", 1): ((1, 4.0, 0.35),),
    ("pelvis", 2): ((1, 5.0, 0.02),),
    ("trunk", 0): ((2, 1.2, 0.2),),
    ("trunk", 1): ((1, 4.5, 0.86),),
    ("trunk", 2): ((1, 9.0, 0.52),),
    ("neck", 0): ((2, 1.5, 0.3),),
    ("neck", 1): ((1, 1.5, 0.4),),
    ("neck", 2): ((1, 4.0, 0.02),),
}
_MEANS: dict[tuple[str, int], float] = {
    ("pelvis", 0): 4.0,
    ("trunk", 0): 2.0,
    ("hip", 0): -1.0,
    ("shoulder", 0): 2.0,
    ("shoulder", 1): -6.0,
    ("elbow", 0): 22.0,
    ("elbow", 2): 10.0,
    ("neck", 0): -3.0,
}
_CLINICAL_COLUMNS = (2, 0, 1)
"""Where flexion, adduction and rotation stand in an angle row (about x, y, z)."""

Series = NDArray[np.complex128]
"""Coefficients of exp(2 pi i k phase), k = 0, 1, ...; the value is the real part of the sum."""


def periodic_series(values: Array, harmonics: int) -> Series:
    """Return the Fourier series of values at equal steps of one period, (m, ...) to (harmonics + 1, ...)."""
    spectrum = np.fft.rfft(values, axis=0)[: harmonics + 1] / len(values)
    spectrum[1:] *= 2.0
    return spectrum


def evaluate(series: Series, phase: Array) -> Array:
    """Return the series at ``phase`` (n,), in periods; (n, ...)."""
    turns = np.exp(2j * math.pi * np.outer(phase, np.arange(len(series))))
    return np.asarray(np.tensordot(turns, series, axes=1).real)


def _stride_series() -> Series:
    series = np.zeros((JOINT_HARMONICS + 1, len(PLACES), 3), np.complex128)
    half_later = (-1.0) ** np.arange(JOINT_HARMONICS + 1)
    for joint, places in JOINT_PLACES.items():
        for column in range(3):
            one = _joint_series(joint, column)
            for place in places:
                left = place.value.startswith("left_")
                series[:, PLACES.index(place), _CLINICAL_COLUMNS[column]] = one * half_later if left else one
    return np.deg2rad(series.real) * ANGLE_SIGNS + 1j * np.deg2rad(series.imag) * ANGLE_SIGNS


def _joint_series(joint: str, column: int) -> Series:
    """Return one angle of the right side or the trunk, degrees; column 0 is flexion, 1 adduction, 2 rotation."""
    one = np.zeros(JOINT_HARMONICS + 1, np.complex128)
    if column == 0 and joint in _CURVES:
        one += periodic_series(np.array(_CURVES[joint]), JOINT_HARMONICS)
    one[0] += _MEANS.get((joint, column), 0.0)
    waves = _RIGHT_WAVES if len(JOINT_PLACES[joint]) == 2 else _AXIAL_WAVES
    for harmonic, amplitude, maximum in waves.get((joint, column), ()):
        one[harmonic] += amplitude * np.exp(-2j * math.pi * harmonic * maximum)
    if joint == "hip":
        # The legs do not turn with the pelvis: the hips take it up.
        one += (1.0, -1.0, -1.0)[column] * _joint_series("pelvis", column)
    return one


STRIDE: Series = _stride_series()
"""(7, 15, 3), rad: joint angles over the stride; phase 0 is the right heel strike."""
STRIDE.flags.writeable = False

COURSE_LENGTH = 18.0  # m; the walker's heading swings once to each side in this distance
COURSE_SWING = math.radians(25.0)  # rad; how far: walking straight would never turn a tag about the vertical
COURSE_HARMONICS = 8


def _course() -> tuple[float, Series]:
    distance = np.arange(256) / 256
    direction = np.exp(1j * COURSE_SWING * np.sin(2 * math.pi * distance))
    spectrum = np.fft.fft(direction) / len(direction)
    return float(spectrum[0].real), spectrum


_COURSE_ADVANCE, _COURSE_SPECTRUM = _course()


def course(distance: Array) -> tuple[Array, Array]:
    """Return heading (n,), rad, and position (n, 2), m, after walking ``distance`` (n,), m, along the course."""
    phase = distance / COURSE_LENGTH
    heading = COURSE_SWING * np.sin(2 * math.pi * phase)
    place = (_COURSE_ADVANCE * distance).astype(np.complex128)
    for k in (*range(-COURSE_HARMONICS, 0), *range(1, COURSE_HARMONICS + 1)):
        turned = np.exp(2j * math.pi * k * phase) - 1.0
        place += _COURSE_SPECTRUM[k] * COURSE_LENGTH * turned / (2j * math.pi * k)
    return heading, np.stack([place.real, place.imag], axis=-1)


@dataclass(frozen=True, slots=True)
class Gait:
    """Walking of one body: what the pelvis does so that the feet meet the floor."""

    stride_length: float
    """m."""
    pelvis: Series
    """(3, 2), m: pelvis to the left of the course and above the floor, over the stride; forwards it is steady."""

    @classmethod
    def from_feet(cls, feet: Array) -> "Gait":
        """Return the gait of a body whose foot points move so around its pelvis.

        Parameters
        ----------
        feet : (m, 4, 3), m, x forward, z up
            Left heel, left ball, right heel, right ball relative to the Hips at m equal steps of one stride.
        """
        first, last = (round(len(feet) * part) for part in RIGHT_BALL_STANDS)
        right_ball = feet[:, 3, 0]
        stride_length = float(right_ball[first] - right_ball[last]) / (last - first) * len(feet)
        height = lowest(feet[..., 2])
        phase = np.arange(len(feet)) / len(feet)
        sideways = SHIFT * np.sin(2 * math.pi * phase)
        pelvis = np.stack([sideways, -height], axis=-1)
        return cls(stride_length, periodic_series(pelvis, PELVIS_HARMONICS))

    def at(self, since: Array) -> tuple[Array, Array, Array, Array]:
        """Return share of full stride (n,), joint angles (n, 15, 3), distance (n,), and pelvis (n, 2).

        Parameters
        ----------
        since : (n,), s
            Time since the first step began.
        """
        share = smooth_step(since / STARTS_WALKING_IN)
        strides = WALKING_SPEED / self.stride_length
        phase = strides * since
        angles = share[:, None, None] * evaluate(STRIDE, phase)
        distance = WALKING_SPEED * STARTS_WALKING_IN * smooth_step_integral(since / STARTS_WALKING_IN)
        return share, angles, distance, evaluate(self.pelvis, phase)


def lowest(heights: Array) -> Array:
    """Return a smooth minimum of (n, points) heights, (n,)."""
    least = heights.min(axis=-1, keepdims=True)
    share = np.exp((least - heights) / CONTACT_SOFTNESS).mean(axis=-1)
    return np.asarray(least[..., 0] - CONTACT_SOFTNESS * np.log(share))
