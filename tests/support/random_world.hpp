// SPDX-License-Identifier: BSD-3-Clause
// Random robots of all joint types with random meshes and primitives among random obstacles, as worlds for edges.
#pragma once

#include "edge_auditor.hpp"
#include "edge_world.hpp"
#include "random_robot.hpp"

struct RandomWorldOptions
{
	int least_joints = 2, most_joints = 8;
	int most_triangles = 30; ///< per mesh
	double tables = 1;       ///< share of worlds whose second checker has motion hulls and pair tables (0 without qhull)
	bool margins = false;
};

namespace random_world
{

inline leeway::Scene makeScene( SeededRng& rng, const lw_transform& around, int most_triangles )
{
	std::vector<ShapePtr> shapes;
	std::vector<std::string> names;
	std::vector<lw_scene_shape_def> defs;
	const int count = rng.integer( 0, 5 ) > 0 ? rng.integer( 5, 25 ) : 0;
	for ( int i = 0; i < count; ++i )
	{
		const bool mesh = rng.integer( 0, 2 ) > 0;
		const int triangles = rng.integer( 1, most_triangles );
		shapes.emplace_back( mesh ? randomMesh( rng, triangles, 0.15, nullptr ) : randomPrimitive( rng, 0.2, nullptr ) );
		lw_transform pose = randomTransform( rng, 0.7 );
		for ( int k = 0; k < 3; ++k )
		{
			pose.t[k] += around.t[k];
		}
		names.push_back( "object" + std::to_string( i ) );
		defs.push_back( { shapes.back().get(), static_cast<std::uint32_t>( i ), pose } );
	}
	std::vector<const char*> pointers;
	for ( const std::string& name : names )
	{
		pointers.push_back( name.c_str() );
	}
	lw_scene_def def = lw_scene_def_default();
	def.object_names = pointers.data();
	def.object_count = static_cast<std::uint32_t>( count );
	def.shapes = defs.data();
	def.shape_count = static_cast<std::uint32_t>( count );
	lw_scene* scene = nullptr;
	lw_diag diag = {};
	leeway::require( lw_scene_create( &def, nullptr, &diag, &scene ), diag );
	return leeway::Scene::adopt( scene );
}

/// Contacts, and all but contacts, of a state are allowed from now on.
inline void allowContacts( RobotModel& model, const lw_scene* scene, const std::vector<std::uint32_t>& variables,
    const State& state, const EdgeMargins& margins, std::vector<lw_link_object_pair>& allowed )
{
	const double close = 0.002;
	const RobotPtr robot = model.create();
	EdgeAuditor auditor( robot.get(), scene, variables, state.data(), {}, 1e-4,
	    [&]( bool self, std::uint32_t link, std::uint32_t other ) { return margins.of( self, link, other ); } );
	const std::uint32_t links = lw_robot_link_count( robot.get() );
	for ( std::uint32_t a = 0; a < links; ++a )
	{
		for ( std::uint32_t b = 0; b < a; ++b )
		{
			if ( auditor.clearance( state.data(), true, a, b ) < close )
			{
				model.allowed.push_back( { a, b } );
			}
		}
		for ( std::uint32_t k = 0; k < lw_scene_object_count( scene ); ++k )
		{
			if ( auditor.clearance( state.data(), false, a, k ) < close )
			{
				allowed.push_back( { a, k } );
			}
		}
	}
}

/// Of all kinds, millimetres to centimetres, and many zeros; some objects want much.
inline EdgeMargins randomMargins( SeededRng& rng, std::uint32_t links, std::uint32_t objects )
{
	EdgeMargins out;
	const auto some = [&] { return rng.integer( 0, 1 ) ? 0.0 : rng.decade( -3, -1.5 ); };
	out.environment = some();
	out.self = some();
	for ( std::uint32_t i = 0; i < links; ++i )
	{
		out.links.push_back( some() );
		out.self_links.push_back( 0.3 * some() );
	}
	for ( std::uint32_t i = 0; i < objects; ++i )
	{
		out.objects.push_back( rng.integer( 0, 5 ) ? some() : 0.1 );
	}
	for ( std::uint32_t a = 0; a < links; ++a ) // one of each at most
	{
		if ( objects > 0 && rng.integer( 0, 2 ) == 0 )
		{
			out.pairs.push_back(
			    { a, static_cast<std::uint32_t>( rng.integer( 0, static_cast<int>( objects ) - 1 ) ), some() } );
		}
		if ( a + 1 < links && rng.integer( 0, 2 ) == 0 )
		{
			const int low = static_cast<int>( a ) + 1, high = static_cast<int>( links ) - 1;
			out.self_pairs.push_back( { a, static_cast<std::uint32_t>( rng.integer( low, high ) ), some() } );
		}
	}
	return out;
}

/// All variables, or those of most joints.
inline std::vector<std::uint32_t> pickGroup( SeededRng& rng, const lw_robot* robot )
{
	std::vector<std::uint32_t> variables;
	const bool all = rng.integer( 0, 3 ) > 0;
	for ( std::uint32_t j = 0; j < lw_robot_joint_count( robot ); ++j )
	{
		const bool take = all || rng.integer( 0, 3 ) > 0;
		for ( std::uint32_t k = 0; take && k < lw_robot_joint_variable_count( robot, j ); ++k )
		{
			variables.push_back( lw_robot_joint_variable( robot, j ) + k );
		}
	}
	return variables;
}

inline leeway::Checker makeChecker( const EdgeWorld& world, const lw_reach* reach )
{
	lw_checker_def def = lw_checker_def_default();
	def.robot = world.robot.get();
	def.scene = world.scene.get();
	def.variables = world.variables.data();
	def.variable_count = static_cast<std::uint32_t>( world.variables.size() );
	def.reference = world.reference.data();
	def.allowed = world.allowed.data();
	def.allowed_count = static_cast<std::uint32_t>( world.allowed.size() );
	def.margins = world.margins.def();
	def.reach = reach;
	lw_checker* checker = nullptr;
	lw_diag diag = {};
	leeway::require( lw_checker_create( &def, nullptr, &diag, &checker ), diag );
	return leeway::Checker::adopt( checker );
}

} // namespace random_world

/// The same seed makes the same world.
inline EdgeWorld randomWorld( std::uint64_t seed, const RandomWorldOptions& options = {} )
{
	SeededRng rng{ std::mt19937_64( seed ) };
	RandomRobotOptions robot_options;
	robot_options.joints = rng.integer( options.least_joints, options.most_joints );
	robot_options.size = 0.1;
	robot_options.triangles = rng.integer( 1, options.most_triangles );
	robot_options.meshShare = rng.integer( 0, 1 ) ? 0.7 : 1.0;
	robot_options.floating = rng.integer( 0, 2 ) > 0;
	RobotModel model;
	std::vector<std::uint32_t> variables;
	RobotPtr robot;
	do
	{
		model = randomRobot( rng, robot_options );
		robot = model.create();
		variables = random_world::pickGroup( rng, robot.get() );
	} while ( variables.empty() );

	EdgeWorld world;
	world.set = "random robots";
	world.name = "random/" + std::to_string( seed );
	world.variables = variables;
	world.reference = randomState( rng, robot.get() );
	// rotations of random states have any length: edges start from states with unit ones
	lw_robot_interpolate( robot.get(), world.reference.data(), world.reference.data(), 0, world.reference.data() );
	world.scene = random_world::makeScene( rng, model.worldFromRoot, options.most_triangles );
	if ( options.margins )
	{
		world.margins = random_world::randomMargins(
		    rng, lw_robot_link_count( robot.get() ), lw_scene_object_count( world.scene.get() ) );
	}
	random_world::allowContacts( model, world.scene.get(), variables, world.reference, world.margins, world.allowed );
	world.robot = leeway::Robot::adopt( model.create().release() );
	world.home = world.group( world.reference );
	world.checker = random_world::makeChecker( world, nullptr );
	leeway::Reach reach;
	if ( rng.uniform( 0, 1 ) < options.tables )
	{
		lw_reach_def def = lw_reach_def_default();
		def.robot = world.robot.get();
		def.seconds = 0; // proofs by subdivision take wall time: with none the same seed gives the same tables
		def.samples = 200;
		lw_reach* made = nullptr;
		lw_diag diag = {};
		leeway::require( lw_reach_create( &def, nullptr, &diag, &made ), diag );
		reach = leeway::Reach::adopt( made );
	}
	world.with_tables = random_world::makeChecker( world, reach.get() );
	return world;
}
