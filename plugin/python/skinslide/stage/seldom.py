"""Modules of USD that few commands need, and that take long to load beside a short bake."""

from __future__ import annotations

import signal
from importlib import import_module
from types import ModuleType


def usd_shade() -> ModuleType:
    """The module pxr.UsdShade."""
    return _loaded("UsdShade")


def usd_utils() -> ModuleType:
    """The module pxr.UsdUtils."""
    return _loaded("UsdUtils")


def _loaded(name: str) -> ModuleType:
    """Uninterrupted, as USD must be while it loads."""
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        return import_module(f"pxr.{name}")
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
