// SPDX-License-Identifier: BSD-3-Clause
// Motion bounds hunted for counterexamples: path lengths of body points along random edges of random robots.
#include "random_robot.hpp"

#include <gtest/gtest.h>

#include <algorithm>

// The internal interface, declared here because its headers are C only.
extern "C"
{
	struct lwi_motion_table;
	lw_status lwi_motion_table_create( const lw_robot* robot, const bool* fixed_variables, const double* reference,
	    const lw_allocator* allocator, lw_diag* diag, lwi_motion_table** out_table );
	void lwi_motion_table_destroy( lwi_motion_table* table );
	size_t lwi_motion_scratch_size( const lwi_motion_table* table );
	bool lwi_motion_measure( const lwi_motion_table* table, const double* qa, const double* qb, void* scratch );
	bool lwi_motion_begin( const lwi_motion_table* table, const double* qa, const double* qb, void* scratch );
	struct lwi_motion_ranges
	{
		const double *least, *most, *speed, *change;
	};
	bool lwi_motion_begin_curve( const lwi_motion_table* table, const lwi_motion_ranges* ranges, void* scratch );
	struct lwi_motion_rate
	{
		double path, change;
	};
	void lwi_motion_place( const lwi_motion_table* table, void* scratch, const lw_transform* poses );
	void lwi_motion_measure_body(
	    const lwi_motion_table* table, void* scratch, uint32_t body, const lw_transform* poses, double share );
	lwi_motion_rate lwi_motion_of( const lwi_motion_table* table, const void* scratch, uint32_t body, uint32_t ancestor );
	struct lwi_chord_error
	{
		double coefficient, max;
	};
	lwi_chord_error lwi_chord_error_of( lwi_motion_rate rate, double h );
	double lwi_motion_between( double chord, lwi_chord_error error, double path );
	double lwi_motion_bound( const lwi_motion_table* table, const void* scratch, uint32_t body, uint32_t ancestor );
	double lwi_motion_rounding( const void* scratch );
	struct lwi_motion_late
	{
		const double* tolerance;
		const uint32_t* tracks;
	};
	struct lwi_motion_tube
	{
		double timely, late;
		uint32_t track;
	};
	void lwi_motion_tolerate(
	    const lwi_motion_table* table, void* scratch, const double* tolerance, const lwi_motion_late* late );
	lwi_motion_tube lwi_motion_tube_of(
	    const lwi_motion_table* table, const void* scratch, uint32_t body, uint32_t ancestor );
	double lwi_motion_largest_tube( const void* scratch );
}

namespace
{

struct Motion
{
	lwi_motion_table* table = nullptr;
	std::vector<double> memory;
	void* scratch = nullptr;

	explicit Motion( const lw_robot* robot, const bool* fixed = nullptr, const double* reference = nullptr )
	{
		EXPECT_EQ( lwi_motion_table_create( robot, fixed, reference, nullptr, nullptr, &table ), LW_OK );
		memory.resize( lwi_motion_scratch_size( table ) / sizeof( double ) + 16 );
		std::size_t address = reinterpret_cast<std::size_t>( memory.data() );
		scratch = reinterpret_cast<void*>( ( address + 63 ) / 64 * 64 );
	}
	Motion( const Motion& ) = delete;
	Motion& operator=( const Motion& ) = delete;
	~Motion() { lwi_motion_table_destroy( table ); }
};

/// Up to nine joints of all types.
RobotModel anyRobot( SeededRng& rng )
{
	RandomRobotOptions options;
	options.joints = rng.integer( 1, 9 );
	return randomRobot( rng, options );
}

lw_vec3 position(
    const lw_transform& ancestorPose, bool inWorld, const lw_transform& pose, const lw_body_def& body, lw_vec3 p )
{
	lw_vec3 world = lw_transform_point( &pose, lw_transform_point( &body.link_from_shape, p ) );
	if ( inWorld )
	{
		return world;
	}
	lw_transform inverse = lw_transform_inverse( &ancestorPose );
	return lw_transform_point( &inverse, world );
}

double distance( lw_vec3 a, lw_vec3 b )
{
	return std::sqrt( ( a.x - b.x ) * ( a.x - b.x ) + ( a.y - b.y ) * ( a.y - b.y ) + ( a.z - b.z ) * ( a.z - b.z ) );
}

std::uint32_t randomAncestor( SeededRng& rng, const lw_robot* robot, std::uint32_t link )
{
	std::vector<std::uint32_t> chain = { LW_INVALID_INDEX, link };
	for ( std::uint32_t j = lw_robot_link_joint( robot, link ); j != LW_INVALID_INDEX;
	      j = lw_robot_link_joint( robot, link ) )
	{
		link = lw_robot_joint_parent( robot, j );
		chain.push_back( link );
	}
	return chain[static_cast<std::size_t>( rng.integer( 0, static_cast<int>( chain.size() ) - 1 ) )];
}

/// Longest polyline through `steps` + 1 states of any point of the body; the true path is at least as long. Also checks
/// that no step is longer than its share of the bound.
double longestPath( const RobotModel& model, const std::vector<std::vector<lw_transform>>& poses, std::uint32_t body,
    std::uint32_t ancestor, double bound, double slack )
{
	double longest = 0;
	const lw_body_def& def = model.bodies[body];
	std::size_t steps = poses.size() - 1;
	for ( lw_vec3 p : model.bodyPoints[body] )
	{
		double path = 0;
		for ( std::size_t i = 0; i < steps; ++i )
		{
			bool inWorld = ancestor == LW_INVALID_INDEX;
			lw_vec3 from = position( poses[i][inWorld ? 0 : ancestor], inWorld, poses[i][def.link], def, p );
			lw_vec3 to = position( poses[i + 1][inWorld ? 0 : ancestor], inWorld, poses[i + 1][def.link], def, p );
			double step = distance( from, to );
			EXPECT_LE( step, bound / static_cast<double>( steps ) + slack );
			path += step;
		}
		longest = std::max( longest, path );
	}
	return longest;
}

} // namespace

TEST( MotionBound, NoPointTravelsFurtherThanTheBound )
{
	SeededRng rng;
	int worldCases = 0, relativeCases = 0, outside = 0;
	std::vector<double> shortRatios, longRatios;
	for ( int i = 0; i < 700; ++i )
	{
		RobotModel model = anyRobot( rng );
		RobotPtr robot = model.create();
		ASSERT_NE( robot, nullptr );
		Motion motion( robot.get() );
		bool isShort = rng.integer( 0, 1 ) == 1;
		double excess = rng.integer( 0, 2 ) == 0 ? rng.decade( -1, 1 ) : 0;
		outside += excess > 0 ? 1 : 0;
		State a = randomState( rng, robot.get(), excess ), b = randomState( rng, robot.get(), excess );
		if ( isShort )
		{
			lw_robot_interpolate( robot.get(), a.data(), b.data(), rng.decade( -3, -0.7 ), b.data() );
		}
		ASSERT_TRUE( lwi_motion_measure( motion.table, a.data(), b.data(), motion.scratch ) );
		const int steps = isShort ? 8 : 40;
		std::vector<std::vector<lw_transform>> poses;
		for ( int k = 0; k <= steps; ++k )
		{
			State q( a.size() );
			lw_robot_interpolate( robot.get(), a.data(), b.data(), static_cast<double>( k ) / steps, q.data() );
			poses.emplace_back( lw_robot_link_count( robot.get() ) );
			ASSERT_EQ( lw_robot_fk( robot.get(), q.data(), poses.back().data() ), LW_OK );
		}
		for ( std::uint32_t body = 0; body < model.bodies.size(); ++body )
		{
			std::uint32_t ancestor = LW_INVALID_INDEX;
			if ( rng.integer( 0, 1 ) == 1 )
			{
				ancestor = randomAncestor( rng, robot.get(), model.bodies[body].link );
			}
			++( ancestor == LW_INVALID_INDEX ? worldCases : relativeCases );
			double bound = lwi_motion_bound( motion.table, motion.scratch, body, ancestor );
			double rounding = lwi_motion_rounding( motion.scratch );
			EXPECT_LE( rounding, 1e-10 );
			double longest = longestPath( model, poses, body, ancestor, bound, 4 * rounding );
			EXPECT_LE( longest, bound + 4 * steps * rounding );
			if ( longest > 1e-4 )
			{
				( isShort ? shortRatios : longRatios ).push_back( longest / bound );
			}
		}
	}
	std::sort( shortRatios.begin(), shortRatios.end() );
	std::sort( longRatios.begin(), longRatios.end() );
	ASSERT_GE( shortRatios.size(), 500u );
	ASSERT_GE( longRatios.size(), 500u );
	double shortMedian = shortRatios[shortRatios.size() / 2], longMedian = longRatios[longRatios.size() / 2];
	std::printf( "path / bound: short edges median %.3f largest %.6f, long edges median %.3f largest %.6f\n", shortMedian,
	    shortRatios.back(), longMedian, longRatios.back() );
	EXPECT_GE( shortMedian, 0.5 );
	EXPECT_GE( longMedian, 0.25 );
	EXPECT_GE( worldCases, 1000 );
	EXPECT_GE( relativeCases, 1000 );
	EXPECT_GE( outside, 100 );
}

// Shifts of joints below one that turns add up. A large share leaves rings as the only bound above the first joint.
TEST( MotionBound, NoPointOfATelescopeTravelsFurtherThanTheBound )
{
	SeededRng rng;
	int tight = 0;
	constexpr int rounds = 200, steps = 40;
	for ( int round = 0; round < rounds; ++round )
	{
		const RobotModel model = telescope( rng );
		RobotPtr robot = model.create();
		ASSERT_NE( robot, nullptr );
		Motion measured( robot.get() ), ringed( robot.get() );
		State a( lw_robot_variable_count( robot.get() ) );
		const double side = rng.integer( 0, 1 ) ? 1 : -1;
		for ( double& value : a )
		{
			value = side * rng.uniform( 0.5, 1 ); // all stages out, or all in
		}
		State b = a;
		b[0] += rng.uniform( -1, 1 );
		ASSERT_TRUE( lwi_motion_measure( measured.table, a.data(), b.data(), measured.scratch ) );
		std::vector<std::vector<lw_transform>> poses;
		for ( int k = 0; k <= steps; ++k )
		{
			State q( a.size() );
			lw_robot_interpolate( robot.get(), a.data(), b.data(), static_cast<double>( k ) / steps, q.data() );
			poses.emplace_back( lw_robot_link_count( robot.get() ) );
			ASSERT_EQ( lw_robot_fk( robot.get(), q.data(), poses.back().data() ), LW_OK );
		}
		ASSERT_TRUE( lwi_motion_begin( ringed.table, a.data(), b.data(), ringed.scratch ) );
		lwi_motion_place( ringed.table, ringed.scratch, poses[0].data() );
		lwi_motion_measure_body( ringed.table, ringed.scratch, 0, poses[0].data(), 1e6 );
		const double rounding = lwi_motion_rounding( measured.scratch );
		const double bound = lwi_motion_bound( measured.table, measured.scratch, 0, LW_INVALID_INDEX );
		const double ringBound = lwi_motion_of( ringed.table, ringed.scratch, 0, LW_INVALID_INDEX ).path;
		const double longest = longestPath( model, poses, 0, LW_INVALID_INDEX, bound, 4 * rounding );
		EXPECT_LE( longest, bound + 4 * steps * rounding ) << "round " << round;
		EXPECT_LE( longest, ringBound + 4 * steps * rounding ) << "round " << round;
		tight += longest > 0.9 * bound;
	}
	EXPECT_GE( tight, rounds / 2 );
}

namespace
{

std::vector<lw_transform> posesAt( const lw_robot* robot, const State& a, const State& b, double t )
{
	State q( a.size() );
	lw_robot_interpolate( robot, a.data(), b.data(), t, q.data() );
	std::vector<lw_transform> poses( lw_robot_link_count( robot ) );
	EXPECT_EQ( lw_robot_fk( robot, q.data(), poses.data() ), LW_OK );
	return poses;
}

/// Poses at `steps` + 1 states from `from` to `to`.
std::vector<std::vector<lw_transform>> posesBetween(
    const lw_robot* robot, const State& a, const State& b, double from, double to, int steps )
{
	std::vector<std::vector<lw_transform>> poses;
	for ( int k = 0; k <= steps; ++k )
	{
		poses.push_back( posesAt( robot, a, b, from + ( to - from ) * k / steps ) );
	}
	return poses;
}

/// Where these have a point of a body, seen from an ancestor or the world.
std::vector<lw_vec3> wayOf(
    const std::vector<std::vector<lw_transform>>& poses, std::uint32_t ancestor, const lw_body_def& body, lw_vec3 point )
{
	const bool inWorld = ancestor == LW_INVALID_INDEX;
	std::vector<lw_vec3> way;
	for ( const std::vector<lw_transform>& now : poses )
	{
		way.push_back( position( now[inWorld ? 0 : ancestor], inWorld, now[body.link], body, point ) );
	}
	return way;
}

double furthestBetween( double chord, lwi_motion_rate rate, double h )
{
	return lwi_motion_between( chord, lwi_chord_error_of( rate, h ), h * rate.path );
}

} // namespace

// States beside an edge, each joint off by its tolerance at most. Bounds by the pose and by the axis radii each decide alone in
// some rounds: a share of a million edges spoils the first.
TEST( MotionBound, NoPointIsFartherFromItsPlaceOnTheEdgeThanTheTube )
{
	SeededRng rng;
	std::vector<double> ratios;
	for ( int i = 0; i < 1500; ++i )
	{
		RobotModel model = anyRobot( rng );
		RobotPtr robot = model.create();
		ASSERT_NE( robot, nullptr );
		Motion motion( robot.get() );
		const State a = randomState( rng, robot.get(), 0 ), b = rng.integer( 0, 1 ) ? randomState( rng, robot.get(), 0 ) : a;
		State tolerance( a.size() );
		const double scale = rng.decade( -3, 0.5 );
		const bool few = rng.integer( 0, 1 ) == 1;
		for ( std::size_t v = 0; v < a.size(); ++v )
		{
			const lw_variable_info info = lw_robot_variable( robot.get(), static_cast<std::uint32_t>( v ) );
			const bool quaternion =
			    lw_robot_joint_type( robot.get(), info.joint ) == LW_JOINT_FLOATING && info.component >= 3;
			tolerance[v] = quaternion || ( few && rng.integer( 0, 1 ) ) ? 0 : scale * rng.uniform( 0, 1 );
		}
		ASSERT_TRUE( lwi_motion_begin( motion.table, a.data(), b.data(), motion.scratch ) );
		lwi_motion_tolerate( motion.table, motion.scratch, tolerance.data(), nullptr );
		const double measured = rng.uniform( 0, 1 );
		const std::vector<lw_transform> pose = posesAt( robot.get(), a, b, measured );
		lwi_motion_place( motion.table, motion.scratch, pose.data() );
		const double share = rng.integer( 0, 2 ) == 0 ? 1e6 : std::max( measured, 1 - measured );
		const double rounding = 4 * lwi_motion_rounding( motion.scratch );
		for ( std::uint32_t body = 0; body < lw_robot_body_count( robot.get() ); ++body )
		{
			lwi_motion_measure_body( motion.table, motion.scratch, body, pose.data(), share );
			const std::uint32_t ancestor = randomAncestor( rng, robot.get(), model.bodies[body].link );
			const double tube = lwi_motion_tube_of( motion.table, motion.scratch, body, ancestor ).timely;
			EXPECT_LE( tube, lwi_motion_largest_tube( motion.scratch ) );
			double farthest = 0;
			for ( int k = 0; k < 8; ++k )
			{
				const double t = k == 0 ? measured : rng.uniform( 0, 1 );
				State q( a.size() ), beside;
				lw_robot_interpolate( robot.get(), a.data(), b.data(), t, q.data() );
				beside = q;
				for ( std::size_t v = 0; v < q.size(); ++v )
				{
					beside[v] += tolerance[v] * ( rng.integer( 0, 1 ) ? 1 : -1 );
				}
				const std::vector<std::vector<lw_transform>> poses = {
				    posesAt( robot.get(), q, q, 0 ), posesAt( robot.get(), beside, beside, 0 ) };
				for ( const lw_vec3 p : model.bodyPoints[body] )
				{
					const std::vector<lw_vec3> way = wayOf( poses, ancestor, model.bodies[body], p );
					farthest = std::max( farthest, distance( way[0], way[1] ) );
				}
			}
			EXPECT_LE( farthest, tube + rounding ) << "robot " << i << ", body " << body;
			if ( tube > 0 )
			{
				ratios.push_back( farthest / tube );
			}
		}
	}
	std::sort( ratios.begin(), ratios.end() );
	EXPECT_GT( ratios[ratios.size() * 9 / 10], 0.8 ) << "the tubes are wide beyond use";
}

// Between two states of an edge, from where a point is at both and how fast its velocity can change: joints whose motions
// cancel each other move little, which the path length does not see. Rates are measured anywhere on the edge.
TEST( MotionBound, NoPointGetsFurtherBetweenTwoStatesThanItsAccelerationAllows )
{
	SeededRng rng;
	std::vector<double> ratios, gains;
	for ( int i = 0; i < 700; ++i )
	{
		RobotModel model = anyRobot( rng );
		RobotPtr robot = model.create();
		ASSERT_NE( robot, nullptr );
		Motion motion( robot.get() );
		double excess = rng.integer( 0, 2 ) == 0 ? rng.decade( -1, 1 ) : 0;
		State a = randomState( rng, robot.get(), excess ), b = randomState( rng, robot.get(), excess );
		ASSERT_TRUE( lwi_motion_begin( motion.table, a.data(), b.data(), motion.scratch ) );
		double h = rng.decade( -3, 0 ), from = rng.uniform( 0, 1 - h ), measured = rng.uniform( 0, 1 );
		double share = std::max( measured, 1 - measured );
		std::vector<lw_transform> reference = posesAt( robot.get(), a, b, measured );
		lwi_motion_place( motion.table, motion.scratch, reference.data() );
		const std::vector<std::vector<lw_transform>> between = posesBetween( robot.get(), a, b, from, from + h, 12 );
		for ( std::uint32_t body = 0; body < model.bodies.size(); ++body )
		{
			const lw_body_def& def = model.bodies[body];
			std::uint32_t ancestor = randomAncestor( rng, robot.get(), def.link );
			lwi_motion_measure_body( motion.table, motion.scratch, body, reference.data(), share );
			const lwi_motion_rate rate = lwi_motion_of( motion.table, motion.scratch, body, ancestor );
			double rounding = lwi_motion_rounding( motion.scratch );
			for ( lw_vec3 p : model.bodyPoints[body] )
			{
				const std::vector<lw_vec3> at = wayOf( between, ancestor, def, p );
				double chord = distance( at.front(), at.back() ), furthest = 0;
				for ( const lw_vec3& x : at )
				{
					furthest = std::max( furthest, distance( at.front(), x ) );
				}
				double bound = furthestBetween( chord + 4 * rounding, rate, h );
				ASSERT_LE( furthest, bound + 4 * rounding ) << "part of length " << h << " from " << from;
				if ( furthest > 1e-6 )
				{
					ratios.push_back( furthest / bound );
					gains.push_back( h * rate.path / bound );
				}
			}
		}
	}
	std::sort( ratios.begin(), ratios.end() );
	std::sort( gains.begin(), gains.end() );
	std::printf( "moved / bound: median %.3f, largest %.6f; path / bound: median %.2f, largest %.1f\n",
	    ratios[ratios.size() / 2], ratios.back(), gains[gains.size() / 2], gains.back() );
	ASSERT_GE( ratios.size(), 1000u );
	EXPECT_GE( ratios[ratios.size() / 2], 0.5 );
	EXPECT_GE( gains.back(), 5 ) << "never any better than the path length";
}

namespace
{

/// A random curve of all variables but quaternions, and its ranges: values from control points, derivatives from a dense row.
struct RandomCurve
{
	int degree;
	std::vector<State> points;
	State least, most, speed, change;

	RandomCurve( SeededRng& rng, const lw_robot* robot ) : degree( rng.integer( 1, 7 ) )
	{
		const State a = randomState( rng, robot, 0 );
		const double bend = rng.decade( -2, 0.5 );
		points.assign( static_cast<std::size_t>( degree ) + 1, a );
		for ( std::size_t v = 0; v < a.size(); ++v )
		{
			const lw_variable_info info = lw_robot_variable( robot, static_cast<std::uint32_t>( v ) );
			const bool quaternion = lw_robot_joint_type( robot, info.joint ) == LW_JOINT_FLOATING && info.component >= 3;
			const bool stays = quaternion || rng.integer( 0, 3 ) == 0;
			for ( std::size_t i = 1; i < points.size(); ++i )
			{
				points[i][v] += stays ? 0 : bend * rng.uniform( -1, 1 );
			}
		}
		least = most = a;
		speed = change = State( a.size(), 0.0 );
		for ( std::size_t v = 0; v < a.size(); ++v )
		{
			for ( const State& p : points )
			{
				least[v] = std::min( least[v], p[v] );
				most[v] = std::max( most[v], p[v] );
			}
			for ( int k = 0; k <= 300 && least[v] < most[v]; ++k )
			{
				speed[v] = std::max( speed[v], 1.001 * std::abs( derivative( v, k / 300.0, 1 ) ) );
				change[v] = std::max( change[v], 1.001 * std::abs( derivative( v, k / 300.0, 2 ) ) );
			}
		}
	}

	State at( double t ) const
	{
		State q( least.size() );
		for ( std::size_t v = 0; v < q.size(); ++v )
		{
			q[v] = least[v] < most[v] ? derivative( v, t, 0 ) : least[v];
		}
		return q;
	}

	/// By Newton's form: the k-th forward differences times binomials.
	double derivative( std::size_t v, double t, int order ) const
	{
		if ( order > degree )
		{
			return 0;
		}
		std::vector<double> p;
		for ( const State& point : points )
		{
			p.push_back( point[v] );
		}
		double factor = 1;
		for ( int k = 0; k < order; ++k )
		{
			factor *= degree - k;
			for ( std::size_t i = 0; i + 1 < p.size(); ++i )
			{
				p[i] = p[i + 1] - p[i];
			}
			p.pop_back();
		}
		const int n = degree - order;
		double sum = 0, binomial = 1;
		for ( int i = 0; i <= n; ++i )
		{
			sum += binomial * std::pow( t, i ) * std::pow( 1 - t, n - i ) * p[static_cast<std::size_t>( i )];
			binomial *= static_cast<double>( n - i ) / ( i + 1 );
		}
		return factor * sum;
	}

	lwi_motion_ranges ranges() const { return { least.data(), most.data(), speed.data(), change.data() }; }
};

} // namespace

// Three places of a point, equally far apart in t: their second difference is at most the squared step times the acceleration.
// Joints of a curve speed up and slow down, which a straight edge's do not.
TEST( MotionBound, NoPointOfACurveSpeedsUpMoreThanTheBound )
{
	SeededRng rng;
	std::vector<double> ratios;
	double fastest = 0;
	for ( int i = 0; i < 1500; ++i )
	{
		RobotModel model = anyRobot( rng );
		RobotPtr robot = model.create();
		ASSERT_NE( robot, nullptr );
		Motion motion( robot.get() );
		const RandomCurve curve( rng, robot.get() );
		const lwi_motion_ranges ranges = curve.ranges();
		ASSERT_TRUE( lwi_motion_begin_curve( motion.table, &ranges, motion.scratch ) );
		const double measured = rng.uniform( 0, 1 ), step = rng.decade( -2.5, -0.5 ), from = rng.uniform( 0, 1 - 2 * step );
		const auto poses = [&]( double t )
		{
			const State q = curve.at( t );
			return posesAt( robot.get(), q, q, 0 );
		};
		const std::vector<std::vector<lw_transform>> three = {
		    poses( from ), poses( from + step ), poses( from + 2 * step ) };
		const std::vector<lw_transform> reference = poses( measured );
		lwi_motion_place( motion.table, motion.scratch, reference.data() );
		const double share = rng.integer( 0, 2 ) == 0 ? 1e6 : std::max( measured, 1 - measured );
		const double rounding = 8 * lwi_motion_rounding( motion.scratch );
		for ( std::uint32_t body = 0; body < model.bodies.size(); ++body )
		{
			const std::uint32_t ancestor = randomAncestor( rng, robot.get(), model.bodies[body].link );
			lwi_motion_measure_body( motion.table, motion.scratch, body, reference.data(), share );
			const lwi_motion_rate rate = lwi_motion_of( motion.table, motion.scratch, body, ancestor );
			for ( const lw_vec3 p : model.bodyPoints[body] )
			{
				const std::vector<lw_vec3> x = wayOf( three, ancestor, model.bodies[body], p );
				const lw_vec3 mean = { 0.5 * ( x[0].x + x[2].x ), 0.5 * ( x[0].y + x[2].y ), 0.5 * ( x[0].z + x[2].z ) };
				const double second = 2 * distance( mean, x[1] ), way = distance( x[0], x[1] );
				ASSERT_LE( second, step * step * rate.change + rounding ) << "robot " << i << ", degree " << curve.degree;
				ASSERT_LE( way, step * rate.path + rounding ) << "robot " << i << ", degree " << curve.degree;
				fastest = std::max( fastest, rate.path > 0 ? way / ( step * rate.path ) : 0 );
				if ( second > 1e-9 )
				{
					ratios.push_back( second / ( step * step * rate.change ) );
				}
			}
		}
	}
	std::sort( ratios.begin(), ratios.end() );
	ASSERT_GE( ratios.size(), 1000u );
	std::printf( "second difference / bound: median %.3f, largest %.6f\n", ratios[ratios.size() / 2], ratios.back() );
	EXPECT_GT( ratios.back(), 0.9 );
	EXPECT_GT( fastest, 0.9 );
}

// A speed limit for the whole edge, measured from a pose near an end: from there points get twice as far as from the middle.
// A slide carries a small body away from the axis about which the whole turns.
TEST( MotionBound, StepIsLongerThanMeasuredFromAPoseNearAnEnd )
{
	SeededRng rng;
	double tightest = 0;
	for ( int i = 0; i < 300; ++i )
	{
		RobotModel model;
		model.link( "root" );
		for ( std::uint32_t k = 0; k < 2; ++k )
		{
			lw_joint_def& joint =
			    model.joint( "l" + std::to_string( k ), k == 0 ? LW_JOINT_REVOLUTE : LW_JOINT_PRISMATIC, k );
			joint.parent_from_joint = lw_transform_identity();
			joint.parent_from_joint.t[0] = rng.uniform( -0.02, 0.02 );
			joint.axis[0] = k == 0 ? 0 : 1;
			joint.axis[2] = k == 0 ? 1 : rng.uniform( -0.5, 0.5 );
		}
		std::vector<lw_vec3> points;
		lw_shape* shape = randomMesh( rng, 2, 0.005, &points );
		model.body( 2, shape, lw_transform_identity(), points );
		RobotPtr robot = model.create();
		Motion motion( robot.get() );
		State a = { rng.uniform( -3, 0 ), 0 }, b = { a[0] + rng.uniform( 1, 6 ), rng.uniform( 0.3, 1 ) };
		const double measured = rng.integer( 0, 1 ) == 0 ? 0 : rng.uniform( 0, 1 );
		ASSERT_TRUE( lwi_motion_begin( motion.table, a.data(), b.data(), motion.scratch ) );
		const std::vector<lw_transform> reference = posesAt( robot.get(), a, b, measured );
		lwi_motion_place( motion.table, motion.scratch, reference.data() );
		lwi_motion_measure_body( motion.table, motion.scratch, 0, reference.data(), std::max( measured, 1 - measured ) );
		const double bound = lwi_motion_of( motion.table, motion.scratch, 0, LW_INVALID_INDEX ).path;
		const int steps = 200;
		const std::vector<std::vector<lw_transform>> poses = posesBetween( robot.get(), a, b, 0, 1, steps );
		for ( lw_vec3 p : points )
		{
			const std::vector<lw_vec3> at = wayOf( poses, LW_INVALID_INDEX, model.bodies[0], p );
			for ( std::size_t k = 0; k + 1 < at.size(); ++k )
			{
				const double speed = steps * distance( at[k], at[k + 1] );
				EXPECT_LE( speed, bound * ( 1 + 1e-9 ) + 1e-9 ) << "measured at " << measured << ", step " << k;
				tightest = std::max( tightest, speed / bound );
			}
		}
	}
	EXPECT_GE( tightest, 0.75 );
}

// A slide that undoes the velocity of two turns: there and back again, both ends are one place and all that is left is
// acceleration, in which the two turns and their product have equal parts. The bound is then exact up to third order:
// anything missing in it shows.
TEST( MotionBound, WhereVelocitiesCancelAccelerationIsLeft )
{
	const double upper_arm = 0.5, forearm = 0.3, radius = 1e-9;
	RobotModel model;
	model.link( "base" );
	model.joint( "slide", LW_JOINT_PRISMATIC, 0 ).axis[2] = 0;
	model.joints.back().axis[1] = 1;
	model.joint( "upper_arm", LW_JOINT_REVOLUTE, 1 );
	model.joint( "forearm", LW_JOINT_REVOLUTE, 2 ).parent_from_joint.t[0] = upper_arm;
	lw_shape* ball = nullptr;
	const double dimensions[3] = { radius, 0, 0 };
	ASSERT_EQ( lw_shape_create_primitive( LW_SHAPE_SPHERE, dimensions, nullptr, nullptr, &ball ), LW_OK );
	lw_transform pose = lw_transform_identity();
	pose.t[0] = forearm;
	model.body( 3, ball, pose );
	RobotPtr robot = model.create();
	ASSERT_NE( robot, nullptr );
	Motion motion( robot.get() );
	for ( double rate_2 : { 0.0, 0.02, 0.03 } )
	{
		double rate_1 = 0.02, slide = -rate_1 * ( upper_arm + forearm ) - rate_2 * forearm;
		State a = { -0.5 * slide, -0.5 * rate_1, -0.5 * rate_2 }, b = { 0.5 * slide, 0.5 * rate_1, 0.5 * rate_2 };
		ASSERT_TRUE( lwi_motion_begin( motion.table, a.data(), b.data(), motion.scratch ) );
		std::vector<lw_transform> start = posesAt( robot.get(), a, b, 0 ), center = posesAt( robot.get(), a, b, 0.5 ),
		                          end = posesAt( robot.get(), a, b, 1 );
		lwi_motion_place( motion.table, motion.scratch, center.data() );
		lwi_motion_measure_body( motion.table, motion.scratch, 0, center.data(), 0.5 );
		const lw_vec3 tip = { forearm, 0, 0 };
		double chord = distance( lw_transform_point( &start[3], tip ), lw_transform_point( &end[3], tip ) );
		double moved = distance( lw_transform_point( &start[3], tip ), lw_transform_point( &center[3], tip ) );
		EXPECT_LT( chord, 0.05 * moved );
		double bound = furthestBetween( chord, lwi_motion_of( motion.table, motion.scratch, 0, LW_INVALID_INDEX ), 1 );
		EXPECT_LE( moved, bound );
		EXPECT_GE( moved, 0.95 * bound ) << "rate " << rate_2;
	}
}

// One revolute joint and a body far from the centre of its sphere: the bound is the arc of the farthest vertex.
TEST( MotionBound, FirstJointSeesTheVerticesNotTheirSphere )
{
	RobotModel model;
	model.link( "base" );
	model.joint( "arm", LW_JOINT_REVOLUTE, 0 );
	double rod[9] = { 0, 0.01, -1, 0, 0.01, 1, 0.01, 0, 0 };
	std::uint32_t indices[3] = { 0, 1, 2 };
	lw_mesh_def mesh = lw_mesh_def_default();
	mesh.vertices = rod;
	mesh.vertex_count = 3;
	mesh.indices = indices;
	mesh.triangle_count = 1;
	lw_shape* shape = nullptr;
	ASSERT_EQ( lw_shape_create_mesh( &mesh, nullptr, nullptr, &shape ), LW_OK );
	model.body( 1, shape, lw_transform_identity() );
	RobotPtr robot = model.create();
	Motion motion( robot.get() );
	State a = { -1 }, b = { 1.5 };
	ASSERT_TRUE( lwi_motion_measure( motion.table, a.data(), b.data(), motion.scratch ) );
	double bound = lwi_motion_bound( motion.table, motion.scratch, 0, LW_INVALID_INDEX );
	EXPECT_GE( bound, 2.5 * 0.01 );
	EXPECT_LE( bound, 2.5 * 0.01 * ( 1 + 1e-9 ) );
}

TEST( MotionBound, OnlyJointsBelowTheAncestorCount )
{
	SeededRng rng;
	for ( int i = 0; i < 100; ++i )
	{
		RobotModel model = randomRobot( rng, {} );
		RobotPtr robot = model.create();
		Motion motion( robot.get() );
		State a = randomState( rng, robot.get() ), b = randomState( rng, robot.get() );
		ASSERT_TRUE( lwi_motion_measure( motion.table, a.data(), b.data(), motion.scratch ) );
		for ( std::uint32_t body = 0; body < model.bodies.size(); ++body )
		{
			std::uint32_t link = model.bodies[body].link;
			double last = lwi_motion_bound( motion.table, motion.scratch, body, link );
			EXPECT_EQ( last, 0 );
			for ( std::uint32_t j = lw_robot_link_joint( robot.get(), link ); j != LW_INVALID_INDEX;
			      j = lw_robot_link_joint( robot.get(), link ) )
			{
				link = lw_robot_joint_parent( robot.get(), j );
				double next = lwi_motion_bound( motion.table, motion.scratch, body, link );
				EXPECT_GE( next, last );
				last = next;
			}
			EXPECT_EQ( last, lwi_motion_bound( motion.table, motion.scratch, body, LW_INVALID_INDEX ) );
		}
		// nothing moves: exactly nothing
		ASSERT_TRUE( lwi_motion_measure( motion.table, a.data(), a.data(), motion.scratch ) );
		for ( std::uint32_t body = 0; body < model.bodies.size(); ++body )
		{
			EXPECT_EQ( lwi_motion_bound( motion.table, motion.scratch, body, LW_INVALID_INDEX ), 0 );
		}
	}
}

// A table that knows the variables that stand still gives valid bounds, mostly tighter ones.
TEST( MotionBound, FixedVariablesKeepTheBoundValid )
{
	SeededRng rng;
	int tighter = 0, looser = 0;
	for ( int i = 0; i < 200; ++i )
	{
		RobotModel model = randomRobot( rng, {} );
		RobotPtr robot = model.create();
		std::uint32_t count = lw_robot_variable_count( robot.get() );
		State reference = randomState( rng, robot.get() );
		State a = randomState( rng, robot.get() ), b = randomState( rng, robot.get() );
		std::unique_ptr<bool[]> fixed( new bool[count + 1]() );
		for ( std::uint32_t j = 0; j < lw_robot_joint_count( robot.get() ); ++j )
		{
			bool hold = rng.integer( 0, 1 ) == 1;
			for ( std::uint32_t k = 0; k < lw_robot_joint_variable_count( robot.get(), j ); ++k )
			{
				std::uint32_t v = lw_robot_joint_variable( robot.get(), j ) + k;
				fixed[v] = hold;
				a[v] = hold ? reference[v] : a[v];
				b[v] = hold ? reference[v] : b[v];
			}
		}
		Motion general( robot.get() ), special( robot.get(), fixed.get(), reference.data() );
		ASSERT_TRUE( lwi_motion_measure( general.table, a.data(), b.data(), general.scratch ) );
		ASSERT_TRUE( lwi_motion_measure( special.table, a.data(), b.data(), special.scratch ) );
		std::vector<std::vector<lw_transform>> poses;
		for ( int k = 0; k <= 20; ++k )
		{
			State q( a.size() );
			lw_robot_interpolate( robot.get(), a.data(), b.data(), k / 20.0, q.data() );
			poses.emplace_back( lw_robot_link_count( robot.get() ) );
			ASSERT_EQ( lw_robot_fk( robot.get(), q.data(), poses.back().data() ), LW_OK );
		}
		for ( std::uint32_t body = 0; body < model.bodies.size(); ++body )
		{
			std::uint32_t ancestor = randomAncestor( rng, robot.get(), model.bodies[body].link );
			double loose = lwi_motion_bound( general.table, general.scratch, body, ancestor );
			double tight = lwi_motion_bound( special.table, special.scratch, body, ancestor );
			tighter += tight < 0.99 * loose ? 1 : 0;
			looser += tight > 1.01 * loose ? 1 : 0;
			EXPECT_LE( longestPath( model, poses, body, ancestor, tight, 1e-11 ), tight + 1e-9 );
		}
	}
	std::printf( "tighter %d, looser %d\n", tighter, looser );
	EXPECT_GE( tighter, 5 );
	EXPECT_LE( looser, tighter ); // the rings of the two tables have other centres, so that a few may be looser
}

TEST( MotionBound, OverflowAndZeroQuaternionAreRefused )
{
	SeededRng rng;
	RobotModel model;
	model.link( "base" );
	model.joint( "lift", LW_JOINT_PRISMATIC, 0 );
	model.joint( "drone", LW_JOINT_FLOATING, 1 );
	model.body( 2, randomMesh( rng, 2, 0.1, nullptr ), lw_transform_identity() );
	RobotPtr robot = model.create();
	Motion motion( robot.get() );
	State a = { 0, 0, 0, 0, 0, 0, 0, 1 }, b = a;
	EXPECT_TRUE( lwi_motion_measure( motion.table, a.data(), b.data(), motion.scratch ) );
	a[0] = -1e308;
	b[0] = 1e308;
	EXPECT_FALSE( lwi_motion_measure( motion.table, a.data(), b.data(), motion.scratch ) );
	a[0] = b[0] = 0;
	b[7] = 0;
	EXPECT_FALSE( lwi_motion_measure( motion.table, a.data(), b.data(), motion.scratch ) );
}
