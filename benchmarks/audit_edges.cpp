// SPDX-License-Identifier: BSD-3-Clause
// audit_edges: who calls a colliding edge free? Certificates and discrete validators at several resolutions, over leeway's
// states and FCL's, against a dense look that knows nothing of certificates. Exit status 1 if a certificate is wrong.
//
// The dense look takes exact distances at states so close that no robot point moves further between two of them than
// --resolution or, away from contact, a quarter of the room there is. Motion is measured from forward kinematics: how far a
// body's bounding sphere went, and how far it turned.
#include "edge_worlds.hpp"
#include "provenance.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <functional>

namespace
{

using Json = nlohmann::ordered_json;

struct Settings
{
	std::string data = LEEWAY_DATA_DIR, json;
	std::size_t edges = 2000;
	double resolution = 1e-4, budget = 2;
	std::uint64_t seed = 20260101;
};

/// Poses of all links at one state of an edge.
std::vector<lw_transform> posesAt( const EdgeWorld& world, const std::vector<double>& state )
{
	const lw_robot* robot = world.problem.robot.get();
	std::vector<double> full( lw_robot_variable_count( robot ) );
	lw_checker_full_state( world.problem.checker.get(), state.data(), full.data() );
	std::vector<lw_transform> poses( lw_robot_link_count( robot ) );
	leeway::require( lw_robot_fk( robot, full.data(), poses.data() ), "forward kinematics" );
	return poses;
}

/// No point of the robot is further from where it was than this: its sphere's centre moved, and it turned about it. The chord
/// of a turn of at most 0.2 rad is its arc to 0.2 %.
double motionBetween( const lw_robot* robot, const std::vector<lw_transform>& from, const std::vector<lw_transform>& to )
{
	double most = 0;
	for ( std::uint32_t i = 0; i < lw_robot_body_count( robot ); ++i )
	{
		const lw_body_def body = lw_robot_body( robot, i );
		const lw_shape_info info = lw_shape_get_info( body.shape );
		const lw_vec3 local = { info.sphere_center[0], info.sphere_center[1], info.sphere_center[2] };
		const lw_vec3 center = lw_transform_point( &body.link_from_shape, local );
		const lw_transform &f = from[body.link], &t = to[body.link];
		const lw_vec3 a = lw_transform_point( &f, center ), b = lw_transform_point( &t, center );
		double turned = 0; // Frobenius norm of the difference of the rotations: sqrt( 2 ) times the chord of the turn
		for ( int row = 0; row < 3; ++row )
		{
			for ( int column = 0; column < 3; ++column )
			{
				const double d = t.r[row][column] - f.r[row][column];
				turned += d * d;
			}
		}
		const double moved = std::sqrt( ( a.x - b.x ) * ( a.x - b.x ) + ( a.y - b.y ) * ( a.y - b.y ) + ( a.z - b.z ) * ( a.z - b.z ) );
		most = std::max( most, moved + std::sqrt( turned / 2 ) * info.sphere_radius );
	}
	return 1.002 * most;
}

struct Judge
{
	std::string name;
	std::function<bool( const double* edge )> is_free;
	std::size_t free = 0, missed = 0, alarms = 0;
};

class Audit
{
public:
	explicit Audit( const Settings& settings )
		: m_settings( settings ), m_random( settings.seed ), m_worlds( settings.data, settings.budget )
	{
		lw_edge_result* result = &m_result;
		m_judges.push_back( { "certified", [this, result]( const double* e ) { return m_worlds.judgedByCertificate( e, false, *result ); } } );
		m_judges.push_back( { "certified, tables", [this, result]( const double* e ) { return m_worlds.judgedByCertificate( e, true, *result ); } } );
		for ( const double resolution : { 0.01, 0.005, 0.001 } )
		{
			char name[32];
			std::snprintf( name, sizeof name, "own states %.1f %%", 100 * resolution );
			m_judges.push_back( { name, [this, resolution]( const double* e ) { return m_worlds.judgedByStates( e, resolution ); } } );
			std::snprintf( name, sizeof name, "FCL %.1f %%", 100 * resolution );
			m_judges.push_back( { name, [this, resolution]( const double* e ) { return m_worlds.judgedByFcl( e, resolution ); } } );
		}
	}

	int run()
	{
		for ( std::size_t i = 0; i < m_settings.edges; ++i )
		{
			static const double lengths[] = { 0.1, 0.5, 2 };
			audit( m_worlds.random( i % 2 == 0, lengths[i % 3], m_random ) );
			if ( ( i + 1 ) % 50 == 0 )
			{
				std::fprintf( stderr, "\r%zu of %zu edges", i + 1, m_settings.edges );
			}
		}
		std::fprintf( stderr, "\r" );
		std::printf( "ARMAR-III, %s: %zu edges of 0.1, 0.5 and 2 rad between free states, every second one near furniture; %zu collide, %.1f million "
					 "states measured\n",
			m_worlds.group(), m_settings.edges, m_colliding, m_states / 1e6 );
		std::printf( "%-20s %10s %22s %22s\n", "judge", "calls free", "of them colliding", "free, but not called" );
		Json rows = Json::array();
		for ( const Judge& judge : m_judges )
		{
			std::printf( "%-20s %10zu %22zu %22zu\n", judge.name.c_str(), judge.free, judge.missed, judge.alarms );
			rows.push_back( { { "judge", judge.name }, { "calls_free", judge.free }, { "missed_collisions", judge.missed },
				{ "free_but_not_called", judge.alarms } } );
		}
		std::printf( "blocked verdicts not reproduced: %zu\n", m_unfounded );
		if ( !m_settings.json.empty() )
		{
			std::ofstream( m_settings.json ) << Json{ { "provenance", provenance() }, { "seed", m_settings.seed },
				{ "edges", m_settings.edges }, { "colliding", m_colliding }, { "states", m_states },
				{ "unfounded_blocked", m_unfounded }, { "judges", rows } }.dump( 2 )
											 << "\n";
		}
		return m_judges[0].missed + m_judges[1].missed + m_unfounded > 0 ? 1 : 0;
	}

private:
	/// True if some state of the edge is in contact.
	bool collides( const Edge& edge )
	{
		EdgeWorld& world = m_worlds.of( edge.data() );
		const lw_robot* robot = world.problem.robot.get();
		double t = 0, step = 0.01;
		std::vector<lw_transform> here = posesAt( world, m_worlds.at( edge.data(), 0 ) );
		while ( true )
		{
			lw_state_result result;
			leeway::require( lw_checker_state( world.problem.checker.get(), world.audit_query.get(), m_worlds.at( edge.data(), t ).data(),
								 LW_WHAT_BOTH, nullptr, false, &result ),
				"a state" );
			++m_states;
			const double room = std::min( result.environment.upper, result.self.upper );
			if ( result.verdict != LW_VERDICT_FREE || t >= 1 )
			{
				return result.verdict != LW_VERDICT_FREE;
			}
			// within the motion from here nothing can touch before half of the room is used up: a quarter leaves a reserve
			const double allowed = std::max( m_settings.resolution, room / 4 );
			std::vector<lw_transform> there;
			for ( step = std::min( 2 * step, 1 - t );; step /= 2 )
			{
				there = posesAt( world, m_worlds.at( edge.data(), std::min( t + step, 1.0 ) ) );
				if ( motionBetween( robot, here, there ) <= allowed )
				{
					break;
				}
			}
			t = std::min( t + step, 1.0 );
			here = there;
		}
	}

	void audit( const Edge& edge )
	{
		const bool truth = collides( edge );
		m_colliding += truth;
		for ( std::size_t i = 0; i < m_judges.size(); ++i )
		{
			const bool free = m_judges[i].is_free( edge.data() );
			m_judges[i].free += free;
			m_judges[i].missed += free && truth;
			m_judges[i].alarms += !free && !truth;
			if ( i < 2 && m_result.verdict == LW_VERDICT_BLOCKED )
			{
				EdgeWorld& world = m_worlds.of( edge.data() );
				m_unfounded += m_worlds.isFree( world, m_worlds.at( edge.data(), m_result.t ).data() );
			}
		}
	}

	const Settings& m_settings;
	std::mt19937_64 m_random;
	EdgeWorlds m_worlds;
	lw_edge_result m_result{};
	std::vector<Judge> m_judges;
	std::size_t m_colliding = 0, m_states = 0, m_unfounded = 0;
};

} // namespace

int main( int argc, char** argv )
{
	CLI::App app{ "Who calls a colliding edge free?" };
	Settings settings;
	app.add_option( "--data", settings.data, "folder of robots and scenes" );
	app.add_option( "--edges", settings.edges )->capture_default_str();
	app.add_option( "--resolution", settings.resolution, "metres of motion between two states near contact" )->capture_default_str();
	app.add_option( "--budget", settings.budget, "seconds for pair proofs" )->capture_default_str();
	app.add_option( "--seed", settings.seed )->capture_default_str();
	app.add_option( "--json", settings.json, "result file" );
	CLI11_PARSE( app, argc, argv );
	try
	{
		return Audit( settings ).run();
	}
	catch ( const std::exception& error )
	{
		std::fprintf( stderr, "audit_edges: error: %s\n", error.what() );
		return 2;
	}
}
