// SPDX-License-Identifier: BSD-3-Clause
// Inverse kinematics: free states of a group in which links have the poses that a goal asks for.
#include "leeway/ik/goal_states.hpp"

#include "ik/goal_test.hpp"
#include "ik/random.hpp"
#include "ik/solver.hpp"

#include <fmt/format.h>

#include <map>

namespace leeway::ik
{
namespace
{

// Two states that differ by less than this in every variable count as one.
constexpr double same_state = 0.02;
// Searches without joint limits that follow if no search within them succeeds.
constexpr std::size_t unlimited_searches = 200;
// States in collision whose pairs are named.
constexpr std::size_t most_blamed = 64;

using State = std::vector<double>;

class Search
{
public:
	Search( const io::RobotModel& robot, const io::Problem& problem, const io::Request& request, const Options& options );
	GoalStates run();

private:
	void bind();
	void setBounds( const std::vector<Interval>& intervals );
	void requireMovable();
	State drawn( std::size_t search );
	void collect();
	bool keep( State& q );
	bool isNew( const State& q ) const;
	double difference( std::size_t variable, double a, double b ) const;
	double distanceToStart( const State& q ) const;
	void wrapAngles( State& q ) const;
	void explain();
	bool explainLimits();
	void explainCollision();
	std::string describeBest() const;

	const io::Problem& m_problem;
	const io::Request& m_request;
	const Options& m_options;
	GoalParts m_parts;
	GoalTest m_goal_test;
	Chain m_chain;
	BoundGoal m_goal;
	std::optional<Solver> m_solver;
	Random m_random;
	Query m_query;
	State m_start;
	std::vector<State> m_blocked; ///< the first most_blamed
	Excess m_best;
	GoalStates m_result;
};

Search::Search( const io::RobotModel& robot, const io::Problem& problem, const io::Request& request, const Options& options )
    : m_problem( problem ), m_request( request ), m_options( options ), m_parts( goalParts( problem, request ) ),
      m_goal_test( problem, request, m_parts ), m_chain( robot, problem ), m_random( options.seed ),
      m_query( makeQuery( problem.checker.get() ) ), m_start( io::startState( problem ) )
{
	m_best.metres = HUGE_VAL;
	bind();
	setBounds( m_parts.joints );
	m_solver.emplace( m_chain, m_goal );
	requireMovable();
}

void Search::bind()
{
	for ( std::size_t i = 0; i < m_request.goal_positions.size(); ++i )
	{
		const ConstraintPlaces& places = m_parts.positions[i];
		const ChainFrame link = m_chain.add( places.link ), frame = m_chain.add( places.frame );
		m_goal.positions.push_back( { PositionConstraint( m_request.goal_positions[i] ), link, frame } );
	}
	for ( std::size_t i = 0; i < m_request.goal_orientations.size(); ++i )
	{
		const ConstraintPlaces& places = m_parts.orientations[i];
		const ChainFrame link = m_chain.add( places.link ), frame = m_chain.add( places.frame );
		m_goal.orientations.push_back( { OrientationConstraint( m_request.goal_orientations[i] ), link, frame } );
	}
}

void Search::setBounds( const std::vector<Interval>& intervals )
{
	const std::vector<Freedom>& freedoms = m_chain.freedoms();
	const auto count = static_cast<Eigen::Index>( freedoms.size() );
	m_goal.bounds =
	    m_goal.draw = { Eigen::VectorXd::Constant( count, -HUGE_VAL ), Eigen::VectorXd::Constant( count, HUGE_VAL ) };
	for ( std::size_t i = 0; i < freedoms.size(); ++i )
	{
		const auto k = static_cast<Eigen::Index>( i );
		if ( freedoms[i].turn >= 0 )
		{
			continue;
		}
		Interval interval = intervals[freedoms[i].variable];
		double start = m_start[freedoms[i].variable];
		if ( interval.wraps && std::isfinite( interval.lower ) ) // the turn that is nearest to the joint constraint
		{
			const double middle = 0.5 * ( interval.lower + interval.upper );
			start = middle + wrapped( start - middle );
		}
		start = std::clamp( start, interval.lower, interval.upper );
		m_start[freedoms[i].variable] = start;
		m_goal.bounds.lower[k] = interval.lower;
		m_goal.bounds.upper[k] = interval.upper;
		if ( interval.upper - interval.lower > far_limits )
		{
			const double distance = interval.wraps ? pi : draw_distance;
			interval.lower = std::max( interval.lower, start - distance );
			interval.upper = std::min( interval.upper, start + distance );
		}
		m_goal.draw.lower[k] = m_chain.moves( i ) ? interval.lower : start;
		m_goal.draw.upper[k] = m_chain.moves( i ) ? interval.upper : start;
	}
}

/// A constraint on a link that no joint of the group moves holds already, or never will.
void Search::requireMovable()
{
	const auto require_movable = [&]( const auto& bound, const auto& goal )
	{
		const double excess = bound.constraint.excess( m_chain.pose( bound.link ), m_chain.pose( bound.frame ) );
		if ( bound.link.joint == bound.frame.joint && excess > excess_rounding )
		{
			throw io::Error( goalFile( m_request ), goalElement( m_request, goal.element ),
			    fmt::format( "{} cannot move link {} in the frame of the constraint",
			        m_problem.group.empty() ? "the robot" : "group " + m_problem.group, goal.link ),
			    "name a link that it moves, or plan for another group" );
		}
	};
	m_chain.place( m_start.data() );
	for ( std::size_t i = 0; i < m_goal.positions.size(); ++i )
	{
		require_movable( m_goal.positions[i], m_request.goal_positions[i] );
	}
	for ( std::size_t i = 0; i < m_goal.orientations.size(); ++i )
	{
		require_movable( m_goal.orientations[i], m_request.goal_orientations[i] );
	}
}

/// The first search begins at the start state.
State Search::drawn( std::size_t search )
{
	State q = m_start;
	if ( search > 0 )
	{
		draw( m_chain.freedoms(), m_chain.moves(), m_goal.draw, m_random, draw_shares[search % std::size( draw_shares )],
		    q.data() );
	}
	return q;
}

double Search::difference( std::size_t variable, double a, double b ) const
{
	return m_parts.limits[variable].wraps ? wrapped( a - b ) : a - b;
}

double Search::distanceToStart( const State& q ) const
{
	double sum = 0;
	for ( std::size_t i = 0; i < q.size(); ++i )
	{
		sum += std::pow( difference( i, q[i], m_start[i] ), 2 );
	}
	return sum;
}

bool Search::isNew( const State& q ) const
{
	return std::none_of( m_result.states.begin(), m_result.states.end(),
	    [&]( const State& known )
	    {
		    bool same = true;
		    for ( std::size_t i = 0; i < q.size(); ++i )
		    {
			    same = same && std::fabs( difference( i, q[i], known[i] ) ) < same_state;
		    }
		    return same;
	    } );
}

void Search::wrapAngles( State& q ) const
{
	for ( std::size_t i = 0; i < q.size(); ++i )
	{
		q[i] = m_parts.limits[i].wraps ? wrapped( q[i] ) : q[i];
	}
}

/// A solution of the solver counts if the engine agrees and the checker proves it free. @return true if it is a new one
bool Search::keep( State& q )
{
	wrapAngles( q );
	if ( !m_goal_test.reaches( q.data() ) )
	{
		return false;
	}
	++m_result.reached;
	bool free = false;
	require( lw_checker_is_free(
	             m_problem.checker.get(), m_query.get(), q.data(), m_options.flags, m_options.min_d, &free, nullptr ),
	    "check of a goal state" );
	if ( !free )
	{
		++m_result.blocked;
		if ( m_blocked.size() < most_blamed )
		{
			m_blocked.push_back( q );
		}
		return false;
	}
	const bool fresh = isNew( q );
	if ( fresh )
	{
		m_result.states.push_back( q );
	}
	return fresh;
}

void Search::collect()
{
	std::size_t in_vain = 0;
	while (
	    m_result.states.size() < m_options.states && m_result.searches < m_options.searches && in_vain < m_options.patience )
	{
		State q = drawn( m_result.searches++ );
		const bool solved = m_solver->solve( m_random, q.data() );
		if ( solved && keep( q ) )
		{
			in_vain = 0;
			continue;
		}
		in_vain += m_result.states.empty() ? 0 : 1;
		const Excess excess = solved ? Excess() : m_solver->excess( q.data() );
		if ( excess.sum() < m_best.sum() )
		{
			m_best = excess;
		}
	}
}

GoalStates Search::run()
{
	collect();
	std::stable_sort( m_result.states.begin(), m_result.states.end(),
	    [this]( const State& a, const State& b ) { return distanceToStart( a ) < distanceToStart( b ); } );
	if ( m_result.reached == 0 )
	{
		m_result.best_metres = m_best.metres;
		m_result.best_radians = m_best.radians;
	}
	if ( m_result.states.empty() )
	{
		explain();
	}
	return std::move( m_result );
}

// ---- why there is none

std::string Search::describeBest() const
{
	std::string text;
	if ( m_best.metres > excess_rounding )
	{
		text = fmt::format( "{:.3g} mm outside of the region of link {}", 1000 * m_best.metres,
		    m_request.goal_positions[m_best.position].link );
	}
	if ( m_best.radians > excess_rounding )
	{
		text += fmt::format( "{}{:.3g} rad beyond the tolerance of the orientation of link {}", text.empty() ? "" : " and ",
		    m_best.radians, m_request.goal_orientations[m_best.orientation].link );
	}
	return text;
}

void Search::explain()
{
	if ( m_result.reached > 0 )
	{
		explainCollision();
		return;
	}
	if ( explainLimits() )
	{
		return;
	}
	m_result.failure = Failure::UNREACHABLE;
	m_result.problem = fmt::format( "no state of {} reaches it: the best of {} searches ends {}",
	    m_problem.group.empty() ? "the robot" : "group " + m_problem.group, m_result.searches, describeBest() );
	m_result.remedy = std::string( "move the goal nearer, widen its tolerances" ) +
	                  ( m_request.goal.empty() ? "" : ", remove its joint constraints" ) +
	                  ", or plan for a group with more joints";
}

/// Searches on with all limits of joints without a constraint lifted. @return true if that succeeds
bool Search::explainLimits()
{
	std::vector<Interval> lifted = m_parts.joints;
	for ( std::size_t i = 0; i < lifted.size(); ++i )
	{
		const bool constrained = lifted[i].lower != m_parts.limits[i].lower || lifted[i].upper != m_parts.limits[i].upper;
		lifted[i] = constrained ? lifted[i] : Interval{ -HUGE_VAL, HUGE_VAL, lifted[i].wraps };
	}
	setBounds( lifted );
	double least = HUGE_VAL;
	std::string text;
	for ( std::size_t i = 0; i < unlimited_searches; ++i )
	{
		State q = drawn( i );
		if ( !m_solver->solve( m_random, q.data() ) )
		{
			continue;
		}
		double beyond = 0;
		std::string lines;
		for ( std::size_t k = 0; k < q.size(); ++k )
		{
			const Interval& limits = m_parts.limits[k];
			const double inside = std::clamp( q[k], limits.lower, limits.upper );
			if ( inside != q[k] )
			{
				beyond += std::fabs( q[k] - inside );
				lines += fmt::format( "{}joint {} at {:.4g}, {} its limit {:.4g}", lines.empty() ? "" : ", ",
				    m_problem.variable_names[k], q[k], q[k] < inside ? "below" : "above", inside );
			}
		}
		if ( beyond > 0 && beyond < least )
		{
			least = beyond;
			text = lines;
		}
	}
	if ( text.empty() )
	{
		return false;
	}
	m_result.failure = Failure::OUT_OF_LIMITS;
	m_result.problem = fmt::format(
	    "it is reached only outside of the joint limits, with {}; the best of {} searches within the limits ends {}", text,
	    m_result.searches, describeBest() );
	m_result.remedy = "choose another pose, or plan for a group with more joints";
	return true;
}

void Search::explainCollision()
{
	const lw_checker* const checker = m_problem.checker.get();
	std::map<std::string, std::size_t> pairs;
	for ( const State& q : m_blocked )
	{
		bool free = false;
		lw_state_reason reason;
		require( lw_checker_is_free( checker, m_query.get(), q.data(), m_options.flags, m_options.min_d, &free, &reason ),
		    "check of a goal state" );
		if ( reason.pair.kind != LW_CLEARANCE_UNKNOWN )
		{
			const lw_robot* const robot = m_problem.robot.get();
			++pairs[std::string( lw_robot_link_name( robot, reason.pair.a ) ) + " - " +
			        ( reason.self ? lw_robot_link_name( robot, reason.pair.b )
			                      : lw_scene_object_name( m_problem.scene.get(), reason.pair.b ) )];
		}
	}
	std::vector<std::pair<std::string, std::size_t>> sorted( pairs.begin(), pairs.end() );
	std::stable_sort( sorted.begin(), sorted.end(), []( const auto& a, const auto& b ) { return a.second > b.second; } );
	std::string text;
	for ( std::size_t i = 0; i < std::min<std::size_t>( sorted.size(), 3 ); ++i )
	{
		text += fmt::format( "{}{} ({} of {})", i > 0 ? ", " : "", sorted[i].first, sorted[i].second, m_blocked.size() );
	}
	m_result.failure = Failure::IN_COLLISION;
	m_result.problem = fmt::format( "of {} states that reach it none is free{}: {}", m_result.reached,
	    m_options.min_d > 0 ? fmt::format( " with more than {} m of clearance", m_options.min_d ) : "", text );
	m_result.remedy = "move the object or the goal, widen its tolerances, or allow contact of the pair";
}

} // namespace

GoalStates findGoalStates(
    const io::RobotModel& robot, const io::Problem& problem, const io::Request& request, const Options& options )
{
	return Search( robot, problem, request, options ).run();
}

std::vector<std::string> goalViolations( const io::Problem& problem, const io::Request& request, const double* q )
{
	const GoalParts parts = goalParts( problem, request );
	return GoalTest( problem, request, parts ).violations( q );
}

} // namespace leeway::ik
