"""One file per output format; ``FORMAT`` in each says which kinds of results it shows, and how."""
