"""One service for every door: text in, frozen results out; it knows no protocol of an editor and no web framework.

``Workspace`` keeps the documents that are open, ``Document`` is one version of a text. Lines and columns count from 1,
in characters, as in every diagnostic; ``positions`` converts those of UTF-16, which editors and browsers count.
"""

from plcgen.workbench.service.documents import Document, Documents
from plcgen.workbench.service.results import Edit, Finding, Fix, Hover, Offer, Symbol
from plcgen.workbench.service.workspace import Workspace

__all__ = ["Document", "Documents", "Edit", "Finding", "Fix", "Hover", "Offer", "Symbol", "Workspace"]
