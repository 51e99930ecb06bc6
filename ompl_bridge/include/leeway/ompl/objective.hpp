// SPDX-License-Identifier: BSD-3-Clause
// An optimisation objective: keep as far away as possible, judged along the whole of each motion.
//
//     auto engine = leeway::ompl::install( si, checker );
//     problem->setOptimizationObjective( std::make_shared<leeway::ompl::ClearanceObjective>( si, engine ) );
#pragma once

#include "leeway/ompl/validity.hpp"

#include <ompl/base/objectives/MinimaxObjective.h>

namespace leeway::ompl
{

/// Maximises the least clearance along a path. OMPL's MaximizeMinClearanceObjective looks at samples of a motion, at the
/// space's resolution; here a motion's cost is proved for all of it.
///
/// Costs are metres above Options::min_d, bigger is better, as in StateValidityChecker::clearance(): 0 for motions that are
/// not proved valid, at most max_d - min_d. Let D be the least clearance along a motion, capped at max_d. The cost c of the
/// motion, both ends included, satisfies:
///
///     min_d + c <= D,  and  min_d + c >= D / (1 + tolerance)  if  D > (1 + tolerance) (min_d + slack).
///
/// Below that band the cost only tells whether the motion is proved valid. Equal for both directions (to rounding).
///
/// Method: the clearances of the ends bound D from above. lw_checker_edge() tries to prove the motion FREE at a margin just
/// below that bound. If it fails, the clearance at the place of the failure is a better bound; after two failures the
/// margin is the geometric mean of the proved margin and the bound.
///
/// Cost: 2 states and usually 1 to 4 certified edge checks, with one state for each failed check; never more than
/// 8 + log2( log( max_d / (min_d + slack) ) / log( 1 + tolerance ) ) checks, 14 for the defaults. Each is slower than a
/// validity check: near the minimum its steps are about tolerance * D long. A low max_d makes all of them faster. Planners
/// compute the costs of all neighbours of a state, also of motions that turn out to be blocked.
///
/// Plateaus: all clearances beyond max_d have equal cost. Planners continue until their time is over unless the objective is
/// satisfied: by default only at the cap, above which costs do not differ; see setCostThreshold().
///
/// Const members may be called by any number of threads at once.
class ClearanceObjective : public ::ompl::base::MinimaxObjective
{
public:
	/// @param si its space must be the object that the engine was made with
	/// @param tolerance relative, (0, 1]
	/// @throws std::invalid_argument if si has another space, if the space's curves are not straight edges
	/// (StateAdapter::straight()), or if the tolerance is out of its domain
	ClearanceObjective(
	    const ::ompl::base::SpaceInformationPtr& si, std::shared_ptr<const Engine> engine, double tolerance = 0.1 );

	/// StateValidityChecker::clearance(), unrounded.
	::ompl::base::Cost stateCost( const ::ompl::base::State* state ) const override;
	/// Always certified, whatever Options::method is.
	::ompl::base::Cost motionCost( const ::ompl::base::State* s1, const ::ompl::base::State* s2 ) const override;
	bool isCostBetterThan( ::ompl::base::Cost c1, ::ompl::base::Cost c2 ) const override; ///< more is better
	bool isSymmetric() const override;
	::ompl::base::Cost identityCost() const override; ///< +inf: cost of an empty motion, and upper bound of any
	::ompl::base::Cost infiniteCost() const override; ///< -inf: worse than any

	double tolerance() const { return m_tolerance; }
	const std::shared_ptr<const Engine>& engine() const { return m_engine; }

private:
	std::shared_ptr<const Engine> m_engine;
	StateValidityChecker m_states;
	double m_tolerance;
};

} // namespace leeway::ompl
