"""Kinetag Studio: motion capture with cheap body-worn sensors."""

__version__ = "0.1.0"
