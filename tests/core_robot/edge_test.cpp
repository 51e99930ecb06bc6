// SPDX-License-Identifier: BSD-3-Clause
// Edges: a FREE that dense sampling refutes, an UNDECIDED outside its band, work without bound near contact.
#include "edge_model.hpp"

// The heart: no FREE edge has a state at or below min_d, its lower bound holds, BLOCKED and UNDECIDED can be reproduced, the
// part proved from the left holds, and clearance well above the band is never undecided.
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
			static const lw_check_flags flag_sets[] = { LW_CHECK_BOTH, LW_CHECK_BOTH, LW_CHECK_ENVIRONMENT, LW_CHECK_SELF };
			def.flags = flag_sets[rng.integer( 0, 3 )];
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
				double c = world.clearanceAt( start, end, t, def.flags );
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
			double there =
			    world.clearanceAt( start, end, r.t, r.self ? LW_CHECK_SELF : LW_CHECK_ENVIRONMENT, r.pair.a, r.pair.b );
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
						EXPECT_GT( world.clearanceAt( start, end, share * r.proved_until, def.flags ), def.min_d );
					}
				}
			}
			else
			{
				EXPECT_EQ( r.proved_until, 0 );
			}
		}
	}
	std::printf( "FREE %d (with halving %d), BLOCKED %d, UNDECIDED %d; self %d, environment %d; partly proved %d\n",
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
	    { 1.01e-3, 1e-3, 1e-4, LW_VERDICT_UNDECIDED },
	    { 1e-6, 0, 1e-3, LW_VERDICT_UNDECIDED },
	    { 1e-6, 0, 1e-4, LW_VERDICT_UNDECIDED },
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
		std::printf( "gap %g min_d %g slack %g: %s after %u states\n", c.gap, c.min_d, c.slack, lw_verdict_name( r.verdict ),
		    r.queries );
		if ( c.gap == 0 ) // 0 to rounding: contact or undecided, never free
		{
			EXPECT_NE( r.verdict, LW_VERDICT_FREE );
		}
		else
		{
			EXPECT_EQ( r.verdict, c.expected );
		}
		EXPECT_LE( r.queries, 2 * travel / c.slack + 2 + 2 * 1024 + 5 );
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
		EXPECT_NEAR( r.proved_until, x, 0.02 * x ); // it ends at a piece whose half is less than 1 % of the run
		EXPECT_LT( r.proved_until, x - 1e-4 );
	}
}

// Two balls on a slider, one of which passes something within the slack where the other one, for a short while, is in contact.
TEST( Edge, UndecidedEdgeNamesAStateWithoutAnyContact )
{
	const double where = 0.375; // the middle of a cell, and no state that is probed after an undecided proof
	for ( const bool first : { false, true } )
	{
		World world;
		slider( world, 1 );
		world.objects.clear();
		world.model.bodies.clear();
		for ( const double y : { -1.0, 1.0 } )
		{
			world.model.body( 1, primitive( LW_SHAPE_SPHERE, 0.05, 0, 0 ), at( 0, y, 0 ) );
			const bool touches = first == ( y < 0 );
			world.object( primitive( LW_SHAPE_SPHERE, 0.01, 0, 0 ), at( where, y + ( touches ? 0.059 : 0.0601 ), 0 ) );
		}
		world.open();
		lw_edge_def def = lw_edge_def_default();
		def.close_windows = 0;
		const lw_edge_result r = world.edge( { 0 }, { 1 }, def );
		EXPECT_EQ( LW_VERDICT_BLOCKED, r.verdict );
		EXPECT_NEAR( where, r.t, 0.02 );
	}
}

/// 200 triangles in a square about the origin. @param along the coordinate axes of its sides
static lw_shape* grid( double size, int along_a, int along_b )
{
	constexpr std::uint32_t cells = 10;
	std::vector<double> vertices;
	std::vector<std::uint32_t> indices;
	for ( std::uint32_t i = 0; i <= cells; ++i )
	{
		for ( std::uint32_t k = 0; k <= cells; ++k )
		{
			double v[3] = { 0, 0, 0 };
			v[along_a] = size * ( static_cast<double>( i ) / cells - 0.5 );
			v[along_b] = size * ( static_cast<double>( k ) / cells - 0.5 );
			vertices.insert( vertices.end(), v, v + 3 );
			const std::uint32_t at = i * ( cells + 1 ) + k;
			if ( i < cells && k < cells )
			{
				indices.insert( indices.end(), { at, at + 1, at + cells + 1, at + 1, at + cells + 1, at + cells + 2 } );
			}
		}
	}
	return meshOf( vertices, indices );
}

// A small dense mesh passes through a large one, in contact neither at the middle nor at either end.
TEST( Edge, DenseMeshThatIsPassedThroughIsFound )
{
	SeededRng rng;
	for ( int i = 0; i < 50; ++i )
	{
		World world;
		slider( world, 1 );
		const double x = ( i % 2 == 0 ? 1 : -1 ) * rng.uniform( 0.005, 0.04 ), half = rng.uniform( 0.045, 0.055 );
		world.object( grid( 0.03, 1, 2 ), at( x, 0, 0 ) );
		world.objects.erase( world.objects.begin() );
		world.model.bodies.clear();
		world.model.body( 1, grid( 0.004, 0, 2 ), lw_transform_identity() );
		world.open();
		lw_edge_def def = lw_edge_def_default();
		def.slack = 1e-4;
		const lw_edge_result r = world.edge( { -half }, { half }, def );
		EXPECT_NE( r.verdict, LW_VERDICT_FREE ) << "mesh at " << x << ", half of the motion " << half;
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
TEST( Edge, ArcThatBulgesBetweenItsPosesIsNoStraightLine )
{
	const auto cases = {
	    std::pair( 1.0, false ), std::pair( -1.0, false ), std::pair( 1.0, true ), std::pair( -1.0, true ) };
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
TEST( Edge, PathCurvedToBothSidesIsNoParabola )
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
TEST( Edge, LowerBoundIsNotAboveAnAttainedDistance )
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
	return meshOf( vertices, { 0, 1, 2, 3, 4, 5 } );
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
			EXPECT_LE( r.lower_bound, gap + 1e-9 )
			    << "plate at " << where << ", frame at " << side << ", alpha " << def.alpha;
		}
		EXPECT_TRUE( gap < 0 || r.verdict != LW_VERDICT_BLOCKED );
	}
	EXPECT_GE( std::min( in_the_way, beside_it ), 200 );
	EXPECT_GE( free, 50 );
}
