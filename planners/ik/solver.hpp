// SPDX-License-Identifier: BSD-3-Clause
// States of a group that satisfy constraints, found by damped least squares within bounds.
//
// Paper: Beeson and Ames, TRAC-IK (Humanoids 2015), on restarts and on tolerances.
#pragma once

#include "ik/constraint.hpp"
#include "ik/descent.hpp"

#include <vector>

namespace leeway::ik
{

/// Constraints bound to the frames of a chain, and the bounds of its freedoms.
struct BoundGoal
{
	template <typename Constraint> struct Bound
	{
		Constraint constraint;
		ChainFrame link, frame;
	};
	std::vector<Bound<PositionConstraint>> positions;
	std::vector<Bound<OrientationConstraint>> orientations;
	Bounds bounds;
	Bounds draw; ///< starts of searches are drawn between these; finite, within the bounds
};

/// The largest excess of all constraints.
struct Excess
{
	double metres = 0, radians = 0;
	std::size_t position = 0, orientation = 0; ///< the constraints that have them
	/// Metres; a radian counts as much as `radian_length`.
	double sum() const;
};

/// Metres and radians: a larger excess is a violation; smaller ones are rounding of the poses.
constexpr double excess_rounding = 1e-9;

/// Moves q by `share` of the way to a random state, uniform between the draw bounds. Quaternions move only if share is 1.
/// @param moving [freedoms] quaternions that may move @param q [variables]
void draw( const std::vector<Freedom>& freedoms, const std::vector<bool>& moving, const Bounds& between, Random& random,
    double share, double* q );

class Solver : private Errors
{
public:
	Solver( Chain& chain, BoundGoal& goal );

	/// Leads q to random targets inside of the tolerances, else to the nearest. @return true if no constraint is exceeded
	bool solve( Random& random, double* q );
	/// Of the constraints at q.
	Excess excess( const double* q );

private:
	bool descend( double* q, bool to_nearest );
	void evaluate( const double* q, Eigen::VectorXd& residual, Eigen::MatrixXd& jacobian ) override;

	Chain& m_chain;
	BoundGoal& m_goal;
	Descent m_descent;
	bool m_to_nearest = false;
	Twists m_twists;
};

} // namespace leeway::ik
