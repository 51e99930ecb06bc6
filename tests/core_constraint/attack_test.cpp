// SPDX-License-Identifier: BSD-3-Clause
// Random robots, motions and references: proved bounds are attacked by samples and by a descent to the largest errors in between, in long
// double. LEEWAY_ATTACK_MOTIONS sets how many motions.
#include "region_bench.hpp"
#include "region_oracle.hpp"
#include "sanitized.hpp"

#include <cstdlib>

namespace
{

struct Motion
{
	RobotModel model;
	RobotPtr robot;
	lw_region_def def;
	OwnedClock clock;
	OwnedTrack timing;
	double end = 0;
};

bool isQuaternion( const lw_robot* robot, std::uint32_t v )
{
	const lw_variable_info info = lw_robot_variable( robot, v );
	return lw_robot_joint_type( robot, info.joint ) == LW_JOINT_FLOATING && info.component >= 3;
}

/// Pieces one behind the other, each from where the one before ended.
void addPieces(
    SeededRng& rng, OwnedTrack& track, const std::vector<double>& from, double size, const std::vector<bool>& still )
{
	std::vector<double> at = from;
	double time = 0;
	const int count = rng.integer( 1, 3 );
	for ( int p = 0; p < count; ++p )
	{
		OwnedPiece piece = {
		    time, time + rng.decade( -1, 1 ), static_cast<unsigned>( rng.integer( 1, LW_CURVE_MOST_DEGREE ) ), at };
		for ( unsigned k = 0; k < piece.degree; ++k )
		{
			for ( std::size_t v = 0; v < at.size(); ++v )
			{
				at[v] += still[v] ? 0 : rng.uniform( -size, size );
				piece.points.push_back( at[v] );
			}
		}
		time = piece.end;
		track.pieces.push_back( piece );
	}
}

/// The share of a track's variables at a time, in long double.
std::vector<long double> valuesAt( const OwnedTrack& track, double time )
{
	const OwnedPiece* last = &track.pieces.front();
	for ( const OwnedPiece& piece : track.pieces )
	{
		last = piece.start <= time ? &piece : last;
	}
	const long double u = std::max( 0.0L, std::min( 1.0L, ( static_cast<long double>( time ) - last->start ) /
	                                                          ( static_cast<long double>( last->end ) - last->start ) ) );
	std::vector<long double> values;
	for ( std::size_t v = 0; v < track.variables.size(); ++v )
	{
		values.push_back( bernsteinAt( *last, track.variables.size(), v, u ) );
	}
	return values;
}

/// @param deviation of each variable, in shares of its tolerance
Errors errorsOf( const Motion& m, double time, const std::vector<double>& deviation )
{
	const OwnedTrack& track = m.clock.tracks[0];
	const std::vector<long double> values = valuesAt( track, time );
	State q( values.size() );
	for ( std::size_t v = 0; v < q.size(); ++v )
	{
		const double tolerance = track.tolerance.empty() ? 0 : track.tolerance[v];
		q[v] = static_cast<double>( values[v] ) + tolerance * deviation[v];
	}
	return errorsAt( m.model, m.robot.get(), m.def, q, valuesAt( m.timing, time )[0] );
}

/// Limits a little above, or below, the errors that a few samples have; some are left out.
void limitBySamples( SeededRng& rng, Motion& m )
{
	Errors most = {};
	const std::vector<double> none( m.clock.tracks[0].variables.size(), 0 );
	for ( int i = 0; i <= 12; ++i )
	{
		const Errors e = errorsOf( m, m.end * i / 12, none );
		for ( std::size_t k = 0; k < e.size(); ++k )
		{
			most[k] = std::max( most[k], std::fabs( e[k] ) );
		}
	}
	const double share = rng.integer( 0, 3 ) > 0 ? 1 + rng.decade( -3, 1 ) : rng.uniform( 0.5, 1 );
	bool any = false;
	while ( !any )
	{
		for ( std::size_t k = 0; k < most.size(); ++k )
		{
			const double limit = rng.integer( 0, 2 ) > 0 ? INFINITY : share * static_cast<double>( most[k] ) + 1e-9;
			any = any || limit < INFINITY;
			if ( k < 3 )
			{
				m.def.lower[k] = -limit;
				m.def.upper[k] = limit;
			}
			( k == LW_REGION_ANGLE ? m.def.angle : m.def.tilt ) = k == LW_REGION_ANGLE || k == LW_REGION_TILT ? limit
			                                                      : k == LW_REGION_ANGLE                      ? m.def.angle
			                                                                                                  : m.def.tilt;
			if ( k >= LW_REGION_TURN_X )
			{
				m.def.turns[k - LW_REGION_TURN_X] = limit;
			}
		}
	}
}

void randomReference( SeededRng& rng, Motion& m )
{
	m.def.start = randomTransform( rng, 0.5 );
	if ( rng.integer( 0, 3 ) > 0 ) // near to the frame's own pose, as constraints are
	{
		const RegionBench bench( m.robot.get() );
		lw_region_def any = m.def;
		any.angle = 1;
		const RegionPtr region = bench.region( any );
		const std::vector<long double> values = valuesAt( m.clock.tracks[0], 0 );
		const State q( values.begin(), values.end() );
		lw_region_errors e;
		ASSERT_EQ( LW_OK, lw_region_state( region.get(), q.data(), 0, &e ) );
		m.def.start = e.pose;
	}
	m.def.shift = rng.integer( 0, 1 ) ? randomVector( rng, rng.decade( -2, 0 ) ) : lw_vec3{ 0, 0, 0 };
	m.def.arc = rng.integer( 0, 1 ) ? randomVector( rng, rng.decade( -2, 0.3 ) ) : lw_vec3{ 0, 0, 0 };
	m.def.center = randomVector( rng, 1 );
	m.def.turn = rng.integer( 0, 1 ) ? randomVector( rng, rng.decade( -2, 0.3 ) ) : lw_vec3{ 0, 0, 0 };
	m.def.axis = randomVector( rng, 1 );
	m.def.turns_are = rng.integer( 0, 1 ) ? LW_TURNS_XYZ : LW_TURNS_VECTOR;
}

Motion randomMotion( SeededRng& rng )
{
	Motion m;
	RandomRobotOptions options;
	options.joints = rng.integer( 1, 9 );
	options.bareShare = 1.1;
	do
	{
		m.model = randomRobot( rng, options );
		m.robot = m.model.create();
	} while ( lw_robot_variable_count( m.robot.get() ) == 0 );
	const std::uint32_t variables = lw_robot_variable_count( m.robot.get() );
	const int links = static_cast<int>( lw_robot_link_count( m.robot.get() ) );
	m.def = lw_region_def_default();
	m.def.base_link = rng.integer( 0, 1 ) ? LW_INVALID_INDEX : static_cast<std::uint32_t>( rng.integer( 0, links - 1 ) );
	m.def.link = rng.integer( 0, 9 ) == 0 ? LW_INVALID_INDEX : static_cast<std::uint32_t>( rng.integer( 0, links - 1 ) );
	m.def.base_from_a = randomTransform( rng, 0.3 );
	m.def.link_from_b = randomTransform( rng, 0.3 );
	OwnedTrack track;
	std::vector<bool> still;
	for ( std::uint32_t v = 0; v < variables; ++v )
	{
		track.variables.push_back( v );
		still.push_back( isQuaternion( m.robot.get(), v ) || rng.integer( 0, 9 ) == 0 );
		track.tolerance.push_back( isQuaternion( m.robot.get(), v ) ? 0 : rng.decade( -7, -2 ) );
	}
	if ( rng.integer( 0, 2 ) > 0 )
	{
		track.tolerance.clear();
	}
	addPieces( rng, track, randomState( rng, m.robot.get(), 0.1 ), rng.decade( -4, 0.3 ), still );
	m.end = track.pieces.back().end;
	m.clock.rest.assign( variables, 0 );
	m.clock.tracks = { track };
	m.timing.variables = { 0 };
	addPieces( rng, m.timing, { rng.uniform( -0.2, 0.2 ) }, rng.decade( -2, 0 ), { false } );
	randomReference( rng, m );
	limitBySamples( rng, m );
	return m;
}

/// INFINITY: none, such as half a turn
double limitOf( const lw_region_def& def, std::size_t k )
{
	if ( k < 3 )
	{
		return def.upper[k];
	}
	const bool quarter = k == LW_REGION_TURN_Y && def.turns_are == LW_TURNS_XYZ;
	const double limit = k == LW_REGION_ANGLE ? def.angle : k == LW_REGION_TILT ? def.tilt : def.turns[k - LW_REGION_TURN_X];
	return limit < ( quarter ? M_PI / 2 : M_PI ) ? limit : INFINITY;
}

/// -INFINITY where the oracle has no answer: of parts of a turn near half a turn.
double sideOf( const lw_region_result& r, const Errors& e, std::size_t k )
{
	if ( std::isnan( e[k] ) )
	{
		return -INFINITY;
	}
	const long double above = e[k] - static_cast<long double>( r.upper[k] ),
	                  below = static_cast<long double>( r.lower[k] ) - e[k];
	return static_cast<double>( std::max( above, below ) );
}

/// The largest amount by which an error was beyond its proved bounds (positive: the proof is wrong), for one limit, near one time.
double attack( SeededRng& rng, const Motion& m, const lw_region_result& r, std::size_t k, double time )
{
	const std::size_t variables = m.clock.tracks[0].variables.size();
	std::vector<double> deviation( variables, 0 );
	double best = sideOf( r, errorsOf( m, time, deviation ), k ), step = m.end / 40;
	const bool tolerant = !m.clock.tracks[0].tolerance.empty();
	for ( int i = 0; i < 24; ++i )
	{
		bool better = false;
		for ( const double other : { time - step, time + step } )
		{
			const double at = std::max( 0.0, std::min( m.end, other ) ), side = sideOf( r, errorsOf( m, at, deviation ), k );
			better = better || side > best;
			time = side > best ? at : time;
			best = std::max( best, side );
		}
		if ( tolerant && i % 4 == 0 )
		{
			const std::size_t v = static_cast<std::size_t>( rng.integer( 0, static_cast<int>( variables ) - 1 ) );
			for ( const double to : { -1.0, 1.0 } )
			{
				std::vector<double> other = deviation;
				other[v] = to;
				const double side = sideOf( r, errorsOf( m, time, other ), k );
				deviation = side > best ? other : deviation;
				best = std::max( best, side );
			}
		}
		step *= better ? 1 : 0.5;
	}
	return best;
}

struct Tally
{
	int free = 0, blocked = 0, undecided = 0, tight = 0, unjudged = 0;
	double worst = -INFINITY; ///< largest error beyond its bound
	std::uint64_t windows = 0;
};

void attackFree( SeededRng& rng, const Motion& m, const lw_region_result& r, Tally& tally )
{
	const std::vector<double> none( m.clock.tracks[0].variables.size(), 0 );
	std::array<double, LW_REGION_LIMITS> best;
	std::array<double, LW_REGION_LIMITS> where = {};
	best.fill( -INFINITY );
	for ( int i = 0; i <= 60; ++i )
	{
		const double time = i < 40 ? m.end * i / 40 : rng.uniform( 0, m.end );
		const Errors e = errorsOf( m, time, none );
		for ( std::size_t k = 0; k < e.size(); ++k )
		{
			where[k] = sideOf( r, e, k ) > best[k] ? time : where[k];
			best[k] = std::max( best[k], sideOf( r, e, k ) );
		}
	}
	for ( std::size_t k = 0; k < best.size(); ++k )
	{
		if ( r.upper[k] < INFINITY )
		{
			const double found = attack( rng, m, r, k, where[k] );
			const double size = std::max( std::fabs( r.upper[k] ), std::fabs( r.lower[k] ) );
			EXPECT_LE( found, 0 ) << lw_region_limit_name( static_cast<lw_region_limit>( k ) ) << " of " << size;
			tally.worst = std::max( tally.worst, found );
			tally.unjudged += found == -INFINITY;
			tally.tight += found > -0.01 * size;
		}
		const double limit = limitOf( m.def, k );
		EXPECT_TRUE( limit == INFINITY || r.upper[k] <= limit );
		EXPECT_TRUE( limit == INFINITY || r.lower[k] >= -limit );
	}
}

} // namespace

TEST( RegionAttack, NoErrorIsBeyondItsProvedBound )
{
	SeededRng rng( 20261127 );
	const char* text = std::getenv( "LEEWAY_ATTACK_MOTIONS" );
	const int motions = text != nullptr ? std::atoi( text ) : unlessSanitized( 400, 40 );
	Tally tally;
	for ( int i = 0; i < motions; ++i )
	{
		Motion m = randomMotion( rng );
		const RegionBench bench( m.robot.get() );
		const lw_region_result r = bench.ask( m.def, m.clock, m.timing, 0, m.end );
		tally.windows += r.windows;
		const std::vector<double> none( m.clock.tracks[0].variables.size(), 0 );
		if ( r.verdict == LW_VERDICT_FREE )
		{
			++tally.free;
			attackFree( rng, m, r, tally );
		}
		else if ( r.verdict == LW_VERDICT_BLOCKED )
		{
			++tally.blocked;
			const Errors e = errorsOf( m, r.time, none );
			EXPECT_GT( r.excess, 0 );
			EXPECT_LE( r.proved_until, r.time );
			// near half a turn a rounding of 1e-15 is one of 1e-7 of the angle
			EXPECT_NEAR( std::isnan( e[r.limit] ) ? r.value : static_cast<double>( e[r.limit] ), r.value,
			    std::fabs( r.value ) > 3 ? 1e-6 : 1e-9 );
		}
		else
		{
			EXPECT_EQ( LW_VERDICT_UNDECIDED, r.verdict );
			tally.undecided += m.clock.tracks[0].tolerance.empty();
		}
		if ( HasFailure() )
		{
			FAIL() << "motion " << i;
		}
	}
	std::printf(
	    "%d motions: %d kept, %d broken, %d undecided without a tolerance; %.1f windows each; nearest to a bound %g m or rad, "
	    "%d within 1 %% of it, %d not judged near half a turn\n",
	    motions, tally.free, tally.blocked, tally.undecided, static_cast<double>( tally.windows ) / motions, -tally.worst,
	    tally.tight, tally.unjudged );
	EXPECT_LT( tally.unjudged, motions / 1000 + 1 );
	EXPECT_GT( tally.free, motions / 4 );
	EXPECT_GT( tally.blocked, motions / 20 );
	EXPECT_LT( tally.undecided, motions / 50 + 1 );
	EXPECT_GT( tally.tight, motions / 10 );
}
