"""Where the focus goes when something that floats is put away."""

import shiboken6
from PySide6.QtWidgets import QWidget


def give_back(before: QWidget | None, window: QWidget) -> None:
    """Give the focus to the widget that had it, when it can still take it; else to the window itself."""
    if before is not None and shiboken6.isValid(before) and before.isVisible() and before.isEnabled():
        before.setFocus()
    else:
        window.setFocus()  # Qt would choose the next in the chain: the first control of the header
