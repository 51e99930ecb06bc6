// SPDX-License-Identifier: BSD-3-Clause
// The least clearance along a motion, enclosed from both sides: certified edges from below, measured states from above.
#include "leeway/ompl/objective.hpp"

#include "edge_prover.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace leeway::ompl
{

namespace ob = ::ompl::base;

namespace
{

constexpr double infinity = std::numeric_limits<double>::infinity();

// Failures after which the margin is halved in logarithm instead of being put just below the last state measured: that
// state is one below the margin, not the lowest.
constexpr int trusted_failures = 2;

// No more edge checks than this, for one whose bounds do not meet because rounding is coarser than the tolerance.
constexpr int most_checks = 64;

// Encloses D, the least clearance along the motion from slot.a to slot.b, capped at max_d.
//
// An edge check at margin c, with slack s and distances to within alpha, is FREE (D > c), or it stops at a state whose
// clearance is at most (c + s) / (1 - alpha). With alpha = tolerance / 4 and s = alpha c that is below c (1 + tolerance),
// because (1 + x / 4) / (1 - x / 4) < 1 + x for 0 < x < 2: a failure at c = high / (1 + tolerance) or below lowers `high`.
//
// Number of checks: let R = log( high / low ) / log( 1 + tolerance ); the search ends at R <= 1. A halving leaves R / 2 or,
// if it fails, at most R / 2 + 0.7; below R = 2 a failure takes 0.3 at least. Hence log2 R + 4, the trusted failures, the
// cap and the last check: no more than 8 + log2 R.
class ClearanceSearch
{
public:
	ClearanceSearch( const Engine& engine, const EdgeProver& prover, double tolerance )
	    : m_engine( engine ), m_prover( prover ), m_tolerance( tolerance ), m_high( engine.options().max_d )
	{
	}

	/// A proved lower bound of D; 0 if the motion is not proved to be valid.
	double run()
	{
		const Options& options = m_engine.options();
		const double lowest = options.min_d + options.slack, factor = 1 + m_tolerance;
		if ( !lowerHigh( m_prover.slot().a ) || !lowerHigh( m_prover.slot().b ) )
		{
			return 0;
		}
		int failures = 0;
		bool cap_tried = false;
		for ( int i = 0; i < most_checks && std::isfinite( m_high ); ++i )
		{
			const double known = std::max( m_low, lowest );
			if ( m_high <= known * factor )
			{
				break;
			}
			double margin = m_high / factor;
			if ( failures >= trusted_failures )
			{
				margin = std::min( margin, std::sqrt( known * m_high ) );
			}
			else if ( m_high == options.max_d && !cap_tried )
			{
				margin = m_high; // nothing is nearer than the cap so far: all or nothing
				cap_tried = true;
			}
			switch ( check( margin, 0.25 * m_tolerance * margin, 0.25 * m_tolerance ) )
			{
			case LW_VERDICT_FREE:
				break;
			case LW_VERDICT_UNKNOWN:
				return 0;
			default:
				++failures;
				if ( !lowerHighAtFailure( margin ) )
				{
					return m_low;
				}
			}
		}
		if ( m_low == 0 )
		{
			check( options.min_d, options.slack, lw_edge_def_default().alpha );
		}
		return m_low;
	}

private:
	// Measures a state; false if it is not clear of min_d.
	bool lowerHigh( const double* q )
	{
		const Options& options = m_engine.options();
		const lw_range range = { options.min_d, m_high, 0.25 * m_tolerance };
		auto& slot = m_prover.slot();
		lw_state_result state;
		slot.cost_queries.add( 1 );
		const lw_checker* checker = slot.checker.get();
		if ( lw_checker_state( checker, slot.query.get(), q, options.flags, &range, true, &state ) != LW_OK ||
		     state.verdict != LW_VERDICT_FREE )
		{
			return false;
		}
		m_high = std::min( { m_high, state.environment.upper, state.self.upper } ); // +inf if far or not asked for
		return m_high > options.min_d;
	}

	bool lowerHighAtFailure( double margin )
	{
		auto& slot = m_prover.slot();
		m_engine.adapter().interpolate( slot.from, slot.to, m_failure, slot.result );
		const bool clear = lowerHigh( slot.result );
		// the upper bound that the verdict itself implies; never below the proved bound, in case rounding swaps the two
		const double share = 0.25 * m_tolerance;
		m_high = std::max( std::min( m_high, margin * ( 1 + share ) / ( 1 - share ) ), m_low );
		return clear;
	}

	// Proves the motion at a margin if possible, and stores the proved bound and the place of a failure.
	lw_verdict check( double margin, double slack, double alpha )
	{
		lw_edge_def def = lw_edge_def_default();
		def.flags = m_engine.options().flags;
		def.min_d = margin;
		def.slack = slack;
		def.close_windows = 0; // bisection goes to where motions are undecided: within the tolerance that is the answer
		def.alpha = alpha;
		auto& slot = m_prover.slot();
		slot.cost_edges.add( 1 );
		const ProvedMotion run = m_prover.prove( def, slot.cost_queries );
		m_failure = run.t;
		if ( run.verdict == LW_VERDICT_FREE )
		{
			m_low = std::min( std::max( run.lower_bound, margin ), m_engine.options().max_d );
		}
		return run.verdict;
	}

	const Engine& m_engine;
	const EdgeProver& m_prover;
	const double m_tolerance;
	double m_low = 0; ///< proved; 0 if nothing is
	double m_high;    ///< D is not above it
	double m_failure = 1;
};

double checkedTolerance( double tolerance )
{
	if ( !( tolerance > 0 && tolerance <= 1 ) )
	{
		throw std::invalid_argument( "leeway::ompl::ClearanceObjective: tolerance must be in (0, 1]" );
	}
	return tolerance;
}

} // namespace

ClearanceObjective::ClearanceObjective(
    const ob::SpaceInformationPtr& si, std::shared_ptr<const Engine> engine, double tolerance )
    : ob::MinimaxObjective( si ), m_engine( std::move( engine ) ), m_states( si, m_engine ),
      m_tolerance( checkedTolerance( tolerance ) )
{
	if ( !m_engine->adapter().straight() )
	{
		throw std::invalid_argument( "leeway::ompl::ClearanceObjective: " + m_engine->adapter().curveProblem() +
		                             "; use OMPL's MaximizeMinClearanceObjective, which samples, for this space" );
	}
	description_ = "Least clearance (leeway)";
	// better than this is the cap itself, and nothing is better than the cap
	setCostThreshold( ob::Cost( std::nextafter( m_engine->options().max_d - m_engine->options().min_d, 0 ) ) );
}

ob::Cost ClearanceObjective::stateCost( const ob::State* state ) const
{
	return ob::Cost( m_states.clearance( state ) );
}

ob::Cost ClearanceObjective::motionCost( const ob::State* s1, const ob::State* s2 ) const
{
	const Engine::Lease lease( *m_engine );
	if ( !lease )
	{
		return ob::Cost( 0 );
	}
	const EdgeProver prover( *m_engine, lease );
	auto& slot = prover.slot();
	slot.motion_costs.add( 1 );
	if ( !prover.read( *si_, s1, s2 ) )
	{
		return ob::Cost( 0 );
	}
	// one direction for both, so that both get the same search
	const std::size_t size = m_engine->adapter().size();
	if ( std::lexicographical_compare( slot.b, slot.b + size, slot.a, slot.a + size ) )
	{
		std::swap_ranges( slot.a, slot.a + size, slot.b );
	}
	const Options& options = m_engine->options();
	const double lower = ClearanceSearch( *m_engine, prover, m_tolerance ).run();
	if ( lower >= options.max_d )
	{
		return ob::Cost( options.max_d - options.min_d );
	}
	return ob::Cost( lower > options.min_d ? std::nextafter( lower - options.min_d, 0 ) : 0 );
}

bool ClearanceObjective::isCostBetterThan( ob::Cost c1, ob::Cost c2 ) const
{
	return c1.value() > c2.value();
}

bool ClearanceObjective::isSymmetric() const
{
	return true;
}

ob::Cost ClearanceObjective::identityCost() const
{
	return ob::Cost( infinity );
}

ob::Cost ClearanceObjective::infiniteCost() const
{
	return ob::Cost( -infinity );
}

} // namespace leeway::ompl
