// SPDX-License-Identifier: BSD-3-Clause
// The nearest node of a tree, compared with distances in doubles; samples by seed.
#include "planner_rig.hpp"
#include "samples.hpp"
#include "space.hpp"
#include "tree.hpp"

namespace
{

TEST( NativeTree, NearestNodeIsNearest )
{
	SeededRng rng;
	const leeway::Checker checker = worldOf( "Carrier" ).make(); // SE2, SO2 and a slide
	const planners::Space space( checker.get(), {}, {} );
	planners::Tree tree( space );
	const auto draw = [&]
	{
		std::vector<double> q;
		for ( std::size_t i = 0; i < space.size(); ++i )
		{
			q.push_back( rng.uniform( space.lower()[i], space.upper()[i] ) );
		}
		return q;
	};
	std::size_t over_the_seam = 0;
	for ( std::uint32_t count = 1; count <= 300; ++count ) // through full and partial blocks
	{
		tree.add( draw().data(), planners::no_node );
		const std::vector<double> q = draw();
		double least = inf;
		for ( std::uint32_t i = 0; i < count; ++i )
		{
			least = std::min( least, space.distance( tree.state( i ), q.data() ) );
		}
		const std::uint32_t found = tree.nearest( q.data() );
		ASSERT_LT( found, count );
		EXPECT_NEAR( space.distance( tree.state( found ), q.data() ), least, 1e-5 ) << count << " nodes";
		for ( std::size_t i = 0; i < space.size(); ++i )
		{
			over_the_seam += space.wraps( i ) && std::fabs( tree.state( found )[i] - q[i] ) > pi;
		}
	}
	EXPECT_GT( over_the_seam, 10u ) << "no neighbour lies over the seam";
}

TEST( NativeTree, EqualNodesGiveTheFirst )
{
	const leeway::Checker checker = worldOf( "Gantry" ).make();
	const planners::Space space( checker.get(), {}, {} );
	planners::Tree tree( space );
	const double q[] = { 0.25, 0.5 }, other[] = { -1, -1 };
	tree.add( other, planners::no_node );
	for ( int i = 0; i < 40; ++i )
	{
		tree.add( q, 0 );
	}
	EXPECT_EQ( tree.nearest( q ), 1u );
	EXPECT_EQ( tree.parent( 1 ), 0u );
}

TEST( NativeTree, CutTakesAllNodesBehindAndNoOthers )
{
	SeededRng rng;
	const leeway::Checker checker = worldOf( "Gantry" ).make();
	const planners::Space space( checker.get(), {}, {} );
	planners::Tree tree( space );
	// the oracle: each state with the states on its way to the root
	std::vector<std::vector<std::vector<double>>> ways;
	const auto wayOf = [&]( std::uint32_t node )
	{
		std::vector<std::vector<double>> way;
		for ( ; node != planners::no_node; node = tree.parent( node ) )
		{
			way.emplace_back( tree.state( node ), tree.state( node ) + space.size() );
		}
		return way;
	};
	for ( int round = 0; round < 60; ++round )
	{
		for ( int i = 0; i < 12; ++i )
		{
			const double q[] = { rng.uniform( -1, 1 ), rng.uniform( -1, 1 ) };
			const auto parent = static_cast<std::uint32_t>( rng.uniform( 0, 1 ) * static_cast<double>( tree.size() ) );
			const std::uint32_t node = tree.add( q, tree.size() < 3 ? planners::no_node : parent );
			ASSERT_EQ( tree.isProved( node ), tree.parent( node ) == planners::no_node );
			if ( i % 2 == 0 && ( tree.parent( node ) == planners::no_node || tree.isProved( tree.parent( node ) ) ) )
			{
				tree.setProved( node );
			}
			ways.push_back( wayOf( node ) );
		}
		const auto victim = 3 + static_cast<std::uint32_t>( rng.uniform( 0, 1 ) * static_cast<double>( tree.size() - 3 ) );
		const std::vector<double> gone = wayOf( victim ).front();
		std::vector<bool> proved;
		for ( std::uint32_t i = 0; i < tree.size(); ++i )
		{
			if ( std::find( ways[i].begin(), ways[i].end(), gone ) == ways[i].end() )
			{
				proved.push_back( tree.isProved( i ) );
			}
		}
		tree.cut( victim );
		ways.erase( std::remove_if( ways.begin(), ways.end(),
		                [&]( const auto& way ) { return std::find( way.begin(), way.end(), gone ) != way.end(); } ),
		    ways.end() );
		ASSERT_EQ( tree.size(), ways.size() );
		for ( std::uint32_t i = 0; i < tree.size(); ++i )
		{
			ASSERT_EQ( wayOf( i ), ways[i] );
			ASSERT_EQ( tree.isProved( i ), proved[i] );
			EXPECT_EQ( tree.nearest( tree.state( i ) ), i ) << "the blocks of the scan hold other nodes";
		}
		double least = inf;
		for ( std::uint32_t i = 0; i < tree.size(); ++i )
		{
			least = std::min( least, space.distance( tree.state( i ), gone.data() ) );
		}
		EXPECT_NEAR( space.distance( tree.state( tree.nearest( gone.data() ) ), gone.data() ), least, 1e-5 )
		    << "the blocks of the scan hold nodes that are gone";
	}
}

TEST( NativeSamples, HaltonPointsFillTheSquare )
{
	// 100 points in 10 x 10 cells of the first two bases: random ones leave 37 cells empty
	planners::Halton halton( 2, 5 );
	std::vector<int> cells( 100 );
	for ( int i = 0; i < 100; ++i )
	{
		double p[2];
		halton.next( p );
		ASSERT_GE( std::min( p[0], p[1] ), 0 );
		ASSERT_LT( std::max( p[0], p[1] ), 1 );
		++cells[static_cast<std::size_t>( p[0] * 10 ) * 10 + static_cast<std::size_t>( p[1] * 10 )];
	}
	EXPECT_LT( std::count( cells.begin(), cells.end(), 0 ), 30 );
}

TEST( NativeSamples, SeedsGiveDifferentNumbers )
{
	planners::Random a( 1 ), b( 1 ), c( 2 );
	const std::uint64_t first = a.next();
	EXPECT_EQ( first, b.next() );
	EXPECT_NE( first, c.next() );
	double sum = 0;
	for ( int i = 0; i < 10000; ++i )
	{
		const double u = a.uniform();
		ASSERT_GE( u, 0 );
		ASSERT_LT( u, 1 );
		sum += u;
	}
	EXPECT_NEAR( sum / 10000, 0.5, 0.02 );
}

} // namespace
