// SPDX-License-Identifier: BSD-3-Clause
// Random robots drive random motions while objects move, come and go: the guard against full proofs, and against a dense look.
#include "guard_bench.hpp"
#include "random_world.hpp"
#include "sanitized.hpp"

namespace
{

/// A smooth motion of all joints but floating ones, from the home state.
OwnedClock randomMotion( const EdgeWorld& world, SeededRng& rng )
{
	OwnedClock clock;
	clock.rest = world.home;
	OwnedTrack track;
	std::vector<double> at;
	for ( std::uint32_t i = 0; i < world.size(); ++i )
	{
		const std::uint32_t joint = lw_robot_variable( world.robot.get(), world.variables[i] ).joint;
		if ( lw_robot_joint_type( world.robot.get(), joint ) != LW_JOINT_FLOATING )
		{
			track.variables.push_back( i );
			at.push_back( world.home[i] );
		}
	}
	const double step = rng.decade( -2, -0.5 );
	double time = 0;
	for ( int k = 0; k < 3 && !at.empty(); ++k )
	{
		OwnedPiece piece = { time, time + rng.uniform( 0.2, 1 ), static_cast<unsigned>( rng.integer( 1, 3 ) ), at };
		for ( unsigned p = 0; p < piece.degree; ++p )
		{
			for ( double& v : at )
			{
				v += step * rng.uniform( -1, 1 );
			}
			piece.points.insert( piece.points.end(), at.begin(), at.end() );
		}
		time = piece.end;
		track.pieces.push_back( piece );
	}
	track.lag = rng.integer( 0, 1 ) * rng.decade( -3, -1.5 );
	if ( !at.empty() )
	{
		clock.tracks.push_back( track );
	}
	return clock;
}

leeway::Scene changed( const lw_scene* scene, const lw_transform& around, int number, SeededRng& rng )
{
	lw_transform pose = randomTransform( rng, 0.7 );
	for ( int k = 0; k < 3; ++k )
	{
		pose.t[k] += around.t[k];
	}
	const std::uint32_t count = lw_scene_object_count( scene );
	const ShapePtr shape( randomMesh( rng, 8, 0.1, nullptr ) );
	const lw_shape* shapes[] = { shape.get() };
	const std::string fresh = "new" + std::to_string( number );
	const std::string old =
	    count > 0 ? lw_scene_object_name( scene, static_cast<std::uint32_t>( rng.integer( 0, int( count ) - 1 ) ) ) : "";
	const int kind = count == 0 ? 0 : rng.integer( 0, 3 );
	const lw_scene_change change = { kind == 0   ? LW_SCENE_ADD
	                                 : kind == 1 ? LW_SCENE_REMOVE
	                                             : LW_SCENE_MOVE,
	    kind == 0 ? fresh.c_str() : old.c_str(), shapes, &pose, 1 };
	lw_scene* made = nullptr;
	lw_diag diag = {};
	leeway::require( lw_scene_edit( scene, &change, 1, nullptr, &diag, &made ), diag );
	return leeway::Scene::adopt( made );
}

struct Tally
{
	int free = 0, blocked = 0, undecided = 0, other = 0, cut = 0;
};

double oneEach( void* time )
{
	return *static_cast<double*>( time ) += 1;
}

/// The least clearance that samples, and descents from the lowest of them, find from one time to another. Brute force over all pairs.
double leastClearance(
    const EdgeWorld& world, const lw_checker* checker, const lw_scene* scene, const lw_clock& clock, double from, double to )
{
	EdgeAuditor auditor( world.robot.get(), scene, world.variables, world.reference.data() );
	const auto at = [&]( double time )
	{
		std::vector<double> q( world.size() );
		EXPECT_EQ( LW_OK, lw_clock_state( checker, &clock, std::clamp( time, from, to ), q.data() ) );
		return auditor.clearance( world.full( q ).data() );
	};
	constexpr int samples = 24;
	const double step = ( to - from ) / samples;
	double lowest = from, least = INFINITY;
	for ( int k = 0; k <= samples; ++k )
	{
		const double time = from + k * step, clearance = at( time );
		lowest = clearance < least ? time : lowest;
		least = std::min( least, clearance );
	}
	for ( double width = 0.5 * step; width > 1e-6 && least > 0; width *= 0.5 )
	{
		for ( const double time : { lowest - width, lowest + width } )
		{
			const double clearance = at( time );
			lowest = clearance < least ? time : lowest;
			least = std::min( least, clearance );
		}
	}
	return least;
}

void drive( const EdgeWorld& world, SeededRng& rng, Tally& tally )
{
	OwnedClock clock = randomMotion( world, rng );
	const double end = clock.tracks.empty() ? 1 : clock.tracks[0].pieces.back().end;
	lw_guard_def def = guardOf( world.with_tables.get(), end );
	def.window = rng.uniform( 0.1, 2 );
	double looks = 0;
	def.microseconds = oneEach;
	def.user = &looks;
	const GuardPtr guard = makeGuard( def, clock );
	leeway::Scene scene = world.scene;
	leeway::Checker checker = world.with_tables;
	double now = 0;
	const int changes = 25;
	for ( int i = 0; i <= changes; ++i, now += rng.uniform( 0, 1.5 * end / changes ) )
	{
		if ( i > 0 )
		{
			scene = changed( scene.get(), lw_transform_identity(), i, rng );
			checker = inScene( world.with_tables.get(), scene.get() );
			ASSERT_EQ( LW_OK, lw_guard_publish( guard.get(), checker.get(), static_cast<std::uint64_t>( i ), nullptr ) );
		}
		if ( rng.integer( 0, 3 ) == 0 )
		{
			continue; // nobody asked about this scene
		}
		const lw_guard_answer answer = ask( guard.get(), now, rng.integer( 0, 3 ) == 0 ? rng.decade( 0.3, 2 ) : INFINITY );
		const leeway::Query query = leeway::makeQuery( checker.get() );
		const lw_clock view = clock.view();
		lw_timed_result whole;
		ASSERT_EQ(
		    LW_OK, lw_checker_timed( checker.get(), query.get(), &view, now, std::max( now, end ), &def.timed, &whole ) );
		tally.free += answer.verdict == LW_VERDICT_FREE;
		tally.blocked += answer.verdict == LW_VERDICT_BLOCKED;
		tally.undecided += answer.verdict == LW_VERDICT_UNDECIDED;
		const bool cut = answer.verdict == LW_VERDICT_UNDECIDED && answer.pair.kind == LW_CLEARANCE_UNKNOWN;
		tally.cut += cut;
		tally.other += !cut && answer.verdict != whole.verdict;
		EXPECT_FALSE( answer.verdict == LW_VERDICT_FREE && whole.verdict == LW_VERDICT_BLOCKED ) << "at " << now;
		EXPECT_FALSE( answer.verdict == LW_VERDICT_BLOCKED && whole.verdict == LW_VERDICT_FREE ) << "at " << now;
		// allowed contacts go by names, which the auditor does not know: it looks at worlds without them only
		if ( world.allowed.empty() && answer.proved_until > now )
		{
			EXPECT_GT( leastClearance( world, checker.get(), scene.get(), view, now, answer.proved_until ), 0 )
			    << "proved until " << answer.proved_until;
		}
	}
}

} // namespace

TEST( GuardWorlds, AnAnswerIsNotThatOfAFullProof )
{
	SeededRng rng;
	Tally tally;
	const char* asked = std::getenv( "LEEWAY_GUARD_WORLDS" );
	const int worlds = asked != nullptr ? std::atoi( asked ) : unlessSanitized( 100, 10 );
	for ( int i = 0; i < worlds; ++i )
	{
		drive( randomWorld( rng.engine()() ), rng, tally );
	}
	std::printf( "%d free, %d blocked, %d undecided, of which %d by the budget; %d unlike a full proof\n", tally.free,
	    tally.blocked, tally.undecided, tally.cut, tally.other );
	EXPECT_GT( tally.cut, 5 );
	EXPECT_GT( tally.free, 50 );
	EXPECT_GT( tally.blocked, unlessSanitized( 50, 3 ) );
	EXPECT_LT( tally.other, 0.05 * ( tally.free + tally.blocked ) );
}
