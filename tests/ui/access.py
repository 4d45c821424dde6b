"""What the checks of accessibility look for in any window."""

from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSlider,
    QAbstractSpinBox,
    QComboBox,
    QLabel,
    QLineEdit,
    QPlainTextEdit,
    QScrollBar,
    QWidget,
)

from studio.ui.views.elided import ElidedLabel

CONTROLS = (QAbstractButton, QAbstractItemView, QAbstractSlider, QAbstractSpinBox, QComboBox, QLineEdit, QPlainTextEdit)


def controls(window: QWidget) -> list[QWidget]:
    found = [child for child in window.findChildren(QWidget) if isinstance(child, CONTROLS) and child.isVisible()]
    inner = (QScrollBar, QAbstractItemView) if any(isinstance(child, QComboBox) for child in found) else (QScrollBar,)
    return [child for child in found if not isinstance(child, QScrollBar) and not _is_part(child, inner)]


def _is_part(child: QWidget, inner: tuple[type, ...]) -> bool:
    return isinstance(child.parent(), QAbstractSpinBox) or (
        isinstance(child, inner) and isinstance(child.window(), QComboBox)
    )


def needs(widget):
    """Return the size without which some of the text would be missing."""
    if isinstance(widget, QLabel) and widget.wordWrap():
        hint = widget.minimumSizeHint()
        hint.setHeight(widget.heightForWidth(widget.width()))
        return hint
    return widget.sizeHint()


def cut_texts(window: QWidget) -> list[tuple[str, str, tuple[int, int], tuple[int, int]]]:
    """Return what cannot be read whole: kind, text, size, and the size it needs."""
    shown = [w for w in window.findChildren(QWidget) if isinstance(w, (QLabel, QAbstractButton)) and w.isVisible()]
    return [
        (type(w).__name__, w.text(), (w.width(), w.height()), (needed.width(), needed.height()))
        for w in shown
        if w.text() and not isinstance(w, ElidedLabel) and (needed := needs(w))
        if w.width() < needed.width() or w.height() < needed.height()
    ]
