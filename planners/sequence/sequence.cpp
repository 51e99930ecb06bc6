// SPDX-License-Identifier: BSD-3-Clause
// Depth first over the goals of the legs. Lines depend on the state where they start and on the scene alone, so they decide on goals before motions to
// these are searched. A change of the scene depends on the state in which it happens: each branch has its own scenes, which share what did not change.
// So do the joints that stand while those of another group move. States and segments here are of the plan's group; those of a leg's own group begin
// and end at Scene::narrow() and Scene::widen().
#include "leeway/sequence/sequence.hpp"
#include "sequence/groups.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <tuple>

namespace leeway::sequence
{
namespace
{

constexpr double least_share = 0.01; // of the time: with less left no further goal is tried
constexpr std::size_t attempts_from_start = 5;

/// Legs that are planned as one: a motion to a goal, or lines with blends between them.
struct Unit
{
	std::size_t first = 0, count = 1; ///< legs
	bool is_line = false;
	std::vector<std::size_t> leg_of;                    ///< of each part of the line
	std::map<const Scene*, std::vector<State>> goals{}; ///< found so far: from which the lines behind are found
};

/// A planned unit, with times from 0.
struct Step
{
	std::size_t unit = 0;
	const Scene* scene = nullptr; ///< in which it is driven
	std::vector<motions::Segment> segments;
	State end;
	lines::Result line; ///< of lines
	std::size_t goals = 0, tried = 0;
};

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

bool isLine( const Leg& leg )
{
	return leg.line || leg.way;
}

const io::PathConstraints& constraintsOf( const Leg& leg )
{
	return leg.line ? leg.line->path : leg.way ? leg.way->with.path : leg.path;
}

std::size_t partsOf( const Leg& leg )
{
	return leg.line ? leg.line->waypoints.size() : leg.way ? leg.way->way.poses.size() : 0;
}

lines::Task lineOf( const Leg& leg, const io::Problem& problem )
{
	return leg.line ? *leg.line : lines::taskOf( problem, leg.way->way, leg.way->with, leg.way->file, leg.way->element );
}

void checkBlend( const std::vector<Leg>& legs, std::size_t i )
{
	const std::string name = nameOf( legs, i );
	if ( i + 1 == legs.size() || !isLine( legs[i] ) || !isLine( legs[i + 1] ) )
	{
		wrong( name, "has a blend, and is not a line before another line",
		    "give 0: the robot rests where a motion to a goal begins or ends" );
	}
	if ( !legs[i + 1].scene.empty() )
	{
		wrong( name, "has a blend, and the scene changes before the next line",
		    "give 0: the robot rests where the scene changes" );
	}
	if ( !( constraintsOf( legs[i] ).empty() && constraintsOf( legs[i + 1] ).empty() ) )
	{
		wrong( name, "has a blend, and one of its lines has path_constraints", "give 0, or remove them" );
	}
}

void check( const std::vector<Leg>& legs )
{
	for ( std::size_t i = 0; i < legs.size(); ++i )
	{
		const Leg& leg = legs[i];
		const std::string name = nameOf( legs, i );
		if ( int( !leg.goals.empty() ) + int( leg.request.has_value() ) + int( leg.line.has_value() ) +
		         int( leg.way.has_value() ) !=
		     1 )
		{
			wrong( name, "has no goal and no line, or several", "give goals, or a request, or a line" );
		}
		if ( leg.line && ( leg.line->any_start || !leg.line->start.empty() ) )
		{
			wrong( name, "is a line with a start of its own", "leave it out: it starts where the leg before ends" );
		}
		if ( isLine( leg ) && !leg.path.empty() )
		{
			wrong( name, "is a line with constraints of a motion to a goal", "give them to lines::Task::path" );
		}
		if ( !( leg.blend >= 0 && std::isfinite( leg.blend ) ) )
		{
			wrong( name, "has a blend that is no radius", "give metres, 0 or more" );
		}
		leg.blend > 0 ? checkBlend( legs, i ) : void();
	}
	legs.empty() ? wrong( "legs", "there is none", "give one motion or more" ) : void();
}

std::vector<Unit> unitsOf( const std::vector<Leg>& legs )
{
	std::vector<Unit> units;
	for ( std::size_t i = 0; i < legs.size(); ++i )
	{
		if ( i == 0 || !( legs[i - 1].blend > 0 ) )
		{
			units.push_back( { i, 0, isLine( legs[i] ), {} } );
		}
		++units.back().count;
		units.back().leg_of.insert( units.back().leg_of.end(), partsOf( legs[i] ), i );
	}
	return units;
}

/// The line of a unit, with blends between its legs.
lines::Task lineOf( const std::vector<Leg>& legs, const Unit& unit, const io::Problem& problem )
{
	lines::Task task = lineOf( legs[unit.first], problem );
	for ( std::size_t i = unit.first + 1; i < unit.first + unit.count; ++i )
	{
		const lines::Task next = lineOf( legs[i], problem );
		if ( !goTogether( task, next ) )
		{
			wrong( nameOf( legs, i - 1 ), "has a blend, and the next line is of another frame, speed or tolerance",
			    "give 0, or lines of one link in one frame" );
		}
		task.waypoints.back().blend = legs[i - 1].blend;
		task.waypoints.insert( task.waypoints.end(), next.waypoints.begin(), next.waypoints.end() );
	}
	return task;
}

/// Why the robot cannot stand there; empty: it can.
std::string blockedBy( const io::Problem& problem, const State& state, const lw_edge_def& edge, const Leg& leg )
{
	const Query query = makeQuery( problem.checker.get() );
	const lw_state_result is =
	    motions::measure( problem.checker.get(), query.get(), state, edge.flags, nullptr, leg.scene.file, leg.element );
	for ( const bool self : { false, true } )
	{
		const bool asked = ( edge.flags & ( self ? LW_CHECK_SELF : LW_CHECK_ENVIRONMENT ) ) != 0;
		if ( asked && !( ( self ? is.self : is.environment ).lower > edge.min_d ) )
		{
			const motions::Named pair = self ? motions::nameSelf( problem.checker.get(), is.self )
			                                 : motions::nameEnvironment( problem.checker.get(), is.environment );
			return fmt::format( "{}the motion cannot begin: {} - {}, clearance {:.6g} m{}; "
			                    "touch_links and allowed_collision_matrix allow a contact that is meant",
			    leg.scene.empty() ? "" : "where the scene has changed, ", pair.first, pair.second, pair.least(),
			    pair.marginText() );
		}
	}
	return {};
}

class Planning
{
public:
	/// @param base before the first leg
	Planning(
	    const io::RobotModel& robot, Scene base, const std::vector<Leg>& legs, const Settings& settings, const State& start )
	    : m_robot( robot ), m_base( std::move( base ) ), m_legs( legs ), m_settings( settings ),
	      m_groups( groupsOf( robot, *m_base.problem, legs ) ), m_units( unitsOf( legs ) )
	{
		checkNames( start );
		m_result.solved = extend( 0, start, m_base );
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

	/// Objects, links and frames of all legs that are not there are errors at once, not where the search comes to them.
	void checkNames( const State& start ) const
	{
		std::shared_ptr<const io::World> world = m_base.world;
		for ( const Unit& unit : m_units )
		{
			const io::SceneDiff& diff = m_legs[unit.first].scene;
			world = diff.empty() ? world : io::changed( *world, diff, start );
			unit.is_line ? static_cast<void>( lineOf( m_legs, unit, world ? *world->problem() : *m_base.problem ) ) : void();
			m_groups[unit.first].empty() ? void() : checkGoal( m_legs[unit.first], m_groups[unit.first] );
		}
	}

	/// A goal of joints names all of the leg's group. Whether others stand where it wants them depends on the legs before.
	void checkGoal( const Leg& leg, const Entries& group ) const
	{
		const io::Problem& all = *m_base.problem;
		for ( const std::size_t entry : leg.request && !leg.request->hasPoseGoal() ? group : Entries() )
		{
			const std::string& name = all.variable_names[entry];
			const bool is_named = std::any_of( leg.request->goal.begin(), leg.request->goal.end(),
			    [&]( const io::JointGoal& goal ) { return goal.joint == name; } );
			if ( !is_named && !leg.request->goal_keeps_rest )
			{
				throw io::Error( leg.request->file, leg.request->goal_element,
				    fmt::format( "names no goal for {}, which is in group {}", name, leg.group ),
				    "give one joint constraint for each joint of the item's group" );
			}
		}
	}

	/// The scene of a unit that begins in this state; found once.
	/// @param before of the unit before it @return null: it cannot begin
	const Scene* enter( std::size_t unit, const Scene& before, const State& state )
	{
		const std::size_t index = m_units[unit].first;
		const bool changes = !m_legs[index].scene.empty(), same_group = m_groups[index] == before.entries;
		if ( !changes && same_group )
		{
			return &before;
		}
		const Scene* whole = before.whole != nullptr ? before.whole : &before;
		whole = changes ? &change( unit, *whole, state ) : whole;
		const Scene* scene = m_groups[index].empty() ? whole : &narrowed( unit, *whole, state );
		for ( const Scene* one : { whole, scene } )
		{
			if ( !one->blocked.empty() )
			{
				fail( index, one->blocked );
				return nullptr;
			}
		}
		return scene;
	}

	/// The scene that a unit's changes make of another one.
	const Scene& change( std::size_t unit, const Scene& whole, const State& state )
	{
		const Leg& leg = m_legs[m_units[unit].first];
		const auto [entry, is_new] = m_entered.try_emplace( { unit, &whole, state, false } );
		Scene& scene = entry->second;
		if ( is_new )
		{
			scene.world = io::changed( *whole.world, leg.scene, state );
			scene.problem = scene.world->problem();
			scene.blocked = blockedBy( *scene.problem, state, m_settings.edge, leg );
		}
		return scene;
	}

	/// The same scene for the unit's group, with the other joints as they are in the state.
	const Scene& narrowed( std::size_t unit, const Scene& whole, const State& state )
	{
		const std::size_t index = m_units[unit].first;
		const auto [entry, is_new] = m_entered.try_emplace( { unit, &whole, state, true } );
		Scene& scene = entry->second;
		if ( is_new )
		{
			scene.world = whole.world;
			scene.problem = whole.world->problemOf( m_robot, m_legs[index].group, state );
			scene.entries = m_groups[index];
			scene.stands = state;
			scene.whole = &whole;
			// pairs that the group does not move are those of the start, or of a leg before that moved them
			scene.blocked = unit == 0 ? blockedBy( *whole.problem, state, m_settings.edge, m_legs[index] ) : "";
		}
		return scene;
	}

	/// A goal of an earlier leg was of no use for this one.
	void drop() { ++m_result.goals; }

	bool follow( std::size_t unit, const State& start, const Scene& scene, std::size_t attempts, Step& step )
	{
		lines::Task task = lineOf( m_legs, m_units[unit], *scene.problem );
		task.start = scene.narrow( start );
		lines::Settings settings{ m_settings, attempts };
		settings.limits = scene.narrow( m_settings.limits );
		settings.stop = [this] { return isOver(); };
		step.unit = unit;
		step.scene = &scene;
		step.line = lines::planLines( m_robot, *scene.problem, task, settings );
		if ( !step.line.solved )
		{
			fail( m_units[unit].leg_of[step.line.stop.part], lines::describe( *scene.problem, step.line ) );
			return false;
		}
		step.segments = scene.widen( step.line.segments );
		step.end = endOf( step.segments );
		return true;
	}

	static State endOf( const std::vector<motions::Segment>& segments )
	{
		const motions::Segment& last = segments.back();
		const std::size_t count = last.points.size() / ( last.degree + 1 );
		return { last.points.end() - static_cast<std::ptrdiff_t>( count ), last.points.end() };
	}

	/// The lines behind a goal, the scenes in which they begin, and the constraints of the motion behind these.
	bool goesOn( std::size_t unit, State state, const Scene& scene )
	{
		const Scene* own = &scene;
		for ( ; unit < m_units.size(); ++unit )
		{
			own = enter( unit, *own, state );
			if ( own == nullptr || !m_units[unit].is_line )
			{
				break;
			}
			Step step;
			if ( !follow( unit, state, *own, m_settings.attempts, step ) )
			{
				return false;
			}
			state = step.end;
		}
		if ( own != nullptr && unit < m_units.size() && !m_legs[m_units[unit].first].path.empty() )
		{
			const std::size_t leg = m_units[unit].first;
			manifold::Manifold manifold( m_robot, *own->problem, m_legs[leg].path );
			const std::vector<std::string> broken = manifold.violations( own->narrow( state ).data() );
			if ( !broken.empty() )
			{
				fail( leg, "its start breaks the constraints along its path: " + broken.front() );
				return false;
			}
		}
		return own != nullptr;
	}

	/// States of a leg's goal, with or without a way on.
	std::vector<State> statesOf( std::size_t index, const Scene& scene )
	{
		const Leg& leg = m_legs[index];
		std::vector<State> states = leg.goals;
		try
		{
			states = !leg.request ? states
			                      : manifold::constrainedGoals( m_robot, *scene.problem, *leg.request, leg.path,
			                            m_settings.edge, m_settings.seed, m_settings.states );
		}
		catch ( const io::Error& error )
		{
			if ( &scene == &m_base || ( index == 0 && scene.whole == &m_base ) )
			{
				throw;
			}
			fail( index, error.what() ); // in the scene of another branch the goal may have states
		}
		std::transform(
		    states.begin(), states.end(), states.begin(), [&]( const State& state ) { return scene.widen( state ); } );
		return states;
	}

	/// Goals of a unit from which the next ones go on; found once in each scene.
	const std::vector<State>& goalsOf( std::size_t index, const Scene& scene )
	{
		Unit& unit = m_units[index];
		const auto [entry, is_new] = unit.goals.try_emplace( &scene );
		std::vector<State>& goals = entry->second;
		const std::vector<State> all = is_new ? statesOf( unit.first, scene ) : std::vector<State>();
		for ( const State& goal : all )
		{
			if ( isOver() )
			{
				break;
			}
			goesOn( index + 1, goal, scene ) ? goals.push_back( goal ) : drop();
		}
		return goals;
	}

	/// Time for a motion: half of the rest while other goals of earlier legs wait.
	double share( bool last_choice ) const { return std::max( last_choice ? left() : left() / 2, 0.0 ); }

	bool move( std::size_t index, const State& start, const Scene& scene, const std::vector<State>& goals, bool last_choice,
	    Step& step )
	{
		const std::size_t leg = m_units[index].first;
		step.unit = index;
		step.scene = &scene;
		manifold::Task task;
		task.start = scene.narrow( start );
		for ( const State& goal : goals )
		{
			task.goals.push_back( scene.narrow( goal ) );
		}
		manifold::Settings settings = m_settings;
		settings.limits = scene.narrow( m_settings.limits );
		settings.seconds = share( last_choice );
		const manifold::Result plan = manifold::planPath( m_robot, *scene.problem, m_legs[leg].path, task, settings );
		if ( !plan.solved() )
		{
			fail( leg, manifold::summary( plan ) );
			return false;
		}
		step.segments = scene.widen( plan.segments );
		step.end = plan.segments.empty() ? start : endOf( step.segments );
		return true;
	}

	/// Whole turns of joints that wrap left out.
	double distance( const State& a, const State& b ) const
	{
		double most = 0;
		for ( std::size_t i = 0; i < a.size(); ++i )
		{
			const io::Problem& problem = *m_base.problem;
			const bool wraps = lw_robot_variable( problem.robot.get(), problem.variables[i] ).wraps;
			most = std::max( most, std::fabs( wraps ? std::remainder( a[i] - b[i], 2 * M_PI ) : a[i] - b[i] ) );
		}
		return most;
	}

	/// Plans the units from this one on. @return false: none of the goals that were tried in the time serves
	/// @param before the scene in which the unit before this one is driven
	bool extend( std::size_t index, const State& start, const Scene& before )
	{
		if ( index == m_units.size() )
		{
			return true;
		}
		const Scene* scene = enter( index, before, start );
		if ( scene == nullptr )
		{
			return false;
		}
		Step step;
		if ( m_units[index].is_line )
		{
			// goalsOf() chose the start, unless the line is the first leg
			const std::size_t attempts = m_settings.attempts * ( m_steps.empty() ? attempts_from_start : 1 );
			return follow( index, start, *scene, attempts, step ) && goOn( index, std::move( step ) );
		}
		std::vector<State> goals = goalsOf( index, *scene );
		const std::size_t count = goals.size();
		m_waiting += count;
		bool found = false;
		while ( !found && !goals.empty() && !isOver() )
		{
			step = {};
			step.goals = count;
			step.tried = count - goals.size();
			if ( !move( index, start, *scene, goals, m_waiting == goals.size(), step ) )
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
		const Scene& scene = *step.scene;
		m_steps.push_back( std::move( step ) );
		if ( extend( index + 1, end, scene ) )
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
				motion.count = unit.is_line ? 0 : step.segments.size();
				motion.begin = begin;
				motion.is_line = unit.is_line;
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
				m_result.legs[unit.first].seconds = unit.is_line ? m_result.legs[unit.first].seconds : end - begin;
				begin = end;
			}
		}
	}

	const io::RobotModel& m_robot;
	const Scene m_base;
	const std::vector<Leg>& m_legs;
	const Settings& m_settings;
	const std::chrono::steady_clock::time_point m_begin = std::chrono::steady_clock::now();
	const std::vector<Entries> m_groups; ///< of each leg
	std::vector<Unit> m_units;
	/// By unit, scene before it, state, and whether it is of the unit's own group; none is removed, for later ones point to it.
	std::map<std::tuple<std::size_t, const Scene*, State, bool>, Scene> m_entered;
	std::vector<Step> m_steps;
	std::size_t m_waiting = 0; ///< goals of all legs that were not tried
	Result m_result;
};

} // namespace

Result planSequence( const io::RobotModel& robot, const io::World& world, const std::vector<Leg>& legs,
    const Settings& settings, const std::vector<double>& start )
{
	check( legs );
	const auto copy = std::make_shared<const io::World>( world );
	const Scene base{ copy, copy->problem() };
	return Planning( robot, base, legs, settings, start.empty() ? io::startState( *base.problem ) : start ).result();
}

Result planSequence( const io::RobotModel& robot, const io::Problem& problem, const std::vector<Leg>& legs,
    const Settings& settings, const std::vector<double>& start )
{
	check( legs );
	const std::vector<Entries> groups = groupsOf( robot, problem, legs );
	for ( std::size_t i = 0; i < legs.size(); ++i )
	{
		legs[i].scene.empty()
		    ? void()
		    : wrong( nameOf( legs, i ), "changes the scene of a problem, which stays as it is", "plan in an io::World" );
		groups[i].empty() ? void()
		                  : wrong( nameOf( legs, i ), "is of another group than the problem", "plan in an io::World" );
	}
	const Scene base{ nullptr, std::shared_ptr<const io::Problem>( std::shared_ptr<const io::Problem>(), &problem ) };
	return Planning( robot, base, legs, settings, start.empty() ? io::startState( problem ) : start ).result();
}

std::vector<Leg> legsOf( const io::PathConstraints& sequence, const lines::Task& line )
{
	std::vector<Leg> legs;
	for ( const io::SequenceItem& item : sequence.items )
	{
		Leg leg;
		leg.element = item.element;
		leg.group = item.request.group;
		leg.blend = item.blend_radius;
		leg.scene = item.scene;
		if ( item.path.way )
		{
			leg.way = Way{ *item.path.way, line, sequence.file, item.element + ".req." };
			leg.way->with.path = item.path;
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

} // namespace leeway::sequence
