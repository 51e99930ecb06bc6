// SPDX-License-Identifier: BSD-3-Clause
// Hulls of robots with limits of any size, from 1e-9 to 1e12, of each joint type in each order: bounded work, and nothing leaves them.
//
// A turning joint above a rail of +-1e6 m once swept 1e8 points.
#include "hull_world.hpp"

#include <cstdlib>

namespace
{

/// Bytes asked for since the beginning stand for the work: all points of all sweeps. Beyond `most` there is no memory.
struct Meter
{
	std::size_t most, total = 0;

	lw_allocator get()
	{
		return { []( void* user, std::size_t size, std::size_t align ) -> void*
		    {
			    auto* self = static_cast<Meter*>( user );
			    self->total += size;
			    return self->total > self->most ? nullptr
			                                    : std::aligned_alloc( align, ( size + align - 1 ) / align * align );
		    },
		    []( void*, void* memory, std::size_t ) { std::free( memory ); }, this };
	}
};

constexpr std::size_t bytes_per_link = std::size_t( 256 ) << 20;

const lw_joint_type types[] = {
    LW_JOINT_FIXED, LW_JOINT_REVOLUTE, LW_JOINT_CONTINUOUS, LW_JOINT_PRISMATIC, LW_JOINT_PLANAR, LW_JOINT_FLOATING };
constexpr int type_count = 6;

/// Joints of these types below each other, with ranges of 1e-9 to 1e12, some of which follow the first one.
RobotModel chainOf( SeededRng& rng, const std::vector<lw_joint_type>& order )
{
	RobotModel model;
	model.link( "root" );
	for ( std::size_t i = 0; i < order.size(); ++i )
	{
		lw_joint_def& j = model.joint( "l" + std::to_string( i ), order[i], static_cast<std::uint32_t>( i ) );
		j.parent_from_joint = randomTransform( rng, 0.3 );
		j.axis[0] = j.axis[1] = j.axis[2] = 0;
		j.axis[rng.integer( 0, 2 )] = 1;
		const auto width = [&] { return std::pow( 10, rng.uniform( -9, 12 ) ); };
		j.upper = width();
		j.lower = rng.integer( 0, 1 ) ? -j.upper : 0;
		for ( int k = 0; k < 3; ++k )
		{
			j.position_upper[k] = width();
			j.position_lower[k] = -j.position_upper[k];
		}
		const bool single = order[i] == LW_JOINT_REVOLUTE || order[i] == LW_JOINT_PRISMATIC;
		if ( i > 0 && single && rng.integer( 0, 3 ) == 0 &&
		     ( order[0] == LW_JOINT_REVOLUTE || order[0] == LW_JOINT_PRISMATIC ) )
		{
			j.mimic = 0;
			j.mimic_multiplier = rng.uniform( -2, 2 );
		}
	}
	for ( std::uint32_t link = 0; link < model.linkNames.size(); ++link )
	{
		std::vector<lw_vec3> points;
		lw_shape* shape = randomMesh( rng, 12, 0.15, &points );
		model.body( link, shape, randomTransform( rng, 0.1 ), points );
	}
	return model;
}

/// Chains of two, all; of three and four, `more` random ones.
std::vector<std::vector<lw_joint_type>> orders( SeededRng& rng, int more )
{
	std::vector<std::vector<lw_joint_type>> all;
	for ( lw_joint_type a : types )
	{
		for ( lw_joint_type b : types )
		{
			all.push_back( { a, b } );
		}
	}
	for ( int i = 0; i < more; ++i )
	{
		std::vector<lw_joint_type> order( 3 + i % 2 );
		std::generate( order.begin(), order.end(), [&] { return types[rng.integer( 0, type_count - 1 )]; } );
		all.push_back( order );
	}
	return all;
}

/// Points of a link at one state against the hull and the sphere of its M, and of those above it.
void expectInside( SeededRng& rng, const RobotModel& model, const lw_reach* reach, const State& q )
{
	const lw_robot* robot = lw_reach_robot( reach );
	std::vector<lw_transform> pose( model.linkNames.size() );
	ASSERT_EQ( lw_robot_fk( robot, q.data(), pose.data() ), LW_OK );
	for ( std::uint32_t link = 0; link < pose.size(); ++link )
	{
		for ( std::uint32_t node : chainUp( robot, link ) )
		{
			const std::uint32_t joint = lw_robot_link_joint( robot, node );
			const lw_transform parent =
			    joint == LW_INVALID_INDEX ? lw_transform_identity() : pose[lw_robot_joint_parent( robot, joint )];
			const lw_reach_node n = lw_reach_get_node( reach, node );
			const lw_vec3 along = direction( rng );
			const double most = support( lw_reach_hull_points( reach, node ), n.hull_point_count, along ) + n.dilation;
			for ( lw_vec3 p : linkPoints( model, link ) )
			{
				const lw_vec3 world = apply( pose[link], p ), at = applyInverse( parent, world );
				const double lost =
				    1e-14 * ( 100 + std::hypot( world.x, world.y, world.z ) + std::hypot( at.x, at.y, at.z ) );
				EXPECT_TRUE( std::isinf( n.m.radius ) || dot( along, at ) <= most + lost )
				    << "node " << node << ", link " << link;
				EXPECT_LE( distance( n.m.center, at ), n.m.radius + lost ) << "node " << node << ", link " << link;
			}
		}
	}
}

} // namespace

TEST( MotionHullLimits, WorkIsBoundedAndNothingLeavesTheHullsWhateverTheLimitsAre )
{
	SeededRng rng( 1106 );
	int unbounded = 0, bounded = 0;
	for ( const std::vector<lw_joint_type>& order : orders( rng, 40 ) )
	{
		const RobotModel model = chainOf( rng, order );
		const RobotPtr robot = model.create();
		Meter meter{ order.size() * bytes_per_link };
		const lw_allocator allocator = meter.get();
		lw_reach_def def = lw_reach_def_default();
		def.robot = robot.get();
		lw_reach* made = nullptr;
		lw_diag diag = {};
		ASSERT_EQ( createHulls( &def, &allocator, &diag, &made ), LW_OK )
		    << diag.message << ": joint types " << testing::PrintToString( order ) << " took " << meter.total << " bytes";
		const ReachPtr reach( made );
		for ( int s = 0; s < 20 && !HasFailure(); ++s )
		{
			expectInside( rng, model, reach.get(), coveredState( rng, reach.get(), s % 2 == 0 ) );
		}
		for ( std::uint32_t link = 0; link < model.linkNames.size(); ++link )
		{
			++( std::isinf( lw_reach_get_node( reach.get(), link ).m.radius ) ? unbounded : bounded );
		}
	}
	EXPECT_GT( bounded, 50 );
	EXPECT_GT( unbounded, 50 );
}

TEST( MotionHullLimits, RailOfHalfAKilometreBelowATurnIsHeldTightly )
{
	RobotModel model;
	model.link( "root" );
	model.joint( "turn", LW_JOINT_CONTINUOUS, 0 );
	lw_joint_def& rail = model.joint( "rail", LW_JOINT_PRISMATIC, 1 );
	rail.axis[0] = 1, rail.axis[2] = 0;
	rail.lower = -400, rail.upper = 400;
	SeededRng rng( 1107 );
	std::vector<lw_vec3> points;
	lw_shape* shape = randomMesh( rng, 12, 0.15, &points );
	model.body( 2, shape, lw_transform_identity(), points );
	const RobotPtr robot = model.create();
	const ReachPtr reach = build( robot.get() );
	const lw_reach_node node = lw_reach_get_node( reach.get(), 1 );
	EXPECT_GE( node.m.radius, 400 );
	EXPECT_LE( node.m.radius, 402 );
	EXPECT_LE( node.excess, 2 );
}
