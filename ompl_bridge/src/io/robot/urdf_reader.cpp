// SPDX-License-Identifier: BSD-3-Clause
// URDF: links, collision shapes and joints. urdfdom parses; a second parse of the same document keeps the parts that urdfdom
// loses.
//
// urdfdom accepts some files that mean nothing (two joints moving one link, numbers it never looks at), refuses some that
// mean something (capsules), forgets the order of the file and prints to the console. So this reader checks the document
// first, removes the parts that urdfdom need not see, and puts urdfdom's output into the error or a notice.
#include "robot/colours.hpp"
#include "robot/urdf_reader.hpp"

#include "robot/plausibility.hpp"
#include "robot/prepare_shapes.hpp"
#include "shape/geometry_loader.hpp"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <mutex>
#include <set>

namespace leeway::io::detail
{

namespace
{

using tinyxml2::XMLElement;

/// Collects urdfdom's messages instead of printing them. console_bridge has one handler per process, hence the lock.
class ConsoleCapture : public console_bridge::OutputHandler
{
public:
	ConsoleCapture() : m_lock( mutex() ), m_previous( console_bridge::getOutputHandler() )
	{
		console_bridge::useOutputHandler( this );
	}
	~ConsoleCapture() override { console_bridge::useOutputHandler( m_previous ); }
	void log( const std::string& text, console_bridge::LogLevel level, const char*, int ) override
	{
		if ( level >= console_bridge::CONSOLE_BRIDGE_LOG_WARN )
		{
			lines.push_back( text );
		}
	}

	std::vector<std::string> lines;

private:
	static std::mutex& mutex()
	{
		static std::mutex lock;
		return lock;
	}
	std::lock_guard<std::mutex> m_lock;
	console_bridge::OutputHandler* m_previous;
};

std::string collisionName( const std::string& link, std::size_t index )
{
	return fmt::format( "link {}, collision {}", link, index + 1 );
}

void checkOrigin( const XmlFile& xml, const XMLElement& parent, const std::string& what )
{
	for ( const XMLElement& origin : children( parent, "origin" ) )
	{
		for ( const char* attribute : { "xyz", "rpy", "quat_xyzw" } )
		{
			if ( origin.Attribute( attribute ) != nullptr )
			{
				xml.numbers( origin, what, attribute, std::strcmp( attribute, "quat_xyzw" ) == 0 ? 4 : 3 );
			}
		}
	}
}

/// The <origin> of a joint or collision; quat_xyzw (URDF 1.2) instead of rpy if it is there.
lw_transform readOrigin(
    const XmlFile& xml, const XMLElement& parent, const std::string& what, std::vector<Notice>& notices )
{
	lw_transform transform = lw_transform_identity();
	const XMLElement* origin = parent.FirstChildElement( "origin" );
	if ( origin == nullptr )
	{
		return transform;
	}
	std::vector<double> zero( 3, 0.0 );
	std::vector<double> xyz = origin->Attribute( "xyz" ) != nullptr ? xml.numbers( *origin, what, "xyz", 3 ) : zero;
	if ( origin->Attribute( "quat_xyzw" ) == nullptr )
	{
		std::vector<double> rpy = origin->Attribute( "rpy" ) != nullptr ? xml.numbers( *origin, what, "rpy", 3 ) : zero;
		require( lw_transform_from_rpy( xyz.data(), rpy.data(), &transform ), "lw_transform_from_rpy" );
		return transform;
	}
	std::vector<double> q = xml.numbers( *origin, what, "quat_xyzw", 4 );
	double norm = std::sqrt( q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] );
	if ( lw_transform_from_quaternion( xyz.data(), q.data(), &transform ) != LW_OK )
	{
		xml.fail( *origin, what, "quat_xyzw is the zero quaternion", "write 0 0 0 1 for no rotation" );
	}
	if ( std::fabs( norm - 1 ) > quaternion_notice_threshold )
	{
		notices.push_back(
		    { xml.path(), xml.place( *origin, what ), fmt::format( "quaternion of length {:.6g} was normalised", norm ) } );
	}
	return transform;
}

void checkGeometry( const XmlFile& xml, const XMLElement& collision, const std::string& what )
{
	const XMLElement* geometry = collision.FirstChildElement( "geometry" );
	const XMLElement* shape = geometry != nullptr ? geometry->FirstChildElement() : nullptr;
	if ( shape == nullptr )
	{
		xml.fail( collision, what, "has no shape", "add <geometry> with a box, sphere, cylinder, capsule or mesh" );
	}
	if ( shape->NextSiblingElement() != nullptr )
	{
		xml.fail( *geometry, what, "has several shapes in one <geometry>", "write one <collision> for each shape" );
	}
	std::string type = shape->Name();
	if ( type == "box" )
	{
		xml.numbers( *shape, what, "size", 3 );
	}
	else if ( type == "sphere" )
	{
		xml.numbers( *shape, what, "radius", 1 );
	}
	else if ( type == "cylinder" || type == "capsule" )
	{
		xml.numbers( *shape, what, "radius", 1 );
		xml.numbers( *shape, what, "length", 1 );
	}
	else if ( type == "mesh" )
	{
		xml.text( *shape, what, "filename" );
		if ( shape->Attribute( "scale" ) != nullptr )
		{
			xml.numbers( *shape, what, "scale", 3 );
		}
	}
	else
	{
		xml.fail( *shape, what, fmt::format( "shape <{}> is not supported", type ),
		    type == "plane" ? "give it as a plane of a planning scene (planes: [{coef: [a, b, c, d]}])"
		                    : "use a box, sphere, cylinder, capsule or mesh" );
	}
	checkOrigin( xml, collision, what );
}

void checkLinks( const XmlFile& xml, std::set<std::string>& links )
{
	for ( const XMLElement& link : children( xml.root(), "link" ) )
	{
		std::string name = xml.text( link, "link", "name" );
		if ( !links.insert( name ).second )
		{
			xml.fail( link, "link " + name, "a link of this name was defined before", "rename or remove one of them" );
		}
		std::size_t index = 0;
		for ( const XMLElement& collision : children( link, "collision" ) )
		{
			checkGeometry( xml, collision, collisionName( name, index++ ) );
		}
	}
	checkLimit( &Limits::links, links.size(), "links", xml.path(), "<robot>" );
	if ( links.empty() )
	{
		const bool srdf = xml.root().FirstChildElement( "group" ) != nullptr ||
		                  xml.root().FirstChildElement( "disable_collisions" ) != nullptr;
		const bool xacro = xml.root().Attribute( "xmlns:xacro" ) != nullptr;
		throw Error( xml.path(), "<robot>", srdf ? "this is an SRDF: it has no links" : "has no links",
		    srdf    ? "give the URDF as the robot, and this file as its SRDF"
		    : xacro ? "it may come of a xacro file that only defines macros: expand the file that uses them"
		            : "give a URDF with at least one <link>" );
	}
}

void checkJoint( const XmlFile& xml, const XMLElement& joint, const std::string& what, const std::set<std::string>& links )
{
	std::string type = xml.text( joint, what, "type" );
	const std::vector<std::string> types = { "revolute", "continuous", "prismatic", "fixed", "planar", "floating" };
	if ( std::find( types.begin(), types.end(), type ) == types.end() )
	{
		xml.fail( joint, what, fmt::format( "type {} is not known", type ), "use one of " + joinNames( types ) );
	}
	for ( const char* end : { "parent", "child" } )
	{
		const XMLElement* e = joint.FirstChildElement( end );
		if ( e == nullptr )
		{
			xml.fail( joint, what, fmt::format( "has no <{}>", end ), fmt::format( "add <{} link=\"...\"/>", end ) );
		}
		std::string link = xml.text( *e, what, "link" );
		if ( links.count( link ) == 0 )
		{
			xml.fail(
			    *e, what, fmt::format( "{} link {} is not defined", end, link ), "define the link or correct its name" );
		}
	}
	checkOrigin( xml, joint, what );
	bool has_axis = type == "revolute" || type == "continuous" || type == "prismatic" || type == "planar";
	if ( const XMLElement* axis = joint.FirstChildElement( "axis" ); axis != nullptr && has_axis )
	{
		std::vector<double> xyz = xml.numbers( *axis, what, "xyz", 3 );
		if ( xyz[0] == 0 && xyz[1] == 0 && xyz[2] == 0 )
		{
			xml.fail( *axis, what, "the axis is zero", "write a direction such as 0 0 1" );
		}
	}
	const XMLElement* limit = joint.FirstChildElement( "limit" );
	if ( limit == nullptr && ( type == "revolute" || type == "prismatic" ) )
	{
		xml.fail( joint, what, fmt::format( "is {} and has no <limit>", type ),
		    "add <limit lower=\"...\" upper=\"...\" effort=\"...\" velocity=\"...\"/>, or make it continuous" );
	}
	if ( limit != nullptr )
	{
		for ( const char* attribute : { "lower", "upper", "effort", "velocity", "acceleration", "jerk" } )
		{
			if ( limit->Attribute( attribute ) != nullptr )
			{
				xml.numbers( *limit, what, attribute, 1 );
			}
		}
	}
	if ( const XMLElement* mimic = joint.FirstChildElement( "mimic" ) )
	{
		xml.text( *mimic, what, "joint" );
		for ( const char* attribute : { "multiplier", "offset" } )
		{
			if ( mimic->Attribute( attribute ) != nullptr )
			{
				xml.numbers( *mimic, what, attribute, 1 );
			}
		}
	}
}

/// One root, and every link hangs on it. urdfdom would find several roots too, but it builds a cycle before it sees it and
/// never frees it.
/// @param joint_above the joint that moves each link but the root
void checkTree(
    const XmlFile& xml, const std::set<std::string>& links, const std::map<std::string, const XMLElement*>& joint_above )
{
	std::vector<std::string> roots;
	for ( const std::string& link : links )
	{
		if ( joint_above.count( link ) == 0 )
		{
			roots.push_back( link );
		}
		std::string at = link;
		for ( std::size_t steps = 0; joint_above.count( at ) != 0; ++steps )
		{
			const XMLElement& joint = *joint_above.at( at );
			if ( steps > links.size() )
			{
				xml.fail( joint, fmt::format( "joint {}", joint.Attribute( "name" ) ), "is part of a cycle of joints",
				    "a robot is a tree of links: remove one joint of the cycle" );
			}
			at = joint.FirstChildElement( "parent" )->Attribute( "link" );
		}
	}
	if ( roots.size() > 1 )
	{
		throw Error( xml.path(), "<robot>",
		    fmt::format( "has {} root links (links that no joint moves): {}", roots.size(), joinNames( roots ) ),
		    "connect all but one to a parent by a joint" );
	}
}

void checkJoints( const XmlFile& xml, const std::set<std::string>& links )
{
	std::map<std::string, const XMLElement*> joint_above;
	std::set<std::string> joints;
	for ( const XMLElement& joint : children( xml.root(), "joint" ) )
	{
		std::string name = xml.text( joint, "joint", "name" );
		if ( !joints.insert( name ).second )
		{
			xml.fail( joint, "joint " + name, "a joint of this name was defined before", "rename or remove one of them" );
		}
		checkJoint( xml, joint, "joint " + name, links );
		std::string child = joint.FirstChildElement( "child" )->Attribute( "link" );
		auto [other, first] = joint_above.emplace( child, &joint );
		if ( !first )
		{
			xml.fail( joint, "joint " + name,
			    fmt::format( "link {} is already the child of joint {}", child, other->second->Attribute( "name" ) ),
			    "a link can be the child of one joint only" );
		}
	}
	for ( const XMLElement& joint : children( xml.root(), "joint" ) )
	{
		const XMLElement* mimic = joint.FirstChildElement( "mimic" );
		if ( mimic != nullptr && joints.count( mimic->Attribute( "joint" ) ) == 0 )
		{
			xml.fail( *mimic, fmt::format( "joint {}", joint.Attribute( "name" ) ),
			    fmt::format( "mimics joint {}, which is not defined", mimic->Attribute( "joint" ) ), "correct the name" );
		}
	}
	checkTree( xml, links, joint_above );
}

/// The document for urdfdom: without visual, inertial and dynamic data, and with capsules as cylinders (urdfdom knows none).
std::string textForUrdfdom( const XmlFile& xml )
{
	tinyxml2::XMLDocument copy;
	xml.document().DeepCopy( &copy );
	XMLElement* robot = copy.RootElement();
	for ( XMLElement* e = robot->FirstChildElement(); e != nullptr; )
	{
		XMLElement* next = e->NextSiblingElement();
		if ( std::strcmp( e->Name(), "link" ) != 0 && std::strcmp( e->Name(), "joint" ) != 0 )
		{
			robot->DeleteChild( e );
		}
		e = next;
	}
	for ( XMLElement* link = robot->FirstChildElement( "link" ); link != nullptr; link = link->NextSiblingElement( "link" ) )
	{
		for ( const char* unused : { "visual", "inertial" } )
		{
			while ( XMLElement* e = link->FirstChildElement( unused ) )
			{
				link->DeleteChild( e );
			}
		}
		for ( XMLElement* c = link->FirstChildElement( "collision" ); c != nullptr;
		      c = c->NextSiblingElement( "collision" ) )
		{
			if ( XMLElement* capsule = c->FirstChildElement( "geometry" )->FirstChildElement( "capsule" ) )
			{
				capsule->SetName( "cylinder" );
			}
			if ( c->FirstChildElement( "material" ) != nullptr )
			{
				c->DeleteChild( c->FirstChildElement( "material" ) );
			}
		}
	}
	for ( XMLElement* joint = robot->FirstChildElement( "joint" ); joint != nullptr;
	      joint = joint->NextSiblingElement( "joint" ) )
	{
		// no clearance depends on these, and urdfdom refuses the whole file for a limit without effort or velocity
		for ( const char* unused : { "dynamics", "calibration", "safety_controller" } )
		{
			while ( XMLElement* e = joint->FirstChildElement( unused ) )
			{
				joint->DeleteChild( e );
			}
		}
		for ( const char* unused : { "effort", "velocity" } )
		{
			XMLElement* limit = joint->FirstChildElement( "limit" );
			if ( limit != nullptr && limit->Attribute( unused ) == nullptr )
			{
				limit->SetAttribute( unused, "0" );
			}
		}
	}
	tinyxml2::XMLPrinter printer;
	copy.Print( &printer );
	return printer.CStr();
}

urdf::ModelInterfaceSharedPtr parseByUrdfdom( const XmlFile& xml, std::vector<Notice>& notices )
{
	ConsoleCapture console;
	urdf::ModelInterfaceSharedPtr urdf;
	try
	{
		urdf = urdf::parseURDF( textForUrdfdom( xml ) );
	}
	catch ( const std::exception& e )
	{
		console.lines.push_back( e.what() );
	}
	if ( !urdf )
	{
		throw Error( xml.path(), "<robot>",
		    fmt::format(
		        "urdfdom cannot read it: {}", console.lines.empty() ? "no reason given" : joinNames( console.lines, 4 ) ),
		    "correct the element it names" );
	}
	for ( const std::string& line : console.lines )
	{
		notices.push_back( { xml.path(), "<robot>", "urdfdom says: " + line } );
	}
	return urdf;
}

Shape readShape( const XmlFile& xml, const XMLElement& collision, const std::string& what, const std::string& link,
    const urdf::Geometry& geometry, bool solid, ShapeLoader& shapes, GeometryLoader& solids )
{
	ShapeLoader::Place place{ xml.path(), xml.place( collision, what ), link };
	switch ( geometry.type )
	{
	case urdf::Geometry::SPHERE:
		return shapes.primitive( place, LW_SHAPE_SPHERE, { static_cast<const urdf::Sphere&>( geometry ).radius, 0, 0 } );
	case urdf::Geometry::BOX:
	{
		const urdf::Vector3& dim = static_cast<const urdf::Box&>( geometry ).dim;
		return shapes.primitive( place, LW_SHAPE_BOX, { dim.x, dim.y, dim.z } );
	}
	case urdf::Geometry::CYLINDER:
	{
		const urdf::Cylinder& cylinder = static_cast<const urdf::Cylinder&>( geometry );
		bool capsule = collision.FirstChildElement( "geometry" )->FirstChildElement( "capsule" ) != nullptr;
		// Both give the length without the caps
		return shapes.primitive(
		    place, capsule ? LW_SHAPE_CAPSULE : LW_SHAPE_CYLINDER, { cylinder.radius, cylinder.length, 0 } );
	}
	case urdf::Geometry::MESH:
	{
		const urdf::Mesh& mesh = static_cast<const urdf::Mesh&>( geometry );
		std::array<double, 3> scale = { mesh.scale.x, mesh.scale.y, mesh.scale.z };
		return solid ? solids.solidMesh( place, mesh.filename, scale ) : shapes.mesh( place, mesh.filename, scale );
	}
	}
	xml.fail( collision, what, "unknown geometry", "use a box, sphere, cylinder, capsule or mesh" );
}

lw_joint_type jointType( const urdf::Joint& joint )
{
	switch ( joint.type )
	{
	case urdf::Joint::REVOLUTE:
		return LW_JOINT_REVOLUTE;
	case urdf::Joint::CONTINUOUS:
		return LW_JOINT_CONTINUOUS;
	case urdf::Joint::PRISMATIC:
		return LW_JOINT_PRISMATIC;
	case urdf::Joint::FLOATING:
		return LW_JOINT_FLOATING;
	case urdf::Joint::PLANAR:
		return LW_JOINT_PLANAR;
	default:
		return LW_JOINT_FIXED;
	}
}

JointModel readJoint( const XmlFile& xml, const XMLElement& element, const urdf::Joint& joint, std::vector<Notice>& notices )
{
	std::string what = "joint " + joint.name;
	JointModel model;
	model.name = joint.name;
	model.type = jointType( joint );
	model.parent = joint.parent_link_name;
	model.child = joint.child_link_name;
	model.parent_from_joint = readOrigin( xml, element, what, notices );
	if ( model.type != LW_JOINT_FIXED && model.type != LW_JOINT_FLOATING )
	{
		model.axis[0] = joint.axis.x;
		model.axis[1] = joint.axis.y;
		model.axis[2] = joint.axis.z;
	}
	bool limited = model.type == LW_JOINT_REVOLUTE || model.type == LW_JOINT_PRISMATIC;
	if ( joint.limits )
	{
		model.velocity = joint.limits->velocity;
		const XMLElement& limit = *element.FirstChildElement( "limit" ); // urdfdom 3 does not know all of them
		model.acceleration = limit.DoubleAttribute( "acceleration" );
		model.jerk = limit.DoubleAttribute( "jerk" );
		if ( limited )
		{
			model.lower = joint.limits->lower;
			model.upper = joint.limits->upper;
		}
	}
	if ( model.lower > model.upper )
	{
		// Bullet takes this for no limits, other programs for a mistake
		xml.fail( element, what, fmt::format( "lower limit {} is above upper limit {}", model.lower, model.upper ),
		    model.type == LW_JOINT_REVOLUTE ? "swap or correct them; if it turns without limits, make it continuous"
		                                    : "swap or correct them" );
	}
	if ( joint.mimic && model.type != LW_JOINT_FIXED )
	{
		model.mimic = joint.mimic->joint_name;
		model.mimic_multiplier = joint.mimic->multiplier;
		model.mimic_offset = joint.mimic->offset;
	}
	return model;
}

/// The two XML parsers may differ on odd characters; a name that urdfdom does not know must not be looked into.
void requireRead( const XmlFile& xml, const XMLElement& element, bool known )
{
	if ( !known )
	{
		xml.fail( element, fmt::format( "{} {}", element.Name(), element.Attribute( "name" ) ), "urdfdom did not read it",
		    "use letters, digits and _ in names" );
	}
}

bool isSolid( const LoadOptions& options, const std::string& link )
{
	return std::any_of(
	    options.solid.begin(), options.solid.end(), [&]( const std::string& name ) { return name == link || name == "*"; } );
}

/// A name that is none would leave a link hollow.
void checkSolid( const XmlFile& xml, const LoadOptions& options, const std::set<std::string>& links )
{
	for ( const std::string& name : options.solid )
	{
		if ( name != "*" && links.count( name ) == 0 )
		{
			throw Error(
			    xml.path(), "<robot>", fmt::format( "there is no link {} to be solid", name ), "name a link, or * for all" );
		}
	}
}

/// Links given as spheres have dozens of them: from two on they are one shape of one tree.
class SphereCollector
{
public:
	/// @return whether the element is left to finish()
	bool take( const urdf::LinkConstSharedPtr& link, const XmlFile& xml, const XMLElement& collision,
	    const std::string& what, const urdf::Geometry& geometry, std::vector<Notice>& notices )
	{
		if ( geometry.type != urdf::Geometry::SPHERE || !hasSeveral( *link ) )
		{
			return false;
		}
		double radius = static_cast<const urdf::Sphere&>( geometry ).radius;
		if ( !( radius > 0 ) )
		{
			xml.fail( collision, what, fmt::format( "sphere radius {} is not a solid", radius ), "give a radius above 0" );
		}
		lw_transform pose = readOrigin( xml, collision, what, notices );
		m_spheres.insert( m_spheres.end(), { pose.t[0], pose.t[1], pose.t[2], radius } );
		return true;
	}
	void finish( const ShapeLoader::Place& place, GeometryLoader& geometry, LinkModel& link )
	{
		if ( !m_spheres.empty() )
		{
			link.collision.push_back( { geometry.spheres( place, m_spheres ), lw_transform_identity() } );
		}
	}

private:
	static bool hasSeveral( const urdf::Link& link )
	{
		return std::count_if( link.collision_array.begin(), link.collision_array.end(),
		           []( const urdf::CollisionSharedPtr& c )
		           { return c->geometry && c->geometry->type == urdf::Geometry::SPHERE; } ) > 1;
	}

	std::vector<double> m_spheres; ///< x, y, z, radius in the link's frame
};

/// Limits that are left out are 0, which hardly anybody means.
void noticeMissingLimits( const XmlFile& xml, std::vector<Notice>& notices )
{
	std::vector<std::string> joints;
	for ( const XMLElement& joint : children( xml.root(), "joint" ) )
	{
		const std::string type = joint.Attribute( "type" );
		if ( type != "revolute" && type != "prismatic" )
		{
			continue;
		}
		const XMLElement& limit = *joint.FirstChildElement( "limit" );
		const bool lower = limit.Attribute( "lower" ) != nullptr, upper = limit.Attribute( "upper" ) != nullptr;
		if ( !lower || !upper )
		{
			const char* missing = lower ? "upper" : upper ? "lower" : "both";
			joints.push_back( fmt::format( "{} {} (line {})", joint.Attribute( "name" ), missing, joint.GetLineNum() ) );
		}
	}
	if ( !joints.empty() )
	{
		notices.push_back( { xml.path(), "<limit>",
		    fmt::format( "limits that are missing are 0, as in any URDF: {}", joinNames( joints ) ) } );
	}
}

LinkModel readLink( const XmlFile& xml, const XMLElement& element, const urdf::ModelInterface& urdf,
    const LoadOptions& options, ShapeLoader& shapes, GeometryLoader& geometry, std::vector<Notice>& notices )
{
	LinkModel link;
	link.name = element.Attribute( "name" );
	urdf::LinkConstSharedPtr urdf_link = urdf.getLink( link.name );
	requireRead( xml, element, urdf_link != nullptr );
	const std::vector<urdf::CollisionSharedPtr>& collisions = urdf_link->collision_array;
	SphereCollector spheres;
	std::size_t index = 0;
	for ( const XMLElement& collision : children( element, "collision" ) )
	{
		std::string what = collisionName( link.name, index );
		if ( index >= collisions.size() || !collisions[index]->geometry )
		{
			xml.fail( collision, what, "urdfdom did not read it", "check its <geometry>" );
		}
		const urdf::Geometry& given = *collisions[index++]->geometry;
		if ( spheres.take( urdf_link, xml, collision, what, given, notices ) )
		{
			continue;
		}
		PlacedShape placed;
		placed.pose = readOrigin( xml, collision, what, notices );
		placed.shape = readShape( xml, collision, what, link.name, given, isSolid( options, link.name ), shapes, geometry );
		link.collision.push_back( std::move( placed ) );
	}
	spheres.finish( { xml.path(), xml.place( element, "link " + link.name ), link.name }, geometry, link );
	return link;
}

void readLinks( const XmlFile& xml, const urdf::ModelInterface& urdf, const LoadOptions& options, RobotModel& model )
{
	ShapeLoader shapes( options, model.report );
	GeometryLoader geometry( options, model.report );
	std::vector<std::string> visual;
	for ( const XMLElement& element : children( xml.root(), "link" ) )
	{
		LinkModel link = readLink( xml, element, urdf, options, shapes, geometry, model.report.notices );
		link.colour = linkColour( xml, element );
		if ( link.collision.empty() )
		{
			model.report.links_without_geometry.push_back( link.name );
			if ( element.FirstChildElement( "visual" ) != nullptr )
			{
				visual.push_back( link.name );
			}
		}
		model.links.push_back( std::move( link ) );
	}
	if ( model.report.links_without_geometry.size() == model.links.size() )
	{
		throw Error( xml.path(), "<robot>", "no link has collision geometry",
		    visual.empty() ? "add <collision> elements to its links"
		                   : "its visual geometry can be used (--visual), or add <collision> elements to its links" );
	}
	if ( !visual.empty() )
	{
		model.report.notices.push_back( { xml.path(), "<robot>",
		    fmt::format( "links that have visual but no collision geometry are not checked: {}", joinNames( visual ) ) } );
	}
}

} // namespace

RobotModel readUrdf( XmlFile& xml, const LoadOptions& options )
{
	RobotModel model;
	xml.requireRobot( "URDF" );
	prepareShapes( xml, options, model.report.notices );
	xml.requireUtf8( xml.root(), "<robot>", "name" );
	std::set<std::string> links;
	checkLinks( xml, links );
	checkJoints( xml, links );
	checkSolid( xml, options, links );

	model.urdf_file = xml.path();
	urdf::ModelInterfaceSharedPtr urdf = parseByUrdfdom( xml, model.report.notices );
	model.name = urdf->getName();
	model.root_link = urdf->getRoot()->name;
	model.planning_frame = model.root_link;
	for ( const XMLElement& element : children( xml.root(), "joint" ) )
	{
		urdf::JointConstSharedPtr joint = urdf->getJoint( element.Attribute( "name" ) );
		model.joints.push_back( readJoint( xml, element, *joint, model.report.notices ) );
	}
	noticeMissingLimits( xml, model.report.notices );
	noticeOddLimits( model, model.report.notices );
	readLinks( xml, *urdf, options, model );
	return model;
}

} // namespace leeway::io::detail
