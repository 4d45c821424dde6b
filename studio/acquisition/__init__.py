"""Bytes to samples: links to radios, ports, files and the simulator, and the dialects they speak."""
