"""The command line: `riprap` and `python -m riprap`."""

from __future__ import annotations

import signal
import sys


def main() -> int:
    """Runs the command line with the arguments of the process; returns its exit code."""
    # signals as for any program of the system: the commands that end in good order set handlers of their own
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    from ._riprap import command

    return command(["riprap", *sys.argv[1:]], [sys.executable, "-m", "riprap"])


if __name__ == "__main__":
    sys.exit(main())
