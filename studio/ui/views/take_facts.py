"""What the numbers of a take are worth, in sentences."""

import math

from PySide6.QtCore import QCoreApplication

from studio.core.body import Place
from studio.core.take import HeadingSource
from studio.ui.fact_words import POSES, duration
from studio.ui.models.playhead import clock
from studio.ui.models.take_review import TakeReview, heading_sources

MOST_NAMED = 4  # places; more are counted
_STRONGEST_FIRST: tuple[HeadingSource, ...] = ("bow", "two poses", "common world", "strap rule", "unknown")


def facts_of(review: TakeReview) -> tuple[str, ...]:
    """Return the sentences: loss, body calibration, headings, method, and the notes of the solver."""
    said = [_loss(review), _calibration(review), *_headings(review), _method(review), *review.motion.notes]
    return tuple(sentence for sentence in said if sentence)


def _tr(text: str) -> str:
    return QCoreApplication.translate("TakeFacts", text)


def _loss(review: TakeReview) -> str:
    summary = review.summary
    said = []
    if summary.recovered:
        said.append(_tr("▲ Recording was cut off; what was safe by then is here."))
    if math.isfinite(summary.lost):
        words = _tr("{n:.1f} % of the samples of {sensors} sensors were lost.")
        if summary.lost == 0.0:
            words = _tr("No sample of {sensors} sensors was lost.")
        said.append(words.format(n=100 * summary.lost, sensors=summary.sensors))
    return " ".join(said)


def _calibration(review: TakeReview) -> str:
    alignment = review.motion.alignment
    pose = POSES.get(alignment.pose, alignment.pose)
    if alignment.to_s <= 0.0:
        words = _tr("Angles are relative to the {pose} that was held {ago} before this take.")
        return words.format(pose=pose, ago=duration(-alignment.to_s))
    words = _tr("Angles are relative to the held {pose}, {from_s} to {to_s} in this take.")
    return words.format(pose=pose, from_s=clock(alignment.from_s)[:-1], to_s=clock(alignment.to_s)[:-1])


def _headings(review: TakeReview) -> list[str]:
    alignment = review.motion.alignment
    sources = heading_sources(alignment)
    said = []
    for source in _STRONGEST_FIRST:
        places = sources.get(source, ())
        if not places:
            continue
        worth = max(math.degrees(alignment.limbs[place].heading_sigma) for place in places)
        words = {
            "bow": _tr("The bow tells which way limbs face (±{n:.0f}°): {places}."),
            "two poses": _tr("Two held poses tell which way limbs face (±{n:.0f}°): {places}."),
            "common world": _tr("The sensors share one heading (±{n:.0f}°): {places}."),
            "strap rule": _tr("Which way limbs face rests on how the tags are strapped on (±{n:.0f}°): {places}."),
            "unknown": _tr("▲ Which way these limbs face is unknown, so they have no angles: {places}."),
        }[source]
        said.append(words.format(n=worth, places=_named(places, len(alignment.limbs))))
    return said


def _named(places: tuple[Place, ...], worn: int) -> str:
    if len(places) == worn:
        return _tr("all {n} limbs").format(n=worn)
    names = [place.value.replace("_", " ") for place in places[:MOST_NAMED]]
    more = len(places) - len(names)
    return ", ".join([*names, *([_tr("{n} more").format(n=more)] if more else [])])


def _method(review: TakeReview) -> str:
    motion = review.motion
    words = _tr("Computed with the filter “{attitude}”, method “{method}”, {rate:.0f} frames a second.")
    return words.format(attitude=motion.attitude, method=motion.method, rate=1 / motion.frame_s)
