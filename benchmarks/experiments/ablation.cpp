// SPDX-License-Identifier: BSD-3-Clause
// The experiment `ablation`: the gain by each part of a query, measured by leaving the part out: alone, and all together.
// Transform caching, range-of-motion hulls and pair tables are those of Steinbach, Kuffner, Asfour, Dillmann 2006 (II.C,
// III, IV).
#include "experiments/experiments.hpp"
#include "experiments/paper.hpp"
#include "support/provenance.hpp"
#include "report/rounds.hpp"

#include <cmath>

namespace
{

namespace io = leeway::io;

constexpr double INFINITE = std::numeric_limits<double>::infinity();

/// A setting of the query: nothing, one part or several parts left out.
struct Variant
{
	const char* name;
	void ( *leave_out )( lw_query_def& );
};

const Variant VARIANTS[] = {
    { "nothing", []( lw_query_def& ) {} },
    { "transform caching", []( lw_query_def& def ) { def.transform_caching = false; } },
    { "motion hulls", []( lw_query_def& def ) { def.motion_hulls = false; } },
    { "pair tables", []( lw_query_def& def ) { def.pair_tables = false; } },
    { "hulls and tables", []( lw_query_def& def ) { def.motion_hulls = def.pair_tables = false; } },
    { "warm start", []( lw_query_def& def ) { def.warm_start = false; } },
    { "planes", []( lw_query_def& def ) { def.planes = false; } },
    { "all of these", []( lw_query_def& def )
        { def.transform_caching = def.motion_hulls = def.pair_tables = def.warm_start = def.planes = false; } },
};
enum
{
	NOTHING = 0,
	CACHING = 1,
	HULLS = 2,
	TABLES = 3,
	HULLS_AND_TABLES = 4,
	WARM_START = 5,
	ALL_OF_THESE = 7
};

struct Question
{
	const char* name;
	lw_check_flags flags;
	lw_range range;
	bool boolean; ///< stops at the first violation
	bool edge;
};

const Question QUESTIONS[] = {
    { "environment, exact", LW_CHECK_ENVIRONMENT, { 0, INFINITE, 0 }, false, false },
    { "environment, > 10 mm?", LW_CHECK_ENVIRONMENT, { 0.01, 0.010000000000000002, 0 }, true, false },
    { "self, exact", LW_CHECK_SELF, { 0, INFINITE, 0 }, false, false },
    { "self, in contact?", LW_CHECK_SELF, { 0, 5e-324, 0 }, true, false },
    { "edge, certified", LW_CHECK_BOTH, { 0, INFINITE, 0 }, false, true },
};

double uniform( std::mt19937_64& random )
{
	return static_cast<double>( random() >> 11 ) * 0x1p-53;
}

/// Uniform within the limits and free, by the checker's word.
std::vector<double> freeState( const io::Problem& problem, lw_query* query, std::mt19937_64& random )
{
	const lw_range contact = { 0, 5e-324, 0 };
	for ( ;; )
	{
		std::vector<double> state;
		for ( const std::uint32_t variable : problem.variables )
		{
			const lw_variable_info info = lw_robot_variable( problem.robot.get(), variable );
			state.push_back( info.lower + uniform( random ) * ( info.upper - info.lower ) );
		}
		lw_state_result result;
		leeway::require(
		    lw_checker_state( problem.checker.get(), query, state.data(), LW_CHECK_BOTH, &contact, true, &result ),
		    "a state" );
		if ( result.verdict == LW_VERDICT_FREE )
		{
			return state;
		}
	}
}

/// From a state some way in a random direction, within the limits.
std::vector<double> beside(
    const io::Problem& problem, const std::vector<double>& from, double way, std::mt19937_64& random )
{
	std::vector<double> direction, to;
	double square = 0;
	for ( std::size_t i = 0; i < from.size(); ++i )
	{
		direction.push_back( 2 * uniform( random ) - 1 );
		square += direction.back() * direction.back();
	}
	for ( std::size_t i = 0; i < from.size(); ++i )
	{
		const lw_variable_info info = lw_robot_variable( problem.robot.get(), problem.variables[i] );
		to.push_back( std::min( info.upper, std::max( info.lower, from[i] + way / std::sqrt( square ) * direction[i] ) ) );
	}
	return to;
}

/// The states of a workload, or its edges from each state to the one in `to`.
struct Work
{
	std::string name;
	std::vector<std::vector<double>> states, to;
};

/// Independent states; states along motions, 0.02 rad apart; edges of 0.5 rad.
std::vector<Work> makeWork( const io::Problem& problem, const ExperimentSettings& settings )
{
	constexpr std::size_t STEPS = 20;
	std::mt19937_64 random( settings.seed );
	const leeway::Query query = leeway::makeQuery( problem.checker.get() );
	Work independent{ "independent states", {}, {} }, motion{ "along motions", {}, {} }, edges{ "edges of 0.5 rad", {}, {} };
	const std::size_t count = settings.pick( 200, 80, STEPS );
	for ( std::size_t i = 0; i < count; ++i )
	{
		independent.states.push_back( freeState( problem, query.get(), random ) );
	}
	while ( motion.states.size() < count )
	{
		const std::vector<double> from = freeState( problem, query.get(), random );
		const std::vector<double> to = beside( problem, from, 0.02 * STEPS, random );
		for ( std::size_t k = 0; k < STEPS; ++k )
		{
			std::vector<double> state;
			for ( std::size_t j = 0; j < from.size(); ++j )
			{
				state.push_back( from[j] + ( to[j] - from[j] ) * static_cast<double>( k ) / STEPS );
			}
			motion.states.push_back( state );
		}
	}
	for ( std::size_t i = 0; i < count / 2; ++i )
	{
		edges.states.push_back( freeState( problem, query.get(), random ) );
		edges.to.push_back( beside( problem, edges.states.back(), 0.5, random ) );
	}
	return { independent, motion, edges };
}

/// The result of one question about one piece of work.
struct Cellblock
{
	std::string group, work;
	const Question* question;
	std::vector<Rounds> rounds;        ///< by variant
	std::vector<lw_query_stats> stats; ///< sums
	double asked = 0;                  ///< questions behind the sums
};

Answer ask( const io::Problem& problem, lw_query* query, const Question& question, const Work& work, std::size_t number )
{
	if ( question.edge )
	{
		lw_edge_def def = lw_edge_def_default();
		def.flags = question.flags;
		lw_edge_result result;
		leeway::require( lw_checker_edge( problem.checker.get(), query, work.states[number].data(), work.to[number].data(),
		                     &def, &result ),
		    "an edge" );
		const double verdict = result.verdict;
		return { verdict, verdict };
	}
	lw_state_result result;
	leeway::require( lw_checker_state( problem.checker.get(), query, work.states[number].data(), question.flags,
	                     &question.range, question.boolean, &result ),
	    "a state" );
	const double verdict = result.verdict;
	const lw_clearance& c = question.flags == LW_CHECK_SELF ? result.self : result.environment;
	return question.boolean ? Answer{ verdict, verdict } : Answer{ c.lower, c.upper };
}

Cellblock measureBlock(
    const io::Problem& problem, const Question& question, const Work& work, int passes, Progress& progress )
{
	Cellblock block{ problem.group, work.name, &question, {}, {}, 0 };
	std::vector<leeway::Query> queries;
	std::vector<Contender> contenders;
	for ( const Variant& variant : VARIANTS )
	{
		lw_query_def def = lw_query_def_default();
		variant.leave_out( def );
		queries.push_back( leeway::makeQuery( problem.checker.get(), def ) );
		lw_query* query = queries.back().get();
		contenders.push_back( { variant.name, [&problem, &question, &work, query]( const double* q )
		    { return ask( problem, query, question, work, questionNumber( q ) ); } } );
	}
	block.rounds = raceRounds(
	    contenders, work.states.size(), passes, progress, problem.group + ", " + work.name + ", " + question.name );
	for ( const leeway::Query& query : queries )
	{
		block.stats.push_back( lw_query_get_stats( query.get() ) );
	}
	block.asked = static_cast<double>( work.states.size() ) * ( passes + 1 );
	return block;
}

/// Number of answers that contradict those with everything on. Of edges: a proof against a counterexample; an edge near
/// contact that one variant refuses and another proves is no contradiction.
std::size_t contradictions( const Cellblock& block )
{
	std::size_t count = 0;
	for ( const Rounds& rounds : block.rounds )
	{
		for ( std::size_t i = 0; i < rounds.answers.size(); ++i )
		{
			const double mine = rounds.answers[i].upper, with = block.rounds[NOTHING].answers[i].upper;
			const bool proof = block.question->edge && ( mine == LW_VERDICT_UNDECIDED || with == LW_VERDICT_UNDECIDED );
			count += !( mine == with ) && !proof;
		}
	}
	return count;
}

// --- results ---------------------------------------------------------------------------------------------------------

void addTable( Outcome& out, const std::vector<Cellblock>& blocks )
{
	Table table{ "ablation", "Each part left out, alone and together",
	    "Mean time per question; medians and quartiles over the passes. Change: of the time, against everything on in the "
	    "same "
	    "pass. The last columns count work per question: eight spheres at a step, two leaves, sphere centres moved into the "
	    "other tree's frame, tests of nodes of the robot and of tables.",
	    { { "group", "" }, { "asked about", "" }, { "question", "" }, { "left out", "" }, { "time", "us", -1 },
	        { "change", "%" }, { "sphere tests", "" }, { "leaf tests", "" }, { "centres moved", "" },
	        { "robot tests", "" } },
	    {} };
	for ( const Cellblock& block : blocks )
	{
		for ( std::size_t v = 0; v < std::size( VARIANTS ); ++v )
		{
			const lw_query_stats& s = block.stats[v];
			const auto each = [&]( std::uint64_t sum ) { return static_cast<double>( sum ) / block.asked; };
			table.rows.push_back( { block.group, block.work, block.question->name, VARIANTS[v].name,
			    timeOf( block.rounds[v] ), ratioOf( block.rounds[v], block.rounds[NOTHING], 1, 100 ), each( s.node_tests ),
			    each( s.leaf_tests ), each( s.center_transforms ), each( s.robot_tests ) } );
		}
	}
	out.tables.push_back( table );
}

void addPlots( Outcome& out, const std::vector<Cellblock>& blocks )
{
	for ( const Cellblock& first : blocks )
	{
		const std::string id = first.group + ( first.work == "independent states" ? "-states" : "-motion" );
		const bool known =
		    std::any_of( out.plots.begin(), out.plots.end(), [&]( const Plot& plot ) { return plot.id == id; } );
		if ( known || first.question->edge )
		{
			continue;
		}
		Plot plot{ id, "What each part is worth: " + first.group + ", " + first.work,
		    "Time of a query without it over the time with everything on: medians over the passes, with quartiles, on a "
		    "logarithmic "
		    "scale. Edges of 0.5 rad are the same in both pictures.",
		    { "left out", "" }, { "time, everything on = 1", "", true }, {}, {}, {} };
		plot.y.from = 0.8;
		for ( std::size_t v = 1; v < std::size( VARIANTS ); ++v )
		{
			plot.categories.push_back( VARIANTS[v].name );
		}
		for ( const Cellblock& block : blocks )
		{
			if ( block.group != first.group || !( block.work == first.work || block.question->edge ) )
			{
				continue;
			}
			Series dots{ block.question->name, {}, Mark::POINTS, false };
			for ( std::size_t v = 1; v < std::size( VARIANTS ); ++v )
			{
				const Measure ratio = ratioOf( block.rounds[v], block.rounds[NOTHING] );
				dots.points.push_back( { static_cast<double>( v - 1 ), ratio.median, ratio.lower, ratio.upper } );
			}
			plot.series.push_back( dots );
		}
		plot.series.push_back(
		    { "", { { -0.6, 1 }, { static_cast<double>( std::size( VARIANTS ) ) - 1.4, 1 } }, Mark::DASHES, false } );
		out.plots.push_back( plot );
	}
}

/// Change of the time in percent, over blocks that count: least, mean, most.
struct Spread
{
	double least = INFINITE, mean = 0, most = -INFINITE;
	std::string where; ///< of the most
};

/// @param against the variant whose time is the reference
Spread spreadOf( const std::vector<Cellblock>& blocks, std::size_t variant,
    const std::function<bool( const Cellblock& )>& counts, std::size_t against = NOTHING )
{
	Spread spread;
	double n = 0;
	for ( const Cellblock& block : blocks )
	{
		if ( !counts( block ) )
		{
			continue;
		}
		const double change = ratioOf( block.rounds[variant], block.rounds[against], 1, 100 ).median;
		spread.mean += change;
		n += 1;
		spread.least = std::min( spread.least, change );
		if ( change > spread.most )
		{
			spread.most = change;
			spread.where = block.group + ", " + block.work + ", " + block.question->name;
		}
	}
	spread.mean = n > 0 ? spread.mean / n : 0;
	return spread;
}

std::string sayOf( const Spread& spread )
{
	return say( "%+.0f %% on average", spread.mean ) + say( " (%+.0f", spread.least ) + say( " to %+.0f %%)", spread.most );
}

Verdict verdictOf( const Spread& spread, double wanted )
{
	return spread.mean >= wanted ? Verdict::HOLDS : spread.most >= wanted ? Verdict::PARTLY : Verdict::DIFFERS;
}

void addClaims( Outcome& out, const std::vector<Cellblock>& blocks )
{
	const auto all = []( const Cellblock& ) { return true; };
	const Spread caching = spreadOf( blocks, CACHING, all );
	double moved_with = 0, moved_without = 0, tests = 0, time = 0, count = 0;
	for ( const Cellblock& block : blocks )
	{
		moved_with += static_cast<double>( block.stats[NOTHING].center_transforms ) / block.asked;
		moved_without += static_cast<double>( block.stats[CACHING].center_transforms ) / block.asked;
		tests += static_cast<double>( block.stats[NOTHING].node_tests + block.stats[NOTHING].leaf_tests ) / block.asked;
		time += timeOf( block.rounds[NOTHING] ).median;
		count += 1;
	}
	out.claims.push_back( { "section II.C", "caching transformed sphere centres makes queries about 30 % faster on average",
	    "without it they take " + sayOf( caching ), verdictOf( caching, 15 ),
	    "A question moves " + say( "%.0f centres with", moved_with / count ) +
	        say( " and %.0f without the cache, ", moved_without / count ) +
	        say( "makes %.0f tests and takes ", tests / count ) + say( "%.0f microseconds: ", time / count ) +
	        say( "the cache spares %.0f %% of the transforms, ", 100 * ( 1 - moved_with / moved_without ) ) +
	        "but one transform serves a test of eight spheres or triangles here, where it served one sphere in the "
	        "paper." } );

	const auto self = []( const Cellblock& block ) { return block.question->flags == LW_CHECK_SELF; };
	const Spread tables = spreadOf( blocks, TABLES, self ), hulls = spreadOf( blocks, HULLS, self );
	out.claims.push_back( { "section IV", "tables of pairs that can never collide avoid computations of self-collision",
	    "without tables self queries take " + sayOf( tables ) + ", most for: " + tables.where, verdictOf( tables, 10 ),
	    tables.least < 5
	        ? "Exact distances gain least: they are spent on pairs that are always near each other, which no table "
	          "rules out."
	        : "" } );
	const Spread untabled = spreadOf( blocks, HULLS_AND_TABLES, self, TABLES );
	double tests_with = 0, tests_without = 0, tests_neither = 0;
	for ( const Cellblock& block : blocks )
	{
		tests_with += static_cast<double>( block.stats[NOTHING].robot_tests ) / block.asked / count;
		tests_without += static_cast<double>( block.stats[HULLS].robot_tests ) / block.asked / count;
		tests_neither += static_cast<double>( block.stats[HULLS_AND_TABLES].robot_tests ) / block.asked / count;
	}
	out.claims.push_back( { "section III", "range-of-motion hulls make (self-)collision checks of articulated robots fast",
	    "without hulls self queries take " + sayOf( hulls ) + "; all queries " + sayOf( spreadOf( blocks, HULLS, all ) ) +
	        "; where there are no tables either, self queries without hulls take " + sayOf( untabled ),
	    verdictOf( hulls, 10 ),
	    say( "A question makes %.0f tests of nodes of the robot and of tables with hulls, ", tests_with ) +
	        say( "%.0f without, ", tests_without ) + say( "%.0f without either: ", tests_neither ) +
	        "their spheres rule out little that tables, made of these hulls, have not ruled out before the query; and an "
	        "arm "
	        "parked before furniture can reach it in all its joints' ranges. What is far from everything is where they "
	        "count: one test, no forward kinematics." } );
	const auto motion = []( const Cellblock& block ) { return block.work == "along motions"; };
	const auto independent = []( const Cellblock& block ) { return block.work == "independent states"; };
	const Spread along = spreadOf( blocks, WARM_START, motion ), apart = spreadOf( blocks, WARM_START, independent );
	out.claims.push_back( { "design", "the witness of the last query is a good start of the next one along a motion",
	    "without it states along motions take " + sayOf( along ) + ", independent ones " + sayOf( apart ),
	    verdictOf( along, 3 ),
	    along.mean < 3 ? "Pairs come nearest first by their boxes, so that the first search finds most of the bound anyway."
	                   : "" } );
	const Spread together = spreadOf( blocks, ALL_OF_THESE, all );
	out.claims.push_back( { "design", "all together are worth more than any alone",
	    "without all of these queries take " + sayOf( together ) + ", most for: " + together.where,
	    together.mean > std::max( { caching.mean, tables.mean, hulls.mean } ) ? Verdict::HOLDS : Verdict::DIFFERS, "" } );

	std::size_t wrong = 0;
	double answers = 0;
	for ( const Cellblock& block : blocks )
	{
		wrong += contradictions( block );
		answers += static_cast<double>( block.rounds.size() * block.rounds[NOTHING].answers.size() );
	}
	out.claims.push_back( { "promise",
	    "whatever is left out changes no answer: exact distances to the bit, verdicts, no proof against a counterexample",
	    say( "%.0f contradictions", static_cast<double>( wrong ) ) + say( " in %.0f answers", answers ),
	    wrong == 0 ? Verdict::HOLDS : Verdict::BROKEN, "" } );
}

class AblationExperiment : public Experiment
{
public:
	std::string name() const override { return "ablation"; }
	std::string title() const override { return "What each part is worth"; }
	double expectedSeconds( const ExperimentSettings& settings ) const override
	{
		return settings.smoke ? 5 : settings.quick ? 20 : 120;
	}

	Outcome run( const ExperimentSettings& settings, Progress& progress ) override
	{
		if ( settings.data.empty() )
		{
			throw std::runtime_error( "ablation: needs a data folder (--data)" );
		}
		Outcome out;
		out.name = name();
		out.title = title();
		out.about =
		    "The same questions with one part of the query switched off at a time (lw_query_def), and with all of them off: "
		    "ARMAR-III, parked before the dishwasher of the cluttered kitchen, its right arm alone and torso with both "
		    "arms. "
		    "Contenders take turns question by question in a random order; times are processor time of one thread, forward "
		    "kinematics included.";
		const char* const groups[] = { "right_arm", "torso_both_arms" };
		const int passes = static_cast<int>( settings.pick( 11, 5, 1 ) );
		std::vector<Cellblock> blocks;
		std::vector<io::Problem> problems;
		double step = 0;
		for ( const char* group : groups )
		{
			progress.at( step, std::string( group ) + ": hulls and tables" );
			problems.push_back( loadPaperKitchen( settings, group ) );
			const std::vector<Work> work = makeWork( problems.back(), settings );
			for ( const Work& w : work )
			{
				for ( const Question& question : QUESTIONS )
				{
					if ( question.edge == !w.to.empty() )
					{
						PartProgress part( progress, step, step + 1.0 / 18 );
						blocks.push_back( measureBlock( problems.back(), question, w, passes, part ) );
						step += 1.0 / 18; // two groups, twice four questions about states, one about edges
					}
				}
			}
		}
		addTable( out, blocks );
		addPlots( out, blocks );
		addClaims( out, blocks );
		const lw_checker_info info = lw_checker_get_info( problems.back().checker.get() );
		out.details = { { "data_hash", hashFiles( kitchenFiles( settings.data ) ) }, { "passes", passes },
		    { "seconds_of_proofs", settings.budget }, { "hulls_and_tables", info.hierarchy },
		    { "self_pairs", info.self_pairs }, { "proved_apart", info.never_pairs } };
		return out;
	}
};

} // namespace

std::unique_ptr<Experiment> makeAblationExperiment()
{
	return std::make_unique<AblationExperiment>();
}
