"""README's commands do what README says, word for word (but the suit walks faster than time)."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
SH = shutil.which("sh") or "sh"

needs_sh = pytest.mark.skipif(sys.platform == "win32", reason="README's commands are for sh")


def commands_below(heading: str, word: str) -> str:
    """Return the block of commands below ``heading`` that contains ``word``."""
    section = README.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    blocks: list[str] = re.findall(r"```sh\n(.*?)```", section, re.DOTALL)
    return next(block for block in blocks if word in block)


def run(commands: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run README's commands in ``folder``, where ``./studio.sh`` is this very studio."""
    studio = folder / "studio.sh"
    studio.write_text(f'#!{SH}\nPYTHONPATH="{ROOT}" exec "{sys.executable}" -m studio "$@"\n', encoding="utf-8")
    studio.chmod(0o755)
    (folder / "resources").symlink_to(ROOT / "resources")
    faster = commands.replace("synthetic:walk ", "'synthetic:walk?speed=max' ")
    return subprocess.run([SH, "-e", "-c", faster], cwd=folder, capture_output=True, text=True, check=False)


@needs_sh
def test_the_first_take_walks_into_a_bvh_and_a_table(tmp_path: Path):
    done = run(commands_below("First take in one minute", "record --source synthetic:walk"), tmp_path)

    assert done.returncode == 0, done.stderr
    said = (tmp_path / "take.txt").read_text(encoding="utf-8")
    assert said.count("\n") == 1
    assert (tmp_path / said.strip() / "take.mcap").is_file()
    assert (tmp_path / "walk.bvh").read_text(encoding="utf-8").startswith("HIERARCHY\n")
    assert "left_knee_flexion_deg" in (tmp_path / "walk-joints.csv").read_text(encoding="utf-8").splitlines()[0]


@needs_sh
def test_the_sample_take_is_imported(tmp_path: Path):
    done = run(commands_below("First take in one minute", "import resources/samples"), tmp_path)

    assert done.returncode == 0, done.stderr
    assert (tmp_path / (tmp_path / "take.txt").read_text(encoding="utf-8").strip() / "take.mcap").is_file()


@pytest.mark.parametrize("verb", re.findall(r"^\| `(\w+)", README, re.MULTILINE))
def test_each_verb_of_the_table_explains_itself(verb: str):
    command = [sys.executable, "-m", "studio", verb, "--help"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)

    assert done.returncode == 0, done.stderr
    assert verb in done.stdout
