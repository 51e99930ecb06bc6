// SPDX-License-Identifier: BSD-3-Clause
// leeway tune.
#include "cli_fixture.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <set>

using nlohmann::json;

namespace
{

/// Few samples, and a rate, so that nothing depends on time.
class CliTune : public Cli
{
protected:
	Outcome tune( std::vector<std::string> more, const std::string& edges = "20" ) const
	{
		const std::vector<std::string> common = { "--group", "arm", "--states", "60", "--edges", edges, "--max-d", "0.3" };
		more.insert( more.begin(), common.begin(), common.end() );
		return runModel( "tune", more, "blocked.yaml" );
	}

	json report( std::vector<std::string> more, int status = 0, const std::string& edges = "20" ) const
	{
		more.insert( more.end(), { "--rate", "1", "--json", "r.json" } );
		const Outcome outcome = tune( more, edges );
		EXPECT_EQ( outcome.status, status ) << outcome.out << outcome.err;
		return json::parse( readFile( path( "r.json" ) ) );
	}
};

/// Output of a run without the times that it measured.
std::string withoutTimes( json report )
{
	for ( json& row : report["settings"] )
	{
		row.erase( "measured_us" );
	}
	for ( const char* kind : { "state", "motion" } )
	{
		report["proposal"][kind].erase( "measured_us" );
	}
	return report.dump();
}

} // namespace

TEST_F( CliTune, TheSameSeedGivesTheSameFrontAndProposal )
{
	const std::string first = withoutTimes( report( { "--error", "5", "--seed", "3" } ) );
	EXPECT_EQ( withoutTimes( report( { "--error", "5", "--seed", "3" } ) ), first );
	EXPECT_NE( withoutTimes( report( { "--error", "5", "--seed", "4" } ) ), first );
}

// A measured rate scales times; which setting is proposed for an error must not follow it.
TEST_F( CliTune, ProposalsForErrorAndConservatismDoNotDependOnTheMachine )
{
	for ( const char* target : { "--error", "--edge-conservatism" } )
	{
		std::set<std::string> proposals;
		for ( const char* rate : { "0.1", "1", "50" } )
		{
			const Outcome outcome = tune( { target, "5", "--rate", rate, "--json", "r.json" } );
			ASSERT_EQ( outcome.status, 0 ) << outcome.err;
			json proposal = json::parse( readFile( path( "r.json" ) ) )["proposal"];
			for ( const char* kind : { "state", "motion" } )
			{
				proposal[kind].erase( "measured_us" );
				proposal[kind].erase( "time_us" );
			}
			proposals.insert( proposal.dump() );
		}
		EXPECT_EQ( proposals.size(), 1u ) << target << " " << *proposals.begin();
	}
}

TEST_F( CliTune, NothingSeenIsBeyondItsPromiseAndProposalsMeetTheTarget )
{
	const json r = report( { "--error", "5" } );
	EXPECT_TRUE( r["target"]["met"] );
	EXPECT_GT( r["free_motions"], 0 );
	EXPECT_LT( r["free_motions"], r["motions"] ) << "the post is in nobody's way: the test sees no motion turned down";
	bool saw_error = false, saw_conservatism = false;
	for ( const json& row : r["settings"] )
	{
		EXPECT_LE( row["worst"].get<double>(), row["promised"].get<double>() + 1e-9 ) << row;
		EXPECT_TRUE( !row["proof"] || row["missed"] == 0 ) << row;
		saw_error = saw_error || ( row["kind"] == "state" && row["worst"] > 1e-4 );
		saw_conservatism = saw_conservatism || ( row["kind"] == "motion" && row["worst"] > 1e-4 );
	}
	EXPECT_TRUE( saw_error && saw_conservatism ) << "no setting gives anything up: the test sees nothing";
	const json& state = r["proposal"]["state"];
	EXPECT_LE( state["promised"].get<double>(), 0.005 + 1e-12 );
	EXPECT_TRUE( r["proposal"]["motion"]["proof"] );
	EXPECT_EQ( state["min_d"], r["proposal"]["motion"]["min_d"] ) << "one margin for both";
	// Nothing else that keeps the target and the planner's room is clearly cheaper
	for ( const json& row : r["settings"] )
	{
		if ( row["kind"] == "state" && row["promised"] <= 0.005 && row["free"] >= r["free_states"] )
		{
			EXPECT_GE( row["work"].get<double>() * 1.051, state["work"].get<double>() ) << row;
		}
	}
}

TEST_F( CliTune, TheFrontHasNoSettingThatAnotherOneBeats )
{
	const json r = report( {} );
	for ( const json& a : r["settings"] )
	{
		bool beaten = false;
		for ( const json& b : r["settings"] )
		{
			beaten = beaten || ( a["kind"] == b["kind"] && b["work"] < a["work"] && b["promised"] <= a["promised"] &&
			                       b["free"] >= a["free"] && ( b["proof"] || !a["proof"] ) );
		}
		EXPECT_FALSE( a["front"] && beaten ) << a;
	}
}

TEST_F( CliTune, ATimeThatNothingKeepsIsANegativeAnswerThatNamesTheBest )
{
	const json r = report( { "--time-per-state", "0.000001" }, 1 );
	EXPECT_FALSE( r["target"]["met"] );
	const Outcome outcome = tune( { "--time-per-state", "0.000001" } );
	EXPECT_EQ( outcome.status, 1 );
	EXPECT_TRUE( contains( outcome.out, "CANNOT BE MET: the fastest setting takes" ) ) << outcome.out;
	// The proposal is then the fastest that can be proposed
	for ( const json& row : r["settings"] )
	{
		if ( row["kind"] == "state" && row["free"] >= r["free_states"] )
		{
			EXPECT_GE( row["work"].get<double>() * 1.051, r["proposal"]["state"]["work"].get<double>() );
		}
	}
}

TEST_F( CliTune, MoreTimeIsSpentOnAccuracy )
{
	const double all = report( { "--time-per-state", "1e9" } )["proposal"]["state"]["promised"];
	EXPECT_EQ( all, 0 );
}

TEST_F( CliTune, StepsWithTheSameMarginAreNoProofAndAreSaidToMiss )
{
	// A fin that only the corners of the arm's tip touch, each for half a millimetre of its way: tip at x = 0.8, corners at
	// 0.80039.
	edit( "blocked.yaml", "[0.6, 0, 0]", "[1.10035, 0, 0]" );
	edit( "blocked.yaml", "[0.1, 0.1, 1]", "[0.6, 0.0002, 1]" );
	const Outcome outcome = runModel(
	    "tune", { "--group", "shoulder_only", "--states", "10", "--edges", "200", "--json", "r.json" }, "blocked.yaml" );
	ASSERT_EQ( outcome.status, 0 ) << outcome.err;
	const json r = json::parse( readFile( path( "r.json" ) ) );
	std::size_t missed = 0;
	for ( const json& row : r["settings"] )
	{
		missed += row["missed"].get<std::size_t>();
		EXPECT_TRUE( row["missed"] == 0 || ( row["validator"] == "steps" && !row["proof"] ) ) << row;
	}
	EXPECT_GT( missed, 0u );
	EXPECT_TRUE( r["proposal"]["motion"]["proof"] );
}

TEST_F( CliTune, WritesTheTableThatItSays )
{
	ASSERT_EQ( tune( { "--csv", "t.csv", "--rate", "2" } ).status, 0 );
	const Table table = parseTable( readFile( path( "t.csv" ) ) );
	ASSERT_GT( table.rows.size(), 20u );
	EXPECT_EQ( table.header.front(), "kind" );
	std::size_t proposed = 0;
	for ( std::size_t i = 0; i < table.rows.size(); ++i )
	{
		EXPECT_DOUBLE_EQ( table.number( i, "time_us" ), 2 * table.number( i, "work" ) );
		proposed += table.rows[i].at( "proposed" ) == "1";
	}
	EXPECT_EQ( proposed, 2u );
}

TEST_F( CliTune, WorksForOneQuestionAlone )
{
	EXPECT_EQ( tune( { "--what", "env" } ).status, 0 );
	EXPECT_EQ( tune( { "--what", "self" } ).status, 0 );
	EXPECT_EQ( tune( { "--min-d", "0.01", "--margin", "0.01" } ).status, 0 );
}

TEST_F( CliTune, BadInputIsNamed )
{
	struct Case
	{
		std::vector<std::string> arguments;
		std::string word;
	};
	const std::vector<Case> cases = {
	    { { "--error", "-1" }, "--error" },
	    { { "--error", "nan" }, "--error" },
	    { { "--error", "300" }, "--error: 300 mm is not less than the 300 mm from --min-d to --max-d" },
	    { { "--time-per-state", "0" }, "--time-per-state" },
	    { { "--edge-conservatism", "0" }, "--edge-conservatism" },
	    { { "--error", "1", "--time-per-state", "5" }, "--error" },
	    { { "--error", "1", "--edge-conservatism", "5" }, "--edge-conservatism" },
	    { { "--rate", "0" }, "--rate" },
	    { { "--states", "0" }, "--states" },
	    { { "--edges", "0" }, "--edges" },
	    { { "--max-d", "inf" }, "--max-d" },
	    { { "--min-d", "0.4" }, "--max-d: 0.3 is not above --min-d 0.4" },
	    { { "--group", "legs" }, "legs" },
	    { { "--csv", "nowhere/t.csv" }, "nowhere/t.csv" },
	};
	for ( const Case& c : cases )
	{
		std::vector<std::string> arguments = { "--group", "arm", "--states", "10", "--edges", "5", "--max-d", "0.3" };
		for ( std::size_t i = 0; i < c.arguments.size(); i += 2 )
		{
			const auto old = std::find( arguments.begin(), arguments.end(), c.arguments[i] );
			if ( old == arguments.end() )
			{
				arguments.insert( arguments.end(), { c.arguments[i], c.arguments[i + 1] } );
				continue;
			}
			*( old + 1 ) = c.arguments[i + 1];
		}
		const Outcome outcome = runModel( "tune", arguments, "blocked.yaml" );
		EXPECT_EQ( outcome.status, 2 ) << c.arguments[0] << " " << c.arguments[1];
		EXPECT_TRUE( contains( outcome.err, c.word ) ) << c.word << "\n" << outcome.err;
	}
}

TEST_F( CliTune, NoFreeStateIsAnErrorWithARemedy )
{
	// The robot's base stands in the obstacle: no state of the arm is free
	edit( "blocked.yaml", "[0.6, 0, 0]", "[0, 0, -0.2]" );
	const Outcome outcome = tune( {} );
	EXPECT_EQ( outcome.status, 2 );
	EXPECT_TRUE( contains( outcome.err, "random states" ) && contains( outcome.err, "--request" ) ) << outcome.err;
}
