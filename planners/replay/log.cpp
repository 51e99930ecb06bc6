// SPDX-License-Identifier: BSD-3-Clause
// Lines of a log: see log.hpp. Objects are MoveIt's CollisionObjects, read as those of a scene.
#include "replay/log.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cerrno>
#include <cstring>
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
	/// The key that says what the line is about; empty: it only tells that all was seen. Others are known to go with it.
	std::string kindOf( const json& line ) const
	{
		std::string kind;
		for ( const char* one : { "world", "people", "attach", "release" } )
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
				    "a line has t, perhaps seen, and one of world, people, attach (with link) and release" );
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
			// a ball in its place: an object has a shape
			json ball = { { "id", id }, { "pose", object["pose"] } };
			ball["primitives"] = json::array( { { { "type", "sphere" }, { "dimensions", { 1.0 } } } } );
			ball["primitive_poses"] = json::array( { { { "position", { 0, 0, 0 } }, { "orientation", { 0, 0, 0, 1 } } } } );
			event.moved.emplace_back( id, parse( ball ).pose );
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
