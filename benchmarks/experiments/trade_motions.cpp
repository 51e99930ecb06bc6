// SPDX-License-Identifier: BSD-3-Clause
// Motions that certificates refuse because of slack and alpha, and contacts that fixed steps miss: see trade.hpp.
//
// Truth is a dense look along the whole motion (edge_auditor.hpp). Promises (checker.h, edges.md), at a margin of 0:
//   certified, FREE     no contact anywhere, and every clearance is at least lower_bound
//   certified, BLOCKED  the named pair is in contact at t
//   certified, UNDECIDED  the named pair has at most slack / (1 - alpha) at t
//   steps of h, min_d h FREE: no contact; of the clearances between two steps none is below min_d - h / 2 (obstacles) or
//   min_d - h (links)
// Steps of h without a margin promise nothing between two of them: the contacts that they miss are counted.
#include "experiments/trade.hpp"

#include "support/edge_worlds.hpp"

#include "edge_auditor.hpp"

#include <cmath>

namespace
{

constexpr double ROUNDING = 1e-9; // metres

enum Knob
{
	SLACK,
	ALPHA,
	STEPS,       // without a margin
	STEPS_MARGIN // min_d is the step
};
const char* const KNOBS[] = { "slack", "alpha", "steps", "steps with margin" };

struct Setting
{
	Knob knob;
	double value;
	lw_edge_def def;
	Promise promise{ ROUNDING };   // metres
	std::size_t missed = 0;        // contact, called free
	std::size_t turned_down = 0;   // free, not called so
	std::size_t free = 0, all = 0; // called free
	std::vector<double> times;     // microseconds, of each motion
};

// Metres. For certificates: the clearance above which none refuses a motion. For steps: their margin, min_d.
double band( const Setting& setting )
{
	return setting.def.method == LW_EDGE_STEPS ? setting.def.min_d
	                                           : ( setting.def.min_d + setting.def.slack ) / ( 1 - setting.def.alpha );
}

std::vector<Setting> allSettings( bool short_run )
{
	std::vector<Setting> all;
	const auto add = [&all]( Knob knob, double value, const auto& change )
	{
		lw_edge_def def = lw_edge_def_default();
		change( def );
		all.push_back( { knob, value, def, Promise( ROUNDING ), 0, 0, 0, 0, {} } );
	};
	for ( const double slack : { 0.0001, 0.0003, 0.001, 0.003, 0.01, 0.03 } )
	{
		add( SLACK, slack, [=]( lw_edge_def& def ) { def.slack = slack; } );
	}
	for ( const double alpha : { 0.0, 0.1, 0.3, 0.6 } )
	{
		add( ALPHA, alpha, [=]( lw_edge_def& def ) { def.alpha = alpha; } );
	}
	for ( const Knob knob : { STEPS, STEPS_MARGIN } )
	{
		for ( const double step : { 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2 } )
		{
			if ( step > 0.002 || !short_run )
			{
				add( knob, step,
				    [=]( lw_edge_def& def )
				    {
					    def.method = LW_EDGE_STEPS;
					    def.max_d = step;
					    def.min_d = knob == STEPS_MARGIN ? step : 0;
				    } );
			}
		}
	}
	return all;
}

// A world with an auditor, who measures its truth, and the queries of all settings.
struct Seat
{
	const EdgeWorld& world;
	EdgeAuditor auditor;
	std::vector<leeway::Query> queries; // one for each setting: no setting profits from another's memory
	leeway::Query spare;

	Seat( const EdgeWorld& of, std::size_t settings )
	    : world( of ), auditor( of.robot.get(), of.scene.get(), of.variables, of.reference.data(), of.allowed ),
	      spare( leeway::makeQuery( of.checker.get() ) )
	{
		for ( std::size_t i = 0; i < settings; ++i )
		{
			queries.push_back( leeway::makeQuery( of.with_tables.get() ) );
		}
	}
};

Motion makeUpMotion( Seat& seat, std::mt19937_64& random )
{
	static const double lengths[] = { 0.1, 0.5, 2 };
	if ( !seat.world.home.empty() && random() % 4 == 0 )
	{
		return { seat.world.randomState( random ), seat.world.randomState( random ) };
	}
	const bool near = random() % 2 == 0;
	return seat.world.randomMotion( near, lengths[random() % 3], random, seat.spare.get() );
}

class Judge
{
public:
	Judge( Seat& seat, const Motion& motion, std::string name, std::string inject )
	    : m_seat( seat ), m_motion( motion ), m_name( std::move( name ) ), m_inject( std::move( inject ) )
	{
		const std::vector<double> from = seat.world.full( motion.from ), to = seat.world.full( motion.to );
		m_look = seat.auditor.look( from.data(), to.data() );
	}

	bool collides() const { return m_look.contact; }

	void ask( Setting& setting, lw_query* query )
	{
		lw_edge_result r;
		const double start = threadMicroseconds();
		const lw_status status = lw_checker_edge(
		    m_seat.world.with_tables.get(), query, m_motion.from.data(), m_motion.to.data(), &setting.def, &r );
		setting.times.push_back( threadMicroseconds() - start );
		leeway::require( status, "a motion" );
		const bool injected = corrupt( setting, r );
		++setting.all;
		setting.free += r.verdict == LW_VERDICT_FREE;
		setting.missed += r.verdict == LW_VERDICT_FREE && m_look.contact;
		setting.turned_down += r.verdict != LW_VERDICT_FREE && !m_look.contact;
		if ( r.verdict == LW_VERDICT_FREE )
		{
			called_free( setting, r );
		}
		else
		{
			turned_down( setting, r, injected );
		}
	}

private:
	// An error of the kind that a fault would make. @return true if there is one now
	bool corrupt( const Setting& setting, lw_edge_result& r ) const
	{
		const bool certified = setting.def.method == LW_EDGE_CERTIFIED;
		if ( r.verdict == LW_VERDICT_BLOCKED &&
		     ( ( m_inject == "certified" && certified ) || ( m_inject == "steps" && setting.knob == STEPS_MARGIN ) ) )
		{
			r.verdict = LW_VERDICT_FREE;
			return true;
		}
		if ( m_inject == "slack" && setting.knob == SLACK && r.verdict == LW_VERDICT_FREE )
		{
			r.verdict = LW_VERDICT_UNDECIDED;
			return true;
		}
		return false;
	}

	// Observes the shortfall of the least clearance that the look found below the promised one; contact is below every
	// promise.
	void called_free( Setting& setting, const lw_edge_result& r )
	{
		const std::string where = m_name + text( ", FREE; least %.9g m at t = %.17g", m_look.least, m_look.t );
		const double least = m_look.contact ? 0 : m_look.least;
		if ( setting.def.method == LW_EDGE_CERTIFIED )
		{
			// In contact, even a bound of nothing is not kept
			setting.promise.observe( m_look.contact ? std::nan( "" ) : std::max( 0.0, r.lower_bound - least ), 0, where );
		}
		else if ( setting.knob == STEPS_MARGIN )
		{
			const double most = m_look.self ? setting.value : setting.value / 2;
			setting.promise.observe(
			    m_look.contact ? std::nan( "" ) : std::max( 0.0, setting.def.min_d - least ), most, where );
		}
	}

	// The clearance at which a motion was turned down. Without injection that of the named pair, at t.
	void turned_down( Setting& setting, const lw_edge_result& r, bool injected )
	{
		const std::vector<double> state = m_seat.world.full( m_seat.world.at( m_motion, r.t ) );
		const double d = injected ? m_look.least : m_seat.auditor.clearance( state.data(), r.self, r.pair.a, r.pair.b );
		const bool undecided = r.verdict == LW_VERDICT_UNDECIDED;
		const double most = undecided ? band( setting ) : setting.def.min_d;
		setting.promise.observe(
		    std::max( 0.0, d ), most, m_name + text( ", %s at t = %.17g", lw_verdict_name( r.verdict ), r.t ) );
	}

	Seat& m_seat;
	const Motion& m_motion;
	const std::string m_name, m_inject;
	EdgeAuditor::Look m_look;
};

struct Totals
{
	std::size_t motions = 0, colliding = 0;
};

double share( std::size_t part, std::size_t whole )
{
	return whole > 0 ? 100.0 * static_cast<double>( part ) / static_cast<double>( whole ) : 0;
}

double meanOf( const std::vector<double>& values )
{
	return values.empty() ? 0 : std::accumulate( values.begin(), values.end(), 0.0 ) / static_cast<double>( values.size() );
}

void addTable( const std::vector<Setting>& all, const Totals& totals, Outcome& out )
{
	Table table{ "motions", "Motions: certified against fixed steps",
	    text(
	        "%zu motions, %zu of them collide. Missed: colliding motions called free. Turned down: free motions not called "
	        "free. Promised and observed, in metres: certified, the clearance at which a motion is turned down; steps with "
	        "their length as margin, the same, and by how much the clearance between two steps falls below the margin.",
	        totals.motions, totals.colliding ),
	    { { "knob", "", 0 }, { "value", "", 0 }, { "promised", "m", 0 }, { "observed", "m", -1 }, { "broken", "", -1 },
	        { "missed", "", -1 }, { "missed", "% of colliding", -1 }, { "turned down", "", -1 },
	        { "turned down", "% of free", -1 }, { "time a motion", "us", -1 } },
	    {} };
	for ( const Setting& s : all )
	{
		const bool promises = s.knob != STEPS;
		table.rows.push_back( { std::string( KNOBS[s.knob] ), s.value, promises ? Cell( band( s ) ) : Cell( "none" ),
		    promises ? Cell( s.promise.worst() ) : Cell( "none" ), static_cast<double>( s.promise.broken() ),
		    static_cast<double>( s.missed ), share( s.missed, totals.colliding ), static_cast<double>( s.turned_down ),
		    share( s.turned_down, totals.motions - totals.colliding ), meanOf( s.times ) } );
	}
	out.tables.push_back( table );
}

void addPlots( const std::vector<Setting>& all, const Totals& totals, Outcome& out )
{
	Plot missed{ "missed", "Fixed steps: missed collisions, and free motions lost",
	    "Missed: of motions that collide; turned down: of free ones. Without a margin steps miss collisions; with their "
	    "length as margin they miss none and turn free motions down. "
	    "Certified "
	    "motions (slack 1 mm) do neither, but for what is within the slack.",
	    { "step", "m", true }, { "share of motions", "%", false }, {}, {}, {} };
	missed.y.from = 0;
	Plot time{ "steps-time", "Fixed steps against certified: time", "Mean processor time of a motion, all of them.",
	    { "step", "m", true }, { "time a motion", "us", true }, {}, {}, {} };
	Plot slack{ "slack", "slack: what is turned down", "The promise is slack / (1 - alpha) with alpha 0.1.",
	    { "slack", "m", true }, { "clearance when turned down", "m", true }, { "time a motion", "us", false }, {}, {} };
	slack.y2.from = 0;
	Series miss{ "missed, no margin", {}, Mark::LINES, false }, lost{ "turned down, margin = step", {}, Mark::LINES, false },
	    certified_miss{ "missed, certified", {}, Mark::DASHES, false },
	    certified_lost{ "turned down, certified", {}, Mark::DASHES, false },
	    plain{ "steps, no margin", {}, Mark::LINES, false }, margin{ "steps, margin = step", {}, Mark::LINES, false },
	    proof{ "certified, slack 1 mm", {}, Mark::DASHES, false }, promised{ "promised", {}, Mark::DASHES, false },
	    observed{ "largest observed", {}, Mark::LINES, false }, slack_time{ "time (right)", {}, Mark::LINES, true };
	const std::size_t free = totals.motions - totals.colliding;
	double low = 1, high = 0;
	for ( const Setting& s : all )
	{
		if ( s.knob == STEPS )
		{
			miss.points.push_back( { s.value, share( s.missed, totals.colliding ) } );
			plain.points.push_back( { s.value, meanOf( s.times ) } );
			low = std::min( low, s.value );
			high = std::max( high, s.value );
		}
		else if ( s.knob == STEPS_MARGIN )
		{
			lost.points.push_back( { s.value, share( s.turned_down, free ) } );
			margin.points.push_back( { s.value, meanOf( s.times ) } );
		}
		else if ( s.knob == SLACK )
		{
			promised.points.push_back( { s.value, band( s ) } );
			if ( s.promise.worst() > 0 ) // the axis has no place for nothing
			{
				observed.points.push_back( { s.value, s.promise.worst() } );
			}
			slack_time.points.push_back( { s.value, meanOf( s.times ) } );
		}
	}
	for ( const Setting& s : all )
	{
		if ( s.knob == SLACK && s.value == 0.001 )
		{
			for ( const double x : { low, high } )
			{
				certified_miss.points.push_back( { x, share( s.missed, totals.colliding ) } );
				certified_lost.points.push_back( { x, share( s.turned_down, free ) } );
				proof.points.push_back( { x, meanOf( s.times ) } );
			}
		}
	}
	missed.series = { miss, lost, certified_miss, certified_lost };
	time.series = { plain, margin, proof };
	slack.series = { promised, slack_time };
	if ( !observed.points.empty() )
	{
		slack.series.insert( slack.series.begin() + 1, observed );
	}
	out.plots.insert( out.plots.end(), { missed, time, slack } );
}

// The promises of some knobs.
std::vector<const Promise*> promisesOf( const std::vector<Setting>& all, std::initializer_list<Knob> knobs )
{
	std::vector<const Promise*> some;
	for ( const Setting& s : all )
	{
		if ( std::find( knobs.begin(), knobs.end(), s.knob ) != knobs.end() )
		{
			some.push_back( &s.promise );
		}
	}
	return some;
}

void addClaims( const std::vector<Setting>& all, const Totals& totals, Outcome& out )
{
	std::size_t certified = 0, with_margin = 0, least = SIZE_MAX, most = 0;
	for ( const Setting& s : all )
	{
		certified += s.knob == SLACK || s.knob == ALPHA ? s.missed : 0;
		with_margin += s.knob == STEPS_MARGIN ? s.missed : 0;
		least = s.knob == STEPS ? std::min( least, s.missed ) : least;
		most = s.knob == STEPS ? std::max( most, s.missed ) : most;
	}
	out.claims.push_back( claimOf( "certified: FREE is free, with at least the clearance said; what is turned down has no "
	                               "more than (min_d + slack) / (1 - alpha)",
	    promisesOf( all, { SLACK, ALPHA } ),
	    text(
	        "%zu of %zu collisions missed in %d settings; the largest clearance of an undecided verdict is %.1f %% of the promise",
	        certified, totals.colliding, 10, 100 * worstShare( promisesOf( all, { SLACK, ALPHA } ) ) ) ) );
	out.claims.push_back( claimOf(
	    "steps with their length as margin miss no collision, and clearance between two falls by no more than promised",
	    promisesOf( all, { STEPS_MARGIN } ), text( "%zu of %zu collisions missed", with_margin, totals.colliding ) ) );
	Claim claim{ "promise", "steps without a margin prove nothing between two of them", "", Verdict::HOLDS, "" };
	claim.figure = text( "%zu to %zu of %zu colliding motions are called free, by the shortest to the longest steps", least,
	    most, totals.colliding );
	claim.verdict = most > 0 ? Verdict::HOLDS : Verdict::DIFFERS;
	claim.why = most > 0 ? "" : "too few motions of this run collide for so short a time that steps could miss it";
	out.claims.push_back( claim );
}

void addWorlds( const ExperimentSettings& settings, EdgeWorlds& worlds )
{
	if ( settings.data.empty() )
	{
		worlds.addRandom( settings.seed, 3 );
		return;
	}
	worlds.addArmar( "torso_right_arm", settings.quick ? std::vector<int>{ 5, 10 } : std::vector<int>{} );
	if ( !settings.smoke )
	{
		worlds.addMbm( "fetch", "arm_with_torso", { 1 } );
	}
	worlds.addRandom( settings.seed, settings.pick( 40, 5, 2 ) );
}

} // namespace

void addTradeMotions( const ExperimentSettings& settings, const TradeSettings& trade, Progress& progress, Outcome& out )
{
	progress.at( 0, "worlds of motions" );
	lw_reach_def reach = lw_reach_def_default();
	reach.seconds = settings.quick || settings.smoke ? std::min( settings.budget, 0.2 ) : settings.budget;
	reach.hulls_only = settings.quick || settings.smoke;
	reach.hull_error = settings.smoke ? 0.1 : reach.hull_error;
	EdgeWorlds worlds( settings.data, reach );
	addWorlds( settings, worlds );
	std::vector<Setting> all = allSettings( settings.quick || settings.smoke );
	std::vector<std::unique_ptr<Seat>> seats( worlds.size() );
	std::mt19937_64 random( settings.seed );
	Totals totals;
	totals.motions = settings.pick( 1500, 120, 24 );
	for ( std::size_t i = 0; i < totals.motions; ++i )
	{
		std::unique_ptr<Seat>& seat = seats[i % seats.size()];
		if ( !seat )
		{
			seat = std::make_unique<Seat>( worlds.world( i % seats.size() ), all.size() );
		}
		const Motion motion = makeUpMotion( *seat, random );
		Judge judge( *seat, motion, seat->world.name + text( ", motion %zu", i ), trade.inject );
		totals.colliding += judge.collides();
		for ( std::size_t k = 0; k < all.size(); ++k ) // in turn, from a new one each time
		{
			const std::size_t s = ( i + k ) % all.size();
			judge.ask( all[s], seat->queries[s].get() );
		}
		progress.at( static_cast<double>( i + 1 ) / static_cast<double>( totals.motions ), "motions" );
	}
	addClaims( all, totals, out );
	addTable( all, totals, out );
	addPlots( all, totals, out );
}
