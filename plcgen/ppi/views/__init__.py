"""Views of PPI masters for the templates."""
