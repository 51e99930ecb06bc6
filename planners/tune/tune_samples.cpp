// SPDX-License-Identifier: BSD-3-Clause
// Samples of states and motions such as a planner checks, with their true clearances.
#include "leeway/tune/tune.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace leeway::tune
{
namespace
{

constexpr double open_span = 1;         // metres to either side of the reference, for positions without limits
constexpr double longest = 0.2;         // of the space's extent: how far OMPL's planners go in one motion by default
constexpr std::size_t attempts = 20000; // random states in search of a free one
constexpr double truth_slack = 2e-5;    // metres, of the proofs that bound the true clearance of a motion
constexpr double truth_width = 5e-5;    // metres: an enclosure this narrow is good enough

class Sampler
{
public:
	Sampler( const io::Problem& problem, lw_query* query, const Settings& settings, std::string robot_file )
	    : m_problem( problem ), m_query( query ), m_settings( settings ), m_robot_file( std::move( robot_file ) ),
	      m_random( settings.seed ), m_reference( motions::groupState( problem, problem.reference ) )
	{
		double squared = 0;
		for ( std::size_t i = 0; i < m_reference.size(); ++i )
		{
			const auto [low, high] = span( i );
			const double range = info( i ).wraps ? M_PI : high - low;
			squared += range * range;
		}
		m_extent = std::sqrt( squared );
	}

	Samples draw()
	{
		Samples samples;
		for ( std::size_t i = 0; i < m_settings.motions; ++i )
		{
			samples.motions.push_back( motion() );
			motions::report(
			    m_settings.progress, "drawing states and motions", double( i + 1 ) / double( m_settings.motions ) );
		}
		for ( std::size_t i = 0; i < m_settings.states; ++i )
		{
			// half anywhere, half where planners are: on the way from a free state to another one
			samples.states.push_back( i % 2 == 0 || samples.motions.empty() ? state() : placeOn( samples.motions ) );
		}
		return samples;
	}

private:
	lw_variable_info info( std::size_t i ) const
	{
		return lw_robot_variable( m_problem.robot.get(), m_problem.variables[i] );
	}

	bool isRotation( std::size_t i ) const
	{
		return info( i ).component >= 3 &&
		       lw_robot_joint_type( m_problem.robot.get(), info( i ).joint ) == LW_JOINT_FLOATING;
	}

	std::pair<double, double> span( std::size_t i ) const
	{
		const lw_variable_info v = info( i );
		if ( isRotation( i ) )
		{
			return { -1, 1 };
		}
		return { std::isfinite( v.lower ) ? v.lower : m_reference[i] - open_span,
		    std::isfinite( v.upper ) ? v.upper : m_reference[i] + open_span };
	}

	// Not std::uniform_real_distribution, which may differ between standard libraries.
	double uniform() { return static_cast<double>( m_random() >> 11 ) * 0x1p-53; }

	// Box and Muller 1958; std::normal_distribution may differ as well.
	double normal() { return std::sqrt( -2 * std::log( 1 - uniform() ) ) * std::cos( 2 * M_PI * uniform() ); }

	std::vector<double> state()
	{
		std::vector<double> q( m_reference.size() );
		for ( std::size_t i = 0; i < q.size(); ++i )
		{
			const auto [low, high] = span( i );
			q[i] = isRotation( i ) ? normal() : low + uniform() * ( high - low );
		}
		for ( std::size_t i = 0; i + 3 < q.size(); ++i )
		{
			if ( isRotation( i ) )
			{
				const double norm = std::hypot( std::hypot( q[i], q[i + 1] ), std::hypot( q[i + 2], q[i + 3] ) );
				std::for_each( q.begin() + static_cast<std::ptrdiff_t>( i ),
				    q.begin() + static_cast<std::ptrdiff_t>( i + 4 ), [norm]( double& value ) { value /= norm; } );
				i += 3;
			}
		}
		return q;
	}

	std::vector<double> between( const std::vector<double>& a, const std::vector<double>& b, double t ) const
	{
		std::vector<double> from = motions::fullState( m_problem, a );
		const std::vector<double> to = motions::fullState( m_problem, b );
		std::vector<double> out( from.size() );
		lw_robot_interpolate( m_problem.robot.get(), from.data(), to.data(), t, out.data() );
		return motions::groupState( m_problem, out );
	}

	std::vector<double> placeOn( const std::vector<Motion>& motions )
	{
		const Motion& on = motions[m_random() % motions.size()];
		return between( on.from, on.to, uniform() );
	}

	bool isFree( const std::vector<double>& q )
	{
		bool free = false;
		require( lw_checker_is_free(
		             m_problem.checker.get(), m_query, q.data(), m_settings.flags, m_settings.min_d, &free, nullptr ),
		    "a state" );
		return free;
	}

	// In a narrow world few random states are free: then the way to one from the reference is tried, ever shorter.
	std::vector<double> freeState()
	{
		const bool home = isFree( m_reference );
		for ( std::size_t i = 0; i < attempts; ++i )
		{
			std::vector<double> q = state();
			if ( home && i > 0 )
			{
				q = between( m_reference, q, std::pow( 0.8, double( i ) ) );
			}
			if ( isFree( q ) )
			{
				return q;
			}
		}
		throw io::Error( m_robot_file, m_problem.group.empty() ? "robot" : "group " + m_problem.group,
		    fmt::format( "none of {} random states has more than {} m of clearance", attempts, m_settings.min_d ),
		    "give a --request whose start state is free, or lower --min-d" );
	}

	Motion motion()
	{
		Motion motion;
		motion.from = freeState();
		motion.to = state();
		const double length = motions::jointDistance( m_problem, motion.from, motion.to ),
		             most = uniform() * longest * m_extent;
		motion.to = length > most ? between( motion.from, motion.to, most / length ) : motion.to;
		return motion;
	}

	const io::Problem& m_problem;
	lw_query* m_query;
	const Settings& m_settings;
	const std::string m_robot_file;
	std::mt19937_64 m_random;
	std::vector<double> m_reference;
	double m_extent = 0;
};

// Closes in on the least clearance of a motion: each check proves that it is above a margin, or finds a state that is
// not. Every bound found is kept.
void enclose( const io::Problem& problem, lw_query* query, const Settings& settings, double most, Motion& motion )
{
	lw_edge_def def = lw_edge_def_default();
	def.flags = settings.flags;
	def.alpha = 0;
	def.slack = truth_slack;
	motion.low = 0;
	motion.high = HUGE_VAL;
	const auto ask = [&]( double margin )
	{
		def.min_d = margin;
		lw_edge_result edge;
		require(
		    lw_checker_edge( problem.checker.get(), query, motion.from.data(), motion.to.data(), &def, &edge ), "a motion" );
		if ( edge.verdict == LW_VERDICT_FREE )
		{
			motion.low = std::max( motion.low, edge.lower_bound );
			return;
		}
		motion.high = std::min(
		    motion.high, edge.verdict == LW_VERDICT_BLOCKED ? std::max( edge.pair.upper, 0.0 ) : margin + def.slack );
	};
	ask( settings.min_d );
	if ( motion.high <= settings.min_d )
	{
		return;
	}
	ask( most );
	for ( int i = 0; i < 30 && motion.low < most && motion.high - motion.low > truth_width; ++i )
	{
		ask( 0.5 * ( std::max( motion.low, settings.min_d ) + std::min( motion.high, most ) ) );
	}
}

} // namespace

Samples drawSamples( const io::Problem& problem, const Settings& settings, const std::string& robot_file )
{
	const Query query = makeQuery( problem.checker.get() );
	Samples samples = Sampler( problem, query.get(), settings, robot_file ).draw();
	for ( const std::vector<double>& q : samples.states )
	{
		lw_state_result exact;
		require( lw_checker_state( problem.checker.get(), query.get(), q.data(), settings.flags, nullptr, false, &exact ),
		    "a state" );
		samples.environment.push_back( exact.environment.upper );
		samples.self.push_back( exact.self.upper );
		samples.free_states += std::min( exact.environment.upper, exact.self.upper ) > settings.min_d;
	}
	const double most = settings.min_d + largestConservatism( settings.target );
	for ( std::size_t i = 0; i < samples.motions.size(); ++i )
	{
		enclose( problem, query.get(), settings, most, samples.motions[i] );
		samples.free_motions += samples.motions[i].low > settings.min_d;
		motions::report( settings.progress, "measuring the motions", double( i + 1 ) / double( samples.motions.size() ) );
	}
	return samples;
}

} // namespace leeway::tune
