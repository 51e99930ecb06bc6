// SPDX-License-Identifier: BSD-3-Clause
// Grids: no state of a cell is nearer than the cell says, cells say something, checkers look into the right one.
#include "checker/checker.h"
#include "checker/clusters.h"
#include "random_robot.hpp"
#include "reach_attack.hpp"
#include "reachability/reach.h"

#include <cstdio>
#include <numeric>

namespace
{

constexpr double ROUNDING = 1e-9; ///< metres: an attack may find this much below a cell

/// A clearance grid of a reach, its axes unpacked.
struct Grid
{
	const lwi_grid* from;
	std::uint32_t link_a, link_b, dimension;
	std::uint32_t variable[3], cells[3];
	double lower[3], upper[3];
	bool periodic[3];

	explicit Grid( const lwi_grid& grid )
	    : from( &grid ), link_a( grid.link_a ), link_b( grid.link_b ), dimension( grid.dimension )
	{
		for ( std::uint32_t i = 0; i < dimension; ++i )
		{
			variable[i] = grid.axes[i].variable;
			cells[i] = 1u << grid.axes[i].bits;
			lower[i] = grid.axes[i].lower;
			upper[i] = grid.axes[i].upper;
			periodic[i] = grid.axes[i].periodic;
		}
	}

	/// The bound of the cell with these indices, metres.
	double at( const std::uint32_t index[3] ) const
	{
		std::size_t cell = 0;
		for ( std::uint32_t i = 0; i < dimension; ++i )
		{
			cell = ( cell << from->axes[i].bits ) + index[i];
		}
		return from->cells[cell] * LWI_GRID_STEP;
	}
};

/// Links of the pair of bodies that a slice is of.
void linksOfSlice( const lw_checker* checker, std::uint32_t slice, std::uint32_t* link_a, std::uint32_t* link_b )
{
	const lwi_cluster_tree* tree = checker->base->tree;
	for ( std::uint32_t a = 0; a < tree->body_count; ++a )
	{
		for ( std::uint32_t b = 0; b < tree->body_count; ++b )
		{
			for ( std::uint32_t p = 0; p < tree->self.pair_count; ++p )
			{
				bool here = tree->self.pairs[p].cluster_a == tree->body_cluster[a] &&
				            tree->self.pairs[p].cluster_b == tree->body_cluster[b];
				if ( here && lwi_checker_slice( tree, p, a, b ) == &tree->grids.slices[slice] )
				{
					*link_a = checker->base->bodies[a].link;
					*link_b = checker->base->bodies[b].link;
				}
			}
		}
	}
}

double sliceAt( const lw_checker* checker, std::uint32_t slice, const double* q )
{
	const lwi_cluster_tree* tree = checker->base->tree;
	return lwi_grid_at( &tree->grids.slices[slice], tree->grids.spacings, q );
}

double sliceAlong( const lw_checker* checker, std::uint32_t slice, const double* qa, const double* qb )
{
	const lwi_cluster_tree* tree = checker->base->tree;
	return lwi_grid_along( &tree->grids.slices[slice], tree->grids.spacings, checker->base->robot, qa, qb, 0 );
}

CheckerPtr makeChecker( const lw_reach* reach, const State& reference, const std::vector<std::uint32_t>& group )
{
	const std::uint32_t none = 0;
	lw_checker_def def = lw_checker_def_default();
	def.robot = lw_reach_robot( reach );
	def.reach = reach;
	def.reference = reference.data();
	def.variables = group.empty() ? &none : group.data();
	def.variable_count = static_cast<std::uint32_t>( group.size() );
	lw_checker* checker = nullptr;
	lw_diag diag = {};
	EXPECT_EQ( lw_checker_create( &def, nullptr, &diag, &checker ), LW_OK ) << diag.message;
	return CheckerPtr( checker );
}

/// Few joints between most links, some of them endless, mimics among them.
RobotPtr randomNeighbours( SeededRng& rng )
{
	RandomRobotOptions options;
	options.joints = rng.integer( 3, 6 );
	options.size = 0.08;
	RobotModel model = randomRobot( rng, options );
	return model.create();
}

/// Three joints in a row, some of them with more than a turn between their limits.
RobotPtr randomChain( SeededRng& rng )
{
	static const lw_joint_type types[] = { LW_JOINT_REVOLUTE, LW_JOINT_CONTINUOUS, LW_JOINT_PRISMATIC };
	RobotModel model;
	model.link( "link0" );
	for ( std::uint32_t i = 0; i < 4; ++i )
	{
		if ( i > 0 )
		{
			lw_joint_def& joint = model.joint( "link" + std::to_string( i ), types[rng.integer( 0, 2 )], i - 1 );
			joint.parent_from_joint = randomTransform( rng, 0.2 );
			joint.lower = rng.uniform( -3, 0 );
			joint.upper = joint.lower + ( rng.integer( 0, 2 ) == 0 ? rng.uniform( 5, 14 ) : rng.uniform( 0.1, 3 ) );
		}
		model.body( i, randomPrimitive( rng, 0.08, nullptr ), randomTransform( rng, 0.1 ) );
	}
	return model.create();
}

RobotPtr randomRobotOf( SeededRng& rng, int round )
{
	return round % 2 == 0 ? randomChain( rng ) : randomNeighbours( rng );
}

/// A state inside of a cell, on its border in some variables.
void drawInCell( SeededRng& rng, const Grid& grid, const std::uint32_t index[3], State& q )
{
	for ( std::uint32_t i = 0; i < grid.dimension; ++i )
	{
		double width = ( grid.upper[i] - grid.lower[i] ) / grid.cells[i];
		double low = grid.lower[i] + width * index[i], high = low + width;
		int where = rng.integer( 0, 3 );
		q[grid.variable[i]] = where == 0 ? low : where == 1 ? high : rng.uniform( low, high );
	}
}

/// The least distance in a cell: random states, then random steps from the best one.
double attackCell( SeededRng& rng, PairAttacker& attacker, const Grid& grid, const std::uint32_t index[3], State q )
{
	State best = q;
	double least = INFINITY;
	for ( int i = 0; i < 40 && least > 0; ++i )
	{
		if ( i < 15 )
		{
			drawInCell( rng, grid, index, q );
		}
		else
		{
			std::uint32_t k = static_cast<std::uint32_t>( rng.integer( 0, static_cast<int>( grid.dimension ) - 1 ) );
			double width = ( grid.upper[k] - grid.lower[k] ) / grid.cells[k], low = grid.lower[k] + width * index[k];
			q = best;
			q[grid.variable[k]] += rng.normal() * 0.3 * width;
			q[grid.variable[k]] = std::min( std::max( q[grid.variable[k]], low ), low + width );
		}
		double found = attacker.distance( grid.link_a, grid.link_b, q, least );
		if ( found < least )
		{
			least = found;
			best = q;
		}
	}
	return least;
}

/// A random robot with its grids, a state, and a group of its variables.
struct RobotWithGrids
{
	RobotWithGrids( SeededRng& rng, int round )
	    : robot( randomRobotOf( rng, round ) ), reach( makeReach( robot.get(), 0.5, 50 ) ),
	      attacker( reach.get(), rng.engine()() ), reference( attacker.randomState() )
	{
	}

	CheckerPtr checker() const { return makeChecker( reach.get(), reference, group ); }

	RobotPtr robot;
	ReachPtr reach;
	PairAttacker attacker;
	State reference;
	std::vector<std::uint32_t> group;
};

} // namespace

TEST( ClearanceGrids, NoStateIsNearerThanItsCellSays )
{
	SeededRng rng;
	int grids = 0, cells = 0, tight = 0, near = 0;
	std::uint32_t dimensions[4] = { 0, 0, 0, 0 };
	// A slow machine makes fewer grids of a robot in its second: it goes on to more robots, here and below
	const auto few = [&]
	{ return grids < 30 || dimensions[1] < 3 || dimensions[2] < 5 || dimensions[3] < 3 || cells < 300; };
	for ( int round = 0; round < 24 || ( round < 240 && few() ); ++round )
	{
		RobotPtr robot = randomRobotOf( rng, round );
		ASSERT_NE( robot, nullptr );
		ReachPtr reach = makeReach( robot.get(), 1, 50 );
		ASSERT_NE( reach, nullptr );
		PairAttacker attacker( reach.get(), rng.engine()() );
		for ( std::uint32_t c = 0; c < reach->grid_count; ++c )
		{
			const Grid grid( reach->grids[c] );
			++grids;
			++dimensions[grid.dimension];
			for ( int i = 0; i < 25; ++i )
			{
				std::uint32_t index[3] = { 0, 0, 0 };
				for ( std::uint32_t k = 0; k < grid.dimension; ++k )
				{
					index[k] = static_cast<std::uint32_t>( rng.integer( 0, static_cast<int>( grid.cells[k] ) - 1 ) );
				}
				double says = grid.at( index );
				if ( says <= 0 )
				{
					continue;
				}
				double least = attackCell( rng, attacker, grid, index, attacker.randomState() );
				EXPECT_GE( least, says - ROUNDING ) << "round " << round << ", links " << grid.link_a << " " << grid.link_b;
				++cells;
				tight += least < 1.5 * says + 0.002;
				near += says < 0.02;
			}
		}
	}
	std::printf( "%d grids of %u, %u, %u variables; %d cells, %d within half, %d near\n", grids, dimensions[1],
	    dimensions[2], dimensions[3], cells, tight, near );
	EXPECT_GE( grids, 30 );
	EXPECT_GE( dimensions[1], 3u );
	EXPECT_GE( dimensions[2], 5u );
	EXPECT_GE( dimensions[3], 3u );
	EXPECT_GE( cells, 300 );
	EXPECT_GE( tight, cells / 4 ) << "true, and of little use";
}

// The cell of a state is computed anew, in long double; all cells are as good where a state is on a border.
TEST( ClearanceGrids, CheckersLookIntoTheRightCell )
{
	SeededRng rng;
	int looked = 0, said = 0;
	for ( int round = 0; round < 8 || ( round < 80 && ( looked < 1000 || said < 300 ) ); ++round )
	{
		RobotWithGrids world( rng, round );
		for ( std::uint32_t v = 0; v < world.reference.size(); ++v )
		{
			const std::uint32_t joint = lw_robot_variable( world.robot.get(), v ).joint;
			if ( lw_robot_joint_variable_count( world.robot.get(), joint ) == 1 && rng.integer( 0, 3 ) > 0 )
			{
				world.group.push_back( v );
			}
		}
		CheckerPtr checker = world.checker();
		for ( std::uint32_t slice = 0; slice < checker->base->tree->grids.slice_count; ++slice )
		{
			std::uint32_t a = 0, b = 0, c = 0;
			linksOfSlice( checker.get(), slice, &a, &b );
			while (
			    !( world.reach->grids[c].link_a == std::max( a, b ) && world.reach->grids[c].link_b == std::min( a, b ) ) )
			{
				ASSERT_LT( ++c, world.reach->grid_count );
			}
			const Grid grid( world.reach->grids[c] );
			for ( int i = 0; i < 200; ++i )
			{
				State q = world.reference, drawn = world.attacker.randomState();
				std::uint32_t index[3] = { 0, 0, 0 };
				for ( std::uint32_t v : world.group )
				{
					double turns = lw_robot_variable( world.robot.get(), v ).wraps ? 2 * M_PI * rng.integer( -3, 3 ) : 0;
					q[v] = drawn[v] + turns;
				}
				bool onBorder = false;
				for ( std::uint32_t k = 0; k < grid.dimension; ++k )
				{
					long double x = q[grid.variable[k]], width = grid.upper[k] - static_cast<long double>( grid.lower[k] );
					long double u = ( x - grid.lower[k] ) / width;
					u -= grid.periodic[k] ? std::floor( u ) : 0;
					long double cell = u * grid.cells[k];
					onBorder = onBorder || std::fabs( cell - std::round( cell ) ) < 1e-9L;
					index[k] = static_cast<std::uint32_t>( std::min( std::floor( cell ), grid.cells[k] - 1.0L ) );
				}
				double says = grid.at( index ), got = sliceAt( checker.get(), slice, q.data() );
				looked += !onBorder;
				said += says > 0;
				EXPECT_TRUE( onBorder || ( got <= says && got >= says * ( 1 - 1e-6 ) - 2e-9 ) ) << got << " " << says;
			}
		}
	}
	EXPECT_GE( looked, 1000 );
	EXPECT_GE( said, 300 );
}

TEST( ClearanceGrids, NoStateOfAnEdgeSaysLessThanTheEdge )
{
	SeededRng rng;
	int edges = 0, said = 0;
	for ( int round = 0; round < 8 || ( round < 80 && ( edges < 500 || said < 100 ) ); ++round )
	{
		RobotWithGrids world( rng, round );
		world.group.resize( world.reference.size() );
		std::iota( world.group.begin(), world.group.end(), 0u );
		CheckerPtr checker = world.checker();
		for ( std::uint32_t slice = 0; slice < checker->base->tree->grids.slice_count; ++slice )
		{
			for ( int i = 0; i < 60; ++i )
			{
				State from = world.attacker.randomState(), to = world.attacker.randomState(), q( from.size() );
				double length = std::pow( 10.0, rng.uniform( -3, 0 ) );
				for ( std::uint32_t v = 0; v < from.size(); ++v )
				{
					bool wraps = lw_robot_variable( world.robot.get(), v ).wraps; // over the seam, too
					to[v] = wraps ? from[v] + rng.uniform( -3, 3 ) * length : from[v] + ( to[v] - from[v] ) * length;
				}
				double along = sliceAlong( checker.get(), slice, from.data(), to.data() );
				++edges;
				said += along > 0;
				for ( int k = 0; k <= 100; ++k )
				{
					lw_robot_interpolate( world.robot.get(), from.data(), to.data(), k / 100.0, q.data() );
					EXPECT_GE( sliceAt( checker.get(), slice, q.data() ) + 1e-12, along ) << "at " << k;
				}
			}
		}
	}
	EXPECT_GE( edges, 500 );
	EXPECT_GE( said, 100 );
}

// Two balls of 0.1 and 0.05, the second at the end of two joints: the best possible grid is known.
TEST( ClearanceGrids, SayMostOfTheTruth )
{
	RobotModel model;
	auto ball = [&]( std::uint32_t link, double radius, double x, double z )
	{
		double dimensions[3] = { radius, 0, 0 };
		lw_shape* shape = nullptr;
		ASSERT_EQ( lw_shape_create_primitive( LW_SHAPE_SPHERE, dimensions, nullptr, nullptr, &shape ), LW_OK );
		lw_transform at = lw_transform_identity();
		at.t[0] = x;
		at.t[2] = z;
		model.body( link, shape, at );
	};
	model.link( "base" );
	ball( 0, 0.1, 0, 0 );
	model.joint( "upper", LW_JOINT_REVOLUTE, 0 ).parent_from_joint.t[0] = 0.2;
	ball( 1, 1e-3, 0, -5 ); // a pin, so that base and tip are not adjacent
	model.joint( "tip", LW_JOINT_CONTINUOUS, 1 ).parent_from_joint.t[0] = 0.15;
	ball( 2, 0.05, 0.2, 0 );
	RobotPtr robot = model.create();
	ReachPtr reach = makeReach( robot.get(), 20, 50 ); // it takes a small part of that
	ASSERT_EQ( reach->grid_count, 1u );
	CheckerPtr checker = makeChecker( reach.get(), { 0, 0 }, { 0, 1 } );
	ASSERT_EQ( checker->base->tree->grids.slice_count, 1u );
	SeededRng rng;
	int near = 0;
	for ( int i = 0; i < 2000; ++i )
	{
		double q[2] = { rng.uniform( -3, 3 ), rng.uniform( -20, 20 ) };
		double x = 0.2 + 0.15 * std::cos( q[0] ) + 0.2 * std::cos( q[0] + q[1] );
		double y = 0.15 * std::sin( q[0] ) + 0.2 * std::sin( q[0] + q[1] ), distance = std::hypot( x, y ) - 0.15;
		double says = sliceAt( checker.get(), 0, q );
		EXPECT_LE( says, std::max( distance, 0.0 ) );
		EXPECT_GE( says, std::min( 0.5 * distance - 0.02, 0.06 ) ) << q[0] << " " << q[1];
		near += says > 0 && says < 0.05;
	}
	EXPECT_GE( near, 50 );
	double far[2] = { 0, 1e9 };
	EXPECT_EQ( sliceAt( checker.get(), 0, far ), 0 ) << "turns that cannot be taken off exactly";
}

TEST( ClearanceGrids, WithoutATimeBudgetThereAreNone )
{
	SeededRng rng;
	RobotPtr robot = randomNeighbours( rng );
	ReachPtr reach = makeReach( robot.get(), 0, 50 );
	EXPECT_EQ( reach->grid_count, 0u );
}
