// SPDX-License-Identifier: BSD-3-Clause
// Tables of a reach against the paper's formulas to the letter.
#include "pair_world.hpp"

namespace
{

/// Equations (1) to (12) to the letter, by recursion over sets.
struct LiteralTables
{
	const lw_reach* reach;
	const lw_robot* robot;
	std::vector<std::vector<std::uint32_t>> children;

	explicit LiteralTables( const lw_reach* r )
		: reach( r ), robot( lw_reach_robot( r ) ), children( lw_robot_link_count( robot ) )
	{
		for ( std::uint32_t j = 0; j < lw_robot_joint_count( robot ); ++j )
		{
			children[lw_robot_joint_parent( robot, j )].push_back( lw_robot_joint_child( robot, j ) );
		}
	}
	double base( std::uint32_t i, std::uint32_t j ) const
	{
		lw_reach_pair pair = lw_reach_get_pair( reach, i, j );
		bool checked = i != j && pair.kind != LW_PAIR_NONE && !lw_robot_pair_allowed( robot, i, j );
		return checked ? pair.separation : INFINITY;
	}
	std::vector<std::uint32_t> parts( std::uint32_t i ) const
	{
		std::vector<std::uint32_t> all = { i };
		for ( std::uint32_t child : children[i] )
		{
			std::vector<std::uint32_t> below = parts( child );
			all.insert( all.end(), below.begin(), below.end() );
		}
		return all;
	}
	double rigid( std::uint32_t i, std::uint32_t j ) const
	{
		double least = INFINITY;
		for ( std::uint32_t k : parts( j ) )
		{
			least = std::min( least, base( i, k ) );
		}
		return least;
	}
	double motion( std::uint32_t i, std::uint32_t j ) const
	{
		double least = INFINITY;
		for ( std::uint32_t l : parts( i ) )
		{
			least = std::min( least, rigid( l, j ) );
		}
		return least;
	}
	/// `neighbours`: R_i against its children too; without, as the paper has it, grandchildren only.
	double scfree( std::uint32_t i, bool neighbours ) const
	{
		double least = INFINITY;
		for ( std::uint32_t child : children[i] )
		{
			least = std::min( least, scfree( child, neighbours ) );
			least = neighbours ? std::min( least, rigid( i, child ) ) : least;
			for ( std::uint32_t grandchild : children[child] )
			{
				least = std::min( least, rigid( i, grandchild ) );
			}
			for ( std::uint32_t sibling : children[i] )
			{
				least = sibling != child ? std::min( least, motion( child, sibling ) ) : least;
			}
		}
		return least;
	}
};

} // namespace

TEST( ReachTables, EqualTheFormulas )
{
	SeededRng rng;
	int finite = 0, positive = 0, paper = 0;
	for ( int round = 0; round < 20; ++round )
	{
		RandomRobotOptions options;
		options.joints = rng.integer( 3, 12 );
		options.size = 0.05;
		RobotModel model = randomRobot( rng, options );
		bool neighboursAllowed = round % 2 == 0; // the paper's case
		for ( const lw_joint_def& joint : model.joints )
		{
			if ( neighboursAllowed || rng.integer( 0, 2 ) == 0 )
			{
				model.allowed.push_back( { joint.parent, joint.child } );
			}
		}
		// some links without geometry
		model.bodies.erase( model.bodies.begin() + rng.integer( 0, static_cast<int>( model.bodies.size() ) - 1 ) );
		RobotPtr robot = model.create();
		ASSERT_NE( robot, nullptr );
		ReachPtr reach = makeReach( robot.get(), 0.05, 20 );
		LiteralTables tables( reach.get() );
		std::uint32_t count = lw_robot_link_count( robot.get() );
		for ( std::uint32_t i = 0; i < count; ++i )
		{
			double scfree = lw_reach_scfree( reach.get(), i );
			EXPECT_EQ( scfree, tables.scfree( i, true ) ) << i;
			if ( neighboursAllowed )
			{
				EXPECT_EQ( scfree, tables.scfree( i, false ) ) << "with neighbours allowed (12) is the paper's, link " << i;
				++paper;
			}
			for ( std::uint32_t j = 0; j < count; ++j )
			{
				EXPECT_EQ( lw_reach_base( reach.get(), i, j ), tables.base( i, j ) ) << i << " " << j;
				EXPECT_EQ( lw_reach_rigid( reach.get(), i, j ), tables.rigid( i, j ) ) << i << " " << j;
				EXPECT_EQ( lw_reach_motion( reach.get(), i, j ), tables.motion( i, j ) ) << i << " " << j;
				finite += std::isfinite( tables.motion( i, j ) );
				positive += std::isfinite( tables.motion( i, j ) ) && tables.motion( i, j ) > 0;
			}
		}
	}
	EXPECT_GE( finite, 200 );
	EXPECT_GE( positive, 50 );
	EXPECT_GE( paper, 20 );
}
