// SPDX-License-Identifier: BSD-3-Clause
// Both certificates of an edge, with and without tables, put to the auditor.
#pragma once

#include "edge_truth.hpp"
#include "sanitized.hpp"
#include "seeded_rng.hpp"

#include <gtest/gtest.h>

struct AuditTally
{
	int free = 0, blocked = 0, undecided = 0, partial = 0;

	/// A test in which one of these never happened tests nothing; the few edges under sanitizers are about memory.
	void expectVariety() const
	{
		std::printf( "%d free, %d blocked, %d undecided, %d proved in part\n", free, blocked, undecided, partial );
		EXPECT_GT( free, 5 );
		EXPECT_GT( blocked, unlessSanitized( 2, -1 ) );
		EXPECT_GT( partial, unlessSanitized( 0, -1 ) );
	}
};

/// One world with its queries and its auditor.
struct AuditBench
{
	const EdgeWorld& world;
	leeway::Query plain, tables, audit;
	EdgeAuditor auditor;

	explicit AuditBench( const EdgeWorld& w )
	    : world( w ), plain( leeway::makeQuery( w.checker.get() ) ), tables( leeway::makeQuery( w.with_tables.get() ) ),
	      audit( leeway::makeQuery( w.checker.get() ) ),
	      auditor( w.robot.get(), w.scene.get(), w.variables, w.reference.data(), w.allowed, 1e-4,
	          [&w]( bool self, std::uint32_t link, std::uint32_t other ) { return w.margins.of( self, link, other ); } )
	{
	}

	/// The answer without tables of a query that was never asked before.
	lw_edge_result ask( const Motion& motion, const lw_edge_def& def ) const
	{
		lw_edge_result result;
		lw_query_reset( plain.get() );
		EXPECT_EQ( LW_OK,
		    lw_checker_edge( world.checker.get(), plain.get(), motion.from.data(), motion.to.data(), &def, &result ) );
		return result;
	}

	void judge( const Motion& motion, SeededRng& rng, AuditTally& tally )
	{
		lw_edge_def def = lw_edge_def_default();
		def.min_d = rng.integer( 0, 3 ) ? 0 : rng.decade( -4, -2 );
		def.slack = rng.integer( 0, 3 ) ? 1e-3 : rng.decade( -4, -2 );
		def.want_proved_until = rng.integer( 0, 1 ) == 1;
		EdgeTruth truth( world, auditor, motion, def.min_d );
		for ( const bool with_tables : { false, true } )
		{
			lw_edge_result r;
			ASSERT_EQ( lw_checker_edge( with_tables ? world.with_tables.get() : world.checker.get(),
			               with_tables ? tables.get() : plain.get(), motion.from.data(), motion.to.data(), &def, &r ),
			    LW_OK );
			tally.free += r.verdict == LW_VERDICT_FREE;
			tally.blocked += r.verdict == LW_VERDICT_BLOCKED;
			tally.undecided += r.verdict == LW_VERDICT_UNDECIDED;
			tally.partial += r.verdict != LW_VERDICT_FREE && r.proved_until > 0;
			EXPECT_EQ( truth.refute( def, r ), "" ) << describe( motion, def, with_tables );
		}
	}

private:
	std::string describe( const Motion& motion, const lw_edge_def& def, bool with_tables ) const
	{
		char text[64];
		std::string out = world.name + ( with_tables ? ", tables" : "" );
		std::snprintf( text, sizeof text, ", min_d %.17g, slack %.17g", def.min_d, def.slack );
		out += text;
		for ( const std::vector<double>* state : { &motion.from, &motion.to } )
		{
			out += state == &motion.from ? "\nfrom" : "\nto";
			for ( const double v : *state )
			{
				std::snprintf( text, sizeof text, " %.17g", v );
				out += text;
			}
		}
		return out;
	}
};
