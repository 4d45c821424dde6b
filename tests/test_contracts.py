"""Each import contract of pyproject.toml breaks when somebody breaks it, and holds for the tree as it is."""

import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
LINT = "import sys; from importlinter.cli import lint_imports_command; lint_imports_command()"

CORE = "core is arithmetic"
QT = "Qt is in ui alone"
WAITING = "storage, importers, analysis and export wait for nobody"
PORTS = "ports are in acquisition alone"
NETWORK = "the studio neither listens nor calls"
TRUTH = "the truth of the synthetic suit is for judging only"
PAGES = "a page knows no other page"
VIEWS = "views ask for nothing by themselves"
JUDGE = "the judge is called by the command line only"

# (the contract, the file that breaks it, the line it adds)
MUTATIONS = [
    ("layers", "core/take.py", "import studio.storage"),
    ("layers", "storage/profile.py", "import studio.acquisition"),
    ("layers", "acquisition/driver.py", "import studio.importers"),
    ("layers", "analysis/__init__.py", "import studio.export"),
    ("layers", "export/__init__.py", "import studio.capture"),
    ("layers", "capture/__init__.py", "import studio.ui"),
    ("layers", "ui/wording.py", "import studio.cli"),
    ("layers", "helpers/__init__.py", ""),
    (CORE, "core/take.py", "import asyncio"),
    (CORE, "core/take.py", "import threading"),
    (CORE, "core/take.py", "def now():\n    import time\n    return time.monotonic()"),
    (CORE, "core/take.py", "import os"),
    (QT, "storage/profile.py", "from PySide6 import QtCore"),
    (QT, "capture/__init__.py", "from PySide6 import QtCore"),
    (WAITING, "export/__init__.py", "import asyncio"),
    (PORTS, "capture/__init__.py", "import serial"),
    (NETWORK, "capture/__init__.py", "import urllib.request"),
    (NETWORK, "storage/profile.py", "import socket"),
    (TRUTH, "acquisition/driver.py", "from studio.acquisition.synthetic import truth"),
    (TRUTH, "capture/__init__.py", "from studio.acquisition.synthetic import truth"),
    (JUDGE, "capture/__init__.py", "from studio.capture import truth"),
    (PAGES, "ui/models/playhead.py", "import studio.ui.views.rail"),
    (PAGES, "ui/views/rail.py", "import studio.ui.presenters.home"),
    (VIEWS, "ui/views/rail.py", "import studio.capture.live_session"),
]


def lint(tree: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", LINT, "--no-logo", "--no-cache"]
    return subprocess.run(command, cwd=tree, capture_output=True, text=True, check=False)


def broken(report: str) -> set[str]:
    """Return the names of the contracts that the report calls broken."""
    return {line.removesuffix(" BROKEN") for line in report.splitlines() if line.endswith(" BROKEN")}


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    shutil.copytree(ROOT / "studio", tmp_path / "studio", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    return tmp_path


def test_the_tree_as_it_is_keeps_every_contract(tree: Path):
    run = lint(tree)

    assert run.returncode == 0, run.stdout + run.stderr


@pytest.mark.parametrize(("contract", "file", "line"), MUTATIONS)
def test_a_contract_breaks_when_somebody_breaks_it(tree: Path, contract: str, file: str, line: str):
    path = tree / "studio" / file
    path.parent.mkdir(exist_ok=True)
    with path.open("a", encoding="utf-8") as module:
        module.write(f"\n{line}\n")

    run = lint(tree)

    assert run.returncode == 1
    assert contract in broken(run.stdout), run.stdout + run.stderr


def test_every_contract_has_been_seen_to_break():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]

    assert {contract["name"] for contract in settings["contracts"]} == {name for name, _, _ in MUTATIONS}
