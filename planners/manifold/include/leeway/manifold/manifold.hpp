// SPDX-License-Identifier: BSD-3-Clause
// The states that keep a request's constraints along the path: how far a state is from them, and the nearest way there.
//
// Each constraint is a few *rows*: a coordinate of a pose and the range that it may have. A row is *thin* if its range is below 4 cm or 0.04
// radians: it is led to the middle of its range. Others are led to the inner nine tenths.
#pragma once

#include "leeway/motions/path_constraints.hpp"

#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace leeway::manifold
{

class Manifold
{
public:
	/// @param robot the model that `problem` was built from
	/// @param problem has to outlive it
	/// @throws io::Error (BoundConstraints; a floating joint in the group; a joint constraint outside of the joint's limits)
	Manifold( const io::RobotModel& robot, const io::Problem& problem, const io::PathConstraints& path );
	~Manifold();

	std::size_t variables() const; ///< of a group state
	/// Joint limits within the joint constraints, [variables()]; infinite: none. For joints that wrap in the turn that is nearest to the start.
	const double* lower() const;
	const double* upper() const;
	const motions::BoundConstraints& constraints() const;

	/// Moves a state to one that keeps all constraints with room: damped Newton steps within the joint limits.
	/// @param q [variables()]
	/// @param most metres and radians, of each row's error then; a thousandth of half the row's range if that is less
	/// @return false if that does not succeed
	bool project( double* q, double most = HUGE_VAL );
	/// The part of a direction along which the constraints stay kept: without changes of thin rows, nor of others that would leave their range.
	/// @param q, direction [variables()]
	void makeTangent( const double* q, double* direction );
	/// Constraints that a state breaks, or touches up to rounding: a line for each, with the amount. Empty: it keeps all.
	std::vector<std::string> violations( const double* q );
	/// Are all poses within their ranges? Of rows alone, without joints. @param q [variables()]
	bool isInRange( const double* q );

	/// Number of rows.
	std::size_t rows() const;
	/// Number of thin rows.
	std::size_t thinRows() const;
	/// Errors of rows and their derivatives: of thin rows from the middle; of others beyond the inner range, with derivatives of 0 within. Metres
	/// and radians. @param q [variables()] @param values [rows()], may be null @param jacobian [rows()][variables()], may be null
	void errors( const double* q, double* values, double* jacobian );

private:
	struct Parts;
	std::unique_ptr<Parts> m_parts;
};

} // namespace leeway::manifold
