// SPDX-License-Identifier: BSD-3-Clause
// States of a group that satisfy constraints, found by damped least squares within bounds.
//
// Papers: Levenberg (1944) and Marquardt (1963) on damping; Sugihara, Solvability-unconcerned inverse kinematics by the
// Levenberg-Marquardt method (IEEE Transactions on Robotics 27, 2011), on damping by the squared error; Beeson and Ames,
// TRAC-IK (Humanoids 2015), on restarts and on tolerances.
#pragma once

#include "ik/chain.hpp"
#include "ik/constraint.hpp"

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
	/// [freedoms] of the chain; infinite: none. Turns of quaternions have none.
	Eigen::VectorXd lower, upper;
	/// [freedoms] starts of searches are drawn between these; both finite, within the bounds.
	Eigen::VectorXd draw_lower, draw_upper;
};

/// The largest excess of all constraints.
struct Excess
{
	double metres = 0, radians = 0;
	std::size_t position = 0, orientation = 0; ///< the constraints that have them
	/// Metres; a radian counts as much as `radian_length`.
	double sum() const;
};

/// Metres that count as much as a radian: about the distance of a hand from its wrist.
constexpr double radian_length = 0.2;
/// Metres and radians: a larger excess is a violation; smaller ones are rounding of the poses.
constexpr double excess_rounding = 1e-9;

class Solver
{
public:
	Solver( Chain& chain, BoundGoal& goal );

	/// Moves q by `share` of the way to a random state, uniform between the draw bounds. Quaternions move only if share
	/// is 1.
	/// @param q [variables]
	void draw( Random& random, double share, double* q ) const;
	/// Moves q into the bounds.
	void clamp( double* q ) const;
	/// Leads q to random targets inside of the tolerances, else to the nearest. @return true if no constraint is exceeded
	bool solve( Random& random, double* q );
	/// Of the constraints at q.
	Excess excess( const double* q );

private:
	bool descend( double* q, bool to_nearest );
	double evaluate( const double* q, bool to_nearest, bool jacobian );
	void step( double damping );
	void stepWithinBounds( const double* q, double damping );
	void move( const double* from, double* to ) const;

	Chain& m_chain;
	BoundGoal& m_goal;
	Eigen::VectorXd m_residual, m_residual_before, m_gradient, m_step;
	Eigen::MatrixXd m_jacobian, m_active, m_normal;
	Eigen::Matrix3Xd m_linear, m_angular;
	std::vector<double> m_try;
	std::vector<bool> m_fixed; ///< freedoms that stay at their bound during a step
	std::size_t m_variables;
};

} // namespace leeway::ik
