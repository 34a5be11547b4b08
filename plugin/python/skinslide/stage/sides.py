"""The words by which names say that something is on the left or on the right."""

from __future__ import annotations

_RIGHT_OF = {"L": "R", "l": "r", "left": "right", "Left": "Right", "LEFT": "RIGHT"}
OTHER_SIDE = _RIGHT_OF | {right: left for left, right in _RIGHT_OF.items()}
