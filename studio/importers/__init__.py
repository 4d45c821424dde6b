"""Foreign recordings to takes: files in, values of ``core`` out; nothing is written here."""
