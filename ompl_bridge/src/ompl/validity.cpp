// SPDX-License-Identifier: BSD-3-Clause
// OMPL's two questions, answered by the core: isValid() and checkMotion(), with the whole of their contracts.
#include "slot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace leeway::ompl
{

namespace ob = ::ompl::base;

namespace
{

std::shared_ptr<const Engine> checkedEngine( std::shared_ptr<const Engine> engine )
{
	if ( !engine )
	{
		throw std::invalid_argument( "leeway::ompl: no engine" );
	}
	return engine;
}

// Is the clearance of q above min_d? Nothing beyond min_d is measured: the quickest question there is.
bool clear( const Engine& engine, lw_query* query, const double* q )
{
	const Options& options = engine.options();
	const lw_range range = { options.min_d, std::nextafter( options.min_d, std::numeric_limits<double>::infinity() ), 0 };
	lw_state_result result;
	return lw_checker_state( engine.checker().get(), query, q, options.what, &range, true, &result ) == LW_OK &&
		result.verdict == LW_VERDICT_FREE;
}

// The base class counts in plain unsigned ints, which planners with several threads share.
void increment( unsigned int& counter )
{
	__atomic_fetch_add( &counter, 1u, __ATOMIC_RELAXED );
}

} // namespace

// ---- states ----

StateValidityChecker::StateValidityChecker( const ob::SpaceInformationPtr& si, std::shared_ptr<const Engine> engine )
	: ob::StateValidityChecker( si ), m_engine( checkedEngine( std::move( engine ) ) )
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
	return clear( *m_engine, lease.query(), lease.a() );
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
	const lw_checker* checker = m_engine->checker().get();
	if ( lw_checker_state( checker, lease.query(), lease.a(), options.what, &range, true, &result ) != LW_OK ||
		result.verdict != LW_VERDICT_FREE )
	{
		return false;
	}
	// what was not asked for is UNKNOWN with lower = 0: left out
	double lower = options.max_d;
	if ( ( options.what & LW_WHAT_ENVIRONMENT ) != 0 )
	{
		lower = std::min( lower, result.environment.lower );
	}
	if ( ( options.what & LW_WHAT_SELF ) != 0 )
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

/// How far a motion was proved.
struct MotionValidator::Run
{
	lw_verdict verdict = LW_VERDICT_UNKNOWN;
	double proved_until = 0; ///< place on the whole motion; 0 if not wanted
	bool want_proved_until = false;
};

MotionValidator::MotionValidator( const ob::SpaceInformationPtr& si, std::shared_ptr<const Engine> engine )
	: ob::MotionValidator( si ), m_engine( checkedEngine( std::move( engine ) ) ), m_def( lw_edge_def_default() )
{
	if ( !m_engine->adapter().straight() )
	{
		throw std::invalid_argument( "leeway::ompl::MotionValidator: " + m_engine->adapter().curveProblem() +
			"; use leeway's StateValidityChecker with OMPL's own motion validator for this space" );
	}
	const Options& options = m_engine->options();
	m_def.method = options.method;
	m_def.what = options.what;
	m_def.min_d = options.min_d;
	m_def.slack = options.slack;
	m_def.max_d = options.step;
}

// Proves OMPL's curve from a to b, piece by piece.
void MotionValidator::proveCurve( const Engine::Lease& lease, const double* a, const double* b, Run& run ) const
{
	const StateAdapter& adapter = m_engine->adapter();
	Engine::Slot& slot = *lease.m_slot;
	lw_edge_def def = m_def;
	def.want_proved_until = run.want_proved_until;
	const unsigned pieces = adapter.pieceCount( a, b );
	std::copy( a, a + adapter.size(), slot.from );
	for ( unsigned piece = 0; piece < pieces; ++piece )
	{
		if ( piece + 1 == pieces )
		{
			std::copy( b, b + adapter.size(), slot.to );
		}
		else
		{
			adapter.interpolate( a, b, double( piece + 1 ) / pieces, slot.to );
		}
		lw_edge_result result;
		const lw_status status =
			lw_checker_edge( m_engine->checker().get(), slot.query.get(), slot.from, slot.to, &def, &result );
		run.verdict = status == LW_OK ? result.verdict : LW_VERDICT_UNKNOWN;
		run.proved_until = ( piece + ( status == LW_OK ? result.proved_until : 0 ) ) / pieces;
		slot.edge_queries.add( status == LW_OK ? result.queries : 0 );
		if ( run.verdict != LW_VERDICT_FREE )
		{
			return;
		}
		std::copy( slot.to, slot.to + adapter.size(), slot.from );
	}
}

// Proves the motion from slot.a to slot.b.
//
// Rotations that OMPL takes for equal (StateAdapter::hasCloseRotations()) make three curves of one motion: OMPL's own from a
// (rotation of a throughout), OMPL's own from b, for planners that walk the edge backwards, and the slerp between. All three
// are proved; together they also cover OMPL's jump at the end. Planners sample such pairs about never, so the price does not
// matter.
MotionValidator::Run MotionValidator::proveMotion( const Engine::Lease& lease, bool want_proved_until ) const
{
	const StateAdapter& adapter = m_engine->adapter();
	Engine::Slot& slot = *lease.m_slot;
	Run run;
	run.want_proved_until = want_proved_until;
	if ( !adapter.hasCloseRotations( slot.a, slot.b ) )
	{
		proveCurve( lease, slot.a, slot.b, run );
		return run;
	}
	std::copy( slot.b, slot.b + adapter.size(), slot.varied );
	adapter.replaceCloseRotations( slot.a, slot.varied );
	proveCurve( lease, slot.a, slot.varied, run );
	if ( run.verdict != LW_VERDICT_FREE )
	{
		return run;
	}
	run.want_proved_until = false;
	std::copy( slot.a, slot.a + adapter.size(), slot.varied );
	adapter.replaceCloseRotations( slot.b, slot.varied );
	proveCurve( lease, slot.varied, slot.b, run );
	if ( run.verdict == LW_VERDICT_FREE )
	{
		proveCurve( lease, slot.a, slot.b, run );
	}
	if ( run.verdict != LW_VERDICT_FREE )
	{
		// proved along one curve but not along another: nothing but the start counts
		run.proved_until = 0;
	}
	return run;
}

MotionValidator::Run MotionValidator::prove( const Engine::Lease& lease, bool want_proved_until ) const
{
	const Run run = proveMotion( lease, want_proved_until );
	Engine::Slot& slot = *lease.m_slot;
	slot.edges.add( 1 );
	slot.free.add( run.verdict == LW_VERDICT_FREE );
	slot.blocked.add( run.verdict == LW_VERDICT_BLOCKED );
	slot.refused.add( run.verdict == LW_VERDICT_REFUSED );
	return run;
}

// Writes the last valid state and returns its t. Both ends are in the slot by now, so `out` may be s1 or s2.
double MotionValidator::writeLastValid( const Engine::Lease& lease, const Run& run, const ob::State* s1,
	ob::State* out ) const
{
	const StateAdapter& adapter = m_engine->adapter();
	Engine::Slot& slot = *lease.m_slot;

	// The end of the proved run can lie so near to min_d that rounding decides: a second candidate lies a little before it.
	constexpr double candidates[] = { 1.0, 1.0 - 0x1p-10 };
	for ( double factor : candidates )
	{
		const double t = std::min( run.proved_until * factor, std::nextafter( 1.0, 0.0 ) );
		if ( !( t > 0 ) )
		{
			break;
		}
		adapter.interpolate( slot.a, slot.b, t, slot.result );
		adapter.enforceBounds( slot.result );
		if ( !clear( *m_engine, slot.query.get(), slot.result ) )
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

bool MotionValidator::count( bool valid ) const
{
	increment( valid ? valid_ : invalid_ );
	return valid;
}

// Both ends within the bounds: then all states between are, because bounds of RealVector are convex and the others have
// none.
bool MotionValidator::read( const Engine::Lease& lease, const ob::State* s1, const ob::State* s2 ) const
{
	if ( !lease || !si_->satisfiesBounds( s1 ) || !si_->satisfiesBounds( s2 ) )
	{
		return false;
	}
	m_engine->adapter().toVector( s1, lease.a() );
	m_engine->adapter().toVector( s2, lease.b() );
	return true;
}

bool MotionValidator::checkMotion( const ob::State* s1, const ob::State* s2 ) const
{
	const Engine::Lease lease( *m_engine );
	return count( read( lease, s1, s2 ) && prove( lease, false ).verdict == LW_VERDICT_FREE );
}

bool MotionValidator::checkMotion( const ob::State* s1, const ob::State* s2, std::pair<ob::State*, double>& lastValid ) const
{
	const Engine::Lease lease( *m_engine );
	if ( !read( lease, s1, s2 ) )
	{
		if ( lastValid.first != nullptr && lastValid.first != s1 )
		{
			si_->copyState( lastValid.first, s1 );
		}
		lastValid.second = 0;
		return count( false );
	}
	const Run run = prove( lease, true );
	if ( run.verdict != LW_VERDICT_FREE )
	{
		lastValid.second = writeLastValid( lease, run, s1, lastValid.first );
	}
	return count( run.verdict == LW_VERDICT_FREE );
}

std::shared_ptr<const Engine> install( const ob::SpaceInformationPtr& si, Checker checker, const Options& options )
{
	auto engine = std::make_shared<const Engine>( si->getStateSpace(), std::move( checker ), options );
	// made before either is set: a refusal leaves `si` as it was
	auto motions = std::make_shared<MotionValidator>( si, engine );
	si->setStateValidityChecker( std::make_shared<StateValidityChecker>( si, engine ) );
	si->setMotionValidator( motions );
	return engine;
}

} // namespace leeway::ompl
