"""A take that was cut off gets its end. The original goes only when the finished one was read back."""

import contextlib
import time
from collections.abc import Iterator
from pathlib import Path

from mcap.opcode import Opcode
from mcap.records import Header

from studio import __version__
from studio.core.errors import Damaged, DiskFull, FolderNotWritable, NotATake, StudioError
from studio.storage.block_reader import BlockReader, Record, read_attachment_record
from studio.storage.blocks import Block, BlockBuilder, RecordFacts, encode
from studio.storage.encoder import identity_record, schema_records
from studio.storage.facts import Event, event_json
from studio.storage.filesystem import FILES, FileSystem, is_held, lock
from studio.storage.ledger import Ledger
from studio.storage.profile import (
    BALLAST_FILE,
    EVENT_TOPIC,
    IMU_TOPIC,
    MAGIC,
    PART_FILE,
    PROFILE,
    TAKE_FILE,
)
from studio.storage.session_folder import list_takes
from studio.storage.take_file import NO_ROOM
from studio.storage.verification import verify

BEGINNING = 60.0  # s in which a recording that has held back its room makes its file; it takes milliseconds

UNFINISHED = "take.recovering.mcap"
ORIGINAL = "take.damaged.mcap"
"""What the cut-off file is called afterwards when more than its end was damaged: others may get more out of it."""


def recover(folder: Path, filesystem: FileSystem = FILES) -> Path:
    """Finish a take whose recording was cut off, and return its folder.

    Raises
    ------
    NotATake, WrittenByNewerStudio, TakeUnsafe, Damaged
        The file cannot be read.
    DiskFull, FolderNotWritable, VerificationFailed
        The finished file cannot be written, or another studio is at it; the original is as it was.
    """
    part = folder / PART_FILE
    if (folder / TAKE_FILE).is_file():
        return folder
    if not part.is_file():
        raise NotATake(str(folder))
    try:
        with part.open("r+b") as stream:
            if not lock(stream.fileno(), wait=False):
                raise FolderNotWritable(str(folder))
            damaged = _finish(BlockReader(stream, part), folder, filesystem)
        if damaged:
            filesystem.replace(part, folder / ORIGINAL)
        else:
            filesystem.remove(part)
        filesystem.remove(folder / BALLAST_FILE)
        filesystem.sync_folder(folder)
    except OSError as error:
        with contextlib.suppress(OSError):
            filesystem.remove(folder / UNFINISHED)
        if error.errno in NO_ROOM:
            raise DiskFull(str(folder), 0.0) from error
        raise FolderNotWritable(str(folder)) from error
    return folder


def recover_all(library: Path) -> list[tuple[Path, StudioError | None]]:
    """Finish all takes of a library whose writer is gone, and return each folder with what stood in the way.

    Room that was held back for a recording which never began or which ended without giving it back is freed.
    """
    told: list[tuple[Path, StudioError | None]] = []
    for take in list_takes(library):
        if not take.recovered:
            continue
        try:
            recover(take.folder)
        except StudioError as error:
            told.append((take.folder, error))
        else:
            told.append((take.folder, None))
    for ballast in library.glob(f"*/*/*/{BALLAST_FILE}"):
        with contextlib.suppress(OSError):
            _free(ballast)
    return told


def _free(ballast: Path) -> None:
    """Remove a left-over file, and its folder when there is nothing else in it."""
    part = ballast.with_name(PART_FILE)
    if time.time() - ballast.stat().st_mtime < BEGINNING or (part.exists() and is_held(part)):
        return
    ballast.unlink()
    if not any(ballast.parent.iterdir()):
        ballast.parent.rmdir()


def _finish(reader: BlockReader, folder: Path, filesystem: FileSystem) -> int:
    """Write and verify the finished take; return how much damage there was."""
    for _ in reader.messages():
        pass  # now all channels are known, whichever of their records was damaged
    if reader.identity is None and not reader.channels:
        raise Damaged(str(folder / PART_FILE), 0.0)
    target = folder / UNFINISHED
    filesystem.remove(folder / BALLAST_FILE)
    filesystem.remove(target)
    descriptor = filesystem.create(target)
    ledger = Ledger()
    try:
        for block in _rebuilt(reader):
            filesystem.write(descriptor, block.data)
            ledger.add(block)
        channels = {channel.topic: channel for channel in reader.channels.values()}
        filesystem.write(descriptor, ledger.closing(channels, indexed=True))
        filesystem.sync_whole(descriptor)
    finally:
        filesystem.close(descriptor)
    imu = {channel.id for topic, channel in channels.items() if topic.startswith(IMU_TOPIC)}
    verify(target, ledger, imu)
    filesystem.replace(target, folder / TAKE_FILE)
    return reader.damaged


def _rebuilt(reader: BlockReader) -> Iterator[Block]:
    """Yield the same messages and attachments in blocks without damage."""
    yield _opening(reader)
    number = 1
    latest = 0
    for records in reader.blocks():
        builder = BlockBuilder(reader.take, number + 1)
        for record in records:
            _copy(record, reader, builder)
        if builder.parts:
            number += 1
            latest = max([latest, *(chunk.end for chunk in builder.chunks)])
            yield builder.finish()
    event = next((channel.id for channel in reader.channels.values() if channel.topic == EVENT_TOPIC), None)
    if event is not None:
        builder = BlockBuilder(reader.take, number + 1)
        note = Event("recovered", latest * 1e-9, {"damaged": reader.damaged, "studio": __version__})
        builder.add_messages(event, 0, [latest], [event_json(note)])
        yield builder.finish()


def _opening(reader: BlockReader) -> Block:
    lead = MAGIC + encode(Header(PROFILE, f"kinetag-studio {__version__}"))
    builder = BlockBuilder(reader.take, 1)
    if reader.identity is not None:
        record = encode(identity_record(reader.identity))
        builder.metadata.append(RecordFacts(len(lead) + builder.add(record), len(record), "kinetag"))
    builder.add(encode(*schema_records(), *reader.channels.values()))
    block = builder.finish()
    return Block(lead + block.data, metadata=block.metadata)


def _copy(record: Record, reader: BlockReader, builder: BlockBuilder) -> None:
    if record.opcode == Opcode.CHUNK:
        messages = reader.chunk(record)
        if messages is not None:
            builder.add_chunk(messages.data)
    attachment = read_attachment_record(record)
    if attachment is not None:
        data = encode(attachment)
        builder.attachments.append(
            RecordFacts(
                builder.add(data),
                len(data),
                attachment.name,
                attachment.media_type,
                attachment.log_time,
                len(attachment.data),
            )
        )
