// SPDX-License-Identifier: BSD-3-Clause
// MoveIt's constraints along a path, proved of a trajectory for all times (leeway/constraint.h).
#pragma once

#include "leeway/constraint.h"
#include "leeway/handles.hpp"
#include "leeway/io/path_constraints.hpp"
#include "leeway/motions/trajectory.hpp"

#include <string>
#include <vector>

namespace leeway::motions
{

/// The answer about one constraint.
struct ConstraintProof
{
	std::string element; ///< of the request
	lw_verdict verdict =
	    LW_VERDICT_FREE; ///< FREE: kept at all times, by all motions within the tolerance; BLOCKED: broken at `time`
	double time = 0;     ///< seconds, unless FREE
	std::string error;   ///< that decides, such as "tilt" or "joint elbow"
	double value = 0, excess = 0; ///< of it at `time`: metres or radians, and beyond its limit
};

/// A position or orientation constraint as a region of the core.
struct PoseConstraint
{
	std::string element; ///< of the request
	lw_region_def def;
	RegionHandle region; ///< empty: the constraint limits nothing
};

/// A joint constraint.
struct JointRange
{
	std::string element, joint;
	bool moves = false;                      ///< with the group
	std::size_t entry = 0;                   ///< of a group state, if it moves
	double stands = 0;                       ///< its value, if it does not
	bool wraps = false;                      ///< then whole turns away it is as good
	double middle = 0, below = 0, above = 0; ///< radians or metres
	/// Radians to be added to `middle` for the range that is nearest to a value.
	double turnsAt( double value ) const;
};

/// Constraints of a request, looked up in a problem once for many proofs. One thread at a time uses it: regions have a memory.
class BoundConstraints
{
public:
	/// @param problem has to outlive it
	/// @throws io::Error for a constraint that no proof knows: regions that are not one box, tolerances that leave no room, names that are not there
	BoundConstraints( const io::Problem& problem, const io::PathConstraints& path );

	/// Proves each constraint on its own: joints, positions, orientations.
	/// @param tolerance [group variables] of the controller; empty: none
	std::vector<ConstraintProof> prove( const std::vector<Segment>& segments, const std::vector<double>& tolerance ) const;

	/// True if all are proved of one segment.
	bool areKept( const Segment& segment ) const;

	const std::vector<PoseConstraint>& poses() const { return m_poses; } ///< positions, then orientations
	const std::vector<JointRange>& joints() const { return m_joints; }

private:
	const io::Problem* m_problem;
	std::vector<PoseConstraint> m_poses;
	std::vector<JointRange> m_joints;
};

/// BoundConstraints::prove() of constraints that are looked up for it.
/// @throws io::Error as BoundConstraints
std::vector<ConstraintProof> proveConstraints( const io::Problem& problem, const io::PathConstraints& path,
    const std::vector<Segment>& segments, const std::vector<double>& tolerance );

/// True if all are FREE.
bool areKept( const std::vector<ConstraintProof>& proofs );

/// A line for people.
std::string describe( const ConstraintProof& proof );
std::string describe( const std::vector<ConstraintProof>& proofs );

} // namespace leeway::motions
