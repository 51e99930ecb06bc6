// SPDX-License-Identifier: BSD-3-Clause
// kitchen_hulls: a robot and where parts of it can get to, as binary glTF: motion hulls and their spheres, see-through.
#include "stage.hpp"

#include <fmt/format.h>

// qhull's C headers have no linkage of their own
extern "C"
{
#include <libqhull_r/qhull_ra.h>
}

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace
{

using namespace kitchen;

struct Options
{
	std::string robot, colours, still;
	std::vector<std::string> hulls, spheres; ///< links, from the largest on: each has the next colour
	std::map<std::string, double> joints;
};

constexpr double crease = 0.35; ///< radians: a hull's facets are seen where it is coarse
/// One for every part in turn, by opacity: inner parts are denser, so that they show through outer ones.
const Surface tints[] = { { "blue", { 0.10, 0.42, 0.92, 0.16 }, 0.35, 0 },
    { "magenta", { 0.88, 0.14, 0.50, 0.26 }, 0.35, 0 }, { "orange", { 1.0, 0.42, 0.0, 0.40 }, 0.35, 0 } };

struct Triangles
{
	std::vector<double> vertices;
	std::vector<uint32_t> corners;
};

/// Facets of the convex hull, counter-clockwise seen from outside. @throws std::runtime_error
Triangles convexHull( const double* points, size_t count )
{
	Triangles hull;
	hull.vertices.assign( points, points + 3 * count );
	qhT state;
	qhT* qh = &state;
	qh_zero( qh, nullptr );
	char command[] = "qhull Qt";
	const int failed =
	    qh_new_qhull( qh, 3, static_cast<int>( count ), hull.vertices.data(), False, command, nullptr, nullptr );
	if ( !failed )
	{
		for ( const facetT* facet = qh->facet_list; facet && facet->next; facet = facet->next )
		{
			std::array<uint32_t, 3> corner{};
			for ( int k = 0; k < 3; ++k )
			{
				const auto* vertex = static_cast<const vertexT*>( facet->vertices->e[k].p );
				corner[static_cast<size_t>( k )] = static_cast<uint32_t>( ( vertex->point - hull.vertices.data() ) / 3 );
			}
			if ( facet->toporient != qh_ORIENTclock )
				std::swap( corner[0], corner[1] );
			hull.corners.insert( hull.corners.end(), corner.begin(), corner.end() );
		}
	}
	qh_freeqhull( qh, qh_ALL );
	if ( failed )
		throw std::runtime_error( fmt::format( "qhull gives up on {} points (status {})", count, failed ) );
	return hull;
}

double volume( const Triangles& hull )
{
	double six_times = 0;
	for ( size_t t = 0; t < hull.corners.size(); t += 3 )
	{
		const double *a = &hull.vertices[3 * hull.corners[t]], *b = &hull.vertices[3 * hull.corners[t + 1]],
		             *c = &hull.vertices[3 * hull.corners[t + 2]];
		six_times += a[0] * ( b[1] * c[2] - b[2] * c[1] ) + a[1] * ( b[2] * c[0] - b[0] * c[2] ) +
		             a[2] * ( b[0] * c[1] - b[1] * c[0] );
	}
	return six_times / 6;
}

/// A photographer's paper: floor that bends up to a wall behind the robot, which looks along x.
Triangles backdrop()
{
	constexpr double front = 5, bend = -2.2, radius = 1.5, height = 6, half_width = 9;
	constexpr uint32_t steps = 24;
	std::vector<std::array<double, 2>> profile = { { front, 0 } }; // x, z
	for ( uint32_t i = 0; i <= steps; ++i )
	{
		const double angle = 0.5 * M_PI * i / steps;
		profile.push_back( { bend - radius * std::sin( angle ), radius * ( 1 - std::cos( angle ) ) } );
	}
	profile.push_back( { bend - radius, height } );
	Triangles paper;
	for ( const auto& [x, z] : profile )
		paper.vertices.insert( paper.vertices.end(), { x, half_width, z, x, -half_width, z } );
	for ( uint32_t i = 0; i + 2 < 2 * profile.size(); i += 2 )
		paper.corners.insert( paper.corners.end(), { i, i + 2, i + 1, i + 1, i + 2, i + 3 } );
	return paper;
}

/// The picture and its source.
class Picture
{
public:
	explicit Picture( const Options& options )
	    : m_options( options ), m_model( io::loadRobot( options.robot, "" ) ), m_robot( io::buildRobot( m_model ) ),
	      m_stage( m_model, m_robot.get(), options.colours ), m_poses( lw_robot_link_count( m_robot.get() ) )
	{
		io::ReachOptions reach;
		reach.def.seconds = 0; // hulls are all that is drawn: nothing is spent on pairs
		reach.def.samples = 0;
		m_reach = io::loadReach( m_robot, reach ).reach;
		for ( const Surface& tint : tints )
			m_stage.colours.define( tint );
		std::vector<double> state( lw_robot_variable_count( m_robot.get() ) );
		lw_robot_default_state( m_robot.get(), state.data() );
		std::map<std::string, double> left = options.joints;
		for ( uint32_t v = 0; v < state.size(); ++v )
		{
			const auto joint = left.find( io::variableName( m_robot.get(), v ) );
			if ( joint != left.end() )
			{
				state[v] = joint->second;
				left.erase( joint );
			}
		}
		if ( !left.empty() )
			throw io::Error(
			    options.robot, "--joint " + left.begin()->first, "is no variable of the robot", "see `leeway info`" );
		leeway::require( lw_robot_fk( m_robot.get(), state.data(), m_poses.data() ), "forward kinematics" );
	}

	std::string draw()
	{
		m_stage.addRobot( m_poses );
		m_stage.colours.define( { "paper", { 0.78, 0.79, 0.81, 1 }, 1, 0 } );
		m_stage.gltf.addNode( "backdrop", -1, { 0, 0, 0 }, { 0, 0, 0, 1 },
		    m_stage.gltf.addMesh( addGeometry( backdrop() ), m_stage.colours.material( "paper" ) ) );
		fmt::print( "{:<28} {:>6} {:>11} {:>10} {:>9} {:>10}\n", "M of", "points", "dilation mm", "excess mm", "volume l",
		    "sphere l" );
		for ( size_t i = 0; i < m_options.hulls.size(); ++i )
			drawHull( i );
		for ( size_t i = 0; i < m_options.spheres.size(); ++i )
			drawSphere( i );
		return m_stage.gltf.bytes();
	}

private:
	/// A part's link, whose M is bounded and not empty.
	uint32_t find( const std::string& name ) const
	{
		const uint32_t link = lw_robot_find_link( m_robot.get(), name.c_str() );
		if ( link == LW_INVALID_INDEX )
			throw io::Error( m_options.robot, name, "is no link of the robot", "see `leeway info`" );
		const lw_reach_node node = lw_reach_get_node( m_reach.get(), link );
		if ( node.hull_point_count < 4 || !std::isfinite( node.m.radius ) )
			throw io::Error( m_options.robot, name, "has no motion hull: it moves nothing, or without limits",
			    "name a link with geometry that joints with limits move" );
		return link;
	}

	/// The frame that M is in.
	int parentNode( uint32_t link, const std::string& name )
	{
		lw_transform pose = lw_transform_identity();
		const uint32_t joint = lw_robot_link_joint( m_robot.get(), link );
		if ( joint != LW_INVALID_INDEX )
			pose = m_poses[lw_robot_joint_parent( m_robot.get(), joint )];
		return m_stage.gltf.addNode( name, -1, translation( pose ), rotation( pose ) );
	}

	int addGeometry( const Triangles& t )
	{
		return m_stage.gltf.addGeometry(
		    shade( t.vertices.data(), t.vertices.size() / 3, t.corners.data(), t.corners.size() / 3, crease ) );
	}

	int tint( size_t part ) { return m_stage.colours.material( tints[part % std::size( tints )].name ); }

	void drawHull( size_t part )
	{
		const uint32_t link = find( m_options.hulls[part] );
		const lw_reach_node node = lw_reach_get_node( m_reach.get(), link );
		const Triangles hull = convexHull( lw_reach_hull_points( m_reach.get(), link ), node.hull_point_count );
		fmt::print( "{:<28} {:>6} {:>11.3f} {:>10.1f} {:>9.0f} {:>10.0f}\n", m_options.hulls[part], node.hull_point_count,
		    1000 * node.dilation, 1000 * node.excess, 1000 * volume( hull ),
		    4000 * M_PI / 3 * std::pow( node.m.radius, 3 ) );
		m_stage.gltf.addNode( "hull", parentNode( link, "M of " + m_options.hulls[part] ), { 0, 0, 0 }, { 0, 0, 0, 1 },
		    m_stage.gltf.addTranslucentMesh( addGeometry( hull ), tint( part ) ) );
	}

	void drawSphere( size_t part )
	{
		const uint32_t link = find( m_options.spheres[part] );
		const lw_sphere m = lw_reach_get_node( m_reach.get(), link ).m;
		lw_shape* made = nullptr;
		const double dimensions[3] = { m.radius, 0, 0 };
		leeway::require( lw_shape_create_primitive( LW_SHAPE_SPHERE, dimensions, nullptr, nullptr, &made ), "sphere" );
		m_shapes.push_back( leeway::Shape::adopt( made ) );
		m_stage.gltf.addNode( "sphere", parentNode( link, "sphere of " + m_options.spheres[part] ),
		    { m.center[0], m.center[1], m.center[2] }, { 0, 0, 0, 1 },
		    m_stage.meshes.of( m_shapes.back().get(), tint( part ), true ) );
	}

	const Options& m_options;
	io::RobotModel m_model;
	leeway::Robot m_robot;
	Stage m_stage;
	std::vector<lw_transform> m_poses; ///< [link]
	leeway::Reach m_reach;
	std::vector<leeway::Shape> m_shapes; ///< meshes are remembered by the shape's address
};

const char* usage =
    "usage: kitchen_hulls --robot R.urdf --still OUT.glb [--colours C.yaml] [--joint NAME=VALUE]... [--hull LINK]...\n"
    "                     [--sphere LINK]...\n"
    "Writes the robot with the motion hulls M of links, and the spheres around M, as still glTF. Parts are coloured in\n"
    "their order, blue, magenta, orange: name the largest first.\n";

/// False if the words are not understood.
bool parse( int argc, char** argv, Options& options )
{
	const std::map<std::string, std::string Options::*> texts = {
	    { "--robot", &Options::robot }, { "--colours", &Options::colours }, { "--still", &Options::still } };
	const std::map<std::string, std::vector<std::string> Options::*> lists = {
	    { "--hull", &Options::hulls }, { "--sphere", &Options::spheres } };
	for ( int i = 1; i + 1 < argc; i += 2 )
	{
		const std::string key = argv[i], value = argv[i + 1];
		const size_t equals = value.find( '=' );
		if ( texts.count( key ) )
			options.*texts.at( key ) = value;
		else if ( lists.count( key ) )
			( options.*lists.at( key ) ).push_back( value );
		else if ( key == "--joint" && equals != std::string::npos )
		{
			char* end = nullptr;
			const std::string number = value.substr( equals + 1 );
			options.joints[value.substr( 0, equals )] = std::strtod( number.c_str(), &end );
			if ( number.empty() || *end != '\0' )
				return false;
		}
		else
			return false;
	}
	return argc % 2 == 1 && !options.robot.empty() && !options.still.empty();
}

} // namespace

int main( int argc, char** argv )
{
	Options options;
	if ( argc == 2 && ( std::string( argv[1] ) == "--help" || std::string( argv[1] ) == "-h" ) )
	{
		fmt::print( "{}", usage );
		return 0;
	}
	if ( !parse( argc, argv, options ) )
	{
		fmt::print( stderr, "{}", usage );
		return 2;
	}
	try
	{
		Picture picture( options );
		writeFile( options.still, picture.draw() );
	}
	catch ( const std::exception& error )
	{
		fmt::print( stderr, "kitchen_hulls: {}\n", error.what() );
		return 2;
	}
	return 0;
}
