"""The command `skinslide` from its first moment: Ctrl-C while the tool is being loaded ends it as it does later."""

from __future__ import annotations

import os
import signal


def main() -> int:
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # until cli.main can say what became of it
    from skinslide.arrays.apart import goes_on
    from skinslide.command import cli

    code = cli.main()
    if goes_on():
        os._exit(code)  # it would work in what the end of a process takes down
    return code
