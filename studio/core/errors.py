"""Everything the operator asked for that could not be done, as types that carry facts.

The tree::

    StudioError
    ├── WorkerLost
    ├── LinkError         PortGone · PortBusy · PortForbidden · SourceUnreadable · NoData · FellSilent
    ├── ProtocolError     UnsupportedVersion
    ├── CalibrationError  CalibrationUnreadable
    ├── SetupError        PlaceTakenTwice · PersonCodeInvalid
    ├── AlignmentError    NoSensorWorn · PoseMissing · PoseTooShort · MovedDuringHold · HeadingsUnknown
    │                     PoseNotHeld
    ├── TakeFileError     NotATake · Damaged · WrittenByNewerStudio · TakeUnsafe · TruthMissing
    ├── RecordingError    AlreadyRecording · StoppedEarly · DiskFull · FileAtLimit · TakeAtLimit
    │                     FolderNotWritable · FolderIsFile · VerificationFailed
    ├── ImportFailed      RecordingMissing · RecordingUnreadable · MapMissing · MapFileInvalid · FormatUnknown
    └── ExportError       NothingToExport · CannotWrite · TargetTaken · ReadBackDiffers

A malformed or lost packet is not an error but a count (``acquisition.health``). Our own mistakes
stay ``ValueError`` or ``AssertionError``. Sentences for people live in ``ui.wording``.
"""

from dataclasses import dataclass, fields


@dataclass(eq=False)
class StudioError(Exception):
    """The operator asked for something and can act on the refusal."""

    def __post_init__(self) -> None:
        # The facts are the arguments too, so that errors survive the pipe of the worker process.
        self.args = tuple(getattr(self, field.name) for field in fields(self))


class LinkError(StudioError):
    """A source of samples could not be opened or kept open."""


@dataclass(eq=False)
class WorkerLost(StudioError):
    """The process that computes ended before its job did: it was closed, killed, or there was no memory left."""


@dataclass(eq=False)
class PortGone(LinkError):
    """The port does not exist, or was pulled out."""

    port: str


@dataclass(eq=False)
class PortBusy(LinkError):
    """Another program holds the port."""

    port: str


@dataclass(eq=False)
class PortForbidden(LinkError):
    """The operating system does not let this user open the port."""

    port: str


@dataclass(eq=False)
class SourceUnreadable(LinkError):
    """The words that name a source cannot be understood."""

    source: str
    reason: str
    """one clause, lower case, without full stop"""


@dataclass(eq=False)
class NoData(LinkError):
    """A source was open all the time and sent nothing that could be kept."""

    source: str
    malformed: int
    """how many pieces arrived that made no sense"""


@dataclass(eq=False)
class FellSilent(LinkError):
    """A source stayed open and sent nothing any more before the recording had its length."""

    source: str
    silent_s: float
    """s at the end of the recording into which nothing came"""
    asked_s: float
    """s that were to be recorded"""


class ProtocolError(StudioError):
    """The other side speaks something this studio does not."""


@dataclass(eq=False)
class UnsupportedVersion(ProtocolError):
    """A tag or receiver announced a version of the wire protocol that is not ours."""

    found: int
    supported: int


class CalibrationError(StudioError):
    """A correction of a sensor could not be determined or read."""


@dataclass(eq=False)
class CalibrationUnreadable(CalibrationError):
    """A calibration file is not what it should be."""

    file: str
    reason: str


class SetupError(StudioError):
    """The assignment of sensors to the body, or the person, is not consistent."""


@dataclass(eq=False)
class PlaceTakenTwice(SetupError):
    """Two sensors were put on one place, or one sensor on two."""

    place: str
    sensors: tuple[str, ...]


@dataclass(eq=False)
class PersonCodeInvalid(SetupError):
    """A person's code must be a short code, never a name."""

    code: str


class AlignmentError(StudioError):
    """The sensors could not be related to the body."""


@dataclass(eq=False)
class NoSensorWorn(AlignmentError):
    """No sensor of the take sits on a place of the body."""

    sensors: int
    """how many the take has"""


@dataclass(eq=False)
class PoseMissing(AlignmentError):
    """The take holds no reference pose and none was named."""

    take_s: float


@dataclass(eq=False)
class PoseTooShort(AlignmentError):
    """A named pose holds too few samples to average, or lies outside the take."""

    pose: str
    from_s: float
    to_s: float
    take_s: float


@dataclass(eq=False)
class MovedDuringHold(AlignmentError):
    """Limbs moved too much while the pose was held."""

    pose: str
    places: tuple[str, ...]
    degrees: tuple[float, ...]


@dataclass(eq=False)
class HeadingsUnknown(AlignmentError):
    """Which way these limbs faced in the held pose is not known."""

    places: tuple[str, ...]


@dataclass(eq=False)
class PoseNotHeld(AlignmentError):
    """Gravity says that another pose was held than the one named."""

    pose: str
    places: tuple[str, ...]
    """the limbs that tell"""
    held: str
    """name of the pose that it looks like"""


class TakeFileError(StudioError):
    """A take cannot be read."""


@dataclass(eq=False)
class NotATake(TakeFileError):
    """There is no take at this path."""

    path: str


@dataclass(eq=False)
class Damaged(TakeFileError):
    """Nothing of the take can be used."""

    path: str
    recovered_until_s: float


@dataclass(eq=False)
class WrittenByNewerStudio(TakeFileError):
    """The take follows a later version of the capture profile."""

    path: str
    found: str
    supported: str


@dataclass(eq=False)
class TakeUnsafe(TakeFileError):
    """The file asks for more memory, channels or time than any take needs."""

    path: str
    reason: str


@dataclass(eq=False)
class TruthMissing(TakeFileError):
    """The take has no true motion beside it: only takes of the synthetic suit have."""

    path: str


class RecordingError(StudioError):
    """A recording could not be started, kept or confirmed."""


@dataclass(eq=False)
class AlreadyRecording(RecordingError):
    """A second recording was to be started while one goes on."""

    folder: str
    """of the recording that goes on"""


@dataclass(eq=False)
class StoppedEarly(RecordingError):
    """A recording was stopped by hand before it began."""

    source: str


@dataclass(eq=False)
class DiskFull(RecordingError):
    """There is no room for the recording."""

    folder: str
    kept_s: float
    """s of the recording that are safe on disk (0 when it never started)"""


@dataclass(eq=False)
class FileAtLimit(RecordingError):
    """The recording is as long as a file on this disk may be (FAT32: 4 GiB)."""

    folder: str
    kept_s: float
    """s of the recording that are safe on disk"""


@dataclass(eq=False)
class TakeAtLimit(RecordingError):
    """The recording has as many samples or events as a take may have."""

    folder: str
    kept_s: float
    """s of the recording that are safe on disk"""


@dataclass(eq=False)
class FolderNotWritable(RecordingError):
    """The library folder cannot be written."""

    folder: str


@dataclass(eq=False)
class FolderIsFile(RecordingError):
    """A file stands where a folder is wanted."""

    path: str


@dataclass(eq=False)
class VerificationFailed(RecordingError):
    """The finished take could not be read back as it was written."""

    path: str
    expected: int
    """samples written"""
    found: int
    """samples read back"""


class ImportFailed(StudioError):
    """A foreign recording could not be turned into a take."""


@dataclass(eq=False)
class RecordingMissing(ImportFailed):
    """There is no file or folder of this name."""

    path: str


@dataclass(eq=False)
class MapMissing(ImportFailed):
    """Tables do not tell what their columns mean, and no map does."""

    paths: tuple[str, ...]


@dataclass(eq=False)
class RecordingUnreadable(ImportFailed):
    """A foreign file is not what its format promises."""

    file: str
    line: int
    """1-based line, 0 when the whole file is meant"""
    reason: str


@dataclass(eq=False)
class MapFileInvalid(ImportFailed):
    """The map that explains CSV columns does not hold together."""

    file: str
    reason: str


@dataclass(eq=False)
class FormatUnknown(ImportFailed):
    """No importer recognises these files."""

    paths: tuple[str, ...]


class ExportError(StudioError):
    """A file for another program could not be made."""


@dataclass(eq=False)
class NothingToExport(ExportError):
    """The take holds nothing of what was asked for."""

    what: str
    reason: str
    """one clause, lower case, without full stop"""


@dataclass(eq=False)
class CannotWrite(ExportError):
    """The target file cannot be written."""

    path: str
    reason: str
    """one clause, lower case, without full stop"""


@dataclass(eq=False)
class TargetTaken(ExportError):
    """A file stands there that is not the same kind of file from this take, or that was changed since."""

    path: str


@dataclass(eq=False)
class ReadBackDiffers(ExportError):
    """The written file, read by another path, is not what was meant."""

    path: str
    difference: str
