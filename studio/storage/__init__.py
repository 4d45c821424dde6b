"""Takes, persons and tags on disk. Needs no window, no link and no solver."""
