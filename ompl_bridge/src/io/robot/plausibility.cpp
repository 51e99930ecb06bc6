// SPDX-License-Identifier: BSD-3-Clause
// Notices about readable values that are hardly meant. They change no answer.
//
// Winding number of a mesh around a point: Jacobson, Kavan, Sorkine-Hornung, "Robust inside-outside segmentation using
// generalized winding numbers", 2013; solid angle of a triangle: van Oosterom, Strackee, "The solid angle of a plane
// triangle", 1983. It needs no closed mesh: a room with a small hole in its wall still encloses.
#include "robot/plausibility.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <set>

namespace leeway::io::detail
{

namespace
{

constexpr double two_turns = 4 * pi;    ///< radians: more than any arm's joint has, less than 13 degrees in radians
constexpr double bounds_nothing = 1000; ///< radians
constexpr double longest_rail = 20;     ///< metres
constexpr double huge_mesh = 50;        ///< metres
constexpr double large_mesh = 5;        ///< metres, with
constexpr double large_ratio = 30;      ///< of the median of a robot's other shapes: a 20 mm finger in millimetres has more
constexpr double tiny_mesh = 0.0005;    ///< metres
constexpr double enclosed = 0.9;        ///< winding number: a tenth of all directions may lead out through holes
constexpr std::size_t links_per_mesh = 2; ///< tested for being enclosed

struct SizedShape
{
	std::string owner;
	double extent; ///< metres, of the longest side of the box
	bool mesh;
};

void addShapes( const std::string& owner, const std::vector<PlacedShape>& shapes, std::vector<SizedShape>& out )
{
	for ( const PlacedShape& placed : shapes )
	{
		const lw_shape_info info = lw_shape_peek_info( placed.shape.get() );
		double extent = 0;
		for ( std::size_t axis = 0; axis < 3; ++axis )
		{
			extent = std::max( extent, info.box_max[axis] - info.box_min[axis] );
		}
		if ( std::isfinite( extent ) ) // planes have no end
		{
			out.push_back( { owner, extent, info.type == LW_SHAPE_MESH } );
		}
	}
}

/// Of the shapes that are not this one; 0 if there are none.
double medianOfOthers( const std::vector<SizedShape>& shapes, const SizedShape& one )
{
	std::vector<double> extents;
	for ( const SizedShape& shape : shapes )
	{
		if ( &shape != &one )
		{
			extents.push_back( shape.extent );
		}
	}
	if ( extents.empty() )
	{
		return 0;
	}
	const auto middle = extents.begin() + static_cast<std::ptrdiff_t>( extents.size() / 2 );
	std::nth_element( extents.begin(), middle, extents.end() );
	return *middle;
}

void noticeSizes( const std::string& file, const char* element, const std::vector<SizedShape>& shapes, bool compare,
    std::vector<Notice>& notices )
{
	std::vector<std::string> large, tiny;
	for ( const SizedShape& shape : shapes )
	{
		if ( !shape.mesh )
		{
			continue;
		}
		// Compared with others only where it is large at all: few meshes have more than thousand
		const double others = compare && shape.extent > large_mesh ? medianOfOthers( shapes, shape ) : 0;
		if ( shape.extent > huge_mesh || ( others > 0 && shape.extent > large_ratio * others ) )
		{
			large.push_back( fmt::format( "{} {:.4g} m", shape.owner, shape.extent ) );
		}
		if ( shape.extent < tiny_mesh )
		{
			tiny.push_back( fmt::format( "{} {:.4g} mm", shape.owner, 1e3 * shape.extent ) );
		}
	}
	if ( !large.empty() )
	{
		notices.push_back( { file, element,
		    fmt::format( "meshes of this size are rare: {}; if they are in millimetres, scale them by 0.001",
		        joinNames( large ) ) } );
	}
	if ( !tiny.empty() )
	{
		notices.push_back(
		    { file, element, fmt::format( "meshes of this size are rare: {}; is a scale too much?", joinNames( tiny ) ) } );
	}
}

/// About 1 or -1 inside of a closed surface, by its orientation, about 0 outside.
double windingNumber( const lw_shape* mesh, const lw_vec3& point )
{
	const double* vertices = lw_shape_vertices( mesh );
	const std::uint32_t* triangles = lw_shape_triangles( mesh );
	const std::uint32_t count = vertices != nullptr && triangles != nullptr ? lw_shape_get_info( mesh ).triangle_count : 0;
	double sum = 0;
	for ( std::size_t i = 0; i < count; ++i )
	{
		double v[3][3], length[3];
		for ( std::size_t k = 0; k < 3; ++k )
		{
			const double* from = vertices + 3 * static_cast<std::size_t>( triangles[3 * i + k] );
			v[k][0] = from[0] - point.x;
			v[k][1] = from[1] - point.y;
			v[k][2] = from[2] - point.z;
			length[k] = std::sqrt( v[k][0] * v[k][0] + v[k][1] * v[k][1] + v[k][2] * v[k][2] );
		}
		const auto dot = [&]( int a, int b ) { return v[a][0] * v[b][0] + v[a][1] * v[b][1] + v[a][2] * v[b][2]; };
		const double volume = v[0][0] * ( v[1][1] * v[2][2] - v[1][2] * v[2][1] ) -
		                      v[0][1] * ( v[1][0] * v[2][2] - v[1][2] * v[2][0] ) +
		                      v[0][2] * ( v[1][0] * v[2][1] - v[1][1] * v[2][0] );
		const double base =
		    length[0] * length[1] * length[2] + dot( 0, 1 ) * length[2] + dot( 1, 2 ) * length[0] + dot( 2, 0 ) * length[1];
		sum += std::atan2( volume, base );
	}
	return sum / ( 2 * pi );
}

bool inBox( const lw_shape_info& info, const lw_vec3& p )
{
	return p.x > info.box_min[0] && p.x < info.box_max[0] && p.y > info.box_min[1] && p.y < info.box_max[1] &&
	       p.z > info.box_min[2] && p.z < info.box_max[2];
}

lw_vec3 boxCentre( const lw_shape_info& info )
{
	return { ( info.box_min[0] + info.box_max[0] ) / 2, ( info.box_min[1] + info.box_max[1] ) / 2,
	    ( info.box_min[2] + info.box_max[2] ) / 2 };
}

/// A point of the shape itself, in its frame. The centre of a mesh's box may be in a hole of it.
lw_vec3 pointOf( const lw_shape* shape )
{
	const double* vertices = lw_shape_vertices( shape );
	return vertices != nullptr ? lw_vec3{ vertices[0], vertices[1], vertices[2] } : boxCentre( lw_shape_peek_info( shape ) );
}

/// A shape of a link, where the reference state puts it.
struct LinkShape
{
	const std::string* link;
	const lw_shape* shape;
	lw_transform world_from_shape;
};

std::vector<LinkShape> linkShapes( const RobotModel& model, const Problem& problem )
{
	const lw_robot* robot = problem.robot.get();
	std::vector<lw_transform> poses( lw_robot_link_count( robot ) );
	std::vector<LinkShape> shapes;
	if ( lw_robot_fk( robot, problem.reference.data(), poses.data() ) != LW_OK )
	{
		return shapes;
	}
	for ( const LinkModel& link : model.links )
	{
		const std::uint32_t index = lw_robot_find_link( robot, link.name.c_str() );
		if ( !link.collision.empty() && index < poses.size() )
		{
			const PlacedShape& first = link.collision.front();
			shapes.push_back( { &link.name, first.shape.get(), lw_transform_multiply( &poses[index], &first.pose ) } );
		}
	}
	return shapes;
}

/// The first link that a mesh encloses; nullptr if none. A robot hangs together: a few links tell.
const std::string* enclosedLink( const lw_shape* mesh, const lw_transform& mesh_from_world,
    const std::vector<LinkShape>& links, const std::function<bool( const std::string& )>& may_touch )
{
	const lw_shape_info box = lw_shape_peek_info( mesh );
	std::size_t tested = 0;
	for ( std::size_t i = 0; i < links.size() && tested < links_per_mesh; ++i )
	{
		const lw_transform mesh_from_link = lw_transform_multiply( &mesh_from_world, &links[i].world_from_shape );
		const lw_vec3 centre = lw_transform_point( &mesh_from_link, boxCentre( lw_shape_peek_info( links[i].shape ) ) );
		if ( !inBox( box, centre ) || may_touch( *links[i].link ) )
		{
			continue;
		}
		const lw_vec3 point = lw_transform_point( &mesh_from_link, pointOf( links[i].shape ) );
		if ( std::fabs( windingNumber( mesh, point ) ) > enclosed )
		{
			return links[i].link;
		}
		++tested;
	}
	return nullptr;
}

} // namespace

void noticeOddLimits( const RobotModel& model, std::vector<Notice>& notices )
{
	std::vector<std::string> degrees, wide, rails;
	for ( const JointModel& joint : model.joints )
	{
		const double largest = std::max( std::fabs( joint.lower ), std::fabs( joint.upper ) );
		const std::string text = fmt::format( "{} {:.6g} to {:.6g}", joint.name, joint.lower, joint.upper );
		if ( joint.type == LW_JOINT_REVOLUTE && largest > two_turns )
		{
			( largest > bounds_nothing ? wide : degrees ).push_back( text );
		}
		if ( joint.type == LW_JOINT_PRISMATIC && largest > longest_rail )
		{
			rails.push_back( text );
		}
	}
	const auto notice = [&]( const std::vector<std::string>& joints, const std::string& what )
	{
		if ( !joints.empty() )
		{
			notices.push_back( { model.urdf_file, "<limit>", what + ": " + joinNames( joints ) } );
		}
	};
	notice( degrees, "limits that look like degrees, and are used as radians" );
	notice( wide, "limits that bound nothing: give the machine's, or make the joint continuous" );
	notice( rails, "limits that look like millimetres, and are used as metres" );
}

void noticeOddSizes( const RobotModel& model, std::vector<Notice>& notices )
{
	std::vector<SizedShape> shapes;
	for ( const LinkModel& link : model.links )
	{
		addShapes( "link " + link.name, link.collision, shapes );
	}
	noticeSizes( model.urdf_file, "<robot>", shapes, true, notices );
}

void noticeOddSizes( const SceneModel& scene, std::vector<Notice>& notices )
{
	std::vector<SizedShape> shapes;
	for ( const SceneObject& object : scene.objects )
	{
		addShapes( "object " + object.name, object.shapes, shapes );
	}
	for ( const AttachedObject& attached : scene.attached )
	{
		addShapes( "object " + attached.object.name, attached.object.shapes, shapes );
	}
	noticeSizes( scene.file, "world", shapes, false, notices );
}

void noticeEnclosures( const RobotModel& model, const SceneModel& scene,
    const std::vector<std::pair<std::string, std::string>>& allowed, Problem& problem )
{
	const std::set<std::pair<std::string, std::string>> contacts( allowed.begin(), allowed.end() );
	const std::vector<LinkShape> links = linkShapes( model, problem );
	for ( const SceneObject& object : scene.objects )
	{
		const lw_transform object_from_world = lw_transform_inverse( &problem.object_poses.at( object.name ) );
		const lw_transform frame_from_world = lw_transform_multiply( &object.pose, &object_from_world );
		const auto may_touch = [&]( const std::string& link ) { return contacts.count( { link, object.name } ) != 0; };
		const std::string* inside = nullptr;
		for ( const PlacedShape& placed : object.shapes )
		{
			const lw_shape_info info = lw_shape_peek_info( placed.shape.get() );
			if ( inside == nullptr && info.type == LW_SHAPE_MESH && !info.solid )
			{
				const lw_transform mesh_from_frame = lw_transform_inverse( &placed.pose );
				inside = enclosedLink(
				    placed.shape.get(), lw_transform_multiply( &mesh_from_frame, &frame_from_world ), links, may_touch );
			}
		}
		if ( inside != nullptr )
		{
			problem.notices.push_back( { scene.file, "object " + object.name,
			    fmt::format( "its mesh encloses link {}: a mesh is a surface, what is inside and does not touch it is free; "
			                 "make the mesh solid if it is",
			        *inside ) } );
		}
	}
}

} // namespace leeway::io::detail
