"""The figure: a body in perspective, painted with QPainter."""

from studio.ui.views.stage.stage import Stage

__all__ = ["Stage"]
