"""The command `skinslide` from its first moment to its last.

Ctrl-C while the tool is being loaded ends it as it does later. A process that is done ends at once: tearing down what
USD and the core hold would take as long as some frames, for nothing.
"""

from __future__ import annotations

import gc
import os
import signal
import sys
from typing import NoReturn


def run() -> NoReturn:
    """Runs the process of a command."""
    # numpy's BLAS would keep a thread busy on each processor, waiting for matrix products: there are none here.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    code = main()
    try:
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
    except OSError:
        sys.exit(code)  # which says so, and fails
    os._exit(code)


def main() -> int:
    """Runs one command; returns its exit code."""
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # until cli.main can say what became of it
    gc.disable()  # until cli.main has loaded the command, of which nothing is garbage
    from skinslide.command import cli

    return cli.main()
