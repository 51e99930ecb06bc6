// SPDX-License-Identifier: BSD-3-Clause
// Valid samples for planners: states in obstacles or near them are moved out.
//
//     auto engine = leeway::ompl::install( si, checker );
//     si->setValidStateSamplerAllocator( leeway::ompl::pushingSamplers( engine ) );
#pragma once

#include "leeway/ompl/validity.hpp"

#include <ompl/base/ValidStateSampler.h>

#include <vector>

namespace leeway::ompl
{

struct PushOptions
{
	double clearance =
	    0.01;           ///< metres above Options::min_d, > 0, finite: samples are pushed until every clearance is above it
	unsigned steps = 6; ///< pushes of a state, at least 1
	/// > 0: states in contact have no direction out. Others are drawn around them within this share of the space's extent: see below.
	double radius = 0.1;
	unsigned tries = 4; ///< states drawn around one in contact; 0: states in contact are given up
};

/// A ValidStateSampler for planners that ask the space information for valid states, such as PRM, EST and SBL; RRT's ask the space itself.
///
/// A uniform sample that is free and far enough is returned as it is. One that is nearer than `clearance` moves along the derivatives of
/// its near pairs (lw_checker_near()), all at once, until it is far enough or its steps are over; a sample between two walls ends in their
/// middle. Around one in contact others are drawn. A free state between it and another in contact replaces it (a bridge over a narrow
/// place); else it moves to the surface, on the way to a free one. So narrow places get more samples than their volume has, and the density is no
/// longer uniform. sample() returns true only for states that the space information's validity checker accepts; a state that is
/// free but still nearer than `clearance` is accepted.
///
/// Cost of a sample: one call of lw_checker_near() if it is far enough, else up to `steps` + 1 of them, and in contact up to
/// 4 `tries` + 7 states more; one state for the validity checker. At most setNrAttempts() uniform samples, 10 by OMPL's default.
///
/// One thread per sampler, as for all of OMPL's; the engine may be shared.
class PushingSampler : public ::ompl::base::ValidStateSampler
{
public:
	/// @param si its space must be the object that the engine was made with
	/// @throws std::invalid_argument for another space, or options out of their domain
	PushingSampler(
	    const ::ompl::base::SpaceInformation* si, std::shared_ptr<const Engine> engine, const PushOptions& options = {} );

	bool sample( ::ompl::base::State* state ) override;
	/// Uniform near another state, then moved: it may end farther away than `distance`, by the moves.
	bool sampleNear( ::ompl::base::State* state, const ::ompl::base::State* near, double distance ) override;

	/// Moves a state out of obstacles and away from near pairs. @return true if it is valid then
	bool push( ::ompl::base::State* state );

private:
	enum class Step
	{
		FAR,
		MOVED,
		STUCK,
		CONTACT
	};
	Step step( const Engine::Lease& lease, std::vector<double>& q );
	bool leaveContact( ::ompl::base::State* state );

	std::shared_ptr<const Engine> m_engine;
	const PushOptions m_options;
	::ompl::base::StateSamplerPtr m_sampler;
	double m_radius;
	std::vector<double> m_q, m_rows, m_move;
};

/// For SpaceInformation::setValidStateSamplerAllocator().
::ompl::base::ValidStateSamplerAllocator pushingSamplers(
    std::shared_ptr<const Engine> engine, const PushOptions& options = {} );

} // namespace leeway::ompl
