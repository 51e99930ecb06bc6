// SPDX-License-Identifier: BSD-3-Clause
// A world that changes between motions: see stage.hpp.
#include "leeway/motions/stage.hpp"

#include <cmath>

namespace leeway::cli
{

const Workbench& Stage::use( const std::string& group )
{
	if ( m_bench && group == m_group )
	{
		return *m_bench;
	}
	m_world.reset();
	m_bench = std::make_unique<Workbench>( m_input, group, m_values, m_notices );
	m_group = group;
	for ( const Change& change : m_changes )
	{
		repeat( change );
	}
	if ( !m_changes.empty() )
	{
		m_bench->adopt( *world().problem() );
	}
	return *m_bench;
}

void Stage::moved( const std::vector<double>& q )
{
	const std::vector<std::string>& names = m_bench->problem().variable_names;
	for ( std::size_t v = 0; v < names.size(); ++v )
	{
		m_values[names[v]] = q[v];
		m_moved.insert( names[v] );
	}
}

double Stage::at( const std::string& variable ) const
{
	return m_moved.count( variable ) != 0 ? m_values.at( variable ) : NAN;
}

io::World& Stage::world()
{
	if ( !m_world )
	{
		m_world = m_bench->makeWorld();
		for ( const auto& [a, b] : m_input.allowed )
		{
			const lw_scene* scene = m_world->problem()->scene.get();
			const bool second = lw_scene_find_object( scene, b.c_str() ) != LW_INVALID_INDEX;
			if ( second || lw_scene_find_object( scene, a.c_str() ) != LW_INVALID_INDEX ) // pairs of links are the robot's
			{
				m_world->allow( second ? a : b, second ? b : a, true );
			}
		}
	}
	return *m_world;
}

/// A change that was made in the world of another group.
void Stage::repeat( const Change& change )
{
	const Step& step = change.step;
	switch ( step.kind )
	{
	case Step::Kind::attach:
		world().attachAt( step.object, step.link, step.touch_links, change.pose );
		break;
	case Step::Kind::release:
		world().detach( step.object );
		world().move( step.object, change.pose );
		break;
	case Step::Kind::allow:
	case Step::Kind::forbid:
		allow( step.link, step.object, step.kind == Step::Kind::allow );
		break;
	case Step::Kind::trajectory:
		break;
	}
}

void Stage::allow( const std::string& link, const std::string& object, bool allowed )
{
	const auto is_object = [&]( const std::string& name )
	{ return lw_scene_find_object( world().problem()->scene.get(), name.c_str() ) != LW_INVALID_INDEX; };
	const bool swapped = !is_object( object ) && is_object( link );
	world().allow( swapped ? object : link, swapped ? link : object, allowed );
}

void Stage::change( const Step& step, const std::string& file )
{
	std::vector<double> q;
	for ( const std::string& name : m_bench->problem().variable_names )
	{
		q.push_back( m_values.count( name ) != 0 ? m_values.at( name ) : 0 );
	}
	Change change{ step, lw_transform_identity() };
	try
	{
		if ( step.kind == Step::Kind::attach )
		{
			world().attach( step.object, step.link, step.touch_links, q );
			change.pose = world().problem()->object_poses.at( step.object );
		}
		else if ( step.kind == Step::Kind::release )
		{
			world().detach( step.object, q );
			change.pose = world().problem()->object_poses.at( step.object );
		}
		else
		{
			repeat( change );
		}
	}
	catch ( const io::Error& error )
	{
		throw io::Error( file, step.element, error.element() + ": " + error.problem(), error.remedy() );
	}
	m_changes.push_back( change );
	m_bench->adopt( *world().problem() );
}

} // namespace leeway::cli
