// SPDX-License-Identifier: BSD-3-Clause
// How fast a robot may go beside people: in closed form on a rail, and by people who run after random robots as fast as they may.
#include "rail.hpp"
#include "random_world.hpp"
#include "sanitized.hpp"

#include <deque>

namespace
{

lw_guard_scale speed( lw_guard* guard, const lw_separation& def, double now, double age, double highest )
{
	lw_guard_scale scale;
	EXPECT_EQ( LW_OK, lw_guard_speed( guard, &def, now, age, highest, INFINITY, &scale ) );
	return scale;
}

leeway::Scene at( const lw_shape* shape, const lw_vec3& place )
{
	lw_transform pose = lw_transform_identity();
	pose.t[0] = place.x;
	pose.t[1] = place.y;
	pose.t[2] = place.z;
	return oneObstacle( shape, pose );
}

/// All variables but quaternions, there and back between two states.
OwnedClock thereAndBack( const EdgeWorld& world, SeededRng& rng )
{
	OwnedClock clock;
	clock.rest = world.home;
	OwnedTrack track;
	std::vector<double> home, away;
	for ( std::uint32_t i = 0; i < world.size(); ++i )
	{
		const std::uint32_t joint = lw_robot_variable( world.robot.get(), world.variables[i] ).joint;
		if ( lw_robot_joint_type( world.robot.get(), joint ) != LW_JOINT_FLOATING )
		{
			track.variables.push_back( i );
			home.push_back( world.home[i] );
			away.push_back( world.home[i] + rng.uniform( -1, 1 ) );
		}
	}
	for ( double begin = 0; begin < 6 && !home.empty(); begin += 1 )
	{
		OwnedPiece piece = { begin, begin + 1, 1, home };
		piece.points.insert( piece.points.end(), away.begin(), away.end() );
		track.pieces.push_back( piece );
		std::swap( home, away );
	}
	if ( !home.empty() )
	{
		clock.tracks.push_back( track );
	}
	return clock;
}

/// A robot that obeys the guard, and a body that runs at it.
class Chase
{
public:
	Chase( const EdgeWorld& world, SeededRng& rng )
	    : world_( world ), rng_( rng ),
	      shape_( primitive( LW_SHAPE_CAPSULE, rng.uniform( 0.05, 0.2 ), rng.uniform( 0.1, 0.5 ) ) ),
	      clock_( thereAndBack( world, rng ) )
	{
		def_ = lw_separation_default();
		def_.speed = rng.uniform( 0.1, 2 );
		def_.intrusion = rng.integer( 0, 1 ) * rng.uniform( 0, 0.2 );
		def_.deceleration = rng.decade( -0.3, 1 );
		cycle_ = rng.decade( -2, -1 );
		age_ = rng.integer( 0, 1 ) * rng.uniform( 0, 0.1 );
		def_.reaction = cycle_ + rng.integer( 0, 1 ) * rng.uniform( 0, 0.1 );
		person_ = lw_vec3{ rng.uniform( -2, 2 ), rng.uniform( -2, 2 ), rng.uniform( -2, 2 ) };
		seen_.push_back( { 0, person_ } );
	}
	bool moves() const { return !clock_.tracks.empty(); }

	/// @return how many times the robot moved, and the least room that it kept beyond the intrusion
	int run( double* least )
	{
		const leeway::Checker first = inScene( world_.with_tables.get(), at( shape_.get(), person_ ).get() );
		lw_guard_def guard_def = guardOf( first.get(), 6 );
		const GuardPtr guard = makeGuard( guard_def, clock_ );
		int moved = 0;
		for ( std::uint64_t k = 1; k <= 60; ++k )
		{
			while ( seen_.size() > 1 && seen_[1].time <= time_ - age_ )
			{
				seen_.pop_front();
			}
			EXPECT_EQ( LW_OK,
			    lw_guard_publish( guard.get(),
			        inScene( world_.with_tables.get(), at( shape_.get(), seen_.front().place ).get() ).get(), k, nullptr ) );
			const lw_guard_scale answer = speed( guard.get(), def_, along_, time_ - seen_.front().time, 2 );
			EXPECT_EQ( answer.stamp, k );
			const bool brakes = answer.scale < rate_;
			for ( int step = 0; step < 4; ++step )
			{
				advance( answer.scale, brakes, cycle_ / 4 );
				if ( rate_ > 0 )
				{
					++moved;
					*least = std::min( *least, clearance() - def_.intrusion );
				}
			}
		}
		return moved;
	}

private:
	struct Sight
	{
		double time;
		lw_vec3 place;
	};

	lw_clearance nearest() const
	{
		const leeway::Checker checker = inScene( world_.with_tables.get(), at( shape_.get(), person_ ).get() );
		const leeway::Query query = leeway::makeQuery( checker.get() );
		OwnedClock clock = clock_;
		const lw_clock view = clock.view();
		std::vector<double> q( world_.size() );
		EXPECT_EQ( LW_OK, lw_clock_state( checker.get(), &view, along_, q.data() ) );
		lw_state_result result;
		EXPECT_EQ(
		    LW_OK, lw_checker_state( checker.get(), query.get(), q.data(), LW_CHECK_ENVIRONMENT, nullptr, false, &result ) );
		return result.environment;
	}
	double clearance() const { return nearest().upper; }

	/// The robot goes as fast as it may, or brakes until another answer allows the scale that it still has; the body runs at the nearest point, or
	/// anywhere.
	void advance( double allowed, bool brakes, double seconds )
	{
		const double begin = rate_;
		rate_ = brakes ? std::max( 0.0, rate_ - def_.deceleration * seconds ) : allowed;
		const double in_motion = brakes ? std::min( seconds, begin / def_.deceleration ) : seconds;
		along_ += brakes ? 0.5 * ( begin + rate_ ) * in_motion : rate_ * seconds;
		time_ += seconds;
		const lw_clearance pair = nearest();
		lw_vec3 way = { pair.point_a.x - pair.point_b.x, pair.point_a.y - pair.point_b.y, pair.point_a.z - pair.point_b.z };
		if ( !( pair.upper < INFINITY && pair.upper > 0 ) || rng_.integer( 0, 9 ) == 0 )
		{
			way = lw_vec3{ rng_.uniform( -1, 1 ), rng_.uniform( -1, 1 ), rng_.uniform( -1, 1 ) };
		}
		const double length = std::sqrt( way.x * way.x + way.y * way.y + way.z * way.z );
		const double step = length > 0 ? ( 1 - 1e-9 ) * def_.speed * seconds / length : 0;
		person_ = lw_vec3{ person_.x + step * way.x, person_.y + step * way.y, person_.z + step * way.z };
		seen_.push_back( { time_, person_ } );
	}

	const EdgeWorld& world_;
	SeededRng& rng_;
	ShapePtr shape_;
	OwnedClock clock_;
	lw_separation def_;
	double cycle_ = 0, age_ = 0, time_ = 0, along_ = 0, rate_ = 0;
	lw_vec3 person_ = {};
	std::deque<Sight> seen_;
};

} // namespace

// A ball of 0.1 m at 1 m/s, and a wall at x: the way until it stands and the separation leave room for one largest scale.
TEST( Separation, AScaleIsTooHighOrTooLow )
{
	SeededRng rng;
	Rail rail( 20, 2, 2 );
	const GuardPtr guard = makeGuard( guardOf( rail.checker.get(), 20 ), rail.clock );
	int between = 0;
	for ( std::uint64_t i = 1; i <= 300; ++i )
	{
		lw_separation def = lw_separation_default();
		def.speed = rng.uniform( 0, 2 );
		def.intrusion = rng.uniform( 0, 0.5 );
		def.reaction = rng.uniform( 0, 0.3 );
		def.deceleration = rng.decade( -0.5, 1 );
		def.grid = static_cast<std::uint32_t>( rng.integer( 1, 200 ) );
		const double now = rng.uniform( 0, 1 ), x = now + rng.uniform( 0, 5 ), age = rng.uniform( 0, 0.1 ),
		             highest = rng.uniform( 0.2, 2 );
		ASSERT_EQ( LW_OK, rail.publish( guard.get(), x, i ) );
		const lw_guard_scale answer = speed( guard.get(), def, now, age, highest );
		// x - 0.2 - now = s T + s^2 / ( 2 b ) + C + v ( T + s / b + age )
		const double b = def.deceleration, half = def.reaction + def.speed / b;
		const double room = x - 0.2 - now - def.intrusion - def.speed * ( def.reaction + age );
		const double exact = room <= 0 ? 0 : b * ( std::sqrt( half * half + 2 * room / b ) - half );
		EXPECT_LE( answer.scale, std::min( exact, highest ) + 1e-9 ) << i;
		EXPECT_GE( answer.scale, std::min( exact, highest ) - 1.01 * highest / def.grid - 1e-2 ) << i;
		between += answer.scale > 0 && answer.scale < highest;
		if ( answer.scale > 0 )
		{
			EXPECT_NEAR( answer.separation, def.intrusion + def.speed * ( def.reaction + answer.scale / b + age ), 1e-12 );
			EXPECT_NEAR( answer.until, now + answer.scale * def.reaction + 0.5 * answer.scale * answer.scale / b, 1e-12 );
		}
		else
		{
			EXPECT_TRUE( std::isnan( answer.separation ) );
		}
		EXPECT_EQ( answer.scale < highest, answer.next.verdict != LW_VERDICT_UNKNOWN );
	}
	EXPECT_GT( between, 30 );
}

// LEEWAY_CHASES=100000: so many of them.
TEST( Separation, SomebodyComesTooNearWhileTheRobotMoves )
{
	SeededRng rng;
	const char* asked = std::getenv( "LEEWAY_CHASES" );
	const int chases = asked != nullptr ? std::atoi( asked ) : unlessSanitized( 150, 8 );
	double nearest = INFINITY;
	int moved = 0;
	for ( int i = 0; i < chases; ++i )
	{
		const EdgeWorld world = randomWorld( rng.engine()() );
		if ( !world.allowed.empty() )
		{
			continue;
		}
		for ( int k = 0; k < 10 && i < chases; ++k, ++i )
		{
			Chase chase( world, rng );
			double least = INFINITY;
			moved += chase.moves() ? chase.run( &least ) : 0;
			EXPECT_GT( least, 0 ) << "chase " << i;
			nearest = std::min( nearest, least );
		}
	}
	std::printf( "%d chases, %d times in motion, least room %g m\n", chases, moved, nearest );
	EXPECT_GT( moved, 10 * chases );
	EXPECT_LT( nearest, 0.05 ) << "nobody came near";
}

TEST( Separation, RefusesBadSettings )
{
	Rail rail( 2, 2, 2 );
	const GuardPtr guard = makeGuard( guardOf( rail.checker.get(), 2 ), rail.clock );
	const auto refused = [&]( lw_status status, lw_guard* asked, const lw_separation& def, double now, double age,
	                         double highest, double budget )
	{
		lw_guard_scale out;
		EXPECT_EQ( lw_guard_speed( asked, &def, now, age, highest, budget, &out ), status );
		EXPECT_EQ( out.scale, 0 );
		EXPECT_TRUE( std::isnan( out.separation ) );
	};
	const lw_separation good = lw_separation_default();
	refused( LW_ERROR_INVALID_ARGUMENT, nullptr, good, 0, 0, 1, INFINITY );
	refused( LW_ERROR_INVALID_ARGUMENT, guard.get(), good, NAN, 0, 1, INFINITY );
	refused( LW_ERROR_INVALID_ARGUMENT, guard.get(), good, 0, -1, 1, INFINITY );
	refused( LW_ERROR_INVALID_ARGUMENT, guard.get(), good, 0, 0, 0, INFINITY );
	refused( LW_ERROR_INVALID_ARGUMENT, guard.get(), good, 0, 0, 1, 50 ); // a budget without a clock
	const auto bad = [&]( void ( *change )( lw_separation& ), lw_status status )
	{
		lw_separation def = good;
		change( def );
		refused( status, guard.get(), def, 0, 0, 1, INFINITY );
	};
	bad( []( lw_separation& def ) { def.cookie = 0; }, LW_ERROR_INVALID_DEF );
	bad( []( lw_separation& def ) { def.speed = NAN; }, LW_ERROR_INVALID_ARGUMENT );
	bad( []( lw_separation& def ) { def.intrusion = -1; }, LW_ERROR_INVALID_ARGUMENT );
	bad( []( lw_separation& def ) { def.reaction = INFINITY; }, LW_ERROR_INVALID_ARGUMENT );
	bad( []( lw_separation& def ) { def.deceleration = 0; }, LW_ERROR_INVALID_ARGUMENT );
	bad( []( lw_separation& def ) { def.grid = 0; }, LW_ERROR_INVALID_ARGUMENT );
	rail.clock.tracks[0].spread_speed = 1;
	const GuardPtr spreads = makeGuard( guardOf( rail.checker.get(), 2 ), rail.clock );
	refused( LW_ERROR_INVALID_ARGUMENT, spreads.get(), good, 0, 0, 1, INFINITY );
}
