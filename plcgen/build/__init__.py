"""From the project to documents: protocols say what there is, this room writes every kind of file."""
