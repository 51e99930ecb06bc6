// SPDX-License-Identifier: BSD-3-Clause
// A world that changes between motions: see stage.hpp.
#include "leeway/motions/stage.hpp"

namespace leeway::motions
{

std::shared_ptr<const io::Problem> Stage::use( const std::string& group )
{
	if ( m_world && group == m_options.group )
	{
		return m_world->problem();
	}
	m_world.reset();
	m_options.group = group;
	m_options.overrides.values = m_values;
	m_allowed = false;
	try
	{
		m_world = std::make_unique<io::World>( m_robot, m_options );
	}
	catch ( const CoreError& error )
	{
		throw io::Error( m_robot.urdf_file, group.empty() ? "robot" : "group " + group, error.what(),
		    "correct the named element of the description" );
	}
	for ( const Change& change : m_changes )
	{
		repeat( change );
	}
	return m_world->problem();
}

void Stage::moved( const std::vector<double>& q )
{
	const std::vector<std::string>& names = m_world->problem()->variable_names;
	for ( std::size_t v = 0; v < names.size(); ++v )
	{
		m_values[names[v]] = q[v];
	}
}

io::World& Stage::changing()
{
	if ( !m_allowed )
	{
		m_allowed = true;
		for ( const auto& [a, b] : m_options.allowed )
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
		changing().attachAt( step.object, step.link, step.touch_links, change.pose );
		break;
	case Step::Kind::release:
		changing().detach( step.object );
		changing().move( step.object, change.pose );
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
	{ return lw_scene_find_object( changing().problem()->scene.get(), name.c_str() ) != LW_INVALID_INDEX; };
	const bool swapped = !is_object( object ) && is_object( link );
	changing().allow( swapped ? object : link, swapped ? link : object, allowed );
}

void Stage::change( const Step& step, const std::string& file )
{
	std::vector<double> q;
	for ( const std::string& name : m_world->problem()->variable_names )
	{
		q.push_back( m_values.count( name ) != 0 ? m_values.at( name ) : 0 );
	}
	Change change{ step, lw_transform_identity() };
	try
	{
		if ( step.kind == Step::Kind::attach )
		{
			changing().attach( step.object, step.link, step.touch_links, q );
			change.pose = changing().problem()->object_poses.at( step.object );
		}
		else if ( step.kind == Step::Kind::release )
		{
			changing().detach( step.object, q );
			change.pose = changing().problem()->object_poses.at( step.object );
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
}

} // namespace leeway::motions
