// SPDX-License-Identifier: BSD-3-Clause
// Checkers of the changes only: a pair that neither they nor the checker before them has, or one that both have.
#include "changing_world.hpp"
#include "simple_shapes.hpp"

#include <gtest/gtest.h>

namespace
{

/// Each checker has its own query.
struct Asked
{
	leeway::Checker checker;
	leeway::Query query;

	explicit Asked( leeway::Checker of ) : checker( std::move( of ) ), query( leeway::makeQuery( checker.get() ) ) {}

	lw_state_result state( const State& q ) const
	{
		lw_state_result result;
		EXPECT_EQ( LW_OK, lw_checker_state( checker.get(), query.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &result ) );
		return result;
	}

	lw_verdict edge( const State& qa, const State& qb ) const
	{
		const lw_edge_def def = lw_edge_def_default();
		lw_edge_result result;
		EXPECT_EQ( LW_OK, lw_checker_edge( checker.get(), query.get(), qa.data(), qb.data(), &def, &result ) );
		return result.verdict;
	}
};

/// The nearest pair of everything is one of before, or one of the changes.
void expectCovered(
    const lw_clearance& all, const lw_clearance& before, const lw_clearance& changes, const std::string& what )
{
	const double rounding = 1e-9;
	EXPECT_LE( std::min( before.lower, changes.lower ), all.upper + rounding ) << what;
	EXPECT_GE( changes.upper, all.lower - rounding ) << what;
}

} // namespace

// A pair left out by mistake would be missed by both: exact clearances say so in every state.
TEST( Changes, CheckerBeforeAndCheckerOfChangesMissAPair )
{
	SeededRng rng;
	std::map<std::string, int> kinds;
	int nearest = 0, edges = 0, blocked = 0;
	for ( int world_number = 0; world_number < 40; ++world_number )
	{
		ChangingWorld world( rng, false );
		for ( int i = 0; i < 30 && !::testing::Test::HasFailure(); ++i )
		{
			const Asked before( world.checker );
			const std::string kind = world.change( rng );
			for ( int more = rng.integer( 0, 3 ); more > 0; --more )
			{
				++kinds[world.change( rng )];
			}
			const std::string what = "world " + std::to_string( world_number ) + ", " + kind;
			const Asked all( world.checker );
			const Asked changes(
			    world.checkerFromNothing( world.robot, world.scene, leeway::Reach(), before.checker.get() ) );
			const lw_checker_info some = lw_checker_get_info( changes.checker.get() ),
			                      full = lw_checker_get_info( all.checker.get() );
			EXPECT_LE( some.environment_pairs, full.environment_pairs ) << what;
			for ( int k = 0; k < 4; ++k )
			{
				const State q = world.randomGroupState( rng );
				const lw_state_result a = all.state( q ), b = before.state( q ), c = changes.state( q );
				expectCovered( a.environment, b.environment, c.environment, what + ", environment" );
				expectCovered( a.self, b.self, c.self, what + ", self" );
				nearest += c.environment.lower < b.environment.lower || c.self.lower < b.self.lower;
			}
			const State qa = world.randomGroupState( rng ), qb = world.randomGroupState( rng );
			const lw_verdict verdict = all.edge( qa, qb );
			const bool both = before.edge( qa, qb ) == LW_VERDICT_FREE && changes.edge( qa, qb ) == LW_VERDICT_FREE;
			EXPECT_FALSE( both && verdict == LW_VERDICT_BLOCKED ) << what;
			EXPECT_FALSE( verdict == LW_VERDICT_FREE && changes.edge( qa, qb ) == LW_VERDICT_BLOCKED ) << what;
			++kinds[kind];
			edges += both;
			blocked += verdict == LW_VERDICT_BLOCKED;
		}
	}
	std::printf( "%d states nearest to a change, %d edges free by both, %d blocked\n", nearest, edges, blocked );
	for ( const char* kind : { "move", "add", "remove", "attach", "detach", "allow", "max_d", "margin" } )
	{
		EXPECT_GT( kinds[kind], 20 ) << kind;
	}
	EXPECT_GT( nearest, 100 );
	EXPECT_GT( edges, 10 );
	EXPECT_GT( blocked, 10 );
}

// The cost is that of the change only if the other pairs are gone, self pairs too.
TEST( Changes, PairsThatDidNotChangeAreCheckedAgain )
{
	RobotModel model;
	model.link( "base" );
	model.joint( "arm", LW_JOINT_CONTINUOUS, 0 );
	model.body( 0, primitive( LW_SHAPE_SPHERE, 0.1, 0, 0 ), at( 0, 0, 3 ) );
	model.body( 1, primitive( LW_SHAPE_SPHERE, 0.1, 0, 0 ), at( 1, 0, 0 ) );
	const RobotPtr robot = model.create();
	const ShapePtr ball( primitive( LW_SHAPE_SPHERE, 0.1, 0, 0 ) );
	const char* const names[] = { "left", "right" };
	lw_scene_shape_def shapes[] = { { ball.get(), 0, at( 0, 2, 0 ) }, { ball.get(), 1, at( 0, -2, 0 ) } };
	lw_scene_def scene_def = lw_scene_def_default();
	scene_def.object_names = names;
	scene_def.object_count = scene_def.shape_count = 2;
	scene_def.shapes = shapes;
	lw_scene* scene = nullptr;
	ASSERT_EQ( LW_OK, lw_scene_create( &scene_def, nullptr, nullptr, &scene ) );
	const leeway::Scene first = leeway::Scene::adopt( scene );
	shapes[1].world_from_shape = at( 0, -1, 0 );
	ASSERT_EQ( LW_OK, lw_scene_create( &scene_def, nullptr, nullptr, &scene ) );
	const leeway::Scene second = leeway::Scene::adopt( scene );
	lw_checker_def def = lw_checker_def_default();
	def.robot = robot.get();
	def.scene = first.get();
	lw_checker* made = nullptr;
	ASSERT_EQ( LW_OK, lw_checker_create( &def, nullptr, nullptr, &made ) );
	const leeway::Checker before = leeway::Checker::adopt( made );
	lw_checker_edit_def edit = lw_checker_edit_def_default();
	edit.scene = second.get();
	edit.only_changes = true;
	ASSERT_EQ( LW_OK, lw_checker_edit( before.get(), &edit, nullptr, nullptr, &made ) );
	const Asked changes{ leeway::Checker::adopt( made ) };
	EXPECT_EQ( 2u, lw_checker_get_info( before.get() ).environment_pairs );
	EXPECT_EQ( 1u, lw_checker_get_info( made ).environment_pairs );
	const lw_state_result up = changes.state( { 1.5 } ), down = changes.state( { -1.5707963267948966 } );
	EXPECT_EQ( INFINITY, up.self.lower );
	EXPECT_GT( up.environment.lower, 1 ) << "the ball that stayed is 0.8 m away";
	EXPECT_EQ( LW_VERDICT_BLOCKED, down.verdict );
	EXPECT_EQ( LW_VERDICT_FREE, changes.edge( { 0.5 }, { 2 } ) );
	EXPECT_EQ( LW_VERDICT_BLOCKED, changes.edge( { -1 }, { -2 } ) );

	// of another robot nothing is known, equal as it may be
	const RobotPtr other = model.create();
	def.robot = other.get();
	def.previous = before.get();
	def.only_changes = true;
	ASSERT_EQ( LW_OK, lw_checker_create( &def, nullptr, nullptr, &made ) );
	const Asked everything{ leeway::Checker::adopt( made ) };
	EXPECT_EQ( 2u, lw_checker_get_info( made ).environment_pairs );
	EXPECT_LT( everything.state( { 0 } ).self.upper, 4 );

	// pairs that the checker of changes leaves out are not known to one that follows it
	edit.scene = nullptr;
	ASSERT_EQ( LW_OK, lw_checker_edit( changes.checker.get(), &edit, nullptr, nullptr, &made ) );
	const Asked rest{ leeway::Checker::adopt( made ) };
	EXPECT_EQ( 1u, lw_checker_get_info( made ).environment_pairs );
	EXPECT_NEAR( std::sqrt( 10.0 ) - 0.2, rest.state( { 0 } ).self.upper, 1e-9 );
	EXPECT_NEAR( 0.8, rest.state( { 1.5707963267948966 } ).environment.upper, 1e-9 );
}
