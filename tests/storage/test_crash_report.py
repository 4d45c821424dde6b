"""Our own mistakes: told on this computer, without names."""

from pathlib import Path

from studio.storage.crash_report import write_crash_report


def test_the_report_holds_the_stack_and_not_the_user(tmp_path):
    secret = Path.home() / "takes of P014"
    try:
        raise ValueError(f"cannot stand {secret}")
    except ValueError as mistake:
        file = write_crash_report(mistake, tmp_path / "logs")

    text = file.read_text(encoding="utf-8")
    assert "ValueError" in text
    assert __name__.rsplit(".", 1)[-1] in text
    assert str(Path.home()) not in text
