// SPDX-License-Identifier: BSD-3-Clause
// Robot, scene and checker as a list of numbers, read by view/engine/engine.c in the same order, and the shapes as a blob.
#include "view/content.hpp"

#include <fmt/format.h>

namespace leeway::view
{
namespace
{

constexpr double engine_format = 2;
constexpr std::size_t most_blob_bytes = std::size_t( 48 ) << 20; // before compression

class Numbers
{
public:
	template <typename... T> void put( T... values ) { ( m_all.push_back( static_cast<double>( values ) ), ... ); }
	void pose( const lw_transform& pose )
	{
		for ( int i = 0; i < 9; ++i )
		{
			put( pose.r[i / 3][i % 3] );
		}
		put( pose.t[0], pose.t[1], pose.t[2] );
	}
	/// Reserves a place for a count that is known later.
	std::size_t later()
	{
		put( 0 );
		return m_all.size() - 1;
	}
	void set( std::size_t at, std::size_t value ) { m_all[at] = static_cast<double>( value ); }
	std::vector<double> all() && { return std::move( m_all ); }

private:
	std::vector<double> m_all;
};

void putRobot( const PageInput& page, const ShapeList& shapes, Numbers& out )
{
	const lw_robot* robot = page.problem.robot.get();
	const std::uint32_t links = lw_robot_link_count( robot ), bodies = lw_robot_body_count( robot );
	const std::vector<io::JointModel> joints = jointsOf( page.robot, robot );
	out.put( links, joints.size(), bodies );
	const std::size_t pairs = out.later();
	for ( std::uint32_t i = 0; i < joints.size(); ++i )
	{
		const io::JointModel& joint = joints[i];
		out.put( joint.type, lw_robot_joint_parent( robot, i ), lw_robot_joint_child( robot, i ) );
		out.pose( joint.parent_from_joint );
		out.put( joint.axis[0], joint.axis[1], joint.axis[2], joint.lower, joint.upper );
		const std::uint32_t mimic =
		    joint.mimic.empty() ? LW_INVALID_INDEX : lw_robot_find_joint( robot, joint.mimic.c_str() );
		out.put( mimic == LW_INVALID_INDEX ? -1.0 : mimic, joint.mimic_multiplier, joint.mimic_offset );
	}
	for ( std::uint32_t i = 0; i < bodies; ++i )
	{
		const lw_body_def body = lw_robot_body( robot, i );
		out.put( shapes.indexOf( body.shape ), body.link );
		out.pose( body.link_from_shape );
	}
	std::size_t count = 0;
	for ( std::uint32_t a = 0; a < links; ++a )
	{
		for ( std::uint32_t b = a + 1; b < links; ++b )
		{
			if ( lw_robot_pair_allowed( robot, a, b ) )
			{
				out.put( a, b );
				++count;
			}
		}
	}
	out.set( pairs, count );
}

void putScene( const lw_scene* scene, const ShapeList& shapes, Numbers& out )
{
	const std::uint32_t count = scene != nullptr ? lw_scene_shape_count( scene ) : 0;
	out.put( scene != nullptr ? lw_scene_object_count( scene ) : 0, count );
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		const lw_scene_shape_def placed = lw_scene_shape( scene, i );
		out.put( shapes.indexOf( placed.shape ), placed.object );
		out.pose( placed.world_from_shape );
	}
}

void putChecker( const io::Problem& problem, Numbers& out )
{
	const lw_checker* checker = problem.checker.get();
	const std::uint32_t links = lw_robot_link_count( problem.robot.get() );
	const std::uint32_t objects = problem.scene ? lw_scene_object_count( problem.scene.get() ) : 0;
	out.put( problem.variables.size(), problem.allowed.size() );
	const std::size_t environment_margins = out.later(), self_margins = out.later();
	for ( const std::uint32_t variable : problem.variables )
	{
		out.put( variable );
	}
	for ( const double value : problem.reference )
	{
		out.put( value );
	}
	for ( const lw_link_object_pair& pair : problem.allowed )
	{
		out.put( pair.link, pair.object );
	}
	const bool margins = hasMargins( checker );
	std::size_t with_objects = 0, with_links = 0;
	for ( std::uint32_t a = 0; a < links && margins; ++a )
	{
		for ( std::uint32_t b = 0; b < objects; ++b )
		{
			if ( const double margin = lw_checker_environment_margin( checker, a, b ); margin > 0 )
			{
				out.put( a, b, margin );
				++with_objects;
			}
		}
	}
	for ( std::uint32_t a = 0; a < links && margins; ++a )
	{
		for ( std::uint32_t b = a + 1; b < links; ++b )
		{
			if ( const double margin = lw_checker_self_margin( checker, a, b ); margin > 0 )
			{
				out.put( a, b, margin );
				++with_links;
			}
		}
	}
	out.set( environment_margins, with_objects );
	out.set( self_margins, with_links );
}

/// The shapes as bytes; empty, with a reason, if one cannot be made or all of them are too many for a page.
std::string shapeBlob( const ShapeList& shapes, std::vector<std::string>& omitted )
{
	const auto without = [&]( const std::string& reason )
	{
		omitted.push_back( "clearances are not computed in this page: " + reason );
		return std::string();
	};
	lw_blob_def def = lw_blob_def_default();
	def.shapes = shapes.shapes().data();
	def.shape_count = static_cast<std::uint32_t>( shapes.shapes().size() );
	lw_diag diag = {};
	void* bytes = nullptr;
	std::size_t size = 0;
	if ( lw_blob_write( &def, nullptr, &diag, &bytes, &size ) != LW_OK )
	{
		return without( fmt::format( "shapes cannot be stored: {}", diag.message ) );
	}
	const std::string blob( static_cast<const char*>( bytes ), size );
	lw_blob_free( nullptr, bytes, size );
	return size <= most_blob_bytes ? blob
	                               : without( fmt::format( "shapes with their trees take {} MB; a page holds at most {}",
	                                     size >> 20, most_blob_bytes >> 20 ) );
}

} // namespace

void addEngine( const PageInput& page, const ShapeList& shapes, PageContent& content )
{
	content.blob = shapeBlob( shapes, content.omitted );
	if ( content.blob.empty() )
	{
		return;
	}
	Numbers numbers;
	numbers.put( engine_format, shapes.shapes().size() );
	putRobot( page, shapes, numbers );
	putScene( page.problem.scene.get(), shapes, numbers );
	putChecker( page.problem, numbers );
	numbers.put( page.motion.apart.size() );
	for ( const ApartPair& apart : page.motion.apart )
	{
		numbers.put( apart.pair.self ? 1 : 0, apart.pair.a, apart.pair.b );
	}
	content.numbers = std::move( numbers ).all();
}

} // namespace leeway::view
