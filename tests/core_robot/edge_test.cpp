// SPDX-License-Identifier: BSD-3-Clause
// Edges: a FREE that dense sampling refutes, a REFUSED outside its band, work without bound near contact.
#include "leeway/checker.h"
#include "random_robot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

namespace
{

struct SceneObject
{
	lw_shape* shape;
	lw_transform pose;
};

/// A robot, a scene and a checker of them, torn down in order.
struct World
{
	RobotModel model;
	std::vector<ShapePtr> sceneShapes;
	std::vector<SceneObject> objects;
	std::vector<lw_link_object_pair> allowed;
	std::vector<std::uint32_t> variables; ///< empty = all
	State reference;
	RobotPtr robot;
	lw_scene* scene = nullptr;
	lw_checker* checker = nullptr;
	lw_query* query = nullptr;
	lw_query* plain = nullptr; ///< for the audit

	World() = default;
	World( const World& ) = delete;
	World& operator=( const World& ) = delete;
	~World() { close(); }

	void close()
	{
		lw_query_destroy( query );
		lw_query_destroy( plain );
		lw_checker_release( checker );
		lw_scene_release( scene );
		query = plain = nullptr;
		checker = nullptr;
		scene = nullptr;
	}

	void object( lw_shape* shape, const lw_transform& pose )
	{
		sceneShapes.emplace_back( shape );
		objects.push_back( { shape, pose } );
	}

	void open()
	{
		close();
		robot = model.create();
		ASSERT_NE( robot, nullptr );
		std::vector<std::string> names;
		std::vector<const char*> pointers;
		std::vector<lw_scene_shape_def> shapes;
		for ( std::size_t i = 0; i < objects.size(); ++i )
		{
			names.push_back( "object" + std::to_string( i ) );
			shapes.push_back( { objects[i].shape, static_cast<std::uint32_t>( i ), objects[i].pose } );
		}
		for ( const std::string& name : names )
		{
			pointers.push_back( name.c_str() );
		}
		lw_scene_def sceneDef = lw_scene_def_default();
		sceneDef.object_names = pointers.data();
		sceneDef.object_count = static_cast<std::uint32_t>( names.size() );
		sceneDef.shapes = shapes.data();
		sceneDef.shape_count = static_cast<std::uint32_t>( shapes.size() );
		ASSERT_EQ( lw_scene_create( &sceneDef, nullptr, nullptr, &scene ), LW_OK );
		lw_checker_def def = lw_checker_def_default();
		def.robot = robot.get();
		def.scene = scene;
		def.variables = variables.empty() ? nullptr : variables.data();
		def.variable_count = static_cast<std::uint32_t>( variables.size() );
		def.reference = reference.empty() ? nullptr : reference.data();
		def.allowed = allowed.data();
		def.allowed_count = static_cast<std::uint32_t>( allowed.size() );
		lw_diag diag = {};
		ASSERT_EQ( lw_checker_create( &def, nullptr, &diag, &checker ), LW_OK ) << diag.message;
		lw_query_def queryDef = lw_query_def_default();
		ASSERT_EQ( lw_query_create( &queryDef, scene, checker, nullptr, &query ), LW_OK );
		ASSERT_EQ( lw_query_create( &queryDef, nullptr, nullptr, nullptr, &plain ), LW_OK );
	}

	bool objectAllowed( std::uint32_t link, std::uint32_t index ) const
	{
		return std::any_of( allowed.begin(), allowed.end(),
			[=]( const lw_link_object_pair& p ) { return p.link == link && p.object == index; } );
	}

	State full( const State& q ) const
	{
		State out( lw_robot_variable_count( robot.get() ) );
		lw_checker_full_state( checker, q.data(), out.data() );
		return out;
	}

	/// True if some joint of the group lies between the two links.
	bool groupMoves( std::uint32_t linkA, std::uint32_t linkB ) const
	{
		auto chain = [&]( std::uint32_t link ) {
			std::vector<std::uint32_t> joints;
			for ( std::uint32_t j = lw_robot_link_joint( robot.get(), link ); j != LW_INVALID_INDEX;
				  j = lw_robot_link_joint( robot.get(), link ) )
			{
				joints.push_back( j );
				link = lw_robot_joint_parent( robot.get(), j );
			}
			return joints;
		};
		std::vector<std::uint32_t> a = chain( linkA ), b = chain( linkB );
		std::vector<std::uint32_t> between;
		std::sort( a.begin(), a.end() );
		std::sort( b.begin(), b.end() );
		std::set_symmetric_difference( a.begin(), a.end(), b.begin(), b.end(), std::back_inserter( between ) );
		return std::any_of( between.begin(), between.end(), [&]( std::uint32_t j ) {
			std::uint32_t followed = lw_robot_joint_mimic( robot.get(), j );
			std::uint32_t leader = followed != LW_INVALID_INDEX ? followed : j;
			std::uint32_t v = lw_robot_joint_variable( robot.get(), leader );
			return v != LW_INVALID_INDEX &&
				   ( variables.empty() || std::find( variables.begin(), variables.end(), v ) != variables.end() );
		} );
	}

	double shapeDistance( const lw_body_def& a, const lw_transform& worldFromA, const lw_shape* b,
		const lw_transform& worldFromB ) const
	{
		lw_transform poseA = lw_transform_multiply( &worldFromA, &a.link_from_shape );
		lw_clearance c;
		EXPECT_EQ( lw_shape_distance( a.shape, &poseA, b, &worldFromB, nullptr, plain, &c ), LW_OK );
		return c.upper;
	}

	/// Least distance at a full state, pair by pair, without the checker. With links given only that pair.
	double clearance( const State& fullState, lw_what what, std::uint32_t a = LW_INVALID_INDEX,
		std::uint32_t b = LW_INVALID_INDEX ) const
	{
		std::vector<lw_transform> poses( lw_robot_link_count( robot.get() ) );
		EXPECT_EQ( lw_robot_fk( robot.get(), fullState.data(), poses.data() ), LW_OK );
		double least = INFINITY;
		for ( std::size_t i = 0; i < model.bodies.size(); ++i )
		{
			lw_body_def bodyI = lw_robot_body( robot.get(), static_cast<std::uint32_t>( i ) );
			for ( std::uint32_t k = 0; ( what & LW_WHAT_ENVIRONMENT ) != 0 && k < objects.size(); ++k )
			{
				if ( !objectAllowed( bodyI.link, k ) && ( a == LW_INVALID_INDEX || ( a == bodyI.link && b == k ) ) )
				{
					least = std::min( least,
						shapeDistance( bodyI, poses[bodyI.link], objects[k].shape, objects[k].pose ) );
				}
			}
			for ( std::size_t k = 0; ( what & LW_WHAT_SELF ) != 0 && k < i; ++k )
			{
				lw_body_def bodyK = lw_robot_body( robot.get(), static_cast<std::uint32_t>( k ) );
				std::uint32_t linkI = bodyI.link, linkK = bodyK.link;
				bool asked = a == LW_INVALID_INDEX || ( a == linkI && b == linkK ) || ( b == linkI && a == linkK );
				if ( asked && !lw_robot_pair_allowed( robot.get(), linkI, linkK ) && groupMoves( linkI, linkK ) )
				{
					lw_transform poseK = lw_transform_multiply( &poses[bodyK.link], &bodyK.link_from_shape );
					least = std::min( least, shapeDistance( bodyI, poses[bodyI.link], bodyK.shape, poseK ) );
				}
			}
		}
		return least;
	}

	double clearanceAt( const State& qa, const State& qb, double t, lw_what what, std::uint32_t a = LW_INVALID_INDEX,
		std::uint32_t b = LW_INVALID_INDEX ) const
	{
		State fullA = full( qa ), fullB = full( qb ), q( fullA.size() );
		lw_robot_interpolate( robot.get(), fullA.data(), fullB.data(), t, q.data() );
		return clearance( q, what, a, b );
	}

	lw_edge_result edge( const State& qa, const State& qb, const lw_edge_def& def ) const
	{
		lw_edge_result result;
		EXPECT_EQ( lw_checker_edge( checker, query, qa.data(), qb.data(), &def, &result ), LW_OK );
		return result;
	}
};

lw_transform at( double x, double y, double z )
{
	lw_transform m = lw_transform_identity();
	m.t[0] = x;
	m.t[1] = y;
	m.t[2] = z;
	return m;
}

lw_shape* primitive( lw_shape_type type, double x, double y, double z )
{
	double d[3] = { x, y, z };
	lw_shape* shape = nullptr;
	EXPECT_EQ( lw_shape_create_primitive( type, d, nullptr, nullptr, &shape ), LW_OK );
	return shape;
}

/// A random robot among random objects, contacts of the state qa allowed.
void randomWorld( SeededRng& rng, World& world, State* start )
{
	RandomRobotOptions options;
	options.joints = rng.integer( 2, 7 );
	options.size = 0.1;
	options.triangles = rng.integer( 1, 12 );
	options.floating = rng.integer( 0, 2 ) > 0;
	do
	{
		world.model = randomRobot( rng, options );
		world.robot = world.model.create();
	} while ( lw_robot_variable_count( world.robot.get() ) == 0 );
	State q = randomState( rng, world.robot.get() );
	world.reference = q;
	world.variables.clear();
	if ( rng.integer( 0, 3 ) == 0 )
	{
		for ( std::uint32_t j = 0; j < lw_robot_joint_count( world.robot.get() ); ++j )
		{
			bool take = rng.integer( 0, 3 ) > 0;
			for ( std::uint32_t k = 0; take && k < lw_robot_joint_variable_count( world.robot.get(), j ); ++k )
			{
				world.variables.push_back( lw_robot_joint_variable( world.robot.get(), j ) + k );
			}
		}
	}
	int objects = rng.integer( 0, 3 ) ? rng.integer( 5, 25 ) : 0;
	for ( int i = 0; i < objects; ++i )
	{
		bool mesh = rng.integer( 0, 1 ) == 1;
		int triangles = rng.integer( 1, 20 );
		lw_shape* shape = mesh ? randomMesh( rng, triangles, 0.15, nullptr ) : randomPrimitive( rng, 0.2, nullptr );
		lw_transform pose = randomTransform( rng, 0.7 );
		for ( int k = 0; k < 3; ++k )
		{
			pose.t[k] += world.model.worldFromRoot.t[k];
		}
		world.object( shape, pose );
	}
	world.open();
	State full = q;
	const double close = 0.002;
	for ( std::uint32_t a = 0; a < world.model.linkNames.size(); ++a )
	{
		for ( std::uint32_t b = 0; b < world.model.linkNames.size(); ++b )
		{
			if ( b < a && world.clearance( full, LW_WHAT_SELF, a, b ) < close )
			{
				world.model.allowed.push_back( { a, b } );
			}
		}
		for ( std::uint32_t k = 0; k < world.objects.size(); ++k )
		{
			if ( world.clearance( full, LW_WHAT_ENVIRONMENT, a, k ) < close )
			{
				world.allowed.push_back( { a, k } );
			}
		}
	}
	world.open();
	start->clear();
	for ( std::uint32_t i = 0; i < lw_checker_variable_count( world.checker ); ++i )
	{
		start->push_back( q[lw_checker_variable( world.checker, i )] );
	}
}

/// Some state of the group: a random one, or one near `start`.
State randomEnd( SeededRng& rng, const World& world, const State& start )
{
	State full = randomState( rng, world.robot.get(), rng.integer( 0, 4 ) == 0 ? 0.7 : 0.0 );
	State near = world.full( start );
	double share = rng.integer( 0, 2 ) ? rng.decade( -1.5, 0 ) : 1.0;
	lw_robot_interpolate( world.robot.get(), near.data(), full.data(), share, full.data() );
	State end;
	for ( std::uint32_t i = 0; i < lw_checker_variable_count( world.checker ); ++i )
	{
		end.push_back( full[lw_checker_variable( world.checker, i )] );
	}
	return end;
}

/// A ball of 10 cm that slides along x above a slab whose top is `gap` below it.
void slider( World& world, double gap, double slabTurn = 0 )
{
	world.model.link( "rail" );
	lw_joint_def& j = world.model.joint( "ball", LW_JOINT_PRISMATIC, 0 );
	j.axis[0] = 1;
	j.axis[2] = 0;
	j.lower = -2;
	j.upper = 2;
	world.model.body( 1, primitive( LW_SHAPE_SPHERE, 0.1, 0, 0 ), lw_transform_identity() );
	lw_transform pose = at( 0, 0, -0.1 - gap - 0.5 );
	pose.r[0][0] = pose.r[1][1] = std::cos( slabTurn );
	pose.r[1][0] = std::sin( slabTurn );
	pose.r[0][1] = -pose.r[1][0];
	world.object( primitive( LW_SHAPE_BOX, 10, 10, 1 ), pose );
	world.open();
}

} // namespace

// The heart: no FREE edge has a state at or below min_d, its lower bound holds, BLOCKED and REFUSED can be reproduced, the
// part proved from the left holds, and clearance well above the band is never refused.
TEST( Edge, CertifiedVerdictsSurviveADenseAudit )
{
	SeededRng rng;
	int verdicts[4] = {}, selfFailures = 0, environmentFailures = 0, deepProofs = 0, partial = 0;
	for ( int i = 0; i < 260; ++i )
	{
		World world;
		State start;
		randomWorld( rng, world, &start );
		for ( int k = 0; k < 4; ++k )
		{
			lw_edge_def def = lw_edge_def_default();
			static const lw_what whats[] = { LW_WHAT_BOTH, LW_WHAT_BOTH, LW_WHAT_ENVIRONMENT, LW_WHAT_SELF };
			def.what = whats[rng.integer( 0, 3 )];
			def.min_d = rng.integer( 0, 1 ) ? 0 : rng.decade( -4, -2 );
			def.slack = rng.decade( -4, -2 );
			def.alpha = rng.integer( 0, 1 ) ? 0 : rng.uniform( 0, 0.5 );
			def.want_proved_until = rng.integer( 0, 1 ) == 1;
			State end = randomEnd( rng, world, start );
			lw_edge_result r = world.edge( start, end, def );
			++verdicts[r.verdict];
			deepProofs += r.verdict == LW_VERDICT_FREE && r.queries > 2 ? 1 : 0;
			double least = INFINITY, leastBefore = INFINITY;
			for ( int n = 0; n <= 60; ++n )
			{
				double t = n == 0 ? 0 : n == 60 ? 1 : rng.uniform( 0, 1 );
				double c = world.clearanceAt( start, end, t, def.what );
				least = std::min( least, c );
				leastBefore = t <= r.proved_until ? std::min( leastBefore, c ) : leastBefore;
			}
			if ( r.verdict == LW_VERDICT_FREE )
			{
				EXPECT_GT( least, def.min_d );
				EXPECT_GT( r.lower_bound, def.min_d );
				EXPECT_LE( r.lower_bound, least + 1e-12 );
				EXPECT_EQ( r.t, 1 );
				EXPECT_EQ( r.proved_until, 1 );
				EXPECT_EQ( r.pair.kind, LW_CLEARANCE_UNKNOWN );
				continue;
			}
			ASSERT_NE( r.verdict, LW_VERDICT_UNKNOWN );
			++( r.self ? selfFailures : environmentFailures );
			EXPECT_EQ( r.lower_bound, 0 );
			double there = world.clearanceAt( start, end, r.t, r.self ? LW_WHAT_SELF : LW_WHAT_ENVIRONMENT, r.pair.a,
				r.pair.b );
			double top = r.verdict == LW_VERDICT_BLOCKED ? def.min_d : ( def.min_d + def.slack ) / ( 1 - def.alpha );
			EXPECT_LE( there, top + 1e-10 ) << lw_verdict_name( r.verdict );
			if ( def.want_proved_until )
			{
				EXPECT_TRUE( r.proved_until < r.t || r.t == 0 );
				EXPECT_GE( r.proved_until, 0 );
				partial += r.proved_until > 0 ? 1 : 0;
				if ( r.proved_until > 0 )
				{
					EXPECT_GT( leastBefore, def.min_d );
					for ( double share : { 1.0, 0.999999, 0.99, 0.9 } )
					{
						EXPECT_GT( world.clearanceAt( start, end, share * r.proved_until, def.what ), def.min_d );
					}
				}
			}
			else
			{
				EXPECT_EQ( r.proved_until, 0 );
			}
		}
	}
	std::printf( "FREE %d (with halving %d), BLOCKED %d, REFUSED %d; self %d, environment %d; partly proved %d\n",
		verdicts[1], deepProofs, verdicts[2], verdicts[3], selfFailures, environmentFailures, partial );
	EXPECT_GE( verdicts[LW_VERDICT_FREE], 200 );
	EXPECT_GE( deepProofs, 80 );
	EXPECT_GE( verdicts[LW_VERDICT_BLOCKED], 150 );
	EXPECT_GE( selfFailures, 40 );
	EXPECT_GE( environmentFailures, 40 );
	EXPECT_GE( partial, 60 );
}

// hpp-core's stall: a ball slides past a slab at a constant small gap, of which floats tell no plane. Work is bounded by the
// slack and a number of windows, not by the gap.
TEST( Edge, SlidingPastAtASmallGapCostsAtMostTheStatedNumberOfQueries )
{
	struct Case
	{
		double gap, min_d, slack;
		lw_verdict expected;
	};
	const Case cases[] = {
		{ 1.01e-3, 0, 1e-3, LW_VERDICT_FREE },
		{ 1.01e-3, 0, 1e-5, LW_VERDICT_FREE },
		{ 1.01e-3, 1e-3, 5e-6, LW_VERDICT_FREE },
		{ 1.01e-3, 1e-3, 1e-4, LW_VERDICT_REFUSED },
		{ 1e-6, 0, 1e-3, LW_VERDICT_REFUSED },
		{ 1e-6, 0, 1e-4, LW_VERDICT_REFUSED },
		{ 1e-4, 0, 9e-5, LW_VERDICT_FREE },
		{ 0, 0, 1e-3, LW_VERDICT_BLOCKED },
		{ -1e-9, 0, 1e-3, LW_VERDICT_BLOCKED },
		{ 1e-3, 1.1e-3, 1e-3, LW_VERDICT_BLOCKED },
	};
	for ( const Case& c : cases )
	{
		World world;
		slider( world, c.gap );
		lw_edge_def def = lw_edge_def_default();
		def.min_d = c.min_d;
		def.slack = c.slack;
		def.alpha = 0;
		const double travel = 0.25;
		lw_query_reset_stats( world.query );
		lw_edge_result r = world.edge( { -0.1 }, { -0.1 + travel }, def );
		std::printf( "gap %g min_d %g slack %g: %s after %u states\n", c.gap, c.min_d, c.slack,
			lw_verdict_name( r.verdict ), r.queries );
		if ( c.gap == 0 ) // 0 to rounding: contact or refused, never free
		{
			EXPECT_NE( r.verdict, LW_VERDICT_FREE );
		}
		else
		{
			EXPECT_EQ( r.verdict, c.expected );
		}
		EXPECT_LE( r.queries, 2 * travel / c.slack + 2 + 2 * 1024 + 4 );
		EXPECT_LE( lw_query_get_stats( world.query ).queries, 2 * r.queries ) << "a coarse look and an exact one per state";
	}
}

// A state in contact only in the middle of the edge, and so briefly that samples 1 cm apart jump over it.
TEST( Edge, ThinObstacleBetweenSamplesIsFound )
{
	SeededRng rng;
	for ( int i = 0; i < 50; ++i )
	{
		World world;
		slider( world, 1 );
		double x = rng.uniform( 0.2, 0.8 );
		world.object( primitive( LW_SHAPE_BOX, 1e-6, 0.01, 0.01 ), at( x, 0, 0 ) );
		world.objects.erase( world.objects.begin() );
		world.model.bodies.clear();
		world.model.body( 1, primitive( LW_SHAPE_SPHERE, 1e-4, 0, 0 ), lw_transform_identity() );
		world.open();
		lw_edge_def def = lw_edge_def_default();
		def.slack = 1e-4;
		def.want_proved_until = true;
		lw_edge_result r = world.edge( { 0 }, { 1 }, def );
		EXPECT_NE( r.verdict, LW_VERDICT_FREE );
		EXPECT_NEAR( r.t, x, 1e-3 );
		EXPECT_NEAR( r.proved_until, x, 2e-3 );
		EXPECT_LT( r.proved_until, x - 1e-4 );
	}
}

// A turn that two slides all but undo in one half of the edge: a proof of that half says nothing of the other one. A small
// ball in the way anywhere must be found, on the way there and back.
TEST( Edge, HalvesOfACellAreProvedByTheirOwnMotion )
{
	const double reach = 0.5, turn = 2;
	for ( double t : { 0.55, 0.6, 0.7, 0.8, 0.85, 0.9, 0.95 } )
	{
		World world;
		world.model.link( "base" );
		world.model.joint( "x", LW_JOINT_PRISMATIC, 0 ).axis[2] = 0;
		world.model.joints.back().axis[0] = 1;
		world.model.joint( "y", LW_JOINT_PRISMATIC, 1 ).axis[2] = 0;
		world.model.joints.back().axis[1] = 1;
		world.model.joint( "turn", LW_JOINT_REVOLUTE, 2 );
		world.model.body( 3, primitive( LW_SHAPE_SPHERE, 0.01, 0, 0 ), at( reach, 0, 0 ) );
		const double slide_x = 2 * reach * ( 1 - std::cos( 0.5 * turn ) ), slide_y = -2 * reach * std::sin( 0.5 * turn );
		world.object( primitive( LW_SHAPE_SPHERE, 0.01, 0, 0 ),
			at( t * slide_x + reach * std::cos( t * turn ), t * slide_y + reach * std::sin( t * turn ), 0 ) );
		world.open();
		const State start = { 0, 0, 0 }, end = { slide_x, slide_y, turn };
		EXPECT_NE( world.edge( start, end, lw_edge_def_default() ).verdict, LW_VERDICT_FREE ) << "ball at t = " << t;
		EXPECT_NE( world.edge( end, start, lw_edge_def_default() ).verdict, LW_VERDICT_FREE ) << "ball at t = " << 1 - t;
	}
}

// A ball on an arm, or the end of a bar that turns about its middle, swings past a box that a plane keeps apart from it at
// the start, in the middle and at the end; between two of them the arc bulges into the box.
TEST( Edge, ArcThatBulgesBetweenItsPlacesIsNoStraightLine )
{
	const auto cases = { std::pair( 1.0, false ), std::pair( -1.0, false ), std::pair( 1.0, true ), std::pair( -1.0, true ) };
	for ( const auto& [side, bar] : cases )
	{
		for ( double deep : { 0.02, 0.002, -0.002 } )
		{
			World world;
			world.model.link( "arm" );
			world.model.joint( "turn", LW_JOINT_REVOLUTE, 0 );
			lw_joint_def& joint = world.model.joints.back();
			joint.axis[0] = joint.axis[1] = 0;
			joint.axis[2] = 1;
			joint.lower = -2;
			joint.upper = 2;
			if ( bar )
			{
				world.model.body( 1, primitive( LW_SHAPE_BOX, 2.1, 0.002, 0.002 ), at( 0, 0, 0 ) );
			}
			else
			{
				world.model.body( 1, primitive( LW_SHAPE_SPHERE, 0.05, 0, 0 ), at( 1, 0, 0 ) );
			}
			const double angle = side * 0.25, away = 1 + 0.05 - deep + 0.5;
			lw_transform pose = at( away * std::cos( angle ), away * std::sin( angle ), 0 );
			pose.r[0][0] = pose.r[1][1] = std::cos( angle );
			pose.r[1][0] = std::sin( angle );
			pose.r[0][1] = -pose.r[1][0];
			world.object( primitive( LW_SHAPE_BOX, 1, 1, 1 ), pose );
			world.open();
			lw_edge_result r = world.edge( { -0.5 }, { 0.5 }, lw_edge_def_default() );
			EXPECT_EQ( r.verdict, deep > 0 ? LW_VERDICT_BLOCKED : LW_VERDICT_FREE ) << deep;
		}
	}
}

// Two arms, the second of which turns back twice as fast, take a ball along a line, and a slide takes it back: at the start,
// in the middle and at the end it is at one place, and its motion in between is all jerk.
TEST( Edge, WayThatIsCurvedToBothSidesIsNoParabola )
{
	const double arm = 0.5, radius = 0.05, half = 0.35, slide = 2 * arm * std::sin( half );
	const double when = std::acos( std::sin( half ) / half ), furthest = 2 * arm * std::sin( when ) - slide * when / half;
	for ( double side : { -1.0, 1.0 } )
	{
		for ( double deep : { 0.002, 0.001, -0.001 } )
		{
			World world;
			world.model.link( "base" );
			const lw_joint_type types[3] = { LW_JOINT_PRISMATIC, LW_JOINT_REVOLUTE, LW_JOINT_REVOLUTE };
			for ( std::uint32_t k = 0; k < 3; ++k )
			{
				lw_joint_def& joint = world.model.joint( "joint_" + std::to_string( k ), types[k], k );
				joint.axis[0] = 0;
				joint.axis[1] = k == 0 ? 1 : 0;
				joint.axis[2] = k == 0 ? 0 : 1;
				joint.lower = -2;
				joint.upper = 2;
			}
			world.model.joints.back().parent_from_joint.t[0] = arm;
			world.model.body( 3, primitive( LW_SHAPE_SPHERE, radius, 0, 0 ), at( -arm, 0, 0 ) );
			world.object( primitive( LW_SHAPE_BOX, 1, 1, 1 ), at( 0, side * ( furthest + radius - deep + 0.5 ), 0 ) );
			world.open();
			lw_edge_def def = lw_edge_def_default();
			def.slack = 1e-4;
			lw_edge_result r = world.edge( { slide, -half, 2 * half }, { -slide, half, -2 * half }, def );
			EXPECT_EQ( r.verdict, deep > 0 ? LW_VERDICT_BLOCKED : LW_VERDICT_FREE ) << deep;
		}
	}
}

TEST( Edge, ShortEdgeBetweenFreeStatesInsideTheSlackIsProvedFromBothEnds )
{
	World world;
	slider( world, 5e-4 );
	lw_edge_def def = lw_edge_def_default();
	def.alpha = 0;
	lw_edge_result r = world.edge( { 0 }, { 8e-4 }, def ); // each end covers 5e-4 of it
	EXPECT_EQ( r.verdict, LW_VERDICT_FREE );
	r = world.edge( { 0 }, { 0 }, def );
	EXPECT_EQ( r.verdict, LW_VERDICT_FREE );
	EXPECT_EQ( r.queries, 1u );
	// along the slab: the clearance that it keeps all the way is proved
	r = world.edge( { 0 }, { 0.1 }, def );
	EXPECT_EQ( r.verdict, LW_VERDICT_FREE );
	EXPECT_EQ( r.queries, 1u );
	EXPECT_LE( r.lower_bound, 5e-4 );
	EXPECT_GE( r.lower_bound, 2e-4 );
}

// A ball that goes straight for a wall and stops short of it: the least clearance is that of the end. With a slack that
// asks for more than there is, the bound found is that clearance itself.
TEST( Edge, LowerBoundIsNotAboveWhatIsAttained )
{
	for ( double end : { 1e-4, 1e-3, 2e-2 } )
	{
		World world;
		world.model.link( "rail" );
		world.model.joint( "ball", LW_JOINT_PRISMATIC, 0 );
		world.model.body( 1, primitive( LW_SHAPE_SPHERE, 0.1, 0, 0 ), lw_transform_identity() );
		world.object( primitive( LW_SHAPE_BOX, 1, 1, 1 ), at( 0, 0, -0.6 ) );
		world.open();
		lw_edge_def def = lw_edge_def_default();
		def.alpha = 0;
		def.slack = 10 * end;
		for ( bool forward : { true, false } )
		{
			lw_edge_result r = world.edge( { forward ? 0.3 : end }, { forward ? end : 0.3 }, def );
			EXPECT_EQ( r.verdict, LW_VERDICT_FREE );
			EXPECT_LE( r.lower_bound, end );
			EXPECT_GE( r.lower_bound, 0.9 * end );
		}
	}
}

// A link that no joint of the group moves and that touches the scene makes every edge impossible, at t = 0.
/// Two small triangles on both sides of a ball's way, as one mesh: its box holds the way, its surface is far from it.
static lw_shape* frame( double side )
{
	std::vector<double> vertices;
	for ( double y : { -side, side } )
	{
		for ( int corner = 0; corner < 3; ++corner )
		{
			vertices.insert( vertices.end(), { 0.1 * ( corner - 1 ), y, corner == 1 ? 0.05 : 0 } );
		}
	}
	const std::uint32_t indices[6] = { 0, 1, 2, 3, 4, 5 };
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = vertices.data();
	def.vertex_count = 6;
	def.indices = indices;
	def.triangle_count = 2;
	lw_shape* shape = nullptr;
	EXPECT_EQ( lw_shape_create_mesh( &def, nullptr, nullptr, &shape ), LW_OK );
	return shape;
}

/// With alpha a search may pass over an obstacle that is a little nearer than the one that it has found. Its proof is the
/// lower end of the interval: a plate in the way, nearer than the frame around the way, is hit.
TEST( Edge, PlateWithinAlphaOfTheNearestObstacleIsPassedOver )
{
	SeededRng rng;
	int in_the_way = 0, beside_it = 0, free = 0;
	for ( int i = 0; i < 2000 && !HasFailure(); ++i )
	{
		World world;
		world.model.link( "rail" );
		lw_joint_def& slide = world.model.joint( "ball", LW_JOINT_PRISMATIC, 0 );
		slide.axis[0] = 1;
		slide.axis[2] = 0;
		slide.lower = -3;
		slide.upper = 3;
		const double radius = 0.01;
		world.model.body( 1, primitive( LW_SHAPE_SPHERE, radius, 0, 0 ), lw_transform_identity() );
		const double side = rng.uniform( 0.4, 1.2 ), where = rng.uniform( -0.95, 0.95 );
		const double beside = rng.integer( 0, 1 ) == 0 ? 0 : rng.uniform( 0.06, 0.8 ); // the plate's middle, off the way
		world.object( frame( side ), lw_transform_identity() );
		world.object( primitive( LW_SHAPE_BOX, 0.002, 0.1, 0.1 ), at( where, beside, 0 ) );
		world.open();
		lw_edge_def def = lw_edge_def_default();
		def.alpha = rng.uniform( 0.2, 0.7 );
		def.slack = rng.decade( -2, 0 ); // a quarter of it is how far beyond its need a proof looks: there alpha counts
		const lw_edge_result r = world.edge( { -rng.uniform( 0.2, 1.2 ) + std::min( where, 0.0 ) },
			{ rng.uniform( 0.2, 1.2 ) + std::max( where, 0.0 ) }, def );
		const double gap = beside - 0.05 - radius; // when it passes the plate
		++( gap < 0 ? in_the_way : beside_it );
		if ( r.verdict == LW_VERDICT_FREE )
		{
			++free;
			EXPECT_LE( r.lower_bound, gap + 1e-9 ) << "plate at " << where << ", frame at " << side << ", alpha " << def.alpha;
		}
		EXPECT_TRUE( gap < 0 || r.verdict != LW_VERDICT_BLOCKED );
	}
	EXPECT_GE( std::min( in_the_way, beside_it ), 200 );
	EXPECT_GE( free, 50 );
}

TEST( Edge, StaticBodiesCount )
{
	for ( double gap : { 0.0015, -0.05 } )
	{
		World world;
		world.model.link( "rail" );
		world.model.joint( "ball", LW_JOINT_PRISMATIC, 0 );
		world.model.body( 0, primitive( LW_SHAPE_SPHERE, 0.1, 0, 0 ), lw_transform_identity() );
		world.model.body( 1, primitive( LW_SHAPE_SPHERE, 0.1, 0, 0 ), at( 2, 0, 0 ) );
		world.object( primitive( LW_SHAPE_BOX, 1, 1, 1 ), at( 0, 0, -0.6 - gap ) );
		world.open();
		lw_edge_def def = lw_edge_def_default();
		def.want_proved_until = true;
		lw_edge_result r = world.edge( { 0 }, { 0.5 }, def );
		EXPECT_EQ( r.verdict, gap > 0 ? LW_VERDICT_FREE : LW_VERDICT_BLOCKED );
		if ( gap > 0 )
		{
			EXPECT_LE( r.lower_bound, gap );
		}
		else
		{
			EXPECT_EQ( r.t, 0 );
			EXPECT_EQ( r.proved_until, 0 );
			EXPECT_EQ( r.pair.a, 0u );
			EXPECT_EQ( r.pair.b, 0u );
			EXPECT_FALSE( r.self );
		}
		def.what = LW_WHAT_SELF;
		EXPECT_EQ( world.edge( { 0 }, { 0.5 }, def ).verdict, LW_VERDICT_FREE );
		def.method = LW_EDGE_STEPS;
		def.what = LW_WHAT_ENVIRONMENT;
		EXPECT_EQ( world.edge( { 0 }, { 0.5 }, def ).verdict, gap > 0 ? LW_VERDICT_FREE : LW_VERDICT_BLOCKED );
	}
}

// The sample of an end is the given state: no edge into a violation of lw_checker_state survives.
TEST( Edge, EndsAgreeWithStates )
{
	SeededRng rng;
	int blockedEnds = 0;
	for ( int i = 0; i < 120; ++i )
	{
		World world;
		State start;
		randomWorld( rng, world, &start );
		for ( int k = 0; k < 4; ++k )
		{
			State end = randomEnd( rng, world, start );
			lw_state_result state;
			ASSERT_EQ( lw_checker_state( world.checker, world.query, end.data(), LW_WHAT_BOTH, nullptr, false, &state ),
				LW_OK );
			for ( lw_edge_method method : { LW_EDGE_CERTIFIED, LW_EDGE_STEPS } )
			{
				lw_edge_def def = lw_edge_def_default();
				def.method = method;
				lw_edge_result r = world.edge( start, end, def );
				if ( state.verdict == LW_VERDICT_BLOCKED )
				{
					++blockedEnds;
					EXPECT_EQ( r.verdict, LW_VERDICT_BLOCKED );
					EXPECT_TRUE( r.t == 1 || method == LW_EDGE_CERTIFIED ) << "proofs may find another one first";
				}
			}
		}
	}
	EXPECT_GE( blockedEnds, 60 );
}

// Planners ask about motions to where they are; a clearance just above min_d is no reason to refuse that one.
TEST( Edge, EdgeWithoutLengthIsNotItsState )
{
	SeededRng rng;
	int freeOnes = 0, blockedOnes = 0;
	for ( int i = 0; i < 150; ++i )
	{
		World world;
		State start;
		randomWorld( rng, world, &start );
		lw_state_result state;
		ASSERT_EQ( lw_checker_state( world.checker, world.query, start.data(), LW_WHAT_BOTH, nullptr, false, &state ), LW_OK );
		const double clearance = std::min( state.environment.upper, state.self.upper );
		if ( state.verdict != LW_VERDICT_FREE || !( clearance > 1e-3 && clearance < INFINITY ) )
		{
			continue;
		}
		for ( int k = 0; k < 6; ++k )
		{
			lw_edge_def def = lw_edge_def_default();
			def.alpha = k % 2 == 0 ? 0.1 : 0.9;
			const double off = rng.decade( -7, -0.5 ); // within the slack and alpha, mostly
			def.min_d = clearance * ( 1 - off );
			const lw_edge_result r = world.edge( start, start, def );
			EXPECT_EQ( r.verdict, LW_VERDICT_FREE ) << clearance << ", " << off << " of it more than min_d";
			EXPECT_GE( r.lower_bound, def.min_d );
			EXPECT_LE( r.lower_bound, clearance * ( 1 + 1e-9 ) );
			freeOnes += r.verdict == LW_VERDICT_FREE;
			def.min_d = clearance * ( 1 + off );
			blockedOnes += world.edge( start, start, def ).verdict == LW_VERDICT_BLOCKED;
		}
	}
	EXPECT_GE( freeOnes, 200 );
	EXPECT_EQ( blockedOnes, freeOnes );
}

// Between two steps no point moves more than max_d, so with min_d >= max_d / 2 the environment is really free of contact,
// with min_d >= max_d the robot is of itself.
TEST( Edge, StepsKeepWhatTheyPromise )
{
	SeededRng rng;
	int verdicts[4] = {}, partial = 0;
	for ( int i = 0; i < 120; ++i )
	{
		World world;
		State start;
		randomWorld( rng, world, &start );
		for ( int k = 0; k < 3; ++k )
		{
			lw_edge_def def = lw_edge_def_default();
			def.method = LW_EDGE_STEPS;
			def.max_d = rng.decade( -3, -1.5 );
			def.what = rng.integer( 0, 1 ) ? LW_WHAT_ENVIRONMENT : LW_WHAT_BOTH;
			def.min_d = def.what == LW_WHAT_ENVIRONMENT ? def.max_d / 2 : def.max_d;
			def.want_proved_until = true;
			State end = randomEnd( rng, world, start );
			lw_edge_result r = world.edge( start, end, def );
			++verdicts[r.verdict];
			if ( r.verdict == LW_VERDICT_FREE )
			{
				EXPECT_EQ( r.t, 1 );
				EXPECT_EQ( r.proved_until, 1 );
				for ( int n = 0; n < 40; ++n )
				{
					EXPECT_GT( world.clearanceAt( start, end, rng.uniform( 0, 1 ), def.what ), 0 );
				}
				continue;
			}
			double there = world.clearanceAt( start, end, r.t, r.self ? LW_WHAT_SELF : LW_WHAT_ENVIRONMENT, r.pair.a,
				r.pair.b );
			EXPECT_LE( there, def.min_d + 1e-10 );
			EXPECT_TRUE( r.proved_until < r.t || r.t == 0 );
			partial += r.proved_until > 0 ? 1 : 0;
			if ( r.proved_until > 0 )
			{
				EXPECT_GT( world.clearanceAt( start, end, r.proved_until, def.what ), def.min_d );
			}
		}
	}
	std::printf( "FREE %d BLOCKED %d REFUSED %d, partly free %d\n", verdicts[1], verdicts[2], verdicts[3], partial );
	EXPECT_GE( verdicts[LW_VERDICT_FREE], 60 );
	EXPECT_GE( verdicts[LW_VERDICT_BLOCKED], 60 );
	EXPECT_GE( partial, 30 );
}

TEST( Edge, StepsVisitEachStateOnce )
{
	World world;
	slider( world, 0.5 );
	lw_edge_def def = lw_edge_def_default();
	def.method = LW_EDGE_STEPS;
	for ( int n : { 1, 2, 3, 7, 8, 100 } )
	{
		def.max_d = 1.0 / n * ( 1 + 1e-9 );
		EXPECT_EQ( world.edge( { -0.5 }, { 0.5 }, def ).queries, static_cast<std::uint32_t>( n + 1 ) );
	}
	def.max_d = 1e-12;
	const lw_edge_result r = world.edge( { -0.5 }, { 0.5 }, def ); // the step is absurdly small for this edge
	EXPECT_EQ( r.verdict, LW_VERDICT_REFUSED );
	EXPECT_EQ( r.pair.kind, LW_CLEARANCE_UNKNOWN );
}

TEST( Edge, BadInputNeverReadsAsFree )
{
	World world;
	slider( world, 1 );
	State a = { 0 }, b = { 0.5 };
	lw_edge_result r;
	auto refused = [&]( const lw_edge_def& def, lw_status expected ) {
		std::memset( static_cast<void*>( &r ), 0x11, sizeof( r ) );
		EXPECT_EQ( lw_checker_edge( world.checker, world.query, a.data(), b.data(), &def, &r ), expected );
		EXPECT_EQ( r.verdict, LW_VERDICT_UNKNOWN );
		EXPECT_EQ( r.proved_until, 0 );
		EXPECT_EQ( r.lower_bound, 0 );
		EXPECT_EQ( r.pair.lower, 0 );
		EXPECT_EQ( r.pair.upper, INFINITY );
	};
	const double nan = std::nan( "" );
	for ( lw_edge_method method : { LW_EDGE_CERTIFIED, LW_EDGE_STEPS } )
	{
		lw_edge_def good = lw_edge_def_default();
		good.method = method;
		EXPECT_EQ( world.edge( a, b, good ).verdict, LW_VERDICT_FREE );
		for ( double bad : std::initializer_list<double>{ nan, INFINITY, -INFINITY } )
		{
			a[0] = bad;
			refused( good, LW_ERROR_INVALID_ARGUMENT );
			a[0] = 0;
			b[0] = bad;
			refused( good, LW_ERROR_INVALID_ARGUMENT );
			b[0] = 0.5;
		}
		a[0] = -1.7e308;
		b[0] = 1.7e308;
		refused( good, LW_ERROR_INVALID_ARGUMENT ); // longer than doubles can say
		a[0] = 0;
		b[0] = 0.5;
		for ( double bad : std::initializer_list<double>{ nan, INFINITY, -1.0 } )
		{
			lw_edge_def def = good;
			def.min_d = bad;
			refused( def, LW_ERROR_INVALID_ARGUMENT );
			def = good;
			( method == LW_EDGE_STEPS ? def.max_d : def.slack ) = bad;
			refused( def, LW_ERROR_INVALID_ARGUMENT );
			def = good;
			def.alpha = bad == INFINITY ? 1 : bad;
			refused( def, LW_ERROR_INVALID_ARGUMENT );
		}
		lw_edge_def def = good;
		def.cookie = 0;
		refused( def, LW_ERROR_INVALID_DEF );
		def = good;
		def.what = static_cast<lw_what>( 0 );
		refused( def, LW_ERROR_INVALID_ARGUMENT );
	}
	lw_edge_def def = lw_edge_def_default();
	lw_query_def queryDef = lw_query_def_default();
	lw_query* small = nullptr;
	ASSERT_EQ( lw_query_create( &queryDef, nullptr, nullptr, nullptr, &small ), LW_OK );
	EXPECT_EQ( lw_checker_edge( world.checker, small, a.data(), b.data(), &def, &r ), LW_ERROR_INVALID_ARGUMENT );
	lw_query_destroy( small );
}

// Same question, same query history: the same bits, whatever ran before on another query.
TEST( Edge, RepeatsBitForBit )
{
	SeededRng rng;
	for ( int i = 0; i < 30; ++i )
	{
		World world;
		State start;
		randomWorld( rng, world, &start );
		State end = randomEnd( rng, world, start );
		lw_edge_def def = lw_edge_def_default();
		def.want_proved_until = true;
		lw_query_reset( world.query );
		lw_edge_result first = world.edge( start, end, def );
		lw_query_reset( world.query );
		lw_edge_result second = world.edge( start, end, def );
		EXPECT_EQ( first.verdict, second.verdict );
		EXPECT_EQ( first.t, second.t );
		EXPECT_EQ( first.proved_until, second.proved_until );
		EXPECT_EQ( first.lower_bound, second.lower_bound );
		EXPECT_EQ( first.queries, second.queries );
		EXPECT_EQ( first.pair.upper, second.pair.upper );
	}
}
