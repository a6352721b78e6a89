# SPDX-License-Identifier: MIT
"""The load history as a list of states, each with its force, its place and the sign of its traction.

Equal steps to the peak, along the path of a travelling load if there is one, then to zero. In full slip the
traction on the body is q = coefficient * p along x, at every step; its sign may change from cycle to cycle.
"""

from __future__ import annotations

from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Load:
    """What acts on the body.

    Parameters
    ----------
    force
        Normal, in N.
    sign
        Of the traction along x.
    x, y
        Where it is centred in m, see `sam.grid.gap.InitialGap`.
    """

    force: float
    sign: float = 1.0
    x: float = 0.0
    y: float = 0.0

    def halfway_to(self, other: Load) -> Load:
        """The load half the way to another one, with its sign; without force there is no place to leave."""
        x, y = (self.x, self.y) if self.force else (other.x, other.y)
        return Load((self.force + other.force) / 2, other.sign, (x + other.x) / 2, (y + other.y) / 2)


UNLOADED = Load(0.0)


@dataclass(frozen=True)
class Target:
    """The end of a load step. cycle, step: as in the history.

    snapshot: the state to be recorded there ("peak", "unloaded" or none); elastic_unloading: in a
    single step, if that strains nothing; note: for the history.
    """

    cycle: int
    step: int
    load: Load
    rises: bool
    snapshot: str = ""
    elastic_unloading: bool = False
    note: str = ""


@dataclass(frozen=True)
class Schedule:
    """All load steps of a scene, unloading in one.

    peak_force: in N; unload_steps: equal steps in which a body is unloaded that yields in it; path: places of
    the load after each step at full size, the start first, in m; alternates: whether the traction changes its
    sign from cycle to cycle.
    """

    targets: tuple[Target, ...]
    peak_force: float
    unload_steps: int
    path: tuple[tuple[float, float], ...] = ((0.0, 0.0),)
    cycles: int = 1
    alternates: bool = False

    def sign_of(self, cycle: int) -> float:
        """Sign of the traction along x in a cycle (from 1)."""
        return -1.0 if self.alternates and cycle % 2 == 0 else 1.0

    @property
    def last_cycle(self) -> list[Target]:
        """The steps of the last cycle, which has the states that are recorded."""
        return [target for target in self.targets if target.cycle == self.cycles]

    @property
    def rises(self) -> int:
        """Steps of a cycle to the peak, those along a path included."""
        return sum(target.rises for target in self.last_cycle)

    @property
    def unloads(self) -> bool:
        """Whether the history ends unloaded."""
        return not self.targets[-1].rises

    def in_steps(self, target: Target) -> list[Target]:
        """Unloading in equal steps, in place of the target that does it in a single one."""
        count, peak = self.unload_steps, self.peak_force
        forces = [peak * (1 - k / count) if k < count else 0.0 for k in range(1, count + 1)]
        steps = [
            Target(target.cycle, target.step + k, replace(target.load, force=force), False)
            for k, force in enumerate(forces)
        ]
        return [*steps[:-1], replace(steps[-1], snapshot=target.snapshot)]
