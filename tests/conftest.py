"""What holds for every test: nothing of the user is touched, no thread is left behind, failures can be repeated."""

import os
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

ROOT = Path(__file__).resolve().parents[1]
ENDING = 5.0  # s; a thread whose future has its result may still have its last instructions before it
WORTH_A_LOOK = 400  # lines; tests/test_conventions.py refuses more than 600

# No screen is needed: where there is none, Qt paints into memory.
if not os.environ.get("DISPLAY") and not os.environ.get("WAYLAND_DISPLAY"):
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

# A loaded machine is slow, not wrong; CI finds the same examples in every run.
settings.register_profile(
    "studio", deadline=None, derandomize=bool(os.environ.get("CI")), suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("studio")


@pytest.fixture(autouse=True)
def user_folders(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    """Point the folders of platformdirs to an empty place."""
    place = tmp_path_factory.getbasetemp() / "user"
    for variable in ("XDG_DATA_HOME", "XDG_CONFIG_HOME", "XDG_STATE_HOME"):
        monkeypatch.setenv(variable, str(place / variable.lower()))


@pytest.fixture(autouse=True)
def no_thread_is_left() -> Iterator[None]:
    """Fail the test that ends while a thread it started still runs."""
    before = set(threading.enumerate())
    yield
    started = [thread for thread in threading.enumerate() if thread not in before]
    for thread in started:
        thread.join(ENDING)
    left = [thread.name for thread in started if thread.is_alive()]
    assert not left, f"threads left behind: {', '.join(left)}"


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Name the modules that grow towards the limit."""
    sizes = {path: path.read_text(encoding="utf-8").count("\n") for path in (ROOT / "studio").rglob("*.py")}
    for path, lines in sorted(sizes.items(), key=lambda item: -item[1]):
        if lines > WORTH_A_LOOK:
            terminalreporter.write_line(f"{path.relative_to(ROOT)} has {lines} lines: more than {WORTH_A_LOOK}")
