"""Ledgers and reports as text for people and as values for JSON."""

import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import msgspec

from studio.analysis.ledger import SensorLedger, ledger
from studio.capture.jobs import SolveReport
from studio.capture.truth import TruthReport
from studio.core.take import Take
from studio.export.sidecar import facts_of
from studio.storage.facts import to_json
from studio.storage.names import NOBODY
from studio.storage.take_reader import ReadReport
from studio.ui.fact_words import readable

_HEADINGS = (
    "sensor", "place", "samples", "lost", "gaps", "longest", "bridged",
    "rate", "clipped", "battery", "skew", "calibration",
)  # fmt: skip

RECOVERED = (
    "A take whose recording was cut off was given its end; what was safe by then is in {folder}. "
    "Look at it with: {command} inspect {folder}"
)

STAGES = {"read": "reading", "solve": "solving", "write": "writing"}


def inspection(take: Take, report: ReadReport, truth: TruthReport | None) -> dict[str, Any]:
    """Return what ``inspect --json`` prints."""
    content: dict[str, Any] = {
        "take": {
            **facts_of(take),
            "recovered": report.recovered,
            "damaged_blocks": report.damaged,
            "samples": report.samples,
        },
        "setup": msgspec.json.decode(to_json(take.setup)),
        "marks": msgspec.json.decode(to_json(list(take.marks))),
        "sensors": [_without_nan(asdict(account)) for account in ledger(take)],
    }
    if truth is not None:
        content["truth"] = truth_values(truth)
    return content


def inspection_text(take: Take, report: ReadReport, truth: TruthReport | None) -> str:
    """Return what ``inspect`` prints."""
    name, person, source = (readable(word) for word in (take.name or "take", take.person or NOBODY, take.source))
    lines = [
        f"{name}  {person}  {take.duration():.2f} s  {report.samples} samples  from {source}",
        *_condition(report),
        "",
        *_columns([_HEADINGS, *(_cells(account) for account in ledger(take))]),
    ]
    if take.marks:
        lines += ["", *(_mark(mark.time, mark.end, f"{mark.kind} {mark.label}".strip()) for mark in take.marks)]
    if truth is not None:
        lines += ["", *truth_text(truth)]
    return "\n".join(lines)


def solve_text(report: SolveReport) -> str:
    """Return what ``solve`` prints."""
    alignment = report.alignment
    lines = [
        f"{report.frames} frames of {report.frame_s * 1000:g} ms, attitude {report.attitude}, method {report.method}",
        f"reference pose {alignment.pose} from {alignment.from_s:.2f} s to {alignment.to_s:.2f} s",
        "",
        f"{'place':<16} {'heading from':<14} {'worth':>8} {'moved in hold':>14}",
    ]
    for place, limb in alignment.limbs.items():
        worth = "unknown" if limb.source == "unknown" else f"±{math.degrees(limb.heading_sigma):.1f}°"
        lines.append(f"{place.value:<16} {limb.source:<14} {worth:>8} {math.degrees(limb.spread):>13.2f}°")
    lines += ["", f"{'sensor':<26} {'estimator':<9} {'offset (°/s)':>24} {'±':>8}"]
    for sensor, offset in report.offsets.items():
        values = " ".join(f"{math.degrees(value):7.3f}" for value in offset.value)
        lines.append(f"{readable(sensor):<26} {offset.estimator:<9} {values:>24} {_degrees(offset.sigma):>8}")
    return "\n".join([*lines, "", *report.notes]).rstrip()


def truth_values(truth: TruthReport) -> dict[str, Any]:
    """Return the comparison with the true motion for JSON."""
    return {
        "joints": {place.value: round(value, 4) for place, value in truth.joint_rms_deg.items()},
        "measured_share": {place.value: round(share, 4) for place, share in truth.measured_share.items()},
        "median_rms_deg": round(truth.median(), 4),
        "worst_rms_deg": round(truth.worst(), 4),
        "transport_delay_s": round(truth.shift_s, 4),
        "from_s": truth.from_s,
        "to_s": truth.to_s,
    }


def truth_text(truth: TruthReport) -> list[str]:
    """Return the comparison with the true motion as lines."""
    lines = [
        f"rotation error of each joint against the true motion, RMS from {truth.from_s:.1f} s to {truth.to_s:.1f} s"
    ]
    for place, share in truth.measured_share.items():
        error = truth.joint_rms_deg.get(place)
        lines.append(f"  {place.value:<16} {'–' if error is None else f'{error:.2f}°':>7}  {share:7.2%} measured")
    judged = f"{len(truth.joint_rms_deg)} of {len(truth.measured_share)} joints"
    return [
        *lines,
        f"  median {truth.median():.2f}°, worst {truth.worst():.2f}°, over {judged}",
        f"  samples are taken to be {truth.shift_s * 1000:.0f} ms earlier than the studio believes",
    ]


def _condition(report: ReadReport) -> list[str]:
    lines = []
    if report.recovered:
        lines.append(f"This take was cut off; what was safe by then is here: {report.until_s:.2f} s.")
    if report.damaged:
        lines.append(f"{report.damaged} blocks of the file are damaged and were left out.")
    return lines


def _cells(a: SensorLedger) -> tuple[str, ...]:
    return (
        readable(a.sensor),
        a.place or "–",
        str(a.samples),
        str(a.lost),
        str(a.gaps),
        f"{a.longest_gap_s * 1000:.0f} ms" if a.lost else "–",
        f"{a.bridged_share:.2%}",
        f"{a.rate_hz:.1f} Hz",
        str(a.clipped),
        f"{a.battery:.0%}" if math.isfinite(a.battery) else "–",
        f"{a.clock_skew_ppm:+.0f} ppm" if math.isfinite(a.clock_skew_ppm) else "–",
        readable(a.calibration),
    )


def _columns(rows: Sequence[tuple[str, ...]]) -> list[str]:
    """Return a table as lines: words to the left, numbers to the right."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    words = (0, 1, len(widths) - 1)
    return [
        "  ".join(
            cell.ljust(width) if column in words else cell.rjust(width)
            for column, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]


def _mark(time: float, end: float, text: str) -> str:
    until = f" to {end:.2f} s" if math.isfinite(end) else ""
    return f"{time:8.2f} s{until}  {readable(text)}"


def _degrees(value: float) -> str:
    return f"{math.degrees(value):.3f}" if math.isfinite(value) else "–"


def _without_nan(values: dict[str, Any]) -> dict[str, Any]:
    return {k: None if isinstance(v, float) and not math.isfinite(v) else v for k, v in values.items()}
