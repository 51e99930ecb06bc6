// SPDX-License-Identifier: BSD-3-Clause
// The kinematic tree of an MJCF model: bodies with their joints and geoms; frames and replicas are resolved.
//
// Semantics are those of MuJoCo's XML reference; gaps in it were tried with MuJoCo 4.0.
#include "mjcf/tree.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

namespace leeway::io::detail::mjcf
{

namespace
{

/// The place of the walk: the body, the pose that frames and replicas around the element add, and the default class.
struct Place
{
	std::size_t body = 0;
	lw_transform pose = lw_transform_identity();
	std::string child_class;
	std::string suffix; ///< of names in replicas
};

/// Elements of a body that change neither kinematics nor contacts.
constexpr const char* passed_over[] = { "inertial", "site", "camera", "light", "plugin" };

class TreeReader
{
public:
	TreeReader( const Document& document, const Compiler& compiler, const Defaults& defaults, std::vector<Notice>& notices )
	    : m_document( document ), m_compiler( compiler ), m_defaults( defaults ), m_poses( document, compiler, defaults ),
	      m_colours( document, defaults ), m_notices( notices )
	{
	}
	Tree read();

private:
	void readChildren( const XMLElement& parent, const Place& place );
	void readBody( const XMLElement& e, const Place& place );
	void readFrame( const XMLElement& e, const Place& place );
	void readReplicas( const XMLElement& e, const Place& place );
	void readJoint( const XMLElement& e, const Place& place );
	void readRange( const XMLElement& e, const Place& place, Joint& joint );
	void readGeom( const XMLElement& e, const Place& place );
	void readSize( const XMLElement& e, const Place& place, const std::string& what, Geom& geom );
	void checkJoints( const Body& body );
	void findWelds();
	std::string nameOf( const XMLElement& e, const std::string& what, const Place& place ) const;
	std::string childClass( const XMLElement& e, const std::string& what, const Place& place ) const;

	const Document& m_document;
	const Compiler& m_compiler;
	const Defaults& m_defaults;
	Poses m_poses;
	Colours m_colours;
	std::vector<Notice>& m_notices;
	Tree m_tree;
	std::map<std::string, std::size_t> m_names; ///< of bodies
	std::set<std::string> m_joint_names;
	std::size_t m_geom_count = 0;
};

/// The own name with the suffix of the replica; empty if it has none.
std::string TreeReader::nameOf( const XMLElement& e, const std::string& what, const Place& place ) const
{
	const std::string name = m_document.optionalText( e, what, "name" );
	return name.empty() ? name : name + place.suffix;
}

std::string TreeReader::childClass( const XMLElement& e, const std::string& what, const Place& place ) const
{
	const std::string own = m_document.optionalText( e, what, "childclass" );
	m_defaults.requireClass( e, what, own );
	return own.empty() ? place.child_class : own;
}

void TreeReader::readChildren( const XMLElement& parent, const Place& place )
{
	for ( const XMLElement* child : m_document.children( parent ) )
	{
		const std::string kind = child->Name();
		if ( kind == "body" )
		{
			readBody( *child, place );
		}
		else if ( kind == "geom" )
		{
			readGeom( *child, place );
		}
		else if ( kind == "joint" || kind == "freejoint" )
		{
			readJoint( *child, place );
		}
		else if ( kind == "frame" )
		{
			readFrame( *child, place );
		}
		else if ( kind == "replicate" )
		{
			readReplicas( *child, place );
		}
		else if ( kind == "attach" || kind == "composite" || kind == "flexcomp" )
		{
			m_document.fail( *child, fmt::format( "<{}>", kind ), fmt::format( "<{}> is not read", kind ),
			    kind == "attach" ? "let MuJoCo write the model with its attachments: mj_saveLastXML()"
			                     : "remove it, or put boxes in its place: bodies that bend are not checked" );
		}
		else if ( std::find_if( std::begin( passed_over ), std::end( passed_over ),
		              [&]( const char* known ) { return kind == known; } ) == std::end( passed_over ) )
		{
			m_document.fail( *child, fmt::format( "<{}>", kind ), fmt::format( "<{}> is not known in a body", kind ),
			    "use body, frame, joint, freejoint or geom" );
		}
	}
}

void TreeReader::readFrame( const XMLElement& e, const Place& place )
{
	for ( const char* scaling : { "scale", "massscale" } )
	{
		if ( std::strcmp( scaling, "scale" ) == 0 && e.Attribute( scaling ) != nullptr )
		{
			m_document.fail(
			    e, "frame", "scale of a <frame> is not read", "let MuJoCo write the compiled model: mj_saveLastXML()" );
		}
	}
	Place inner = place;
	const lw_transform pose = m_poses.own( e, "frame" );
	inner.pose = lw_transform_multiply( &place.pose, &pose );
	inner.child_class = childClass( e, "frame", place );
	readChildren( e, inner );
}

/// Replica i stands at the i-th power of the offset; each gets its number as a suffix, all of the same length.
void TreeReader::readReplicas( const XMLElement& e, const Place& place )
{
	const std::string what = "replicate";
	const std::int64_t count = m_document.integer( e, what, "count" );
	if ( count < 1 )
	{
		m_document.fail( e, what, fmt::format( "count {} is not positive", count ), "give a number from 1 on" );
	}
	checkLimit( &Limits::links, static_cast<std::uint64_t>( count ), "replicas", m_document.path(), "replicate" );
	const std::vector<double> zero( 3, 0.0 );
	const std::vector<double> offset =
	    e.Attribute( "offset" ) != nullptr ? m_document.numbers( e, what, "offset", 3, 3 ) : zero;
	const std::vector<double> euler =
	    e.Attribute( "euler" ) != nullptr ? m_document.numbers( e, what, "euler", 3, 3 ) : zero;
	const lw_transform turn = m_poses.turn( zero, euler );
	const std::string separator = m_document.optionalText( e, what, "sep" );
	const std::size_t digits = std::to_string( count ).size();
	Place inner = place;
	for ( std::int64_t i = 0; i < count; ++i )
	{
		// the innermost suffix stands first
		inner.suffix = fmt::format( "{}{:0{}}{}", separator, i, digits, place.suffix );
		readChildren( e, inner );
		const lw_transform shift = shiftBy( offset[0], offset[1], offset[2] );
		inner.pose = lw_transform_multiply( &inner.pose, &shift );
		inner.pose = lw_transform_multiply( &inner.pose, &turn );
	}
}

void TreeReader::readBody( const XMLElement& e, const Place& place )
{
	Body body;
	const std::size_t index = m_tree.bodies.size();
	body.name = nameOf( e, "body", place );
	body.element = &e;
	body.parent = place.body;
	const std::string what = body.name.empty() ? fmt::format( "body {}", index ) : "body " + body.name;
	checkLimit( &Limits::links, index, "bodies", m_document.path(), what );
	if ( !body.name.empty() && !m_names.emplace( body.name, index ).second )
	{
		m_document.fail( e, what, "a body of this name was defined before", "rename or remove one of them" );
	}
	const lw_transform own = m_poses.own( e, what );
	body.pose = lw_transform_multiply( &place.pose, &own );
	body.mocap = e.Attribute( "mocap" ) != nullptr && m_document.word( e, what, "mocap", { "true", "false" } ) == "true";
	Place inner;
	inner.body = index;
	inner.child_class = childClass( e, what, place );
	inner.suffix = place.suffix;
	m_tree.bodies.push_back( body );
	readChildren( e, inner );
	checkJoints( m_tree.bodies[index] );
}

void TreeReader::readRange( const XMLElement& e, const Place& place, Joint& joint )
{
	const std::string what = "joint " + joint.name;
	const XMLElement* range = m_defaults.find( e, place.child_class, "range" );
	const XMLElement* limited = m_defaults.find( e, place.child_class, "limited" );
	const std::string wanted =
	    limited != nullptr ? m_document.word( *limited, what, "limited", { "true", "false", "auto" } ) : "auto";
	const std::vector<double> given = range != nullptr ? m_document.range( *range, what ) : std::vector<double>( 2, 0.0 );
	if ( wanted == "false" || ( wanted == "auto" && range == nullptr ) )
	{
		return;
	}
	const bool turns = joint.type != Joint::SLIDE;
	if ( std::isinf( given[0] ) && std::isinf( given[1] ) && given[0] < given[1] )
	{
		return; // no limits
	}
	if ( turns && !( std::isfinite( given[0] ) && std::isfinite( given[1] ) ) )
	{
		m_document.fail( *range, what, "has a limit on one side only", "give both limits, or none" );
	}
	if ( given[0] > given[1] )
	{
		m_document.fail( *range, what, fmt::format( "lower limit {} is above upper limit {}", given[0], given[1] ),
		    "swap or correct them" );
	}
	if ( wanted == "auto" && !m_compiler.auto_limits && given[0] != given[1] )
	{
		m_document.fail( *range, what, "has a range, and nothing says whether it is limited (autolimits is false)",
		    "add limited=\"true\" or limited=\"false\"" );
	}
	if ( given[0] == given[1] )
	{
		if ( wanted == "true" )
		{
			m_document.fail( *limited, what, fmt::format( "is limited, and its range is from {0} to {0}", given[0] ),
			    "give a range, or remove the joint" );
		}
		return; // an empty range is none
	}
	joint.limited = true;
	joint.lower = turns ? m_compiler.angle( given[0] ) : given[0];
	joint.upper = turns ? m_compiler.angle( given[1] ) : given[1];
}

void TreeReader::readJoint( const XMLElement& e, const Place& place )
{
	if ( place.body == 0 )
	{
		m_document.fail( e, fmt::format( "<{}>", e.Name() ), "the world has a joint", "put it into a <body>" );
	}
	Body& body = m_tree.bodies[place.body];
	Joint joint;
	joint.element = &e;
	joint.name = nameOf( e, "joint", place );
	const std::string what = joint.name.empty() ? fmt::format( "joint of body {}", body.name ) : "joint " + joint.name;
	if ( !joint.name.empty() && !m_joint_names.insert( joint.name ).second )
	{
		m_document.fail( e, what, "a joint of this name was defined before", "rename or remove one of them" );
	}
	const bool free = std::strcmp( e.Name(), "freejoint" ) == 0;
	const auto carrier = [&]( const char* attribute )
	{ return free ? nullptr : m_defaults.find( e, place.child_class, attribute ); };
	if ( const XMLElement* type = carrier( "type" ) )
	{
		const std::string word = m_document.word( *type, what, "type", { "hinge", "slide", "ball", "free" } );
		joint.type = word == "slide"  ? Joint::SLIDE
		             : word == "ball" ? Joint::BALL
		             : word == "free" ? Joint::FREE
		                              : Joint::HINGE;
	}
	joint.type = free ? Joint::FREE : joint.type;
	if ( joint.type == Joint::FREE )
	{
		const bool align =
		    e.Attribute( "align" ) != nullptr && m_document.word( e, what, "align", { "true", "false", "auto" } ) != "auto"
		        ? m_document.word( e, what, "align", { "true", "false", "auto" } ) == "true"
		        : m_compiler.align_free;
		if ( align )
		{
			m_notices.push_back( m_document.notice(
			    e, what, "is not aligned with the inertia of its body: values of the joint differ from MuJoCo's" ) );
		}
		body.joints.push_back( joint );
		return;
	}
	const XMLElement* position = carrier( "pos" );
	const XMLElement* axis = carrier( "axis" );
	const XMLElement* reference = carrier( "ref" );
	const std::vector<double> p =
	    position != nullptr ? m_document.numbers( *position, what, "pos", 3, 3 ) : std::vector<double>( 3, 0.0 );
	const std::vector<double> a =
	    axis != nullptr ? m_document.numbers( *axis, what, "axis", 3, 3 ) : std::vector<double>{ 0, 0, 1 };
	const lw_vec3 point = lw_transform_point( &place.pose, { p[0], p[1], p[2] } );
	std::copy_n( &point.x, 3, joint.position );
	const double length = std::hypot( a[0], a[1], a[2] );
	const bool has_axis = joint.type != Joint::BALL;
	if ( has_axis && !( length > 1e-14 && std::isfinite( length ) ) )
	{
		m_document.fail( *axis, what, "the axis is zero", "write a direction such as 0 0 1" );
	}
	for ( std::size_t k = 0; has_axis && k < 3; ++k )
	{
		joint.axis[k] = ( place.pose.r[k][0] * a[0] + place.pose.r[k][1] * a[1] + place.pose.r[k][2] * a[2] ) / length;
	}
	if ( reference != nullptr && has_axis )
	{
		const double value = m_document.numbers( *reference, what, "ref", 1, 1 )[0];
		joint.reference = joint.type == Joint::HINGE ? m_compiler.angle( value ) : value;
	}
	readRange( e, place, joint );
	body.joints.push_back( joint );
}

void TreeReader::checkJoints( const Body& body )
{
	const std::string what = "body " + body.name;
	const auto count = [&]( Joint::Type type )
	{
		return std::count_if(
		    body.joints.begin(), body.joints.end(), [&]( const Joint& joint ) { return joint.type == type; } );
	};
	if ( count( Joint::FREE ) > 0 && ( body.joints.size() > 1 || body.parent != 0 ) )
	{
		m_document.fail( *body.element, what,
		    body.parent != 0 ? "has a free joint and is no child of the world" : "has joints beside its free joint",
		    "a free body is a child of <worldbody> and has one joint" );
	}
	if ( count( Joint::BALL ) > 0 && count( Joint::BALL ) + count( Joint::HINGE ) > 1 )
	{
		m_document.fail(
		    *body.element, what, "has a ball joint and another joint that turns", "put one of them into a body between" );
	}
	if ( body.mocap && ( !body.joints.empty() || body.parent != 0 ) )
	{
		m_document.fail( *body.element, what, "is a mocap body with joints or below another body",
		    "a mocap body stands in <worldbody> and has no joint" );
	}
	if ( body.mocap )
	{
		m_notices.push_back(
		    m_document.notice( *body.element, what, "is a mocap body: it is fixed where the file places it" ) );
	}
}

/// @param type of the geom, for the numbers that it needs
std::size_t sizeCount( GeomType type )
{
	switch ( type )
	{
	case GeomType::SPHERE:
		return 1;
	case GeomType::CAPSULE:
	case GeomType::CYLINDER:
		return 2;
	case GeomType::BOX:
	case GeomType::ELLIPSOID:
		return 3;
	default:
		return 0; // a plane's size is for pictures; those of assets are theirs
	}
}

void TreeReader::readSize( const XMLElement& e, const Place& place, const std::string& what, Geom& geom )
{
	const XMLElement* size = m_defaults.find( e, place.child_class, "size" );
	const XMLElement* ends = m_defaults.find( e, place.child_class, "fromto" );
	const std::size_t needed = sizeCount( geom.type );
	if ( needed == 0 )
	{
		return;
	}
	if ( size != nullptr )
	{
		const std::vector<double> numbers = m_document.numbers( *size, what, "size", 1, 3 );
		std::copy( numbers.begin(), numbers.end(), geom.size );
	}
	if ( ends != nullptr )
	{
		if ( geom.type == GeomType::SPHERE )
		{
			m_document.fail( *ends, what, "a sphere has no fromto", "use a capsule, cylinder, box or ellipsoid" );
		}
		double length = 0;
		const lw_transform pose = m_poses.between( *ends, what, length );
		geom.pose = lw_transform_multiply( &place.pose, &pose );
		geom.size[needed - 1] = 0.5 * length;
		geom.size[1] = needed == 3 ? geom.size[0] : geom.size[1];
	}
	for ( std::size_t i = 0; i < needed; ++i )
	{
		if ( !( geom.size[i] > 0 ) )
		{
			m_document.fail( size != nullptr ? *size : e, what,
			    fmt::format( "size {} is {}: a {} needs {} above 0", i + 1, geom.size[i], "geom of this type", needed ),
			    "give the sizes, which are half of the edges and radii" );
		}
	}
}

void TreeReader::readGeom( const XMLElement& e, const Place& place )
{
	Body& body = m_tree.bodies[place.body];
	Geom geom;
	geom.element = &e;
	geom.name = nameOf( e, "geom", place );
	const std::string what =
	    geom.name.empty() ? fmt::format( "{}, geom {}", body.name.empty() ? "a body without a name" : "body " + body.name,
	                            body.geoms.size() + 1 )
	                      : "geom " + geom.name;
	checkLimit( &Limits::objects, ++m_geom_count, "geoms", m_document.path(), what );
	const auto carrier = [&]( const char* attribute ) { return m_defaults.find( e, place.child_class, attribute ); };
	if ( const XMLElement* type = carrier( "type" ) )
	{
		const std::vector<std::string> types = {
		    "plane", "hfield", "sphere", "capsule", "ellipsoid", "cylinder", "box", "mesh" };
		const std::string word = m_document.text( *type, what, "type" );
		if ( word == "sdf" )
		{
			m_document.fail(
			    *type, what, "type sdf is a function in a plugin of MuJoCo and is not read", "give a mesh of its surface" );
		}
		m_document.word( *type, what, "type", types );
		geom.type = static_cast<GeomType>( std::find( types.begin(), types.end(), word ) - types.begin() );
	}
	const auto mask = [&]( const char* attribute )
	{
		const XMLElement* found = carrier( attribute );
		return found != nullptr ? static_cast<std::uint32_t>( m_document.integer( *found, what, attribute ) ) : 1u;
	};
	geom.contype = mask( "contype" );
	geom.conaffinity = mask( "conaffinity" );
	geom.colour = m_colours.of( e, place.child_class );
	const XMLElement* mesh = carrier( "mesh" );
	const XMLElement* field = carrier( "hfield" );
	geom.asset = geom.type == GeomType::MESH && mesh != nullptr      ? m_document.text( *mesh, what, "mesh" )
	             : geom.type == GeomType::HFIELD && field != nullptr ? m_document.text( *field, what, "hfield" )
	                                                                 : "";
	if ( geom.asset.empty() && ( geom.type == GeomType::MESH || geom.type == GeomType::HFIELD ) )
	{
		m_document.fail(
		    e, what, "names no asset", geom.type == GeomType::MESH ? "add mesh=\"...\"" : "add hfield=\"...\"" );
	}
	const lw_transform pose = m_poses.ofClass( e, what, place.child_class );
	geom.pose = lw_transform_multiply( &place.pose, &pose );
	const bool fitted = mesh != nullptr && sizeCount( geom.type ) > 0;
	if ( fitted && geom.collides() )
	{
		m_document.fail( e, what,
		    fmt::format( "MuJoCo fits a shape to mesh {}, and that is not read", mesh->Attribute( "mesh" ) ),
		    "write type=\"mesh\" for its convex hull, or give the sizes of the shape" );
	}
	if ( !fitted )
	{
		readSize( e, place, what, geom );
	}
	if ( const XMLElement* margin = carrier( "margin" ) )
	{
		geom.margin = m_document.numbers( *margin, what, "margin", 1, 1 )[0];
	}
	body.geoms.push_back( geom );
}

void TreeReader::findWelds()
{
	for ( std::size_t i = 1; i < m_tree.bodies.size(); ++i )
	{
		Body& body = m_tree.bodies[i];
		body.weld = body.joints.empty() && !body.mocap ? m_tree.bodies[body.parent].weld : i;
	}
}

Tree TreeReader::read()
{
	Body world;
	world.name = "world";
	world.element = &m_document.root();
	world.pose = lw_transform_identity();
	m_tree.bodies.push_back( world );
	m_names.emplace( world.name, 0 );
	for ( const XMLElement* section : m_document.children( m_document.root(), "worldbody" ) )
	{
		Place place;
		m_tree.bodies[0].element = section;
		place.child_class = childClass( *section, "worldbody", place );
		readChildren( *section, place );
	}
	findWelds();
	// names for those that have none; names of the file keep theirs
	for ( std::size_t i = 1; i < m_tree.bodies.size(); ++i )
	{
		Body& body = m_tree.bodies[i];
		for ( std::string name = fmt::format( "body{}", i ); body.name.empty(); name += '_' )
		{
			body.name = m_names.emplace( name, i ).second ? name : "";
		}
		for ( Joint& joint : body.joints )
		{
			for ( std::string name = body.name + "/joint"; joint.name.empty(); name += '_' )
			{
				joint.name = m_joint_names.insert( name ).second ? name : "";
			}
		}
	}
	return std::move( m_tree );
}

} // namespace

Tree readTree( const Document& document, const Compiler& compiler, const Defaults& defaults, std::vector<Notice>& notices )
{
	return TreeReader( document, compiler, defaults, notices ).read();
}

} // namespace leeway::io::detail::mjcf
