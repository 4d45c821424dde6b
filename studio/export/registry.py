"""The list of exporters, and the one way to write any of them."""

from importlib import import_module
from pathlib import Path

from studio.core.errors import ReadBackDiffers
from studio.export.file_target import sidecar_of, write_file
from studio.export.material import Material, Product, Wish
from studio.export.sidecar import as_text

EXPORTERS = {
    "bvh": "studio.export.bvh_export:export_bvh",
    "joints": "studio.export.csv_export:export_joints",
    "orientations": "studio.export.csv_export:export_orientations",
    "raw": "studio.export.csv_export:export_raw",
}
"""Imported when chosen. ``joints``, ``orientations`` and ``raw`` are the tables of ``--format csv``."""


def export_file(name: str, material: Material, wish: Wish, path: Path) -> tuple[Path, Path]:
    """Write ``path`` and ``path``.json, each read back first; return both. Whatever stood there is replaced.

    Raises
    ------
    NothingToExport, CannotWrite, ReadBackDiffers
        Files that stood there before are then untouched.
    """
    module, function = EXPORTERS[name].split(":")
    product: Product = getattr(import_module(module), function)(material, wish)
    beside = sidecar_of(path)
    written = write_file(path, product.blocks, product.read_back)
    text = as_text({**product.sidecar, "exporter": name, "file": written._asdict()})

    def same_text(part: Path) -> None:
        if part.read_bytes() != text:
            raise ReadBackDiffers(str(part), "the text differs")

    write_file(beside, [text], same_text)
    return path, beside
