"""An ISO-on-TCP server in front of a PPI line, so that S7 clients of any make reach an S7-200.

``passing`` decides what of a request may reach the line and what the client hears; ``server`` holds the connections.
"""
