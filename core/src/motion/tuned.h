// SPDX-License-Identifier: BSD-3-Clause
// All numbers of the prover that are measured, not derived. Proofs hold for any of them; time and the share of undecided answers change.
//
// Time of edges with half of the number, and with twice as much, over time with it: geometric means (core/docs/lab/edges.md).
#ifndef LEEWAY_MOTION_TUNED_H
#define LEEWAY_MOTION_TUNED_H

/// Metres. A pair is first measured in windows in which its bodies deviate less from the lines between their poses.
#define LWI_MOST_DEVIATION 0.05

/// Metres. Nor is it in windows wider than quarters while its bodies' paths in half of one are longer than this together: most that these
/// prove, the gate's boxes have proved.
#define LWI_LONG_PATH 0.1

/// Metres. A piece of a curve that bends more is halved at once.
#define LWI_MOST_BEND 0.15

/// A run ends where the next window is a smaller share of the proved part.
#define LWI_LEAST_GAIN 0.01

/// Share of the slack with which proofs hold at least: it becomes lower_bound.
#define LWI_SLACK_SHARE 0.25

enum
{
	LWI_PROBE_BODIES =
		3, ///< near obstacles without a test of points, in a window of the gate, from which its middle is tested
	LWI_MOST_PROBES = 16,         ///< states of a look and of all probes, poses of the middle again among them
	LWI_PIECES_MOST_FAILURES = 5, ///< in a row: then one test in 2^5 of a pair tries planes of its pieces
	LWI_RUN_STATES = 8,           ///< for proved_until, at least; as many as for the verdict if those are more
	LWI_FIRST_STATES = 32         ///< the same while nothing is proved: an edge may begin within the slack, as grips do
};

#endif
