"""Files for other programs, made as blocks of bytes and read back before they count."""
