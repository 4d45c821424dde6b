"""studio.sh and test.sh set everything up, or say in one sentence what is missing and what to do."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from installers import environment

ROOT = Path(__file__).resolve().parents[2]
TOOLS = ("sh", "dirname", "cat", "tail", "mktemp", "rm", "env", "date", "chmod")

pytestmark = pytest.mark.skipif(os.name == "nt", reason="Windows has its own scripts, and no sh to run these")


class Computer:
    """A path with nothing on it but a few tools and the programs a test puts there."""

    def __init__(self, folder: Path) -> None:
        self.programs = folder / "programs"
        self.venv = folder / "venv"
        self.log = folder / "log"
        self.programs.mkdir()
        for tool in TOOLS:
            found = shutil.which(tool)
            assert found, tool
            (self.programs / tool).symlink_to(found)
        self.user(1000)

    def program(self, path: Path, script: str) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"#!{shutil.which('sh')}\n{script}\n", encoding="utf-8")
        path.chmod(0o755)

    def on_path(self, name: str, script: str) -> None:
        self.program(self.programs / name, script)

    def user(self, number: int) -> None:
        self.on_path("id", f"echo {number}")

    def ready_environment(self, kind: str = "run") -> None:
        """Pretend an environment: its Python is ours for the set-up and only tells its words otherwise."""
        self.program(
            self.venv / "bin" / "python",
            f'case "$1" in -c|-I) exec {sys.executable} "$@" ;; esac\nprintf "%s\\n" "$@" >> {self.log}',
        )
        (self.venv / "pyvenv.cfg").touch()
        (self.venv / f"kinetag-{kind}.stamp").write_text(environment.fingerprint(), encoding="utf-8")

    def run(self, script: str, *words: str, venv: str = "") -> subprocess.CompletedProcess[str]:
        facts = {"PATH": self.programs, "KINETAG_VENV": venv or self.venv, "TMPDIR": self.venv.parent}
        return subprocess.run(
            [str(self.programs / "sh"), str(ROOT / script), *words],
            env={name: str(fact) for name, fact in facts.items()},
            cwd=self.venv.parent,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            check=False,
        )


@pytest.fixture
def computer(tmp_path: Path) -> Computer:
    return Computer(tmp_path)


def old_python(version: str) -> str:
    return f'case "$2" in *"is too"*) echo "{version} is too old" ;; *) exit 1 ;; esac'


def python_without_ensurepip() -> str:
    return 'case "$2" in *ensurepip*) exit 1 ;; *"-venv"*) echo python3.12-venv ;; *) exit 0 ;; esac'


def python_that_makes_no_environment(version: str) -> str:
    return f'case "$1" in -m) echo "$@"; exit 1 ;; -V) echo Python {version} ;; esac'


def test_without_python_the_studio_says_which_are_needed(computer: Computer):
    run = computer.run("studio.sh")

    assert run.returncode == 1
    assert run.stdout == ""
    assert run.stderr == (
        "Python 3.11, 3.12 or 3.13 is needed and none was found: "
        "install one, for example from python.org, then start again.\n"
    )


def test_a_python_that_is_too_old_is_named(computer: Computer):
    computer.on_path("python3", old_python("3.9"))

    run = computer.run("studio.sh")

    assert run.returncode == 1
    assert run.stderr.startswith("Python 3.11, 3.12 or 3.13 is needed and 3.9 is too old: install one")
    assert run.stderr.count("\n") == 1


def test_a_shim_that_only_fails_is_passed_over(computer: Computer):
    computer.on_path("python3.13", "echo 'pyenv: python3.13: command not found' >&2; exit 127")
    computer.on_path("python3", python_that_makes_no_environment("3.12.1"))

    run = computer.run("studio.sh")

    assert run.returncode == 1
    assert run.stderr == (
        f"Making an environment with Python 3.12.1 in {computer.venv}.\n"
        f"-m venv --clear {computer.venv}\n"
        f"The environment could not be made in {computer.venv} for the reason above.\n"
    )


def test_without_the_module_for_environments_a_user_reads_the_command(computer: Computer):
    computer.on_path("python3", python_without_ensurepip())
    computer.on_path("apt-get", "exit 1")

    run = computer.run("studio.sh")

    assert run.returncode == 1
    assert run.stderr == (
        "python3 cannot make environments (the module ensurepip is missing): "
        "run 'sudo apt install python3.12-venv', then start again.\n"
    )


def test_a_complete_python_goes_before_a_newer_one_without_environments(computer: Computer):
    computer.on_path("python3.13", python_without_ensurepip())
    computer.on_path("python3.11", python_that_makes_no_environment("3.11.2"))

    assert "Making an environment with Python 3.11.2" in computer.run("studio.sh").stderr


def test_root_gets_the_missing_packages_after_being_told(computer: Computer):
    computer.user(0)
    computer.on_path("python3", python_without_ensurepip())
    computer.on_path("apt-get", f'echo "$@" >> {computer.log}')

    run = computer.run("studio.sh")

    assert run.stderr.startswith(
        "python3 cannot make environments (the module ensurepip is missing): "
        "installing python3.12-venv from the packages of this system.\n"
    )
    assert computer.log.read_text(encoding="utf-8") == "install -y --no-install-recommends python3.12-venv\n"


def test_old_package_lists_are_fetched_and_the_install_tried_again(computer: Computer):
    computer.user(0)
    computer.on_path("apt-get", f'echo "$1" >> {computer.log}; [ "$1" = update ] || {{ echo "E: none"; exit 100; }}')

    run = computer.run("studio.sh")

    assert computer.log.read_text(encoding="utf-8").split() == ["install", "update", "install"]
    assert run.returncode == 1
    assert "E: none" in run.stderr
    assert run.stderr.splitlines()[-1].endswith("install them by hand, then start again.")


def test_a_sudo_that_asks_for_nothing_is_used(computer: Computer):
    computer.on_path("sudo", '[ "$1" = -n ] && shift; exec "$@"')
    computer.on_path("true", "exit 0")
    computer.on_path("apt-get", f'echo "$@" >> {computer.log}')

    computer.run("studio.sh")

    assert computer.log.read_text(encoding="utf-8") == "install -y --no-install-recommends python3 python3-venv\n"


def test_a_folder_that_is_no_environment_is_never_cleared(computer: Computer):
    computer.on_path("python3", "exit 0")
    computer.venv.mkdir()
    (computer.venv / "thesis.txt").write_text("three years", encoding="utf-8")

    run = computer.run("studio.sh")

    assert run.returncode == 1
    assert "is in the way" in run.stderr
    assert (computer.venv / "thesis.txt").exists()


def test_words_after_the_name_reach_the_studio_unchanged(computer: Computer):
    computer.ready_environment()

    run = computer.run("studio.sh", "record", "--source", "synthetic:walk?seed=1&tags=15", "--library", "my takes")

    assert run.returncode == 0
    assert (run.stdout, run.stderr) == ("", "")
    assert computer.log.read_text(encoding="utf-8").splitlines() == [
        "-m",
        "studio",
        "record",
        "--source",
        "synthetic:walk?seed=1&tags=15",
        "--library",
        "my takes",
    ]


def test_the_tests_need_a_compiler_and_say_so(computer: Computer):
    computer.ready_environment("dev")

    run = computer.run("test.sh")

    assert run.returncode == 1
    assert run.stderr == (
        "The tests compile C and gcc is missing: install gcc (macOS: xcode-select --install), then start again.\n"
    )


def test_all_checks_run_and_a_failure_is_not_hidden_by_the_next_success(computer: Computer):
    computer.ready_environment("dev")
    computer.on_path("gcc", "cat >/dev/null")
    computer.program(computer.venv / "bin" / "lint-imports", "exit 1")

    run = computer.run("test.sh")

    assert run.returncode == 1
    assert computer.log.read_text(encoding="utf-8").split() == [
        "-m", "ruff", "check", "-m", "mypy", "-m", "pytest", "-n", "auto", "--ignore=tests/journeys",
        "-m", "pytest", "tests/journeys",
    ]  # fmt: skip
    assert re.findall(r"== (.+): (passed|FAILED) in \d+ s", run.stderr) == [
        ("ruff", "passed"),
        ("mypy", "passed"),
        ("import-linter", "FAILED"),
        ("pytest", "passed"),
        ("journeys", "passed"),
    ]
    assert run.stderr.endswith("Failed: import-linter\n")


def test_kinds_of_tests_are_chosen_and_other_words_go_to_pytest(computer: Computer):
    computer.ready_environment("dev")
    computer.on_path("gcc", "cat >/dev/null")
    computer.on_path("node", "exit 0")
    computer.on_path("npm", "exit 0")
    computer.on_path("uname", "echo Darwin")

    assert computer.run("test.sh", "--long", "-k", "walk and run", "--peers").returncode == 0
    assert computer.log.read_text(encoding="utf-8").splitlines() == [
        "tests/peers/environments.py",
        "-m",
        "pytest",
        "-m",
        "long or peers",
        "-k",
        "walk and run",
    ]


def test_what_the_peers_need_is_installed_before_they_are_asked(computer: Computer):
    computer.user(0)
    computer.ready_environment("dev")
    computer.on_path("gcc", "cat >/dev/null")
    computer.on_path("uname", "echo Darwin")
    computer.on_path("apt-get", f'echo "$@" >> {computer.log}')

    computer.run("test.sh", "--peers")

    first, then, *_ = computer.log.read_text(encoding="utf-8").splitlines()
    assert (first, then) == ("install -y --no-install-recommends nodejs npm", "tests/peers/environments.py")


def test_the_environment_may_be_named_from_where_one_stands(computer: Computer):
    computer.ready_environment("dev")
    computer.on_path("gcc", "cat >/dev/null")

    run = computer.run("test.sh", "tests/core", venv="venv")

    assert run.returncode == 0, run.stderr
    assert computer.log.read_text(encoding="utf-8").split() == ["-m", "pytest", "tests/core"]


def test_an_environment_for_tests_is_enough_to_start_but_not_the_reverse(tmp_path: Path):
    (tmp_path / "kinetag-dev.stamp").write_text(environment.fingerprint(), encoding="utf-8")
    assert environment.is_ready(tmp_path, "run")

    (tmp_path / "kinetag-dev.stamp").rename(tmp_path / "kinetag-run.stamp")
    assert not environment.is_ready(tmp_path, "dev")


def test_an_environment_of_other_lists_is_not_ready(tmp_path: Path):
    (tmp_path / "kinetag-run.stamp").write_text("made from something else", encoding="utf-8")

    assert not environment.is_ready(tmp_path, "run")


def test_a_failing_pip_is_shown_and_explained(
    computer: Computer, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    computer.ready_environment()
    computer.on_path("python", "echo 'WARNING: Retrying after connection broken by NewConnectionError' >&2; exit 1")
    monkeypatch.setattr(sys, "executable", str(computer.programs / "python"))

    assert environment.install(computer.venv, "run") == 1
    assert capsys.readouterr().err == (
        "WARNING: Retrying after connection broken by NewConnectionError\n"
        "The packages could not be fetched: connect this computer to the network, then start again.\n"
    )
    assert not environment.is_ready(computer.venv, "run")


@pytest.mark.parametrize(
    ("said", "begins"),
    [
        ("OSError: [Errno 28] No space left on device", "The disk is full"),
        ("socket.gaierror: [Errno -2] Name or service not known", "The packages could not be fetched"),
        ("Max retries exceeded (Caused by SSLError(CERTIFICATE_VERIFY_FAILED))", "The network lets no safe connection"),
        ("ERROR: Could not build wheels for vqf", "The packages could not be installed; the lines above"),
    ],
)
def test_what_pip_said_is_told_in_a_sentence(said: str, begins: str):
    assert environment.reason_in(said).startswith(begins)


def test_the_scripts_accept_the_pythons_that_the_package_accepts():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["requires-python"] == ">=3.11,<3.14"

    for script in ("environment.sh", "environment.bat"):
        text = (ROOT / "installers" / script).read_text(encoding="utf-8")
        assert "(3, 11) <= sys.version_info[:2] <= (3, 13)" in text
        assert set(re.findall(r"(?:python|py -)(3\.1\d)", text)) == {"3.11", "3.12", "3.13"}


def test_constraints_pin_every_package_the_lists_name():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    listed = project["dependencies"] + project["optional-dependencies"]["dev"]
    pinned = re.findall(r"^([\w-]+)==[\w.]+$", (ROOT / "constraints.txt").read_text(encoding="utf-8"), re.MULTILINE)

    assert {re.split(r"[<>=!]", name)[0] for name in listed} <= set(pinned)
