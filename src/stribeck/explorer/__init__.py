"""A page with sliders that simulates a scenario in the browser, with the solver as WebAssembly."""

from stribeck.explorer.page import explore

__all__ = ["explore"]
