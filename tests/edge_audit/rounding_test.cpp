// SPDX-License-Identifier: BSD-3-Clause
// Roundings of corners: a path whose roundings are all FREE, and one of them that comes too near to something.
#include "audit_fixture.hpp"
#include "one_obstacle.hpp"
#include "random_world.hpp"
#include "leeway/motions/roundings.hpp"

#include <gtest/gtest.h>

namespace
{

using leeway::motions::proveRoundings;
using leeway::motions::RoundingProof;

State moved( State a, const State& v, double t )
{
	for ( std::size_t i = 0; i < a.size(); ++i )
	{
		a[i] += t * v[i];
	}
	return a;
}

double lengthOf( const State& v )
{
	double sum = 0;
	for ( const double x : v )
	{
		sum += x * x;
	}
	return std::sqrt( sum );
}

State unit( const State& from, const State& to )
{
	const State way = moved( to, from, -1 );
	return moved( State( way.size(), 0.0 ), way, 1 / lengthOf( way ) );
}

/// One corner of a path, and blends as others make them.
struct Corner
{
	State before, corner, behind;

	State in() const { return unit( before, corner ); }
	State out() const { return unit( corner, behind ); }
	double angle() const
	{
		double cosine = 0;
		const State a = in(), b = out();
		for ( std::size_t i = 0; i < a.size(); ++i )
		{
			cosine += a[i] * b[i];
		}
		return std::acos( std::clamp( cosine, -1.0, 1.0 ) );
	}
	double half() const
	{
		return 0.5 * std::min( lengthOf( moved( corner, before, -1 ) ), lengthOf( moved( behind, corner, -1 ) ) );
	}

	/// The arc of Kunz and Stilman, RSS 2012, equations 1 to 5, at the share t of its angle.
	State arc( double deviation, double t ) const
	{
		const double a = angle(), cut = std::min( half(), deviation * std::sin( a / 2 ) / ( 1 - std::cos( a / 2 ) ) );
		const double radius = cut / std::tan( a / 2 );
		const State y1 = in(), y2 = out(), bisector = unit( y1, y2 );
		const State center = moved( corner, bisector, radius / std::cos( a / 2 ) );
		const State x = unit( center, moved( corner, y1, -cut ) );
		return moved( moved( center, x, radius * std::cos( t * a ) ), y1, radius * std::sin( t * a ) );
	}

	/// A Bezier curve whose control points are on both edges, `inner` of them in the corner; it leaves them at `cut`.
	State bezier( int inner, double cut, double t ) const
	{
		const State a = moved( corner, in(), -cut ), b = moved( corner, out(), cut );
		std::vector<State> row( static_cast<std::size_t>( inner ) + 2, corner );
		row.front() = a;
		row.back() = b;
		for ( ; row.size() > 1; row.pop_back() )
		{
			for ( std::size_t i = 0; i + 1 < row.size(); ++i )
			{
				row[i] = moved( row[i], moved( row[i + 1], row[i], -1 ), t );
			}
		}
		return row.front();
	}
};

constexpr double link_radius = 0.02, ball_radius = 0.02; // metres

struct Tally
{
	int free = 0, blocked = 0, undecided = 0, bisected = 0;
	double nearest = INFINITY; ///< clearance of an attack less the bound
};

class RoundingBench
{
public:
	RoundingBench( const EdgeWorld& world, SeededRng& rng, Tally& tally )
	    : m_world( world ), m_bench( world ), m_rng( rng ), m_tally( tally )
	{
	}

	/// Attacks the widest roundings that are proved: a proof that forgets a part of them goes too far.
	void judge( const Corner& corner )
	{
		const std::vector<State> path = { corner.before, corner.corner, corner.behind };
		lw_edge_def def = lw_edge_def_default();
		def.min_d = m_rng.integer( 0, 1 ) ? 0 : 1e-3;
		double radius = m_rng.decade( -3, -1 ), proved = 0, bound = 0;
		RoundingProof found;
		for ( int i = 0; i < 12; ++i, radius *= 1.6 )
		{
			ASSERT_EQ( proveRoundings( m_world.checker.get(), m_bench.plain.get(), path, radius, def, found ), LW_OK );
			if ( found.verdict != LW_VERDICT_FREE )
			{
				break;
			}
			proved = radius;
			bound = found.lower_bound;
		}
		++( found.verdict == LW_VERDICT_FREE      ? m_tally.free
		    : found.verdict == LW_VERDICT_BLOCKED ? m_tally.blocked
		                                          : m_tally.undecided );
		if ( found.verdict == LW_VERDICT_BLOCKED )
		{
			EXPECT_LE( clearance( found.q ), def.min_d + 1e-9 ) << m_world.name;
		}
		if ( found.verdict != LW_VERDICT_FREE && !found.on_edge && found.free_radius > 0 )
		{
			EXPECT_LT( found.free_radius, radius );
			++m_tally.bisected;
			attack( corner, found.free_radius, def.min_d, def.min_d );
		}
		if ( proved > 0 )
		{
			attack( corner, proved, def.min_d, bound );
		}
	}

private:
	double clearance( const State& q ) { return m_bench.auditor.clearance( m_world.full( q ).data() ); }

	/// A blend as deep as the radius allows, and one that is less deep.
	State blend( const Corner& corner, double radius, int kind, double share, double t )
	{
		if ( kind == 0 )
		{
			return corner.arc( share * radius, t );
		}
		const double sine = std::sin( corner.angle() / 2 );
		// the depth of the middle is the share of the control points that are not in the corner
		const double weight = std::pow( 2.0, -kind ), cut = std::min( corner.half(), 2 * radius / sine );
		return corner.bezier( kind, share * std::min( cut, radius / ( weight * sine ) ), t );
	}

	void attack( const Corner& corner, double radius, double min_d, double bound )
	{
		const double a = corner.angle();
		if ( !( a > 1e-6 && a < M_PI - 1e-6 ) )
		{
			return;
		}
		double least = INFINITY;
		for ( int i = 0; i < 12; ++i )
		{
			const int kind = m_rng.integer( 0, 3 );
			const double share = ( i % 2 == 0 ? 1 : m_rng.uniform( 0, 1 ) ) * ( 1 - 1e-9 );
			for ( int k = 0; k <= 40; ++k )
			{
				least = std::min( least, clearance( blend( corner, radius, kind, share, k / 40.0 ) ) );
			}
		}
		EXPECT_GT( least, min_d - 1e-9 ) << m_world.name << ": a rounding by at most " << radius << " is too near";
		EXPECT_GE( least, bound - 1e-9 ) << m_world.name << ": a rounding by at most " << radius;
		m_tally.nearest = std::min( m_tally.nearest, least - bound );
	}

	const EdgeWorld& m_world;
	AuditBench m_bench;
	SeededRng& m_rng;
	Tally& m_tally;
};

ShapePtr ball( double radius )
{
	const double size[3] = { radius, 0, 0 };
	lw_shape* shape = nullptr;
	leeway::require( lw_shape_create_primitive( LW_SHAPE_SPHERE, size, nullptr, nullptr, &shape ), lw_diag{} );
	return ShapePtr( shape );
}

/// An arm with a ball on each link, some of which are telescopes.
leeway::Robot randomArm( SeededRng& rng )
{
	RobotModel model;
	model.link( "base" );
	const int joints = rng.integer( 2, 5 );
	for ( int i = 0; i < joints; ++i )
	{
		const lw_joint_type type = rng.integer( 0, 4 ) == 0   ? LW_JOINT_PRISMATIC
		                           : rng.integer( 0, 2 ) == 0 ? LW_JOINT_CONTINUOUS
		                                                      : LW_JOINT_REVOLUTE;
		lw_joint_def& joint = model.joint( "j" + std::to_string( i ), type, static_cast<std::uint32_t>( i ) );
		State axis = { rng.uniform( -1, 1 ), rng.uniform( -1, 1 ), rng.uniform( 0.1, 1 ) };
		axis = moved( State( 3, 0.0 ), axis, 1 / lengthOf( axis ) );
		std::copy( axis.begin(), axis.end(), joint.axis );
		joint.lower = -6;
		joint.upper = 6;
		lw_transform at = lw_transform_identity();
		at.t[0] = 0.4;
		joint.parent_from_joint = at;
		model.body( static_cast<std::uint32_t>( i ) + 1, ball( link_radius ).release(), at );
	}
	return leeway::Robot::adopt( model.create().release() );
}

Corner randomCorner( SeededRng& rng, std::size_t size )
{
	const double lengths[] = { 0.3, 0.8, 2 };
	const auto way = [&]
	{
		State out( size );
		for ( double& part : out )
		{
			part = rng.uniform( -1, 1 );
		}
		return moved( State( size, 0.0 ), out, lengths[rng.integer( 0, 2 )] / lengthOf( out ) );
	};
	const State corner = way();
	return { moved( corner, way(), 1 ), corner, moved( corner, way(), 1 ) };
}

/// Balls stand where links of some roundings come, and away from both edges.
std::vector<lw_scene_shape_def> ballsInside(
    SeededRng& rng, const lw_robot* robot, const Corner& corner, const lw_shape* shape )
{
	std::vector<lw_transform> poses( lw_robot_link_count( robot ) );
	const auto places = [&]( const State& q )
	{
		std::vector<State> out;
		leeway::require( lw_robot_fk( robot, q.data(), poses.data() ), lw_diag{} );
		for ( std::size_t i = 1; i < poses.size(); ++i )
		{
			const lw_transform& x = poses[i];
			out.push_back( { x.t[0] + 0.4 * x.r[0][0], x.t[1] + 0.4 * x.r[1][0], x.t[2] + 0.4 * x.r[2][0] } );
		}
		return out;
	};
	std::vector<State> way;
	for ( int k = 0; k <= 200; ++k )
	{
		for ( const State* end : { &corner.before, &corner.behind } )
		{
			const std::vector<State> here = places( moved( corner.corner, moved( *end, corner.corner, -1 ), k / 200.0 ) );
			way.insert( way.end(), here.begin(), here.end() );
		}
	}
	std::vector<lw_scene_shape_def> out;
	for ( int i = 0; i < 40; ++i )
	{
		const std::vector<State> inside =
		    places( corner.bezier( 1, corner.half() * rng.uniform( 0.2, 1 ), rng.uniform( 0, 1 ) ) );
		const State& at = inside[static_cast<std::size_t>( rng.integer( 0, static_cast<int>( inside.size() ) - 1 ) )];
		const bool far = std::all_of( way.begin(), way.end(),
		    [&]( const State& x ) { return lengthOf( moved( x, at, -1 ) ) > link_radius + ball_radius + 0.01; } );
		lw_transform pose = lw_transform_identity();
		std::copy( at.begin(), at.end(), pose.t );
		if ( far )
		{
			out.push_back( { shape, 0, pose } );
		}
	}
	return out;
}

EdgeWorld worldAround( leeway::Robot robot, const std::vector<lw_scene_shape_def>& shapes )
{
	EdgeWorld world;
	world.name = "arm among balls";
	world.robot = std::move( robot );
	const char* name = "balls";
	lw_scene_def def = lw_scene_def_default();
	def.object_names = &name;
	def.object_count = 1;
	def.shapes = shapes.data();
	def.shape_count = static_cast<std::uint32_t>( shapes.size() );
	lw_scene* scene = nullptr;
	leeway::require( lw_scene_create( &def, nullptr, nullptr, &scene ), lw_diag{} );
	world.scene = leeway::Scene::adopt( scene );
	world.reference.assign( lw_robot_variable_count( world.robot.get() ), 0.0 );
	for ( std::uint32_t v = 0; v < world.reference.size(); ++v )
	{
		world.variables.push_back( v );
	}
	world.checker = random_world::makeChecker( world, nullptr );
	world.with_tables = random_world::makeChecker( world, nullptr );
	return world;
}

/// A ball that two telescopes move in a plane, and a post.
struct Plane
{
	RobotPtr robot;
	ShapePtr post;
	leeway::Scene scene;
	leeway::Checker checker;
	leeway::Query query;

	Plane( double x, double y, double radius )
	{
		RobotModel model;
		model.link( "base" );
		for ( int k = 0; k < 2; ++k )
		{
			lw_joint_def& joint = model.joint( k == 0 ? "x" : "y", LW_JOINT_PRISMATIC, static_cast<std::uint32_t>( k ) );
			joint.axis[0] = k == 0;
			joint.axis[1] = k == 1;
			joint.axis[2] = 0;
			joint.lower = -4;
			joint.upper = 4;
		}
		model.body( 2, ball( 0.5 * radius ).release(), lw_transform_identity() );
		post = ball( 0.5 * radius );
		robot = model.create();
		lw_transform at = lw_transform_identity();
		at.t[0] = x;
		at.t[1] = y;
		scene = oneObstacle( post.get(), at );
		checker = checkerOf( robot.get(), scene.get() );
		query = leeway::makeQuery( checker.get() );
	}

	RoundingProof ask( const std::vector<State>& path, double radius, const State& tolerance = {} )
	{
		RoundingProof out;
		lw_edge_def def = lw_edge_def_default();
		def.tolerance = tolerance.empty() ? nullptr : tolerance.data();
		EXPECT_EQ( proveRoundings( checker.get(), query.get(), path, radius, def, out ), LW_OK );
		return out;
	}
};

} // namespace

TEST( Roundings, BlendsOfAFreeCornerStayFree )
{
	SeededRng rng;
	Tally tally;
	const ShapePtr obstacle = ball( ball_radius );
	const int wanted = unlessSanitized( 40, 1 ); // corners that are free up to a radius: one of ten
	for ( int i = 0; i < unlessSanitized( 400, 40 ) || ( tally.bisected <= wanted && i < 2000 ); ++i )
	{
		leeway::Robot robot = randomArm( rng );
		const Corner corner = randomCorner( rng, lw_robot_variable_count( robot.get() ) );
		const std::vector<lw_scene_shape_def> balls = ballsInside( rng, robot.get(), corner, obstacle.get() );
		const EdgeWorld world = worldAround( std::move( robot ), balls );
		RoundingBench( world, rng, tally ).judge( corner );
	}
	std::printf( "%d free, %d blocked, %d undecided, %d free up to a radius; nearest attack %.3g m above the bound\n",
	    tally.free, tally.blocked, tally.undecided, tally.bisected, tally.nearest );
	EXPECT_GT( tally.bisected, wanted );
}

// The corner is the origin, and a post stands on its bisector, so that an arc which passes the corner at `touching` touches it.
TEST( Roundings, LargestFreeRadiusIsThatOfTheArcThatTouchesAPost )
{
	for ( const double angle : { 0.3, 1.0, 1.5708, 2.2 } )
	{
		// directions -angle / 2 and angle / 2 about x; the bisector is y
		const double x = std::cos( angle / 2 ), y = std::sin( angle / 2 ), size = 0.2;
		const double deepest = 3.9 / 2 * std::tan( angle / 4 ); // of arcs: edges end
		const double touching = std::min( 0.8, 0.5 * deepest );
		Plane plane( 0, touching + size, size );
		const std::vector<State> path = { { -3.9 * x, 3.9 * y }, { 0, 0 }, { 3.9 * x, 3.9 * y } };
		const RoundingProof wide = plane.ask( path, 2 * touching );
		ASSERT_EQ( wide.verdict, LW_VERDICT_BLOCKED ) << angle;
		EXPECT_FALSE( wide.on_edge ) << angle;
		EXPECT_EQ( wide.corner, 1u );
		EXPECT_LE( wide.free_radius, touching ) << angle;
		EXPECT_GE( wide.free_radius, 0.75 * touching ) << angle; // other blends get a little nearer to the post than the arc
		EXPECT_EQ( plane.ask( path, wide.free_radius ).verdict, LW_VERDICT_FREE ) << angle;
		EXPECT_EQ( plane.ask( { path[0], path[1], { 0, 3.9 } }, 0.1 ).on_edge, true ) << angle; // through the post
	}
}

// A blend as deep as the radius, driven as far beside itself as the tolerance allows, is no deeper than the arc that touches the post.
TEST( Roundings, TolerancesOfJointsThatMoveReachBeyondTheRounding )
{
	for ( const double angle : { 0.3, 1.0, 1.5708 } )
	{
		const double x = std::cos( angle / 2 ), y = std::sin( angle / 2 ), size = 0.2;
		const double touching = std::min( 0.8, 0.25 * 3.9 * std::tan( angle / 4 ) ), beside = 0.4 * touching;
		Plane plane( 0, touching + size, size );
		const std::vector<State> path = { { -3.9 * x, 3.9 * y }, { 0, 0 }, { 3.9 * x, 3.9 * y } };
		const RoundingProof wide = plane.ask( path, 2 * touching, { 0, beside } );
		ASSERT_NE( wide.verdict, LW_VERDICT_FREE ) << angle;
		EXPECT_FALSE( wide.on_edge ) << angle;
		EXPECT_LE( wide.free_radius, touching - beside ) << angle;
		EXPECT_GE( wide.free_radius, 0.5 * ( touching - beside ) ) << angle;
		// of a joint that stands still along the path likewise
		EXPECT_EQ( plane.ask( { { -1, 0 }, { 0, 0 }, { 1, 0 }, { 1, 0.1 } }, 0.01, { 0, 0.9 * touching } ).verdict,
		    LW_VERDICT_FREE )
		    << angle;
		EXPECT_NE( plane.ask( { { -1, 0 }, { 0, 0 }, { 1, 0 }, { 1, 0.1 } }, 0.01, { 0, 1.1 * touching } ).verdict,
		    LW_VERDICT_FREE )
		    << angle;
	}
}

// A path that turns back on itself, goes straight on, or rests has no corner that could be cut.
TEST( Roundings, PointsOnAStraightLineNeedNoMoreThanTheirEdges )
{
	Plane plane( 0, 0.3, 0.2 );
	for ( const std::vector<State>& path :
	    { std::vector<State>{ { -1, 0 }, { 0, 0 }, { 1, 0 } }, std::vector<State>{ { -1, 0 }, { 1, 0 }, { 0, 0 } },
	        std::vector<State>{ { -1, 0 }, { 0, 0 }, { 0, 0 }, { 1, 0 } }, std::vector<State>{ { 0, 0 } } } )
	{
		const RoundingProof found = plane.ask( path, 1 );
		EXPECT_EQ( found.verdict, LW_VERDICT_FREE );
		EXPECT_GT( found.lower_bound, 0 );
	}
	RoundingProof out;
	const lw_edge_def def = lw_edge_def_default();
	EXPECT_EQ(
	    proveRoundings( plane.checker.get(), plane.query.get(), { { 0, 0 } }, 0, def, out ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( proveRoundings( plane.checker.get(), plane.query.get(), {}, 1, def, out ), LW_ERROR_INVALID_ARGUMENT );
}
