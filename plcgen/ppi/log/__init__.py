"""Values of S7-200 stations kept in a file for months: CSV, JSON lines or SQLite.

``stations`` reads, ``logger`` decides what is worth a row, ``keeping`` holds rows until they are on disk and begins new
files, ``files`` writes them. Nothing is missing without a mark: a row says that logging began or ended, that a station
is bad and since when, that cycles were missed, or how many rows found no place.
"""
