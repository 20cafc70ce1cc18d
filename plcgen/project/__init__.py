"""From YAML text to a validated spec: ``source`` (positions), ``schema`` (pydantic), ``catalog`` (devices)."""
