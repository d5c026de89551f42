"""A page with sliders that simulates a scenario in the browser, with the solver as WebAssembly."""

from stribeck.explore.page import explore, explorer_page

__all__ = ["explore", "explorer_page"]
