"""What stands in for sensors that were not worn, in words: a figure of 23 segments does not show which are measured."""

from studio.core.body import PLACES, Place
from studio.core.pose import Motion


def stand_ins(motion: Motion) -> tuple[str, ...]:
    """Return one note for each rule of ``core.full_body`` that the motion needed; none with all fifteen sensors."""
    known = [place for place, measured in motion.measured.items() if measured.any()]
    notes = []
    if Place.PELVIS not in known and Place.CHEST not in known:
        notes.append("No sensor tells of the trunk: it stands upright and faces where the wearer faced at the hold.")
    elif Place.PELVIS not in known:
        notes.append("No sensor tells of the pelvis: the hips stand upright and turn with the chest.")
    elif Place.CHEST not in known:
        notes.append("No sensor tells of the chest: the trunk moves with the pelvis as one piece.")
    limbs = [place for place in PLACES if place not in (Place.PELVIS, Place.CHEST) and place not in known]
    if limbs:
        names = ", ".join(place.value.replace("_", " ") for place in limbs)
        notes.append(f"Held as in the reference pose on the next part that has a sensor: {names}.")
    return tuple(notes)
