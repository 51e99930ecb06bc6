// SPDX-License-Identifier: BSD-3-Clause
// Time left of several pieces of work.
#include "report/console_progress.hpp"

#include <gtest/gtest.h>

TEST( TimeLeft, PieceThatTakesLongerLeavesTheRestAsExpected )
{
	TimeLeft time( { 10, 20 } );
	time.begin( 0, 100 );
	EXPECT_DOUBLE_EQ( time.left( 0, 100 ), 30 );
	// half of the first took 10 s where 5 were expected: twice as long for all
	EXPECT_DOUBLE_EQ( time.left( 0.5, 110 ), 10 + 40 );
	time.begin( 1, 120 );
	EXPECT_DOUBLE_EQ( time.left( 0, 120 ), 40 );
	EXPECT_DOUBLE_EQ( time.left( 1, 160 ), 0 );
}

TEST( TimeLeft, FirstInstantIsExtrapolated )
{
	TimeLeft time( { 10 } );
	time.begin( 0, 0 );
	EXPECT_DOUBLE_EQ( time.left( 0.001, 5 ), 9.99 ); // loading took 5 s; that says nothing of the rest
	EXPECT_DOUBLE_EQ( time.done( 0, 0 ), 0 );
}

TEST( TimeLeft, ShareDoneIsNotThatOfTheTime )
{
	TimeLeft time( { 10, 30 } );
	time.begin( 0, 0 );
	EXPECT_DOUBLE_EQ( time.done( 1, 10 ), 0.25 );
	time.begin( 1, 10 );
	EXPECT_DOUBLE_EQ( time.done( 0.5, 25 ), 0.625 );
	EXPECT_DOUBLE_EQ( time.done( 1, 40 ), 1 );
}

TEST( TimeLeft, MinutesAreSaidAsSeconds )
{
	EXPECT_EQ( sayDuration( 59.4 ), "59 s" );
	EXPECT_EQ( sayDuration( 59.6 ), "1 min 0 s" );
	EXPECT_EQ( sayDuration( 200 ), "3 min 20 s" );
}

TEST( TimeLeft, PartReportsItsOwnShareAsThatOfTheWhole )
{
	struct Last : Progress
	{
		double share = -1;
		void at( double s, const std::string& ) override { share = s; }
	} last;
	PartProgress part( last, 0.5, 0.7 );
	part.at( 0.5, "" );
	EXPECT_DOUBLE_EQ( last.share, 0.6 );
}
