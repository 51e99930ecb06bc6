// SPDX-License-Identifier: BSD-3-Clause
// Obstacles that a group cannot come near to are passed over: random robots and scenes against the same ones with
// everything modelled; states inside and outside of the limits. No answer may differ.
#include "required_world.hpp"

namespace
{

/// The state at which a verdict blocks an edge is blocked.
void expectBlocked(
    const World& world, const lw_checker* checker, lw_query* query, const State& q, const State& to, double t, double min_d )
{
	const lw_range range = lw_range_threshold( min_d );
	State full_a( world.reference.size() ), full_b( full_a ), full_t( full_a ), at;
	lw_checker_full_state( checker, q.data(), full_a.data() );
	lw_checker_full_state( checker, to.data(), full_b.data() );
	lw_robot_interpolate( world.robot.get(), full_a.data(), full_b.data(), t, full_t.data() );
	for ( uint32_t variable : world.group )
	{
		at.push_back( full_t[variable] );
	}
	EXPECT_EQ( LW_VERDICT_BLOCKED, ask( checker, query, at, range ).verdict );
}

/// Shapes of scene and robot that are meshes.
int meshesOf( const World& world )
{
	const auto is_mesh = []( const auto& s ) { return lw_shape_get_info( s.shape ).type == LW_SHAPE_MESH; };
	return static_cast<int>( std::count_if( world.placed.begin(), world.placed.end(), is_mesh ) +
	                         std::count_if( world.model.bodies.begin(), world.model.bodies.end(), is_mesh ) );
}

} // namespace

TEST( Required, LessChangesAnAnswer )
{
	SeededRng rng;
	int free = 0, blocked = 0, outside = 0, edges = 0, different = 0, elsewhere = 0, fewer = 0, unmade = 0;
	for ( int i = 0; i < 150 && !HasFailure(); ++i )
	{
		SCOPED_TRACE( ::testing::Message() << "world " << i );
		Counts counts;
		World world = randomWorld( rng );
		world.margin = i % 2 == 0 ? 0 : rng.decade( -2, 0 );
		World lazy = deferred( world, counts );
		ScenePtr scene = makeScene( world.placed ), lazy_scene = makeScene( lazy.placed );
		// beyond everything: nothing is passed over
		CheckerPtr whole = makeChecker( world.robot.get(), scene.get(), world, 1e9 );
		const double limits[] = { inf, 0.1, 0.3 };
		CheckerPtr less = makeChecker( lazy.robot.get(), lazy_scene.get(), lazy, limits[i % 3] );
		const lw_checker_info all = lw_checker_get_info( whole.get() ), some = lw_checker_get_info( less.get() );
		expectSame( all.static_environment, some.static_environment, "static" );
		fewer += some.near_shapes < world.placed.size();
		QueryPtr query = coldQuery( whole.get() ), other = coldQuery( less.get() );
		for ( int k = 0; k < 8; ++k )
		{
			SCOPED_TRACE( ::testing::Message() << "state " << k );
			double excess = k % 4 == 3 ? 1.5 : 0;
			State q = groupState( rng, world, excess ), to = groupState( rng, world, excess );
			for ( const lw_range& range : ranges )
			{
				SCOPED_TRACE( ::testing::Message() << "min_d " << range.min_d << " max_d " << range.max_d );
				lw_state_result want = ask( whole.get(), query.get(), q, range ),
				                got = ask( less.get(), other.get(), q, range );
				EXPECT_EQ( want.verdict, got.verdict );
				expectSame( want.environment, got.environment, "environment" );
				expectSame( want.self, got.self, "self" );
				++( want.environment.kind == LW_CLEARANCE_VIOLATION ? blocked : free );
			}
			outside += excess > 0;
			// also more than the checker was told that anybody asks for
			const double min_d = k % 3 == 0 ? 0.005 : std::min( limits[i % 3], 0.2 ) * rng.uniform( 0.5, 2.5 );
			for ( lw_edge_method method : { LW_EDGE_CERTIFIED, LW_EDGE_STEPS } )
			{
				lw_status want_status, got_status; // a mimic joint without limits has no motion bound
				lw_edge_result want = askEdge( whole.get(), query.get(), q, to, method, min_d, want_status );
				lw_edge_result got = askEdge( less.get(), other.get(), q, to, method, min_d, got_status );
				EXPECT_EQ( want_status, got_status );
				edges += want_status == LW_OK;
				// Proofs are made of coarse distances, which depend on the order of the search. So does which state ends
				// one, and whether it is an undecided one or a blocked one; a proof may not contradict a blocked state.
				different += want.verdict != got.verdict;
				EXPECT_FALSE( want.verdict == LW_VERDICT_FREE && got.verdict == LW_VERDICT_BLOCKED );
				EXPECT_FALSE( got.verdict == LW_VERDICT_FREE && want.verdict == LW_VERDICT_BLOCKED );
				if ( got.verdict == LW_VERDICT_BLOCKED && got_status == LW_OK )
				{
					expectBlocked( world, whole.get(), query.get(), q, to, got.t, min_d );
				}
				// The last window that was proved may be a quarter of the edge, and a run may end where states are used up; but it
				// never goes beyond a state that is too near.
				elsewhere += std::fabs( want.proved_until - got.proved_until ) > 0.25;
				if ( want.verdict == LW_VERDICT_BLOCKED && want_status == LW_OK && method == LW_EDGE_CERTIFIED )
				{
					EXPECT_LE( got.proved_until, want.t );
				}
			}
		}
		bool all_made = std::all_of( lazy.shapes.begin(), lazy.shapes.end(),
		    []( const ShapePtr& shape ) { return !lw_shape_peek_info( shape.get() ).deferred; } );
		unmade += !all_made;
		less.reset();
		other.reset();
		lazy_scene.reset();
		lazy = World();
		EXPECT_EQ( counts.released.load(), meshesOf( world ) );
	}
	EXPECT_GE( std::min( free, blocked ), 200 );
	EXPECT_GE( outside, 100 );
	EXPECT_GE( edges, 1000 );
	EXPECT_LE( different, edges / 200 ) << "edges with another verdict";
	EXPECT_LE( elsewhere, edges / 500 ) << "edges whose proved part ends elsewhere";
	EXPECT_GE( fewer, 40 ) << "scenes of which something is passed over";
	EXPECT_GE( unmade, 20 ) << "worlds in which some mesh was never needed";
}

// The bound itself, against random states: it is proved, so no state may come nearer.
TEST( Required, ObstacleNearerThanProved )
{
	SeededRng rng;
	int proved = 0, tight = 0;
	for ( int i = 0; i < 120; ++i )
	{
		World world = randomWorld( rng );
		ScenePtr scene = makeScene( world.placed );
		CheckerPtr checker = makeChecker( world.robot.get(), scene.get(), world, inf );
		QueryPtr query = coldQuery( checker.get() );
		std::vector<lw_transform> poses( lw_robot_link_count( world.robot.get() ) );
		std::vector<double> least( world.placed.size(), inf );
		State full = world.reference;
		for ( int k = 0; k < 60; ++k )
		{
			State q = groupState( rng, world, 0 );
			lw_checker_full_state( checker.get(), q.data(), full.data() );
			if ( k % 2 == 0 ) // corners of the box of limits: reach is longest there
			{
				for ( uint32_t variable : world.group )
				{
					lw_variable_info info = lw_robot_variable( world.robot.get(), variable );
					bool limited = std::isfinite( info.lower ) && std::isfinite( info.upper );
					full[variable] = limited ? ( rng.integer( 0, 1 ) != 0 ? info.lower : info.upper ) : full[variable];
				}
			}
			ASSERT_EQ( LW_OK, lw_robot_fk( world.robot.get(), full.data(), poses.data() ) );
			for ( std::size_t s = 0; s < world.placed.size(); ++s )
			{
				double bound = lw_checker_obstacle_distance( checker.get(), static_cast<uint32_t>( s ) );
				if ( bound == 0 || bound == inf )
				{
					continue;
				}
				for ( uint32_t b = 0; b < lw_robot_body_count( world.robot.get() ); ++b )
				{
					lw_body_def body = lw_robot_body( world.robot.get(), b );
					bool moves = false;
					for ( uint32_t link = body.link; lw_robot_link_joint( world.robot.get(), link ) != LW_INVALID_INDEX; )
					{
						uint32_t joint = lw_robot_link_joint( world.robot.get(), link );
						uint32_t leader = joint;
						double share = 1; // 0: it mimics, but stands still
						while ( world.model.joints[leader].mimic != LW_INVALID_INDEX )
						{
							share *= world.model.joints[leader].mimic_multiplier;
							leader = world.model.joints[leader].mimic;
						}
						uint32_t variable = lw_robot_joint_variable( world.robot.get(), leader );
						moves = moves || ( share != 0 && std::find( world.group.begin(), world.group.end(), variable ) !=
						                                     world.group.end() );
						link = lw_robot_joint_parent( world.robot.get(), joint );
					}
					if ( !moves )
					{
						continue;
					}
					lw_transform pose = lw_transform_multiply( &poses[body.link], &body.link_from_shape );
					lw_clearance clearance;
					ASSERT_EQ( LW_OK, lw_shape_distance( body.shape, &pose, world.placed[s].shape,
					                      &world.placed[s].world_from_shape, nullptr, query.get(), &clearance ) );
					EXPECT_GE( clearance.upper, bound ) << "world " << i << " shape " << s << " body " << b;
					least[s] = std::min( least[s], clearance.upper );
				}
			}
		}
		for ( std::size_t s = 0; s < world.placed.size(); ++s )
		{
			double bound = lw_checker_obstacle_distance( checker.get(), static_cast<uint32_t>( s ) );
			proved += bound > 0 && bound < inf;
			tight += bound > 0.7 * least[s] && bound < inf;
		}
	}
	EXPECT_GE( proved, 200 );
	EXPECT_GE( tight, 20 ) << "bounds are so loose that this test finds nothing";
}

/// A small ball on a chain of one to three joints.
static World ballOnAChain( SeededRng& rng, double radius, lw_transform* link_from_ball )
{
	World world;
	world.model.link( "root" );
	const int joints = rng.integer( 1, 3 );
	const bool drives = rng.integer( 0, 3 ) == 0; // its first joint roams a plane
	for ( int k = 0; k < joints; ++k )
	{
		lw_joint_def& joint = world.model.joint( "l" + std::to_string( k ),
		    k == 0 && drives                    ? LW_JOINT_PLANAR
		    : k == 0 || rng.integer( 0, 3 ) > 0 ? LW_JOINT_REVOLUTE
		                                        : LW_JOINT_PRISMATIC,
		    static_cast<uint32_t>( k ) );
		joint.parent_from_joint = randomTransform( rng, 0.5 );
		joint.lower = rng.uniform( -3, 0 );
		joint.upper = joint.lower + rng.decade( -1, 0.8 );
		for ( int axis = 0; axis < 3; ++axis )
		{
			joint.position_lower[axis] = -rng.decade( -1, 0.5 );
			joint.position_upper[axis] = rng.decade( -1, 0.5 );
		}
	}
	*link_from_ball = lw_transform_identity();
	link_from_ball->t[0] = drives ? rng.uniform( 0, 0.2 ) : rng.uniform( 0.2, 1 );
	lw_shape* shape = nullptr;
	EXPECT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_SPHERE, &radius, nullptr, nullptr, &shape ) );
	world.model.body( static_cast<uint32_t>( joints ), shape, *link_from_ball );
	world.robot = world.model.create();
	for ( uint32_t v = 0; v < lw_robot_variable_count( world.robot.get() ); ++v )
	{
		world.group.push_back( v );
	}
	world.reference = randomState( rng, world.robot.get() );
	return world;
}

/// An obstacle, a ball as well, in some direction from where the chain's ball is at q.
static void placeBeside(
    SeededRng& rng, World& world, const lw_transform& link_from_ball, const State& q, double radius, double gap )
{
	std::vector<lw_transform> poses( lw_robot_link_count( world.robot.get() ) );
	ASSERT_EQ( LW_OK, lw_robot_fk( world.robot.get(), q.data(), poses.data() ) );
	lw_transform there = lw_transform_multiply( &poses.back(), &link_from_ball );
	const lw_transform turned = randomTransform( rng, 0 );
	for ( int axis = 0; axis < 3; ++axis )
	{
		there.t[axis] += turned.r[axis][0] * ( 2 * radius + gap );
	}
	lw_shape* shape = nullptr;
	ASSERT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_SPHERE, &radius, nullptr, nullptr, &shape ) );
	world.shapes.emplace_back( shape );
	world.placed.push_back( { shape, static_cast<uint32_t>( world.placed.size() ), there } );
}

// A planner may ask for more room than it told the checker that anybody asks for: then nothing may be passed over. A ball
// swings past obstacles outside of its circle, which it cannot come near to by as much as the checker was told.
TEST( Required, EdgeAsksForMoreThanItsCheckerWasTold )
{
	SeededRng rng;
	int beyond = 0, free = 0, passed_over = 0;
	for ( int i = 0; i < 1000 && !HasFailure(); ++i )
	{
		World world;
		world.model.link( "root" );
		world.model.joint( "arm", LW_JOINT_REVOLUTE, 0 ); // about z
		const double arm = rng.uniform( 0.4, 1 ), radius = 0.002, gap = rng.decade( -1, 0 ), angle = rng.uniform( -1, 1 );
		lw_transform at = lw_transform_identity(), there = at;
		at.t[0] = arm;
		there.t[0] = ( arm + 2 * radius + gap ) * std::cos( angle );
		there.t[1] = ( arm + 2 * radius + gap ) * std::sin( angle );
		lw_shape *ball = nullptr, *obstacle = nullptr;
		ASSERT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_SPHERE, &radius, nullptr, nullptr, &ball ) );
		ASSERT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_SPHERE, &radius, nullptr, nullptr, &obstacle ) );
		world.model.body( 1, ball, at );
		world.robot = world.model.create();
		world.reference = { 0 };
		world.group = { 0 };
		world.shapes.emplace_back( obstacle );
		world.placed.push_back( { obstacle, 0, there } );
		const ScenePtr scene = makeScene( world.placed );
		const CheckerPtr checker = makeChecker( world.robot.get(), scene.get(), world, gap * rng.uniform( 0.4, 1.2 ) );
		const QueryPtr query = coldQuery( checker.get() );
		const lw_checker_info info = lw_checker_get_info( checker.get() );
		passed_over += info.near_shapes == 0;
		for ( double factor : { 0.5, 1.001, 1.05 } )
		{
			lw_status status;
			const lw_edge_result r = askEdge( checker.get(), query.get(), { rng.uniform( -2.9, -1 ) },
			    { rng.uniform( 1, 2.9 ) }, LW_EDGE_CERTIFIED, factor * gap, status );
			ASSERT_EQ( status, LW_OK );
			EXPECT_TRUE( factor < 1 || r.verdict != LW_VERDICT_FREE )
			    << "world " << i << ", gap " << gap << ", min_d " << factor * gap;
			free += r.verdict == LW_VERDICT_FREE;
			beyond += factor > 1 && info.horizon < factor * gap;
		}
	}
	EXPECT_GE( std::min( { beyond, free, passed_over } ), 300 );
}

// Small balls on short chains, and small obstacles right beside places that they come to: there a bound that is a few per
// cent of an arm's length too large is wrong.
TEST( Required, ObstacleBesideTheWayIsOutOfReach )
{
	SeededRng rng;
	int proved = 0, beside = 0;
	for ( int i = 0; i < 300 && !HasFailure(); ++i )
	{
		lw_transform at;
		World world = ballOnAChain( rng, 0.002, &at );
		std::vector<double> gaps;
		for ( int k = 0; k < 60; ++k )
		{
			State q = randomState( rng, world.robot.get() );
			for ( uint32_t v = 0; v < q.size(); ++v ) // limits, where a way ends
			{
				const lw_variable_info info = lw_robot_variable( world.robot.get(), v );
				const int where = rng.integer( 0, 5 );
				const double limit = where == 0 ? info.lower : info.upper;
				q[v] = where < 2 && std::isfinite( limit ) ? limit : q[v];
			}
			gaps.push_back( rng.decade( -4, -1 ) );
			placeBeside( rng, world, at, q, 0.002, gaps.back() );
		}
		const ScenePtr scene = makeScene( world.placed );
		const CheckerPtr checker = makeChecker( world.robot.get(), scene.get(), world, inf );
		for ( uint32_t k = 0; k < gaps.size(); ++k )
		{
			const double bound = lw_checker_obstacle_distance( checker.get(), k );
			EXPECT_LE( bound, gaps[k] + 1e-9 ) << "robot " << i << ", obstacle " << k;
			proved += bound > 0;
			beside += bound > 0.5 * gaps[k];
		}
	}
	std::printf( "%d of obstacles a little beside the way proved to be, %d with half of their gap\n", proved, beside );
	EXPECT_GE( beside, 20 );
}

namespace
{

/// A checker of this robot of one joint and a ball about the origin: the ball has to be looked at.
/// @param contact the robot touches it
void expectNotPassedOver( const lw_robot_def& def, const lw_shape* obstacle, bool contact )
{
	lw_robot* robot = nullptr;
	const lw_status status = lw_robot_create( &def, nullptr, nullptr, &robot );
	if ( !contact && status == LW_ERROR_INVALID_ARGUMENT )
	{
		return; // poses as far as that are none
	}
	ASSERT_EQ( LW_OK, status );
	const RobotPtr robot_owner( robot );
	const ScenePtr scene = makeScene( { { obstacle, 0, lw_transform_identity() } } );
	lw_checker_def checker_def = lw_checker_def_default();
	checker_def.robot = robot;
	checker_def.scene = scene.get();
	checker_def.max_d = 0.1;
	lw_checker* checker = nullptr;
	ASSERT_EQ( LW_OK, lw_checker_create( &checker_def, nullptr, nullptr, &checker ) );
	const CheckerPtr checker_owner( checker );
	EXPECT_EQ( 0.0, lw_checker_obstacle_distance( checker, 0 ) );
	QueryPtr query = coldQuery( checker );
	const double q = 0.3;
	const lw_range range = { 0, 0.1, 0 };
	lw_state_result result;
	ASSERT_EQ( LW_OK, lw_checker_state( checker, query.get(), &q, LW_CHECK_BOTH, &range, false, &result ) );
	EXPECT_EQ( contact, result.verdict == LW_VERDICT_BLOCKED );
}

} // namespace

// The sweep of a body so far from the axis of its joint that squares leave the range of doubles has no number of arcs. It
// must not get lost, nor the obstacles with it. Nor may that of a point on the axis, whose number of arcs is 0 / 0 if its
// ball has no radius.
TEST( Required, SweepsWithoutANumberOfArcsAreNotLost )
{
	const double origin[3] = { 0, 0, 0 }, sizes[3] = { 0.5, 0, 0 };
	lw_shape *point = nullptr, *ball = nullptr;
	ASSERT_EQ( LW_OK, lw_shape_create_points( origin, 1, 0.0, nullptr, nullptr, nullptr, &point ) );
	ASSERT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_SPHERE, sizes, nullptr, nullptr, &ball ) );
	const ShapePtr body( point ), obstacle( ball );
	lw_joint_def joint = lw_joint_def_default();
	joint.name = "j";
	joint.type = LW_JOINT_REVOLUTE;
	joint.parent = 0;
	joint.child = 1;
	joint.axis[0] = 0;
	joint.axis[2] = 1;
	joint.lower = -1;
	joint.upper = 1;
	const char* links[2] = { "base", "tip" };
	lw_body_def bodies[2] = { { body.get(), 1, lw_transform_identity() }, { body.get(), 1, lw_transform_identity() } };
	bodies[1].link_from_shape.t[0] = 1e200;
	lw_robot_def def = lw_robot_def_default();
	def.name = "r";
	def.link_names = links;
	def.link_count = 2;
	def.joints = &joint;
	def.joint_count = 1;
	def.bodies = bodies;
	for ( uint32_t far : { 0u, 1u } )
	{
		SCOPED_TRACE( far );
		def.bodies = bodies + far;
		def.body_count = 1;
		expectNotPassedOver( def, obstacle.get(), far == 0 );
	}
}
