"""The running studio without a window: links, solver and take-writer at work together."""
