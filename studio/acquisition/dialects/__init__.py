"""Pure bytes to readings and back, one module for each wire format."""
