// SPDX-License-Identifier: BSD-3-Clause
// A recorded drive before the guard: see replay.hpp.
#include "replay/replay.hpp"

#include "leeway/io/world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

namespace leeway::replay
{
namespace
{

using motions::Guard;

double microsecondsSince( std::chrono::steady_clock::time_point begin )
{
	return std::chrono::duration<double, std::micro>( std::chrono::steady_clock::now() - begin ).count();
}

/// A world and the guard of the motion in it. Events change the world. An event that it refuses leaves its objects in doubt, and the world unknown,
/// until events that it takes have named them all.
class Watched
{
public:
	Watched( const io::RobotModel& robot, const io::ProblemOptions& options, const std::vector<motions::Segment>& segments,
	    const motions::GuardSettings& settings )
	    : m_world( robot, options ), m_guard( *m_world.problem(), segments, settings )
	{
		for ( std::uint32_t i = 0; i < lw_scene_object_count( m_world.problem()->scene.get() ); ++i )
		{
			m_objects.insert( lw_scene_object_name( m_world.problem()->scene.get(), i ) );
		}
	}

	/// @param q of the robot, for objects that it takes and puts down
	/// @return false: the event is late, and left out @throws io::Error, CoreError, and the world is unknown
	bool apply( const Event& event, const std::vector<double>& q )
	{
		// frames are late by the clock of their sensor
		if ( event.kind == Event::Kind::frame ? isLate( event, q ) : event.seen < m_seen )
		{
			return false;
		}
		const std::set<std::string> named = namesOf( event );
		m_doubtful.insert( named.begin(), named.end() );
		change( event, q );
		m_guard.publish( m_world.problem()->checker, ++m_stamp );
		for ( const std::string& name : named )
		{
			m_doubtful.erase( name );
		}
		m_seen = std::max( m_seen, event.seen );
		return true;
	}
	bool isKnown() const { return m_doubtful.empty(); }
	double seen() const { return m_seen; }
	Guard& guard() { return m_guard; }
	std::shared_ptr<const io::Problem> problem() const { return m_world.problem(); }

private:
	/// The objects that an event is about. People are one: each line has all of them.
	static std::set<std::string> namesOf( const Event& event )
	{
		switch ( event.kind )
		{
		case Event::Kind::people:
			return { "people" };
		case Event::Kind::cloud:
		case Event::Kind::frame:
			return { cloud_name };
		case Event::Kind::attach:
		case Event::Kind::release:
			return { event.object };
		case Event::Kind::world:
			break;
		}
		std::set<std::string> names( event.removed.begin(), event.removed.end() );
		for ( const io::SceneObject& object : event.objects )
		{
			names.insert( object.name );
		}
		for ( const auto& [name, pose] : event.moved )
		{
			names.insert( name );
		}
		return names;
	}
	void change( const Event& event, const std::vector<double>& q )
	{
		const std::set<std::string> before = event.kind == Event::Kind::people ? m_objects : std::set<std::string>();
		for ( const std::string& name : before )
		{
			remove( name );
		}
		for ( const std::string& name : event.removed )
		{
			remove( name );
		}
		for ( const io::SceneObject& object : event.objects )
		{
			if ( m_objects.count( object.name ) > 0 )
			{
				remove( object.name );
			}
			std::vector<io::PlacedShape> shapes = object.shapes; // poses with the object's
			const lw_transform back = lw_transform_inverse( &object.pose );
			for ( io::PlacedShape& shape : shapes )
			{
				shape.pose = lw_transform_multiply( &back, &shape.pose );
			}
			m_world.add( object.name, shapes, object.pose );
			m_objects.insert( object.name );
		}
		for ( const auto& [name, pose] : event.moved )
		{
			m_world.move( name, pose );
		}
		if ( event.kind == Event::Kind::cloud )
		{
			m_cloud = std::make_unique<io::Cloud>( event.cloud );
			m_objects.insert( cloud_name );
		}
		if ( m_cloud && ( event.kind == Event::Kind::cloud || event.kind == Event::Kind::frame ) )
		{
			m_world.see( cloud_name, *m_cloud );
		}
		if ( event.kind == Event::Kind::attach )
		{
			m_world.attach( event.object, event.link, event.touch_links, q );
		}
		if ( event.kind == Event::Kind::release )
		{
			m_world.detach( event.object, q );
		}
	}
	/// Takes a frame into the cloud, without the points on the robot itself. @throws io::Error, and the world is unknown
	bool isLate( const Event& event, const std::vector<double>& q )
	{
		const std::shared_ptr<const io::Problem> problem = m_world.problem();
		const std::vector<double> state = motions::fullState( *problem, q );
		lw_cloud_frame frame = event.frame;
		( frame.depth.width > 0 ? frame.depth.data : frame.points.data ) = event.measured.data();
		frame.robot = lw_checker_robot( problem->checker.get() );
		frame.state = state.data();
		lw_diag diag{};
		const std::uint64_t late = m_cloud ? lw_cloud_get_info( m_cloud->get() ).late : 0;
		const lw_status status =
		    m_cloud ? lw_cloud_insert( m_cloud->get(), &frame, &diag, nullptr ) : LW_ERROR_INVALID_ARGUMENT;
		if ( status == LW_ERROR_STALE && lw_cloud_get_info( m_cloud->get() ).late > late )
		{
			return true;
		}
		if ( status != LW_OK )
		{
			m_doubtful.insert( cloud_name );
			throw io::Error( "log", "frame", m_cloud ? diag.message : "comes before any cloud",
			    m_cloud ? "nothing is known until the next frame that is taken" : "begin the log with a line with cloud" );
		}
		return false;
	}
	void remove( const std::string& name )
	{
		m_world.remove( name );
		m_objects.erase( name );
	}

	static constexpr const char* cloud_name = "cloud";
	io::World m_world;
	Guard m_guard;
	std::unique_ptr<io::Cloud> m_cloud;
	std::set<std::string> m_objects;
	std::uint64_t m_stamp = 0;
	std::set<std::string> m_doubtful; ///< objects of events that were refused
	double m_seen = -std::numeric_limits<double>::infinity();
};

class Driver
{
public:
	Driver( const io::RobotModel& robot, const io::ProblemOptions& options, const std::vector<motions::Segment>& segments,
	    const Log& log, const Settings& settings )
	    : m_segments( segments ), m_log( log ), m_settings( settings ), m_world( robot, options, segments, settings.guard )
	{
		const auto is_people = []( const Event& event ) { return event.kind == Event::Kind::people; };
		if ( std::any_of( log.events.begin(), log.events.end(), is_people ) )
		{
			io::ProblemOptions alone = options;
			alone.scene = nullptr;
			motions::GuardSettings guard = settings.guard;
			guard.deceleration.clear();
			m_people = std::make_unique<Watched>( robot, alone, segments, guard );
		}
		m_result.sceneries.push_back( { segments.front().begin, m_world.problem() } );
	}

	Result drive()
	{
		const double begin = m_segments.front().begin, end = m_world.guard().end();
		const auto count = static_cast<std::size_t>( std::ceil( ( end - begin ) * m_settings.rate - 1e-9 ) );
		std::size_t next = 0;
		for ( std::size_t k = 0; k <= count; ++k )
		{
			const double now = std::min( end, begin + static_cast<double>( k ) / m_settings.rate );
			for ( ; next < m_log.events.size() && m_log.events[next].time <= now; ++next )
			{
				take( m_log.events[next], now );
			}
			cycle( now );
		}
		return std::move( m_result );
	}

private:
	void take( const Event& event, double now )
	{
		Watched& watched = event.kind == Event::Kind::people ? *m_people : m_world;
		++m_result.events;
		const auto begin = std::chrono::steady_clock::now();
		try
		{
			const bool taken =
			    watched.apply( event, motions::stateAt( m_segments, std::max( event.seen, m_segments.front().begin ) ) );
			m_result.late += taken ? 0 : 1;
			if ( taken && event.kind == Event::Kind::frame )
			{
				m_result.frames.push_back( event.seen );
			}
		}
		catch ( const io::Error& error )
		{
			m_result.rejected.push_back(
			    fmt::format( "{}: {}: {}; {}", event.element, error.element(), error.problem(), error.remedy() ) );
		}
		catch ( const CoreError& error )
		{
			m_result.rejected.push_back( fmt::format( "{}: {}", event.element, error.what() ) );
		}
		m_result.publish_microseconds.push_back( microsecondsSince( begin ) );
		const double apart = ( m_world.guard().end() - m_segments.front().begin ) / most_sceneries;
		if ( event.kind != Event::Kind::people && now - m_result.sceneries.back().begin >= apart )
		{
			m_result.sceneries.push_back( { now, m_world.problem() } );
		}
	}

	/// Why nothing is known about the world; empty: it is known.
	std::string unknown( const Watched& watched, double now ) const
	{
		if ( !watched.isKnown() )
		{
			return "an event could not be taken into the world, and its objects not since";
		}
		const double age = now - watched.seen();
		return age > m_settings.stale ? fmt::format( "it was seen {:.3f} s ago, more than {} s", age, m_settings.stale )
		                              : "";
	}

	void cycle( double now )
	{
		const auto begin = std::chrono::steady_clock::now();
		Cycle cycle;
		cycle.time = now;
		const lw_guard_answer answer = m_world.guard().ask( now, m_settings.budget );
		cycle.verdict = answer.verdict;
		cycle.proved_until = answer.proved_until;
		cycle.stands = std::nan( "" );
		if ( !m_settings.guard.deceleration.empty() )
		{
			const lw_guard_answer stop = m_world.guard().stop( now );
			cycle.stands = stop.verdict == LW_VERDICT_FREE ? stop.time : cycle.stands;
		}
		if ( m_people )
		{
			cycle.scale = scaleBesidePeople( now );
		}
		cycle.microseconds = microsecondsSince( begin );
		cycle.age = now - m_world.seen();
		const std::string reason = unknown( m_world, now );
		if ( !reason.empty() )
		{
			cycle.verdict = LW_VERDICT_UNDECIDED;
			cycle.proved_until = now;
			cycle.stands = std::nan( "" );
		}
		if ( cycle.verdict != LW_VERDICT_FREE && !m_result.alarm )
		{
			raise( answer, cycle, reason );
		}
		if ( cycle.scale < m_result.least_scale )
		{
			m_result.least_scale = cycle.scale;
			m_result.least_scale_at = now;
		}
		m_result.cycles.push_back( cycle );
	}

	double scaleBesidePeople( double now )
	{
		if ( std::isinf( m_people->seen() ) || !unknown( *m_people, now ).empty() ) // nobody was looked for, or not any more
		{
			return 0;
		}
		return m_people->guard().speed( m_settings.separation, now, now - m_people->seen(), 1, m_settings.budget ).scale;
	}

	void raise( const lw_guard_answer& answer, const Cycle& cycle, const std::string& reason )
	{
		Alarm alarm;
		alarm.at = cycle.time;
		alarm.verdict = cycle.verdict;
		alarm.time = reason.empty() ? answer.time : cycle.time;
		alarm.reason = !reason.empty()                            ? "the world is unknown: " + reason
		               : answer.pair.kind == LW_CLEARANCE_UNKNOWN ? "the budget ended before the proof"
		                                                          : "";
		alarm.brake_by = std::nan( "" );
		if ( reason.empty() )
		{
			const lw_checker* checker = m_world.problem()->checker.get();
			alarm.self = answer.self;
			alarm.pair =
			    answer.self ? motions::nameSelf( checker, answer.pair ) : motions::nameEnvironment( checker, answer.pair );
			if ( !m_settings.guard.deceleration.empty() )
			{
				alarm.brake_by = m_world.guard().brakeBy( cycle.time, answer.proved_until, 1 / m_settings.rate );
			}
		}
		m_result.alarm = alarm;
	}

	const std::vector<motions::Segment>& m_segments;
	const Log& m_log;
	const Settings& m_settings;
	Watched m_world;
	std::unique_ptr<Watched> m_people;
	Result m_result;
};

} // namespace

Result replay( const io::RobotModel& robot, const io::ProblemOptions& options, const std::vector<motions::Segment>& segments,
    const Log& log, const Settings& settings )
{
	if ( segments.empty() || !( settings.rate > 0 ) || !( settings.rate <= 1e6 ) ||
	     ( segments.back().begin + segments.back().seconds - segments.front().begin ) * settings.rate > 1e8 )
	{
		throw io::Error( log.file, "rate", fmt::format( "has {} cycles per second", settings.rate ),
		    "give a rate above 0 and up to 1e6, of at most 1e8 cycles in all" );
	}
	return Driver( robot, options, segments, log, settings ).drive();
}

} // namespace leeway::replay
