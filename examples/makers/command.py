"""The command line of every make.py: one argument, the folder to write into."""

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

from makers.makehuman import MissingDataError


def main(make: Callable[[Path], Path], description: str) -> None:
    """Makes the example; exits with 1 and one line where its data is not installed."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("outdir", type=Path, help="folder for cache.usdc and the shot; made where missing")
    arguments = parser.parse_args()
    try:
        print(make(arguments.outdir))
    except MissingDataError as error:
        sys.exit(f"error: {error}")
