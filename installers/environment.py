"""Install what pyproject.toml lists into the environment that runs this file, unless that is done already.

Run by studio.sh, studio.bat, test.sh and test.bat before anything is installed: the standard library only.
A stamp in the environment remembers what it was made from, so that later starts cost milliseconds.
"""

import hashlib
import platform
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
EXTRAS = {"run": "", "dev": "[dev]"}
CONTAINS = {"run": ("run", "dev"), "dev": ("dev",)}  # whoever can test can also start

NO_NETWORK = (
    r"NewConnectionError|ConnectTimeout|ReadTimeout|ProxyError|Max retries exceeded|Temporary failure in name"
    r"|Name or service not known|nodename nor servname|getaddrinfo failed|Network is unreachable"
)
REASONS = (
    (r"No space left on device|\[Errno 28\]", "The disk is full: free about 500 MB, then start again."),
    (
        r"CERTIFICATE_VERIFY_FAILED|SSLError",  # before the network: pip names its retries here too
        "The network lets no safe connection through: ask whoever runs it for its certificate, then start again.",
    ),
    (NO_NETWORK, "The packages could not be fetched: connect this computer to the network, then start again."),
    (r"Permission denied|\[Errno 13\]", "The environment cannot be written: check who owns its folder."),
)
UNKNOWN_REASON = "The packages could not be installed; the lines above say why."


def fingerprint() -> str:
    """Return what an environment depends on: the lists, the Python, and where the studio lies."""
    text = hashlib.sha256()
    for part in (
        (ROOT / "pyproject.toml").read_bytes(),
        (ROOT / "constraints.txt").read_bytes(),
        platform.python_version().encode(),
        str(ROOT).encode(),
    ):
        text.update(hashlib.sha256(part).digest())
    return text.hexdigest()


def is_ready(venv: Path, kind: str) -> bool:
    """Tell whether ``venv`` was made from the present lists, for ``kind`` or for more than that."""
    wanted = fingerprint()
    stamps = (venv / f"kinetag-{other}.stamp" for other in CONTAINS[kind])
    return any(stamp.is_file() and stamp.read_text(encoding="utf-8") == wanted for stamp in stamps)


def install(venv: Path, kind: str) -> int:
    """Install and stamp; return 0, or what pip returned after telling why."""
    (venv / f"kinetag-{kind}.stamp").unlink(missing_ok=True)
    code, said = _pip(kind)
    if code:
        sys.stderr.write(said)
        sys.stderr.write(reason_in(said) + "\n")
        return code
    (venv / f"kinetag-{kind}.stamp").write_text(fingerprint(), encoding="utf-8")
    return 0


def reason_in(said: str) -> str:
    """Return one sentence for what pip said when it failed."""
    return next((sentence for pattern, sentence in REASONS if re.search(pattern, said)), UNKNOWN_REASON)


def _pip(kind: str) -> tuple[int, str]:
    options = ["--quiet", "--disable-pip-version-check", "--no-input", "--retries", "2"]
    constraints = str(ROOT / "constraints.txt")
    command = [sys.executable, "-m", "pip", "install", *options, "-e", f"{ROOT}{EXTRAS[kind]}", "-c", constraints]
    with tempfile.TemporaryFile() as log:
        code = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, check=False).returncode
        log.seek(0)
        return code, log.read().decode(errors="replace")


def main() -> int:
    """Make the environment ready: ``environment.py run|dev VENV``."""
    kind, venv = sys.argv[1], Path(sys.argv[2])
    if is_ready(venv, kind):
        return 0
    sys.stderr.write("Installing what Kinetag Studio needs (half a minute, once).\n")
    return install(venv, kind)


if __name__ == "__main__":
    sys.exit(main())
