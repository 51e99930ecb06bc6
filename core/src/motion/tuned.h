// SPDX-License-Identifier: BSD-3-Clause
// Numbers of the prover that are measured, not derived. Proofs hold for any of them; their time and their number change.
//
// Time of free edges with half of it, and with twice as much, over time with it, geometric means over 8 to 15 robots
// (core/docs/lab/edges.md):
//
//	number                    half   double
//	LWI_MOST_LINEAR_BULGE     1.02   1.00
//	LWI_MOST_BULGE            0.99   1.00
//	LWI_LEAST_CHANGE          1.01   1.03   (blocked: 1.15)
//	LWI_PROBE_WORK            1.01   1.00   (blocked: 0.99, 1.02; measured in cells)
//	LWI_PIECES_MOST_FAILURES  1.00   1.01   (2 and 7)
//	LWI_MOST_BEND             0.99   1.00   (0.08 m and 0.2 m, curves)
//
// The others are not measured: they set how long a run goes on, and how much of the slack a proof keeps.
#ifndef LEEWAY_MOTION_TUNED_H
#define LEEWAY_MOTION_TUNED_H

/// Metres. Where paths bend more, poses at the window's ends bound them better than the velocity in the middle.
#define LWI_MOST_LINEAR_BULGE 0.004

/// Metres. A body that bulges more between its poses has no plane near obstacles: halving the window is cheaper.
#define LWI_MOST_BULGE 0.05

/// Metres per squared unit of t. Straighter edges begin with one window, others with eight.
#define LWI_LEAST_CHANGE 2.5

/// Metres. A piece of a curve that bends more is halved at once.
#define LWI_MOST_BEND 0.15

/// A run ends where the next window is a smaller share of the proved part.
#define LWI_LEAST_GAIN 0.01

/// Share of the slack with which proofs hold at least: it becomes lower_bound.
#define LWI_SLACK_SHARE 0.25

enum
{
	LWI_PROBE_WORK = 8,           ///< open cells from which whole states are probed
	LWI_PIECES_MOST_FAILURES = 5, ///< in a row: then one test in 2^5 of a pair looks at its pieces
	LWI_RUN_STATES = 8,           ///< for proved_until, at least; as many as for the verdict if those are more
	LWI_FIRST_STATES = 32         ///< the same while nothing is proved: an edge may begin within the slack, as grips do
};

#endif
