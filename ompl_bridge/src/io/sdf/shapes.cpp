// SPDX-License-Identifier: BSD-3-Clause
// Collision shapes of SDF: boxes, spheres, cylinders, capsules, ellipsoids, meshes, planes.
#include "sdf/sdf.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace leeway::io::detail::sdf
{

lw_transform transformOf( const Pose3d& pose )
{
	const double t[3] = { pose.Pos().X(), pose.Pos().Y(), pose.Pos().Z() };
	const double q[4] = { pose.Rot().X(), pose.Rot().Y(), pose.Rot().Z(), pose.Rot().W() };
	lw_transform transform;
	require( lw_transform_from_quaternion( t, q, &transform ), "lw_transform_from_quaternion" );
	return transform;
}

std::string placeOf( const std::string& what, const ::sdf::ElementPtr& element )
{
	const std::optional<int> line = element != nullptr ? element->LineNumber() : std::nullopt;
	return line ? fmt::format( "{} (line {})", what, *line ) : what;
}

namespace
{

/// A half-space below a plane of this normal at a pose.
PlacedShape halfSpace(
    GeometryLoader& geometry, const ShapeLoader::Place& place, const ::sdf::Plane& plane, const lw_transform& pose )
{
	const lw_vec3 tip = lw_transform_point( &pose, { plane.Normal().X(), plane.Normal().Y(), plane.Normal().Z() } );
	const double n[3] = { tip.x - pose.t[0], tip.y - pose.t[1], tip.z - pose.t[2] };
	return geometry.plane( place, { n[0], n[1], n[2], -( n[0] * pose.t[0] + n[1] * pose.t[1] + n[2] * pose.t[2] ) }, true );
}

bool isSolid( const LoadOptions& options, const std::string& link )
{
	return std::any_of(
	    options.solid.begin(), options.solid.end(), [&]( const std::string& name ) { return name == link || name == "*"; } );
}

/// A pose in the frame of its link. @throws Error
lw_transform poseOf( const ::sdf::SemanticPose& semantic, const ShapeLoader::Place& place )
{
	Pose3d pose;
	if ( const ::sdf::Errors errors = semantic.Resolve( pose ); !errors.empty() )
	{
		throw Error( place.file, place.element, errors.front().Message(), "correct its pose" );
	}
	return transformOf( pose );
}

} // namespace

Shape Shapes::meshOf( const Given& given )
{
	const ::sdf::Mesh& mesh = *given.geometry->MeshShape();
	if ( !mesh.Submesh().empty() )
	{
		throw Error( given.place.file, given.place.element,
		    fmt::format( "submesh {} of mesh {}: parts of mesh files are not read", mesh.Submesh(), mesh.Uri() ),
		    "save the part as a file of its own" );
	}
	const std::array<double, 3> scale = { mesh.Scale().X(), mesh.Scale().Y(), mesh.Scale().Z() };
	return isSolid( m_options, given.place.owner ) ? m_geometry.solidMesh( given.place, mesh.Uri(), scale )
	                                               : m_shapes.mesh( given.place, mesh.Uri(), scale );
}

Shape Shapes::shapeOf( const Given& given )
{
	const ::sdf::Geometry& geometry = *given.geometry;
	switch ( geometry.Type() )
	{
	case ::sdf::GeometryType::BOX:
	{
		const auto size = geometry.BoxShape()->Size();
		return m_shapes.primitive( given.place, LW_SHAPE_BOX, { size.X(), size.Y(), size.Z() } );
	}
	case ::sdf::GeometryType::SPHERE:
		return m_shapes.primitive( given.place, LW_SHAPE_SPHERE, { geometry.SphereShape()->Radius(), 0, 0 } );
	case ::sdf::GeometryType::CYLINDER:
		return m_shapes.primitive(
		    given.place, LW_SHAPE_CYLINDER, { geometry.CylinderShape()->Radius(), geometry.CylinderShape()->Length(), 0 } );
	case ::sdf::GeometryType::CAPSULE: // the length without the caps, as here
		return m_shapes.primitive(
		    given.place, LW_SHAPE_CAPSULE, { geometry.CapsuleShape()->Radius(), geometry.CapsuleShape()->Length(), 0 } );
	case ::sdf::GeometryType::ELLIPSOID:
	{
		const auto radii = geometry.EllipsoidShape()->Radii();
		if ( !( radii.X() > 0 && radii.Y() > 0 && radii.Z() > 0 ) )
		{
			throw Error( given.place.file, given.place.element, "an ellipsoid has a radius that is not above 0",
			    "give three radii above 0" );
		}
		return m_geometry.ellipsoid( given.place, { radii.X(), radii.Y(), radii.Z() } );
	}
	case ::sdf::GeometryType::MESH:
		return meshOf( given );
	default:
		throw Error( given.place.file, given.place.element, "its shape is none that is read",
		    "use a box, sphere, cylinder, capsule, ellipsoid, mesh or plane; a height map is read in a planning scene "
		    "(leeway_height_maps)" );
	}
}

void Shapes::add( const Given& given, std::vector<PlacedShape>& shapes, std::vector<PlacedShape>& planes )
{
	const ::sdf::Geometry& geometry = *given.geometry;
	if ( geometry.Type() == ::sdf::GeometryType::EMPTY )
	{
		return;
	}
	++m_count;
	if ( geometry.Type() == ::sdf::GeometryType::PLANE )
	{
		planes.push_back( halfSpace( m_geometry, given.place, *geometry.PlaneShape(), given.pose ) );
		return;
	}
	if ( m_options.skip_missing_meshes && geometry.Type() == ::sdf::GeometryType::MESH &&
	     !hasResource( geometry.MeshShape()->Uri(), given.place.file, m_options ) )
	{
		--m_count;
		const ::sdf::ElementPtr element = geometry.MeshShape()->Element();
		m_missing.add( geometry.MeshShape()->Uri(), given.place.owner, element ? element->LineNumber().value_or( 0 ) : 0 );
		return;
	}
	shapes.push_back( { shapeOf( given ), given.pose } );
}

std::vector<PlacedShape> Shapes::read( const ::sdf::Link& link, const std::string& name, std::vector<PlacedShape>& planes )
{
	std::vector<PlacedShape> shapes;
	const auto read = [&]( const auto& part, const char* kind )
	{
		const std::string file =
		    part.Element() != nullptr && !part.Element()->FilePath().empty() ? part.Element()->FilePath() : m_file;
		Given given{ part.Geom(),
		    { file, placeOf( fmt::format( "link {}, {} {}", name, kind, part.Name() ), part.Element() ), name }, {} };
		given.pose = poseOf( part.SemanticPose(), given.place );
		add( given, shapes, planes );
	};
	for ( std::uint64_t i = 0; i < link.CollisionCount(); ++i )
	{
		read( *link.CollisionByIndex( i ), "collision" );
	}
	if ( link.CollisionCount() == 0 && link.VisualCount() > 0 )
	{
		( m_options.use_visual ? m_visual : m_hidden ).push_back( name );
		for ( std::uint64_t i = 0; m_options.use_visual && i < link.VisualCount(); ++i )
		{
			read( *link.VisualByIndex( i ), "visual" );
		}
	}
	return shapes;
}

void Shapes::finish()
{
	m_missing.report( m_file, m_count > 0, m_report.notices );
	if ( m_count == 0 )
	{
		throw Error( m_file, "<sdf>", "no link has collision geometry",
		    m_hidden.empty() ? "add <collision> elements to its links"
		                     : "its visual geometry can be used (--visual), or add <collision> elements to its links" );
	}
	if ( !m_visual.empty() )
	{
		m_report.notices.push_back( { m_file, "<visual>",
		    "visual geometry is used for links without collision geometry: " + joinNames( m_visual ) } );
	}
	if ( !m_hidden.empty() )
	{
		m_report.notices.push_back( { m_file, "<sdf>",
		    "links that have visual but no collision geometry are not checked: " + joinNames( m_hidden ) } );
	}
}

} // namespace leeway::io::detail::sdf
