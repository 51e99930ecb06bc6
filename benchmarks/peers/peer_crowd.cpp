// SPDX-License-Identifier: BSD-3-Clause
// Comparison G, many pairs: 32 convex bodies of one link slide past 32 obstacles, and all 1,024 pairs are near.
//
// lw_checker_near() returns all rows in one call, each with interval, witness points and direction. A peer gives one signed distance per call.
#include "peers/convex_body.hpp"
#include "peers/peer_workloads.hpp"

#include "support/provenance.hpp"

#include "leeway/near.h"
#include "leeway/scene.h"

#include <cmath>

namespace
{

constexpr std::uint32_t BODIES = 32;   ///< of the link, and of the scene
constexpr double SCALE = 0.05;         ///< metres: of a body
constexpr double STEP = 3e-4, FAR = 5; ///< metres: between states; nearer pairs have a row
constexpr double OFF = 1e-8;           ///< metres: a sum of distances differs by no more for each pair

class Crowd
{
public:
	Crowd( const std::string& kind, const PeersSettings& settings, const std::vector<PeerLibrary>& peers,
	    std::mt19937_64& random )
	    : m_settings( settings ), m_rows( BODIES * BODIES )
	{
		m_bodies.reserve( 2 * BODIES );
		for ( std::uint32_t i = 0; i < 2 * BODIES; ++i )
		{
			const bool moves = i < BODIES;
			m_bodies.push_back( convexBody( kind, SCALE, random ) );
			lw_transform pose = lw_transform_identity();
			const double at[3] = {
			    uniform( random, 0, 0.5 ), uniform( random, 0, 0.5 ) + ( moves ? 0 : 0.8 ), uniform( random, 0, 0.5 ) };
			std::copy( at, at + 3, pose.t );
			m_poses.push_back( pose );
		}
		makeChecker();
		for ( const PeerLibrary& peer : peers )
		{
			std::unique_ptr<PeerEngine> engine = peer.managers ? nullptr : peer.make();
			for ( std::size_t i = 0; engine != nullptr && i < m_bodies.size(); ++i )
			{
				engine->place( engine->add( &m_bodies[i], m_bodies[i].geometry ), m_poses[i] );
			}
			if ( engine != nullptr && !std::isnan( engine->signedDistance( 0, BODIES, 1e-9 ) ) )
			{
				m_engines.push_back( std::move( engine ) );
			}
		}
	}

	void run( const std::string& kind, PeerReport& out )
	{
		std::vector<Contender> contenders = {
		    { "leeway", [this]( const double* n ) { return askLeeway( numberOf( n ), false ); } },
		    { "leeway cold", [this]( const double* n ) { return askLeeway( numberOf( n ), true ); } } };
		for ( const auto& engine : m_engines )
		{
			contenders.push_back( { engine->name() + " 1e-9",
			    [this, e = engine.get()]( const double* n ) { return askPeer( *e, numberOf( n ) ); } } );
		}
		ConfigurationSet set;
		for ( std::uint32_t i = 0; i < m_settings.states; ++i )
		{
			set.states.push_back( { static_cast<double>( i ) } );
		}
		const std::vector<Run> runs = race( contenders, set, m_settings.repetitions, 50 );
		std::vector<PeerRow> rows;
		for ( std::size_t c = 0; c < contenders.size(); ++c )
		{
			PeerRow row;
			Hash hash;
			row.workload = "G 1,024 near pairs, " + kind;
			row.library = contenders[c].name;
			row.count = set.states.size();
			row.pairs = BODIES * BODIES;
			row.time = summarise( runs[c] );
			for ( std::size_t i = 0; i < set.states.size(); ++i )
			{
				const double off = std::abs( runs[c].answers[i].upper - runs[0].answers[i].upper ) / row.pairs;
				row.largest_difference = std::max( row.largest_difference, off );
				row.disagreements += off > OFF ? 1 : 0;
				hash.add( std::llround( runs[c].answers[i].upper * 1e9 ) );
			}
			row.answers_hash = hash.text();
			rows.push_back( row );
		}
		out.add( rows );
	}

private:
	void makeChecker()
	{
		lw_robot_def robot_def = lw_robot_def_default();
		const char* links[2] = { "base", "slider" };
		lw_joint_def joint = lw_joint_def_default();
		joint.name = "slide";
		joint.type = LW_JOINT_PRISMATIC;
		joint.parent = 0;
		joint.child = 1;
		joint.axis[0] = 1;
		joint.axis[1] = joint.axis[2] = 0;
		joint.lower = -10;
		joint.upper = 10;
		std::vector<lw_body_def> bodies;
		std::vector<lw_scene_shape_def> shapes;
		std::vector<std::string> names;
		for ( std::uint32_t i = 0; i < BODIES; ++i )
		{
			lw_body_def body = {};
			body.link = 1;
			body.shape = m_bodies[i].shape.get();
			body.link_from_shape = m_poses[i];
			bodies.push_back( body );
			shapes.push_back( { m_bodies[BODIES + i].shape.get(), i, m_poses[BODIES + i] } );
			names.push_back( "obstacle " + std::to_string( i ) );
		}
		std::vector<const char*> name_list;
		for ( const std::string& name : names )
		{
			name_list.push_back( name.c_str() );
		}
		robot_def.link_names = links;
		robot_def.link_count = 2;
		robot_def.joints = &joint;
		robot_def.joint_count = 1;
		robot_def.bodies = bodies.data();
		robot_def.body_count = BODIES;
		lw_diag diag = {};
		lw_robot* robot = nullptr;
		leeway::require( lw_robot_create( &robot_def, nullptr, &diag, &robot ), diag );
		m_robot = leeway::Robot::adopt( robot );
		lw_scene_def scene_def = lw_scene_def_default();
		scene_def.shapes = shapes.data();
		scene_def.shape_count = scene_def.object_count = BODIES;
		scene_def.object_names = name_list.data();
		lw_scene* scene = nullptr;
		leeway::require( lw_scene_create( &scene_def, nullptr, &diag, &scene ), diag );
		m_scene = leeway::Scene::adopt( scene );
		lw_checker_def checker_def = lw_checker_def_default();
		checker_def.robot = robot;
		checker_def.scene = scene;
		lw_checker* checker = nullptr;
		leeway::require( lw_checker_create( &checker_def, nullptr, &diag, &checker ), diag );
		m_checker = leeway::Checker::adopt( checker );
		m_query = leeway::makeQuery( checker );
	}

	static double placeOf( std::size_t state ) { return STEP * ( static_cast<double>( state % 1000 ) - 500 ); }

	/// The sum of all clearances.
	Answer askLeeway( std::size_t state, bool cold )
	{
		if ( cold )
		{
			lw_query_reset( m_query.get() );
		}
		lw_near_def def = lw_near_def_default();
		def.flags = LW_CHECK_ENVIRONMENT;
		def.distance = FAR;
		const double q = placeOf( state );
		std::uint32_t count = 0;
		leeway::require( lw_checker_near( m_checker.get(), m_query.get(), &q, &def, m_rows.data(),
		                     static_cast<std::uint32_t>( m_rows.size() ), &count ),
		    "near pairs" );
		double sum = 0;
		for ( std::uint32_t i = 0; i < count; ++i )
		{
			sum += m_rows[i].clearance.upper;
		}
		return single( sum );
	}

	Answer askPeer( PeerEngine& engine, std::size_t state ) const
	{
		for ( std::uint32_t i = 0; i < BODIES; ++i )
		{
			lw_transform pose = m_poses[i];
			pose.t[0] += placeOf( state );
			engine.place( i, pose );
		}
		double sum = 0;
		for ( std::uint32_t a = 0; a < BODIES; ++a )
		{
			for ( std::uint32_t b = BODIES; b < 2 * BODIES; ++b )
			{
				sum += engine.signedDistance( a, b, 1e-9 );
			}
		}
		return single( sum );
	}

	const PeersSettings& m_settings;
	std::vector<ConvexBody> m_bodies;
	std::vector<lw_transform> m_poses;
	leeway::Robot m_robot;
	leeway::Scene m_scene;
	leeway::Checker m_checker;
	leeway::Query m_query;
	std::vector<std::unique_ptr<PeerEngine>> m_engines;
	std::vector<lw_near_pair> m_rows;
};

} // namespace

void runCrowds( const PeersSettings& settings, const std::vector<PeerLibrary>& peers, PeerReport& out )
{
	std::mt19937_64 random( settings.seed );
	for ( const char* kind : { "sphere", "capsule", "box", "hull" } )
	{
		Crowd( kind, settings, peers, random ).run( kind, out );
	}
}
