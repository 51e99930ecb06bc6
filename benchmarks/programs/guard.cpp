// SPDX-License-Identifier: BSD-3-Clause
// A motion that runs while one object moves: the guard's answer, a proof of the rest from nothing, and states at steps of 1 cm.
//
// Panda in MotionBenchMaker's scenes, and ARMAR-III's right arm in the cluttered kitchen; robots of the zoo in generated scenes, and random ones. Of the times
// of the guard the writer's part is a row of its own: it runs on another thread. A stop: 20 ms of reaction, then 5 rad/s^2. FCL looks at the
// same states as "states at 1 cm", for the answers that are judged and where the motion seems free. Exit status 1 if the guard says FREE
// and the whole proof BLOCKED, or the other way round, or if a judge that knows neither finds a contact in a part that an answer calls proved.
#include "leeway/guard.h"
#include "peers/fcl_peer.hpp"
#include "planning/generated_problems.hpp"
#include "programs/commands.hpp"
#include "support/edge_worlds.hpp"
#include "support/running_motion.hpp"
#include "support/provenance.hpp"
#include "support/race.hpp"
#include "support/temporary_folder.hpp"

#include "edge_auditor.hpp"
#include "seeded_rng.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <map>

namespace
{

struct Settings
{
	std::string data = LEEWAY_DATA_DIR, zoo;
	std::size_t random_robots = 0;
	int changes = 2000, pieces = 6;
	double judged = 0.02; ///< share of the answers
	int cycles = 100000;  ///< of a controller, with another scene in each 33rd one
	double budget = 2;
	std::uint64_t seed = 20260101;
	bool quick = false;
};

/// Where a random body of the robot will be at a random time.
lw_vec3 placeOfABody( const EdgeWorld& world, const OwnedTrack& track, SeededRng& rng )
{
	std::vector<double> q;
	const double time = rng.uniform( 0, track.pieces.back().end );
	for ( std::size_t v = 0; v < track.variables.size(); ++v )
	{
		q.push_back( track.at( v, time ) );
	}
	std::vector<lw_transform> links( lw_robot_link_count( world.robot.get() ) );
	leeway::require( lw_robot_fk( world.robot.get(), world.full( q ).data(), links.data() ), "lw_robot_fk" );
	const auto body =
	    static_cast<std::uint32_t>( rng.integer( 0, static_cast<int>( lw_robot_body_count( world.robot.get() ) ) - 1 ) );
	const double* at = links[lw_robot_body( world.robot.get(), body ).link].t;
	return { at[0], at[1], at[2] };
}

/// The scene with one object shifted by up to 0.2 m; every fourth time it comes into the robot's way.
leeway::Scene shifted( const EdgeWorld& world, const OwnedTrack& track, SeededRng& rng )
{
	const lw_scene* scene = world.scene.get();
	const auto object =
	    static_cast<std::uint32_t>( rng.integer( 0, static_cast<int>( lw_scene_object_count( scene ) ) - 1 ) );
	double by[3] = { rng.uniform( -0.2, 0.2 ), rng.uniform( -0.2, 0.2 ), rng.uniform( -0.2, 0.2 ) };
	bool in_the_way = rng.integer( 0, 3 ) == 0;
	std::vector<lw_transform> poses;
	for ( std::uint32_t k = 0; k < lw_scene_shape_count( scene ); ++k )
	{
		if ( lw_scene_shape( scene, k ).object == object )
		{
			poses.push_back( lw_scene_shape( scene, k ).world_from_shape );
			if ( in_the_way )
			{
				const lw_vec3 there = placeOfABody( world, track, rng );
				const double* here = poses.back().t;
				by[0] += there.x - here[0];
				by[1] += there.y - here[1];
				by[2] += there.z - here[2];
				in_the_way = false;
			}
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

/// The straight pieces of a part of the motion.
std::vector<Motion> piecesOf( const OwnedTrack& track, double begin, double end )
{
	std::vector<Motion> pieces;
	for ( const OwnedPiece& piece : track.pieces )
	{
		const double from = std::max( begin, piece.start ), to = std::min( end, piece.end );
		if ( from < to )
		{
			pieces.emplace_back();
			for ( std::size_t v = 0; v < track.variables.size(); ++v )
			{
				pieces.back().from.push_back( track.at( v, from ) );
				pieces.back().to.push_back( track.at( v, to ) );
			}
		}
	}
	return pieces;
}

/// Pieces by states. @param states [out] of each piece that was looked at
bool seemsFree(
    const lw_checker* checker, lw_query* query, const std::vector<Motion>& pieces, std::vector<std::uint32_t>& states )
{
	lw_edge_def steps = lw_edge_def_default();
	steps.method = LW_EDGE_STEPS;
	steps.max_d = 0.01;
	states.clear();
	for ( const Motion& piece : pieces )
	{
		lw_edge_result r;
		leeway::require( lw_checker_edge( checker, query, piece.from.data(), piece.to.data(), &steps, &r ), "steps" );
		states.push_back( r.queries );
		if ( r.verdict != LW_VERDICT_FREE )
		{
			return false;
		}
	}
	return true;
}

/// Is a contact in pieces that an answer calls proved? Brute force over all pairs.
bool isRefuted( const EdgeWorld& world, const lw_scene* scene, const std::vector<Motion>& pieces )
{
	EdgeAuditor auditor( world.robot.get(), scene, world.variables, world.reference.data(), world.allowed );
	return std::any_of( pieces.begin(), pieces.end(),
	    [&]( const Motion& piece )
	    {
		    // the end of the proof itself may be the contact
		    return auditor.look( world.full( piece.from ).data(), world.full( piece.to ).data(), 0, 1 - 1e-9 ).contact;
	    } );
}

/// Microseconds of FCL at as many states of each piece.
double byFcl( FclPeer& fcl, const std::vector<Motion>& pieces, const std::vector<std::uint32_t>& states )
{
	return microseconds(
	    [&]
	    {
		    for ( std::size_t k = 0; k < pieces.size(); ++k )
		    {
			    fcl.isFreeAtStates( pieces[k].from, pieces[k].to, states[k] );
		    }
	    } );
}

struct Times
{
	std::map<std::string, std::vector<double>> of;
	std::size_t free = 0, blocked = 0, contradictions = 0, judged = 0, refuted = 0;
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

lw_guard_def guardDef( const EdgeWorld& world, const lw_clock& clock, double end )
{
	lw_guard_def def = lw_guard_def_default();
	def.checker = world.with_tables.get();
	def.clock = &clock;
	def.end = end;
	def.microseconds = []( void* ) { return threadMicroseconds(); };
	return def;
}

/// A controller at 1 kHz, which drives the motion again and again, and gives each answer at most half a millisecond; a camera at 30 Hz.
void cycle( const EdgeWorld& world, const Settings& settings, int cycles, SeededRng& rng, Histogram& histogram )
{
	OwnedClock clock = freeMotion( world, world.with_tables.get(), settings.pieces, rng );
	if ( clock.tracks[0].pieces.empty() )
	{
		return;
	}
	const lw_clock view = clock.view();
	const double end = clock.tracks[0].pieces.back().end;
	lw_guard_def def = guardDef( world, view, end );
	def.window = 0.25;
	const leeway::GuardHandle guard = makeGuard( def );
	constexpr int camera = 33;
	for ( int i = 0; i < cycles; ++i )
	{
		if ( i % camera == 0 )
		{
			const leeway::Checker now = edited( world.with_tables.get(), shifted( world, clock.tracks[0], rng ).get() );
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
	OwnedClock clock = freeMotion( world, world.with_tables.get(), settings.pieces, rng );
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
	const leeway::GuardHandle guard = makeGuard( def );
	const leeway::Query query = leeway::makeQuery( world.with_tables.get() );
	lw_guard_answer answer;
	leeway::require( lw_guard_ask( guard.get(), 0, INFINITY, &answer ), "lw_guard_ask" );
	leeway::Checker now = world.with_tables;
	const auto models = std::make_shared<FclModels>();
	for ( int i = 1; i <= changes; ++i )
	{
		const leeway::Scene scene = shifted( world, clock.tracks[0], rng );
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
		times.of["a stop"].push_back( microseconds(
		    [&] { leeway::require( lw_guard_stop( guard.get(), from, INFINITY, &stop ), "lw_guard_stop" ); } ) );
		if ( answer.verdict != LW_VERDICT_FREE )
		{
			double latest = 0;
			times.of["latest order to stop"].push_back( microseconds(
			    [&]
			    {
				    leeway::require( lw_guard_brake_by( guard.get(), from, answer.proved_until, 0.02, INFINITY, &latest ),
				        "lw_guard_brake_by" );
			    } ) );
		}
		const leeway::Checker owner = edited( world.with_tables.get(), scene.get() );
		const lw_checker* full = owner.get();
		lw_timed_result whole;
		times.of["whole proof"].push_back( microseconds( [&]
		    { leeway::require( lw_checker_timed( full, query.get(), &view, from, end, &def.timed, &whole ), "timed" ); } ) );
		const std::vector<Motion> rest = piecesOf( clock.tracks[0], from, end );
		std::vector<std::uint32_t> states;
		bool seems_free = false;
		times.of["states at 1 cm"].push_back(
		    microseconds( [&] { seems_free = seemsFree( full, query.get(), rest, states ); } ) );
		times.hash.add( seems_free );
		times.free += answer.verdict == LW_VERDICT_FREE;
		times.blocked += answer.verdict == LW_VERDICT_BLOCKED;
		times.contradictions += ( answer.verdict == LW_VERDICT_FREE && whole.verdict == LW_VERDICT_BLOCKED ) ||
		                        ( answer.verdict == LW_VERDICT_BLOCKED && whole.verdict == LW_VERDICT_FREE );
		times.hash.add( answer.verdict == LW_VERDICT_BLOCKED );
		if ( rng.uniform( 0, 1 ) < settings.judged && answer.proved_until > from )
		{
			++times.judged;
			times.refuted += isRefuted( world, scene.get(), piecesOf( clock.tracks[0], from, answer.proved_until ) );
			if ( seems_free )
			{
				FclPeer fcl( full, models, world.allowed );
				times.of["FCL at those, if free"].push_back( byFcl( fcl, rest, states ) );
			}
		}
	}
}

void report( const std::string& name, const Times& times, Result& result )
{
	std::printf( "%s: %zu free, %zu blocked, %zu contradictions; %zu judged, %zu refuted\n", name.c_str(), times.free,
	    times.blocked, times.contradictions, times.judged, times.refuted );
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

Subjects subjectsOf( const Settings& settings, const std::string& folder )
{
	Subjects subjects = {
	    { "Panda",
	        []( EdgeWorlds& worlds ) {
		        worlds.addMbm( "panda", "panda_arm", { 1, 2, 3 } );
	        } },
	    { "ARMAR-III, kitchen",
	        []( EdgeWorlds& worlds ) {
		        worlds.addArmar( "right_arm", { 1, 2 } );
	        } },
	};
	addUntuned( subjects, settings.zoo, "", settings.random_robots, settings.seed, folder );
	return subjects;
}

int run( const Settings& settings, Result& result )
{
	lw_reach_def reach = lw_reach_def_default();
	reach.seconds = settings.budget;
	const TemporaryFolder temporary;
	const Subjects subjects = subjectsOf( settings, temporary.path().string() );
	SeededRng rng{ std::mt19937_64( settings.seed ) };
	std::size_t wrong = 0;
	for ( const auto& [name, add] : subjects )
	{
		EdgeWorlds worlds( settings.data, reach );
		add( worlds );
		Times times;
		Histogram histogram;
		const int count = static_cast<int>( worlds.size() );
		const int changes = settings.quick ? 20 : settings.changes / count + 1;
		const int cycles = settings.quick ? 2000 : settings.cycles / static_cast<int>( subjects.size() );
		for ( int i = 0; i < count; ++i )
		{
			drive( worlds.world( static_cast<std::size_t>( i ) ), settings, changes, rng, times );
			cycle( worlds.world( static_cast<std::size_t>( i ) ), settings, cycles / count + 1, rng, histogram );
		}
		report( name, times, result );
		report( name, histogram, result );
		wrong += times.contradictions + times.refuted;
	}
	return wrong == 0 ? 0 : 1;
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
	command.option( "--judged", s->judged, "share of the answers that the judge looks at, which is slow", { 0, 1 } );
	command.option( "--zoo", s->zoo, "folder of .ci/install.sh zoo: eight robots more, in scenes made by seed" );
	command.option( "--random-robots", s->random_robots, "random robots in random scenes", { 0, 100000 } );
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
