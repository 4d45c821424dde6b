"""Names of folders that every system can hold, and codes of persons."""

import re
import unicodedata

from studio.core.errors import PersonCodeInvalid

SLUG_LIMIT = 64  # characters; with library, person and session a path stays under Windows' 260
NOBODY = "P000"
"""Folder of foreign recordings that do not tell whose they are; no person is given this code."""

_CODE = re.compile(r"(?=.*[0-9])[A-Za-z0-9]{1,16}")  # a word without a digit is a name
_DEVICES = {"CON", "PRN", "AUX", "NUL", *(f"{port}{n}" for port in ("COM", "LPT") for n in range(10))}
"""Names Windows keeps for devices (learn.microsoft.com, "Naming Files, Paths, and Namespaces")."""


def person_folder(code: str) -> str:
    """Return the folder of a person: the code in capitals, because some systems do not tell case apart.

    Raises
    ------
    PersonCodeInvalid
        Anything but 1 to 16 letters and digits with a digit among them, and what Windows takes for a device.
    """
    if not code:
        return NOBODY
    if not _CODE.fullmatch(code) or code.upper() in _DEVICES:
        raise PersonCodeInvalid(code)
    return code.upper()


def slug(name: str) -> str:
    """Return ``name`` as part of a folder's name: letters and digits of any script, ``-`` and ``_``, at most 64.

    Empty when nothing of the name can stay.
    """
    # NFC, or the same name would be two folders: macOS decomposes what it is given.
    composed = unicodedata.normalize("NFC", name)
    kept = "".join(c if unicodedata.category(c)[0] in "LNM" or c in "-_" else "-" for c in composed)
    short = re.sub(r"-{2,}", "-", kept).strip("-_")
    while len(short) > SLUG_LIMIT or len(short.encode()) > 3 * SLUG_LIMIT:  # ext4: 255 bytes in a name
        short = short[:-1].rstrip("-_")
    return short
