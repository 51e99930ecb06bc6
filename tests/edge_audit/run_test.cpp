// SPDX-License-Identifier: BSD-3-Clause
// Proved runs of motions that are not free: bodies whose first contact follows from their geometry.
#include "audit_fixture.hpp"
#include "one_obstacle.hpp"
#include "random_robot.hpp"

#include <gtest/gtest.h>

namespace
{

ShapePtr ball( double radius )
{
	const double size[3] = { radius, 0, 0 };
	lw_shape* shape = nullptr;
	leeway::require( lw_shape_create_primitive( LW_SHAPE_SPHERE, size, nullptr, nullptr, &shape ), lw_diag{} );
	return ShapePtr( shape );
}

leeway::Scene ballsAt( const lw_shape* shape, const std::vector<double>& places )
{
	std::vector<lw_scene_shape_def> shapes;
	for ( const double x : places )
	{
		lw_transform pose = lw_transform_identity();
		pose.t[0] = x;
		shapes.push_back( { shape, 0, pose } );
	}
	const char* name = "balls";
	lw_scene_def def = lw_scene_def_default();
	def.object_names = &name;
	def.object_count = 1;
	def.shapes = shapes.data();
	def.shape_count = static_cast<std::uint32_t>( shapes.size() );
	lw_scene* scene = nullptr;
	leeway::require( lw_scene_create( &def, nullptr, nullptr, &scene ), lw_diag{} );
	return leeway::Scene::adopt( scene );
}

lw_edge_result proveRun( const lw_checker* checker, const std::vector<double>& from, const std::vector<double>& to )
{
	const leeway::Query query = leeway::makeQuery( checker );
	lw_edge_def def = lw_edge_def_default();
	def.want_proved_until = true;
	lw_edge_result result;
	EXPECT_EQ( lw_checker_edge( checker, query.get(), from.data(), to.data(), &def, &result ), LW_OK );
	return result;
}

} // namespace

// Two arms turn about one axis, each with a ball at its end: one may stand while the other turns.
TEST( ProvedRuns, TurnsOfBothBodiesCount )
{
	SeededRng rng;
	int partial = 0;
	for ( int i = 0; i < 300; ++i )
	{
		const double arm = rng.uniform( 0.3, 2 ), radius = rng.uniform( 0.01, 0.1 ) * arm;
		RobotModel model;
		model.worldFromRoot = randomTransform( rng, 1 );
		model.link( "base" );
		lw_transform at_end = lw_transform_identity();
		at_end.t[0] = arm;
		for ( int k = 0; k < 2; ++k )
		{
			lw_joint_def& joint = model.joint( "arm" + std::to_string( k ), LW_JOINT_REVOLUTE, 0 );
			joint.parent_from_joint = lw_transform_identity();
			model.body( static_cast<std::uint32_t>( k ) + 1, ball( radius ).release(), at_end );
		}
		const RobotPtr robot = model.create();
		const leeway::Checker checker = checkerOf( robot.get(), nullptr );
		const double contact = 2 * std::asin( radius / arm ); // angle between the arms
		const double away = contact + rng.uniform( 0.05, 0.6 ), inside = contact * rng.uniform( -1, 0.8 );
		const double first = rng.uniform( -1, 1 ), turn = ( away - inside ) * rng.integer( 0, 2 ) / 2;
		// the difference of the angles goes from `away` to `inside`
		const std::vector<double> from = { first, first + away }, to = { first + turn, first + turn + inside };
		for ( const bool swapped : { false, true } )
		{
			const auto order = [&]( const std::vector<double>& q ) {
				return swapped ? std::vector<double>{ q[1], q[0] } : q;
			};
			const lw_edge_result run = proveRun( checker.get(), order( from ), order( to ) );
			const double meets = ( away - contact ) / ( away - inside );
			ASSERT_NE( run.verdict, LW_VERDICT_FREE );
			ASSERT_LE( run.proved_until, meets * ( 1 + 1e-12 ) )
			    << "arm " << arm << ", ball " << radius << ", turn " << turn;
			partial += run.proved_until > 0.3 * meets;
		}
	}
	EXPECT_GT( partial, 300 );
}

// A ball on a rail, and balls beside each other on its way: those behind the first are no reason to go on.
TEST( ProvedRuns, EndBeforeTheFirstStateThatIsTooNear )
{
	SeededRng rng;
	int partial = 0;
	for ( int i = 0; i < 300; ++i )
	{
		const double radius = rng.uniform( 0.001, 0.03 );
		RobotModel model;
		model.link( "base" );
		lw_joint_def& joint = model.joint( "rail", LW_JOINT_PRISMATIC, 0 );
		joint.parent_from_joint = lw_transform_identity();
		joint.axis[0] = 1;
		joint.axis[2] = 0;
		model.body( 1, ball( radius ).release(), lw_transform_identity() );
		const RobotPtr robot = model.create();
		std::vector<double> places = { 0, i % 2 == 0 ? 1.0 : 0.75 }; // the middle of the motion, and its end
		if ( i % 3 == 0 )
		{
			places.push_back( rng.uniform( -0.9, 1 ) );
		}
		const ShapePtr obstacle = ball( radius );
		const leeway::Scene scene = ballsAt( obstacle.get(), places );
		const leeway::Checker checker = checkerOf( robot.get(), scene.get() );
		const lw_edge_result run = proveRun( checker.get(), { -1 }, { 1 } );
		const double meets = 0.5 * ( *std::min_element( places.begin(), places.end() ) - 2 * radius + 1 );
		ASSERT_NE( run.verdict, LW_VERDICT_FREE );
		ASSERT_LE( run.proved_until, meets * ( 1 + 1e-12 ) ) << "ball " << radius;
		partial += run.proved_until > 0.5 * meets;
	}
	EXPECT_GT( partial, 200 );
}
