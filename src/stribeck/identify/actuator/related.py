"""Relations between a law's parameters that every search maintains: F_s >= F_c and z_ba < F_c/sigma_0."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from stribeck.arrays import Array
from stribeck.identify.actuator.coordinates import MachineCoordinate

_ABOVE = 1e-6  # of F_c: the least distance of F_s above it
_BELOW = 0.95  # of F_c/sigma_0: the largest z_ba


class Relations:
    """The related coordinates; ``number`` returns the machine's number at a path that is not fitted."""

    def __init__(self, sought: Sequence[MachineCoordinate], number: Callable[[str], float | None]) -> None:
        self.sought = sought
        at = {path: i for i, c in enumerate(sought) for path in c.targets if ".law." in path}
        self.above: list[tuple[int | float, int | float]] = []
        for path in dict.fromkeys(f"{path[:-3]}F_s" for path in at if path.endswith((".F_s", ".F_c"))):
            high, low = (at.get(p, number(p)) for p in (path, f"{path.removesuffix('F_s')}F_c"))
            if high is not None and low is not None:
                self.above.append((high, low))
        self.below: list[tuple[int, int | float, int | float]] = []
        for path, i in at.items():
            if path.endswith(".z_ba"):
                wanted = (f"{path.removesuffix('z_ba')}parameters.{n}" for n in ("F_c", "sigma_0"))
                level, stiffness = (at.get(p, number(p)) for p in wanted)
                if level is not None and stiffness is not None:
                    self.below.append((i, level, stiffness))

    def lower(self) -> list[int]:
        """The coordinates with another above them: their difference steps go down."""
        return [j for _, j in self.above if isinstance(j, int)]

    def repaired(self, U: Array) -> Array:
        """The points (lanes, coordinates), within their bounds, moved so that the relations hold."""
        for high, low in self.above:
            for row in U:
                level = self._number(low, row) * (1 + _ABOVE)
                if isinstance(high, int) and self._number(high, row) < level:
                    row[high] = self.sought[high].inner(level)
                if isinstance(low, int) and self._number(high, row) < level * (1 - 1e-12):  # a bound, or fixed
                    row[low] = self.sought[low].inner(self._number(high, row) / (1 + 2 * _ABOVE))
        for i, level_at, stiffness_at in self.below:
            for row in U:
                most = _BELOW * self._number(level_at, row) / self._number(stiffness_at, row)
                if self.sought[i].outer(row[i]) > most:
                    row[i] = self.sought[i].inner(most)
        return U

    def _number(self, which: int | float, row: Array) -> float:
        """The value of a fitted (by index) or fixed parameter."""
        return self.sought[which].outer(float(row[which])) if isinstance(which, int) else which
