"""What a file of numbers cannot say of itself, as JSON beside it."""

import hashlib
import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

import studio
from studio.analysis.ledger import SensorLedger, ledger
from studio.core.body import PLACES
from studio.core.pose import Motion
from studio.core.sample import Stream
from studio.core.take import Alignment, Calibration, LimbAlignment, Take
from studio.core.track import flags_of, in_force
from studio.export.file_target import PROGRAM


def sidecar(take: Take, motion: Motion | None, of_the_file: Mapping[str, Any]) -> dict[str, Any]:
    """Return what stands beside an exported file.

    Parameters
    ----------
    motion : Motion or None
        None when the file holds what the sensors said and nothing was solved.
    of_the_file
        What only its exporter knows: units, columns, rate.
    """
    assignment = take.setup.assignment
    content: dict[str, Any] = {
        "made_by": {"program": PROGRAM, "version": studio.__version__},
        "take": {**facts_of(take), "samples_sha256": digest_of(take)},
        "body": {"stature_m": take.setup.stature, "stature_known": take.setup.stature_known},
        "sensors": [_sensor(take, *pair) for pair in zip(take.streams, ledger(take), strict=True)],
        "places_without_sensor": [place.value for place in PLACES if place not in assignment.sensors],
        **of_the_file,
    }
    if motion is not None:
        content["solved"] = {
            "method": motion.method,
            "attitude": motion.attitude,
            "alignment": _alignment(motion.alignment, take),
            "interpolated_share": {place.value: _share(motion, lost) for place, lost in motion.lost.items()},
            "bridged_share_of_measured": {
                place.value: _share_of(lost, motion.measured[place]) for place, lost in motion.lost.items()
            },
            "notes": list(motion.notes),
        }
    return content


def as_text(content: Mapping[str, Any]) -> bytes:
    """Return JSON in UTF-8, with null for numbers that are unknown."""
    return (json.dumps(_finite(content), ensure_ascii=False, allow_nan=False, indent=2) + "\n").encode()


def facts_of(take: Take) -> dict[str, Any]:
    """Return what identifies a take, as JSON: who, from where, when, how long."""
    return {
        "name": take.name,
        "person": take.person,
        "source": take.source,
        "started": take.started,
        "duration_s": take.duration(),
        "versions": dict(take.versions),
    }


def digest_of(take: Take) -> str:
    """Return the SHA-256 of all samples: the same for one take only, whatever it is called now."""
    digest = hashlib.sha256()
    for stream in take.streams:
        digest.update(stream.info.sensor.encode())
        for values in (stream.time, stream.received, stream.orientation, stream.rate, stream.acceleration):
            digest.update(values.tobytes())
    return digest.hexdigest()


def _sensor(take: Take, stream: Stream, account: SensorLedger) -> dict[str, Any]:
    stored = {known.sensor: known for known in take.setup.calibrations}.get(stream.info.sensor)
    calibration = in_force(stream.info, flags_of(stream), stored)
    return {
        "sensor": stream.info.sensor,
        "label": stream.info.label,
        "place": account.place,
        "frame_s": stream.info.frame_s,
        "samples": account.samples,
        "lost": account.lost,
        "longest_gap_s": account.longest_gap_s,
        "bridged_share": round(account.bridged_share, 6),
        "calibration": None if calibration is None else _calibration(calibration),
    }


def _calibration(calibration: Calibration) -> dict[str, Any]:
    return {
        "date": calibration.date,
        "method": calibration.method,
        "offset_deg_s": [math.degrees(value) for value in calibration.correction.offset],
        "offset_sigma_deg_s": [math.degrees(value) for value in calibration.offset_sigma],
        "gain_sigma": calibration.gain_sigma,
        "temperature_c": calibration.temperature,
    }


def _alignment(alignment: Alignment, take: Take) -> dict[str, Any]:
    return {
        "pose": alignment.pose,
        "from_s": alignment.from_s,
        "to_s": alignment.to_s,
        "age_at_end_of_take_s": take.duration() - alignment.to_s,
        "limbs": {place.value: _limb(limb) for place, limb in alignment.limbs.items()},
    }


def _limb(limb: LimbAlignment) -> dict[str, Any]:
    return {
        "heading_source": limb.source,
        "heading_sigma_deg": math.degrees(limb.heading_sigma),
        "spread_deg": math.degrees(limb.spread),
    }


def _share(motion: Motion, lost: NDArray[np.bool_]) -> float:
    return round(float(lost.mean()), 6) if len(motion) else 0.0


def _share_of(lost: NDArray[np.bool_], measured: NDArray[np.bool_]) -> float:
    return round(float(lost[measured].mean()), 6) if measured.any() else 0.0


def _finite(value: Any) -> Any:
    """Return the same content with null for numbers that are unknown: JSON has no NaN."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return value
