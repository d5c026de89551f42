"""Attacks on ``stribeck check``: laws whose truth is known by hand."""
