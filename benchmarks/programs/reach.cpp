// SPDX-License-Identifier: BSD-3-Clause
// Cost of motion hulls and pair tables, and a long hunt for a vertex that leaves its hull.
//
// Containment is tested by support functions: a convex set contains a body if and only if in every direction it reaches at
// least as far. Each state brings one random direction, in which all hulls and spheres of the robot are tested.
#include "programs/commands.hpp"
#include "seeded_rng.hpp"
#include "support/race.hpp"

#include "leeway/io/model.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>

namespace
{

namespace io = leeway::io;

struct Settings
{
	std::string data = LEEWAY_DATA_DIR;
	std::vector<std::string> robots; ///< URDF[,SRDF]
	std::uint64_t states = 1000000, seed = 1;
	double budget = 20;
	int repetitions = 5;
};

double secondsOf( const std::function<void()>& work )
{
	const auto begin = std::chrono::steady_clock::now();
	work();
	return std::chrono::duration<double>( std::chrono::steady_clock::now() - begin ).count();
}

// ---- containment -----------------------------------------------------------------------------------------------------

struct Direction
{
	double x, y, z;
};

/// The direction as the frame sees it.
Direction intoFrame( const lw_transform& world_from_frame, Direction n )
{
	const auto& r = world_from_frame.r;
	return { r[0][0] * n.x + r[1][0] * n.y + r[2][0] * n.z, r[0][1] * n.x + r[1][1] * n.y + r[2][1] * n.z,
	    r[0][2] * n.x + r[1][2] * n.y + r[2][2] * n.z };
}

double along( Direction n, const double* p )
{
	return n.x * p[0] + n.y * p[1] + n.z * p[2];
}

double farthest( Direction n, const double* points, std::size_t count )
{
	double best = -INFINITY;
	for ( std::size_t i = 0; i < count; ++i )
	{
		best = std::max( best, along( n, points + 3 * i ) );
	}
	return best;
}

double farthestBall( Direction n, const double* centers, const double* radii, std::uint32_t count )
{
	double best = -INFINITY;
	for ( std::size_t i = 0; i < count; ++i )
	{
		const double* p = centers + 3 * i;
		best = std::max( best, n.x * p[0] + n.y * p[1] + n.z * p[2] + radii[i] * std::hypot( n.x, n.y, n.z ) );
	}
	return best;
}

double farthestBox( Direction n, const double* corners, std::uint32_t count )
{
	double best = -INFINITY;
	for ( std::size_t i = 0; i < count; ++i )
	{
		const double *low = corners + 6 * i, *high = low + 3;
		best = std::max( best, std::max( n.x * low[0], n.x * high[0] ) + std::max( n.y * low[1], n.y * high[1] ) +
		                           std::max( n.z * low[2], n.z * high[2] ) );
	}
	return best;
}

/// How far a shape reaches in direction n of its own frame.
double support( const lw_shape* shape, Direction n )
{
	const lw_shape_info info = lw_shape_get_info( shape );
	const double* d = info.dimensions;
	const double flat = std::hypot( n.x, n.y ), length = std::hypot( flat, n.z );
	switch ( info.type )
	{
	case LW_SHAPE_MESH:
		return farthest( n, lw_shape_vertices( shape ), info.vertex_count );
	case LW_SHAPE_POINTS:
		return farthest( n, lw_shape_vertices( shape ), info.vertex_count ) + d[0] * length;
	case LW_SHAPE_BOX:
		return ( std::abs( n.x ) * d[0] + std::abs( n.y ) * d[1] + std::abs( n.z ) * d[2] ) / 2;
	case LW_SHAPE_SPHERE:
		return d[0] * length;
	case LW_SHAPE_CYLINDER:
		return d[0] * flat + std::abs( n.z ) * d[1] / 2;
	case LW_SHAPE_CAPSULE:
		return d[0] * length + std::abs( n.z ) * d[1] / 2;
	case LW_SHAPE_CONE:
		return std::max( n.z * d[1] / 2, d[0] * flat - n.z * d[1] / 2 );
	case LW_SHAPE_BOXES:

		return farthestBox( n, lw_shape_vertices( shape ), info.vertex_count / 2 );
	case LW_SHAPE_SPHERES:
		return farthestBall( n, lw_shape_vertices( shape ), lw_shape_radii( shape ), info.vertex_count );
	case LW_SHAPE_HALFSPACE:
	case LW_SHAPE_PLANE:
		break; // robots have none
	}
	return INFINITY;
}

/// Hunts for geometry outside of the hull or sphere that must contain it.
class Containment
{
public:
	Containment( const lw_reach* reach, std::uint64_t seed )
	    : m_reach( reach ), m_robot( lw_reach_robot( reach ) ), m_rng( seed ), m_poses( lw_robot_link_count( m_robot ) ),
	      m_state( lw_robot_variable_count( m_robot ) )
	{
		orderLinks();
	}

	/// One state, one direction. Every fourth state has each joint at one of its limits.
	void test( std::uint64_t index )
	{
		sample( index % 4 == 3 );
		if ( lw_robot_fk( m_robot, m_state.data(), m_poses.data() ) != LW_OK )
		{
			throw std::runtime_error( "forward kinematics failed inside the limits" );
		}
		const double z = m_rng.uniform( -1, 1 ), angle = m_rng.uniform( -M_PI, M_PI ), r = std::sqrt( 1 - z * z );
		const Direction n = { r * std::cos( angle ), r * std::sin( angle ), z };
		measureSubtrees( n );
		for ( std::uint32_t link = 0; link < m_poses.size(); ++link )
		{
			testLink( link, n );
		}
	}

	std::uint64_t tests() const { return m_tests; }
	std::uint64_t violations() const { return m_violations; }
	/// Largest reach beyond a hull or sphere, metres; below 0: the least room that was left.
	double worst() const { return m_worst; }

private:
	/// Parents first.
	void orderLinks()
	{
		m_children.resize( m_poses.size() );
		m_parent.assign( m_poses.size(), LW_INVALID_INDEX );
		std::uint32_t root = 0;
		for ( std::uint32_t link = 0; link < m_poses.size(); ++link )
		{
			const std::uint32_t joint = lw_robot_link_joint( m_robot, link );
			if ( joint == LW_INVALID_INDEX )
			{
				root = link;
				continue;
			}
			m_parent[link] = lw_robot_joint_parent( m_robot, joint );
			m_children[m_parent[link]].push_back( link );
		}
		m_order = { root };
		for ( std::size_t i = 0; i < m_order.size(); ++i )
		{
			m_order.insert( m_order.end(), m_children[m_order[i]].begin(), m_children[m_order[i]].end() );
		}
	}

	void sample( bool corner )
	{
		for ( std::uint32_t i = 0; i < m_state.size(); ++i )
		{
			double lower, upper;
			lw_reach_variable_range( m_reach, i, &lower, &upper );
			lower = std::max( lower, -3.0 ); // for a variable without limits any range will do: nothing unbounded is tested
			upper = std::min( upper, 3.0 );
			const bool wraps = lw_robot_variable( m_robot, i ).wraps;
			m_state[i] = wraps    ? m_rng.uniform( -2 * M_PI, 2 * M_PI )
			             : corner ? ( m_rng.uniform( 0, 1 ) < 0.5 ? lower : upper )
			                      : m_rng.uniform( lower, upper );
		}
	}

	/// How far each link's subtree reaches, world frame.
	void measureSubtrees( Direction n )
	{
		m_reached.assign( m_poses.size(), -INFINITY );
		for ( std::uint32_t i = 0; i < lw_robot_body_count( m_robot ); ++i )
		{
			const lw_body_def body = lw_robot_body( m_robot, i );
			const Direction in_link = intoFrame( m_poses[body.link], n );
			const double reached = along( n, m_poses[body.link].t ) + along( in_link, body.link_from_shape.t ) +
			                       support( body.shape, intoFrame( body.link_from_shape, in_link ) );
			m_reached[body.link] = std::max( m_reached[body.link], reached );
		}
		m_own = m_reached;
		for ( std::size_t i = m_order.size(); i-- > 1; )
		{
			const std::uint32_t parent = m_parent[m_order[i]];
			m_reached[parent] = std::max( m_reached[parent], m_reached[m_order[i]] );
		}
	}

	/// The poses and sums here are rounded too: up to 1e-14 of the coordinates, which are metres.
	void expect( double reached, double allowed )
	{
		++m_tests;
		m_worst = std::max( m_worst, reached - allowed );
		m_violations += !( reached <= allowed + 1e-13 * ( 1 + std::abs( reached ) ) );
	}

	void testSphere( const lw_sphere& sphere, const lw_transform& frame, Direction n, double reached )
	{
		if ( std::isfinite( sphere.radius ) )
		{
			expect( reached, along( n, frame.t ) + along( intoFrame( frame, n ), sphere.center ) + sphere.radius );
		}
	}

	void testLink( std::uint32_t link, Direction n )
	{
		const lw_reach_node node = lw_reach_get_node( m_reach, link );
		const lw_transform world = lw_transform_identity();
		const lw_transform& frame = m_parent[link] == LW_INVALID_INDEX ? world : m_poses[m_parent[link]];
		if ( std::isfinite( m_own[link] ) )
		{
			testSphere( node.r, m_poses[link], n, m_own[link] );
		}
		if ( !std::isfinite( m_reached[link] ) )
		{
			return; // nothing there
		}
		testSphere( node.mr, m_poses[link], n, m_reached[link] );
		testSphere( node.m, frame, n, m_reached[link] );
		if ( node.hull_point_count > 0 )
		{
			const double hull =
			    farthest( intoFrame( frame, n ), lw_reach_hull_points( m_reach, link ), node.hull_point_count );
			expect( m_reached[link], along( n, frame.t ) + hull + node.dilation );
		}
	}

	const lw_reach* m_reach;
	const lw_robot* m_robot;
	SeededRng m_rng;
	std::vector<lw_transform> m_poses;
	std::vector<double> m_state, m_own, m_reached;
	std::vector<std::vector<std::uint32_t>> m_children;
	std::vector<std::uint32_t> m_parent, m_order;
	std::uint64_t m_tests = 0, m_violations = 0;
	double m_worst = -INFINITY;
};

// ---- a robot ---------------------------------------------------------------------------------------------------------

leeway::Reach build( const lw_robot* robot, double seconds, std::uint32_t samples )
{
	lw_reach_def def = lw_reach_def_default();
	def.robot = robot;
	def.seconds = seconds;
	def.samples = samples;
	lw_diag diag{};
	lw_reach* reach = nullptr;
	leeway::require( lw_reach_create( &def, nullptr, &diag, &reach ), diag );
	return leeway::Reach::adopt( reach );
}

Json countClasses( const lw_reach* reach )
{
	std::map<std::string, std::uint32_t> counts;
	const std::uint32_t links = lw_robot_link_count( lw_reach_robot( reach ) );
	for ( std::uint32_t a = 0; a < links; ++a )
	{
		for ( std::uint32_t b = 0; b < a; ++b )
		{
			const lw_reach_pair pair = lw_reach_get_pair( reach, a, b );
			if ( pair.kind != LW_PAIR_NONE )
			{
				std::string name = lw_pair_class_name( pair.kind );
				name += pair.kind == LW_PAIR_NEVER ? std::string( " (" ) + lw_pair_proof_name( pair.proof ) + ")" : "";
				++counts[name];
			}
		}
	}
	return counts;
}

/// Milliseconds to read the blob of a reach, the median of some.
double loadBlob( const lw_reach* reach, int repetitions, std::size_t& bytes )
{
	lw_blob_def def = lw_blob_def_default();
	def.reach = reach;
	void* blob = nullptr;
	lw_diag diag{};
	leeway::require( lw_blob_write( &def, nullptr, &diag, &blob, &bytes ), diag );
	std::vector<double> times;
	for ( int i = 0; i < repetitions; ++i )
	{
		times.push_back( 1000 * secondsOf(
		                            [&]
		                            {
			                            lw_reach* read = nullptr;
			                            leeway::require( lw_blob_read_reach( blob, bytes, def.key, lw_reach_robot( reach ),
			                                                 nullptr, &diag, &read ),
			                                diag );
			                            lw_reach_release( read );
		                            } ) );
	}
	lw_blob_free( nullptr, blob, bytes );
	return median( times );
}

bool runRobot( const Settings& settings, const std::string& urdf, const std::string& srdf, Result& result )
{
	const io::RobotModel model = io::loadRobot( urdf, srdf );
	const io::Problem problem = io::buildProblem( model, {} );
	const lw_robot* robot = problem.robot.get();
	leeway::Reach reach;
	const double hulls = secondsOf( [&] { reach = build( robot, 0, 0 ); } );
	const double whole = secondsOf( [&] { reach = build( robot, settings.budget, lw_reach_def_default().samples ); } );
	std::size_t bytes = 0;
	const double load = loadBlob( reach.get(), settings.repetitions, bytes );
	const Json classes = countClasses( reach.get() );
	std::printf(
	    "\n%s: %u links, %u variables\n  hulls and hull proofs %.2f s; with samples, search and %g s of subdivision %.2f s\n",
	    model.name.c_str(), lw_robot_link_count( robot ), lw_robot_variable_count( robot ), hulls, settings.budget, whole );
	std::printf( "  blob %.2f MB, read in %.2f ms\n ", bytes / 1e6, load );
	for ( const auto& [name, count] : classes.items() )
	{
		std::printf( " %s %u,", name.c_str(), count.get<std::uint32_t>() );
	}
	std::printf( "\n" );

	Containment containment( reach.get(), settings.seed );
	const double hunt = secondsOf(
	    [&]
	    {
		    for ( std::uint64_t i = 0; i < settings.states; ++i )
		    {
			    containment.test( i );
			    if ( ( i + 1 ) % 50000 == 0 )
			    {
				    std::fprintf( stderr, "\r  containment: %3.0f %%", 100.0 * double( i + 1 ) / double( settings.states ) );
			    }
		    }
		    std::fprintf( stderr, "\r" );
	    } );
	std::printf( "  containment: %llu states, %llu tests, %llu outside, least room %.3g m (%.0f s)\n",
	    static_cast<unsigned long long>( settings.states ), static_cast<unsigned long long>( containment.tests() ),
	    static_cast<unsigned long long>( containment.violations() ), -containment.worst(), hunt );
	result.add( { { "robot", model.name }, { "hulls_s", hulls }, { "whole_s", whole }, { "blob_bytes", bytes },
	    { "blob_read_ms", load }, { "classes", classes }, { "containment_states", settings.states },
	    { "containment_tests", containment.tests() }, { "containment_outside", containment.violations() },
	    { "containment_least_room_m", -containment.worst() } } );
	return containment.violations() == 0;
}

int run( Settings settings, Result& result )
{
	if ( settings.robots.empty() )
	{
		for ( const char* name : { "armar3/armar3", "mbm/fetch/fetch", "mbm/panda/panda" } )
		{
			const std::string base = settings.data + "/" + name;
			settings.robots.push_back( base + ".urdf," + base + ".srdf" );
		}
	}
	bool contained = true;
	for ( const std::string& robot : settings.robots )
	{
		const std::size_t comma = robot.find( ',' );
		contained &= runRobot(
		    settings, robot.substr( 0, comma ), comma == std::string::npos ? "" : robot.substr( comma + 1 ), result );
	}
	std::printf( contained ? "\nnothing is outside of its hulls\n" : "\nSOMETHING IS OUTSIDE OF ITS HULL\n" );
	return contained ? 0 : 1;
}

} // namespace

void addReach( Bench& bench )
{
	const auto s = std::make_shared<Settings>();
	Command& command =
	    bench.command( "reach", "motion hulls and pair tables: cost, and a hunt for geometry that leaves its hull" );
	command.option( "--data", s->data, "folder of robots" );
	command.option( "--robot", s->robots, "URDF[,SRDF]: instead of the three robots of the data folder" );
	command.option( "--states", s->states, "random states per robot" );
	command.option( "--budget", s->budget, "seconds for proofs by subdivision", { 0 } );
	command.option( "--repetitions", s->repetitions, "of reading a blob", { 1 } );
	command.option( "--seed", s->seed, "of the states" );
	command.work( [s]( Result& result ) { return run( *s, result ); } );
}
