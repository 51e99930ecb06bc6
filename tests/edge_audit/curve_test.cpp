// SPDX-License-Identifier: BSD-3-Clause
// Polynomial motions: a FREE curve, or a motion within its tolerance, that comes too near to something.
#include "audit_fixture.hpp"
#include "one_obstacle.hpp"
#include "random_world.hpp"

#include <gtest/gtest.h>

namespace
{

using Points = std::vector<double>; ///< [degree + 1][size]

struct Curve
{
	unsigned degree;
	Points points;

	/// By Bernstein polynomials, not by de Casteljau.
	std::vector<double> at( double t ) const
	{
		const std::size_t size = points.size() / ( degree + 1 );
		std::vector<double> q( size, 0.0 );
		for ( unsigned i = 0; i <= degree; ++i )
		{
			double weight = std::pow( t, i ) * std::pow( 1 - t, degree - i );
			for ( unsigned k = 0; k < i; ++k )
			{
				weight *= static_cast<double>( degree - k ) / ( k + 1 );
			}
			for ( std::size_t v = 0; v < size; ++v )
			{
				q[v] += weight * points[i * size + v];
			}
		}
		return q;
	}
};

struct CurveTally
{
	int free = 0, blocked = 0, undecided = 0;
	std::uint64_t queries = 0, edge_queries = 0;
};

bool isQuaternion( const EdgeWorld& world, std::size_t i )
{
	const lw_variable_info info = lw_robot_variable( world.robot.get(), world.variables[i] );
	return lw_robot_joint_type( world.robot.get(), info.joint ) == LW_JOINT_FLOATING && info.component >= 3;
}

/// From near the way of a motion, so that some are free.
Curve randomCurve( const EdgeWorld& world, const Motion& motion, double bend, SeededRng& rng )
{
	Curve curve = { static_cast<unsigned>( rng.integer( 1, 7 ) ), {} };
	for ( unsigned i = 0; i <= curve.degree; ++i )
	{
		for ( std::size_t v = 0; v < world.size(); ++v )
		{
			const bool inside = i > 0 && i < curve.degree;
			const double line = motion.from[v] + ( motion.to[v] - motion.from[v] ) * i / curve.degree;
			const double value = line + ( inside ? bend * rng.uniform( -1, 1 ) : 0 );
			curve.points.push_back( isQuaternion( world, v ) ? motion.from[v] : value );
		}
	}
	return curve;
}

class CurveBench
{
public:
	CurveBench( const EdgeWorld& world, SeededRng& rng ) : m_world( world ), m_bench( world ), m_rng( rng ) {}

	void judge( CurveTally& tally )
	{
		m_last.points.clear();
		const double lengths[] = { 0.1, 0.5, 2, 6 };
		const Motion motion = m_world.randomMotion(
		    m_rng.integer( 0, 1 ), lengths[m_rng.integer( 0, 3 )], m_rng.engine(), m_bench.audit.get() );
		std::vector<double> tolerance( m_world.size(), 0.0 );
		for ( std::size_t v = 0; v < m_world.size() && m_rng.integer( 0, 1 ); ++v )
		{
			tolerance[v] = isQuaternion( m_world, v ) ? 0 : m_rng.decade( -4, -2 );
		}
		lw_edge_def def = lw_edge_def_default();
		def.min_d = m_rng.integer( 0, 1 ) ? 0 : 1e-3;
		def.want_proved_until = m_rng.integer( 0, 1 );
		def.tolerance = m_rng.integer( 0, 1 ) ? tolerance.data() : nullptr;
		const bool tables = m_rng.integer( 0, 1 ) == 1;
		const lw_checker* checker = tables ? m_world.with_tables.get() : m_world.checker.get();
		lw_query* query = tables ? m_bench.tables.get() : m_bench.plain.get();
		// the same curve, bent more and more: the last one that is proved leaves the least room
		SeededRng same = m_rng;
		for ( double bend = m_rng.decade( -3, -1 ); bend < 3; bend *= 1.5 )
		{
			m_rng = same;
			const Curve curve = randomCurve( m_world, motion, bend, m_rng );
			lw_edge_result result;
			ASSERT_EQ( lw_checker_curve( checker, query, curve.points.data(), curve.degree, &def, &result ), LW_OK );
			tally.free += result.verdict == LW_VERDICT_FREE;
			tally.blocked += result.verdict == LW_VERDICT_BLOCKED;
			tally.undecided += result.verdict == LW_VERDICT_UNDECIDED;
			tally.queries += result.verdict == LW_VERDICT_FREE ? result.queries : 0;
			if ( result.verdict == LW_VERDICT_BLOCKED )
			{
				EXPECT_LE( clearance( curve.at( result.t ) ), def.min_d + 1e-9 )
				    << m_world.name << ": BLOCKED at " << result.t;
			}
			m_last = result.verdict == LW_VERDICT_FREE ? curve : m_last;
			m_last_bound = result.verdict == LW_VERDICT_FREE ? result.lower_bound : m_last_bound;
			if ( result.verdict != LW_VERDICT_FREE )
			{
				attack( curve, def, result.proved_until, def.min_d );
				break;
			}
		}
		if ( !m_last.points.empty() )
		{
			attack( m_last, def, 1, m_last_bound );
		}
	}

private:
	double clearance( const std::vector<double>& q ) { return m_bench.auditor.clearance( m_world.full( q ).data() ); }

	/// The least clearance of a dense row of states, looked at closer where it is least.
	void attack( const Curve& curve, const lw_edge_def& def, double until, double bound )
	{
		const int steps = until > 0 ? 200 : 0;
		double least = INFINITY, where = 0;
		const auto look = [&]( double t, bool off )
		{
			std::vector<double> q = curve.at( t );
			for ( std::size_t v = 0; v < q.size() && off && def.tolerance != nullptr; ++v )
			{
				q[v] += ( 1 - 1e-9 ) * def.tolerance[v] * ( m_rng.integer( 0, 1 ) ? 1 : -1 );
			}
			const double found = clearance( q );
			where = found < least ? t : where;
			least = std::min( least, found );
		};
		for ( int i = 0; i < steps; ++i )
		{
			look( until * i / ( steps - 1 ), i % 3 == 0 );
		}
		const double middle = where;
		for ( int i = 0; i < steps; ++i )
		{
			look( std::clamp( middle + until * ( i / 100.0 - 1 ) / steps, 0.0, until ), i % 3 == 0 );
		}
		EXPECT_GT( least, def.min_d - 1e-9 ) << m_world.name << ": proved until " << until << ", too near at " << where;
		EXPECT_GE( least, bound - 1e-9 ) << m_world.name;
	}

	const EdgeWorld& m_world;
	AuditBench m_bench;
	SeededRng& m_rng;
	Curve m_last = { 0, {} };
	double m_last_bound = 0;
};

} // namespace

TEST( Curve, VerdictsOnRandomCurvesSurviveADenseLook )
{
	SeededRng rng;
	CurveTally tally;
	for ( int i = 0; i < unlessSanitized( 80, 15 ); ++i )
	{
		RandomWorldOptions options;
		options.margins = i % 3 == 0;
		options.tables = 0.5;
		const EdgeWorld world = randomWorld( rng.engine()(), options );
		CurveBench bench( world, rng );
		for ( int k = 0; k < 8; ++k )
		{
			bench.judge( tally );
		}
	}
	std::printf( "%d free, %d blocked, %d undecided; %.1f states a free curve\n", tally.free, tally.blocked, tally.undecided,
	    static_cast<double>( tally.queries ) / std::max( 1, tally.free ) );
	EXPECT_GT( tally.free, 20 );
	EXPECT_GT( tally.blocked, unlessSanitized( 20, 1 ) );
}

// A controller that stops at corners drives the edges that were proved.
TEST( Curve, AMotionAlongAFreeEdgeIsFree )
{
	SeededRng rng;
	int free = 0;
	for ( int i = 0; i < 60; ++i )
	{
		RandomWorldOptions options;
		options.tables = 0;
		const EdgeWorld world = randomWorld( rng.engine()(), options );
		AuditBench bench( world );
		const Motion motion = world.randomMotion( false, 1, rng.engine(), bench.audit.get() );
		bool straight = true;
		for ( std::size_t v = 0; v < world.size(); ++v )
		{
			const bool wraps = lw_robot_variable( world.robot.get(), world.variables[v] ).wraps;
			const bool round = wraps && std::abs( motion.to[v] - motion.from[v] ) > 3;
			straight = straight && !round && !( isQuaternion( world, v ) && motion.to[v] != motion.from[v] );
		}
		Points points;
		for ( const double share : { 0.0, 0.0, 0.0, 1.0, 1.0, 1.0 } ) // at rest at both ends
		{
			for ( std::size_t v = 0; v < world.size(); ++v )
			{
				points.push_back( motion.from[v] + share * ( motion.to[v] - motion.from[v] ) );
			}
		}
		const lw_edge_def def = lw_edge_def_default();
		lw_edge_result edge, curve;
		ASSERT_EQ(
		    lw_checker_edge( world.checker.get(), bench.plain.get(), motion.from.data(), motion.to.data(), &def, &edge ),
		    LW_OK );
		if ( straight && edge.verdict == LW_VERDICT_FREE )
		{
			++free;
			lw_query_reset( bench.plain.get() );
			ASSERT_EQ(
			    lw_checker_edge( world.checker.get(), bench.plain.get(), motion.from.data(), motion.to.data(), &def, &edge ),
			    LW_OK );
			lw_query_reset( bench.plain.get() );
			ASSERT_EQ( lw_checker_curve( world.checker.get(), bench.plain.get(), points.data(), 5, &def, &curve ), LW_OK );
			EXPECT_EQ( curve.verdict, LW_VERDICT_FREE ) << world.name;
		}
	}
	EXPECT_GT( free, 10 );
}

// An arm that turns about z by more than half a turn: the shorter way between its ends is the other one.
TEST( Curve, AContinuousJointTurnsAsFarAsItsControlPointsSay )
{
	RobotModel model;
	model.link( "base" );
	lw_joint_def& joint = model.joint( "arm", LW_JOINT_CONTINUOUS, 0 );
	joint.axis[0] = joint.axis[1] = 0;
	joint.axis[2] = 1;
	lw_transform at = lw_transform_identity();
	at.t[0] = 1;
	const double radius[3] = { 0.1, 0, 0 };
	lw_shape *ball = nullptr, *post = nullptr;
	ASSERT_EQ( lw_shape_create_primitive( LW_SHAPE_SPHERE, radius, nullptr, nullptr, &ball ), LW_OK );
	ASSERT_EQ( lw_shape_create_primitive( LW_SHAPE_SPHERE, radius, nullptr, nullptr, &post ), LW_OK );
	model.body( 1, ball, at );
	const RobotPtr robot = model.create();
	const ShapePtr keep( post );
	lw_transform behind = lw_transform_identity();
	behind.t[0] = -1; // at an angle of pi
	const leeway::Scene scene = oneObstacle( post, behind );
	const leeway::Checker checker = checkerOf( robot.get(), scene.get() );
	const leeway::Query query = leeway::makeQuery( checker.get() );
	const lw_edge_def edge = lw_edge_def_default();
	lw_edge_result result;
	const double through[] = { 0.5, 5.8 }, round[] = { 0.5, -0.5 }, turns[] = { 0.5, 3, -3, 7, 0.6 };
	ASSERT_EQ( lw_checker_curve( checker.get(), query.get(), through, 1, &edge, &result ), LW_OK );
	EXPECT_EQ( result.verdict, LW_VERDICT_BLOCKED );
	EXPECT_NEAR( 0.5 + 5.3 * result.t, M_PI, 0.21 );
	ASSERT_EQ( lw_checker_curve( checker.get(), query.get(), round, 1, &edge, &result ), LW_OK );
	EXPECT_EQ( result.verdict, LW_VERDICT_FREE );
	ASSERT_EQ( lw_checker_curve( checker.get(), query.get(), turns, 4, &edge, &result ), LW_OK );
	EXPECT_EQ( result.verdict, LW_VERDICT_FREE ); // its largest value is 1.62
	const double beyond[] = { 0.5, NAN };
	EXPECT_EQ( lw_checker_curve( checker.get(), query.get(), beyond, 1, &edge, &result ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( result.verdict, LW_VERDICT_UNKNOWN );
	EXPECT_EQ( lw_checker_curve( checker.get(), query.get(), turns, 0, &edge, &result ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( lw_checker_curve( checker.get(), query.get(), turns, 8, &edge, &result ), LW_ERROR_INVALID_ARGUMENT );
}

// A ball on a rail that turns back a hair before or behind the face of a block: the whole motion is a deviation from its chord.
TEST( Curve, BallTurnsBackBeyondTheProvedDeviation )
{
	SeededRng rng;
	int free = 0;
	for ( int i = 0; i < 600; ++i )
	{
		const double far = rng.uniform( 0.02, 1 ), gap = ( i % 2 == 0 ? 1 : -1 ) * rng.decade( -5, -2 );
		RobotModel model;
		model.link( "rail" );
		lw_joint_def& joint = model.joint( "ball", LW_JOINT_PRISMATIC, 0 );
		joint.axis[0] = 1;
		joint.axis[1] = joint.axis[2] = 0;
		joint.lower = -2;
		joint.upper = 2;
		const double radius[3] = { 0.1, 0, 0 }, size[3] = { 1, 1, 1 };
		lw_shape *ball = nullptr, *block = nullptr;
		ASSERT_EQ( lw_shape_create_primitive( LW_SHAPE_SPHERE, radius, nullptr, nullptr, &ball ), LW_OK );
		ASSERT_EQ( lw_shape_create_primitive( LW_SHAPE_BOX, size, nullptr, nullptr, &block ), LW_OK );
		model.body( 1, ball, lw_transform_identity() );
		const RobotPtr robot = model.create();
		const ShapePtr keep( block );
		lw_transform behind = lw_transform_identity();
		behind.t[0] = far + gap + 0.1 + 0.5;
		const leeway::Scene scene = oneObstacle( block, behind );
		const leeway::Checker checker = checkerOf( robot.get(), scene.get() );
		const leeway::Query query = leeway::makeQuery( checker.get() );
		const lw_edge_def edge = lw_edge_def_default();
		lw_edge_result result;
		// farthest at t, from the derivative of 3 a t (1 - t)^2 + 3 b t^2 (1 - t)
		const double t = rng.uniform( 0.35, 0.65 ), b = -( 1 - t ) * ( 1 - 3 * t ) / ( t * ( 2 - 3 * t ) );
		const double scale = far / ( 3 * t * ( 1 - t ) * ( 1 - t + b * t ) );
		const double points[] = { 0, scale, b * scale, 0 };
		ASSERT_EQ( lw_checker_curve( checker.get(), query.get(), points, 3, &edge, &result ), LW_OK );
		EXPECT_FALSE( gap < 0 && result.verdict == LW_VERDICT_FREE ) << "far " << far << ", gap " << gap;
		EXPECT_TRUE( gap < edge.slack || result.verdict == LW_VERDICT_FREE ) << "far " << far << ", gap " << gap;
		free += result.verdict == LW_VERDICT_FREE;
	}
	EXPECT_GT( free, 100 );
}

namespace
{

lw_shape* ballOf( double radius )
{
	const double size[3] = { radius, 0, 0 };
	lw_shape* shape = nullptr;
	EXPECT_EQ( lw_shape_create_primitive( LW_SHAPE_SPHERE, size, nullptr, nullptr, &shape ), LW_OK );
	return shape;
}

lw_transform along( double x, double z )
{
	lw_transform at = lw_transform_identity();
	at.t[0] = x;
	at.t[2] = z;
	return at;
}

void addJoint( RobotModel& model, const char* name, lw_joint_type type, std::uint32_t parent, int axis, double limit )
{
	lw_joint_def& joint = model.joint( name, type, parent );
	for ( int k = 0; k < 3; ++k )
	{
		joint.axis[k] = k == axis ? 1 : 0;
	}
	joint.lower = -limit;
	joint.upper = limit;
}

} // namespace

// A ball leaves a post that it touches, faster than in the mean, while an arm turns so far that spheres of eight windows at once
// decide. With the mean speed the first window would begin a centimetre farther away. The ball may follow a joint, faster than it or the
// other way round.
TEST( Curve, EachOfEightWindowsHasItsOwnSpeed )
{
	for ( const auto& [gap, multiplier] : { std::pair( -0.002, 0.0 ), std::pair( 0.002, 0.0 ), std::pair( -0.002, 4.0 ),
	          std::pair( 0.002, 4.0 ), std::pair( -0.002, -4.0 ) } )
	{
		RobotModel model;
		model.link( "base" );
		addJoint( model, "slide", LW_JOINT_PRISMATIC, 0, 0, 4 );
		addJoint( model, "arm", LW_JOINT_REVOLUTE, 0, 2, 4 );
		if ( multiplier != 0 )
		{
			addJoint( model, "follower", LW_JOINT_PRISMATIC, 0, 0, 16 );
			model.joints.back().mimic = 0;
			model.joints.back().mimic_multiplier = multiplier;
		}
		model.body( multiplier != 0 ? 3 : 1, ballOf( 0.1 ), lw_transform_identity() );
		model.body( 2, ballOf( 0.1 ), along( 1, 5 ) );
		const double share = multiplier != 0 ? 1 / multiplier : 1;
		const RobotPtr robot = model.create();
		const ShapePtr post( ballOf( 0.1 ) );
		const leeway::Scene scene = oneObstacle( post.get(), along( 0.2 + gap, 0 ) );
		const leeway::Checker checker = checkerOf( robot.get(), scene.get() );
		const leeway::Query query = leeway::makeQuery( checker.get() );
		const double points[] = { 0, -1.6, -0.19 * share, -0.5333, -0.19 * share, 0.5333, 0, 1.6 };
		const lw_edge_def edge = lw_edge_def_default();
		lw_edge_result result;
		ASSERT_EQ( lw_checker_curve( checker.get(), query.get(), points, 3, &edge, &result ), LW_OK );
		EXPECT_EQ( result.verdict, gap < 0 ? LW_VERDICT_BLOCKED : LW_VERDICT_FREE ) << gap;
	}
}

namespace
{

/// @param seconds for tables of pairs
leeway::Checker checkerWithReach(
    const lw_robot* robot, const lw_scene* scene, double seconds, double max_d = lw_checker_def_default().max_d )
{
	lw_reach_def reach_def = lw_reach_def_default();
	reach_def.robot = robot;
	reach_def.seconds = seconds;
	lw_reach* made = nullptr;
	lw_diag diag = {};
	leeway::require( lw_reach_create( &reach_def, nullptr, &diag, &made ), diag );
	const leeway::Reach reach = leeway::Reach::adopt( made );
	lw_checker_def def = lw_checker_def_default();
	def.robot = robot;
	def.scene = scene;
	def.reach = made;
	def.max_d = max_d;
	lw_checker* checker = nullptr;
	leeway::require( lw_checker_create( &def, nullptr, &diag, &checker ), diag );
	return leeway::Checker::adopt( checker );
}

/// A ball on a slide of 10 cm to both sides, on a joint that hardly turns, and a post of the robot.
struct SlideAndPost
{
	RobotPtr robot;
	leeway::Checker checker;
	leeway::Query query;

	SlideAndPost( double post, double seconds )
	{
		RobotModel model;
		model.link( "base" );
		addJoint( model, "turn", LW_JOINT_REVOLUTE, 0, 2, 0.01 );
		addJoint( model, "slide", LW_JOINT_PRISMATIC, 1, 0, 0.1 );
		model.body( 2, ballOf( 0.1 ), lw_transform_identity() );
		model.body( 0, ballOf( 0.1 ), along( post, 0 ) );
		robot = model.create();
		checker = checkerWithReach( robot.get(), nullptr, seconds );
		query = leeway::makeQuery( checker.get() );
	}

	/// @param values of the slide at the control points
	lw_verdict verdict( const std::vector<double>& values ) const
	{
		Points points;
		for ( const double value : values )
		{
			points.push_back( 0 );
			points.push_back( value );
		}
		const lw_edge_def edge = lw_edge_def_default();
		lw_edge_result result;
		EXPECT_EQ( lw_checker_curve( checker.get(), query.get(), points.data(),
		               static_cast<std::uint32_t>( values.size() - 1 ), &edge, &result ),
		    LW_OK );
		return result.verdict;
	}
};

} // namespace

// Tables of the reach end at the limits. Between its ends a curve may leave them, and a slide that does meets the post.
TEST( Curve, TablesEndWhereItLeavesTheLimits )
{
	const SlideAndPost world( 0.31, 0 );
	EXPECT_EQ( world.verdict( { 0.09, 0.09, 0.08, 0.09 } ), LW_VERDICT_FREE );
	EXPECT_EQ( world.verdict( { 0.09, 0.13, 0.13, 0.09 } ), LW_VERDICT_BLOCKED );
}

// .. whichever of the inner control points is outside of them.
TEST( Curve, TablesEndWhereAnySingleControlPointLeavesTheLimits )
{
	const SlideAndPost world( 0.31, 0 );
	for ( std::size_t degree = 2; degree <= 6; ++degree )
	{
		for ( std::size_t out = 1; out < degree; ++out )
		{
			std::vector<double> values( degree + 1, 0.09 );
			values[out] =
			    0.2; // its weight is 0.3 at least where it is largest: 0.12 is reached, and the post is met at 0.11
			EXPECT_EQ( world.verdict( values ), LW_VERDICT_BLOCKED ) << "point " << out << " of degree " << degree;
		}
	}
}

// A grid has a value for each state: that of one lane proves no other.
TEST( Curve, GridsAreLookedUpForEachStateOfALook )
{
	const SlideAndPost world( 0.29, 1 );
	for ( int first = 0; first < 8; ++first )
	{
		double q[16];
		lw_verdict verdicts[8];
		for ( int i = 0; i < 8; ++i )
		{
			q[2 * i] = 0;
			q[2 * i + 1] = i < first ? -0.0999 : 0.0999; // 0.19 m away from the post, and 1 cm in it
		}
		ASSERT_EQ( lw_checker_states(
		               world.checker.get(), world.query.get(), q, 8, LW_CHECK_SELF, 0, LW_STATES_FULL, verdicts, nullptr ),
		    LW_OK );
		for ( int i = 0; i < 8; ++i )
		{
			EXPECT_EQ( verdicts[i] == LW_VERDICT_FREE, i < first ) << "state " << i << " of " << first;
		}
	}
}

// Grids know the chord. This one is a single state, 4 cm away from the post that the curve meets.
TEST( Curve, GridsOfTheChordLeaveRoomForTheWayBesideIt )
{
	const SlideAndPost world( 0.29, 1 );
	EXPECT_EQ( world.verdict( { 0.05, 0.08, 0.08, 0.08, 0.08, 0.05 } ), LW_VERDICT_FREE );
	EXPECT_EQ( world.verdict( { 0.05, 0.0999, 0.0999, 0.0999, 0.0999, 0.05 } ), LW_VERDICT_BLOCKED );
}

// Obstacles that a robot cannot come near within its limits are left out of rows of spheres. Between its ends a curve may leave the
// limits: a slide that does meets such an obstacle, while an arm turns so far that there are such rows.
TEST( Curve, ObstaclesBeyondTheLimitsAreMetWhereItLeavesThem )
{
	RobotModel model;
	model.link( "base" );
	addJoint( model, "slide", LW_JOINT_PRISMATIC, 0, 0, 0.1 );
	addJoint( model, "arm", LW_JOINT_REVOLUTE, 0, 2, 4 );
	model.body( 1, ballOf( 0.1 ), lw_transform_identity() );
	model.body( 2, ballOf( 0.1 ), along( 1, 5 ) );
	const RobotPtr robot = model.create();
	const ShapePtr post( ballOf( 0.1 ) );
	const leeway::Scene scene = oneObstacle( post.get(), along( 0.4, 0 ) );
	const leeway::Checker checker = checkerWithReach( robot.get(), scene.get(), 0, 0.05 );
	const leeway::Query query = leeway::makeQuery( checker.get() );
	for ( const auto& [first, second] :
	    { std::pair( 0.1, 0.1 ), std::pair( 0.19, 0.19 ), std::pair( 0.25, 0.0 ), std::pair( 0.0, 0.25 ) } )
	{
		const double points[] = { 0.09, -1.6, 0.09 + first, -0.5333, 0.09 + second, 0.5333, 0.09, 1.6 };
		const lw_edge_def edge = lw_edge_def_default();
		lw_edge_result result;
		ASSERT_EQ( lw_checker_curve( checker.get(), query.get(), points, 3, &edge, &result ), LW_OK );
		EXPECT_EQ( result.verdict, first + second > 0.24 ? LW_VERDICT_BLOCKED : LW_VERDICT_FREE )
		    << first << ", " << second; // 0.2 is reached
	}
	// a tolerance that leads beyond the limits
	for ( const double tolerance : { 0.03, 0.13 } )
	{
		const double a[] = { 0.09, -1.6 }, b[] = { 0.09, 1.6 }, tolerances[] = { tolerance, 0 };
		lw_edge_def edge = lw_edge_def_default();
		edge.tolerance = tolerances;
		lw_edge_result result;
		ASSERT_EQ( lw_checker_edge( checker.get(), query.get(), a, b, &edge, &result ), LW_OK );
		EXPECT_EQ( result.verdict == LW_VERDICT_FREE, tolerance < 0.1 ) << tolerance;
	}
}

// A ball turns away from one that hardly moves and that it touches at first: each has its own turn.
TEST( Curve, TwoBodiesOfAShortEdgeHaveTheirOwnTurns )
{
	for ( const double gap : { -0.002, 0.002 } )
	{
		for ( const bool swapped : { false, true } )
		{
			RobotModel model;
			model.link( "base" );
			const std::uint32_t slide = swapped ? 2 : 1, turn = swapped ? 1 : 2;
			if ( swapped )
			{
				addJoint( model, "turn", LW_JOINT_REVOLUTE, 0, 2, 4 );
			}
			addJoint( model, "slide", LW_JOINT_PRISMATIC, 0, 0, 4 );
			if ( !swapped )
			{
				addJoint( model, "turn", LW_JOINT_REVOLUTE, 0, 2, 4 );
			}
			lw_transform beside = along( 1, 0 );
			beside.t[1] = -0.2 - gap;
			model.body( slide, ballOf( 0.1 ), beside );
			model.body( turn, ballOf( 0.1 ), along( 1, 0 ) );
			const RobotPtr robot = model.create();
			const leeway::Checker checker = checkerOf( robot.get(), nullptr );
			const leeway::Query query = leeway::makeQuery( checker.get() );
			const double a[] = { 0, 0 }, b[] = { swapped ? 0.15 : 1e-5, swapped ? 1e-5 : 0.15 };
			const lw_edge_def edge = lw_edge_def_default();
			lw_edge_result result;
			ASSERT_EQ( lw_checker_edge( checker.get(), query.get(), a, b, &edge, &result ), LW_OK );
			EXPECT_EQ( result.verdict, gap < 0 ? LW_VERDICT_BLOCKED : LW_VERDICT_FREE ) << gap << swapped;
		}
	}
}
