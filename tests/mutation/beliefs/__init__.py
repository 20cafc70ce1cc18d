"""Facts of plcgen's own source, broken one at a time: does generate or verify notice? Development only."""
