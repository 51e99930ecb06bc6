// SPDX-License-Identifier: BSD-3-Clause
// Convex regions of joint space that others call free of collisions, such as Drake's IRIS regions: a colliding state in one, or its proved part.
#pragma once

#include "referee/contact.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace leeway::referee
{

/// All q with A q <= b.
struct Region
{
	std::string name, file, element;
	std::vector<std::string> joint_names; ///< of the columns; empty: the group's variables
	std::vector<std::vector<double>> a;   ///< [rows][columns]
	std::vector<double> b;                ///< [rows]
};

struct RegionSettings
{
	double min_d = 0;
	lw_check_flags flags = LW_CHECK_BOTH;
	double search_seconds = 1; ///< for a colliding state
	double proof_seconds = 1;  ///< for proofs, if there is none
	std::uint32_t seed = 1;
};

struct RegionVerdict
{
	/// BLOCKED: q is in the region and collides. FREE: all of the region within the joint limits is proved. UNDECIDED: neither.
	lw_verdict verdict = LW_VERDICT_UNKNOWN;
	std::vector<double> q;     ///< BLOCKED: group state
	std::vector<double> worst; ///< BLOCKED: the deepest state found from there on
	Depth depth;               ///< of it
	motions::Named pair;       ///< of it
	bool self = false;         ///< of the pair
	double proved = 0;         ///< share of random states of the region that are in proved boxes
	std::size_t boxes = 0;     ///< that are proved
	std::size_t states = 0;    ///< that were measured
	std::size_t descents = 0;  ///< of the clearance, from random states
	double seconds = 0;
};

/// Searches for a colliding state: random states of the region (hit and run: Smith, Operations Research 32(6), 1984), from each the clearance is
/// lessened along its derivative, along faces of the region where it meets them. Then boxes of the region are proved by the motion bounds of a
/// resting robot with tolerances, each that cannot be is halved. The region is that part of A q <= b which is within the joint limits.
/// @throws io::Error for columns that are not the group's, numbers that are not finite, and for a region without an inner state
RegionVerdict judgeRegion( const io::Problem& problem, const Region& region, const RegionSettings& settings );

} // namespace leeway::referee
