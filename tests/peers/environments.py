"""Builds, once, the environments of the programs that read what we wrote.

They stand in the folder named by KINETAG_PEERS (``checkenv`` in the project when it is not set). The
programs are peers to test against, never dependencies of the product. Run as a script it only builds.
"""

import os
import shutil
import subprocess
import sys
import venv
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).parent
BLENDER = ("bpy==4.5.15",)  # the long-term release; has wheels for Python 3.11 alone
READERS = ("numpy==2.4.6", "bvhio==1.5.4", "bvh==0.3", "pybvh==0.9.0", "upc-pymotion==0.3.4")
BLENDER_PYTHON = (3, 11)


class PeersMissing(Exception):
    """An environment cannot be built here; says why."""


@dataclass(frozen=True)
class Peers:
    """How to start each program."""

    blender: tuple[str, ...]
    readers: tuple[str, ...]
    three: tuple[str, ...]


def build() -> Peers:
    """Return the peers, built when they are not there yet."""
    folder = Path(os.environ.get("KINETAG_PEERS", HERE.parents[1] / "checkenv")).resolve()
    blender = _python_environment(folder / "blender", BLENDER, _python_for_blender())
    readers = _python_environment(folder / "readers", READERS, sys.executable)
    three = _node_environment(folder / "three")
    return Peers(
        (str(blender), str(HERE / "read_bvh_bpy.py")),
        (str(readers), str(HERE / "read_bvh_packages.py")),
        ("node", str(three)),
    )


def _python_environment(folder: Path, packages: tuple[str, ...], interpreter: str) -> Path:
    python = folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    built = folder / "built.txt"  # written last: a broken build is begun anew
    if built.is_file() and built.read_text() == "\n".join(packages):
        return python
    shutil.rmtree(folder, ignore_errors=True)
    if interpreter == sys.executable:
        venv.create(folder, with_pip=True)
    else:
        _run([interpreter, "-m", "venv", str(folder)])
    _run([str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", *packages])
    built.write_text("\n".join(packages))
    return python


def _python_for_blender() -> str:
    if sys.version_info[:2] == BLENDER_PYTHON:
        return sys.executable
    name = "python{}.{}".format(*BLENDER_PYTHON)
    found = shutil.which(name)
    if found is None:
        raise PeersMissing(f"Blender as a Python module needs {name}, which is not on this computer")
    return found


def _node_environment(folder: Path) -> Path:
    """Return our script inside the folder, because node looks for modules beside the script."""
    npm = shutil.which("npm")
    if npm is None or shutil.which("node") is None:
        raise PeersMissing("three.js needs node and npm, which are not on this computer")
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("package.json", "read_bvh_three.mjs"):
        shutil.copyfile(HERE / name, folder / name)
    if not (folder / "node_modules" / "three" / "package.json").is_file():
        _run([npm, "install", "--silent", "--no-package-lock", "--prefix", str(folder)])
    return folder / "read_bvh_three.mjs"


def _run(command: list[str]) -> None:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise PeersMissing(f"{' '.join(command)} failed: {(done.stderr or done.stdout)[-500:]}")


if __name__ == "__main__":
    print(build())
