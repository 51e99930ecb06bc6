// SPDX-License-Identifier: BSD-3-Clause
// MJCF as a robot: the world is its root link, and geoms of the world are that link's.
#include "mjcf/robot.hpp"

#include "mjcf/known.hpp"
#include "shape/missing_meshes.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace leeway::io::detail
{

namespace mjcf
{
namespace
{

/// Shapes of all links, and notices of geoms that give none.
class ShapeReader
{
public:
	ShapeReader(
	    const Document& document, const LoadOptions& options, const GeomPairs& pairs, GeomShapes& shapes, RobotModel& model )
	    : m_document( document ), m_options( options ), m_shapes( shapes ), m_model( model )
	{
		for ( const auto& [a, b] : pairs )
		{
			m_paired.insert( a );
			m_paired.insert( b );
		}
	}
	void read( const Tree& tree );
	std::vector<PlaneLink> planes;

private:
	bool collides( const Geom& geom ) const { return geom.collides() || m_paired.count( geom.name ) != 0; }
	void readBody( const Body& body );
	std::optional<Colour> colourOf( const Body& body ) const;
	void addPlane( const Body& body, const Geom& geom, const std::string& what );
	void addShapes( const Body& body, bool visual, LinkModel& link );
	void notices( const Tree& tree );

	const Document& m_document;
	const LoadOptions& m_options;
	GeomShapes& m_shapes;
	RobotModel& m_model;
	std::set<std::string> m_paired; ///< geoms of a <pair>
	const Body* m_bodies = nullptr; ///< the first
	std::vector<std::string> m_hidden, m_used, m_margins;
	MissingMeshes m_missing;
};

/// A link of its own, which becomes an obstacle of each problem.
void ShapeReader::addPlane( const Body& body, const Geom& geom, const std::string& what )
{
	const auto taken = [&]( const std::string& name )
	{
		return std::any_of(
		    m_model.links.begin(), m_model.links.end(), [&]( const LinkModel& link ) { return link.name == name; } );
	};
	LinkModel link;
	link.name = geom.name.empty() ? "plane" : geom.name;
	while ( taken( link.name ) )
	{
		link.name += '_';
	}
	link.collision.push_back( m_shapes.plane( geom, what, link.name ) );
	link.colour = geom.colour;
	JointModel joint;
	joint.name = link.name + "/fixed";
	joint.parent = body.name;
	joint.child = link.name;
	joint.parent_from_joint = lw_transform_identity();
	planes.push_back( { link.name, static_cast<std::size_t>( &body - m_bodies ), &geom } );
	m_model.joints.push_back( joint );
	m_model.links.push_back( std::move( link ) );
}

/// @param visual geoms that collide with nothing instead of the others
void ShapeReader::addShapes( const Body& body, bool visual, LinkModel& link )
{
	const auto wanted = [&]( const Geom& geom ) { return geom.type != GeomType::PLANE && collides( geom ) != visual; };
	const auto is_sphere = [&]( const Geom& geom ) { return geom.type == GeomType::SPHERE && wanted( geom ); };
	const bool several = std::count_if( body.geoms.begin(), body.geoms.end(), is_sphere ) > 1;
	std::vector<double> spheres; // dozens of them are one shape of one tree
	for ( std::size_t i = 0; i < body.geoms.size(); ++i )
	{
		const Geom& geom = body.geoms[i];
		const std::string what =
		    geom.name.empty() ? fmt::format( "body {}, geom {}", body.name, i + 1 ) : "geom " + geom.name;
		if ( geom.type == GeomType::PLANE && collides( geom ) )
		{
			if ( body.weld != 0 )
			{
				m_document.fail( *geom.element, what, "a plane moves", "put it into <worldbody>, or use a box" );
			}
			addPlane( body, geom, what );
		}
		if ( !wanted( geom ) )
		{
			continue;
		}
		if ( geom.margin != 0 )
		{
			m_margins.push_back( what );
		}
		if ( several && is_sphere( geom ) )
		{
			spheres.insert( spheres.end(), { geom.pose.t[0], geom.pose.t[1], geom.pose.t[2], geom.size[0] } );
			continue;
		}
		const std::string missing = m_options.skip_missing_meshes ? m_shapes.missingFile( geom, what ) : "";
		if ( !missing.empty() )
		{
			m_missing.add( missing, body.name, geom.element->GetLineNum() );
			continue;
		}
		link.collision.push_back( m_shapes.make( geom, what, body.name ) );
	}
	if ( !spheres.empty() )
	{
		link.collision.push_back( m_shapes.spheres( body, spheres ) );
	}
}

/// As in a URDF: of the first geom with a colour that is there to be seen alone; else of the first that collides.
std::optional<Colour> ShapeReader::colourOf( const Body& body ) const
{
	for ( const bool seen : { true, false } )
	{
		const auto found = std::find_if( body.geoms.begin(), body.geoms.end(),
		    [&]( const Geom& geom ) { return geom.type != GeomType::PLANE && geom.colour && collides( geom ) != seen; } );
		if ( found != body.geoms.end() )
		{
			return found->colour;
		}
	}
	return std::nullopt;
}

void ShapeReader::readBody( const Body& body )
{
	LinkModel link; // planes add links
	addShapes( body, false, link );
	const bool visual =
	    std::any_of( body.geoms.begin(), body.geoms.end(), [&]( const Geom& geom ) { return !collides( geom ); } );
	if ( link.collision.empty() && visual && m_options.use_visual )
	{
		addShapes( body, true, link );
		m_used.push_back( body.name );
	}
	else if ( visual &&
	          std::none_of( body.geoms.begin(), body.geoms.end(), [&]( const Geom& geom ) { return collides( geom ); } ) )
	{
		m_hidden.push_back( body.name );
	}
	const auto found = std::find_if(
	    m_model.links.begin(), m_model.links.end(), [&]( const LinkModel& l ) { return l.name == body.name; } );
	found->collision = std::move( link.collision );
	found->colour = colourOf( body );
}

void ShapeReader::notices( const Tree& tree )
{
	std::vector<Notice>& notices = m_model.report.notices;
	const auto say = [&]( const std::string& element, const std::string& text ) {
		notices.push_back( { m_document.path(), element, text } );
	};
	if ( !m_used.empty() )
	{
		say( "<geom>",
		    fmt::format(
		        "geoms that collide with nothing (contype and conaffinity 0) are used for bodies that have no others: {}",
		        joinNames( m_used ) ) );
	}
	if ( !m_hidden.empty() )
	{
		say( "<geom>",
		    fmt::format( "bodies of which all geoms collide with nothing (contype and conaffinity 0) are not checked: {}",
		        joinNames( m_hidden ) ) );
	}
	if ( !m_margins.empty() )
	{
		say( "<geom>", fmt::format( "margins of geoms are not used, give margins of your own (--margins): {}",
		                   joinNames( m_margins, 4 ) ) );
	}
	for ( const LinkModel& link : m_model.links )
	{
		if ( link.collision.empty() )
		{
			m_model.report.links_without_geometry.push_back( link.name );
		}
	}
	const bool none = m_model.report.links_without_geometry.size() == m_model.links.size();
	m_missing.report( m_document.path(), !none, notices );
	if ( none )
	{
		throw Error( m_document.path(), "<mujoco>", "no body has a geom that collides",
		    m_hidden.empty()
		        ? fmt::format( "add <geom> elements to its {} bodies", tree.bodies.size() )
		        : "geoms that collide with nothing can be used (--visual), or change their contype and conaffinity" );
	}
}

void ShapeReader::read( const Tree& tree )
{
	m_bodies = tree.bodies.data();
	for ( const Body& body : tree.bodies )
	{
		readBody( body );
	}
	notices( tree );
}

/// A name that is none would leave a link hollow.
void checkSolid( const LoadOptions& options, const RobotModel& model )
{
	for ( const std::string& name : options.solid )
	{
		const bool known = name == "*" || std::any_of( model.links.begin(), model.links.end(),
		                                      [&]( const LinkModel& link ) { return link.name == name; } );
		if ( !known )
		{
			throw Error( model.urdf_file, "<mujoco>", fmt::format( "there is no link {} to be solid", name ),
			    "leave it out: meshes of MJCF are solid hulls" );
		}
	}
}

/// Sections that need no reading, and those that change bodies.
void checkSections( const Document& document )
{
	for ( const XMLElement* e : document.children( document.root() ) )
	{
		const std::string kind = e->Name();
		const bool flex = kind == "deformable" && !document.children( *e, "flex" ).empty();
		if ( flex )
		{
			document.fail( *document.children( *e, "flex" )[0], "<flex>", "bodies that bend are not read",
			    "remove it, or put boxes in its place" );
		}
	}
	for ( const XMLElement* e : document.inSections( "asset", "model" ) )
	{
		document.fail( *e, "<model>", "models in <asset> are not read",
		    "let MuJoCo write the model with its attachments: mj_saveLastXML()" );
	}
}

} // namespace
} // namespace mjcf

RobotModel readMjcf( std::unique_ptr<XmlFile> xml, const LoadOptions& options )
{
	using namespace mjcf;
	RobotModel model;
	const Document document( std::move( xml ) );
	std::vector<Notice>& notices = model.report.notices;
	checkSections( document );
	noticeUnknown( document, notices );
	model.urdf_file = document.path();
	const std::string name = document.optionalText( document.root(), "<mujoco>", "model" );
	model.name = name.empty() ? "mujoco" : name;
	const Compiler compiler = readCompiler( document, notices );
	const Defaults defaults( document );
	const Tree tree = readTree( document, compiler, defaults, notices );
	model.root_link = tree.bodies[0].name;
	model.planning_frame = model.root_link;
	const Couplings couplings = readCouplings( document, defaults, tree, notices );
	addLinks( document, tree, couplings, model );
	checkLimit( &Limits::links, model.links.size(), "links", document.path(), "<mujoco>" );
	checkSolid( options, model );
	const GeomPairs pairs = readGeomPairs( document, tree );
	GeomShapes shapes( document, compiler, defaults, options, model.report );
	ShapeReader reader( document, options, pairs, shapes, model );
	reader.read( tree );
	checkLimit( &Limits::links, model.links.size(), "links", document.path(), "<mujoco>" );
	addPairs( document, compiler, tree, pairs, reader.planes, model );
	addStates( document, tree, model );
	return model;
}

} // namespace leeway::io::detail
