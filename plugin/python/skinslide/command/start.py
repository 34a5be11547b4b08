"""The command `skinslide` from its first moment: Ctrl-C while the tool is being loaded ends it as it does later."""

from __future__ import annotations

import signal


def main() -> int:
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # until cli.main can say what became of it
    from skinslide.command import cli

    return cli.main()
