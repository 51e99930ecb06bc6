// SPDX-License-Identifier: BSD-3-Clause
// The accuracy that alpha, min_d and max_d give up on states: see trade.hpp.
//
// For an answer [lower, upper] and the true clearance d the promises are those of distance.h:
//   always             lower <= d <= upper
//   alpha              upper - lower <= alpha upper, plus rounding
//   min_d              a violation is answered exactly where d <= min_d, and its upper is no more than min_d
//   max_d              FAR is answered exactly where d >= max_d, with lower = max_d
// Observed is, in this order: the relative width, less rounding; by how much the reported upper exceeds d in a violation; by
// how much min( upper, max_d ) differs from min( d, max_d ).
#include "experiments/trade.hpp"

#include "support/configurations.hpp"
#include "support/edge_worlds.hpp"
#include "peers/fcl_peer.hpp"

#include <array>

namespace
{

constexpr double INF = std::numeric_limits<double>::infinity();
constexpr double ROUNDING = 1e-10; // metres: of poses (kinematics.md) and distances, 6e-12 for the humanoid
constexpr double CLOSE = 1e-9;     // metres: a distance this near to a threshold may be on either side of it

struct Subject
{
	leeway::Checker checker;
	std::vector<std::vector<double>> states;
	std::vector<std::array<double, 2>> truth; // environment, self
};

// By FCL; the truth of random worlds, whose shapes it lacks, is leeway's exact answer.
Subject kitchen( const ExperimentSettings& settings, Progress& progress )
{
	Subject subject;
	const leeway::io::Problem problem = loadKitchen( settings.data, lw_tree_def_default() );
	subject.checker = problem.checker;
	FclPeer fcl( problem.checker.get() );
	const std::size_t each = settings.pick( 1200, 100, 4 );
	const std::vector<ConfigurationSet> sets = makeConfigurations( problem, settings.data, settings.seed, each );
	for ( const ConfigurationSet& set : sets )
	{
		for ( const std::vector<double>& q : set.states )
		{
			fcl.pose( q.data() );
			subject.states.push_back( q );
			subject.truth.push_back(
			    { std::max( 0.0, fcl.environmentDistance( INF ) ), std::max( 0.0, fcl.selfDistance( INF ) ) } );
			progress.at( static_cast<double>( subject.states.size() ) / static_cast<double>( sets.size() * each ),
			    "the truth, by FCL" );
		}
	}
	return subject;
}

Subject randomWorlds( const ExperimentSettings& settings )
{
	EdgeWorlds worlds( settings.data, lw_reach_def_default() );
	worlds.addRandom( settings.seed, 1 );
	const EdgeWorld& world = worlds.world( 0 );
	Subject subject;
	subject.checker = world.checker;
	std::mt19937_64 random( settings.seed );
	leeway::Query query = leeway::makeQuery( world.checker.get() );
	for ( std::size_t i = 0; i < settings.pick( 400, 100, 60 ); ++i )
	{
		subject.states.push_back( world.randomState( random ) );
		lw_state_result exact;
		leeway::require( lw_checker_state( world.checker.get(), query.get(), subject.states.back().data(), LW_CHECK_BOTH,
		                     nullptr, false, &exact ),
		    "a state" );
		subject.truth.push_back( { exact.environment.upper, exact.self.upper } );
	}
	return subject;
}

enum Knob
{
	ALPHA,
	MIN_D,
	MAX_D,
	RANGE
};
const char* const KNOBS[] = { "alpha", "min_d", "max_d", "range" };

struct Setting
{
	Knob knob;
	double value; // of the knob; a random range has none
	lw_range range;
	Promise promise{ ROUNDING };
	double off_worst = 0, off_sum = 0; // upper - d over upper, of answers in the range
	std::size_t near = 0;              // such answers
	std::vector<double> passes;        // mean microseconds of each
	double pass = 0;                   // sum of this one
};

std::vector<Setting> allSettings( bool short_run )
{
	std::vector<Setting> all;
	for ( const double alpha : { 0.0, 0.01, 0.05, 0.1, 0.3, 0.5, 0.8 } )
	{
		all.push_back( { ALPHA, alpha, { 0, INF, alpha }, Promise( ROUNDING ), 0, 0, 0, {}, 0 } );
	}
	for ( const double min_d : { 0.001, 0.003, 0.01, 0.03, 0.1 } )
	{
		all.push_back( { MIN_D, min_d, { min_d, INF, 0 }, Promise( ROUNDING ), 0, 0, 0, {}, 0 } );
	}
	for ( const double max_d : { 0.01, 0.03, 0.1, 0.3, 1.0 } )
	{
		all.push_back( { MAX_D, max_d, { 0, max_d, 0 }, Promise( ROUNDING ), 0, 0, 0, {}, 0 } );
	}
	for ( int i = 0; i < ( short_run ? 1 : 2 ); ++i )
	{
		all.push_back( { RANGE, double( i ), { 0, INF, 0 }, Promise( ROUNDING ), 0, 0, 0, {}, 0 } );
	}
	return all;
}

// An error of the kind that a fault of this knob would make.
void corrupt( const std::string& inject, const Setting& setting, lw_clearance& c )
{
	if ( inject != KNOBS[setting.knob] || c.kind == LW_CLEARANCE_UNKNOWN )
	{
		return;
	}
	if ( setting.knob == MIN_D && c.kind == LW_CLEARANCE_VIOLATION )
	{
		c.kind = LW_CLEARANCE_NEAR;
	}
	else if ( setting.knob == MAX_D && c.kind == LW_CLEARANCE_NEAR )
	{
		c.kind = LW_CLEARANCE_FAR;
		c.lower = setting.range.max_d;
		c.upper = INF;
	}
	else if ( c.kind == LW_CLEARANCE_NEAR )
	{
		c.lower = 0.9 * ( 1 - setting.range.alpha ) * c.upper;
	}
}

// For every knob: the true clearance is in the interval, and the class agrees with the thresholds.
std::string refute( const lw_clearance& c, double d, const lw_range& range )
{
	const bool is_low = d <= range.min_d - CLOSE, is_high = d > range.min_d + CLOSE;
	const bool is_far = d >= range.max_d + CLOSE, is_near = d < range.max_d - CLOSE;
	if ( !( c.lower <= d + CLOSE && d - CLOSE <= c.upper ) )
	{
		return "the interval does not hold the true clearance";
	}
	if ( c.kind == LW_CLEARANCE_VIOLATION ? is_high : is_low )
	{
		return "a violation is not told, or told where there is none";
	}
	if ( c.kind == LW_CLEARANCE_FAR ? is_near && std::isfinite( d ) : is_far && c.kind != LW_CLEARANCE_VIOLATION )
	{
		return "far is not told, or told of something near";
	}
	return "";
}

void judge( Setting& setting, const lw_range& range, const lw_clearance& c, double d, const char* part, std::size_t state )
{
	const std::string where = text( "%s of state %zu, true %.9g, interval [%.9g, %.9g]", part, state, d, c.lower, c.upper );
	const std::string wrong = refute( c, d, range );
	double observed = 0, promised = 0;
	if ( c.kind == LW_CLEARANCE_NEAR )
	{
		// lower >= (1 - alpha) upper, so no more than that below the truth either
		observed = std::max( 0.0, c.upper - c.lower - ROUNDING ) / c.upper;
		promised = range.alpha;
		const double off = std::max( 0.0, c.upper - d ) / c.upper;
		setting.off_worst = std::max( setting.off_worst, off );
		setting.off_sum += off;
		++setting.near;
	}
	if ( setting.knob == MIN_D || setting.knob == MAX_D )
	{
		const bool violation = c.kind == LW_CLEARANCE_VIOLATION;
		observed = setting.knob == MIN_D ? ( violation ? c.upper - d : 0 )
		                                 : std::abs( std::min( c.upper, range.max_d ) - std::min( d, range.max_d ) );
		promised = setting.knob == MIN_D ? range.min_d : 0;
	}
	setting.promise.observe( wrong.empty() ? std::max( 0.0, observed ) : std::nan( "" ), promised, where + "; " + wrong );
}

lw_range randomRange( std::mt19937_64& random )
{
	lw_range range;
	range.min_d = EdgeWorld::uniform( random ) < 0.3 ? 0 : std::pow( 10.0, -4 + 3 * EdgeWorld::uniform( random ) );
	range.max_d = range.min_d + std::pow( 10.0, -3 + 3 * EdgeWorld::uniform( random ) );
	range.alpha = EdgeWorld::uniform( random ) < 0.3 ? 0 : 0.95 * EdgeWorld::uniform( random );
	return range;
}

// One pass over all states, settings in turn and in a new order at each: a setting after another one finds warm caches.
void pass( const Subject& subject, const std::string& inject, bool counts, std::mt19937_64& random,
    std::vector<Setting>& all, std::vector<leeway::Query>& queries )
{
	std::vector<std::size_t> order( all.size() );
	std::iota( order.begin(), order.end(), std::size_t{ 0 } );
	for ( std::size_t i = 0; i < subject.states.size(); ++i )
	{
		for ( std::size_t k = order.size(); k-- > 1; )
		{
			std::swap( order[k], order[random() % ( k + 1 )] );
		}
		for ( const std::size_t s : order )
		{
			Setting& setting = all[s];
			const lw_range range = setting.knob == RANGE ? randomRange( random ) : setting.range;
			lw_state_result result;
			const double start = threadMicroseconds();
			const lw_status status = lw_checker_state(
			    subject.checker.get(), queries[s].get(), subject.states[i].data(), LW_CHECK_BOTH, &range, false, &result );
			setting.pass += threadMicroseconds() - start;
			leeway::require( status, "a state" );
			if ( counts )
			{
				corrupt( inject, setting, result.environment );
				corrupt( inject, setting, result.self );
				judge( setting, range, result.environment, subject.truth[i][0], "environment", i );
				judge( setting, range, result.self, subject.truth[i][1], "self", i );
			}
		}
	}
	for ( Setting& setting : all )
	{
		setting.passes.push_back( setting.pass / static_cast<double>( subject.states.size() ) );
		setting.pass = 0;
	}
}

std::vector<const Promise*> promisesOf( const std::vector<Setting>& all, Knob knob )
{
	std::vector<const Promise*> some;
	for ( const Setting& setting : all )
	{
		if ( setting.knob == knob )
		{
			some.push_back( &setting.promise );
		}
	}
	return some;
}

void addClaims( const std::vector<Setting>& all, Outcome& out )
{
	const auto alphas = promisesOf( all, ALPHA ), mins = promisesOf( all, MIN_D ), maxs = promisesOf( all, MAX_D ),
	           ranges = promisesOf( all, RANGE );
	double worst = 0;
	for ( const Promise* promise : maxs )
	{
		worst = std::max( worst, promise->worst() );
	}
	out.claims.push_back(
	    claimOf( "alpha: the interval holds the true clearance and is no wider than alpha of its upper end", alphas,
	        text( "the widest is %.1f %% of the promised width", 100 * worstShare( alphas ) ) ) );
	out.claims.push_back(
	    claimOf( "min_d: a violation is told exactly where there is one, and its distance is at most min_d", mins,
	        text( "the largest error is %.1f %% of min_d", 100 * worstShare( mins ) ) ) );
	out.claims.push_back( claimOf( "max_d: far is told exactly where it is so, and everything nearer is exact", maxs,
	    text( "the largest difference is %.2g m", worst ) ) );
	out.claims.push_back( claimOf( "all three at once, at random: as each by itself", ranges,
	    text( "the widest interval is %.1f %% of the promised width", 100 * worstShare( ranges ) ) ) );
}

void addTable( const std::vector<Setting>& all, Outcome& out )
{
	Table table{ "states", "States: observed beside promised",
	    "Observed and promised: alpha (and random ranges) the relative width of the interval; min_d metres by which the "
	    "distance reported "
	    "of a violation exceeds the true one; max_d metres by which the clearance, cut at max_d, is off. Upper too high: "
	    "the upper end "
	    "over the true clearance, of answers in the range. Each answer is one of environment or self.",
	    { { "knob", "", 0 }, { "value", "", 0 }, { "promised", "", 0 }, { "observed", "", -1 }, { "mean observed", "", -1 },
	        { "upper too high, most", "%", -1 }, { "mean", "%", -1 }, { "broken", "", -1 }, { "time a state", "us", -1 },
	        { "answers", "", 0 } },
	    {} };
	for ( const Setting& s : all )
	{
		const double mean = s.near > 0 ? s.off_sum / static_cast<double>( s.near ) : 0;
		table.rows.push_back(
		    { std::string( KNOBS[s.knob] ), s.knob == RANGE ? Cell( text( "random %g", s.value + 1 ) ) : Cell( s.value ),
		        s.promise.promised(), s.promise.worst(), s.promise.mean(), 100 * s.off_worst, 100 * mean,
		        static_cast<double>( s.promise.broken() ), measure( s.passes ), static_cast<double>( s.promise.count() ) } );
	}
	out.tables.push_back( table );
}

void addPlots( const std::vector<Setting>& all, Outcome& out )
{
	Plot alpha{ "alpha", "alpha: width of the interval",
	    "The promise is the diagonal. Right axis: time of environment and self together.", { "alpha", "", false },
	    { "width or error, relative to upper", "", false }, { "time a state", "us", false }, {}, {} };
	alpha.y.from = alpha.y2.from = 0;
	Series promised{ "promised", {}, Mark::DASHES, false }, worst{ "largest observed", {}, Mark::LINES, false },
	    mean{ "mean observed", {}, Mark::LINES, false }, off{ "upper end too high, mean", {}, Mark::LINES, false },
	    time{ "time (right)", {}, Mark::LINES, true };
	Plot cut{ "range", "min_d and max_d: time",
	    "What ends a search early: a violation found (min_d), nothing within reach (max_d).",
	    { "min_d or max_d", "m", true }, { "time a state", "us", false }, {}, {}, {} };
	cut.y.from = 0;
	Series by_min{ "min_d", {}, Mark::LINES, false }, by_max{ "max_d", {}, Mark::LINES, false };
	for ( const Setting& s : all )
	{
		const Measure t = measure( s.passes );
		const Point timed{ s.value, t.median, t.lower, t.upper };
		if ( s.knob == ALPHA )
		{
			promised.points.push_back( { s.value, s.value } );
			worst.points.push_back( { s.value, s.promise.worst() } );
			mean.points.push_back( { s.value, s.promise.mean() } );
			off.points.push_back( { s.value, s.near > 0 ? s.off_sum / static_cast<double>( s.near ) : 0 } );
			time.points.push_back( timed );
		}
		else if ( s.knob != RANGE )
		{
			( s.knob == MIN_D ? by_min : by_max ).points.push_back( timed );
		}
	}
	Point exact = time.points.front();
	Series all_of_it{ "exact", { { 0.001, exact.y }, { 1, exact.y } }, Mark::DASHES, false };
	alpha.series = { worst, promised, mean, off, time }; // the promise is drawn over the worst
	cut.series = { by_min, by_max, all_of_it };
	out.plots.push_back( alpha );
	out.plots.push_back( cut );
}

} // namespace

void addTradeStates( const ExperimentSettings& settings, const TradeSettings& trade, Progress& progress, Outcome& out )
{
	PartProgress truth( progress, 0, 0.5 ), asking( progress, 0.5, 1 );
	const Subject subject = settings.data.empty() ? randomWorlds( settings ) : kitchen( settings, truth );
	std::vector<Setting> all = allSettings( settings.quick || settings.smoke );
	std::vector<leeway::Query> queries;
	for ( std::size_t i = 0; i < all.size(); ++i )
	{
		queries.push_back( leeway::makeQuery( subject.checker.get() ) );
	}
	std::mt19937_64 random( settings.seed );
	const std::size_t passes = settings.pick( 3, 3, 1 );
	for ( std::size_t i = 0; i < passes; ++i )
	{
		asking.at( static_cast<double>( i ) / static_cast<double>( passes ), "states" );
		pass( subject, trade.inject, i == 0, random, all, queries );
	}
	addClaims( all, out );
	addTable( all, out );
	addPlots( all, out );
}
