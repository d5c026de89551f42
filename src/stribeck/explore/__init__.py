"""A page with sliders that simulates a scenario in the browser, with the solver as WebAssembly."""

from stribeck.explore.page import explore

__all__ = ["explore"]
