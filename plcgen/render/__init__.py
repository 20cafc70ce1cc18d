"""The one Jinja environment, and writing, comparing and recovering an output folder."""
