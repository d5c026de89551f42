"""A page that simulates a scenario in the browser while its numbers are turned: the solver's own C as WebAssembly."""

from stribeck.explore.page import explore, explorer_page

__all__ = ["explore", "explorer_page"]
