// SPDX-License-Identifier: BSD-3-Clause
// The experiment `trade` on little work: every promise is kept, and an error put into any knob's answers is noticed.
#include "experiments/trade.hpp"

#include <gtest/gtest.h>

namespace
{

class NoProgress : public Progress
{
public:
	void at( double share, const std::string& ) override
	{
		EXPECT_GE( share, m_share - 1e-12 );
		EXPECT_LE( share, 1 + 1e-12 );
		m_share = share;
	}

private:
	double m_share = 0;
};

Outcome runTrade( const std::string& inject )
{
	ExperimentSettings settings;
	settings.data.clear(); // random worlds
	settings.smoke = settings.quick = true;
	NoProgress progress;
	return makeTradeExperiment( { inject } )->run( settings, progress );
}

std::vector<std::string> brokenClaims( const Outcome& outcome )
{
	std::vector<std::string> broken;
	for ( const Claim& claim : outcome.claims )
	{
		if ( claim.verdict == Verdict::BROKEN )
		{
			broken.push_back( claim.text );
		}
	}
	return broken;
}

} // namespace

TEST( Promise, ObservationBeyondItIsTakenForKept )
{
	Promise promise( 1e-9 );
	promise.observe( 0.1, 0.2, "first" );
	promise.observe( 0.2 + 1e-10, 0.2, "second" );
	EXPECT_EQ( promise.broken(), 0u );
	EXPECT_EQ( claimOf( "", { &promise }, "" ).verdict, Verdict::HOLDS );
	promise.observe( 0.21, 0.2, "third" );
	promise.observe( 0.3, 0.2, "fourth" );
	EXPECT_EQ( promise.broken(), 2u );
	EXPECT_EQ( promise.worst(), 0.3 );
	const Claim claim = claimOf( "", { &promise }, "" );
	EXPECT_EQ( claim.verdict, Verdict::BROKEN );
	EXPECT_NE( claim.why.find( "third" ), std::string::npos ) << claim.why;
}

TEST( Promise, NanOrSilenceIsTakenForKept )
{
	Promise promise( 1e-9 );
	EXPECT_EQ( claimOf( "", { &promise }, "" ).verdict, Verdict::BROKEN ) << "nobody has looked";
	promise.observe( std::nan( "" ), 0.2, "" );
	EXPECT_EQ( promise.broken(), 1u );
	EXPECT_EQ( promise.worst(), INFINITY );
}

TEST( Trade, PromiseIsNotKept )
{
	const Outcome outcome = runTrade( "" );
	for ( const Claim& claim : outcome.claims )
	{
		EXPECT_NE( claim.verdict, Verdict::BROKEN ) << claim.text << ": " << claim.figure << ": " << claim.why;
	}
	EXPECT_GE( outcome.claims.size(), 8u );
	EXPECT_EQ( outcome.tables.size(), 3u );
	EXPECT_EQ( outcome.plots.size(), 5u );
	EXPECT_NO_THROW( toJson( outcome ) );
}

TEST( Trade, ErrorOfAKnobIsNotNoticed )
{
	for ( const char* knob : { "alpha", "min_d", "max_d", "range", "float", "slack", "certified", "steps" } )
	{
		const Outcome outcome = runTrade( knob );
		EXPECT_FALSE( promisesKept( outcome ) ) << knob;
		EXPECT_EQ( brokenClaims( outcome ).size(), 1u ) << knob << ": only its own promise is broken";
	}
}
