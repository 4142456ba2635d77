"""The command `linkage-fmu`, and `python -m linkage_fmu`."""

from __future__ import annotations

import signal
import sys

from . import _engine


def main() -> int:
    """Run the command line. Returns the exit code."""
    # The program ends at Ctrl-C or handles it. Python's handler would only record it.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _engine.main(["linkage-fmu", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
