"""The proof of the engine: channel, ticket and gate as they lie in a folder, under every fault, once per target.

``make engine`` runs it for generated folders of every target and size, and records the engines that hold.
"""
