"""Machines from other programs' files, and back."""

from __future__ import annotations

from stribeck.exchange.bam import from_bam, to_bam
from stribeck.exchange.mjcf import from_mujoco_file, to_mujoco

__all__ = ["from_bam", "from_mujoco_file", "to_bam", "to_mujoco"]
