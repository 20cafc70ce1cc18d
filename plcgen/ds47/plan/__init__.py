"""From a spec to a frozen project: telegrams packed to the record limit, buffers, names, numbers."""
