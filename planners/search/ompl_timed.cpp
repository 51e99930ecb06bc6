// SPDX-License-Identifier: BSD-3-Clause
// See ompl_timed.hpp.
#include "leeway/planners/ompl_timed.hpp"

#include "timed_motion.hpp"

#include <ompl/base/MotionValidator.h>
#include <ompl/base/StateValidityChecker.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/spaces/TimeStateSpace.h>

#include <mutex>

namespace leeway::planners
{

namespace
{

namespace ob = ::ompl::base;

const double* numbersOf( const ob::State* state )
{
	return state->as<ob::CompoundState>()->as<ob::RealVectorStateSpace::StateType>( 0 )->values;
}

double timeOf( const ob::State* state )
{
	return state->as<ob::CompoundState>()->as<ob::TimeStateSpace::StateType>( 1 )->position;
}

/// With bounds: numbers of OMPL's space do not go round.
TimedSettings bounded( const Checker& checker, TimedSettings settings, const lw_clock& others )
{
	Statistics unused;
	const TimedMotion motion( checker, settings, others, unused );
	std::vector<double> lower, upper;
	motion.findBounds( lower, upper );
	settings.lower = lower;
	settings.upper = upper;
	return settings;
}

/// The questions of both validators, one thread at a time.
struct TimedQuestions
{
	TimedQuestions( const Checker& checker, const TimedSettings& s, const lw_clock& others )
	    : settings( bounded( checker, s, others ) ), motion( checker, settings, others, statistics ),
	      query( makeQuery( checker.get() ) )
	{
		motion.begin( query.get() );
	}

	const TimedSettings settings;
	Statistics statistics;
	TimedMotion motion;
	Query query;
	std::mutex mutex;
};

class TimedStateValidity : public ob::StateValidityChecker
{
public:
	TimedStateValidity( const ob::SpaceInformationPtr& si, std::shared_ptr<TimedQuestions> questions )
	    : ob::StateValidityChecker( si ), m_questions( std::move( questions ) )
	{
	}

	bool isValid( const ob::State* state ) const override
	{
		const std::lock_guard<std::mutex> lock( m_questions->mutex );
		return m_questions->motion.isStateFree( numbersOf( state ), timeOf( state ) );
	}

private:
	std::shared_ptr<TimedQuestions> m_questions;
};

class TimedMotionValidity : public ob::MotionValidator
{
public:
	TimedMotionValidity( const ob::SpaceInformationPtr& si, std::shared_ptr<TimedQuestions> questions )
	    : ob::MotionValidator( si ), m_questions( std::move( questions ) )
	{
	}

	bool checkMotion( const ob::State* from, const ob::State* to ) const override
	{
		const std::lock_guard<std::mutex> lock( m_questions->mutex );
		TimedMotion& motion = m_questions->motion;
		const double between = timeOf( to ) - timeOf( from );
		const bool valid = between > 0 && motion.least( numbersOf( from ), numbersOf( to ) ) <= between * ( 1 + 1e-12 ) &&
		                   motion.isFree( numbersOf( from ), timeOf( from ), numbersOf( to ), timeOf( to ) );
		valid ? ++valid_ : ++invalid_;
		return valid;
	}

	/// Of a motion that is not valid nothing is claimed: the last valid state is the first one.
	bool checkMotion( const ob::State* from, const ob::State* to, std::pair<ob::State*, double>& last_valid ) const override
	{
		const bool valid = checkMotion( from, to );
		last_valid.second = valid ? 1 : 0;
		if ( !valid && last_valid.first != nullptr )
		{
			si_->copyState( last_valid.first, from );
		}
		return valid;
	}

private:
	std::shared_ptr<TimedQuestions> m_questions;
};

} // namespace

ob::StateSpacePtr makeTimedSpace( const Checker& checker, const TimedSettings& settings, const lw_clock& others )
{
	const TimedSettings within = bounded( checker, settings, others );
	const auto n = static_cast<unsigned>( settings.variables.size() );
	auto numbers = std::make_shared<ob::RealVectorStateSpace>( n );
	ob::RealVectorBounds bounds( n );
	bounds.low = within.lower;
	bounds.high = within.upper;
	numbers->setBounds( bounds );
	auto time = std::make_shared<ob::TimeStateSpace>();
	time->setBounds( settings.start_time, settings.deadline );
	auto both = std::make_shared<ob::CompoundStateSpace>();
	both->addSubspace( numbers, 1.0 );
	both->addSubspace( time, 1.0 );
	both->lock();
	return both;
}

void setTimedValidators(
    const ob::SpaceInformationPtr& si, const Checker& checker, const TimedSettings& settings, const lw_clock& others )
{
	const auto* compound = dynamic_cast<const ob::CompoundStateSpace*>( si->getStateSpace().get() );
	const bool fits = compound != nullptr && compound->getSubspaceCount() == 2 &&
	                  compound->getSubspace( 0 )->getType() == ob::STATE_SPACE_REAL_VECTOR &&
	                  compound->getSubspace( 0 )->getDimension() == settings.variables.size() &&
	                  compound->getSubspace( 1 )->getType() == ob::STATE_SPACE_TIME;
	if ( !fits )
	{
		throw InputError(
		    "leeway::planners: setTimedValidators: the space is no compound of a RealVectorStateSpace of all planned "
		    "variables and a TimeStateSpace; makeTimedSpace() makes one" );
	}
	const auto questions = std::make_shared<TimedQuestions>( checker, settings, others );
	si->setStateValidityChecker( std::make_shared<TimedStateValidity>( si, questions ) );
	si->setMotionValidator( std::make_shared<TimedMotionValidity>( si, questions ) );
}

} // namespace leeway::planners
