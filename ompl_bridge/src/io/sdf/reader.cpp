// SPDX-License-Identifier: BSD-3-Clause
// SDF as a robot: libsdformat reads the file, its includes and its frames; links and joints of all models become one tree whose root is
// the world.
//
// A joint of SDF has a frame of its own, which need not be that of its child link. Where they differ, a link without geometry stands in
// the frame of the joint, and the child is fixed to it, so that links keep their frames.
#include "sdf/sdf.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <limits>
#include <stdexcept>

namespace leeway::io::detail
{

namespace sdf
{
namespace
{

using ::ignition::math::Vector3d;

const char* const world_name = "world"; // SDF reserves it
constexpr double half_turn = 3.14159265358979323846;
constexpr double no_limit = 1e15; // libsdformat's own infinity is 1e16

/// The first few errors of libsdformat.
std::string wordsOf( const ::sdf::Errors& errors )
{
	std::vector<std::string> words;
	for ( const ::sdf::Error& error : errors )
	{
		words.push_back(
		    error.LineNumber() ? fmt::format( "line {}: {}", *error.LineNumber(), error.Message() ) : error.Message() );
	}
	return joinNames( words, 3 );
}

/// Where libsdformat looks for model://NAME of an <include>: a folder with model.config, or a file.
std::string findModel( const std::string& uri, const std::string& file, const LoadOptions& options )
{
	const bool scheme = uri.find( "://" ) != std::string::npos;
	std::vector<Notice> ignored; // a model that is guessed would be another world
	for ( const std::string tail : { "/model.config", "" } )
	{
		if ( hasResource( uri + tail, file, options ) )
		{
			const std::filesystem::path found = findResource( "model", uri + tail, file, "<include>", options, ignored );
			return tail.empty() ? found.string() : found.parent_path().string();
		}
		if ( !scheme && std::filesystem::is_regular_file( uri ) )
		{
			return uri;
		}
	}
	return "";
}

/// A joint of a model whose frame has this pose in the world.
struct GivenJoint
{
	const ::sdf::Joint* joint;
	std::string scope; ///< "arm::", or empty
	Pose3d model;      ///< in the world
};

class Reader
{
public:
	Reader( const std::string& file, const LoadOptions& options )
	    : m_file( file ), m_options( options ), m_shapes( file, options, m_robot.report )
	{
	}
	RobotModel read();

private:
	[[noreturn]] void fail( const std::string& what, const ::sdf::ElementPtr& element, const std::string& problem,
	    const std::string& remedy ) const
	{
		throw Error( m_file, placeOf( what, element ), problem, remedy );
	}
	void require( const ::sdf::Errors& errors, const std::string& what, const ::sdf::ElementPtr& element ) const
	{
		if ( !errors.empty() )
		{
			fail( what, element, wordsOf( errors ), "correct it" );
		}
	}
	void load( ::sdf::Root& root );
	void addModel( const ::sdf::Model& model, const std::string& scope, const Pose3d& pose, bool is_static );
	void addLink( const ::sdf::Link& link, const std::string& name, const Pose3d& pose );
	void addJoint( const GivenJoint& given );
	std::vector<JointModel> partsOf( const GivenJoint& given, const std::string& name );
	void addMoving( const std::vector<JointModel>& parts, JointModel place, const Pose3d& joint_from_child );
	void setAxis( const GivenJoint& given, unsigned index, const std::string& what, JointModel& joint ) const;
	void append( JointModel joint, const std::string& child );
	void holdTheRest();
	void allowFixed();
	void checkNames() const;

	const std::string& m_file;
	const LoadOptions& m_options;
	RobotModel m_robot;
	Shapes m_shapes;
	std::map<std::string, Pose3d> m_poses; ///< of links in the world
	std::vector<GivenJoint> m_joints;
	std::map<std::string, std::size_t> m_above; ///< joint of the robot above each link
	std::vector<std::string> m_static, m_planes;
	std::vector<std::string> m_loops; ///< joints whose child has one already
};

/// libsdformat throws out of std::stoi for a version that is no number.
::sdf::Errors loaded( ::sdf::Root& root, const std::string& file, const ::sdf::ParserConfig& config )
{
	try
	{
		return root.Load( file, config );
	}
	catch ( const std::logic_error& error )
	{
		throw Error( file, "<sdf>", fmt::format( "libsdformat takes a text for a number and fails ({})", error.what() ),
		    "write version=\"1.9\", or the number that the file was written for" );
	}
}

void Reader::load( ::sdf::Root& root )
{
	::sdf::Console::Instance()->SetQuiet( true );
	::sdf::ParserConfig config;
	config.SetFindCallback( [&]( const std::string& uri ) { return findModel( uri, m_file, m_options ); } );
	config.SetWarningsPolicy( ::sdf::EnforcementPolicy::LOG );
	config.SetUnrecognizedElementsPolicy( ::sdf::EnforcementPolicy::LOG );
	::sdf::Errors errors = loaded( root, m_file, config );
	errors.erase(
	    std::remove_if( errors.begin(), errors.end(), // no pose or shape depends on these; a notice tells them below
	        []( const ::sdf::Error& error ) { return error.Code() == ::sdf::ErrorCode::LINK_INERTIA_INVALID; } ),
	    errors.end() );
	if ( !errors.empty() )
	{
		throw Error(
		    m_file, "<sdf>", wordsOf( errors ), "correct the file; name folders of included models by --package-path" );
	}
	// Once more, and strictly, for the warnings that libsdformat would only have printed
	config.SetWarningsPolicy( ::sdf::EnforcementPolicy::ERR );
	config.SetUnrecognizedElementsPolicy( ::sdf::EnforcementPolicy::ERR );
	::sdf::Root strict;
	if ( const ::sdf::Errors warnings = loaded( strict, m_file, config ); !warnings.empty() )
	{
		m_robot.report.notices.push_back(
		    { m_file, "<sdf>", fmt::format( "{} warnings of libsdformat: {}", warnings.size(), wordsOf( warnings ) ) } );
	}
}

void Reader::addLink( const ::sdf::Link& link, const std::string& name, const Pose3d& pose )
{
	LinkModel model;
	model.name = name;
	std::vector<PlacedShape> planes;
	model.collision = m_shapes.read( link, name, planes );
	m_poses[name] = pose;
	m_robot.links.push_back( std::move( model ) );
	for ( PlacedShape& plane : planes )
	{
		LinkModel floor;
		floor.name = name + "/plane" + std::string( m_planes.empty() ? "" : std::to_string( m_planes.size() + 1 ) );
		floor.collision.push_back( std::move( plane ) );
		m_planes.push_back( floor.name );
		m_poses[floor.name] = pose;
		JointModel joint;
		joint.name = floor.name + "/fixed";
		joint.parent = name;
		joint.parent_from_joint = lw_transform_identity();
		m_robot.links.push_back( floor );
		append( std::move( joint ), floor.name );
	}
}

void Reader::addModel( const ::sdf::Model& model, const std::string& scope, const Pose3d& pose, bool is_static )
{
	for ( std::uint64_t i = 0; i < model.LinkCount(); ++i )
	{
		const ::sdf::Link& link = *model.LinkByIndex( i );
		Pose3d in_model;
		require( link.SemanticPose().Resolve( in_model, "__model__" ), "link " + scope + link.Name(), link.Element() );
		addLink( link, scope + link.Name(), pose * in_model );
		if ( is_static || model.Static() )
		{
			m_static.push_back( scope + link.Name() );
		}
	}
	for ( std::uint64_t i = 0; i < model.JointCount(); ++i )
	{
		m_joints.push_back( { model.JointByIndex( i ), scope, pose } );
	}
	for ( std::uint64_t i = 0; i < model.ModelCount(); ++i )
	{
		const ::sdf::Model& nested = *model.ModelByIndex( i );
		Pose3d in_model;
		require(
		    nested.SemanticPose().Resolve( in_model, "__model__" ), "model " + scope + nested.Name(), nested.Element() );
		addModel( nested, scope + nested.Name() + "::", pose * in_model, is_static || model.Static() );
	}
}

/// Adds a joint, whose parent and frame are set, above a link.
void Reader::append( JointModel joint, const std::string& child )
{
	joint.child = child;
	m_above.emplace( child, m_robot.joints.size() );
	m_robot.joints.push_back( std::move( joint ) );
}

void Reader::setAxis( const GivenJoint& given, unsigned index, const std::string& what, JointModel& joint ) const
{
	const ::sdf::JointAxis* axis = given.joint->Axis( index );
	if ( axis == nullptr )
	{
		fail( what, given.joint->Element(), "has no axis", "add <axis>" );
	}
	Vector3d xyz;
	require( axis->ResolveXyz( xyz ), what, given.joint->Element() );
	for ( unsigned i = 0; i < 3; ++i )
	{
		joint.axis[i] = xyz[i];
	}
	const bool slides = given.joint->Type() == ::sdf::JointType::PRISMATIC;
	const bool from = axis->Lower() > -no_limit, to = axis->Upper() < no_limit;
	const bool endless = given.joint->Type() == ::sdf::JointType::CONTINUOUS || ( !from && !to );
	const double infinity = std::numeric_limits<double>::infinity();
	joint.type = slides ? LW_JOINT_PRISMATIC : endless ? LW_JOINT_CONTINUOUS : LW_JOINT_REVOLUTE;
	if ( joint.type != LW_JOINT_CONTINUOUS )
	{
		joint.lower = from ? axis->Lower() : -infinity;
		joint.upper = to ? axis->Upper() : infinity;
	}
	if ( joint.lower > joint.upper )
	{
		fail( what, given.joint->Element(),
		    fmt::format( "lower limit {} is above upper limit {}", joint.lower, joint.upper ), "swap or correct them" );
	}
	if ( joint.type == LW_JOINT_REVOLUTE && from != to )
	{
		fail( what, given.joint->Element(), "turns and has a limit on one side only", "give both limits, or none" );
	}
	const double velocity = axis->MaxVelocity();
	joint.velocity = velocity > 0 && velocity < no_limit ? velocity : 0;
}

/// The joints of the robot that a joint of SDF is, without their places.
std::vector<JointModel> Reader::partsOf( const GivenJoint& given, const std::string& name )
{
	const ::sdf::JointType type = given.joint->Type();
	std::vector<JointModel> parts;
	if ( type == ::sdf::JointType::BALL ) // every turn is one about x, y and z, as with MJCF
	{
		for ( int axis = 0; axis < 3; ++axis )
		{
			JointModel part;
			part.name = name + "_" + "xyz"[axis];
			part.axis[0] = 0;
			part.axis[axis] = 1;
			part.type = axis == 1 ? LW_JOINT_REVOLUTE : LW_JOINT_CONTINUOUS;
			part.lower = axis == 1 ? -half_turn / 2 : 0;
			part.upper = axis == 1 ? half_turn / 2 : 0;
			parts.push_back( part );
		}
		m_robot.report.notices.push_back( { m_file, "joint " + name, "a ball joint is three hinges, about x, y and z" } );
		return parts;
	}
	const bool two = type == ::sdf::JointType::REVOLUTE2 || type == ::sdf::JointType::UNIVERSAL;
	for ( unsigned index = 0; index < ( two ? 2u : 1u ); ++index )
	{
		JointModel part;
		part.name = two ? fmt::format( "{}/{}", name, index + 1 ) : name;
		setAxis( given, index, "joint " + part.name, part );
		parts.push_back( part );
	}
	return parts;
}

/// One joint after the other, with links between them that have no geometry.
void Reader::addMoving( const std::vector<JointModel>& parts, JointModel place, const Pose3d& joint_from_child )
{
	const std::string name = place.name, child = place.child;
	const lw_transform rest = transformOf( joint_from_child );
	const lw_transform same = lw_transform_identity();
	const bool apart = std::memcmp( &rest, &same, sizeof( rest ) ) != 0;
	for ( const JointModel& part : parts )
	{
		JointModel joint = part;
		joint.parent = place.parent;
		joint.parent_from_joint = place.parent_from_joint;
		const bool last = &part == &parts.back() && !apart;
		LinkModel between;
		between.name = part.name + "/moved";
		append( joint, last ? child : between.name );
		if ( !last )
		{
			m_robot.links.push_back( between );
			place.parent = between.name;
			place.parent_from_joint = same;
		}
	}
	if ( apart )
	{
		place.name = name + "/child";
		place.parent_from_joint = rest;
		append( place, child );
	}
}

void Reader::addJoint( const GivenJoint& given )
{
	const ::sdf::Joint& joint = *given.joint;
	const std::string name = given.scope + joint.Name(), what = "joint " + name;
	std::string parent, child;
	require( joint.ResolveParentLink( parent ), what, joint.Element() );
	require( joint.ResolveChildLink( child ), what, joint.Element() );
	if ( child == world_name )
	{
		fail( what, joint.Element(), "its child is the world", "make the world its parent" );
	}
	const bool fixed_to_world = parent == world_name;
	JointModel model;
	model.parent = fixed_to_world ? world_name : given.scope + parent;
	model.child = given.scope + child;
	for ( const std::string& link : { model.parent, model.child } )
	{
		if ( link != world_name && m_poses.count( link ) == 0 )
		{
			fail( what, joint.Element(), fmt::format( "there is no link {}", link ), "correct the name" );
		}
	}
	if ( m_above.count( model.child ) != 0 )
	{
		m_loops.push_back( fmt::format( "{} at {}", name, model.child ) );
		return;
	}
	Pose3d in_model;
	require( joint.SemanticPose().Resolve( in_model, "__model__" ), what, joint.Element() );
	const Pose3d frame = given.model * in_model;
	model.name = name;
	model.parent_from_joint =
	    transformOf( ( fixed_to_world ? Pose3d::Zero : m_poses.at( model.parent ) ).Inverse() * frame );
	const Pose3d joint_from_child = frame.Inverse() * m_poses.at( model.child );
	switch ( joint.Type() )
	{
	case ::sdf::JointType::FIXED:
	{
		const lw_transform rest = transformOf( joint_from_child );
		model.parent_from_joint = lw_transform_multiply( &model.parent_from_joint, &rest );
		append( model, std::string( model.child ) );
		return;
	}
	case ::sdf::JointType::REVOLUTE:
	case ::sdf::JointType::CONTINUOUS:
	case ::sdf::JointType::PRISMATIC:
	case ::sdf::JointType::REVOLUTE2:
	case ::sdf::JointType::UNIVERSAL:
	case ::sdf::JointType::BALL:
		addMoving( partsOf( given, name ), model, joint_from_child );
		return;
	default:
		fail( what, joint.Element(), "is a screw or a gearbox, which are not read",
		    "use revolute and prismatic joints in its place, or fix it" );
	}
}

/// Links that no joint holds are fixed to the world.
void Reader::holdTheRest()
{
	std::vector<std::string> free;
	for ( const auto& [name, pose] : m_poses )
	{
		if ( m_above.count( name ) == 0 )
		{
			JointModel joint;
			joint.name = name + "/fixed";
			joint.parent = world_name;
			joint.parent_from_joint = transformOf( pose );
			append( std::move( joint ), name );
			if ( std::find( m_static.begin(), m_static.end(), name ) == m_static.end() )
			{
				free.push_back( name );
			}
		}
	}
	if ( !free.empty() )
	{
		m_robot.report.notices.push_back( { m_file, "<sdf>",
		    fmt::format(
		        "links that no joint holds stand where the file places them ({}): {}", free.size(), joinNames( free ) ) } );
	}
	for ( const LinkModel& link : m_robot.links )
	{
		std::string at = link.name;
		for ( std::size_t steps = 0; at != world_name; ++steps )
		{
			if ( steps > m_robot.links.size() )
			{
				throw Error( m_file, "link " + link.name, "is part of a cycle of joints",
				    "a robot is a tree of links: remove one joint of the cycle" );
			}
			at = m_robot.joints[m_above.at( at )].parent;
		}
	}
}

/// A plane is no obstacle to links that stand on it for good.
void Reader::allowFixed()
{
	const auto is_fixed = [&]( std::string at )
	{
		while ( at != world_name && m_robot.joints[m_above.at( at )].type == LW_JOINT_FIXED )
		{
			at = m_robot.joints[m_above.at( at )].parent;
		}
		return at == world_name;
	};
	for ( const std::string& plane : m_planes )
	{
		if ( !is_fixed( plane ) )
		{
			throw Error( m_file, "link " + m_robot.joints[m_above.at( plane )].parent, "has a plane and moves",
			    "put the plane into a static model, or use a box" );
		}
		for ( const LinkModel& link : m_robot.links )
		{
			if ( link.name != plane && !link.collision.empty() && is_fixed( link.name ) )
			{
				m_robot.disabled.push_back( { plane, link.name, "fixed to the world in the SDF" } );
			}
		}
	}
}

void Reader::checkNames() const
{
	for ( const std::string& name : m_options.solid )
	{
		if ( name != "*" && m_poses.count( name ) == 0 )
		{
			throw Error(
			    m_file, "<sdf>", fmt::format( "there is no link {} to be solid", name ), "name a link, or * for all" );
		}
	}
	checkLimit( &Limits::links, m_robot.links.size(), "links", m_file, "<sdf>" );
}

RobotModel Reader::read()
{
	::sdf::Root root;
	load( root );
	m_robot.urdf_file = m_file;
	m_robot.root_link = m_robot.planning_frame = world_name;
	LinkModel world;
	world.name = world_name;
	m_robot.links.push_back( world );
	if ( root.WorldCount() > 1 )
	{
		throw Error( m_file, "<sdf>", fmt::format( "has {} worlds", root.WorldCount() ), "keep one of them" );
	}
	if ( root.WorldCount() == 1 )
	{
		const ::sdf::World& given = *root.WorldByIndex( 0 );
		m_robot.name = given.Name();
		for ( std::uint64_t i = 0; i < given.ModelCount(); ++i )
		{
			const ::sdf::Model& model = *given.ModelByIndex( i );
			Pose3d pose;
			require( model.SemanticPose().Resolve( pose, world_name ), "model " + model.Name(), model.Element() );
			addModel( model, model.Name() + "::", pose, false );
		}
	}
	else if ( root.Model() != nullptr )
	{
		m_robot.name = root.Model()->Name();
		addModel( *root.Model(), "", root.Model()->RawPose(), false );
	}
	if ( m_poses.empty() )
	{
		throw Error( m_file, "<sdf>", "has no model with links", "give a file with a <model>, or a <world> of models" );
	}
	checkNames();
	const auto is_read = []( const GivenJoint& given )
	{
		const ::sdf::JointType type = given.joint->Type();
		return type != ::sdf::JointType::SCREW && type != ::sdf::JointType::GEARBOX;
	};
	std::stable_partition( m_joints.begin(), m_joints.end(), is_read ); // the others may close loops of these
	for ( const GivenJoint& joint : m_joints )
	{
		addJoint( joint );
	}
	if ( !m_loops.empty() )
	{
		m_robot.report.notices.push_back( { m_file, "<joint>",
		    fmt::format( "joints that close loops are not held ({}), links move as if they were not there: {}",
		        m_loops.size(), joinNames( m_loops ) ) } );
	}
	holdTheRest();
	m_shapes.finish();
	allowFixed();
	for ( const LinkModel& link : m_robot.links )
	{
		if ( link.collision.empty() )
		{
			m_robot.report.links_without_geometry.push_back( link.name );
		}
	}
	return std::move( m_robot );
}

} // namespace
} // namespace sdf

RobotModel readSdf( const std::string& file, const LoadOptions& options )
{
	return sdf::Reader( file, options ).read();
}

} // namespace leeway::io::detail
