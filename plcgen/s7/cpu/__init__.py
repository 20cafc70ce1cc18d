"""The soft CPU: SCL compiled to Python over real S7 memory, with a scan cycle on a virtual clock."""
