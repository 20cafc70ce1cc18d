"""Where every member of a block with standard access lies, and the bytes that its start values make."""
