// SPDX-License-Identifier: BSD-3-Clause
#include "view/steps.hpp"

#include "leeway/motions/audit.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>

namespace leeway::view
{
namespace
{

constexpr std::size_t equal_steps = 400;   // of a motion
constexpr std::size_t most_corners = 1600; // beyond these, corners between the equal steps are left out
constexpr int refinements = 12;            // halvings around the least clearance
constexpr std::size_t refined_minima = 8;  // the lowest local minima
constexpr int most_rounds = 12;            // of setting pairs apart

using StateAt = std::function<std::vector<double>( double )>;

/// Measures states of one motion.
class Meter
{
public:
	explicit Meter( const Measuring& how ) : m_how( how ), m_query( makeQuery( how.problem.checker.get() ) ) {}
	ViewStep measured( double at, const std::vector<double>& q ) const
	{
		ViewStep step;
		step.at = at;
		step.q = q;
		step.result = measure(
		    m_how.problem.checker.get(), m_query.get(), q, m_how.flags, nullptr, m_how.file, "a state of the motion" );
		step.others = m_others ? m_others->measured( q, m_how.flags ) : step.result;
		return step;
	}
	/// Sets pairs apart until the nearest of the others changes its distance.
	void setApart( ViewMotion& motion )
	{
		for ( int round = 0; round < most_rounds; ++round )
		{
			std::vector<SeenState> seen;
			for ( const ViewStep& step : motion.steps )
			{
				seen.push_back( { &step.q, &step.others } );
			}
			const std::vector<ApartPair> more = keepingDistance( m_how.problem, seen, m_how.min_d, m_how.file );
			if ( more.empty() )
			{
				return;
			}
			motion.apart.insert( motion.apart.end(), more.begin(), more.end() );
			std::vector<lwv_pair> pairs;
			std::transform( motion.apart.begin(), motion.apart.end(), std::back_inserter( pairs ),
			    []( const ApartPair& apart ) { return apart.pair; } );
			m_others.emplace( m_how.problem.checker.get(), pairs, m_how.file );
			for ( ViewStep& step : motion.steps )
			{
				step.others = m_others->measured( step.q, m_how.flags );
			}
		}
	}

private:
	const Measuring& m_how;
	Query m_query;
	std::optional<Others> m_others; // without the pairs that are set apart
};

/// Searches between the neighbours of a local minimum for a smaller clearance, by golden section; the best step found.
ViewStep refined( const Meter& meter, const StateAt& state_at, double low, double high, ViewStep best )
{
	constexpr double golden = 0.381966011250105;
	for ( int i = 0; i < refinements; ++i )
	{
		const bool right = high - best.at > best.at - low;
		const double at = right ? best.at + golden * ( high - best.at ) : best.at - golden * ( best.at - low );
		ViewStep step = meter.measured( at, state_at( at ) );
		const bool better = leastClearance( step.others ) < leastClearance( best.others );
		( better == right ? low : high ) = better ? best.at : at;
		if ( better )
		{
			best = std::move( step );
		}
	}
	return best;
}

/// Adds the minima between steps.
void refine( const Meter& meter, const StateAt& state_at, std::vector<ViewStep>& steps )
{
	std::vector<std::size_t> minima;
	const auto clearance = [&]( std::size_t i ) { return leastClearance( steps[i].others ); };
	for ( std::size_t i = 0; i < steps.size(); ++i )
	{
		const bool low = ( i == 0 || clearance( i ) <= clearance( i - 1 ) ) &&
		                 ( i + 1 == steps.size() || clearance( i ) <= clearance( i + 1 ) );
		if ( low && std::isfinite( clearance( i ) ) && steps.size() > 1 )
		{
			minima.push_back( i );
		}
	}
	std::stable_sort(
	    minima.begin(), minima.end(), [&]( std::size_t a, std::size_t b ) { return clearance( a ) < clearance( b ); } );
	minima.resize( std::min( minima.size(), refined_minima ) );
	std::vector<ViewStep> found;
	for ( const std::size_t i : minima )
	{
		const double low = steps[i == 0 ? 0 : i - 1].at, high = steps[std::min( i + 1, steps.size() - 1 )].at;
		ViewStep best = refined( meter, state_at, low, high, steps[i] );
		if ( best.at != steps[i].at )
		{
			found.push_back( std::move( best ) );
		}
	}
	steps.insert( steps.end(), found.begin(), found.end() );
	std::stable_sort( steps.begin(), steps.end(), []( const ViewStep& a, const ViewStep& b ) { return a.at < b.at; } );
}

/// Equal steps from the first corner to `end`, and the corners.
ViewMotion sampled(
    const Measuring& how, const StateAt& state_at, double end, const std::vector<double>& corners, StepUnit unit )
{
	Meter meter( how );
	std::vector<double> places;
	for ( std::size_t i = 0; i <= equal_steps; ++i )
	{
		places.push_back(
		    corners.front() + ( end - corners.front() ) * static_cast<double>( i ) / static_cast<double>( equal_steps ) );
	}
	if ( corners.size() <= most_corners )
	{
		places.insert( places.end(), corners.begin(), corners.end() );
	}
	std::sort( places.begin(), places.end() );
	places.erase( std::unique( places.begin(), places.end() ), places.end() );
	ViewMotion motion;
	motion.unit = unit;
	for ( const double place : places )
	{
		motion.steps.push_back( meter.measured( place, state_at( place ) ) );
		report( how.progress, "measuring the motion for the page", double( motion.steps.size() ) / double( places.size() ) );
	}
	meter.setApart( motion );
	refine( meter, state_at, motion.steps );
	return motion;
}

} // namespace

double leastClearance( const lw_state_result& result )
{
	double least = std::numeric_limits<double>::infinity();
	for ( const lw_clearance* c : { &result.environment, &result.self } )
	{
		const bool asked = c->kind != LW_CLEARANCE_UNKNOWN;
		least = asked ? std::min( least, std::isfinite( c->upper ) && c->upper <= 0 ? c->upper : c->lower ) : least;
	}
	return least;
}

ViewMotion motionOfPath( const Measuring& how, const std::vector<std::vector<double>>& points )
{
	const io::Problem& problem = how.problem;
	std::vector<double> begin = { 0 };
	for ( std::size_t i = 0; i + 1 < points.size(); ++i )
	{
		begin.push_back( begin.back() + jointDistance( problem, points[i], points[i + 1] ) );
	}
	const double whole = begin.back();
	if ( !( whole > 0 ) )
	{
		return motionOfStates( problem, { points.front() }, {}, how.flags, how.file );
	}
	for ( double& place : begin )
	{
		place /= whole;
	}
	const StateAt state_at = [&]( double place )
	{
		const auto next = std::upper_bound( begin.begin() + 1, begin.end() - 1, place );
		const std::size_t i = static_cast<std::size_t>( next - begin.begin() ) - 1;
		const double span = begin[i + 1] - begin[i], t = span > 0 ? std::clamp( ( place - begin[i] ) / span, 0.0, 1.0 ) : 0;
		std::vector<double> full( problem.reference.size() );
		const std::vector<double> from = fullState( problem, points[i] ), to = fullState( problem, points[i + 1] );
		lw_robot_interpolate( problem.robot.get(), from.data(), to.data(), t, full.data() );
		return groupState( problem, full );
	};
	return sampled( how, state_at, 1, begin, StepUnit::share );
}

ViewMotion motionOfTrajectory( const Measuring& how, const std::vector<Segment>& segments )
{
	std::vector<double> corners;
	corners.reserve( segments.size() );
	for ( const Segment& segment : segments )
	{
		corners.push_back( segment.begin );
	}
	const double end = segments.back().begin + segments.back().seconds;
	return sampled(
	    how, [&]( double time ) { return stateAt( segments, time ); }, end, corners, StepUnit::seconds );
}

ViewMotion motionOfStates( const io::Problem& problem, const std::vector<std::vector<double>>& states,
    const std::vector<std::string>& labels, lw_check_flags flags, const std::string& file )
{
	const Measuring how = { problem, flags, 0, file };
	const Meter meter( how );
	ViewMotion motion;
	motion.unit = states.size() > 1 ? StepUnit::state : StepUnit::none;
	for ( std::size_t i = 0; i < states.size(); ++i )
	{
		motion.steps.push_back( meter.measured( static_cast<double>( i ), states[i] ) );
		motion.steps.back().label = i < labels.size() ? labels[i] : "";
	}
	return motion;
}

std::size_t leastStep( const ViewMotion& motion )
{
	std::size_t best = 0;
	for ( std::size_t i = 1; i < motion.steps.size(); ++i )
	{
		best = leastClearance( motion.steps[i].others ) < leastClearance( motion.steps[best].others ) ? i : best;
	}
	return best;
}

void setNothingApart( ViewMotion& motion )
{
	motion.apart.clear();
	for ( ViewStep& step : motion.steps )
	{
		step.others = step.result;
	}
}

} // namespace leeway::view
