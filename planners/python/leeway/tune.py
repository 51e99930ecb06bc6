# SPDX-License-Identifier: BSD-3-Clause
"""Speed against accuracy in a scene of one's own: measures settings of checks, and proposes one for states and one for edges.

    found = leeway.tune.tune( checker, min_d=0.005, max_d=0.3, error=0.001 )
    print( found )
    checker.clearance( q, min_d=found.states.min_d, max_d=found.states.max_d, alpha=found.states.alpha )

Every setting that it proposes keeps its proofs; it gives up accuracy that is stated in metres. The program `leeway tune` does the same
with counted work in place of time, and with more settings of edges.
"""
from __future__ import annotations

import time
from typing import NamedTuple

import numpy

from ._core import Checker, whole_number

__all__ = ["Setting", "Tuned", "tune"]

ALPHA = 0.1  # relative tolerance of distances within Checker.edges()
ROUNDING = 1e-9  # metres, granted to every promise
MOST_COUNT = 2**31 - 1
KEPT = 0.9  # a proposed setting calls at least this share of the free states or edges free
CLOSE = 1.05  # times so close are the same: for less nothing is given up


class Setting(NamedTuple):
    """Arguments of a check, with their cost and accuracy. Units: metres, microseconds."""
    kind: str  #: "states" for Checker.clearance(); "edges", proofs, or "steps", for Checker.edges()
    min_d: float
    max_d: float = float("inf")
    alpha: float = 0.0
    slack: float = 0.0
    step: float | None = None
    promised: float = 0.0  #: states: clearance may be reported too small by this; edges: free ones may be refused up to this above min_d
    worst: float = 0.0  #: of that, seen
    free: int = 0  #: called free
    missed: int = 0  #: called free and are not: only without proof
    proof: bool = True
    microseconds: float = 0.0  #: of processor time, for a state or an edge
    front: bool = False  #: no other is as cheap and as accurate

    def __repr__(self) -> str:
        words = {"states": f"max_d={self.max_d:.6g}, alpha={self.alpha:.6g}", "edges": f"slack={self.slack:.6g}", "steps": f"step={self.step}"}
        return (f"Setting({self.kind}: min_d={self.min_d:.6g}, {words[self.kind]}; {self.microseconds:.3g} us, promises {1e3 * self.promised:.4g} mm, "
                f"saw {1e3 * self.worst:.4g} mm{'' if self.proof else ', no proof'})")


class Tuned(NamedTuple):
    """Measured settings, and the proposed ones."""
    settings: list[Setting]
    states: Setting | None
    edges: Setting | None
    met: bool  #: the target

    def __repr__(self) -> str:
        lines = [f"Tuned({len(self.settings)} settings, target {'met' if self.met else 'NOT met'}"]
        return ";\n  ".join(lines + [f"proposed {s!r}" for s in (self.states, self.edges) if s is not None]) + ")"


class _Samples(NamedTuple):
    states: numpy.ndarray  # [n, dof]
    clearance: numpy.ndarray  # [n]: true
    ends: tuple[numpy.ndarray, numpy.ndarray]  # of edges, the first free
    low: numpy.ndarray  # [m]: proved, the edge keeps more than this; -inf if it is not free


def _draw(checker: Checker, min_d: float, check: str, levels: list[float], states: int, edges: int, seed: int) -> _Samples:
    """States half anywhere and half on edges; edges from free states, as long as those of planners."""
    if not (numpy.isfinite(checker.lower).all() and numpy.isfinite(checker.upper).all()):
        raise ValueError(f"tune: a variable of {checker.variables} has no limits; give the URDF limits for it")
    rng = numpy.random.default_rng(seed)
    def anywhere(n: int) -> numpy.ndarray:
        return rng.uniform(checker.lower, checker.upper, (n, checker.dof))

    free = numpy.empty((0, checker.dof))
    for _ in range(100):
        q = anywhere(200)
        free = numpy.concatenate([free, q[checker.is_free(q, min_d=min_d, check=check)]])
        if len(free) >= edges:
            break
    if not len(free):
        raise ValueError(f"tune: none of 20000 random states has a clearance above {min_d} m; lower min_d, or look at the scene")
    a = free[numpy.arange(edges) % len(free)]
    toward = anywhere(edges) - a
    longest = 0.2 * numpy.linalg.norm(checker.upper - checker.lower)
    b = a + toward * numpy.minimum(1, longest * rng.uniform(size=(edges, 1)) / numpy.linalg.norm(toward, axis=1)[:, None])
    on = rng.integers(edges, size=states // 2)
    q = numpy.concatenate([anywhere(states - len(on)), a[on] + rng.uniform(size=(len(on), 1)) * (b[on] - a[on])])
    low = numpy.full(edges, -numpy.inf)
    for level in [0.0, *levels]:
        low[checker.edges(a, b, min_d=min_d + level, slack=2e-5, check=check).free] = level
    return _Samples(q, checker.clearance(q, check=check, witnesses=False).upper, (a, b), low)


def _state_grid(min_d: float, max_d: float, extra: list[float]) -> list[Setting]:
    rows = [Setting("states", min_d, max_d)]
    for error in sorted({0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, *extra}):
        for margin in sorted({0.0, error}):
            for nearer in (0.0, error):
                for coarse in (0.0, error / (max_d - nearer)):
                    row = Setting("states", min_d + margin, max_d - nearer, coarse, promised=error)
                    if (margin or nearer or coarse) and row.min_d < row.max_d and coarse < 1 and error < max_d - min_d:
                        rows.append(row)
    return rows


def _edge_grid(min_d: float, levels: list[float], self_pairs: bool) -> list[Setting]:
    rows = []
    for c in levels:
        for margin in {0.0, c / 2}:
            slack = (1 - ALPHA) * (min_d + c) - min_d - margin
            if slack > 1e-3 * c:
                rows.append(Setting("edges", min_d + margin, slack=slack, promised=c))
        step = c if self_pairs else 2 * c
        if step >= 1e-3:
            rows.append(Setting("steps", min_d + c, step=step, promised=c))
            rows.append(Setting("steps", min_d, step=step, proof=False))
    return rows


def _timed(ask, count: int, passes: int) -> tuple:
    best = float("inf")
    for _ in range(passes):
        begin = time.thread_time()
        found = ask()
        best = min(best, time.thread_time() - begin)
    return found, 1e6 * best / count


def _measure_states(checker: Checker, row: Setting, asked: Setting, check: str, samples: _Samples, passes: int) -> Setting:
    found, cost = _timed(lambda: checker.clearance(samples.states, min_d=row.min_d, max_d=row.max_d, alpha=row.alpha, check=check,
        witnesses=False), len(samples.states), passes)
    reported = numpy.where(found.lower <= row.min_d, asked.min_d, numpy.minimum(found.lower, row.max_d))
    short = numpy.clip(samples.clearance, asked.min_d, asked.max_d) - numpy.clip(reported, asked.min_d, asked.max_d)
    if short.max() > row.promised + ROUNDING or short.min() < -ROUNDING:
        raise RuntimeError(f"tune: {row!r} breaks its promise by {short.max()} m; please report this scene")
    return row._replace(worst=float(max(0.0, short.max())), free=int((found.lower > row.min_d).sum()), microseconds=cost)


def _measure_edges(checker: Checker, row: Setting, check: str, samples: _Samples, passes: int) -> Setting:
    a, b = samples.ends
    found, cost = _timed(lambda: checker.edges(a, b, min_d=row.min_d, slack=row.slack, step=row.step, check=check), len(a), passes)
    refused = samples.low[~found.free]
    worst = float(max(0.0, refused.max(initial=0.0)))
    missed = int((found.free & (samples.low < 0)).sum()) if not row.proof else 0
    if row.proof and worst > row.promised + ROUNDING:
        raise RuntimeError(f"tune: {row!r} refused an edge with {worst} m to spare; please report this scene")
    return row._replace(worst=worst, free=int(found.free.sum()), missed=missed, microseconds=cost)


def _with_front(rows: list[Setting]) -> list[Setting]:
    def beats(a: Setting, b: Setting) -> bool:
        good = a.microseconds <= b.microseconds and a.promised <= b.promised and a.proof >= b.proof and a.free >= b.free
        return good and a != b

    def kind(row: Setting) -> bool:
        return row.kind == "states"

    return [row._replace(front=not any(kind(o) == kind(row) and beats(o, row) for o in rows)) for row in rows]


def _cheapest(rows: list[Setting], most: float) -> Setting | None:
    """The cheapest that promises at most this; of those nearly as cheap the most accurate."""
    passing = [row for row in rows if row.promised <= most]
    if not passing:
        return None
    least = min(row.microseconds for row in passing)
    return min((row for row in passing if row.microseconds <= CLOSE * least), key=lambda row: (row.promised, row.microseconds))


def tune(checker: Checker, *, min_d: float = 0.0, max_d: float = 0.5, check: str = "both", states: int = 400, edges: int = 100, seed: int = 1,
         error: float | None = None, conservatism: float | None = None, microseconds: float | None = None, passes: int = 3) -> Tuned:
    """Measures settings on random states and edges of a checker, one thread, and proposes the cheapest that meet the target.

    min_d, max_d: metres, the range of clearances to tell apart. At most one target: error: metres of a state's clearance; conservatism:
    metres above min_d up to which free edges may be refused; microseconds: of processor time for a state, then the most accurate
    setting. Without a target: a hundredth of max_d for states and 1.1 mm for edges. A proposal keeps its proofs and calls at least nine
    tenths of the free states (edges) free. Raises ValueError if no random state is free.
    """
    if not 0 <= min_d < max_d < float("inf"):
        raise ValueError("tune: 0 <= min_d < max_d < inf does not hold; give the range of clearances to tell apart")
    if sum(target is not None for target in (error, conservatism, microseconds)) > 1:
        raise ValueError("tune: give one of error, conservatism, microseconds")
    states, edges = whole_number("states", states, 2, MOST_COUNT), whole_number("edges", edges, 1, MOST_COUNT)
    seed, passes = whole_number("seed", seed), whole_number("passes", passes, 1, MOST_COUNT)
    usual = {"states": 0.01 * max_d if error is None else error, "edges": 0.0011 if conservatism is None else conservatism}
    levels = sorted({0.0002, 0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, usual["edges"]})
    samples = _draw(checker, min_d, check, levels, states, edges, seed)
    grid = _state_grid(min_d, max_d, [usual["states"]])
    rows = [_measure_states(checker, row, grid[0], check, samples, passes) for row in grid]
    rows += [_measure_edges(checker, row, check, samples, passes) for row in _edge_grid(min_d, levels, check != "environment")]
    rows = _with_front(rows)
    free = {"states": int((samples.clearance > min_d).sum()), "edges": int((samples.low >= 0).sum())}
    good = {kind: [row for row in rows if row.proof and (row.kind == "states") == (kind == "states") and row.free >= KEPT * free[kind]]
        for kind in free}
    if microseconds is not None:
        fast = [row for row in good["states"] if row.microseconds <= microseconds]
        of_states = min(fast, key=lambda row: (row.promised, row.microseconds)) if fast else min(good["states"], key=lambda row: row.microseconds)
        met = bool(fast)
    else:
        of_states = _cheapest(good["states"], usual["states"])
        met = of_states is not None
    of_edges = _cheapest(good["edges"], usual["edges"])
    met = met and (conservatism is None or of_edges is not None)
    if of_edges is None and good["edges"]:
        of_edges = min(good["edges"], key=lambda row: (row.promised, row.microseconds))
    return Tuned(rows, of_states, of_edges, met)
