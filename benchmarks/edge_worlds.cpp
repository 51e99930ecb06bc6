// SPDX-License-Identifier: BSD-3-Clause
// Worlds and judges of edges: see edge_worlds.hpp.
#include "edge_worlds.hpp"

#include <cstdio>

namespace io = leeway::io;

namespace
{

double uniform( std::mt19937_64& random )
{
	return static_cast<double>( random() >> 11 ) * 0x1p-53;
}

double extentOf( const io::Problem& problem )
{
	double sum = 0;
	for ( std::uint32_t variable : problem.variables )
	{
		const lw_variable_info info = lw_robot_variable( problem.robot.get(), variable );
		sum += ( info.upper - info.lower ) * ( info.upper - info.lower );
	}
	return std::sqrt( sum );
}

double lengthOf( const double* a, const double* b, std::size_t size )
{
	double sum = 0;
	for ( std::size_t i = 0; i < size; ++i )
	{
		sum += ( b[i] - a[i] ) * ( b[i] - a[i] );
	}
	return std::sqrt( sum );
}

/// As DiscreteMotionValidator::checkMotion( s1, s2 ): s1 is taken for valid.
template <typename IsValid>
bool discrete( const double* a, const double* b, std::size_t size, double step, const IsValid& is_valid )
{
	if ( !is_valid( b ) )
	{
		return false;
	}
	const int count = static_cast<int>( std::ceil( lengthOf( a, b, size ) / step ) );
	std::vector<double> state( size );
	std::queue<std::pair<int, int>> parts;
	if ( count >= 2 )
	{
		parts.emplace( 1, count - 1 );
	}
	while ( !parts.empty() )
	{
		const auto [first, last] = parts.front();
		parts.pop();
		const int middle = ( first + last ) / 2;
		for ( std::size_t i = 0; i < size; ++i )
		{
			state[i] = a[i] + ( b[i] - a[i] ) * middle / count;
		}
		if ( !is_valid( state.data() ) )
		{
			return false;
		}
		if ( first < middle )
		{
			parts.emplace( first, middle - 1 );
		}
		if ( middle < last )
		{
			parts.emplace( middle + 1, last );
		}
	}
	return true;
}

bool isFreeFor( const lw_checker* checker, lw_query* query, const double* q )
{
	const lw_range range = { 0, std::nextafter( 0.0, 1.0 ), 0 };
	lw_state_result result;
	leeway::require( lw_checker_state( checker, query, q, LW_WHAT_BOTH, &range, true, &result ), "a state" );
	return result.verdict == LW_VERDICT_FREE;
}

} // namespace

EdgeWorlds::EdgeWorlds( const std::string& data, double budget )
{
	const std::string armar = data + "/armar3/armar3";
	m_robot = io::loadRobot( armar + ".urdf", armar + ".srdf" );
	m_scene = io::loadScene( data + "/kit_kitchen/scene_cluttered.yaml" );
	for ( int i = 1; i <= 12; ++i )
	{
		char name[64];
		std::snprintf( name, sizeof name, "/armar3/reach/%02d.yaml", i );
		add( data + name, budget );
	}
	m_size = m_worlds[0].problem.variables.size();
	m_extent = extentOf( m_worlds[0].problem );
}

void EdgeWorlds::add( const std::string& request_file, double budget )
{
	const io::Request request = io::loadRequest( request_file );
	io::ProblemOptions options;
	options.group = group();
	options.scene = &m_scene;
	options.request = &request;
	EdgeWorld world;
	world.problem = io::buildProblem( m_robot, options );
	if ( !m_reach )
	{
		lw_reach_def def = lw_reach_def_default();
		def.robot = world.problem.robot.get();
		def.seconds = budget;
		lw_diag diag{};
		lw_reach* reach = nullptr;
		leeway::require( lw_reach_create( &def, nullptr, &diag, &reach ), diag );
		m_reach = leeway::Reach::adopt( reach );
	}
	lw_checker_def def = lw_checker_def_default();
	def.robot = world.problem.robot.get();
	def.scene = world.problem.scene.get();
	def.variables = world.problem.variables.data();
	def.variable_count = static_cast<std::uint32_t>( world.problem.variables.size() );
	def.reference = world.problem.reference.data();
	def.reach = m_reach.get();
	lw_diag diag{};
	lw_checker* checker = nullptr;
	leeway::require( lw_checker_create( &def, nullptr, &diag, &checker ), diag );
	world.with_tables = leeway::Checker::adopt( checker );
	world.query = leeway::makeQuery( world.problem.checker.get() );
	world.table_query = leeway::makeQuery( world.with_tables.get() );
	world.audit_query = leeway::makeQuery( world.problem.checker.get() );
	world.fcl = std::make_unique<FclPeer>( world.problem.checker.get() );
	m_worlds.push_back( std::move( world ) );
}

/// A random free state of a random base; near: within 50 mm of the environment.
Edge EdgeWorlds::start( bool near, std::mt19937_64& random )
{
	while ( true )
	{
		const std::size_t w = random() % m_worlds.size();
		const EdgeWorld& world = m_worlds[w];
		Edge edge = { static_cast<double>( w ) };
		for ( std::uint32_t variable : world.problem.variables )
		{
			const lw_variable_info info = lw_robot_variable( world.problem.robot.get(), variable );
			edge.push_back( info.lower + uniform( random ) * ( info.upper - info.lower ) );
		}
		const lw_range range = { 0, 0.05, 0 };
		lw_state_result result;
		leeway::require( lw_checker_state( world.problem.checker.get(), world.audit_query.get(), edge.data() + 1, LW_WHAT_BOTH, &range,
							 false, &result ),
			"a state" );
		if ( result.verdict == LW_VERDICT_FREE && ( !near || result.environment.kind == LW_CLEARANCE_NEAR ) )
		{
			return edge;
		}
	}
}

Edge EdgeWorlds::random( bool near, double length, std::mt19937_64& random )
{
	std::normal_distribution<double> normal;
	while ( true )
	{
		Edge edge = start( near, random );
		EdgeWorld& world = of( edge.data() );
		for ( int attempt = 0; attempt < 20; ++attempt )
		{
			std::vector<double> direction( m_size ), end( m_size );
			double norm = 0;
			for ( double& d : direction )
			{
				d = normal( random );
				norm += d * d;
			}
			bool inside = true;
			for ( std::size_t i = 0; i < m_size; ++i )
			{
				const lw_variable_info info = lw_robot_variable( world.problem.robot.get(), world.problem.variables[i] );
				end[i] = edge[1 + i] + direction[i] * length / std::sqrt( norm );
				inside = inside && end[i] >= info.lower && end[i] <= info.upper;
			}
			if ( inside && isFree( world, end.data() ) )
			{
				edge.insert( edge.end(), end.begin(), end.end() );
				return edge;
			}
		}
	}
}

std::vector<double> EdgeWorlds::at( const double* edge, double t ) const
{
	std::vector<double> state( m_size );
	for ( std::size_t i = 0; i < m_size; ++i )
	{
		state[i] = edge[1 + i] + ( edge[1 + m_size + i] - edge[1 + i] ) * t;
	}
	return state;
}

bool EdgeWorlds::isFree( EdgeWorld& world, const double* q )
{
	return isFreeFor( world.problem.checker.get(), world.audit_query.get(), q );
}

bool EdgeWorlds::judgedByCertificate( const double* edge, bool tables, lw_edge_result& result )
{
	EdgeWorld& world = of( edge );
	const lw_edge_def def = lw_edge_def_default();
	leeway::require( lw_checker_edge( tables ? world.with_tables.get() : world.problem.checker.get(),
						 tables ? world.table_query.get() : world.query.get(), edge + 1, edge + 1 + m_size, &def, &result ),
		"an edge" );
	return result.verdict == LW_VERDICT_FREE;
}

bool EdgeWorlds::judgedByStates( const double* edge, double resolution )
{
	EdgeWorld& world = of( edge );
	return discrete( edge + 1, edge + 1 + m_size, m_size, resolution * m_extent, [&]( const double* q ) {
		return isFreeFor( world.with_tables.get(), world.table_query.get(), q );
	} );
}

bool EdgeWorlds::judgedByFcl( const double* edge, double resolution )
{
	FclPeer& fcl = *of( edge ).fcl;
	return discrete( edge + 1, edge + 1 + m_size, m_size, resolution * m_extent, [&fcl]( const double* q ) {
		fcl.pose( q );
		return !fcl.environmentCollides() && !fcl.selfCollides();
	} );
}
