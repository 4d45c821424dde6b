"""Asking for folders, and showing them in the system's own file manager."""

from pathlib import Path

from PySide6.QtCore import QUrl
from PySide6.QtGui import QDesktopServices
from PySide6.QtWidgets import QFileDialog, QWidget


def choose_folder(parent: QWidget, title: str, start: Path) -> Path | None:
    """Let a folder be chosen; None when nobody did."""
    # The system's dialog where there is one: it knows the person's drives and favourites.
    chosen = QFileDialog.getExistingDirectory(parent, title, str(start))
    return Path(chosen) if chosen else None


def show_folder(folder: Path) -> bool:
    """Open a folder in the file manager; return whether the system took it."""
    return QDesktopServices.openUrl(QUrl.fromLocalFile(str(folder)))
