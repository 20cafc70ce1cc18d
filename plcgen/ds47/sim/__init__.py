"""Simulated machinery that generated code is run against: the drive, the CPU, the serial slave.

``drive`` serves data set 47 (``server`` executes the requests, ``behaviour`` says what differs between devices,
``faults`` what goes wrong, ``load`` reads all of it from YAML).
"""
