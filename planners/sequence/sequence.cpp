// SPDX-License-Identifier: BSD-3-Clause
// Depth first over the goals of the legs. Lines depend on the state where they start alone, so they decide on goals before motions to these are searched.
#include "leeway/sequence/sequence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace leeway::sequence
{
namespace
{

using State = std::vector<double>;

constexpr double least_share = 0.01; // of the time: with less left no further goal is tried
constexpr std::size_t attempts_from_start = 5;

/// Legs that are planned as one: a motion to a goal, or lines with blends between them.
struct Unit
{
	std::size_t first = 0, count = 1; ///< legs
	std::optional<lines::Task> line;
	std::vector<std::size_t> leg_of; ///< of each part of the line
	bool has_goals = false;          ///< `goals` are known
	std::vector<State> goals;        ///< from which the lines behind are found
};

/// A planned unit, with times from 0.
struct Step
{
	std::size_t unit = 0;
	std::vector<motions::Segment> segments;
	State end;
	lines::Result line; ///< of lines
	std::size_t goals = 0, tried = 0;
};

std::string nameOf( const std::vector<Leg>& legs, std::size_t i )
{
	return legs[i].element.empty() ? fmt::format( "legs[{}]", i ) : legs[i].element;
}

[[noreturn]] void wrong( const std::string& element, const std::string& problem, const std::string& remedy )
{
	throw io::Error( "sequence", element, problem, remedy );
}

bool isSame( const io::Frame& a, const io::Frame& b )
{
	return a.link == b.link && std::equal( &a.pose.r[0][0], &a.pose.r[0][0] + 9, &b.pose.r[0][0] ) &&
	       std::equal( a.pose.t, a.pose.t + 3, b.pose.t );
}

bool goTogether( const lines::Task& a, const lines::Task& b )
{
	const bool axes = a.free_axis.has_value() == b.free_axis.has_value() &&
	                  ( !a.free_axis || ( a.free_axis->x == b.free_axis->x && a.free_axis->y == b.free_axis->y &&
	                                        a.free_axis->z == b.free_axis->z ) );
	return isSame( a.tip, b.tip ) && isSame( a.base, b.base ) && axes && a.tolerance == b.tolerance && a.angle == b.angle &&
	       a.speed == b.speed;
}

void check( const std::vector<Leg>& legs )
{
	for ( std::size_t i = 0; i < legs.size(); ++i )
	{
		const Leg& leg = legs[i];
		const std::string name = nameOf( legs, i );
		if ( int( !leg.goals.empty() ) + int( leg.request.has_value() ) + int( leg.line.has_value() ) != 1 )
		{
			wrong( name, "has no goal and no line, or several", "give goals, or a request, or a line" );
		}
		if ( leg.line && ( leg.line->any_start || !leg.line->start.empty() ) )
		{
			wrong( name, "is a line with a start of its own", "leave it out: it starts where the leg before ends" );
		}
		if ( leg.line && !leg.path.empty() )
		{
			wrong( name, "is a line with constraints of a motion to a goal", "give them to lines::Task::path" );
		}
		if ( !( leg.blend >= 0 && std::isfinite( leg.blend ) ) )
		{
			wrong( name, "has a blend that is no radius", "give metres, 0 or more" );
		}
		if ( leg.blend > 0 && ( i + 1 == legs.size() || !leg.line || !legs[i + 1].line ) )
		{
			wrong( name, "has a blend, and is not a line before another line",
			    "give 0: the robot rests where a motion to a goal begins or ends" );
		}
		if ( leg.blend > 0 && !( leg.line->path.empty() && legs[i + 1].line->path.empty() ) )
		{
			wrong( name, "has a blend, and one of its lines has path_constraints", "give 0, or remove them" );
		}
		if ( leg.blend > 0 && !goTogether( *leg.line, *legs[i + 1].line ) )
		{
			wrong( name, "has a blend, and the next line is of another frame, speed or tolerance",
			    "give 0, or lines of one link in one frame" );
		}
	}
	legs.empty() ? wrong( "legs", "there is none", "give one motion or more" ) : void();
}

std::vector<Unit> unitsOf( const std::vector<Leg>& legs )
{
	std::vector<Unit> units;
	for ( std::size_t i = 0; i < legs.size(); ++i )
	{
		const bool goes_on = i > 0 && legs[i - 1].blend > 0;
		if ( !goes_on )
		{
			units.push_back( { i, 0, {}, {}, false, {} } );
		}
		Unit& unit = units.back();
		++unit.count;
		if ( !legs[i].line )
		{
			continue;
		}
		const std::vector<lines::Waypoint>& waypoints = legs[i].line->waypoints;
		unit.leg_of.insert( unit.leg_of.end(), waypoints.size(), i );
		if ( !goes_on )
		{
			unit.line = legs[i].line;
			continue;
		}
		unit.line->waypoints.back().blend = legs[i - 1].blend;
		unit.line->waypoints.insert( unit.line->waypoints.end(), waypoints.begin(), waypoints.end() );
	}
	return units;
}

class Planning
{
public:
	Planning( const io::RobotModel& robot, const io::Problem& problem, const std::vector<Leg>& legs,
	    const Settings& settings, const State& start )
	    : m_robot( robot ), m_problem( problem ), m_legs( legs ), m_settings( settings ), m_units( unitsOf( legs ) )
	{
		m_result.solved = extend( 0, start );
		m_result.plan_seconds = seconds();
		if ( m_result.solved )
		{
			m_result.reason.clear();
			m_result.goals = 0;
			join();
		}
		m_result.stopped = !m_result.solved && isOver();
	}

	Result result() && { return std::move( m_result ); }

private:
	double seconds() const { return std::chrono::duration<double>( std::chrono::steady_clock::now() - m_begin ).count(); }
	double left() const { return m_settings.seconds - seconds(); }
	bool isOver() const { return left() < least_share * m_settings.seconds || ( m_settings.stop && m_settings.stop() ); }

	void fail( std::size_t leg, const std::string& reason )
	{
		if ( leg > m_result.failed )
		{
			m_result.goals = 0;
		}
		if ( leg >= m_result.failed )
		{
			m_result.failed = leg;
			m_result.reason = reason;
		}
	}

	/// A goal of an earlier leg was of no use for this one.
	void drop() { ++m_result.goals; }

	bool follow( std::size_t unit, const State& start, std::size_t attempts, Step& step )
	{
		lines::Task task = *m_units[unit].line;
		task.start = start;
		lines::Settings settings{ m_settings, attempts };
		settings.stop = [this] { return isOver(); };
		step.unit = unit;
		step.line = lines::planLines( m_robot, m_problem, task, settings );
		if ( !step.line.solved )
		{
			fail( m_units[unit].leg_of[step.line.stop.part], lines::describe( m_problem, step.line ) );
			return false;
		}
		step.segments = step.line.segments;
		step.end = endOf( step.segments );
		return true;
	}

	static State endOf( const std::vector<motions::Segment>& segments )
	{
		const motions::Segment& last = segments.back();
		const std::size_t count = last.points.size() / ( last.degree + 1 );
		return { last.points.end() - static_cast<std::ptrdiff_t>( count ), last.points.end() };
	}

	/// The lines behind a goal, and the constraints of the motion behind these.
	bool goesOn( std::size_t unit, State state )
	{
		for ( ; unit < m_units.size() && m_units[unit].line; ++unit )
		{
			Step step;
			if ( !follow( unit, state, m_settings.attempts, step ) )
			{
				return false;
			}
			state = step.end;
		}
		if ( unit < m_units.size() && !m_legs[m_units[unit].first].path.empty() )
		{
			const std::size_t leg = m_units[unit].first;
			manifold::Manifold manifold( m_robot, m_problem, m_legs[leg].path );
			const std::vector<std::string> broken = manifold.violations( state.data() );
			if ( !broken.empty() )
			{
				fail( leg, "its start breaks the constraints along its path: " + broken.front() );
				return false;
			}
		}
		return true;
	}

	/// Goals of a unit from which the next ones go on; found once.
	const std::vector<State>& goalsOf( std::size_t index )
	{
		Unit& unit = m_units[index];
		if ( unit.has_goals )
		{
			return unit.goals;
		}
		unit.has_goals = true;
		const Leg& leg = m_legs[unit.first];
		const std::vector<State> all = leg.request ? manifold::constrainedGoals( m_robot, m_problem, *leg.request, leg.path,
		                                                 m_settings.edge, m_settings.seed, m_settings.states )
		                                           : leg.goals;
		for ( const State& goal : all )
		{
			if ( isOver() )
			{
				break;
			}
			goesOn( index + 1, goal ) ? unit.goals.push_back( goal ) : drop();
		}
		return unit.goals;
	}

	/// Time for a motion: half of the rest while other goals of earlier legs wait.
	double share( bool last_choice ) const { return std::max( last_choice ? left() : left() / 2, 0.0 ); }

	bool move( std::size_t index, const State& start, const std::vector<State>& goals, bool last_choice, Step& step )
	{
		const std::size_t leg = m_units[index].first;
		manifold::Task task;
		task.start = start;
		task.goals = goals;
		manifold::Settings settings = m_settings;
		settings.seconds = share( last_choice );
		const manifold::Result plan = manifold::planPath( m_robot, m_problem, m_legs[leg].path, task, settings );
		if ( !plan.solved() )
		{
			fail( leg, manifold::summary( plan ) );
			return false;
		}
		step.unit = index;
		step.segments = plan.segments;
		step.end = plan.segments.empty() ? start : endOf( plan.segments );
		return true;
	}

	/// Whole turns of joints that wrap left out.
	double distance( const State& a, const State& b ) const
	{
		double most = 0;
		for ( std::size_t i = 0; i < a.size(); ++i )
		{
			const bool wraps = lw_robot_variable( m_problem.robot.get(), m_problem.variables[i] ).wraps;
			most = std::max( most, std::fabs( wraps ? std::remainder( a[i] - b[i], 2 * M_PI ) : a[i] - b[i] ) );
		}
		return most;
	}

	/// Plans the units from this one on. @return false: none of the goals that were tried in the time serves
	bool extend( std::size_t index, const State& start )
	{
		if ( index == m_units.size() )
		{
			return true;
		}
		Step step;
		if ( m_units[index].line )
		{
			// goalsOf() chose the start, unless the line is the first leg
			const std::size_t attempts = m_settings.attempts * ( m_steps.empty() ? attempts_from_start : 1 );
			return follow( index, start, attempts, step ) && goOn( index, std::move( step ) );
		}
		std::vector<State> goals = goalsOf( index );
		const std::size_t count = goals.size();
		m_waiting += count;
		bool found = false;
		while ( !found && !goals.empty() && !isOver() )
		{
			step = {};
			step.goals = count;
			step.tried = count - goals.size();
			if ( !move( index, start, goals, m_waiting == goals.size(), step ) )
			{
				break;
			}
			const State end = step.end;
			const auto nearest = std::min_element( goals.begin(), goals.end(),
			    [&]( const State& a, const State& b ) { return distance( a, end ) < distance( b, end ); } );
			goals.erase( nearest );
			--m_waiting;
			found = goOn( index, std::move( step ) );
			found ? void() : drop();
		}
		m_waiting -= goals.size();
		return found;
	}

	bool goOn( std::size_t index, Step step )
	{
		const State end = step.end;
		m_steps.push_back( std::move( step ) );
		if ( extend( index + 1, end ) )
		{
			return true;
		}
		m_steps.pop_back();
		return false;
	}

	/// One trajectory of all steps, with the legs' places in it.
	void join()
	{
		m_result.legs.resize( m_legs.size() );
		double begin = 0;
		for ( const Step& step : m_steps )
		{
			const Unit& unit = m_units[step.unit];
			const std::size_t first = m_result.segments.size();
			for ( std::size_t leg = unit.first; leg < unit.first + unit.count; ++leg )
			{
				Motion& motion = m_result.legs[leg];
				motion.first = first;
				motion.count = unit.line ? 0 : step.segments.size();
				motion.begin = begin;
				motion.is_line = unit.line.has_value();
				motion.position_error = step.line.position_error;
				motion.angle_error = step.line.angle_error;
				motion.goals = step.goals;
				motion.tried = step.tried;
			}
			for ( const lines::Part& part : step.line.parts )
			{
				Motion& motion = m_result.legs[unit.leg_of[part.part]];
				motion.first = motion.count == 0 ? first + part.first : motion.first;
				motion.begin = motion.count == 0 ? begin + part.begin : motion.begin;
				motion.count += part.count;
				motion.seconds = begin + part.begin + part.seconds - motion.begin;
			}
			for ( motions::Segment segment : step.segments )
			{
				segment.begin = 1e-9 * std::round( 1e9 * ( begin + segment.begin ) );
				m_result.segments.push_back( std::move( segment ) );
			}
			if ( !step.segments.empty() )
			{
				const motions::Segment& last = step.segments.back();
				const double end = 1e-9 * std::round( 1e9 * ( begin + last.begin + last.seconds ) );
				m_result.legs[unit.first].seconds = unit.line ? m_result.legs[unit.first].seconds : end - begin;
				begin = end;
			}
		}
	}

	const io::RobotModel& m_robot;
	const io::Problem& m_problem;
	const std::vector<Leg>& m_legs;
	const Settings& m_settings;
	const std::chrono::steady_clock::time_point m_begin = std::chrono::steady_clock::now();
	std::vector<Unit> m_units;
	std::vector<Step> m_steps;
	std::size_t m_waiting = 0; ///< goals of all legs that were not tried
	Result m_result;
};

} // namespace

Result planSequence( const io::RobotModel& robot, const io::Problem& problem, const std::vector<Leg>& legs,
    const Settings& settings, const std::vector<double>& start )
{
	check( legs );
	return Planning( robot, problem, legs, settings, start.empty() ? io::startState( problem ) : start ).result();
}

std::vector<Leg> legsOf( const io::Problem& problem, const io::PathConstraints& sequence, const lines::Task& line )
{
	std::vector<Leg> legs;
	for ( const io::SequenceItem& item : sequence.items )
	{
		Leg leg;
		leg.element = item.element;
		leg.blend = item.blend_radius;
		if ( item.path.way )
		{
			leg.line = lines::taskOf( problem, *item.path.way, line, sequence.file, item.element + ".req." );
			leg.line->path = item.path;
		}
		else
		{
			leg.request = item.request;
			leg.path = item.path;
		}
		legs.push_back( std::move( leg ) );
	}
	return legs;
}

std::vector<std::vector<motions::ConstraintProof>> proveLegs( const io::Problem& problem,
    const io::PathConstraints& sequence, const Result& plan, const std::vector<motions::Segment>& segments )
{
	std::vector<std::vector<motions::ConstraintProof>> proofs( plan.legs.size() );
	for ( std::size_t i = 0; i < plan.legs.size(); ++i )
	{
		const io::PathConstraints& own = sequence.items[i].path;
		const Motion& leg = plan.legs[i];
		if ( !own.empty() && leg.count > 0 )
		{
			const auto first = segments.begin() + static_cast<std::ptrdiff_t>( leg.first );
			proofs[i] =
			    motions::proveConstraints( problem, own, { first, first + static_cast<std::ptrdiff_t>( leg.count ) }, {} );
		}
	}
	return proofs;
}

} // namespace leeway::sequence
