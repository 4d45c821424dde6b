"""What there is to show, without widgets: QtCore only."""
