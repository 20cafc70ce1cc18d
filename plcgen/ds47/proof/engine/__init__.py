"""The proof of the engine: channel, ticket and gate as they lie in a folder, under every fault, once per target.

``engine_checks(DriveEngine.of(files, dialect))`` are the checks; ``python -m plcgen.ds47.proof.engine`` runs
them for generated folders and records the hashes of the engines that hold.
"""
