"""PPI, the point-to-point protocol of the S7-200: FDL frames, S7 PDUs, addresses, packing.

Everything here is pure. ``areas`` holds the numbers of the protocol, ``model`` the values, ``fdl`` the frames on the
line, ``pdu`` their contents, ``telegram`` both together, ``address`` what people write (VB100, M0.0), ``pack`` the
few telegrams for many items, ``stream`` finds frames in a capture, ``dissect`` explains them byte by byte.
"""
