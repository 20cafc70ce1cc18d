"""SimaticML documents to blocks, tables and SCL text."""
