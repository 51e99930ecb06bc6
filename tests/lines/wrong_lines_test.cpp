// SPDX-License-Identifier: BSD-3-Clause
// Lines that cannot be: the place and the reason are named; tasks that cannot be meant are errors.
#include "line_world.hpp"

#include <functional>

namespace
{

bool contains( const std::string& text, const std::string& part )
{
	return text.find( part ) != std::string::npos;
}

} // namespace

TEST( WrongLines, AnObstacleOnTheLineIsNotNamed )
{
	const std::string scene =
	    "world:\n  collision_objects:\n    - {id: ball, primitives: [{type: sphere, dimensions: [0.05]}], "
	    "primitive_poses: [{position: [0.4, 0.1, 0.45], orientation: [0, 0, 0, 1]}]}\n";
	LineWorld world( sevenAxisArm(), scene );
	world.settings.attempts = 10;
	world.task.waypoints = { { placed( 0.4, -0.2, 0.45 ) }, { placed( 0.4, 0.2, 0.45 ) } };
	const lines::Result r = world.plan();
	ASSERT_FALSE( r.solved );
	EXPECT_EQ( lines::Obstacle::COLLISION, r.stop.obstacle );
	EXPECT_EQ( "ball", r.stop.pair.second );
	EXPECT_NEAR( 0.4, r.stop.position.x, 1e-9 );
	EXPECT_GT( r.stop.fraction, 0.57 ); // balls of 0.02 and 0.05 m meet at 0.575, or a link before
	EXPECT_LT( r.stop.fraction, 0.62 );
	EXPECT_TRUE( contains( lines::describe( world.problem, r ), "ball" ) );
}

TEST( WrongLines, TheEndOfTheReachIsNotNamed )
{
	LineWorld world( sixAxisArm() );
	world.settings.attempts = 5;
	world.task.waypoints = { { placed( 0.5, 0, 0.4 ) }, { placed( 1.5, 0, 0.4 ) } };
	const lines::Result r = world.plan();
	ASSERT_FALSE( r.solved );
	EXPECT_TRUE( r.stop.obstacle == lines::Obstacle::SINGULARITY || r.stop.obstacle == lines::Obstacle::JOINT_LIMIT );
	EXPECT_FALSE( r.stop.joint.empty() );
	EXPECT_GT( r.stop.fraction, 0.05 );
	EXPECT_LT( r.stop.fraction, 0.6 );
	EXPECT_EQ( 6u, r.stop.q.size() );
}

TEST( WrongLines, AnUnreachableEndIsTriedInEveryPosture )
{
	LineWorld world( sevenAxisArm() );
	world.task.waypoints = { { placed( 0.35, 0, 0.4 ) }, { placed( 1.5, 0, 0.4 ) } };
	const lines::Result r = world.plan();
	ASSERT_FALSE( r.solved );
	EXPECT_LE( r.attempts, 8u );
	EXPECT_GT( r.stop.fraction, 0.05 );
}

TEST( WrongLines, ALimitOfAJointIsNotNamed )
{
	LineWorld world( sixAxisArm() );
	world.problem.reference = { 2.8, 0.5, 1.2, 0.1, -0.6, 0.3 };
	world.task.any_start = false;
	const lw_transform at = world.tip( world.problem.reference );
	// around the base, against the limit of the first joint at 2.9
	const double x = at.t[0], y = at.t[1], angle = -1.2;
	lw_transform to = at;
	const lw_transform turn = placed( 0, 0, 0, 0, 0, -angle );
	to = lw_transform_multiply( &turn, &to );
	world.task.waypoints = {
	    { to, lw_vec3{ x * std::cos( 0.5 ) - y * std::sin( 0.5 ), x * std::sin( 0.5 ) + y * std::cos( 0.5 ), at.t[2] } } };
	const lines::Result r = world.plan();
	ASSERT_FALSE( r.solved );
	EXPECT_EQ( 1u, r.attempts ); // there is no other way for six joints
	EXPECT_EQ( lines::Obstacle::JOINT_LIMIT, r.stop.obstacle ) << lines::describe( world.problem, r );
	EXPECT_EQ( "j1", r.stop.joint );
}

TEST( WrongLines, AnUnreachableStartIsSearchedForEver )
{
	LineWorld world( sixAxisArm() );
	world.task.waypoints = { { placed( 3, 0, 0.4 ) }, { placed( 3, 0, 0.5 ) } };
	const lines::Result r = world.plan();
	EXPECT_EQ( lines::Obstacle::UNREACHABLE, r.stop.obstacle );
	EXPECT_TRUE( contains( lines::describe( world.problem, r ), "no state has this pose" ) );
}

TEST( WrongLines, AStartInCollisionIsUsed )
{
	const std::string scene =
	    "world:\n  collision_objects:\n    - {id: ball, primitives: [{type: sphere, dimensions: [3]}], "
	    "primitive_poses: [{position: [0, 0, 0], orientation: [0, 0, 0, 1]}]}\n";
	LineWorld world( sevenAxisArm(), scene );
	world.task.any_start = false;
	world.task.waypoints = { { placed( 0.35, -0.25, 0.45 ) } };
	const lines::Result r = world.plan();
	EXPECT_FALSE( r.solved );
	EXPECT_EQ( 1u, r.attempts );
	EXPECT_EQ( 0, r.stop.fraction );
}

TEST( WrongLines, TasksThatCannotBeMeant )
{
	const struct
	{
		const char* words;
		std::function<void( lines::Task& )> spoil;
	} cases[] = {
	    { "tolerance", []( lines::Task& t ) { t.tolerance = 0; } },
	    { "tolerance", []( lines::Task& t ) { t.angle = NAN; } },
	    { "speed", []( lines::Task& t ) { t.speed = 0; } },
	    { "free axis",
	        []( lines::Task& t ) {
		        t.free_axis = lw_vec3{ 0, 0, 0 };
	        } },
	    { "too few", []( lines::Task& t ) { t.waypoints.pop_back(); } },
	    { "no finite pose", []( lines::Task& t ) { t.waypoints[1].pose.t[0] = NAN; } },
	    { "no circle",
	        []( lines::Task& t ) {
		        t.waypoints[1].via = lw_vec3{ 0.35, 0, 0.45 };
	        } },
	    { "there already", []( lines::Task& t ) { t.waypoints[1] = t.waypoints[0]; } },
	    { "does not move", []( lines::Task& t ) { t.tip.link = 0; } },
	};
	for ( const auto& wrong : cases )
	{
		LineWorld world( sevenAxisArm() );
		world.task.waypoints = { { placed( 0.35, -0.25, 0.45 ) }, { placed( 0.35, 0.25, 0.45 ) } };
		wrong.spoil( world.task );
		try
		{
			world.plan();
			ADD_FAILURE() << wrong.words;
		}
		catch ( const io::Error& error )
		{
			EXPECT_TRUE( contains( error.what(), wrong.words ) ) << error.what();
		}
	}
}
