// SPDX-License-Identifier: BSD-3-Clause
// Motions of a planner: see planner_edges.hpp.
#include "support/planner_edges.hpp"

#include "leeway/ompl/validity.hpp"

#include <ompl/geometric/SimpleSetup.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

#include <mutex>
#include <random>

namespace ob = ::ompl::base;

namespace
{

/// Passes motions on to another validator and records them. One thread.
class Recorder : public ob::MotionValidator
{
public:
	Recorder( const ob::SpaceInformationPtr& si, ob::MotionValidatorPtr other, const leeway::ompl::StateAdapter& adapter,
	    std::vector<Motion>& motions )
	    : ob::MotionValidator( si ), m_other( std::move( other ) ), m_adapter( adapter ), m_motions( motions )
	{
	}

	bool checkMotion( const ob::State* s1, const ob::State* s2 ) const override
	{
		keep( s1, s2 );
		return m_other->checkMotion( s1, s2 );
	}

	bool checkMotion( const ob::State* s1, const ob::State* s2, std::pair<ob::State*, double>& last_valid ) const override
	{
		keep( s1, s2 ); // before the answer: last_valid may be one of the two
		return m_other->checkMotion( s1, s2, last_valid );
	}

private:
	void keep( const ob::State* s1, const ob::State* s2 ) const
	{
		Motion motion = { std::vector<double>( m_adapter.size() ), std::vector<double>( m_adapter.size() ) };
		m_adapter.toVector( s1, motion.from.data() );
		m_adapter.toVector( s2, motion.to.data() );
		m_motions.push_back( std::move( motion ) );
	}

	const ob::MotionValidatorPtr m_other;
	const leeway::ompl::StateAdapter& m_adapter;
	std::vector<Motion>& m_motions;
};

} // namespace

std::vector<Motion> motionsOfPlanner( const EdgeWorldEntry& entry, double seconds, std::size_t most, std::uint64_t seed )
{
	::ompl::msg::setLogLevel( ::ompl::msg::LOG_ERROR );
	static std::once_flag seeded; // OMPL takes a seed only before its first random number
	std::call_once( seeded, [seed] { ::ompl::RNG::setSeed( static_cast<std::uint_fast32_t>( seed % 0x7fffffff + 1 ) ); } );
	::ompl::geometric::SimpleSetup setup( leeway::ompl::makeStateSpace( entry.world.with_tables ) );
	const ob::SpaceInformationPtr& si = setup.getSpaceInformation();
	const auto engine = leeway::ompl::install( si, entry.world.with_tables );
	std::vector<Motion> motions;
	si->setMotionValidator( std::make_shared<Recorder>( si, si->getMotionValidator(), engine->adapter(), motions ) );
	ob::ScopedState<> start( setup.getStateSpace() ), goal( setup.getStateSpace() );
	engine->adapter().fromVector( entry.start.data(), start.get() );
	engine->adapter().fromVector( entry.goal.data(), goal.get() );
	setup.setStartAndGoalStates( start, goal );
	setup.setPlanner( std::make_shared<::ompl::geometric::RRTConnect>( si ) );
	if ( setup.solve( seconds ) == ob::PlannerStatus::EXACT_SOLUTION )
	{
		setup.simplifySolution( seconds );
	}
	std::vector<Motion> chosen;
	std::mt19937_64 random( seed );
	std::sample( motions.begin(), motions.end(), std::back_inserter( chosen ), most, random );
	return chosen;
}
