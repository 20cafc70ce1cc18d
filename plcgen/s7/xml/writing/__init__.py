"""Blocks and SCL text to SimaticML documents."""
