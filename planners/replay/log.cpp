// SPDX-License-Identifier: BSD-3-Clause
// Lines of a log: see log.hpp. Objects are MoveIt's CollisionObjects, read as those of a scene.
#include "referee/arrays.hpp"
#include "replay/log.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>

namespace leeway::replay
{
namespace
{

using nlohmann::json;

class LineReader
{
public:
	LineReader( Log& log, const io::LoadOptions& options, std::size_t number )
	    : m_log( log ), m_options( options ), m_element( fmt::format( "line {}", number ) )
	{
	}

	Event read( const std::string& text )
	{
		const json line = json::parse( text, nullptr, false );
		if ( line.is_discarded() || !line.is_object() )
		{
			fail( "", "is no JSON object", "write one object in each line, such as {\"t\": 0.5, \"world\": {...}}" );
		}
		Event event;
		event.element = m_element;
		const std::string kind = kindOf( line );
		event.time = number( line, "t" );
		event.seen = line.contains( "seen" ) ? number( line, "seen" ) : event.time;
		if ( event.seen > event.time )
		{
			fail( "seen", fmt::format( "is {} s, after t = {} s", event.seen, event.time ),
			    "give the time at which the sensor saw it" );
		}
		if ( kind == "world" || kind == "people" )
		{
			event.kind = kind == "world" ? Event::Kind::world : Event::Kind::people;
			readObjects( line[kind], kind, event );
		}
		else if ( kind == "cloud" )
		{
			event.kind = Event::Kind::cloud;
			readCloud( line[kind], event.cloud );
		}
		else if ( kind == "frame" )
		{
			event.kind = Event::Kind::frame;
			readFrame( line[kind], event );
		}
		else if ( kind == "attach" || kind == "release" )
		{
			event.kind = kind == "attach" ? Event::Kind::attach : Event::Kind::release;
			event.object = text_of( line, kind );
			event.link = kind == "attach" ? text_of( line, "link" ) : "";
			readTouchLinks( line, event );
		}
		return event;
	}

private:
	[[noreturn]] void fail( const std::string& key, const std::string& problem, const std::string& remedy ) const
	{
		throw io::Error( m_log.file, key.empty() ? m_element : m_element + ": " + key, problem, remedy );
	}
	/// The key of the line's kind; empty: all was seen, and is as before. Keys that do not go with it are errors.
	std::string kindOf( const json& line ) const
	{
		std::string kind;
		for ( const char* one : { "world", "people", "attach", "release", "cloud", "frame" } )
		{
			if ( line.contains( one ) )
			{
				if ( !kind.empty() )
				{
					fail( one, "is in one line with " + kind, "make two lines of it" );
				}
				kind = one;
			}
		}
		for ( const auto& [key, value] : line.items() )
		{
			const bool of_attach = kind == "attach" && ( key == "link" || key == "touch_links" );
			if ( key != kind && key != "t" && key != "seen" && !of_attach )
			{
				fail( key, "is unknown here",
				    "a line has t, perhaps seen, and one of world, people, cloud, frame, attach (with link) and release" );
			}
		}
		return kind;
	}
	double number( const json& line, const std::string& key ) const
	{
		const auto found = line.find( key );
		if ( found == line.end() || !found->is_number() || !std::isfinite( found->get<double>() ) )
		{
			fail( key, "is missing or no finite number", "give seconds" );
		}
		return found->get<double>();
	}
	std::string text_of( const json& line, const std::string& key ) const
	{
		const auto found = line.find( key );
		if ( found == line.end() || !found->is_string() || found->get<std::string>().empty() )
		{
			fail( key, "is missing or no name", "give a name" );
		}
		return found->get<std::string>();
	}
	void readTouchLinks( const json& line, Event& event ) const
	{
		for ( const json& name : line.value( "touch_links", json::array() ) )
		{
			if ( !name.is_string() )
			{
				fail( "touch_links", "is no list of names", "give a list of links" );
			}
			event.touch_links.push_back( name );
		}
	}
	/// Numbers of a list. @param out [count]
	void numbers( const json& object, const std::string& key, std::size_t count, double* out ) const
	{
		const json list = object.value( key, json() );
		const bool right = list.is_array() && list.size() == count &&
		                   std::all_of( list.begin(), list.end(), []( const json& one ) { return one.is_number(); } );
		if ( !right )
		{
			fail( key, "is missing or no list of numbers", fmt::format( "give {} numbers", count ) );
		}
		for ( std::size_t i = 0; i < count; ++i )
		{
			out[i] = list[i];
		}
	}
	void refuseUnknown( const json& object, const std::string& of, const std::set<std::string>& known ) const
	{
		if ( !object.is_object() )
		{
			fail( of, "is no object", "write {...}" );
		}
		for ( const auto& [key, value] : object.items() )
		{
			if ( known.count( key ) == 0 )
			{
				fail( key, "is unknown in " + of, "use " + fmt::format( "{}", fmt::join( known, ", " ) ) );
			}
		}
	}
	void readCloud( const json& cloud, lw_cloud_def& def ) const
	{
		refuseUnknown( cloud, "cloud", { "resolution", "box_min", "box_max", "shadow", "unseen_blocked", "sensor_error" } );
		numbers( cloud, "box_min", 3, def.box_min );
		numbers( cloud, "box_max", 3, def.box_max );
		def.resolution = number( cloud, "resolution" );
		def.shadow = cloud.contains( "shadow" ) ? number( cloud, "shadow" ) : def.shadow;
		def.sensor_error = cloud.contains( "sensor_error" ) ? number( cloud, "sensor_error" ) : def.sensor_error;
		if ( cloud.contains( "unseen_blocked" ) && !cloud["unseen_blocked"].is_boolean() )
		{
			fail( "unseen_blocked", "is no truth value", "write true or false" );
		}
		def.unseen_blocked = cloud.value( "unseen_blocked", false );
	}
	/// The array of a file beside the log.
	std::vector<std::vector<double>> arrayOf( const json& frame, const std::string& key ) const
	{
		const std::string file = ( std::filesystem::path( m_log.file ).parent_path() / text_of( frame, key ) ).string();
		std::vector<std::vector<std::vector<double>>> read = referee::readNpy( file );
		if ( read.size() != 1 )
		{
			throw io::Error( file, "array", "has three dimensions", "write one array of two in a file" );
		}
		return std::move( read.front() );
	}
	void readFrame( const json& frame, Event& event )
	{
		refuseUnknown( frame, "frame", { "depth", "points", "camera", "pose", "sensor", "near", "far" } );
		const bool is_depth = frame.contains( "depth" );
		if ( is_depth == frame.contains( "points" ) )
		{
			fail( "frame", "has neither depth nor points, or both", "name one file of NumPy" );
		}
		const std::vector<std::vector<double>> rows = arrayOf( frame, is_depth ? "depth" : "points" );
		const std::size_t width = rows.empty() ? 0 : rows.front().size();
		if ( rows.empty() || ( !is_depth && width != 3 ) )
		{
			fail( "frame", "has an array of another shape", "write depths [rows][columns], or points [n][3]" );
		}
		for ( const std::vector<double>& row : rows )
		{
			event.measured.insert( event.measured.end(), row.begin(), row.end() );
		}
		json object = { { "id", "sensor" } };
		if ( frame.contains( "pose" ) )
		{
			object["pose"] = frame["pose"];
		}
		event.frame.world_from_sensor = poseOf( object );
		event.frame.stamp = event.seen;
		event.frame.sensor =
		    frame.contains( "sensor" ) ? static_cast<std::uint32_t>( std::max( 0.0, number( frame, "sensor" ) ) ) : 0;
		event.frame.near = frame.contains( "near" ) ? number( frame, "near" ) : event.frame.near;
		event.frame.far = frame.contains( "far" ) ? number( frame, "far" ) : event.frame.far;
		lay( frame, is_depth, rows.size(), width, event );
	}
	/// The layout of the frame's data.
	void lay( const json& frame, bool is_depth, std::size_t height, std::size_t width, Event& event ) const
	{
		if ( is_depth )
		{
			double camera[4];
			numbers( frame, "camera", 4, camera );
			lw_cloud_depth& depth = event.frame.depth;
			depth.width = static_cast<std::uint32_t>( width );
			depth.height = static_cast<std::uint32_t>( height );
			depth.row_step = width * sizeof( float );
			depth.is_float = true;
			depth.scale = 1;
			depth.fx = camera[0];
			depth.fy = camera[1];
			depth.cx = camera[2];
			depth.cy = camera[3];
			return;
		}
		lw_cloud_points& points = event.frame.points;
		points.width = static_cast<std::uint32_t>( height );
		points.height = 1;
		points.point_step = 3 * sizeof( float );
		points.row_step = points.point_step * height;
		for ( std::size_t k = 0; k < 3; ++k )
		{
			points.offset[k] = k * sizeof( float );
		}
	}
	/// The pose of an object, which has a shape only to have one.
	lw_transform poseOf( json object )
	{
		object["primitives"] = json::array( { { { "type", "sphere" }, { "dimensions", { 1.0 } } } } );
		object["primitive_poses"] = json::array( { { { "position", { 0, 0, 0 } }, { "orientation", { 0, 0, 0, 1 } } } } );
		return parse( object ).pose;
	}
	/// Objects of a PlanningSceneWorld.
	void readObjects( const json& world, const std::string& key, Event& event )
	{
		if ( !world.is_object() || !world.value( "collision_objects", json() ).is_array() || world.size() != 1 )
		{
			fail( key, "is no world of collision_objects alone",
			    "write {\"collision_objects\": [...]}, a list that may be empty" );
		}
		std::set<std::string> names;
		for ( const json& object : world["collision_objects"] )
		{
			const std::string id = object.is_object() ? text_of( object, "id" ) : "";
			if ( !names.insert( id ).second )
			{
				fail( key, fmt::format( "object '{}' is there twice", id ), "name it once in a line" );
			}
			readObject( object, id, event );
		}
	}
	void readObject( json object, const std::string& id, Event& event )
	{
		const json operation = object.value( "operation", json( 0 ) );
		object.erase( "operation" );
		if ( operation == 0 || operation == "ADD" )
		{
			event.objects.push_back( parse( object ) );
		}
		else if ( event.kind == Event::Kind::world && ( operation == 1 || operation == "REMOVE" ) )
		{
			event.removed.push_back( id );
		}
		else if ( event.kind == Event::Kind::world && ( operation == 3 || operation == "MOVE" ) )
		{
			if ( !object.contains( "pose" ) )
			{
				fail( id, "moves, and has no pose", "give the pose of the object" );
			}
			event.moved.emplace_back( id, poseOf( { { "id", id }, { "pose", object["pose"] } } ) );
		}
		else
		{
			fail( id, fmt::format( "operation {} is none of its kind", operation.dump() ),
			    event.kind == Event::Kind::world ? "use ADD (0), REMOVE (1) or MOVE (3)"
			                                     : "people have no operation: a line has all of them" );
		}
	}
	io::SceneObject parse( const json& object )
	{
		const json scene = { { "world", { { "collision_objects", json::array( { object } ) } } } };
		io::SceneModel model;
		try
		{
			model = io::parseScene( scene.dump( -1, ' ', false, json::error_handler_t::replace ), m_log.file, m_options );
		}
		catch ( const io::Error& error )
		{
			throw io::Error( m_log.file, m_element + ": " + error.element(), error.problem(), error.remedy() );
		}
		for ( const io::Notice& notice : model.report.notices )
		{
			const auto same = [&]( const io::Notice& n ) { return n.text == notice.text; };
			if ( std::none_of( m_log.notices.begin(), m_log.notices.end(), same ) )
			{
				m_log.notices.push_back( { m_log.file, m_element + ": " + notice.element, notice.text } );
			}
		}
		if ( model.objects.empty() )
		{
			fail( "collision_objects", "the object has no shape", "give it primitives, meshes or planes" );
		}
		if ( !model.objects.front().frame.empty() )
		{
			fail( model.objects.front().name, fmt::format( "is in frame '{}'", model.objects.front().frame ),
			    "give poses in the planning frame, and no frame_id" );
		}
		return model.objects.front();
	}

	Log& m_log;
	const io::LoadOptions& m_options;
	std::string m_element;
};

} // namespace

Log readLog( const std::string& file, const io::LoadOptions& options )
{
	Log log;
	log.file = file;
	std::ifstream stream( file );
	if ( !stream )
	{
		throw io::Error( file, "file", std::strerror( errno ), "name a log that can be read" );
	}
	std::string text;
	for ( std::size_t number = 1; std::getline( stream, text ); ++number )
	{
		if ( text.find_first_not_of( " \t\r" ) != std::string::npos )
		{
			log.events.push_back( LineReader( log, options, number ).read( text ) );
		}
	}
	if ( stream.bad() )
	{
		throw io::Error( file, "file", "could not be read to its end", "copy it to another disk" );
	}
	return log;
}

} // namespace leeway::replay
