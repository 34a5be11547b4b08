"""How rest vertices are looked up in a frame, and which lookup that comes to on this machine."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from skinslide._core import lib
from skinslide.arrays.checks import device_number, number_of
from skinslide.arrays.native import call, enum_value, new, read
from skinslide.arrays.records import LookupInfo


@dataclass(frozen=True)
class Lookup:
    """How rest vertices are looked up in a frame. The result is always the same.

    Attributes:
        method: auto, egl or exact.
        device: The number of one of EGL's devices; None: the first that works.
        resolution: Texels along a side of the texture of faces; 0: by the patch.
    """

    method: str = "auto"
    device: int | None = None
    resolution: int = 0

    @staticmethod
    def of(lookup: str | Lookup) -> Lookup:
        """Makes a lookup of one, or of its method alone.

        Args:
            lookup: A lookup, or its method.

        Returns:
            The lookup.
        """
        return lookup if isinstance(lookup, Lookup) else Lookup(lookup)

    def options(self) -> Any:
        """The core's struct of options. Raises SliderError for what none can have."""
        options = new("workspace_options")
        options.lookup, options.device = enum_value("lookup", self.method, ""), device_number(self.device)
        options.resolution = number_of("resolution", self.resolution)
        return options


def choose_lookup(lookup: str | Lookup = "auto") -> LookupInfo:
    """Says which lookup, on which device, a choice leads to on this machine.

    Args:
        lookup: auto, egl, exact, or a Lookup.

    Returns:
        The lookup that a slider would have, and why.

    Raises:
        SliderError: That lookup cannot be had here.
    """
    info, device = new("lookup_info"), new("device_info")
    call(lib.skinslide_choose_lookup, Lookup.of(lookup).options(), info, device)
    return read(LookupInfo, info[0], device[0])
