"""Readings of one link become samples, and what is known about each sensor is kept up to date."""

import math
from collections import deque
from collections.abc import Mapping
from dataclasses import replace
from typing import Final

from studio.acquisition.dialects.dialect import Reading, Traits
from studio.acquisition.health import SensorHealth
from studio.acquisition.sensor_line import SensorLine, Spot, Verdict
from studio.core.sample import Correction, Sample, SensorId, SensorInfo, Vector, is_plausible_correction
from studio.core.timeline import SharedClock

CLIPPED = 8  # Flag.CLIPPED
FILLED = 256  # Flag.FILLED; members of an IntFlag cost a microsecond each time

GAP = 0.5  # s without a sample that is told as an event (reliability, F26)
NEIGHBOUR_SILENCE = 2.0  # s; a sensor silent for longer no longer claims its number
MOST_SENSORS = 256  # of one link; a room holds a few suits, a hostile stream 2^32 serials
MOST_EVENTS = 10_000  # kept until somebody takes them

EventFacts = dict[str, str | int | float | list[str]]
Event = tuple[str, EventFacts]

_PASSING: Final = frozenset(
    ("coefficients", "coefficient_x", "coefficient_y", "coefficient_z", "angle_x", "angle_y", "angle_z", "samples")
)
"""Facts that belong to their packet and not to the sensor."""


class SensorTracker:
    """One sensor: its line, its health, and its description."""

    def __init__(self, reading: Reading, link: str, traits: Traits, shared: SharedClock, events: deque[Event]) -> None:
        facts: dict[str, str | int | float] = {"link": link}
        self.info = SensorInfo(reading.sensor, traits.frame_s, number=reading.number, facts=facts)
        self.health = SensorHealth(reading.sensor)
        self._line = SensorLine(traits, shared)
        self._events = events
        self._last_time = math.nan
        self._rows: dict[int, Vector] = {}
        self._rows_crc: int | None = None

    def accept(self, reading: Reading, received: float) -> Sample | None:
        """Return the sample of a packet that arrived at ``received`` (s), None when it is none."""
        health = self.health
        health.heard = received
        line = self._line
        spot = line.place(reading, received)
        if spot.verdict is Verdict.DUPLICATE:
            health.duplicates += 1
            return None
        if spot.verdict is Verdict.DOUBTED:
            health.inconsistent += 1
            return None
        self._count(spot, reading, received)
        if reading.facts is not None:
            self._learn(reading.facts)
        if reading.number != self.info.number or line.frame_s != self.info.frame_s:
            self._describe(reading)
        flags = reading.flags
        if reading.rate[0] != reading.rate[0]:  # NaN: math.isnan is a call more
            flags |= FILLED
        return Sample(
            reading.sensor,
            line.epoch,
            spot.frame,
            spot.device_time,
            spot.time,
            received,
            reading.orientation,
            reading.rate,
            reading.acceleration,
            flags,
            reading.battery,
            reading.temperature,
            reading.rssi,
        )

    def _count(self, spot: Spot, reading: Reading, received: float) -> None:
        health = self.health
        health.count(spot.time, received)
        if reading.flags & CLIPPED:
            health.clipped += 1
        health.rssi = reading.rssi
        if reading.battery == reading.battery:
            health.battery = reading.battery
        if reading.temperature == reading.temperature:
            health.temperature = reading.temperature
        if spot.verdict is Verdict.LATE:
            health.late += 1
            if spot.frame > self._line.first_frame:
                health.lost -= 1
            return
        health.lost += spot.missing
        clock_map = self._line.clock_map
        health.offset, health.skew = clock_map.offset, clock_map.skew
        if spot.verdict is not Verdict.NEXT:
            self._tell_new_epoch(spot)
        elif spot.time - self._last_time > GAP:
            self._tell("gap", {"from": self._last_time, "to": spot.time, "frames": spot.missing})
        if spot.stepped:
            self._tell("clock stepped", {"time": spot.time})
        self._last_time = spot.time

    def _tell_new_epoch(self, spot: Spot) -> None:
        # The packets that raised the doubt made sense after all.
        self.health.inconsistent -= spot.redeemed
        if spot.verdict is Verdict.RESTARTED:
            self.health.reboots += 1
        kind = "reboot" if spot.verdict is Verdict.RESTARTED else "frame length"
        self._tell(kind, {"epoch": self._line.epoch, "from": self._last_time, "to": spot.time})

    def _describe(self, reading: Reading) -> None:
        if reading.number != self.info.number:
            self._tell("number", {"before": self.info.number, "number": reading.number})
        self.info = replace(self.info, number=reading.number, frame_s=self._line.frame_s)

    def _learn(self, told: Mapping[str, str | int | float]) -> None:
        if "coefficients" in told:
            self._learn_row(told)
        elif "calibration_crc" in told and self._rows_crc not in (None, told["calibration_crc"]):
            # The tag was calibrated again: what it told before is no longer in force.
            self._rows.clear()
            self._rows_crc = None
            self.info = replace(self.info, correction=None)
            self._tell("coefficients outdated", {"calibration_crc": told["calibration_crc"]})
        lasting = {name: fact for name, fact in told.items() if name not in _PASSING}
        address = self.info.facts.get("address")
        if address is not None and told.get("address", address) != address:
            self._tell("address", {"before": str(address), "address": told["address"]})
        facts = {**self.info.facts, **lasting}
        if facts != self.info.facts:
            self.info = replace(self.info, facts=facts)

    def _learn_row(self, told: Mapping[str, str | int | float]) -> None:
        crc = int(told["calibration_crc"])
        if crc != self._rows_crc:
            self._rows.clear()
            self._rows_crc = crc
            self.info = replace(self.info, correction=None)
        x, y, z = (float(told[f"coefficient_{axis}"]) for axis in "xyz")
        self._rows[int(told["coefficients"])] = (x, y, z)
        if len(self._rows) < 4:
            return
        correction = Correction(self._rows[0], (self._rows[1], self._rows[2], self._rows[3]))
        if not is_plausible_correction(correction):  # no calibration could take it back
            self._rows.clear()  # the tag may be asked again
            self.info = replace(self.info, correction=None)
            self._tell("coefficients implausible", {"calibration_crc": crc})
        elif correction != self.info.correction:
            self.info = replace(self.info, correction=correction)
            self._tell("coefficients", {"calibration_crc": crc})

    def _tell(self, kind: str, facts: EventFacts) -> None:
        self._events.append((kind, {"sensor": self.info.sensor, **facts}))


class LinkTracker:
    """All sensors of one link.

    Events are pairs of kind and facts (JSON types; times in s on this computer's monotonic clock):
    ``found`` number · ``number`` before, number · ``duplicate number`` number, sensors ·
    ``address`` before, address · ``gap`` from, to, frames · ``reboot`` epoch, from, to ·
    ``frame length`` epoch, from, to · ``clock stepped`` time · ``shared clock restarted`` time ·
    ``coefficients`` calibration_crc · ``coefficients outdated`` calibration_crc · ``coefficients implausible``
    calibration_crc; all but those of several sensors with ``sensor``.
    """

    def __init__(self, link: str, traits: Traits) -> None:
        self.infos: dict[SensorId, SensorInfo] = {}
        """What is known about each sensor now."""
        self.health: dict[SensorId, SensorHealth] = {}
        self.ignored = 0
        """Readings of sensors beyond the most one link may have."""
        self._link = link
        self._traits = traits
        self._shared = SharedClock(traits.clock_modulus, traits.clock_tick)
        self._shared_restarts = 0
        self._sensors: dict[SensorId, SensorTracker] = {}
        self._events: deque[Event] = deque(maxlen=MOST_EVENTS)
        self._told_pairs: set[tuple[int, SensorId, SensorId]] = set()

    def accept(self, reading: Reading, received: float) -> Sample | None:
        """Return the sample of a reading that arrived at ``received`` (s), None when it is none."""
        tracker = self._sensors.get(reading.sensor)
        if tracker is None:
            tracker = self._find(reading)
            if tracker is None:
                return None
            self._look_for_twins(reading, received)
        elif reading.facts is not None or reading.number != tracker.info.number:
            self._look_for_twins(reading, received)
        sample = tracker.accept(reading, received)
        self.infos[reading.sensor] = tracker.info
        if self._shared.restarts != self._shared_restarts:
            self._shared_restarts = self._shared.restarts
            self._events.append(("shared clock restarted", {"time": received}))
        return sample

    def note_refused(self, refused: Mapping[SensorId, int]) -> None:
        """Take over the dialect's counts of packets it could not read, by sensor."""
        for sensor, count in refused.items():
            if sensor in self.health:
                self.health[sensor].refused = count

    def take_events(self) -> list[Event]:
        """Return what happened since the last time, in order."""
        events = list(self._events)
        self._events.clear()
        return events

    def _find(self, reading: Reading) -> SensorTracker | None:
        if len(self._sensors) >= MOST_SENSORS:
            self.ignored += 1
            return None
        tracker = SensorTracker(reading, self._link, self._traits, self._shared, self._events)
        self._sensors[reading.sensor] = tracker
        self.health[reading.sensor] = tracker.health
        self._events.append(("found", {"sensor": reading.sensor, "number": reading.number}))
        return tracker

    def _look_for_twins(self, reading: Reading, received: float) -> None:
        """Tell of each other sensor with this number that is heard too, once."""
        if not reading.number:
            return
        for sensor, other in self._sensors.items():
            if sensor == reading.sensor or other.info.number != reading.number:
                continue
            first, second = sorted((sensor, reading.sensor))
            pair = (reading.number, first, second)
            if pair not in self._told_pairs and other.health.silent_for(received) < NEIGHBOUR_SILENCE:
                self._told_pairs.add(pair)
                self._events.append(("duplicate number", {"number": reading.number, "sensors": [first, second]}))
