// SPDX-License-Identifier: BSD-3-Clause
// Motion bounds of cells hunted for counterexamples: body points at random states of random cells of random robots, seen
// from every link on the way to another one.
#include "random_robot.hpp"

#include <algorithm>
#include <gtest/gtest.h>

// The internal interface, declared here because its headers are C only.
extern "C"
{
	struct lwi_motion_table;
	lw_status lwi_motion_table_create( const lw_robot* robot, const bool* fixed_variables, const double* reference,
	    const lw_allocator* allocator, lw_diag* diag, lwi_motion_table** out_table );
	void lwi_motion_table_destroy( lwi_motion_table* table );
	void lwi_motion_cell( const lwi_motion_table* table, uint32_t body, const uint32_t* way, uint32_t count, uint32_t upward,
	    const double* center, const double* half_width, const lw_transform* poses, double rounding, double* lengths );
	double lwi_motion_box_rounding( const lwi_motion_table* table, uint32_t body, const uint32_t* way, uint32_t count,
	    const double* lower, const double* upper );
}

namespace
{

std::vector<std::uint32_t> ancestors( const lw_robot* robot, std::uint32_t link )
{
	std::vector<std::uint32_t> all = { link };
	while ( lw_robot_link_joint( robot, link ) != LW_INVALID_INDEX )
	{
		link = lw_robot_joint_parent( robot, lw_robot_link_joint( robot, link ) );
		all.push_back( link );
	}
	return all;
}

/// The joints that move between two links, and behind each the link from which one looks.
struct Way
{
	std::vector<std::uint32_t> joints, seenFrom; ///< seenFrom has one more
	std::uint32_t upward = 0;
	bool floating = false;

	Way( const lw_robot* robot, const RobotModel& model, std::uint32_t from, std::uint32_t to )
	{
		std::vector<std::uint32_t> up = ancestors( robot, from ), down = ancestors( robot, to );
		while ( up.size() > 1 && down.size() > 1 && up[up.size() - 2] == down[down.size() - 2] )
		{
			up.pop_back();
			down.pop_back();
		}
		seenFrom.push_back( from );
		for ( std::size_t i = 0; i + 1 < up.size(); ++i )
		{
			add( robot, model, lw_robot_link_joint( robot, up[i] ), up[i + 1] );
		}
		upward = static_cast<std::uint32_t>( joints.size() );
		for ( std::size_t i = down.size() - 1; i-- > 0; )
		{
			add( robot, model, lw_robot_link_joint( robot, down[i] ), down[i] );
		}
	}

	void add( const lw_robot* robot, const RobotModel& model, std::uint32_t joint, std::uint32_t behind )
	{
		if ( isConstant( model, joint ) )
		{
			return;
		}
		floating = floating || lw_robot_joint_type( robot, joint ) == LW_JOINT_FLOATING;
		joints.push_back( joint );
		seenFrom.push_back( behind );
	}

	static bool isConstant( const RobotModel& model, std::uint32_t joint )
	{
		const lw_joint_def& j = model.joints[joint];
		if ( j.type == LW_JOINT_FIXED )
		{
			return true;
		}
		return j.mimic != LW_INVALID_INDEX && ( j.mimic_multiplier == 0 || isConstant( model, j.mimic ) );
	}
};

double distance( lw_vec3 a, lw_vec3 b )
{
	return std::sqrt( ( a.x - b.x ) * ( a.x - b.x ) + ( a.y - b.y ) * ( a.y - b.y ) + ( a.z - b.z ) * ( a.z - b.z ) );
}

lw_vec3 seen( const std::vector<lw_transform>& poses, std::uint32_t from, const lw_body_def& body, lw_vec3 p )
{
	lw_transform inverse = lw_transform_inverse( &poses[from] );
	lw_vec3 world = lw_transform_point( &poses[body.link], lw_transform_point( &body.link_from_shape, p ) );
	return lw_transform_point( &inverse, world );
}

} // namespace

TEST( MotionCell, NoPointLeavesItsBound )
{
	SeededRng rng;
	int downward = 0, tight = 0, checks = 0;
	for ( int round = 0; round < 400; ++round )
	{
		RandomRobotOptions options;
		options.joints = rng.integer( 1, 8 );
		RobotModel model = randomRobot( rng, options );
		RobotPtr robot = model.create();
		ASSERT_NE( robot, nullptr );
		lwi_motion_table* table = nullptr;
		ASSERT_EQ( lwi_motion_table_create( robot.get(), nullptr, nullptr, nullptr, nullptr, &table ), LW_OK );
		std::uint32_t variables = lw_robot_variable_count( robot.get() );
		int last = static_cast<int>( model.bodies.size() ) - 1;
		for ( int trial = 0; trial < 20; ++trial )
		{
			std::uint32_t body = static_cast<std::uint32_t>( rng.integer( 0, last ) );
			std::uint32_t to = static_cast<std::uint32_t>( rng.integer( 0, last ) );
			lw_body_def def = lw_robot_body( robot.get(), body );
			Way way( robot.get(), model, def.link, to );
			if ( way.floating )
			{
				continue;
			}
			State center = randomState( rng, robot.get() ), half( variables ), low( variables ), high( variables );
			double width = rng.decade( -4, 1.1 ); // beyond two turns: joints of +-2 pi, mimic factors
			for ( std::uint32_t v = 0; v < variables; ++v )
			{
				half[v] = rng.integer( 0, 2 ) > 0 ? width * rng.uniform( 0, 1 ) : 0;
				low[v] = center[v] - half[v];
				high[v] = center[v] + half[v];
			}
			std::uint32_t count = static_cast<std::uint32_t>( way.joints.size() );
			std::vector<lw_transform> middle( model.linkNames.size() ), poses( model.linkNames.size() );
			ASSERT_EQ( lw_robot_fk( robot.get(), center.data(), middle.data() ), LW_OK );
			double rounding = lwi_motion_box_rounding( table, body, way.joints.data(), count, low.data(), high.data() );
			EXPECT_LT( rounding, 1e-9 );
			std::vector<double> lengths( count + 1, 0.0 ), largest( count + 1, 0.0 );
			lwi_motion_cell( table, body, way.joints.data(), count, way.upward, center.data(), half.data(), middle.data(),
			    rounding, lengths.data() );
			for ( int sample = 0; sample < 12; ++sample )
			{
				State q = center;
				for ( std::uint32_t v = 0; v < variables; ++v )
				{
					double t = rng.integer( 0, 1 ) ? 2.0 * rng.integer( 0, 1 ) - 1 : rng.uniform( -1, 1 );
					q[v] += t * half[v];
				}
				ASSERT_EQ( lw_robot_fk( robot.get(), q.data(), poses.data() ), LW_OK );
				for ( std::uint32_t k = 0; k <= count; ++k )
				{
					for ( lw_vec3 p : model.bodyPoints[body] )
					{
						std::uint32_t from = way.seenFrom[k];
						double moved = distance( seen( middle, from, def, p ), seen( poses, from, def, p ) );
						EXPECT_LE( moved, lengths[k] + 2 * rounding ) << "round " << round << ", step " << k << "/" << count;
						largest[k] = std::max( largest[k], moved );
					}
				}
			}
			for ( std::uint32_t k = 1; k <= count; ++k )
			{
				++checks;
				downward += k > way.upward;
				tight += largest[k] > 0.3 * lengths[k];
			}
		}
		lwi_motion_table_destroy( table );
	}
	std::printf( "%d bounds, %d seen downwards, %d with a point that moves 0.3 of it\n", checks, downward, tight );
	EXPECT_GE( downward, 1000 );
	EXPECT_GE( tight, checks / 4 ) << "a bound that is never nearly reached is a bound of something else";
}

// Where joints below a turn shift, the bound has to follow their shift together, not by the farthest of them.
TEST( MotionCell, NoPointOfATelescopeLeavesItsBound )
{
	SeededRng rng;
	int tight = 0;
	constexpr int rounds = 200;
	for ( int round = 0; round < rounds; ++round )
	{
		const RobotModel model = telescope( rng );
		const auto tip = static_cast<std::uint32_t>( model.linkNames.size() - 1 );
		RobotPtr robot = model.create();
		ASSERT_NE( robot, nullptr );
		lwi_motion_table* table = nullptr;
		ASSERT_EQ( lwi_motion_table_create( robot.get(), nullptr, nullptr, nullptr, nullptr, &table ), LW_OK );
		Way way( robot.get(), model, tip, 0 );
		const auto count = static_cast<std::uint32_t>( way.joints.size() );
		const std::uint32_t variables = lw_robot_variable_count( robot.get() );
		State center( variables ), half( variables, 0.0 );
		const double side = rng.integer( 0, 1 ) ? 1 : -1;
		for ( double& value : center )
		{
			value = side * rng.uniform( 0.5, 1 ); // all stages out, or all in
		}
		half[0] = rng.uniform( 0.01, 1 ); // only the first joint turns
		std::vector<lw_transform> middle( model.linkNames.size() ), poses( model.linkNames.size() );
		ASSERT_EQ( lw_robot_fk( robot.get(), center.data(), middle.data() ), LW_OK );
		const double rounding = lwi_motion_box_rounding( table, 0, way.joints.data(), count, center.data(), center.data() );
		std::vector<double> lengths( count + 1, 0.0 );
		lwi_motion_cell( table, 0, way.joints.data(), count, way.upward, center.data(), half.data(), middle.data(), rounding,
		    lengths.data() );
		double largest = 0;
		for ( double end : { -1.0, 1.0 } )
		{
			State q = center;
			q[0] += end * half[0];
			ASSERT_EQ( lw_robot_fk( robot.get(), q.data(), poses.data() ), LW_OK );
			for ( lw_vec3 p : model.bodyPoints[0] )
			{
				const double moved = distance( seen( middle, 0, model.bodies[0], p ), seen( poses, 0, model.bodies[0], p ) );
				EXPECT_LE( moved, lengths[count] + 2 * rounding ) << "round " << round;
				largest = std::max( largest, moved );
			}
		}
		tight += largest > 0.9 * lengths[count];
		lwi_motion_table_destroy( table );
	}
	EXPECT_GE( tight, rounds / 2 );
}
