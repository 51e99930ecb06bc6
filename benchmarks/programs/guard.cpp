// SPDX-License-Identifier: BSD-3-Clause
// A motion that runs while one object moves: the guard's answer, a proof of the rest from nothing, and states at steps of 1 cm.
//
// Panda in MotionBenchMaker's scenes, and ARMAR-III's right arm in the cluttered kitchen. Of the times of the guard the writer's part is a row of its own: it
// runs on another thread. A stop: 20 ms of reaction, then 5 rad/s^2. Exit status 1 if the guard says FREE and the whole proof BLOCKED, or the other way round.
#include "leeway/guard.h"
#include "programs/commands.hpp"
#include "support/edge_worlds.hpp"
#include "support/provenance.hpp"
#include "support/race.hpp"

#include "owned_clock.hpp"
#include "seeded_rng.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <map>

namespace
{

struct Settings
{
	std::string data = LEEWAY_DATA_DIR;
	int changes = 2000, pieces = 6;
	int cycles = 100000; ///< of a controller, with another scene in each 33rd one
	double budget = 2;
	std::uint64_t seed = 20260101;
	bool quick = false;
};

struct GuardReleaser
{
	void operator()( lw_guard* guard ) const { lw_guard_destroy( guard ); }
};

/// Of this thread on the processor: other programs on the machine would decide about the slowest hundredth.
double threadMicroseconds()
{
	timespec time = {};
	clock_gettime( CLOCK_THREAD_CPUTIME_ID, &time );
	return 1e6 * static_cast<double>( time.tv_sec ) + 1e-3 * static_cast<double>( time.tv_nsec );
}

double microseconds( const std::function<void()>& work )
{
	const double start = threadMicroseconds();
	work();
	return threadMicroseconds() - start;
}

/// Straight pieces of half a second that are free, one after the other.
OwnedClock freeMotion( const EdgeWorld& world, int pieces, SeededRng& rng )
{
	const leeway::Query query = leeway::makeQuery( world.with_tables.get() );
	const lw_edge_def def = lw_edge_def_default();
	OwnedClock clock;
	clock.rest = world.home.empty() ? world.group( world.reference ) : world.home;
	OwnedTrack track;
	std::vector<double> at = clock.rest;
	for ( std::uint32_t i = 0; i < at.size(); ++i )
	{
		track.variables.push_back( i );
	}
	for ( int tries = 0; tries < 5000 && static_cast<int>( track.pieces.size() ) < pieces; ++tries )
	{
		std::vector<double> to = at;
		for ( std::size_t i = 0; i < to.size(); ++i )
		{
			const lw_variable_info info = lw_robot_variable( world.robot.get(), world.variables[i] );
			to[i] = std::clamp( to[i] + rng.uniform( -0.4, 0.4 ), info.lower, info.upper );
		}
		lw_edge_result r;
		leeway::require( lw_checker_edge( world.with_tables.get(), query.get(), at.data(), to.data(), &def, &r ), "edge" );
		if ( r.verdict == LW_VERDICT_FREE )
		{
			const double start = 0.5 * static_cast<double>( track.pieces.size() );
			OwnedPiece piece = { start, start + 0.5, 1, at };
			piece.points.insert( piece.points.end(), to.begin(), to.end() );
			track.pieces.push_back( piece );
			at = to;
		}
	}
	clock.tracks.push_back( track );
	return clock;
}

/// The scene with one object shifted by up to 0.2 m.
leeway::Scene shifted( const lw_scene* scene, SeededRng& rng )
{
	const auto object =
	    static_cast<std::uint32_t>( rng.integer( 0, static_cast<int>( lw_scene_object_count( scene ) ) - 1 ) );
	const double by[3] = { rng.uniform( -0.2, 0.2 ), rng.uniform( -0.2, 0.2 ), rng.uniform( -0.2, 0.2 ) };
	std::vector<lw_transform> poses;
	for ( std::uint32_t k = 0; k < lw_scene_shape_count( scene ); ++k )
	{
		if ( lw_scene_shape( scene, k ).object == object )
		{
			poses.push_back( lw_scene_shape( scene, k ).world_from_shape );
			for ( int i = 0; i < 3; ++i )
			{
				poses.back().t[i] += by[i];
			}
		}
	}
	const lw_scene_change change = { LW_SCENE_MOVE, lw_scene_object_name( scene, object ), nullptr, poses.data(),
	    static_cast<std::uint32_t>( poses.size() ) };
	lw_scene* moved = nullptr;
	leeway::require( lw_scene_edit( scene, &change, 1, nullptr, nullptr, &moved ), "lw_scene_edit" );
	return leeway::Scene::adopt( moved );
}

/// The rest of the motion, by states.
bool seemsFree( const lw_checker* checker, lw_query* query, const OwnedTrack& track, double now )
{
	lw_edge_def steps = lw_edge_def_default();
	steps.method = LW_EDGE_STEPS;
	steps.max_d = 0.01;
	bool free = true;
	for ( std::size_t i = 0; i < track.pieces.size() && free; ++i )
	{
		const OwnedPiece& piece = track.pieces[i];
		if ( piece.end > now )
		{
			std::vector<double> from( track.variables.size() );
			for ( std::size_t v = 0; v < from.size(); ++v )
			{
				from[v] = track.at( v, std::max( now, piece.start ) );
			}
			lw_edge_result r;
			leeway::require(
			    lw_checker_edge( checker, query, from.data(), piece.points.data() + from.size(), &steps, &r ), "steps" );
			free = r.verdict == LW_VERDICT_FREE;
		}
	}
	return free;
}

struct Times
{
	std::map<std::string, std::vector<double>> of;
	std::size_t free = 0, blocked = 0, contradictions = 0;
	Hash hash;
};

/// Times of answers, by powers of two of a microsecond.
struct Histogram
{
	static constexpr std::size_t bins = 16;
	std::array<std::size_t, bins> count{};
	std::size_t cycles = 0, late = 0; ///< late: more than a millisecond
	double most = 0;

	void add( double us )
	{
		std::size_t bin = 0;
		for ( double edge = 1; us >= edge && bin + 1 < bins; edge *= 2 )
		{
			++bin;
		}
		++count[bin];
		++cycles;
		late += us > 1000 ? 1 : 0;
		most = std::max( most, us );
	}
};

using GuardPtr = std::unique_ptr<lw_guard, GuardReleaser>;

GuardPtr makeGuard( const lw_guard_def& def )
{
	lw_guard* made = nullptr;
	leeway::require( lw_guard_create( &def, nullptr, nullptr, &made ), "lw_guard_create" );
	return GuardPtr( made );
}

lw_guard_def guardDef( const EdgeWorld& world, const lw_clock& clock, double end )
{
	lw_guard_def def = lw_guard_def_default();
	def.checker = world.with_tables.get();
	def.clock = &clock;
	def.end = end;
	def.microseconds = []( void* ) { return threadMicroseconds(); };
	return def;
}

/// The checker of another scene.
leeway::Checker edited( const lw_checker* checker, const lw_scene* scene )
{
	lw_checker_edit_def edit = lw_checker_edit_def_default();
	edit.scene = scene;
	lw_checker* made = nullptr;
	leeway::require( lw_checker_edit( checker, &edit, nullptr, nullptr, &made ), "lw_checker_edit" );
	return leeway::Checker::adopt( made );
}

/// A controller at 1 kHz, which drives the motion again and again, and gives each answer at most half a millisecond; a camera at 30 Hz.
void cycle( const EdgeWorld& world, const Settings& settings, int cycles, SeededRng& rng, Histogram& histogram )
{
	OwnedClock clock = freeMotion( world, settings.pieces, rng );
	if ( clock.tracks[0].pieces.empty() )
	{
		return;
	}
	const lw_clock view = clock.view();
	const double end = clock.tracks[0].pieces.back().end;
	lw_guard_def def = guardDef( world, view, end );
	def.window = 0.25;
	const GuardPtr guard = makeGuard( def );
	constexpr int camera = 33;
	for ( int i = 0; i < cycles; ++i )
	{
		if ( i % camera == 0 )
		{
			const leeway::Checker now = edited( world.with_tables.get(), shifted( world.scene.get(), rng ).get() );
			leeway::require(
			    lw_guard_publish( guard.get(), now.get(), static_cast<std::uint64_t>( i + 1 ), nullptr ), "publish" );
		}
		lw_guard_answer answer;
		const double time = std::fmod( 1e-3 * i, end );
		histogram.add(
		    microseconds( [&] { leeway::require( lw_guard_ask( guard.get(), time, 500, &answer ), "lw_guard_ask" ); } ) );
	}
}

void drive( const EdgeWorld& world, const Settings& settings, int changes, SeededRng& rng, Times& times )
{
	OwnedClock clock = freeMotion( world, settings.pieces, rng );
	if ( clock.tracks[0].pieces.empty() )
	{
		return;
	}
	const lw_clock view = clock.view();
	const double end = clock.tracks[0].pieces.back().end;
	lw_guard_def def = guardDef( world, view, end );
	const std::vector<double> deceleration( clock.tracks[0].variables.size(), 5 );
	def.braking = 0;
	def.deceleration = deceleration.data();
	def.reaction = 0.02;
	const GuardPtr guard = makeGuard( def );
	const leeway::Query query = leeway::makeQuery( world.with_tables.get() );
	lw_guard_answer answer;
	leeway::require( lw_guard_ask( guard.get(), 0, INFINITY, &answer ), "lw_guard_ask" );
	leeway::Checker now = world.with_tables;
	for ( int i = 1; i <= changes; ++i )
	{
		const leeway::Scene scene = shifted( world.scene.get(), rng );
		const double from = rng.uniform( 0, 0.5 * end );
		times.of["publish (writer)"].push_back( microseconds(
		    [&]
		    {
			    now = edited( now.get(), scene.get() );
			    leeway::require(
			        lw_guard_publish( guard.get(), now.get(), static_cast<std::uint64_t>( i ), nullptr ), "publish" );
		    } ) );
		times.of["guard"].push_back( microseconds(
		    [&] { leeway::require( lw_guard_ask( guard.get(), from, INFINITY, &answer ), "lw_guard_ask" ); } ) );
		lw_guard_answer stop;
		times.of["a stop"].push_back(
		    microseconds( [&] { leeway::require( lw_guard_stop( guard.get(), from, &stop ), "lw_guard_stop" ); } ) );
		if ( answer.verdict != LW_VERDICT_FREE )
		{
			double latest = 0;
			times.of["latest order to stop"].push_back( microseconds(
			    [&] {
				    leeway::require(
				        lw_guard_brake_by( guard.get(), from, answer.proved_until, 0.02, &latest ), "lw_guard_brake_by" );
			    } ) );
		}
		const leeway::Checker owner = edited( world.with_tables.get(), scene.get() );
		const lw_checker* full = owner.get();
		lw_timed_result whole;
		times.of["whole proof"].push_back( microseconds( [&]
		    { leeway::require( lw_checker_timed( full, query.get(), &view, from, end, &def.timed, &whole ), "timed" ); } ) );
		times.of["states at 1 cm"].push_back(
		    microseconds( [&] { times.hash.add( seemsFree( full, query.get(), clock.tracks[0], from ) ); } ) );
		times.free += answer.verdict == LW_VERDICT_FREE;
		times.blocked += answer.verdict == LW_VERDICT_BLOCKED;
		times.contradictions += ( answer.verdict == LW_VERDICT_FREE && whole.verdict == LW_VERDICT_BLOCKED ) ||
		                        ( answer.verdict == LW_VERDICT_BLOCKED && whole.verdict == LW_VERDICT_FREE );
		times.hash.add( answer.verdict == LW_VERDICT_BLOCKED );
	}
}

void report( const std::string& name, const Times& times, Result& result )
{
	std::printf(
	    "%s: %zu free, %zu blocked, %zu contradictions\n", name.c_str(), times.free, times.blocked, times.contradictions );
	for ( const auto& [what, values] : times.of )
	{
		std::vector<double> sorted = values;
		std::sort( sorted.begin(), sorted.end() );
		const double p99 = sorted[sorted.size() - 1 - sorted.size() / 100];
		const Summary s = summarise( values );
		std::printf( "  %-18s us: median %8.1f, 99 %% %8.1f, most %8.1f\n", what.c_str(), s.median, p99, sorted.back() );
		Json row = { { "world", name }, { "what", what }, { "p99_us", rounded( p99 ) },
		    { "most_us", rounded( sorted.back() ) }, { "answers_hash", times.hash.text() } };
		row.update( toJson( s ) );
		result.add( std::move( row ) );
	}
}

void report( const std::string& name, const Histogram& histogram, Result& result )
{
	std::printf( "%s: %zu cycles, %zu above 1 ms, %.1f us at most; us:", name.c_str(), histogram.cycles, histogram.late,
	    histogram.most );
	Json counts = Json::array();
	for ( std::size_t i = 0; i < Histogram::bins; ++i )
	{
		counts.push_back( histogram.count[i] );
		std::printf( histogram.count[i] > 0 ? " <%zu: %zu" : "", std::size_t{ 1 } << i, histogram.count[i] );
	}
	std::printf( "\n" );
	result.add( { { "world", name }, { "what", "cycles" }, { "cycles", histogram.cycles }, { "above_1_ms", histogram.late },
	    { "most_us", rounded( histogram.most ) }, { "below_powers_of_two_us", counts } } );
}

int run( const Settings& settings, Result& result )
{
	lw_reach_def reach = lw_reach_def_default();
	reach.seconds = settings.budget;
	EdgeWorlds worlds( settings.data, reach );
	worlds.addMbm( "panda", "panda_arm", { 1, 2, 3 } );
	const std::size_t pandas = worlds.size();
	worlds.addArmar( "right_arm", { 1, 2 } );
	std::map<std::string, Times> times;
	std::map<std::string, Histogram> histograms;
	SeededRng rng{ std::mt19937_64( settings.seed ) };
	const int changes = settings.quick ? 20 : settings.changes / static_cast<int>( pandas ) + 1;
	for ( std::size_t i = 0; i < worlds.size(); ++i )
	{
		const std::string name = i < pandas ? "Panda" : "ARMAR-III, kitchen";
		drive( worlds.world( i ), settings, changes, rng, times[name] );
		cycle( worlds.world( i ), settings,
		    ( settings.quick ? 2000 : settings.cycles ) / static_cast<int>( worlds.size() ) + 1, rng, histograms[name] );
	}
	std::size_t contradictions = 0;
	for ( const auto& [name, of] : times )
	{
		report( name, of, result );
		report( name, histograms[name], result );
		contradictions += of.contradictions;
	}
	return contradictions == 0 ? 0 : 1;
}

} // namespace

void addGuard( Bench& bench )
{
	const auto s = std::make_shared<Settings>();
	Command& command =
	    bench.command( "guard", "a motion that runs while objects move: the guard, whole proofs, states at steps" );
	command.option( "--data", s->data, "folder with mbm, armar3 and kit_kitchen" );
	command.option( "--changes", s->changes, "scenes of each robot", { 1, 10000000 } );
	command.option( "--cycles", s->cycles, "of a controller, another scene in each 33rd one", { 1, 1000000000 } );
	command.option( "--pieces", s->pieces, "of the motion, half a second each", { 1, 1000 } );
	command.option( "--budget", s->budget, "seconds of proofs for pair tables", { 0 } );
	command.option( "--seed", s->seed, "of motions and scenes" );
	command.flag( "--quick", s->quick, "twenty scenes a world" );
	command.work(
	    [s]( Result& result )
	    {
		    requireData( s->data, "mbm" );
		    return run( *s, result );
	    } );
}
