// SPDX-License-Identifier: BSD-3-Clause
// OMPL's two questions, answered by the core: isValid() and checkMotion(), with the whole of their contracts.
#include "edge_prover.hpp"
#include "leeway/prepare.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace leeway::ompl
{

namespace ob = ::ompl::base;

namespace
{

// States carry no type: those of another space would be read as numbers of this one.
std::shared_ptr<const Engine> checkedEngine( const ob::SpaceInformationPtr& si, std::shared_ptr<const Engine> engine )
{
	if ( !si || !engine )
	{
		throw std::invalid_argument( "leeway::ompl: no space information or no engine" );
	}
	if ( si->getStateSpace() != engine->adapter().space() )
	{
		throw std::invalid_argument( "leeway::ompl: the space information is of space " + si->getStateSpace()->getName() +
		                             ", the engine was made for another one, " + engine->adapter().space()->getName() +
		                             "; make an engine for each" );
	}
	return engine;
}

// An error is not free.
bool clear( const Options& options, const lw_checker* checker, lw_query* query, const double* q )
{
	bool free = false;
	lw_checker_is_free( checker, query, q, options.flags, options.min_d, &free, nullptr );
	return free;
}

// The base class counts in plain unsigned ints, which planners with several threads share.
void increment( unsigned int& counter )
{
	__atomic_fetch_add( &counter, 1u, __ATOMIC_RELAXED );
}

} // namespace

// ---- states ----

StateValidityChecker::StateValidityChecker( const ob::SpaceInformationPtr& si, std::shared_ptr<const Engine> engine )
    : ob::StateValidityChecker( si ), m_engine( checkedEngine( si, std::move( engine ) ) )
{
	// a lower bound: alpha, max_d and the rounding bound all err on that side
	specs_.clearanceComputationType = ob::StateValidityCheckerSpecs::BOUNDED_APPROXIMATE;
	specs_.hasValidDirectionComputation = false;
}

bool StateValidityChecker::isValid( const ob::State* state ) const
{
	// NaN passes OMPL's comparisons with the bounds; the core refuses it
	if ( !si_->satisfiesBounds( state ) )
	{
		return false;
	}
	const Engine::Lease lease( *m_engine );
	if ( !lease )
	{
		return false;
	}
	lease.m_slot->states.add( 1 );
	m_engine->adapter().toVector( state, lease.a() );
	return clear( m_engine->options(), lease.checker(), lease.query(), lease.a() );
}

bool StateValidityChecker::evaluate( const ob::State* state, double& dist ) const
{
	dist = 0;
	const Engine::Lease lease( *m_engine );
	if ( !lease )
	{
		return false;
	}
	lease.m_slot->states.add( 1 );
	m_engine->adapter().toVector( state, lease.a() );
	const Options& options = m_engine->options();
	const lw_range range = { options.min_d, options.max_d, options.alpha };
	lw_state_result result;
	if ( lw_checker_state( lease.checker(), lease.query(), lease.a(), options.flags, &range, true, &result ) != LW_OK ||
	     result.verdict != LW_VERDICT_FREE )
	{
		return false;
	}
	// a part outside `options.what` is UNKNOWN with lower = 0: left out
	double lower = options.max_d;
	if ( ( options.flags & LW_CHECK_ENVIRONMENT ) != 0 )
	{
		lower = std::min( lower, result.environment.lower );
	}
	if ( ( options.flags & LW_CHECK_SELF ) != 0 )
	{
		lower = std::min( lower, result.self.lower );
	}
	dist = std::max( 0.0, lower - options.min_d );
	return true;
}

bool StateValidityChecker::isValid( const ob::State* state, double& dist ) const
{
	return evaluate( state, dist ) && si_->satisfiesBounds( state );
}

bool StateValidityChecker::isValid( const ob::State* state, double& dist, ob::State*, bool& validStateAvailable ) const
{
	validStateAvailable = false;
	return isValid( state, dist );
}

double StateValidityChecker::clearance( const ob::State* state ) const
{
	double dist = 0;
	evaluate( state, dist );
	return dist;
}

double StateValidityChecker::clearance( const ob::State* state, ob::State*, bool& validStateAvailable ) const
{
	validStateAvailable = false;
	return clearance( state );
}

// ---- motions ----

MotionValidator::MotionValidator( const ob::SpaceInformationPtr& si, std::shared_ptr<const Engine> engine )
    : ob::MotionValidator( si ), m_engine( checkedEngine( si, std::move( engine ) ) ), m_def( lw_edge_def_default() ),
      m_last_def( m_def )
{
	if ( !m_engine->adapter().straight() )
	{
		throw std::invalid_argument( "leeway::ompl::MotionValidator: " + m_engine->adapter().curveProblem() +
		                             "; use leeway's StateValidityChecker with OMPL's own motion validator for this space" );
	}
	const Options& options = m_engine->options();
	m_def.method = options.method;
	m_def.flags = options.flags;
	m_def.min_d = options.min_d;
	m_def.slack = options.slack;
	m_def.max_d = options.step;
	m_def.tolerance = options.tolerance.empty() ? nullptr : options.tolerance.data(); // the engine's

	// An edge with all clearances above (min_d + T + slack) / (1 - alpha), T the tube of a pair, is never undecided
	// (core/docs/edges.md, motions.md): the run is proved at that margin, and a millionth more for the rounding of the state at
	// its end. Tubes grow as their tolerances do. proveRun() treats motions that begin nearer than that.
	m_last_def = m_def;
	m_last_def.want_proved_until = true;
	const double growth = ( 1 + 1e-6 ) / ( 1 - m_def.alpha );
	m_last_def.min_d = ( m_def.min_d + m_def.slack ) * growth;
	for ( const double tolerance : options.tolerance )
	{
		m_last_tolerance.push_back( tolerance * growth );
	}
	m_last_def.tolerance = m_last_tolerance.empty() ? nullptr : m_last_tolerance.data();
}

ProvedMotion MotionValidator::prove( const EdgeProver& prover, const lw_edge_def& def ) const
{
	Engine::Slot& slot = prover.slot();
	const ProvedMotion run = prover.prove( def, slot.edge_queries );
	slot.edges.add( 1 );
	slot.free.add( run.verdict == LW_VERDICT_FREE );
	slot.blocked.add( run.verdict == LW_VERDICT_BLOCKED );
	slot.undecided.add( run.verdict == LW_VERDICT_UNDECIDED );
	if ( run.verdict == LW_VERDICT_UNDECIDED )
	{
		m_engine->noteUndecided( run.self, run.pair );
	}
	return run;
}

// True if the motions from slot.a to slot.result and back are free, asked for as checkMotion() asks.
bool MotionValidator::isFreeBothWays( const EdgeProver& prover ) const
{
	Engine::Slot& slot = prover.slot();
	auto isFree = [&] { return prover.prove( m_def, slot.edge_queries ).verdict == LW_VERDICT_FREE; };
	std::swap( slot.b, slot.result );
	const bool there = isFree();
	std::swap( slot.a, slot.b );
	const bool back = there && isFree();
	std::swap( slot.a, slot.b );
	std::swap( slot.b, slot.result );
	return back;
}

// Writes the last valid state and returns its t. Both ends are in the slot by now, so `out` may be s1 or s2.
double MotionValidator::writeLastValid(
    const EdgeProver& prover, const ProvedRun& run, const ob::State* s1, ob::State* out ) const
{
	const StateAdapter& adapter = m_engine->adapter();
	Engine::Slot& slot = prover.slot();

	// The end of the proved run can lie so near to min_d that rounding decides: the second candidate lies a little before
	// it. A run that begins within the slack can end where its proof is undecided as a motion of its own: the others lie well
	// before.
	constexpr double candidates[] = { 1.0, 1.0 - 0x1p-10, 0.75, 0.25 };
	for ( double factor : candidates )
	{
		const double t = std::min( run.until * factor, std::nextafter( 1.0, 0.0 ) );
		if ( !( t > 0 ) )
		{
			break;
		}
		adapter.interpolate( slot.a, slot.b, t, slot.result );
		adapter.enforceBounds( slot.result );
		if ( !clear( m_engine->options(), slot.checker.get(), slot.query.get(), slot.result ) ||
		     ( run.within_slack && !isFreeBothWays( prover ) ) )
		{
			continue;
		}
		if ( out == nullptr )
		{
			return t;
		}
		adapter.fromVector( slot.result, out );
		if ( si_->satisfiesBounds( out ) )
		{
			return t;
		}
		break; // a space with bounds of its own kind
	}
	if ( out == s1 )
	{
		adapter.fromVector( slot.a, out ); // it may have been overwritten above
	}
	else if ( out != nullptr )
	{
		si_->copyState( out, s1 );
	}
	return 0;
}

// The run up to the last valid state of a motion that is not free.
MotionValidator::ProvedRun MotionValidator::proveRun( const EdgeProver& prover ) const
{
	SlotCounter& queries = prover.slot().edge_queries;
	const double until = prover.prove( m_last_def, queries ).proved_until;
	if ( until > 0 )
	{
		return { until, false };
	}
	// The motion begins within the slack, as grips do and links that are near each other by design: the run is proved as the
	// verdict is, by slacks that follow the room at its start.
	lw_edge_def def = m_def;
	def.want_proved_until = true;
	return { prover.prove( def, queries ).proved_until, true };
}

bool MotionValidator::count( bool valid ) const
{
	increment( valid ? valid_ : invalid_ );
	return valid;
}

bool MotionValidator::checkMotion( const ob::State* s1, const ob::State* s2 ) const
{
	const Engine::Lease lease( *m_engine );
	if ( !lease )
	{
		return count( false );
	}
	const EdgeProver prover( *m_engine, lease );
	return count( prover.read( *si_, s1, s2 ) && prove( prover, m_def ).verdict == LW_VERDICT_FREE );
}

bool MotionValidator::checkMotion( const ob::State* s1, const ob::State* s2, std::pair<ob::State*, double>& lastValid ) const
{
	auto keepStart = [&]
	{
		if ( lastValid.first != nullptr && lastValid.first != s1 )
		{
			si_->copyState( lastValid.first, s1 );
		}
		lastValid.second = 0;
		return count( false );
	};
	const Engine::Lease lease( *m_engine );
	if ( !lease )
	{
		return keepStart();
	}
	const EdgeProver prover( *m_engine, lease );
	if ( !prover.read( *si_, s1, s2 ) )
	{
		return keepStart();
	}
	lw_edge_def def = m_def;
	def.want_proved_until = def.method == LW_EDGE_STEPS;
	const ProvedMotion motion = prove( prover, def );
	const bool free = motion.verdict == LW_VERDICT_FREE;
	if ( !free )
	{
		const bool steps = def.method == LW_EDGE_STEPS;
		const ProvedRun run = steps ? ProvedRun{ motion.proved_until, false } : proveRun( prover );
		lastValid.second = writeLastValid( prover, run, s1, lastValid.first );
	}
	return count( free );
}

std::shared_ptr<Engine> install( const ob::SpaceInformationPtr& si, Checker checker, const Options& options )
{
	if ( !si )
	{
		throw std::invalid_argument( "leeway::ompl::install: no space information" );
	}
	auto engine = std::make_shared<Engine>( si->getStateSpace(), std::move( checker ), options );
	// made before either is set: a refusal leaves `si` as it was
	auto motions = std::make_shared<MotionValidator>( si, engine );
	si->setStateValidityChecker( std::make_shared<StateValidityChecker>( si, engine ) );
	si->setMotionValidator( motions );
	if ( options.prepare )
	{
		// ignored: with or without this call, states and motions that need a mesh that cannot be made are refused
		(void)prepare( engine->checker().get() );
	}
	return engine;
}

} // namespace leeway::ompl
