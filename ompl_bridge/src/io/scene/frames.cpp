// SPDX-License-Identifier: BSD-3-Clause
// Frames of a problem by name.
#include "scene/frames.hpp"

#include "base/io_internal.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace leeway::io
{
namespace detail
{
namespace
{

bool isIdentity( const lw_transform& pose )
{
	lw_transform identity = lw_transform_identity();
	return std::equal( pose.t, pose.t + 3, identity.t ) && std::equal( &pose.r[0][0], &pose.r[0][0] + 9, &identity.r[0][0] );
}

std::string withoutSlash( const std::string& name )
{
	return !name.empty() && name[0] == '/' ? name.substr( 1 ) : name;
}

} // namespace

Frames::Frames( const RobotModel& model, const lw_robot* robot, const std::vector<double>& q, const SceneModel* scene,
    std::vector<Notice>& notices )
    : m_model( model ), m_robot( robot ), m_links( lw_robot_link_count( robot ) )
{
	if ( lw_robot_fk( robot, q.data(), m_links.data() ) != LW_OK )
	{
		throw Error(
		    model.urdf_file, "reference state", "holds a non-finite value or a zero quaternion", "correct the start state" );
	}
	if ( scene == nullptr )
	{
		return;
	}
	auto is_link = [&]( const std::string& name ) { return lw_robot_find_link( robot, name.c_str() ) != LW_INVALID_INDEX; };
	for ( const auto& [child, value] : scene->fixed_frames )
	{
		// MoveIt's spelling has the planning frame as child; where no link is called so, a file may call it "world"
		const auto& [parent, pose] = value;
		bool places_parent = !parent.empty() && !is_link( parent ) && ( child == model.planning_frame || child == "world" );
		std::string placed = places_parent ? parent : child;
		if ( !is_link( placed ) )
		{
			bool first = m_fixed.emplace( placed, std::pair( places_parent ? std::string() : parent, pose ) ).second;
			if ( !first )
			{
				throw Error( scene->file, "fixed_frame_transforms", fmt::format( "frame {} is placed twice", placed ),
				    "keep one of them" );
			}
		}
		else if ( !isIdentity( pose ) )
		{
			notices.push_back( { scene->file, "fixed_frame_transforms",
			    fmt::format( "{} has its place by the robot: this transform is ignored", placed ) } );
		}
	}
}

bool Frames::isPlanning( const std::string& name ) const
{
	return name.empty() || name == m_model.planning_frame ||
	       ( name == "world" && lw_robot_find_link( m_robot, "world" ) == LW_INVALID_INDEX && m_fixed.count( name ) == 0 );
}

std::vector<std::string> Frames::known() const
{
	std::vector<std::string> names = { m_model.planning_frame, "world" };
	for ( const auto& frame : m_fixed )
	{
		names.push_back( frame.first );
	}
	for ( const LinkModel& link : m_model.links )
	{
		if ( link.name != m_model.planning_frame )
		{
			names.push_back( link.name );
		}
	}
	return names;
}

Frames::Found Frames::find( std::string& name, Frame& out ) const
{
	out = Frame();
	for ( std::size_t step = 0; step <= m_fixed.size(); ++step )
	{
		out.link = lw_robot_find_link( m_robot, name.c_str() );
		if ( out.link != LW_INVALID_INDEX || isPlanning( name ) )
		{
			return Found::yes;
		}
		auto parent = m_fixed.find( name );
		if ( parent == m_fixed.end() )
		{
			return Found::unknown;
		}
		out.pose = lw_transform_multiply( &parent->second.second, &out.pose );
		name = parent->second.first;
	}
	return Found::cycle;
}

lw_transform Frames::planningFrom(
    const std::string& full_name, const std::string& file, const std::string& wanted_by ) const
{
	std::string name = withoutSlash( full_name );
	Frame frame;
	switch ( find( name, frame ) )
	{
	case Found::unknown:
		throw Error( file, wanted_by, fmt::format( "frame {} is not known", name ),
		    fmt::format( "use one of {}", joinNames( known(), 12 ) ) );
	case Found::cycle:
		throw Error(
		    file, "fixed_frame_transforms", fmt::format( "frame {} hangs on itself", full_name ), "break the cycle" );
	case Found::yes:
		break;
	}
	return frame.link == LW_INVALID_INDEX ? frame.pose : lw_transform_multiply( &m_links[frame.link], &frame.pose );
}

std::map<std::string, Frame> Frames::fixed() const
{
	std::map<std::string, Frame> frames;
	std::vector<std::string> names = { "", m_model.planning_frame, "world" };
	for ( const auto& frame : m_fixed )
	{
		names.push_back( frame.first );
	}
	for ( const std::string& name : names )
	{
		Frame frame;
		std::string last = name;
		if ( lw_robot_find_link( m_robot, name.c_str() ) == LW_INVALID_INDEX && find( last, frame ) == Found::yes )
		{
			frames.emplace( name, frame );
		}
	}
	return frames;
}

} // namespace detail

Frame findFrame( const Problem& problem, const std::string& full_name, const std::string& file, const std::string& element )
{
	const std::string name = detail::withoutSlash( full_name );
	const lw_robot* robot = problem.robot.get();
	const std::uint32_t link = lw_robot_find_link( robot, name.c_str() );
	const auto object = problem.object_poses.find( name );
	if ( link != LW_INVALID_INDEX )
	{
		// an attached object has its own pose; the frame of its link is that of the parent link
		const bool attached = lw_robot_is_attached( robot, link ) && object != problem.object_poses.end();
		return { link, attached ? object->second : lw_transform_identity() };
	}
	if ( object != problem.object_poses.end() )
	{
		return { LW_INVALID_INDEX, object->second };
	}
	const auto fixed = problem.frames.find( name );
	if ( fixed != problem.frames.end() )
	{
		return fixed->second;
	}
	std::vector<std::string> known;
	for ( const auto& frame : problem.frames )
	{
		known.push_back( frame.first );
	}
	for ( std::uint32_t i = 0; i < lw_robot_link_count( robot ); ++i )
	{
		known.push_back( lw_robot_link_name( robot, i ) );
	}
	known.erase( std::remove( known.begin(), known.end(), "" ), known.end() );
	throw Error( file, element, fmt::format( "frame {} is not known", full_name ),
	    fmt::format( "use one of {}", detail::joinNames( known, 12 ) ) );
}

} // namespace leeway::io
