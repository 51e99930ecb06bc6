// SPDX-License-Identifier: BSD-3-Clause
// The model of a certificate from a problem. Planar joints become two shifts and a turn, floating ones three shifts and a fixed turn.
#include "certify/model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

namespace leeway::certify
{
namespace
{

const StoredPose no_motion{ 0, 0, 0, 0, 0, 0, 1 };

/// Two Newton steps of the polar decomposition, as the core takes: a rotation to 1e-6 becomes one to rounding.
StoredPose stored( lw_transform pose )
{
	for ( int step = 0; step < 2; ++step )
	{
		double next[3][3];
		for ( int i = 0; i < 3; ++i )
		{
			for ( int j = 0; j < 3; ++j )
			{
				next[i][j] = 1.5 * pose.r[i][j];
				for ( int k = 0; k < 3; ++k )
				{
					for ( int l = 0; l < 3; ++l )
					{
						next[i][j] -= 0.5 * pose.r[i][k] * pose.r[l][k] * pose.r[l][j];
					}
				}
			}
		}
		std::copy( &next[0][0], &next[0][0] + 9, &pose.r[0][0] );
	}
	StoredPose result{ pose.t[0], pose.t[1], pose.t[2] };
	lw_transform_to_quaternion( &pose, &result[3] );
	return result;
}

/// x and y of a planar joint's plane: Duff and others 2017, as core/docs/kinematics.md has it.
std::array<Vec, 2> planeOf( const Vec& n )
{
	const double sign = n[2] < 0 ? -1 : 1, p = -1 / ( sign + n[2] ), b = n[0] * n[1] * p;
	return { Vec{ 1 + sign * n[0] * n[0] * p, sign * b, -sign * n[0] }, Vec{ b, sign + n[1] * n[1] * p, -n[1] } };
}

class Builder
{
public:
	Builder( const io::Problem& problem, const io::RobotModel& robot, const double* state, const std::string& file )
	    : m_problem( problem ), m_robot( robot ), m_core( problem.robot.get() ), m_state( state ), m_file( file )
	{
		for ( const io::JointModel& joint : robot.joints )
		{
			m_joints[joint.name] = &joint;
		}
		for ( std::uint32_t i = 0; i < problem.variables.size(); ++i )
		{
			m_group[problem.variables[i]] = i;
		}
	}
	Model build( lw_check_flags flags );

private:
	void addLinks();
	void addJoint( std::uint32_t joint );
	void addLink( const std::string& name, const std::string& joint, std::uint32_t parent, const StoredPose& origin,
	    Link::Type type, const Vec& axis, std::uint32_t variable, double multiplier = 1, double offset = 0 );
	void addFloating( std::uint32_t joint, const StoredPose& origin, std::uint32_t parent );
	void addVariables();
	std::uint32_t shapeOf( const lw_shape* shape );
	void addBodies();
	void addAllowed();
	void addMargins();
	std::string reasonOf( std::uint32_t a, std::uint32_t b ) const;

	const io::Problem& m_problem;
	const io::RobotModel& m_robot;
	const lw_robot* m_core;
	const double* m_state; ///< [group variables]
	const std::string& m_file;
	std::map<std::string, const io::JointModel*> m_joints;
	std::map<std::uint32_t, std::uint32_t> m_group; ///< robot variable -> variable of the certificate
	std::vector<std::uint32_t> m_place;             ///< link of the core -> link of the certificate
	std::map<const lw_shape*, std::uint32_t> m_shapes;
	Model m_model;
};

void Builder::addLink( const std::string& name, const std::string& joint, std::uint32_t parent, const StoredPose& origin,
    Link::Type type, const Vec& axis, std::uint32_t variable, double multiplier, double offset )
{
	Link link;
	link.name = name;
	link.joint = joint;
	link.parent = parent;
	link.origin = origin;
	link.type = type;
	link.axis = axis;
	if ( type != Link::fixed )
	{
		const auto found = variable != LW_INVALID_INDEX ? m_group.find( variable ) : m_group.end();
		link.variable = found != m_group.end() && multiplier != 0 ? found->second : nothing;
		const double constant = variable != LW_INVALID_INDEX ? multiplier * m_problem.reference[variable] : 0;
		link.multiplier = link.variable != nothing ? multiplier : 0;
		link.offset = link.variable != nothing ? offset : constant + offset;
	}
	m_model.links.push_back( std::move( link ) );
}

void Builder::addFloating( std::uint32_t joint, const StoredPose& origin, std::uint32_t parent )
{
	const std::string name = lw_robot_joint_name( m_core, joint );
	const std::uint32_t first = lw_robot_joint_variable( m_core, joint );
	StoredPose rotation = no_motion;
	for ( std::uint32_t k = 0; k < 4; ++k )
	{
		rotation[3 + k] = m_problem.reference[first + 3 + k];
		const auto found = m_group.find( first + 3 + k );
		rotation[3 + k] = found != m_group.end() ? m_state[found->second] : rotation[3 + k];
	}
	for ( std::uint32_t k = 0; k < 3; ++k )
	{
		Vec axis{ 0, 0, 0 };
		axis[k] = 1;
		addLink( name + "/" + "xyz"[k], io::variableName( m_core, first + k ), parent, k == 0 ? origin : no_motion,
		    Link::shift, axis, first + k );
		parent = static_cast<std::uint32_t>( m_model.links.size() - 1 );
	}
	addLink( lw_robot_link_name( m_core, lw_robot_joint_child( m_core, joint ) ), name, parent, rotation, Link::fixed,
	    { 0, 0, 1 }, LW_INVALID_INDEX );
}

void Builder::addJoint( std::uint32_t joint )
{
	const std::string name = lw_robot_joint_name( m_core, joint );
	const std::uint32_t core_child = lw_robot_joint_child( m_core, joint );
	const std::string child = lw_robot_link_name( m_core, core_child );
	std::uint32_t parent = m_place[lw_robot_joint_parent( m_core, joint )];
	const auto found = m_joints.find( name ); // none: an attached object
	const StoredPose origin = found != m_joints.end() ? stored( found->second->parent_from_joint ) : no_motion;
	Vec axis{ 1, 0, 0 };
	if ( found != m_joints.end() )
	{
		std::copy( found->second->axis, found->second->axis + 3, axis.begin() );
		const double size = length( axis );
		axis = size > 0 ? ( 1 / size ) * axis : Vec{ 1, 0, 0 };
	}
	const std::uint32_t first = lw_robot_joint_variable( m_core, joint );
	switch ( lw_robot_joint_type( m_core, joint ) )
	{
	case LW_JOINT_REVOLUTE:
	case LW_JOINT_CONTINUOUS:
	case LW_JOINT_PRISMATIC:
	{
		const Link::Type type = lw_robot_joint_type( m_core, joint ) == LW_JOINT_PRISMATIC ? Link::shift : Link::turn;
		double multiplier = 1, offset = 0;
		std::string at = name;
		while ( !m_joints.at( at )->mimic.empty() && m_joints.at( at )->type != LW_JOINT_FIXED )
		{
			offset += multiplier * m_joints.at( at )->mimic_offset;
			multiplier *= m_joints.at( at )->mimic_multiplier;
			at = m_joints.at( at )->mimic;
		}
		const std::uint32_t driver = lw_robot_joint_variable( m_core, lw_robot_find_joint( m_core, at.c_str() ) );
		addLink( child, name, parent, origin, type, axis, driver, multiplier, offset );
		break;
	}
	case LW_JOINT_PLANAR:
	{
		const std::array<Vec, 2> plane = planeOf( axis );
		addLink( name + "/x", name + "/x", parent, origin, Link::shift, plane[0], first );
		parent = static_cast<std::uint32_t>( m_model.links.size() - 1 );
		addLink( name + "/y", name + "/y", parent, no_motion, Link::shift, plane[1], first + 1 );
		addLink( child, name + "/theta", parent + 1, no_motion, Link::turn, axis, first + 2 );
		break;
	}
	case LW_JOINT_FLOATING:
		addFloating( joint, origin, parent );
		break;
	default:
		addLink( child, name, parent, origin, Link::fixed, axis, LW_INVALID_INDEX );
		break;
	}
	m_place[core_child] = static_cast<std::uint32_t>( m_model.links.size() - 1 );
}

void Builder::addLinks()
{
	const std::uint32_t count = lw_robot_link_count( m_core ), joints = lw_robot_joint_count( m_core );
	m_place.assign( count, nothing );
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		if ( lw_robot_link_joint( m_core, i ) == LW_INVALID_INDEX )
		{
			addLink( lw_robot_link_name( m_core, i ), "", 0, no_motion, Link::fixed, { 0, 0, 1 }, LW_INVALID_INDEX );
			m_place[i] = 0;
		}
	}
	std::vector<bool> done( joints, false );
	for ( bool more = true; more; )
	{
		more = false;
		for ( std::uint32_t joint = 0; joint < joints; ++joint )
		{
			if ( !done[joint] && m_place[lw_robot_joint_parent( m_core, joint )] != nothing )
			{
				addJoint( joint );
				done[joint] = more = true;
			}
		}
	}
}

void Builder::addVariables()
{
	for ( std::size_t i = 0; i < m_problem.variables.size(); ++i )
	{
		const lw_variable_info info = lw_robot_variable( m_core, m_problem.variables[i] );
		const double infinite = std::numeric_limits<double>::infinity();
		m_model.variables.push_back(
		    { m_problem.variable_names[i], info.wraps ? -infinite : info.lower, info.wraps ? infinite : info.upper } );
	}
}

std::uint32_t Builder::shapeOf( const lw_shape* core )
{
	const auto [found, is_new] = m_shapes.emplace( core, static_cast<std::uint32_t>( m_model.shapes.size() ) );
	if ( !is_new )
	{
		return found->second;
	}
	const lw_shape_info info = lw_shape_get_info( core );
	Shape shape;
	shape.source = lw_shape_type_name( info.type );
	shape.radius = info.dimensions[0];
	shape.height = info.dimensions[1];
	const double* at = lw_shape_vertices( core );
	switch ( info.type )
	{
	case LW_SHAPE_MESH:
		shape.kind = Kind::triangles;
		shape.solid = info.solid;
		shape.numbers.assign( at, at + 3 * std::size_t( info.vertex_count ) );
		shape.corners.assign(
		    lw_shape_triangles( core ), lw_shape_triangles( core ) + 3 * std::size_t( info.triangle_count ) );
		break;
	case LW_SHAPE_POINTS:
	case LW_SHAPE_SPHERES:
		shape.kind = Kind::balls;
		for ( std::uint32_t i = 0; i < info.vertex_count; ++i )
		{
			shape.numbers.insert( shape.numbers.end(), at + 3 * std::size_t( i ), at + 3 * std::size_t( i ) + 3 );
			shape.numbers.push_back( info.type == LW_SHAPE_POINTS ? info.dimensions[0] : lw_shape_radii( core )[i] );
		}
		break;
	case LW_SHAPE_BOXES:
		shape.kind = Kind::boxes;
		shape.numbers.assign( at, at + 3 * std::size_t( info.vertex_count ) );
		break;
	case LW_SHAPE_BOX:
		shape.kind = Kind::boxes;
		for ( int k = 0; k < 6; ++k )
		{
			shape.numbers.push_back( ( k < 3 ? -0.5 : 0.5 ) * info.dimensions[k % 3] );
		}
		break;
	case LW_SHAPE_SPHERE:
		shape.kind = Kind::balls;
		shape.numbers = { 0, 0, 0, info.dimensions[0] };
		break;
	case LW_SHAPE_CYLINDER:
		shape.kind = Kind::cylinder;
		break;
	case LW_SHAPE_CAPSULE:
		shape.kind = Kind::capsule;
		break;
	case LW_SHAPE_CONE:
		shape.kind = Kind::cone;
		break;
	case LW_SHAPE_HALFSPACE:
		shape.kind = Kind::halfspace;
		break;
	case LW_SHAPE_PLANE:
		shape.kind = Kind::plane;
		break;
	}
	if ( !shape.unbounded() && shape.count() == 0 )
	{
		throw io::Error( m_file, shape.source, "a mesh could not be read for the certificate", "see the messages about it" );
	}
	shape.arrange();
	shape.finish();
	m_model.shapes.push_back( std::move( shape ) );
	return found->second;
}

void Builder::addBodies()
{
	for ( std::uint32_t i = 0; i < lw_robot_body_count( m_core ); ++i )
	{
		const lw_body_def body = lw_robot_body( m_core, i );
		m_model.bodies.push_back( { m_place[body.link], shapeOf( body.shape ), stored( body.link_from_shape ) } );
	}
	const lw_scene* scene = m_problem.scene.get();
	for ( std::uint32_t i = 0; scene != nullptr && i < lw_scene_object_count( scene ); ++i )
	{
		m_model.objects.emplace_back( lw_scene_object_name( scene, i ) );
	}
	for ( std::uint32_t i = 0; scene != nullptr && i < lw_scene_shape_count( scene ); ++i )
	{
		const lw_scene_shape_def shape = lw_scene_shape( scene, i );
		m_model.obstacles.push_back( { shape.object, shapeOf( shape.shape ), stored( shape.world_from_shape ) } );
	}
}

std::string Builder::reasonOf( std::uint32_t a, std::uint32_t b ) const
{
	const std::string first = lw_robot_link_name( m_core, a ), second = lw_robot_link_name( m_core, b );
	for ( const io::DisabledPair& pair : m_robot.disabled )
	{
		if ( ( pair.link1 == first && pair.link2 == second ) || ( pair.link1 == second && pair.link2 == first ) )
		{
			return "SRDF: " + ( pair.reason.empty() ? std::string( "no reason given" ) : pair.reason );
		}
	}
	return lw_robot_is_attached( m_core, a ) || lw_robot_is_attached( m_core, b ) ? "attached object that may touch"
	                                                                              : "scene or command line";
}

void Builder::addAllowed()
{
	std::set<std::uint32_t> with_shapes;
	for ( std::uint32_t i = 0; i < lw_robot_body_count( m_core ); ++i )
	{
		with_shapes.insert( lw_robot_body( m_core, i ).link );
	}
	for ( const std::uint32_t a : with_shapes )
	{
		for ( const std::uint32_t b : with_shapes )
		{
			if ( a < b && lw_robot_pair_allowed( m_core, a, b ) )
			{
				m_model.allowed.push_back( { false, m_place[a], m_place[b], reasonOf( a, b ) } );
			}
		}
	}
	for ( const lw_link_object_pair& pair : m_problem.allowed )
	{
		if ( with_shapes.count( pair.link ) != 0 )
		{
			m_model.allowed.push_back( { true, m_place[pair.link], pair.object, "scene or command line" } );
		}
	}
}

void Builder::addMargins()
{
	const lw_checker* checker = m_problem.checker.get();
	const std::uint32_t links = lw_robot_link_count( m_core );
	for ( std::uint32_t a = 0; a < links; ++a )
	{
		for ( std::uint32_t o = 0; o < m_model.objects.size(); ++o )
		{
			if ( const double margin = lw_checker_environment_margin( checker, a, o ); margin != 0 )
			{
				m_model.margins.push_back( { true, m_place[a], o, margin } );
			}
		}
		for ( std::uint32_t b = a + 1; b < links; ++b )
		{
			if ( const double margin = lw_checker_self_margin( checker, a, b ); margin != 0 )
			{
				m_model.margins.push_back( { false, m_place[a], m_place[b], margin } );
			}
		}
	}
}

Model Builder::build( lw_check_flags flags )
{
	m_model.claims = flags;
	addLinks();
	addVariables();
	addBodies();
	addAllowed();
	// The reader sees the pairs that would have to be proved, not those that never move against each other
	std::vector<Allowed> all;
	all.swap( m_model.allowed );
	std::set<std::pair<std::uint32_t, std::uint32_t>> needed;
	for ( const Pair& pair : pairsOf( m_model ) )
	{
		if ( !pair.object )
		{
			needed.insert( std::minmax( m_model.bodies[pair.a].owner, m_model.bodies[pair.b].owner ) );
		}
	}
	std::copy_if( all.begin(), all.end(), std::back_inserter( m_model.allowed ),
	    [&]( const Allowed& pair ) { return pair.object || needed.count( std::minmax( pair.a, pair.b ) ) != 0; } );
	addMargins();
	return std::move( m_model );
}

/// The lowest link above both; whether variables act between.
std::uint32_t ancestorOf( const Model& model, std::uint32_t a, std::uint32_t b, bool& moves )
{
	moves = false;
	while ( a != b )
	{
		std::uint32_t& lower = a > b ? a : b;
		moves = moves || model.links[lower].variable != nothing;
		lower = model.links[lower].parent;
	}
	return a;
}

} // namespace

Model modelOf( const io::Problem& problem, const io::RobotModel& robot, const double* state, lw_check_flags flags,
    const std::string& file )
{
	return Builder( problem, robot, state, file ).build( flags );
}

std::vector<Pair> pairsOf( const Model& model )
{
	std::set<std::array<std::uint32_t, 3>> allowed;
	std::map<std::array<std::uint32_t, 3>, double> margins;
	const auto key = []( bool object, std::uint32_t a, std::uint32_t b ) {
		return std::array<std::uint32_t, 3>{
		    object ? 1U : 0U, object ? a : std::min( a, b ), object ? b : std::max( a, b ) };
	};
	for ( const Allowed& pair : model.allowed )
	{
		allowed.insert( key( pair.object, pair.a, pair.b ) );
	}
	for ( const Margin& margin : model.margins )
	{
		margins[key( margin.object, margin.a, margin.b )] = margin.value;
	}
	std::vector<Pair> pairs;
	const auto add = [&]( std::uint32_t a, std::uint32_t b, bool object, std::uint32_t owner )
	{
		const auto place = key( object, model.bodies[a].owner, owner );
		Pair pair{ a, b, object, 0, 0, false };
		pair.ancestor = ancestorOf( model, model.bodies[a].owner, object ? 0 : owner, pair.moves );
		if ( allowed.count( place ) == 0 && ( object || pair.moves ) )
		{
			const auto margin = margins.find( place );
			pair.margin = margin != margins.end() ? margin->second : 0;
			pairs.push_back( pair );
		}
	};
	for ( std::uint32_t a = 0; a < model.bodies.size() && ( model.claims & LW_CHECK_ENVIRONMENT ) != 0; ++a )
	{
		for ( std::uint32_t b = 0; b < model.obstacles.size(); ++b )
		{
			add( a, b, true, model.obstacles[b].owner );
		}
	}
	for ( std::uint32_t a = 0; a < model.bodies.size() && ( model.claims & LW_CHECK_SELF ) != 0; ++a )
	{
		for ( std::uint32_t b = a + 1; b < model.bodies.size(); ++b )
		{
			add( a, b, false, model.bodies[b].owner );
		}
	}
	return pairs;
}

} // namespace leeway::certify
