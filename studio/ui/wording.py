"""Every refusal in words: what happened, why, and what to do.

The texts stand whole in one table, with the facts of ``core.errors`` as named placeholders, so that a
translator sees sentences and not pieces. Words that come from files, ports or people are shown without
control characters and shortened, because anybody may have written them.
"""

import string
from collections.abc import Callable
from dataclasses import fields
from typing import Any, NamedTuple

from studio.core import errors
from studio.core.errors import StudioError
from studio.ui.fact_words import in_words


class Message(NamedTuple):
    """One message, each part a sentence or more, or empty."""

    id: str
    """``area.name``: what the manual calls it."""
    what: str
    why: str
    do: str


def sentences(error: StudioError) -> Message:
    """Return what to show for ``error``, with its facts filled in."""
    template = TEMPLATES[message_id(error)]
    facts = {field.name: in_words(field.name, getattr(error, field.name)) for field in fields(error)}
    what, why, do = (_filled(part, facts) for part in template[1:])
    return Message(template.id, what, why, do)


def one_line(error: StudioError) -> str:
    """Return the message as one line for a terminal."""
    return " ".join(part for part in sentences(error)[1:] if part)


def message_id(error: StudioError) -> str:
    """Return the id of the message for ``error``; KeyError for a group, which nobody raises."""
    choice = MESSAGE_OF[type(error)]
    return choice if isinstance(choice, str) else choice(error)


def _filled(template: str, facts: dict[str, str]) -> str:
    text = template.format_map(facts)
    # A limb may begin a sentence; a path or a port keeps its own first letter.
    return text[:1].upper() + text[1:] if template.startswith("{place") else text


def placeholders(template: str) -> set[str]:
    """Return the names of the facts that ``template`` asks for."""
    return {name for _, name, _, _ in string.Formatter().parse(template) if name}


def _by_id(*messages: Message) -> dict[str, Message]:
    return {message.id: message for message in messages}


TEMPLATES = _by_id(
    # Connecting
    Message(
        "con.gone",
        "{port} is not there.",
        "It was pulled out, or it never had this name.",
        "Plug the receiver in and look at the list of sources.",
    ),
    Message(
        "con.busy",
        "{port} is in use by another program.",
        "Only one program at a time can listen to a port.",
        "Close the other program, for example the Arduino serial monitor, and try again.",
    ),
    Message(
        "con.perm",
        "This computer does not let you open {port}.",
        "Your user account has no right to use serial ports.",
        "On Linux, add yourself to the group “dialout”, then log out and in again.",
    ),
    Message(
        "con.source",
        "The source “{source}” was not understood.",
        "The reason: {reason}.",
        "Write synthetic, serial:PORT or replay:TAKE.",
    ),
    Message(
        "con.none",
        "No sensor sent anything.",
        "The source “{source}” was open all the time and stayed silent.",
        "Switch a tag on and keep it within 3 m, or try the simulated suit with the source “synthetic”.",
    ),
    Message(
        "con.silent",
        "Nothing came for the last {silent_s} of {asked_s}.",
        "The source “{source}” stayed open and fell silent; what came before is kept.",
        "Look at the batteries and keep the tags within 3 m, then record again.",
    ),
    Message(
        "con.garbage",
        "Data arrived but made no sense.",
        "{malformed} pieces came from “{source}” and none could be read.",
        "Check the speed of the port and the kind of device.",
    ),
    Message(
        "con.tag_newer",
        "A tag or receiver speaks a newer language than this studio.",
        "It speaks version {found}, the studio knows version {supported}.",
        "Install the newest studio.",
    ),
    Message(
        "con.tag_older",
        "A tag or receiver speaks an older language than this studio.",
        "It speaks version {found}, the studio knows version {supported}.",
        "Put the newest firmware on it.",
    ),
    # Calibration and body calibration
    Message(
        "cal.file",
        "The calibration file {file} cannot be used.",
        "The reason: {reason}.",
        "Choose another file, or calibrate again.",
    ),
    Message(
        "cal.no_pose",
        "The take holds no reference pose.",
        "In {take_s} nobody marked when the person stood still in a known pose, "
        "so the sensors cannot be related to the body.",
        "Calibrate the body before recording; on the command line, say when it was held: --pose n=2..5.",
    ),
    Message(
        "cal.no_sensor",
        "No sensor is worn in this take.",
        "It has {sensors} sensors, and none of them is assigned to a place of the body.",
        "Say in the map file or before recording where each one sits; raw and orientation tables can be had as it is.",
    ),
    Message(
        "cal.pose_outside",
        "The {pose} cannot be used.",
        "It was said to last from {from_s} to {to_s}; the take lasts {take_s} and holds too few samples of that time.",
        "Give a time of at least 1 s inside the take.",
    ),
    Message(
        "cal.moved",
        "{places} moved while the {pose} was held.",
        "The movement was {degrees}.",
        "Hold still until the long tone, or record the pose again.",
    ),
    Message(
        "cal.heading",
        "Headings unknown: {places}.",
        "Without them it is not known which way these limbs faced in the held pose, and joint angles would be wrong.",
        "Record a bow after the pose, and name it too where poses are named; or strap the tags on as the picture "
        "shows and say so; or use sensors that share one compass direction.",
    ),
    Message(
        "cal.other_pose",
        "What was recorded as {pose} looks like {held}.",
        "Gravity says so on these limbs: {places}. All joint angles would be wrong.",
        "Record the poses again as the pictures show them, or correct their names.",
    ),
    # Person and assignment
    Message(
        "set.place_twice",
        "One place has two sensors, or one sensor two places.",
        "Place: {place}. Sensor: {sensors}.",
        "Give each place one sensor.",
    ),
    Message(
        "set.person_code",
        "“{code}” cannot stand for a person.",
        "Takes are kept under a code, never under a name, so that a lost file tells nobody who was measured.",
        "Use letters and a number, at most 16 together, for example P014.",
    ),
    # Recording
    Message(
        "rec.running",
        "A recording is going on already.",
        "It is being kept in {folder}, and there is only one at a time.",
        "Stop it, then record the next take.",
    ),
    Message(
        "rec.early",
        "Nothing was recorded.",
        "You stopped before any sensor of “{source}” was ready.",
        "Start again, and wait until the sensors are found.",
    ),
    Message(
        "rec.no_room",
        "Recording did not start: the disk is full.",
        "There is no room left in {folder}.",
        "Free space or choose another folder.",
    ),
    Message(
        "rec.disk_full",
        "Recording stopped: the disk is full.",
        "{kept_s} of the recording are safe in {folder}.",
        "Free space, then record the next take.",
    ),
    Message(
        "rec.file_limit",
        "Recording stopped: the disk allows no longer file.",
        "Files on a disk formatted as FAT32 end at 4 GB; {kept_s} of the recording are safe in {folder}.",
        "Record the next take, or keep the library on a disk with another format (exFAT, NTFS, APFS).",
    ),
    Message(
        "rec.take_limit",
        "Recording stopped: a take holds no more.",
        "One take has room for 24 hours of 30 sensors; {kept_s} of the recording are safe in {folder}.",
        "Record the next take.",
    ),
    Message(
        "rec.folder",
        "Recordings cannot be kept in {folder}.",
        "The studio has no right to write there.",
        "Choose another folder.",
    ),
    Message(
        "rec.is_file",
        "{path} is a file, not a folder.",
        "A library is a folder, with a folder in it for each person.",
        "Choose another folder.",
    ),
    Message(
        "rec.verify_fail",
        "The take could not be read back as it was recorded.",
        "{found} of {expected} samples came back from {path}.",
        "Keep the file, check the disk, and record again.",
    ),
    # Opening
    Message(
        "open.not_take",
        "There is no take at {path}.",
        "A take is a folder that holds the file take.mcap, such as out/P014/2026-11-24a/take-001_walk.",
        "Check the path.",
    ),
    Message(
        "open.worker_lost",
        "This could not be worked out.",
        "The part of the studio that computes was ended by the system; mostly because the memory is full.",
        "Close other programs and try again. The take is as it was.",
    ),
    Message(
        "open.damaged",
        "Nothing of the take can be used.",
        "The file {path} is damaged; what could be recovered ends after {recovered_until_s}.",
        "Restore the file from a copy.",
    ),
    Message(
        "open.newer",
        "The take was made by a newer studio.",
        "{path} has format {found}; this studio reads up to {supported}.",
        "Install the newest studio.",
    ),
    Message(
        "open.refused",
        "This file is not a safe take.",
        "{path} was not opened: {reason}.",
        "Ask where the file came from.",
    ),
    Message(
        "open.no_truth",
        "The take has no true motion beside it.",
        "Only takes of the simulated suit know it, and {path} is not one of them.",
        "Look at the take without --truth.",
    ),
    # Importing
    Message(
        "imp.missing",
        "{path} is not there.",
        "There is no file or folder of this name.",
        "Check the name, and the folder you are in.",
    ),
    Message(
        "imp.no_map",
        "A map is missing.",
        "A table does not tell what its columns mean: {paths}.",
        "Describe the columns in a map and import again with --map FILE; the manual shows how.",
    ),
    Message(
        "imp.line",
        "{file} cannot be imported.",
        "Line {line}: {reason}.",
        "Correct the line, or export the recording again from the program it came from.",
    ),
    Message(
        "imp.file",
        "{file} cannot be imported.",
        "The reason: {reason}.",
        "Export the recording again from the program it came from.",
    ),
    Message(
        "imp.map",
        "The map {file} does not fit.",
        "The reason: {reason}.",
        "Correct the map; the manual shows each of its entries.",
    ),
    Message(
        "imp.format",
        "The format was not recognised.",
        "Imported are folders of x-io sensors, and tables of numbers that a map describes; this is neither: {paths}.",
        "Give the folder that holds the folders of the sensors, or tables (CSV) and a map.",
    ),
    # Exporting
    Message(
        "exp.nothing",
        "There is nothing to export.",
        "The take holds no {what}: {reason}.",
        "Choose something else to export, or another take.",
    ),
    Message(
        "exp.target",
        "{path} cannot be written.",
        "The reason: {reason}.",
        "Choose another name, or a folder that is there and that you may write to.",
    ),
    Message(
        "exp.taken",
        "{path} is there already.",
        "It is not the same kind of file, made by this studio from this take, or it was changed since.",
        "Choose another name, or add --overwrite to replace it.",
    ),
    Message(
        "exp.differs",
        "The exported file is not right.",
        "{path} was read again and compared with the motion: {difference}.",
        "Do not use the file; please report this with the take.",
    ),
)

MESSAGE_OF: dict[type[StudioError], str | Callable[[Any], str]] = {
    errors.PortGone: "con.gone",
    errors.PortBusy: "con.busy",
    errors.PortForbidden: "con.perm",
    errors.SourceUnreadable: "con.source",
    errors.NoData: lambda error: "con.garbage" if error.malformed else "con.none",
    errors.FellSilent: "con.silent",
    errors.UnsupportedVersion: lambda error: "con.tag_newer" if error.found > error.supported else "con.tag_older",
    errors.CalibrationUnreadable: "cal.file",
    errors.NoSensorWorn: "cal.no_sensor",
    errors.PoseMissing: "cal.no_pose",
    errors.PoseTooShort: "cal.pose_outside",
    errors.MovedDuringHold: "cal.moved",
    errors.HeadingsUnknown: "cal.heading",
    errors.PoseNotHeld: "cal.other_pose",
    errors.PlaceTakenTwice: "set.place_twice",
    errors.PersonCodeInvalid: "set.person_code",
    errors.AlreadyRecording: "rec.running",
    errors.StoppedEarly: "rec.early",
    errors.DiskFull: lambda error: "rec.disk_full" if error.kept_s > 0 else "rec.no_room",
    errors.FileAtLimit: "rec.file_limit",
    errors.TakeAtLimit: "rec.take_limit",
    errors.FolderNotWritable: "rec.folder",
    errors.FolderIsFile: "rec.is_file",
    errors.VerificationFailed: "rec.verify_fail",
    errors.NotATake: "open.not_take",
    errors.WorkerLost: "open.worker_lost",
    errors.Damaged: "open.damaged",
    errors.WrittenByNewerStudio: "open.newer",
    errors.TakeUnsafe: "open.refused",
    errors.TruthMissing: "open.no_truth",
    errors.RecordingUnreadable: lambda error: "imp.line" if error.line else "imp.file",
    errors.RecordingMissing: "imp.missing",
    errors.MapMissing: "imp.no_map",
    errors.MapFileInvalid: "imp.map",
    errors.FormatUnknown: "imp.format",
    errors.NothingToExport: "exp.nothing",
    errors.CannotWrite: "exp.target",
    errors.TargetTaken: "exp.taken",
    errors.ReadBackDiffers: "exp.differs",
}
"""Which message tells of which error; a function where the facts decide."""
