"""The protocols that plcgen speaks: one package each, behind the face in ``base``."""
