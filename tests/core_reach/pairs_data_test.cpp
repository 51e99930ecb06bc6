// SPDX-License-Identifier: BSD-3-Clause
// Pairs of the shared robots: no pair proved apart gives way to an attack, neighbours are those that the SRDFs name, and
// allowed pairs that touch show it.
#include "leeway/io/model.hpp"
#include "reach_attack.hpp"

#include <string>

namespace
{

struct Subject
{
	leeway::Robot robot;
	leeway::io::RobotModel model;
	ReachPtr reach;

	Subject( const std::string& folder, const std::string& name, double seconds, std::uint32_t samples )
	{
		std::string base = std::string( LEEWAY_DATA_DIR ) + "/" + folder + "/" + name;
		model = leeway::io::loadRobot( base + ".urdf", base + ".srdf" );
		robot = leeway::io::buildRobot( model );
		reach = makeReach( robot.get(), seconds, samples );
	}
	std::uint32_t link( const std::string& name ) const { return lw_robot_find_link( robot.get(), name.c_str() ); }
	std::uint32_t links() const { return lw_robot_link_count( robot.get() ); }
};

struct Count
{
	int hull = 0, subdivision = 0, open = 0, contact = 0, adjacent = 0;
};

/// Attacks every separation and checks all evidence of contact.
Count attackAll( const Subject& subject, int states, int steps )
{
	Count count;
	PairAttacker attacker( subject.reach.get(), 7 );
	for ( std::uint32_t a = 0; a < subject.links(); ++a )
	{
		for ( std::uint32_t b = 0; b < a; ++b )
		{
			lw_reach_pair pair = lw_reach_get_pair( subject.reach.get(), a, b );
			count.adjacent += pair.adjacent;
			if ( pair.kind == LW_PAIR_NONE || pair.kind == LW_PAIR_RIGID )
			{
				continue;
			}
			attacker.checkEvidence( a, b );
			count.hull += pair.proof == LW_PROOF_HULL;
			count.subdivision += pair.proof == LW_PROOF_SUBDIVISION;
			count.contact += pair.closest <= 0;
			count.open += pair.closest > 0 && pair.proof == LW_PROOF_NONE;
			if ( pair.separation > 0 )
			{
				EXPECT_GE( attacker.attack( a, b, states, steps ), pair.separation - 1e-9 )
				    << lw_robot_link_name( subject.robot.get(), a ) << " " << lw_robot_link_name( subject.robot.get(), b );
			}
		}
	}
	std::printf( "%d proved by hulls, %d by subdivision, %d in contact, %d open, %d adjacent\n", count.hull,
	    count.subdivision, count.contact, count.open, count.adjacent );
	return count;
}

/// The pairs that the SRDF calls adjacent, as far as both links have geometry.
std::set<std::pair<std::uint32_t, std::uint32_t>> namedAdjacent( const Subject& subject )
{
	std::set<std::pair<std::uint32_t, std::uint32_t>> named;
	for ( const leeway::io::DisabledPair& pair : subject.model.disabled )
	{
		if ( pair.reason == "Adjacent" )
		{
			std::uint32_t a = subject.link( pair.link1 ), b = subject.link( pair.link2 );
			named.insert( { std::min( a, b ), std::max( a, b ) } );
		}
	}
	return named;
}

std::set<std::pair<std::uint32_t, std::uint32_t>> foundAdjacent( const Subject& subject )
{
	std::set<std::pair<std::uint32_t, std::uint32_t>> found;
	for ( std::uint32_t a = 0; a < subject.links(); ++a )
	{
		for ( std::uint32_t b = a + 1; b < subject.links(); ++b )
		{
			if ( lw_reach_get_pair( subject.reach.get(), a, b ).adjacent )
			{
				found.insert( { a, b } );
			}
		}
	}
	return found;
}

} // namespace

TEST( ReachPairsData, Armar3 )
{
	Subject subject( "armar3", "armar3", 40, 60 ); // random states and the search for contact are part of the time
	EXPECT_EQ( foundAdjacent( subject ).size(), 53u );
	EXPECT_EQ( foundAdjacent( subject ), namedAdjacent( subject ) );
	Count count = attackAll( subject, 30, 60 );
	EXPECT_GE( count.hull + count.subdivision, 300 );
	EXPECT_GE( count.contact, 700 );
}

TEST( ReachPairsData, Panda )
{
	Subject subject( "mbm/panda", "panda", 30, 200 );
	EXPECT_EQ( foundAdjacent( subject ), namedAdjacent( subject ) );
	Count count = attackAll( subject, 200, 300 );
	EXPECT_GE( count.hull + count.subdivision, 20 );
}

TEST( ReachPairsData, Fetch )
{
	// Its SRDF joins all neighbours of links without geometry to each other as well
	Subject subject( "mbm/fetch", "fetch", 30, 200 );
	std::set<std::pair<std::uint32_t, std::uint32_t>> named = namedAdjacent( subject ), found = foundAdjacent( subject );
	EXPECT_TRUE( std::includes( named.begin(), named.end(), found.begin(), found.end() ) );
	EXPECT_EQ( found.size(), 14u );
	Count count = attackAll( subject, 200, 300 );
	EXPECT_GE( count.hull + count.subdivision, 20 );
}
