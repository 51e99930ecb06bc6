// SPDX-License-Identifier: BSD-3-Clause
// Roundings of a path's corners, proved: time parametrisation drives an arc or a blend where a planner left a corner.
#pragma once

#include "leeway/leeway.h"
#include "leeway/motions/states.hpp"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace leeway::motions
{

/// Verdict on a path and all of its roundings.
struct RoundingProof
{
	lw_verdict verdict = LW_VERDICT_UNKNOWN;
	double lower_bound = 0; ///< FREE: metres, proved, of all clearances on the path and its roundings; else 0
	/// Not FREE: the first place that failed, the rounding of points[corner] or, with `on_edge`, the edge that leads there.
	std::size_t corner = 0;
	bool on_edge = false;
	std::vector<double>
	    q; ///< BLOCKED: a state of the path or of a rounding, in collision; UNDECIDED: one near which the proof ended
	bool self = false;                          ///< of the pair below
	lw_clearance pair = lw_clearance_unknown(); ///< of q; UNDECIDED: near q
	double free_radius =
	    0; ///< not FREE at a corner: largest radius found by bisection whose roundings of this corner are FREE
	std::size_t corners = 0;
	std::uint64_t queries = 0;
};

/// Proves the straight path through `points`, and every curve that follows it except around corners, where it
///   - leaves one edge and joins the next at most l from the corner, l = min( L1 / 2, L2 / 2, 2 radius / sin( angle / 2 ) ),
///   - bends to one side in between, in the plane of both edges,
///   - and passes the corner's bisector at most min( radius, l tan( angle / 4 ) ) from the corner.
/// L1, L2 are the lengths of the two edges, `angle` is between their directions, all Euclidean in the group's variables. Among
/// them are the circular arcs of Kunz and Stilman's time parametrisation (TOTG) and parabolas that stay as near to the corner.
/// Proof: core/docs/motions.md.
/// @param points group states; angles are plain numbers. Quaternions must not change
/// @param radius radians or metres, > 0: distance of a corner from its rounding (MoveIt's path_tolerance)
/// @param def min_d, slack, tolerance and flags: FREE holds for all motions within the tolerance of a rounding
/// @return LW_OK, or the status of lw_checker_curve()
lw_status proveRoundings( const lw_checker* checker, lw_query* query, const std::vector<std::vector<double>>& points,
    double radius, const lw_edge_def& def, RoundingProof& out );

/// A proof of roundings with names.
struct RoundingAudit
{
	double radius = 0, seconds = 0, min_d = 0;
	RoundingProof proof;
	std::vector<std::string> names; ///< of the variables of proof.q
	Named pair;                     ///< of a state that is not free, measured there
	bool valid() const { return proof.verdict == LW_VERDICT_FREE; }
};

/// Proves a path and its roundings; continuous joints take the shorter way from point to point.
/// @param points group states, at least one @param radius, def as for proveRoundings() @param file of the path, for errors
/// @throws io::Error if the group has a floating joint, CoreError
RoundingAudit auditRoundings( const io::Problem& problem, const std::vector<std::vector<double>>& points, double radius,
    const lw_edge_def& def, const std::string& file );
/// Lines for people.
std::string describe( const RoundingAudit& audit );

} // namespace leeway::motions
