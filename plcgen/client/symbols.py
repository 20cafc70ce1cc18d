"""Symbol tables of STEP 7-Micro/WIN for the client: they are read by ``spec.symbols``, where specs need them too."""

from plcgen.spec.symbols import SymbolTable, load_symbols, parse_symbols

__all__ = ["SymbolTable", "load_symbols", "parse_symbols"]
