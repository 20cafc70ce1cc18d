"""Start of the command line; ``--version`` answers before anything else is imported."""

from __future__ import annotations

import gc
import sys

from plcgen._version import __version__


def main() -> int:
    """Run the command line and return its exit code."""
    if sys.argv[1:] in (["--version"], ["-V"]) and sys.stdout is not None:
        try:
            sys.stdout.write(f"plcgen {__version__}\n")
            sys.stdout.flush()
        except OSError:
            pass
        else:
            return 0
    collect_rarely()
    from plcgen.cli.main import run

    return run()


def collect_rarely() -> None:
    """Look for circles of garbage seldom, in a process of one's own: most of what a run makes is needed to its end."""
    gc.set_threshold(100_000, 50, 100)


if __name__ == "__main__":
    sys.exit(main())
