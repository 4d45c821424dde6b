"""Widgets: they render what the models say and emit what the operator intends."""
