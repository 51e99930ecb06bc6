// SPDX-License-Identifier: BSD-3-Clause
// Figures 9b and 10: the gain by max_d, min_d and alpha, for ARMAR-III against itself and the kitchen.
// Paper: Steinbach, Kuffner, Asfour, Dillmann 2006, section VI.
#include "experiments/paper.hpp"
#include "report/rounds.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace
{

namespace io = leeway::io;

constexpr double INFINITE = std::numeric_limits<double>::infinity();
constexpr double MARGIN = 0.01; ///< metres: min_d of the paper's figure 10a
const char* const GROUP = "platform_torso_both_arms";

/// Joints of the reach of armar3/reach/05.yaml, and its path as `leeway plan --seed 1` found it: torso and right arm go
/// under the wall cupboard over the dishwasher, past its edge at 3 mm and along its front at 1 mm.
const char* const REACH_JOINTS[] = { "Hip_Pitch_joint", "Hip_Roll_joint", "Hip_Yaw_joint", "Shoulder_1_R_joint",
    "Shoulder_2_R_joint", "Upperarm_R_joint", "Elbow_R_joint", "Underarm_R_joint", "Wrist_1_R_joint", "Wrist_2_R_joint" };
const double REACH_PATH[][10] = {
    { 0, 0, 0, 1.15632396, -0.241728101, 0.154478137, -0.280330096, -0.0555683363, -0.0183605172, -0.0382236081 },
    { -0.0251684994, 0.0237377519, 0.0121842811, 1.12203156, -0.180079677, 0.07635737696, -0.296916583, -0.0245369637,
        0.00170419092, -0.014170407 },
    { -0.20747224, 0.123331388, 0.0271318426, 0.393003025, 0.381332731, -0.651627309, -0.288754112, 0.53516599, 0.157226811,
        0.0929930738 },
    { -0.158502416, 0.122791535, 0.0402700017, 0.251785613, 0.416664269, -0.606762953, -0.269421584, 0.570016189,
        0.148452033, 0.092725502 },
    { 0.224979016, 0.00792045169, 0.238987381, -0.635137299, 0.374578974, -0.0266153066, -0.328293723, 0.504017895,
        -0.106896643, 0.217290284 },
    { 0.245611066, -0.00510036830, 0.255703234, -0.6738246, 0.354547889, 0.0169808483, -0.344129335, 0.481948325,
        -0.131978334, 0.232087374 },
    { 0.327565014, -0.157286799, 0.376780106, -0.863793503, 0.100496452, 0.288959052, -0.525542524, 0.268591787,
        -0.364520479, 0.372929476 },
};

/// States along the path, evenly spaced in joint space.
std::vector<std::vector<double>> reachStates( const io::Problem& problem, std::size_t count )
{
	std::map<std::string, std::size_t> index;
	for ( std::size_t i = 0; i < problem.variable_names.size(); ++i )
	{
		index[problem.variable_names[i]] = i;
	}
	const std::vector<double> parked = io::startState( problem );
	std::vector<double> along = { 0 };
	for ( std::size_t i = 1; i < std::size( REACH_PATH ); ++i )
	{
		double square = 0;
		for ( std::size_t k = 0; k < std::size( REACH_JOINTS ); ++k )
		{
			square += std::pow( REACH_PATH[i][k] - REACH_PATH[i - 1][k], 2 );
		}
		along.push_back( along.back() + std::sqrt( square ) );
	}
	std::vector<std::vector<double>> states;
	for ( std::size_t i = 0; i < count; ++i )
	{
		const double at = along.back() * static_cast<double>( i ) / static_cast<double>( count - 1 );
		std::size_t edge = 1;
		while ( edge + 1 < along.size() && along[edge] < at )
		{
			++edge;
		}
		const double t = ( at - along[edge - 1] ) / ( along[edge] - along[edge - 1] );
		std::vector<double> state = parked;
		for ( std::size_t k = 0; k < std::size( REACH_JOINTS ); ++k )
		{
			state[index.at( REACH_JOINTS[k] )] =
			    REACH_PATH[edge - 1][k] + t * ( REACH_PATH[edge][k] - REACH_PATH[edge - 1][k] );
		}
		states.push_back( state );
	}
	return states;
}

/// The range of a question, which may depend on its number.
using RangeOf = std::function<lw_range( std::size_t )>;

/// Contenders of one race, each with a query of its own.
class Field
{
public:
	Field( const lw_checker* checker, const std::vector<std::vector<double>>& states )
	    : m_checker( checker ), m_states( states )
	{
	}

	/// @return its number
	std::size_t add( lw_check_flags flags, RangeOf range, bool proofs = true )
	{
		lw_query_def def = lw_query_def_default();
		def.motion_hulls = def.pair_tables = proofs;
		m_queries.push_back( leeway::makeQuery( m_checker, def ) );
		lw_query* query = m_queries.back().get();
		m_contenders.push_back( { "", [this, query, flags, range = std::move( range )]( const double* q )
		    {
			    const std::size_t number = questionNumber( q );
			    const lw_range wanted = range( number );
			    lw_state_result result;
			    leeway::require(
			        lw_checker_state( m_checker, query, m_states[number].data(), flags, &wanted, false, &result ),
			        "a state" );
			    const lw_clearance& c = flags == LW_CHECK_SELF ? result.self : result.environment;
			    return Answer{ c.lower, c.upper };
		    } } );
		return m_contenders.size() - 1;
	}

	std::size_t add( lw_check_flags flags, const lw_range& range, bool proofs = true )
	{
		return add(
		    flags, [range]( std::size_t ) { return range; }, proofs );
	}

	std::vector<Rounds> race( int passes, Progress& progress, const std::string& title ) const
	{
		return raceRounds( m_contenders, m_states.size(), passes, progress, title );
	}

	/// Pairs of shapes that a contender searched, per question.
	double searches( std::size_t contender ) const
	{
		const lw_query_stats stats = lw_query_get_stats( m_queries[contender].get() );
		return static_cast<double>( stats.queries );
	}

private:
	const lw_checker* m_checker;
	const std::vector<std::vector<double>>& m_states;
	std::vector<leeway::Query> m_queries;
	std::vector<Contender> m_contenders;
};

/// Mean of the members' values: a contender's times for these questions.
double meanOf( const std::vector<double>& values, const std::vector<std::size_t>& members )
{
	double sum = 0;
	for ( const std::size_t i : members )
	{
		sum += values[i];
	}
	return members.empty() ? 0 : sum / static_cast<double>( members.size() );
}

double meanOf( const std::vector<double>& values )
{
	std::vector<std::size_t> all( values.size() );
	std::iota( all.begin(), all.end(), std::size_t{ 0 } );
	return meanOf( values, all );
}

std::vector<double> uppers( const Rounds& rounds )
{
	std::vector<double> out;
	for ( const Answer& answer : rounds.answers )
	{
		out.push_back( answer.upper );
	}
	return out;
}

Point pointOf( double x, const Measure& m )
{
	return { x, m.median, m.lower, m.upper };
}

std::string millimetres( double metres )
{
	return std::isfinite( metres ) ? say( "%g mm", 1e3 * metres ) : "none";
}

// --- figure 9b -------------------------------------------------------------------------------------------------------

const double MAX_D[] = { 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, INFINITE };
const double FACTORS[] = { 0.2, 0.5, 0.9, 1.1, 1.5, 2, 5, 10, INFINITE };

struct Asked
{
	lw_check_flags flags;
	bool proofs; ///< with motion hulls and pair tables
	const char *name, *short_name;
};

const Asked ASKED[] = {
    { LW_CHECK_SELF, true, "self", "self" },
    { LW_CHECK_SELF, false, "self, without hulls and tables", "self, without" },
    { LW_CHECK_ENVIRONMENT, true, "environment", "environment" },
};

/// Time over max_d in metres.
void addMaxD( const io::Problem& problem, const std::vector<std::vector<double>>& states, int passes, Progress& progress,
    Outcome& out )
{
	Field field( problem.checker.get(), states );
	for ( const Asked& asked : ASKED )
	{
		for ( const double max_d : MAX_D )
		{
			field.add( asked.flags, { 0, max_d, 0 }, asked.proofs );
		}
	}
	const std::vector<Rounds> rounds = field.race( passes, progress, "figure 9b, max_d" );
	Table table{ "max-d", "Time over max_d (figure 9b)",
	    "Mean time per state; medians and quartiles over the passes. Found: states "
	    "with anything nearer than max_d.",
	    { { "question", "" }, { "max_d", "" }, { "time", "us", -1 }, { "of the time without max_d", "%" },
	        { "found", "%" } },
	    {} };
	Plot plot{ "9b-max-d", "Self-collision and environment: time over max_d",
	    "Dashed: without max_d. Bands are quartiles over the passes.", { "max_d", "mm", true },
	    { "mean time per state", "us" }, {}, {}, {} };
	plot.y.from = 0;
	std::size_t c = 0;
	for ( const Asked& asked : ASKED )
	{
		Series line{ asked.short_name, {}, Mark::LINES, false };
		const Rounds& unbounded = rounds[c + std::size( MAX_D ) - 1];
		for ( const double max_d : MAX_D )
		{
			double found = 0;
			for ( const Answer& answer : rounds[c].answers )
			{
				found += answer.upper < INFINITE;
			}
			const Measure time = timeOf( rounds[c] );
			table.rows.push_back( { asked.name, millimetres( max_d ), time, ratioOf( rounds[c], unbounded, 0, 100 ),
			    100 * found / static_cast<double>( states.size() ) } );
			if ( max_d < INFINITE )
			{
				line.points.push_back( pointOf( 1e3 * max_d, time ) );
			}
			++c;
		}
		plot.series.push_back( line );
		const double all = timeOf( unbounded ).median;
		plot.series.push_back( { "", { { 1, all }, { 1000, all } }, Mark::DASHES, false } );
	}
	out.tables.push_back( table );
	out.plots.push_back( plot );
}

/// States that are not in contact and their exact distances.
struct Apart
{
	std::vector<std::vector<double>> states;
	std::vector<double> exact;
};

Apart findApart( const io::Problem& problem, lw_check_flags flags, const std::vector<std::vector<double>>& all_states,
    Progress& progress )
{
	Apart apart;
	Field field( problem.checker.get(), all_states );
	field.add( flags, lw_range_exact() );
	const std::vector<double> found = uppers( field.race( 0, progress, "figure 9b, exact distances" )[0] );
	for ( std::size_t i = 0; i < found.size(); ++i )
	{
		if ( found[i] > 1e-6 && found[i] < INFINITE )
		{
			apart.states.push_back( all_states[i] );
			apart.exact.push_back( found[i] );
		}
	}
	return apart;
}

/// Time over max_d in multiples of each state's own distance: the paper's claim is about multiples above 1.
void addFactors( const io::Problem& problem, const std::vector<std::vector<double>>& all_states, int passes,
    Progress& progress, Outcome& out )
{
	Table table{ "max-d-relative", "Time over max_d in multiples of the true distance",
	    "States that are not in contact; each is asked with max_d = factor * its exact distance.",
	    { { "question", "" }, { "max_d / distance", "" }, { "time", "us", -1 }, { "of the time without max_d", "%" },
	        { "pairs searched", "" } },
	    {} };
	Plot plot{ "9b-relative", "Time over max_d, in multiples of the true distance",
	    "100 % is the time without max_d. Right of 1 the nearest pair still has to be found.",
	    { "max_d / true distance", "", true }, { "of the time without max_d", "%" }, {}, {}, {} };
	plot.y.from = 0;
	double share = 0;
	for ( const Asked& asked : ASKED )
	{
		PartProgress part( progress, share, share + 1.0 / 3 );
		share += 1.0 / 3;
		PartProgress first( part, 0, 0.05 );
		const auto [states, exact] = findApart( problem, asked.flags, all_states, first );
		Field field( problem.checker.get(), states );
		for ( const double factor : FACTORS )
		{
			field.add(
			    asked.flags,
			    [&exact = exact, factor]( std::size_t i ) {
				    return lw_range{ 0, factor * exact[i], 0 };
			    },
			    asked.proofs );
		}
		PartProgress rest( part, 0.05, 1 );
		const std::vector<Rounds> rounds = field.race( passes, rest, std::string( "figure 9b, " ) + asked.short_name );
		Series line{ asked.short_name, {}, Mark::LINES, false };
		std::map<double, Measure> relative;
		for ( std::size_t c = 0; c < std::size( FACTORS ); ++c )
		{
			relative[FACTORS[c]] = ratioOf( rounds[c], rounds.back(), 0, 100 );
			const double searches = field.searches( c ) / static_cast<double>( states.size() ) / ( passes + 1 );
			table.rows.push_back( { asked.name, std::isfinite( FACTORS[c] ) ? say( "%g", FACTORS[c] ) : "none",
			    timeOf( rounds[c] ), relative[FACTORS[c]], searches } );
			if ( std::isfinite( FACTORS[c] ) )
			{
				line.points.push_back( pointOf( FACTORS[c], relative[FACTORS[c]] ) );
			}
		}
		plot.series.push_back( line );
		const double below = relative[0.5].median, just = relative[1.1].median, twice = relative[2].median,
		             ten = relative[10].median;
		const std::string figures = std::string( asked.name ) + say( ": %.0f %% of the time at half the distance", below ) +
		                            say( ", %.0f %% at 1.1 times", just ) + say( ", %.0f %% at twice", twice ) +
		                            say( ", %.0f %% at ten times", ten );
		const bool smaller = below < 90, higher = just < 95 && twice < 97;
		const std::string searches =
		    "A query without max_d searches " +
		    say( "%.1f pairs of shapes", field.searches( 8 ) / static_cast<double>( states.size() ) / ( passes + 1 ) ) +
		    say( ", one with twice the distance %.1f, ",
		        field.searches( 5 ) / static_cast<double>( states.size() ) / ( passes + 1 ) ) +
		    say( "with half of it %.1f: ", field.searches( 1 ) / static_cast<double>( states.size() ) / ( passes + 1 ) );
		out.claims.push_back( { "figure 9b",
		    asked.flags == LW_CHECK_SELF ? "max_d makes self-collision faster below the real distance, and also above it"
		                                 : "the same holds between robot and kitchen",
		    figures,
		    smaller && higher ? Verdict::HOLDS
		    : smaller         ? Verdict::PARTLY
		                      : Verdict::DIFFERS,
		    smaller && higher
		        ? ""
		        : searches +
		              "pairs are taken nearest first, with the witness of the last query measured before them, so a bound "
		              "near the true distance is there early and a max_d above it has little left to rule out." } );
	}
	out.tables.push_back( table );
	out.plots.push_back( plot );
}

// --- figure 10a: min_d -----------------------------------------------------------------------------------------------

/// A question asked at every state along the reach.
struct Along
{
	const char* name;
	lw_range range;
};

const Along ALONG[] = {
    { "exact", { 0, INFINITE, 0 } },
    { "min_d 10 mm", { MARGIN, INFINITE, 0 } },
    { "alpha 0.3", { 0, INFINITE, 0.3 } },
    { "min_d 10 mm, alpha 0.3", { MARGIN, INFINITE, 0.3 } },
};

/// Mean work of an exact query in some of the states.
std::string workOf(
    const io::Problem& problem, const std::vector<std::vector<double>>& states, const std::vector<std::size_t>& members )
{
	const leeway::Query query = leeway::makeQuery( problem.checker.get() );
	const lw_range exact = lw_range_exact();
	for ( const std::size_t i : members )
	{
		lw_state_result result;
		leeway::require( lw_checker_state( problem.checker.get(), query.get(), states[i].data(), LW_CHECK_ENVIRONMENT,
		                     &exact, false, &result ),
		    "a state" );
	}
	const lw_query_stats stats = lw_query_get_stats( query.get() );
	const double count = static_cast<double>( std::max<std::size_t>( 1, members.size() ) );
	return say( "a query searches %.1f pairs of shapes", static_cast<double>( stats.queries ) / count ) +
	       say( " and compares %.0f pairs of leaves", static_cast<double>( stats.leaf_tests ) / count );
}

/// Time and reported distance along the reach.
void addReach( const io::Problem& problem, const std::vector<std::vector<double>>& states, int passes, Progress& progress,
    Outcome& out )
{
	Field field( problem.checker.get(), states );
	for ( const Along& along : ALONG )
	{
		field.add( LW_CHECK_ENVIRONMENT, along.range );
	}
	const std::vector<Rounds> rounds = field.race( passes, progress, "figure 10a, along the reach" );
	Plot time{ "10a-reach-time", "Robot against kitchen along a reach: time",
	    "States evenly spaced along the path; medians over the passes.", { "share of the path", "%" }, { "time", "us" }, {},
	    {}, {} };
	Plot distance{ "10a-reach-distance", "Robot against kitchen along a reach: reported distance",
	    "Upper ends of the intervals. With min_d a state below it is reported by the first pair found below it, which need "
	    "not be "
	    "the nearest.",
	    { "share of the path", "%" }, { "reported distance", "mm" }, {}, {}, {} };
	time.y.from = distance.y.from = 0;
	std::vector<std::size_t> near, far;
	const std::vector<double> exact = uppers( rounds[0] );
	for ( std::size_t i = 0; i < states.size(); ++i )
	{
		( exact[i] <= MARGIN ? near : far ).push_back( i );
	}
	Table table{ "reach", "Robot against kitchen along a reach (figure 10a)",
	    say( "%.0f states, ", static_cast<double>( states.size() ) ) +
	        say( "%.0f of them within 10 mm.", static_cast<double>( near.size() ) ),
	    { { "question", "" }, { "mean", "us", -1 }, { "within 10 mm", "us", -1 }, { "beyond 10 mm", "us", -1 } }, {} };
	for ( std::size_t c = 0; c < std::size( ALONG ); ++c )
	{
		time.series.push_back( { ALONG[c].name, {}, Mark::LINES, false } );
		distance.series.push_back( { ALONG[c].name, {}, Mark::LINES, false } );
		for ( std::size_t i = 0; i < states.size(); ++i )
		{
			const double x = 100 * static_cast<double>( i ) / static_cast<double>( states.size() - 1 );
			time.series.back().points.push_back( { x, rounds[c].medians[i] } );
			distance.series.back().points.push_back( { x, 1e3 * rounds[c].answers[i].upper } );
		}
		table.rows.push_back(
		    { ALONG[c].name, timeOf( rounds[c] ), meanOf( rounds[c].medians, near ), meanOf( rounds[c].medians, far ) } );
	}
	distance.series.push_back( { "min_d", { { 0, 1e3 * MARGIN }, { 100, 1e3 * MARGIN } }, Mark::DASHES, false } );
	out.tables.push_back( table );
	out.plots.push_back( time );
	out.plots.push_back( distance );

	const double with = meanOf( rounds[1].medians, near ), without = meanOf( rounds[0].medians, near );
	const double elsewhere = meanOf( rounds[1].medians, far ) / meanOf( rounds[0].medians, far );
	out.claims.push_back( { "figure 10a",
	    "below the safety margin of 10 mm a collision is reported at once, without it the query takes much longer",
	    say( "within 10 mm %.1f us", with ) + say( " with min_d, %.1f us without", without ) +
	        say( " (%.0f times)", without / with ) + say( "; beyond 10 mm min_d makes it %.2f times as long", elsewhere ),
	    without > 2 * with ? Verdict::HOLDS
	    : without > with   ? Verdict::PARTLY
	                       : Verdict::DIFFERS,
	    without > 2 * with ? "" : "Within 10 mm " + workOf( problem, states, near ) + ": there is not more to spare." } );
	const double near_exact = without, far_exact = meanOf( rounds[0].medians, far );
	const bool longest = near_exact > far_exact;
	out.claims.push_back( { "figure 10a", "exact distances take longest where robot and kitchen are near each other",
	    say( "exact: %.1f us within 10 mm", near_exact ) + say( ", %.1f us beyond", far_exact ),
	    longest ? Verdict::HOLDS : Verdict::DIFFERS,
	    longest ? ""
	            : "Within 10 mm " + workOf( problem, states, near ) + "; beyond, " + workOf( problem, states, far ) +
	                  ". A bound of millimetres rules out by their boxes nearly all pairs that are not in contact; at a "
	                  "distance many "
	                  "are about as near as the nearest." } );
}

/// Time and reported distance over min_d.
void addMinD( const io::Problem& problem, const std::vector<std::vector<double>>& states, int passes, Progress& progress,
    Outcome& out )
{
	const double min_d[] = { 0, 0.001, 0.002, 0.005, 0.01, 0.02, 0.03, 0.05, 0.075, 0.1 };
	Field field( problem.checker.get(), states );
	for ( const double d : min_d )
	{
		field.add( LW_CHECK_ENVIRONMENT, { d, INFINITE, 0 } );
	}
	const std::vector<Rounds> rounds = field.race( passes, progress, "figure 10a, min_d" );
	Table table{ "min-d", "Robot against kitchen along a reach, over min_d (figure 10a)",
	    "Reported: mean of the upper ends, which for a violation is the pair that ended the search.",
	    { { "min_d", "mm" }, { "time", "us", -1 }, { "violations", "%" }, { "reported distance", "mm" } }, {} };
	Plot plot{ "10a-min-d", "Robot against kitchen along a reach: time and reported distance over min_d",
	    "Means over the states of the path. Bands are quartiles over the passes.", { "min_d", "mm" },
	    { "mean time per state", "us" }, { "mean reported distance", "mm" }, {}, {} };
	plot.y.from = plot.y2.from = 0;
	Series time{ "time", {}, Mark::LINES, false }, reported{ "reported distance (right)", {}, Mark::LINES, true };
	for ( std::size_t c = 0; c < std::size( min_d ); ++c )
	{
		double violations = 0;
		for ( const double upper : uppers( rounds[c] ) )
		{
			violations += upper <= min_d[c];
		}
		const double mean = 1e3 * meanOf( uppers( rounds[c] ) );
		table.rows.push_back(
		    { 1e3 * min_d[c], timeOf( rounds[c] ), 100 * violations / static_cast<double>( states.size() ), mean } );
		time.points.push_back( pointOf( 1e3 * min_d[c], timeOf( rounds[c] ) ) );
		reported.points.push_back( { 1e3 * min_d[c], mean } );
	}
	plot.series = { time, reported };
	out.tables.push_back( table );
	out.plots.push_back( plot );
	const double first = timeOf( rounds.front() ).median, last = timeOf( rounds.back() ).median;
	std::vector<std::size_t> within;
	for ( std::size_t i = 0; i < states.size(); ++i )
	{
		if ( rounds[0].answers[i].upper <= min_d[std::size( min_d ) - 1] )
		{
			within.push_back( i );
		}
	}
	const double of_states = 100 * static_cast<double>( within.size() ) / static_cast<double>( states.size() );
	const double of_time = of_states * meanOf( rounds[0].medians, within ) / meanOf( rounds[0].medians );
	const double spared = 100 * ( 1 - meanOf( rounds.back().medians, within ) / meanOf( rounds[0].medians, within ) );
	out.claims.push_back( { "figure 10a", "the larger min_d, the earlier queries end",
	    say( "%.1f us without min_d", first ) + say( ", %.1f us at 10 mm", timeOf( rounds[4] ).median ) +
	        say( ", %.1f us at 100 mm", last ) +
	        say( "; in the states within 100 mm the largest min_d spares %.0f %%", spared ),
	    last < 0.8 * first ? Verdict::HOLDS
	    : spared > 20      ? Verdict::PARTLY
	                       : Verdict::DIFFERS,
	    last < 0.8 * first ? ""
	                       : say( "%.0f %% of the states are within 100 mm, ", of_states ) +
	                             say( "but only %.0f %% of the time is spent there: ", of_time ) +
	                             "exact queries take longest beyond, where no min_d helps." } );
}

// --- figures 10a and 10b: alpha --------------------------------------------------------------------------------------

const double ALPHAS[] = { 0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9 };
constexpr std::size_t ALPHA_30 = 5; ///< index of 0.3

struct AlphaSet
{
	const char *id, *name;
	lw_check_flags flags;
	const std::vector<std::vector<double>>* states;
	double gain = 0; ///< time at 0 over time at 0.3
};

/// Time and reported distance of one set over alpha; a promise broken is a claim of its own.
Series addAlphaSet( const io::Problem& problem, AlphaSet& set, int passes, Progress& progress, Table& table, Outcome& out )
{
	Field field( problem.checker.get(), *set.states );
	for ( const double alpha : ALPHAS )
	{
		field.add( set.flags, { 0, INFINITE, alpha } );
	}
	const std::vector<Rounds> rounds = field.race( passes, progress, std::string( "figure 10, alpha, " ) + set.name );
	Plot plot{ std::string( set.flags == LW_CHECK_SELF ? "10b-" : "10a-alpha-" ) + set.id,
	    std::string( set.name ) + ": time and reported distance over alpha",
	    "Mean over the states; the interval [lower, upper] holds the true distance (its mean is dashed). Bands are "
	    "quartiles over "
	    "the passes.",
	    { "alpha", "" }, { "mean time per state", "us" }, { "mean reported distance", "mm" }, {}, {} };
	plot.y.from = plot.y2.from = 0;
	Series time{ "time", {}, Mark::LINES, false }, upper{ "upper end (right)", {}, Mark::LINES, true },
	    lower{ "lower end (right)", {}, Mark::LINES, true }, truth{ "true (right)", {}, Mark::DASHES, true },
	    relative{ set.name, {}, Mark::LINES, false };
	const std::vector<double> exact = uppers( rounds[0] );
	double worst = 0; // largest excess of a relative error over its alpha; 0 if none exceeds it
	for ( std::size_t c = 0; c < std::size( ALPHAS ); ++c )
	{
		double error = 0, low = 0;
		for ( std::size_t i = 0; i < exact.size(); ++i )
		{
			const Answer& answer = rounds[c].answers[i];
			error = std::max( error, ( answer.upper - exact[i] ) / std::max( answer.upper, 1e-9 ) );
			low += answer.lower / static_cast<double>( exact.size() );
		}
		worst = std::max( worst, error - ALPHAS[c] );
		const double high = meanOf( uppers( rounds[c] ) );
		table.rows.push_back( { set.name, ALPHAS[c], timeOf( rounds[c] ), ratioOf( rounds[0], rounds[c] ), 1e3 * low,
		    1e3 * high, 1e3 * meanOf( exact ), 100 * error } );
		time.points.push_back( pointOf( ALPHAS[c], timeOf( rounds[c] ) ) );
		upper.points.push_back( { ALPHAS[c], 1e3 * high } );
		lower.points.push_back( { ALPHAS[c], 1e3 * low } );
		truth.points.push_back( { ALPHAS[c], 1e3 * meanOf( exact ) } );
		relative.points.push_back( pointOf( ALPHAS[c], ratioOf( rounds[c], rounds[0], 0, 100 ) ) );
	}
	plot.series = { time, upper, lower, truth };
	out.plots.push_back( plot );
	set.gain = ratioOf( rounds[0], rounds[ALPHA_30] ).median;
	if ( worst > 1e-9 )
	{
		out.claims.push_back( { "promise", "upper - true <= alpha * upper", say( "exceeded by %.3g of upper", worst ),
		    Verdict::BROKEN, set.name } );
	}
	return relative;
}

void addAlpha( const io::Problem& problem, const PaperStates& states, int passes, Progress& progress, Outcome& out )
{
	Table table{ "alpha", "Time and reported distance over alpha (figures 10a and 10b)",
	    "Distances are means over the states. Largest error: of the upper end over the true distance, in percent of the "
	    "upper "
	    "end; alpha promises that it is no more than alpha.",
	    { { "question", "" }, { "alpha", "" }, { "time", "us", -1 }, { "exact over this", "times" }, { "lower", "mm" },
	        { "upper", "mm" }, { "true", "mm" }, { "largest error", "%" } },
	    {} };
	AlphaSet sets[] = {
	    { "reach", "environment, along the reach", LW_CHECK_ENVIRONMENT, &states.reach },
	    { "random", "environment, near furniture", LW_CHECK_ENVIRONMENT, &states.random },
	    { "reach", "self, along the reach", LW_CHECK_SELF, &states.reach },
	    { "random", "self, near furniture", LW_CHECK_SELF, &states.random },
	};
	Plot together{ "10-gain", "What alpha is worth: environment and self", "100 % is the exact distance.", { "alpha", "" },
	    { "of the exact query's time", "%" }, {}, {}, {} };
	together.y.from = 0;
	for ( std::size_t i = 0; i < std::size( sets ); ++i )
	{
		const double quarter = 1.0 / static_cast<double>( std::size( sets ) ), from = static_cast<double>( i ) * quarter;
		PartProgress part( progress, from, from + quarter );
		together.series.push_back( addAlphaSet( problem, sets[i], passes, part, table, out ) );
	}
	out.tables.push_back( table );
	out.plots.push_back( together );

	const double environment = std::max( sets[0].gain, sets[1].gain ), self = std::max( sets[2].gain, sets[3].gain );
	const double least = std::min( { sets[0].gain, sets[1].gain, sets[2].gain, sets[3].gain } );
	const std::string figures = "exact over alpha 0.3: environment " + say( "%.2f times along the reach", sets[0].gain ) +
	                            say( ", %.2f near furniture", sets[1].gain ) + say( "; self %.2f", sets[2].gain ) +
	                            say( " and %.2f", sets[3].gain );
	out.claims.push_back( { "figures 10a, 10b", "a larger error tolerance makes distances considerably faster", figures,
	    least > 1.2                       ? Verdict::HOLDS
	    : environment > 1.2 || self > 1.2 ? Verdict::PARTLY
	                                      : Verdict::DIFFERS,
	    least > 1.2 ? ""
	                : "Where the exact query ends with a slab or a plane across the nearest pair, the proof that alpha "
	                  "spares is cheap." } );
	// set against set: the states are the same
	const int more = ( sets[2].gain > sets[0].gain ) + ( sets[3].gain > sets[1].gain );
	std::string why = "Mean true distances: ";
	for ( std::size_t i = 0; i < std::size( sets ); ++i )
	{
		const std::vector<Cell>& exact = table.rows[i * std::size( ALPHAS )];
		const std::vector<Cell>& widest = table.rows[( i + 1 ) * std::size( ALPHAS ) - 1];
		why += std::string( i > 0 ? "; " : "" ) + sets[i].name + say( " %.0f mm", std::get<double>( exact[6] ) ) +
		       say( ", of %.1f us", std::get<Measure>( exact[2] ).median ) +
		       say( " the widest alpha leaves %.1f", std::get<Measure>( widest[2] ).median );
	}
	why += ". What is left there is finding pairs at all, which no alpha spares; of self distances pair tables and hulls "
	       "have spared "
	       "it beforehand, and of the kitchen at a distance alpha spares the proof over large faces.";
	out.claims.push_back( { "figure 10b", "alpha pays most for self-collision", figures,
	    more == 2   ? Verdict::HOLDS
	    : more == 1 ? Verdict::PARTLY
	                : Verdict::DIFFERS,
	    more == 2 ? "" : why } );
	if ( promisesKept( out ) )
	{
		out.claims.push_back( { "promise", "upper - true <= alpha * upper, in every answer",
		    say( "kept in %.0f answers",
		        static_cast<double>( 2 * std::size( ALPHAS ) * ( states.reach.size() + states.random.size() ) ) ),
		    Verdict::HOLDS, "" } );
	}
}

} // namespace

io::Problem loadPaperKitchen( const ExperimentSettings& settings, const std::string& group )
{
	const io::RobotModel robot =
	    io::loadRobot( settings.data + "/armar3/armar3.urdf", settings.data + "/armar3/armar3.srdf" );
	const io::SceneModel scene = io::loadScene( settings.data + "/kit_kitchen/scene_cluttered.yaml" );
	const io::Request request = io::loadRequest( settings.data + "/armar3/reach/05.yaml" );
	io::ProblemOptions options;
	options.group = group;
	options.scene = &scene;
	options.request = &request;
	// hulls and tables take longest, and are the same for all groups
	static std::map<std::string, leeway::Reach> known;
	const std::string key = settings.data + say( " %g", settings.budget ) +
	                        say( " %.0f", static_cast<double>( settings.seed ) ) + ( settings.smoke ? " coarse" : "" );
	leeway::Reach& reach = known[key];
	if ( !reach )
	{
		io::ReachOptions find;
		find.def.seconds = settings.budget;
		find.def.seed = settings.seed;
		if ( settings.smoke )
		{
			find.def.hull_error = 0.3;
			find.def.samples = 50;
		}
		reach = io::loadReach( io::buildRobot( robot ), find ).reach;
	}
	options.reach = reach;
	return io::buildProblem( robot, options );
}

void addPaperRobot( const ExperimentSettings& settings, Progress& progress, Outcome& out )
{
	progress.at( 0, "robot and kitchen, hulls and tables" );
	const io::Problem problem = loadPaperKitchen( settings, GROUP );
	PaperStates states;
	states.reach = reachStates( problem, settings.pick( 201, 101, 21 ) );
	for ( const ConfigurationSet& set :
	    makeConfigurations( problem, settings.data, settings.seed, settings.pick( 100, 40, 5 ) ) )
	{
		if ( set.name != "near" ) // those are made to be near contact
		{
			states.random.insert( states.random.end(), set.states.begin(), set.states.end() );
		}
	}
	const int passes = static_cast<int>( settings.pick( 15, 5, 1 ) );
	PartProgress max_d( progress, 0.1, 0.35 ), factors( progress, 0.35, 0.55 ), reach( progress, 0.55, 0.6 ),
	    min_d( progress, 0.6, 0.7 ), alpha( progress, 0.7, 1 );
	addMaxD( problem, states.random, passes, max_d, out );
	addFactors( problem, states.random, passes, factors, out );
	addReach( problem, states.reach, passes, reach, out );
	addMinD( problem, states.reach, passes, min_d, out );
	addAlpha( problem, states, passes, alpha, out );
	const lw_checker_info info = lw_checker_get_info( problem.checker.get() );
	out.details["robot"] = { { "group", GROUP }, { "states_along_the_reach", states.reach.size() },
	    { "states_near_furniture", states.random.size() }, { "passes", passes }, { "self_pairs", info.self_pairs },
	    { "proved_apart", info.never_pairs }, { "seconds_of_proofs", settings.budget } };
}
