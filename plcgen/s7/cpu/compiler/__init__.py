"""One block of SCL to Python source: one part per concern, each given the parts it needs.

``block.compile_block`` puts them together. What calls itself through others - expressions, statements - goes through
a table of parts by class of node: ``Expressions`` and ``Statements``.
"""
