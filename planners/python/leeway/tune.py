# SPDX-License-Identifier: BSD-3-Clause
"""Speed against accuracy in a scene of one's own: measures settings of checks, and proposes one for states and one for edges.

    found = leeway.tune.tune( checker, min_d=0.005, max_d=0.3, error=0.001 )
    print( found )
    checker.clearance( q, min_d=found.states.min_d, max_d=found.states.max_d, alpha=found.states.alpha )

Every setting that it proposes keeps its proofs; it gives up accuracy that is stated in metres. Settings, samples and choice are those of
the program `leeway tune`, by the same library.
"""
from __future__ import annotations

from typing import Any, NamedTuple

from . import _core
from ._core import Checker, whole_number

__all__ = ["Setting", "Tuned", "tune"]

MOST_COUNT = 2**31 - 1


class Setting(NamedTuple):
    """Arguments of a check, with their cost and accuracy. Units: metres, microseconds."""
    kind: str  #: "states" for Checker.clearance(); "edges", proofs, or "steps", for Checker.edges()
    min_d: float
    max_d: float  #: states: beyond it no distance; infinite for edges
    alpha: float
    slack: float  #: edges
    step: float | None  #: steps
    promised: float  #: states: clearance may be reported too small by this; edges: free ones may be refused up to this above min_d
    worst: float  #: of that, seen
    mean: float  #: of that, seen; edges: over those refused
    free: int  #: called free
    missed: int  #: called free and are not: only without proof
    proof: bool
    work: float  #: counted, for a state or an edge: equal seeds give equal work
    microseconds: float  #: `work` at the rate of this machine
    measured: float  #: microseconds of processor time, this run
    front: bool  #: no other is as cheap and as accurate

    def __repr__(self) -> str:
        words = {"states": f"max_d={self.max_d:.6g}, alpha={self.alpha:.6g}", "edges": f"slack={self.slack:.6g}, alpha={self.alpha:.6g}",
            "steps": f"step={self.step}"}
        return (f"Setting({self.kind}: min_d={self.min_d:.6g}, {words[self.kind]}; {self.microseconds:.3g} us, promises {1e3 * self.promised:.4g} mm, "
                f"saw {1e3 * self.worst:.4g} mm{'' if self.proof else ', no proof'})")


class Tuned(NamedTuple):
    """Measured settings, and the proposed ones."""
    settings: list[Setting]
    states: Setting | None
    edges: Setting | None
    met: bool  #: the target
    report: dict[str, Any]  #: as `leeway tune --json` writes it

    def __repr__(self) -> str:
        lines = [f"Tuned({len(self.settings)} settings, target {'met' if self.met else 'NOT met'}"]
        return ";\n  ".join(lines + [f"proposed {s!r}" for s in (self.states, self.edges) if s is not None]) + ")"


def _setting(row: dict[str, Any] | None) -> Setting | None:
    if row is None:
        return None
    kind = {"steps": "steps", "certified": "edges"}.get(row["validator"], "states")
    return Setting(kind, row["min_d"], row["max_d"] if kind == "states" else float("inf"), row["alpha"], row["slack"] or 0.0,
        row["max_d"] if kind == "steps" else None, row["promised"], row["worst"], row["mean"], row["free"], row["missed"], row["proof"],
        row["work"], row["time_us"], row["measured_us"], row["front"])


def tune(checker: Checker, *, min_d: float = 0.0, max_d: float = 0.5, check: str = "both", states: int = 400, edges: int = 100, seed: int = 1,
         error: float | None = None, conservatism: float | None = None, microseconds: float | None = None, rate: float = 0.0) -> Tuned:
    """Measures settings on random states and edges of a checker, one thread, and proposes the cheapest that meet the target.

    min_d, max_d: metres, the range of clearances to tell apart. At most one target: error: metres of a state's clearance; conservatism:
    metres above min_d up to which free edges may be refused; microseconds: for a state, then the most accurate setting. Without a
    target: a hundredth of max_d for states and 1.1 mm for edges. rate: microseconds per unit of counted work, 0 = measured; with a rate
    given equal seeds give equal proposals. A proposal keeps its proofs and calls at least nine tenths of the free states (edges) free.
    Raises ValueError if no random state is free.
    """
    if not 0 <= min_d < max_d < float("inf"):
        raise ValueError("tune: 0 <= min_d < max_d < inf does not hold; give the range of clearances to tell apart")
    targets = {"error": error, "conservatism": conservatism, "microseconds": microseconds}
    given = [(name, value) for name, value in targets.items() if value is not None]
    if len(given) > 1:
        raise ValueError("tune: give one of error, conservatism, microseconds")
    states, edges = whole_number("states", states, 1, MOST_COUNT), whole_number("edges", edges, 1, MOST_COUNT)
    seed = whole_number("seed", seed)
    if any(not value > 0 for _, value in given) or not 0 <= rate < float("inf"):
        raise ValueError("tune: targets are above 0, and rate is 0 or more")
    name, value = given[0] if given else ("", 0.0)
    report = _core._tune(checker, min_d, max_d, check, states, edges, seed, name, value, rate)
    proposal = report["proposal"]
    return Tuned([_setting(row) for row in report["settings"]], _setting(proposal["state"]), _setting(proposal["motion"]),
        report["target"]["met"], report)
