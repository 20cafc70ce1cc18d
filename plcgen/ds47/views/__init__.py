"""Views of drive jobs for the templates."""
