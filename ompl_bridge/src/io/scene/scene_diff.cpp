// SPDX-License-Identifier: BSD-3-Clause
// Differences of scenes, applied to copies of a world.
#include "leeway/io/scene_diff.hpp"

#include "base/io_internal.hpp"

#include <fmt/format.h>

#include <set>

namespace leeway::io
{
namespace
{

class Applying
{
public:
	Applying( World& world, const std::string& file, const std::vector<double>& state )
	    : m_world( world ), m_file( file ), m_state( state )
	{
	}

	void apply( const SceneEdit& edit )
	{
		const std::string& name = edit.object.name;
		switch ( edit.kind )
		{
		case SceneEdit::Kind::attach:
			attach( edit );
			break;
		case SceneEdit::Kind::release:
			release( edit );
			break;
		case SceneEdit::Kind::add:
			if ( isThere( name ) )
			{
				requireInWorld( edit );
				m_world.remove( name );
			}
			add( edit, worldFrom( edit.object.frame, edit ) );
			break;
		case SceneEdit::Kind::remove:
			requireThere( edit );
			// one that was attached has left the world, and MoveIt's examples remove it once more
			if ( m_attached.count( name ) == 0 )
			{
				requireInWorld( edit );
				m_world.remove( name );
			}
			break;
		case SceneEdit::Kind::move:
		{
			requireThere( edit );
			requireInWorld( edit );
			const lw_transform frame = worldFrom( edit.object.frame, edit );
			m_world.move( name, lw_transform_multiply( &frame, &edit.object.pose ) );
			break;
		}
		}
	}

private:
	bool isThere( const std::string& name ) const { return m_world.problem()->object_poses.count( name ) != 0; }

	[[noreturn]] void fail( const SceneEdit& edit, const std::string& problem, const std::string& remedy ) const
	{
		throw Error( m_file, edit.element, problem, remedy );
	}

	void requireThere( const SceneEdit& edit ) const
	{
		if ( !isThere( edit.object.name ) )
		{
			std::vector<std::string> known;
			for ( const auto& object : m_world.problem()->object_poses )
			{
				known.push_back( object.first );
			}
			fail( edit, fmt::format( "there is no object {} by then", edit.object.name ),
			    known.empty() ? "add it first"
			                  : fmt::format( "use one of {}, or add it first", detail::joinNames( known, 12 ) ) );
		}
	}

	void requireInWorld( const SceneEdit& edit ) const
	{
		const std::string holder = m_world.holder( edit.object.name );
		if ( !holder.empty() )
		{
			fail( edit, fmt::format( "object {} is attached to link {} by then", edit.object.name, holder ),
			    "release it first: operation REMOVE in attached_collision_objects" );
		}
	}

	/// The frame in the world, where it is in the state. @param name empty: the planning frame
	lw_transform worldFrom( const std::string& name, const SceneEdit& edit ) const
	{
		const std::shared_ptr<const Problem> problem = m_world.problem();
		const Frame frame = findFrame( *problem, name, m_file, edit.element );
		if ( frame.link == LW_INVALID_INDEX )
		{
			return frame.pose;
		}
		std::vector<double> full = problem->reference;
		for ( std::size_t i = 0; i < m_state.size(); ++i )
		{
			full.at( problem->variables.at( i ) ) = m_state[i];
		}
		std::vector<lw_transform> links( lw_robot_link_count( problem->robot.get() ) );
		if ( lw_robot_fk( problem->robot.get(), full.data(), links.data() ) != LW_OK )
		{
			fail( edit, "the state before it holds a value that is not finite, or a zero quaternion", "correct it" );
		}
		return lw_transform_multiply( &links[frame.link], &frame.pose );
	}

	void add( const SceneEdit& edit, const lw_transform& world_from_frame )
	{
		std::vector<PlacedShape> shapes = edit.object.shapes;
		const lw_transform object_from_frame = lw_transform_inverse( &edit.object.pose );
		for ( PlacedShape& shape : shapes )
		{
			shape.pose = lw_transform_multiply( &object_from_frame, &shape.pose );
		}
		m_world.add( edit.object.name, shapes, lw_transform_multiply( &world_from_frame, &edit.object.pose ) );
	}

	void attach( const SceneEdit& edit )
	{
		const SceneObject& object = edit.object;
		m_attached.insert( object.name );
		if ( object.shapes.empty() )
		{
			requireThere( edit );
			requireInWorld( edit );
			m_world.attach( object.name, edit.link, edit.touch_links, m_state );
			return;
		}
		if ( isThere( object.name ) )
		{
			requireInWorld( edit );
			m_world.remove( object.name );
		}
		lw_transform link_from_frame = lw_transform_identity();
		const lw_transform world_from_link = worldFrom( edit.link, edit );
		lw_transform world_from_frame = world_from_link;
		if ( !object.frame.empty() && object.frame != edit.link )
		{
			const lw_transform link_from_world = lw_transform_inverse( &world_from_link );
			world_from_frame = worldFrom( object.frame, edit );
			link_from_frame = lw_transform_multiply( &link_from_world, &world_from_frame );
		}
		add( edit, world_from_frame );
		m_world.attachAt(
		    object.name, edit.link, edit.touch_links, lw_transform_multiply( &link_from_frame, &object.pose ) );
	}

	void release( const SceneEdit& edit )
	{
		requireThere( edit );
		const std::string holder = m_world.holder( edit.object.name );
		if ( holder.empty() || ( !edit.link.empty() && edit.link != holder ) )
		{
			fail( edit,
			    holder.empty()
			        ? fmt::format( "object {} is not attached by then", edit.object.name )
			        : fmt::format( "object {} is attached to link {}, not to {}", edit.object.name, holder, edit.link ),
			    holder.empty() ? "attach it first, or remove it by world.collision_objects" : "name that link, or none" );
		}
		m_world.detach( edit.object.name, m_state );
		m_attached.erase( edit.object.name );
	}

	World& m_world;
	const std::string& m_file;
	const std::vector<double>& m_state;
	std::set<std::string> m_attached; ///< by these edits
};

} // namespace

std::shared_ptr<const World> changed( const World& world, const SceneDiff& diff, const std::vector<double>& state )
{
	auto next = std::make_shared<World>( world );
	const std::string* element = diff.matrix ? &diff.matrix->element : nullptr;
	try
	{
		diff.matrix ? static_cast<void>( next->setContacts( *diff.matrix ) ) : void();
		Applying applying( *next, diff.file, state );
		for ( const SceneEdit& edit : diff.edits )
		{
			element = &edit.element;
			applying.apply( edit );
		}
	}
	catch ( const Error& error )
	{
		if ( error.element() == *element )
		{
			throw Error( diff.file, *element, error.problem(), error.remedy() );
		}
		throw Error( diff.file, *element, error.element() + ": " + error.problem(), error.remedy() );
	}
	return next;
}

} // namespace leeway::io
