"""PPI client for the S7-200: values and their types, symbols, exchanges over a line, and the API on top.

``values`` reads and writes what people type, ``places`` are addresses and symbols with types, ``exchange`` moves one
request and its answer over a line with bounded retries, ``client`` is the Python API.
"""

from plcgen.ppi.client.client import Client, CpuInfo, Reading, Written
from plcgen.ppi.client.exchange import ClientError, NoAnswerError, RefusedError, Settings

__all__ = ["Client", "ClientError", "CpuInfo", "NoAnswerError", "Reading", "RefusedError", "Settings", "Written"]
