// SPDX-License-Identifier: BSD-3-Clause
// Margins of pairs: every answer of a checker against brute force over all pairs, distances of lw_shape_distance() less margins
// that are added up here once more. Random robots, scenes, groups and margins; states inside and outside of the limits; edges.
#include "checker_handles.hpp"
#include "counting_allocator.hpp"
#include "random_robot.hpp"
#include "same_bits.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <set>

namespace
{

const double inf = std::numeric_limits<double>::infinity();

/// Of distances of a few metres, with poses that are multiplied in another order.
const double rounding = 1e-10;

/// Margins that own their arrays, and what they mean.
struct Margins
{
	double environment = 0, self = 0;
	std::vector<double> link, link_self, object;
	std::map<std::pair<uint32_t, uint32_t>, double> pairs, self_pairs; ///< self pairs: lower link first
	std::vector<lw_pair_margin> listed, listed_self;

	lw_margins def()
	{
		lw_margins out = {};
		listed.clear();
		listed_self.clear();
		for ( const auto& [pair, margin] : pairs )
		{
			listed.push_back( { pair.first, pair.second, margin } );
		}
		for ( const auto& [pair, margin] : self_pairs ) // either order, any sequence
		{
			listed_self.insert( listed_self.begin(), { pair.second, pair.first, margin } );
		}
		out.environment = environment;
		out.self = self;
		out.link_environment = link.empty() ? nullptr : link.data();
		out.link_self = link_self.empty() ? nullptr : link_self.data();
		out.object = object.empty() ? nullptr : object.data();
		out.environment_pairs = listed.data();
		out.environment_pair_count = static_cast<uint32_t>( listed.size() );
		out.self_pairs = listed_self.data();
		out.self_pair_count = static_cast<uint32_t>( listed_self.size() );
		return out;
	}
	double toObject( uint32_t a, uint32_t b ) const
	{
		auto found = pairs.find( { a, b } );
		return found != pairs.end() ? found->second
									: environment + ( link.empty() ? 0 : link[a] ) + ( object.empty() ? 0 : object[b] );
	}
	double ofLinks( uint32_t a, uint32_t b ) const
	{
		auto found = self_pairs.find( { std::min( a, b ), std::max( a, b ) } );
		return found != self_pairs.end()
				   ? found->second
				   : self + ( link_self.empty() ? 0 : link_self[std::min( a, b )] ) +
						 ( link_self.empty() ? 0 : link_self[std::max( a, b )] );
	}
};

struct World
{
	RobotModel model;
	RobotPtr robot;
	std::vector<ShapePtr> shapes;
	std::vector<lw_scene_shape_def> placed;
	uint32_t objects = 0;
	ScenePtr scene;
	ReachPtr reach;
	State reference;
	std::vector<uint32_t> group;
	std::vector<lw_link_object_pair> allowed;
	Margins margins;

	lw_status build( CheckerPtr& out, lw_diag* diag, const lw_reach* with, double max_d = inf,
		const lw_allocator* allocator = nullptr, const lw_checker* previous = nullptr )
	{
		const uint32_t none = 0;
		lw_checker_def def = lw_checker_def_default();
		def.robot = robot.get();
		def.scene = scene.get();
		def.variables = group.empty() ? &none : group.data();
		def.variable_count = static_cast<uint32_t>( group.size() );
		def.reference = reference.data();
		def.allowed = allowed.data();
		def.allowed_count = static_cast<uint32_t>( allowed.size() );
		def.reach = with;
		def.max_d = max_d;
		def.margins = margins.def();
		def.previous = previous;
		lw_checker* checker = nullptr;
		lw_status status = lw_checker_create( &def, allocator, diag, &checker );
		out.reset( checker );
		return status;
	}
	CheckerPtr build( const lw_reach* with = nullptr, double max_d = inf, const lw_checker* previous = nullptr )
	{
		CheckerPtr out;
		lw_diag diag = {};
		EXPECT_EQ( LW_OK, build( out, &diag, with, max_d, nullptr, previous ) ) << diag.message;
		return out;
	}
	State full( const State& q ) const
	{
		State out = reference;
		for ( std::size_t i = 0; i < group.size(); ++i )
		{
			out[group[i]] = q[i];
		}
		return out;
	}
	State part( const State& whole ) const
	{
		State q;
		for ( uint32_t variable : group )
		{
			q.push_back( whole[variable] );
		}
		return q;
	}
};

void createScene( World& world )
{
	std::vector<std::string> names;
	std::vector<const char*> pointers;
	for ( uint32_t i = 0; i < world.objects; ++i )
	{
		names.push_back( "object" + std::to_string( i ) );
	}
	for ( const std::string& name : names )
	{
		pointers.push_back( name.c_str() );
	}
	lw_scene_def def = lw_scene_def_default();
	def.object_names = pointers.data();
	def.object_count = world.objects;
	def.shapes = world.placed.data();
	def.shape_count = static_cast<uint32_t>( world.placed.size() );
	lw_scene* scene = nullptr;
	ASSERT_EQ( LW_OK, lw_scene_create( &def, nullptr, nullptr, &scene ) );
	world.scene.reset( scene );
}

ReachPtr makeReach( const lw_robot* robot )
{
	lw_reach_def def = lw_reach_def_default();
	def.robot = robot;
	def.seconds = 0.02;
	def.samples = 50;
	def.hull_error = 0.3;
	lw_reach* reach = nullptr;
	lw_diag diag = {};
	const lw_status status = lw_reach_create( &def, nullptr, &diag, &reach );
	EXPECT_TRUE( status == LW_OK || status == LW_ERROR_UNSUPPORTED ) << diag.message; // a library without qhull
	return ReachPtr( reach );
}

World randomWorld( SeededRng& rng, bool with_reach )
{
	World world;
	RandomRobotOptions options;
	options.joints = rng.integer( 3, 11 );
	options.floating = rng.integer( 0, 2 ) == 0;
	options.size = rng.integer( 0, 1 ) != 0 ? 0.04 : 0.1;
	world.model = randomRobot( rng, options );
	for ( int i = rng.integer( 0, 3 ); i > 0; --i ) // links with several bodies
	{
		uint32_t link = static_cast<uint32_t>( rng.integer( 0, options.joints ) );
		world.model.body( link, randomPrimitive( rng, options.size, nullptr ), randomTransform( rng, 0.2 ) );
	}
	for ( uint32_t i = 0; i < world.model.joints.size(); ++i )
	{
		world.model.allowed.push_back( { world.model.joints[i].parent, world.model.joints[i].child } );
	}
	world.robot = world.model.create();
	world.reach = with_reach ? makeReach( world.robot.get() ) : nullptr;
	world.reference = randomState( rng, world.robot.get() );
	bool chosen = false;
	for ( uint32_t i = 0; i < lw_robot_variable_count( world.robot.get() ); ++i )
	{
		chosen = lw_robot_variable( world.robot.get(), i ).component == 0 ? rng.integer( 0, 3 ) > 0 : chosen;
		if ( chosen )
		{
			world.group.push_back( i );
		}
	}
	const double spread = rng.uniform( 1, 3 );
	world.objects = static_cast<uint32_t>( rng.integer( 0, 20 ) );
	for ( uint32_t i = 0; i < world.objects; ++i )
	{
		for ( int k = rng.integer( 1, 2 ); k > 0; --k )
		{
			const bool mesh = rng.integer( 0, 2 ) == 0;
			world.shapes.emplace_back( mesh ? randomMesh( rng, 20, 0.15, nullptr ) : randomPrimitive( rng, 0.2, nullptr ) );
			world.placed.push_back( { world.shapes.back().get(), i, randomTransform( rng, spread ) } );
		}
	}
	if ( rng.integer( 0, 3 ) == 0 && world.objects > 0 ) // a floor, which has no box
	{
		lw_shape* floor = nullptr;
		const double none[3] = { 0, 0, 0 };
		EXPECT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_HALFSPACE, none, nullptr, nullptr, &floor ) );
		world.shapes.emplace_back( floor );
		lw_transform pose = lw_transform_identity();
		pose.t[2] = -3;
		world.placed.push_back( { floor, 0, pose } );
	}
	createScene( world );
	for ( int i = world.objects > 0 ? rng.integer( 0, 3 ) : 0; i > 0; --i )
	{
		world.allowed.push_back( { static_cast<uint32_t>( rng.integer( 0, options.joints ) ),
			static_cast<uint32_t>( rng.integer( 0, static_cast<int>( world.objects ) - 1 ) ) } );
	}
	return world;
}

/// Some kinds of margins or all of them, millimetres to decimetres, and many zeros.
Margins randomMargins( SeededRng& rng, const World& world )
{
	Margins m;
	const auto some = [&] { return rng.integer( 0, 2 ) == 0 ? 0.0 : rng.decade( -3, -0.8 ); };
	const int kinds = rng.integer( 0, 2 ) == 0 ? 127 : rng.integer( 1, 126 );
	const uint32_t links = lw_robot_link_count( world.robot.get() );
	m.environment = ( kinds & 1 ) != 0 ? some() : 0;
	m.self = ( kinds & 2 ) != 0 ? some() : 0;
	for ( uint32_t i = 0; i < links; ++i )
	{
		if ( ( kinds & 4 ) != 0 )
		{
			m.link.push_back( some() );
		}
		if ( ( kinds & 8 ) != 0 )
		{
			m.link_self.push_back( 0.3 * some() );
		}
	}
	for ( uint32_t i = 0; i < world.objects && ( kinds & 16 ) != 0; ++i )
	{
		m.object.push_back( rng.integer( 0, 9 ) == 0 ? 0.5 : some() );
	}
	for ( int i = rng.integer( 1, 12 ); i > 0; --i )
	{
		uint32_t a = static_cast<uint32_t>( rng.integer( 0, static_cast<int>( links ) - 1 ) );
		uint32_t b = static_cast<uint32_t>( rng.integer( 0, static_cast<int>( links ) - 1 ) );
		if ( ( kinds & 32 ) != 0 && world.objects > 0 )
		{
			m.pairs[{ a, static_cast<uint32_t>( rng.integer( 0, static_cast<int>( world.objects ) - 1 ) ) }] = some();
		}
		if ( ( kinds & 64 ) != 0 && a != b )
		{
			m.self_pairs[{ std::min( a, b ), std::max( a, b ) }] = some();
		}
	}
	return m;
}

// --- oracle ----------------------------------------------------------------------------------------------------------

/// Brute force: all pairs, and nothing of the checker's.
class Oracle
{
public:
	explicit Oracle( const World& world ) : m_world( world ), m_poses( lw_robot_link_count( world.robot.get() ) )
	{
		lw_query_def def = lw_query_def_default();
		lw_query* query = nullptr;
		EXPECT_EQ( LW_OK, lw_query_create( &def, nullptr, nullptr, nullptr, &query ) );
		m_query.reset( query );
		for ( const lw_link_object_pair& pair : world.allowed )
		{
			m_allowed.insert( { pair.link, pair.object } );
		}
	}

	struct Answer
	{
		double environment = inf, self = inf;
		bool inside = false;   ///< the nearest of all is closer than its margin, and not touching
		bool by_margin = false; ///< without margins another pair would be the nearest
	};

	Answer ask( const State& q )
	{
		Answer out;
		EXPECT_EQ( LW_OK, lw_robot_fk( m_world.robot.get(), m_world.full( q ).data(), m_poses.data() ) );
		double nearest = inf, of_least = inf;
		const auto take = [&]( double distance, double margin, double& least )
		{
			if ( distance - margin < std::min( out.environment, out.self ) )
			{
				of_least = distance;
				out.inside = distance > 1e-6 && distance < margin - 1e-6;
			}
			nearest = std::min( nearest, distance );
			least = std::min( least, distance - margin );
		};
		const uint32_t bodies = lw_robot_body_count( m_world.robot.get() );
		for ( uint32_t i = 0; i < bodies; ++i )
		{
			for ( uint32_t k = 0; k < m_world.placed.size(); ++k )
			{
				const lw_scene_shape_def& obstacle = m_world.placed[k];
				const uint32_t link = lw_robot_body( m_world.robot.get(), i ).link;
				if ( m_allowed.count( { link, obstacle.object } ) == 0 )
				{
					take( obstacleDistance( i, k ), m_world.margins.toObject( link, obstacle.object ), out.environment );
				}
			}
			for ( uint32_t k = 0; k < i; ++k )
			{
				const uint32_t a = lw_robot_body( m_world.robot.get(), i ).link, b = lw_robot_body( m_world.robot.get(), k ).link;
				if ( isSelfPair( a, b ) )
				{
					take( bodyDistance( i, k ), m_world.margins.ofLinks( a, b ), out.self );
				}
			}
		}
		out.by_margin = of_least > nearest + 1e-6;
		return out;
	}

	/// Clearance of the moving bodies to one shape of the scene.
	double toShape( const State& q, uint32_t shape )
	{
		EXPECT_EQ( LW_OK, lw_robot_fk( m_world.robot.get(), m_world.full( q ).data(), m_poses.data() ) );
		double least = inf;
		for ( uint32_t i = 0; i < lw_robot_body_count( m_world.robot.get() ); ++i )
		{
			const uint32_t link = lw_robot_body( m_world.robot.get(), i ).link, object = m_world.placed[shape].object;
			if ( !movers( link ).empty() && m_allowed.count( { link, object } ) == 0 )
			{
				least = std::min( least, obstacleDistance( i, shape ) - m_world.margins.toObject( link, object ) );
			}
		}
		return least;
	}

	/// Clearance of one named pair at the state of the last question.
	double ofPair( bool self, uint32_t a, uint32_t b )
	{
		double least = inf;
		for ( uint32_t i = 0; i < lw_robot_body_count( m_world.robot.get() ); ++i )
		{
			if ( lw_robot_body( m_world.robot.get(), i ).link != a )
			{
				continue;
			}
			for ( uint32_t k = 0; !self && k < m_world.placed.size(); ++k )
			{
				least = m_world.placed[k].object == b ? std::min( least, obstacleDistance( i, k ) ) : least;
			}
			for ( uint32_t k = 0; self && k < lw_robot_body_count( m_world.robot.get() ); ++k )
			{
				least = lw_robot_body( m_world.robot.get(), k ).link == b ? std::min( least, bodyDistance( i, k ) ) : least;
			}
		}
		return least - ( self ? m_world.margins.ofLinks( a, b ) : m_world.margins.toObject( a, b ) );
	}

private:
	lw_transform bodyPose( uint32_t body ) const
	{
		const lw_body_def def = lw_robot_body( m_world.robot.get(), body );
		return lw_transform_multiply( &m_poses[def.link], &def.link_from_shape );
	}
	double distance( const lw_shape* a, const lw_transform& at, const lw_shape* b, const lw_transform& there )
	{
		lw_clearance out;
		EXPECT_EQ( LW_OK, lw_shape_distance( a, &at, b, &there, nullptr, m_query.get(), &out ) );
		return out.upper;
	}
	double obstacleDistance( uint32_t body, uint32_t shape )
	{
		const lw_scene_shape_def& obstacle = m_world.placed[shape];
		return distance( lw_robot_body( m_world.robot.get(), body ).shape, bodyPose( body ), obstacle.shape,
			obstacle.world_from_shape );
	}
	double bodyDistance( uint32_t a, uint32_t b )
	{
		return distance( lw_robot_body( m_world.robot.get(), a ).shape, bodyPose( a ),
			lw_robot_body( m_world.robot.get(), b ).shape, bodyPose( b ) );
	}
	/// Joints above a link that the group moves.
	std::set<uint32_t> movers( uint32_t link ) const
	{
		std::set<uint32_t> out;
		const lw_robot* robot = m_world.robot.get();
		for ( uint32_t joint; ( joint = lw_robot_link_joint( robot, link ) ) != LW_INVALID_INDEX; )
		{
			const uint32_t leader = lw_robot_joint_mimic( robot, joint );
			const uint32_t variable = lw_robot_joint_variable( robot, leader != LW_INVALID_INDEX ? leader : joint );
			double multiplier = 1;
			for ( uint32_t k = joint; m_world.model.joints[k].mimic != LW_INVALID_INDEX; k = m_world.model.joints[k].mimic )
			{
				multiplier *= m_world.model.joints[k].mimic_multiplier; // 0 stands still
			}
			if ( multiplier != 0 && std::count( m_world.group.begin(), m_world.group.end(), variable ) != 0 )
			{
				out.insert( joint );
			}
			link = lw_robot_joint_parent( robot, joint );
		}
		return out;
	}
	bool isSelfPair( uint32_t a, uint32_t b )
	{
		auto [found, fresh] = m_self.emplace( std::pair( a, b ), false );
		if ( fresh )
		{
			found->second = !lw_robot_pair_allowed( m_world.robot.get(), a, b ) && movers( a ) != movers( b );
		}
		return found->second;
	}

	const World& m_world;
	std::vector<lw_transform> m_poses;
	QueryPtr m_query;
	std::set<std::pair<uint32_t, uint32_t>> m_allowed;
	std::map<std::pair<uint32_t, uint32_t>, bool> m_self;
};

/// What an interval claims of the true clearance.
void judge( const lw_clearance& got, double truth, const lw_range& range, double lowest, const char* which )
{
	SCOPED_TRACE( ::testing::Message() << which << ": truth " << truth << " in [" << got.lower << ", " << got.upper
									   << "], kind " << got.kind << ", range " << range.min_d << ' ' << range.max_d );
	EXPECT_LE( got.lower, truth + rounding );
	if ( got.kind == LW_CLEARANCE_FAR )
	{
		EXPECT_EQ( got.upper, inf );
		EXPECT_TRUE( got.lower == range.max_d || got.lower == inf );
		return;
	}
	EXPECT_GE( got.upper, truth - rounding );
	EXPECT_GE( got.lower, lowest );
	switch ( got.kind )
	{
		case LW_CLEARANCE_NEAR:
			EXPECT_GT( got.lower, range.min_d );
			EXPECT_LT( got.lower, range.max_d );
			EXPECT_LE( got.upper - got.lower, range.alpha * got.upper + rounding );
			break;
		case LW_CLEARANCE_VIOLATION:
			EXPECT_LE( got.upper, range.min_d );
			break;
		default:
			EXPECT_EQ( got.kind, LW_CLEARANCE_UNDECIDED );
			EXPECT_NEAR( truth, range.min_d, rounding );
	}
}

void expectSame( const lw_clearance& plain, const lw_clearance& got, const char* which )
{
	EXPECT_EQ( plain.kind, got.kind ) << which << ' ' << plain.upper << ' ' << got.upper;
	if ( plain.kind != LW_CLEARANCE_VIOLATION ) // there any pair at or below min_d will do
	{
		EXPECT_EQ( plain.upper, got.upper ) << which;
		EXPECT_TRUE( plain.lower == got.lower || std::abs( plain.lower - got.lower ) < rounding ) << which;
	}
}

/// The witness is on the geometry: its length is the clearance and the margin of the pair that is named.
void judgeWitness( const World& world, const lw_checker* checker, const lw_clearance& got, bool self )
{
	if ( got.upper < inf )
	{
		const double length = std::hypot( got.point_a.x - got.point_b.x, got.point_a.y - got.point_b.y,
			got.point_a.z - got.point_b.z );
		const double margin = self ? world.margins.ofLinks( got.a, got.b ) : world.margins.toObject( got.a, got.b );
		EXPECT_EQ( margin, self ? lw_checker_self_margin( checker, got.a, got.b )
								: lw_checker_environment_margin( checker, got.a, got.b ) );
		EXPECT_NEAR( length - margin, got.upper, rounding );
	}
}

lw_state_result ask( const lw_checker* checker, lw_query* query, const State& q, const lw_range& range, bool stop = false )
{
	lw_state_result out;
	EXPECT_EQ( LW_OK, lw_checker_state( checker, query, q.data(), LW_WHAT_BOTH, &range, stop, &out ) );
	return out;
}

State groupState( SeededRng& rng, const World& world, double excess )
{
	return world.part( randomState( rng, world.robot.get(), excess ) );
}

const lw_range ranges[] = { { 0, inf, 0 }, { 0, 0.05, 0 }, { 0, 0.3, 0 }, { 0.01, 0.1, 0 }, { 0, 5e-324, 0 },
	{ 0.02, std::nextafter( 0.02, 1.0 ), 0 }, { 0, inf, 0.3 }, { 0.01, 0.4, 0.5 } };

struct Tally
{
	int near = 0, far = 0, violated = 0, inside = 0, by_margin = 0;
};

void judgeState( const World& world, Oracle& oracle, const std::vector<std::pair<const lw_checker*, lw_query*>>& all,
	const State& q, Tally& tally )
{
	const Oracle::Answer truth = oracle.ask( q );
	tally.inside += truth.inside;
	tally.by_margin += truth.by_margin;
	const lw_checker_info info = lw_checker_get_info( all[0].first );
	for ( const lw_range& range : ranges )
	{
		const double least = std::min( truth.environment, truth.self );
		lw_state_result first = {};
		for ( const auto& [checker, query] : all )
		{
			const lw_state_result got = ask( checker, query, q, range );
			judge( got.environment, truth.environment, range, -info.environment_margin, "environment" );
			judge( got.self, truth.self, range, -info.self_margin, "self" );
			judgeWitness( world, checker, got.environment, false );
			judgeWitness( world, checker, got.self, true );
			if ( std::abs( least - range.min_d ) > rounding )
			{
				const lw_verdict want = least > range.min_d ? LW_VERDICT_FREE : LW_VERDICT_BLOCKED;
				EXPECT_EQ( got.verdict, want );
				EXPECT_EQ( ask( checker, query, q, range, true ).verdict, want );
			}
			if ( checker == all[0].first )
			{
				first = got;
				tally.near += got.environment.kind == LW_CLEARANCE_NEAR;
				tally.far += got.environment.kind == LW_CLEARANCE_FAR;
				tally.violated += got.environment.kind == LW_CLEARANCE_VIOLATION;
			}
			else if ( range.alpha == 0 )
			{
				expectSame( first.environment, got.environment, "environment" );
				expectSame( first.self, got.self, "self" );
			}
		}
	}
}

} // namespace

TEST( Margins, state_is_not_distance_less_margin )
{
	SeededRng rng;
	Tally tally;
	for ( int i = 0; i < 50 && !HasFailure(); ++i )
	{
		SCOPED_TRACE( ::testing::Message() << "world " << i );
		World world = randomWorld( rng, i % 2 == 0 );
		world.margins = randomMargins( rng, world );
		Oracle oracle( world );
		// all pairs; with tables if there are any; with obstacles passed over
		const CheckerPtr plain = world.build( nullptr, 1e9 ), tables = world.build( world.reach.get(), 1e9 ),
						 less = world.build( world.reach.get(), i % 3 == 0 ? inf : 0.1 );
		const QueryPtr queries[] = { makeQuery( plain.get(), false, false ), makeQuery( tables.get() ),
			makeQuery( tables.get(), false ), makeQuery( less.get() ), makeQuery( less.get(), true, false ) };
		const std::vector<std::pair<const lw_checker*, lw_query*>> all = { { plain.get(), queries[0].get() },
			{ tables.get(), queries[1].get() }, { tables.get(), queries[2].get() }, { less.get(), queries[3].get() },
			{ less.get(), queries[4].get() } };
		for ( int k = 0; k < 12 && !HasFailure(); ++k )
		{
			SCOPED_TRACE( ::testing::Message() << "state " << k );
			judgeState( world, oracle, all, groupState( rng, world, k % 4 == 3 ? 1.5 : 0 ), tally );
		}
	}
	std::printf( "%d near, %d far, %d violated; %d inside of a margin, %d nearest by their margin\n", tally.near, tally.far,
		tally.violated, tally.inside, tally.by_margin );
	EXPECT_GE( std::min( { tally.near, tally.far, tally.violated } ), 100 );
	EXPECT_GE( tally.inside, 50 );
	EXPECT_GE( tally.by_margin, 50 );
}

namespace
{

/// A chain of boxes that can hardly bend, so that spheres and tables rule out whole parts of it; few of its links have a margin,
/// and that is large.
World stiffWorld( SeededRng& rng )
{
	World world;
	const double box[3] = { 0.1, 0.1, 0.1 };
	const uint32_t links = 7;
	for ( uint32_t i = 0; i < links; ++i )
	{
		if ( i == 0 )
		{
			world.model.link( "base" );
		}
		else
		{
			lw_joint_def& joint = world.model.joint( "l" + std::to_string( i ), LW_JOINT_REVOLUTE, i - 1 );
			joint.parent_from_joint.t[0] = 0.4;
			joint.lower = -0.1;
			joint.upper = 0.1;
		}
		lw_shape* shape = nullptr;
		EXPECT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_BOX, box, nullptr, nullptr, &shape ) );
		world.model.body( i, shape, lw_transform_identity() );
	}
	world.robot = world.model.create();
	world.reach = makeReach( world.robot.get() );
	world.reference = State( links - 1, 0 );
	for ( uint32_t i = 0; i + 1 < links; ++i )
	{
		world.group.push_back( i );
	}
	world.objects = 3;
	for ( uint32_t i = 0; i < world.objects; ++i )
	{
		world.shapes.emplace_back( randomPrimitive( rng, 0.1, nullptr ) );
		lw_transform at = randomTransform( rng, 0 );
		at.t[0] = rng.uniform( 0, 2.4 );
		at.t[1] = rng.uniform( 0.3, 1.2 );
		world.placed.push_back( { world.shapes.back().get(), i, at } );
	}
	createScene( world );
	Margins& m = world.margins;
	m.link.assign( links, 0 );
	m.link[static_cast<std::size_t>( rng.integer( 0, links - 1 ) )] = rng.uniform( 0.2, 1 );
	const uint32_t a = static_cast<uint32_t>( rng.integer( 0, 3 ) ), b = static_cast<uint32_t>( rng.integer( 4, links - 1 ) );
	m.self_pairs[{ a, b }] = rng.uniform( 0.6, 1.2 ) * 0.4 * ( b - a );
	if ( rng.integer( 0, 1 ) != 0 )
	{
		m.pairs[{ b, 1 }] = rng.uniform( 0.2, 1 );
	}
	return world;
}

} // namespace

TEST( Margins, part_of_a_robot_is_ruled_out_by_less_than_its_margin )
{
	SeededRng rng;
	Tally tally;
	for ( int i = 0; i < 60 && !HasFailure(); ++i )
	{
		SCOPED_TRACE( ::testing::Message() << "world " << i );
		World world = stiffWorld( rng );
		Oracle oracle( world );
		const CheckerPtr plain = world.build( nullptr, 1e9 ), tables = world.build( world.reach.get(), 1e9 );
		EXPECT_EQ( lw_checker_get_info( tables.get() ).hierarchy, world.reach != nullptr );
		const QueryPtr one = makeQuery( plain.get(), false, false );
		const QueryPtr other = makeQuery( tables.get(), true, false ); // a warm start would find what the spheres hide
		for ( int k = 0; k < 4; ++k )
		{
			judgeState( world, oracle, { { plain.get(), one.get() }, { tables.get(), other.get() } },
				groupState( rng, world, 0 ), tally );
		}
	}
	EXPECT_GE( std::min( { tally.near, tally.far, tally.violated } ), 50 );
	EXPECT_GE( tally.inside, 50 );
}

TEST( Margins, obstacle_is_passed_over_within_its_margin )
{
	SeededRng rng;
	int passed_over = 0, negative = 0;
	for ( int i = 0; i < 50 && !HasFailure(); ++i )
	{
		SCOPED_TRACE( ::testing::Message() << "world " << i );
		World world = randomWorld( rng, false );
		world.margins = randomMargins( rng, world );
		Oracle oracle( world );
		const CheckerPtr checker = world.build( nullptr, 0.05 );
		const lw_checker_info info = lw_checker_get_info( checker.get() );
		passed_over += info.near_shapes < world.placed.size();
		for ( int k = 0; k < 20; ++k )
		{
			const State q = groupState( rng, world, 0 );
			for ( uint32_t shape = 0; shape < world.placed.size(); ++shape )
			{
				const double proved = lw_checker_obstacle_distance( checker.get(), shape );
				negative += proved < 0;
				EXPECT_GE( oracle.toShape( q, shape ), proved - rounding );
			}
		}
	}
	EXPECT_GE( passed_over, 20 );
	EXPECT_GE( negative, 100 );
}

// A checker made after another one, with other margins, must not believe what held for the old ones.
TEST( Margins, edit_keeps_an_old_margin )
{
	SeededRng rng;
	int fixed = 0, shared = 0;
	for ( int i = 0; i < 40 && !HasFailure(); ++i )
	{
		SCOPED_TRACE( ::testing::Message() << "world " << i );
		World world = randomWorld( rng, i % 4 == 0 );
		CheckerPtr last = world.build( world.reach.get(), 0.2 );
		for ( int k = 0; k < 6; ++k )
		{
			const Margins before = world.margins, fresh = randomMargins( rng, world );
			world.margins = k % 3 == 2 ? Margins() : fresh;
			if ( k % 2 == 0 ) // the environment's alone
			{
				world.margins.self = before.self;
				world.margins.link_self = before.link_self;
				world.margins.self_pairs = before.self_pairs;
			}
			const CheckerPtr edited = world.build( world.reach.get(), 0.2, last.get() );
			const CheckerPtr anew = world.build( world.reach.get(), 0.2 );
			const lw_checker_info a = lw_checker_get_info( edited.get() ), b = lw_checker_get_info( anew.get() );
			expectSame( b.static_environment, a.static_environment, "static" );
			fixed += b.static_environment.upper < inf;
			shared += k % 2 == 0;
			EXPECT_EQ( a.never_pairs, b.never_pairs );
			EXPECT_EQ( a.near_shapes, b.near_shapes );
			const QueryPtr one = makeQuery( edited.get() ), other = makeQuery( anew.get() );
			for ( int j = 0; j < 4; ++j )
			{
				const State q = groupState( rng, world, 0 );
				for ( const lw_range& range : { ranges[0], ranges[1], ranges[4] } )
				{
					const lw_state_result got = ask( edited.get(), one.get(), q, range ),
										  want = ask( anew.get(), other.get(), q, range );
					EXPECT_EQ( want.verdict, got.verdict );
					expectSame( want.environment, got.environment, "environment" );
					expectSame( want.self, got.self, "self" );
				}
			}
			last.reset( lw_checker_retain( edited.get() ) );
		}
	}
	EXPECT_GE( fixed, 30 );
	EXPECT_GE( shared, 60 );
}

// --- edges -----------------------------------------------------------------------------------------------------------

namespace
{

/// Group state at t.
State stateAt( const World& world, const State& a, const State& b, double t )
{
	State out( world.reference.size() );
	lw_robot_interpolate( world.robot.get(), world.full( a ).data(), world.full( b ).data(), t, out.data() );
	return world.part( out );
}

/// The least clearance that a look at some states of an edge finds.
double lookAt( const World& world, Oracle& oracle, const State& a, const State& b, double end, int steps )
{
	double least = inf;
	for ( int i = 0; i <= steps; ++i )
	{
		const Oracle::Answer truth = oracle.ask( stateAt( world, a, b, end * i / steps ) );
		least = std::min( { least, truth.environment, truth.self } );
	}
	return least;
}

struct EdgeTally
{
	int free = 0, blocked = 0, refused = 0, partial = 0, nearly = 0;
};

void judgeEdge( const World& world, Oracle& oracle, const lw_checker* checker, lw_query* query, const State& a,
	const State& b, const lw_edge_def& def, EdgeTally& tally )
{
	lw_edge_result r;
	if ( lw_checker_edge( checker, query, a.data(), b.data(), &def, &r ) != LW_OK )
	{
		return; // a mimic joint without limits has no motion bound
	}
	SCOPED_TRACE( ::testing::Message() << lw_verdict_name( r.verdict ) << " at " << r.t << ", min_d " << def.min_d );
	const bool certified = def.method == LW_EDGE_CERTIFIED;
	if ( r.verdict == LW_VERDICT_FREE )
	{
		++tally.free;
		const double least = lookAt( world, oracle, a, b, 1, 40 );
		tally.nearly += least < def.min_d + 0.02;
		EXPECT_TRUE( !certified || least >= r.lower_bound - rounding ) << least << ' ' << r.lower_bound;
		EXPECT_TRUE( !certified || r.lower_bound > def.min_d );
		EXPECT_GT( certified ? least : std::min( lookAt( world, oracle, a, b, 1, 1 ), inf ), def.min_d - rounding );
		return;
	}
	oracle.ask( stateAt( world, a, b, r.t ) );
	const double pair = oracle.ofPair( r.self, r.pair.a, r.pair.b );
	const bool blocked = r.verdict == LW_VERDICT_BLOCKED;
	++( blocked ? tally.blocked : tally.refused );
	EXPECT_LE( pair, ( blocked ? def.min_d : ( def.min_d + def.slack ) / ( 1 - def.alpha ) ) + rounding );
	EXPECT_TRUE( !blocked || r.pair.upper <= def.min_d );
	if ( r.proved_until > 0 && certified )
	{
		++tally.partial;
		EXPECT_GT( lookAt( world, oracle, a, b, r.proved_until, 20 ), def.min_d );
	}
}

} // namespace

TEST( Margins, edge_enters_a_margin )
{
	SeededRng rng;
	EdgeTally tally;
	for ( int i = 0; i < 50 && !HasFailure(); ++i )
	{
		SCOPED_TRACE( ::testing::Message() << "world " << i );
		World world = randomWorld( rng, i % 2 == 0 );
		world.margins = randomMargins( rng, world );
		Oracle oracle( world );
		const CheckerPtr plain = world.build( nullptr, 1e9 ), tables = world.build( world.reach.get(), 0.2 );
		const QueryPtr one = makeQuery( plain.get(), false ), other = makeQuery( tables.get() );
		// from a state that is free, if there is one nearby
		State home = groupState( rng, world, 0 );
		for ( int k = 0; k < 30 && ask( plain.get(), one.get(), home, ranges[4] ).verdict != LW_VERDICT_FREE; ++k )
		{
			home = groupState( rng, world, 0 );
		}
		for ( int k = 0; k < 5 && !HasFailure(); ++k )
		{
			const State far = groupState( rng, world, 0 ), to = stateAt( world, home, far, rng.decade( -2, 0 ) );
			lw_edge_def def = lw_edge_def_default();
			def.method = k == 4 ? LW_EDGE_STEPS : LW_EDGE_CERTIFIED;
			def.max_d = 0.05;
			def.min_d = rng.integer( 0, 1 ) != 0 ? 0 : rng.decade( -3, -1 );
			def.slack = rng.decade( -4, -2 );
			def.want_proved_until = true;
			judgeEdge( world, oracle, plain.get(), one.get(), home, to, def, tally );
			judgeEdge( world, oracle, tables.get(), other.get(), home, to, def, tally );
		}
	}
	std::printf( "%d free, %d nearly not, %d blocked, %d refused, %d proved in part\n", tally.free, tally.nearly,
		tally.blocked, tally.refused, tally.partial );
	EXPECT_GE( std::min( tally.free, tally.blocked ), 80 );
	EXPECT_GE( std::min( tally.partial, tally.nearly ), 10 );
}

// --- laws ------------------------------------------------------------------------------------------------------------

// Zeros, however they are spelt, are no margins: bit for bit, and without a byte.
TEST( Margins, zeros_change_an_answer )
{
	SeededRng rng;
	for ( int i = 0; i < 15; ++i )
	{
		World world = randomWorld( rng, false );
		const CheckerPtr none = world.build();
		const uint32_t links = lw_robot_link_count( world.robot.get() );
		world.margins.link.assign( links, 0 );
		world.margins.link_self.assign( links, 0 );
		world.margins.object.assign( world.objects, 0 );
		world.margins.self_pairs[{ 0, 1 }] = 0;
		if ( world.objects > 0 )
		{
			world.margins.pairs[{ 1, 0 }] = 0;
		}
		const CheckerPtr zeros = world.build();
		EXPECT_EQ( lw_checker_get_info( none.get() ).bytes, lw_checker_get_info( zeros.get() ).bytes );
		EXPECT_EQ( lw_checker_get_info( zeros.get() ).environment_margin, 0 );
		const QueryPtr one = makeQuery( none.get() ), other = makeQuery( zeros.get() );
		for ( int k = 0; k < 10; ++k )
		{
			const State q = groupState( rng, world, 0 );
			const lw_state_result a = ask( none.get(), one.get(), q, ranges[0] ), b = ask( zeros.get(), other.get(), q, ranges[0] );
			EXPECT_TRUE( sameBits( a.environment, b.environment ) );
			EXPECT_TRUE( sameBits( a.self, b.self ) );
		}
	}
}

// The same margin for all pairs moves all answers by it, and nothing else.
TEST( Margins, uniform_margin_is_not_a_shift )
{
	SeededRng rng;
	int shifted = 0;
	for ( int i = 0; i < 25; ++i )
	{
		World world = randomWorld( rng, i % 3 == 0 );
		const CheckerPtr none = world.build( world.reach.get() );
		const double margin = rng.decade( -3, -1 );
		world.margins.environment = world.margins.self = margin;
		const CheckerPtr with = world.build( world.reach.get() );
		const QueryPtr one = makeQuery( none.get() ), other = makeQuery( with.get() );
		for ( int k = 0; k < 10; ++k )
		{
			const State q = groupState( rng, world, 0 );
			const lw_state_result a = ask( none.get(), one.get(), q, ranges[0] ), b = ask( with.get(), other.get(), q, ranges[0] );
			for ( const auto& [bare, less] : { std::pair( a.environment, b.environment ), std::pair( a.self, b.self ) } )
			{
				if ( bare.upper < inf && bare.upper > margin )
				{
					++shifted;
					EXPECT_EQ( bare.upper - margin, less.upper );
					EXPECT_EQ( bare.a, less.a );
					EXPECT_EQ( bare.b, less.b );
					EXPECT_EQ( 0, std::memcmp( &bare.point_a, &less.point_a, sizeof( lw_vec3 ) ) );
				}
			}
		}
	}
	EXPECT_GE( shifted, 150 );
}

// A ball with a margin is a larger ball.
TEST( Margins, margin_of_a_ball_is_not_its_radius )
{
	for ( const double gap : { 0.5, 0.031, 0.03, 0.02, -0.01 } )
	{
		World world;
		world.model.link( "base" );
		world.model.joint( "slider", LW_JOINT_PRISMATIC, 0 );
		const double ball[3] = { 0.1, 0, 0 }, box[3] = { 0.2, 0.2, 0.2 };
		lw_shape* shape = nullptr;
		ASSERT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_SPHERE, ball, nullptr, nullptr, &shape ) );
		world.model.body( 1, shape, lw_transform_identity() );
		ASSERT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_BOX, box, nullptr, nullptr, &shape ) );
		world.shapes.emplace_back( shape );
		lw_transform at = lw_transform_identity();
		at.t[0] = 0.2 + gap;
		world.placed = { { shape, 0, at } };
		world.objects = 1;
		createScene( world );
		world.robot = world.model.create();
		world.reference = { 0 };
		world.group = { 0 };
		world.margins.link = { 0, 0.02 };
		world.margins.object = { 0.01 };
		const CheckerPtr checker = world.build();
		const QueryPtr query = makeQuery( checker.get() );
		const lw_state_result got = ask( checker.get(), query.get(), { 0 }, ranges[0] );
		EXPECT_EQ( got.verdict, gap > 0.03 + 1e-9 ? LW_VERDICT_FREE : gap < 0.03 - 1e-9 ? LW_VERDICT_BLOCKED : got.verdict );
		EXPECT_NEAR( got.environment.upper, std::max( gap, 0.0 ) - 0.03, 1e-12 ) << "contact is as deep as the margin, no deeper";
		EXPECT_EQ( got.environment.kind == LW_CLEARANCE_VIOLATION, got.environment.upper <= 0 );
		EXPECT_EQ( lw_checker_environment_margin( checker.get(), 1, 0 ), 0.03 );
		EXPECT_EQ( lw_checker_environment_margin( checker.get(), 1, 1 ), 0 ) << "no such object";
	}
}

// --- bad input -------------------------------------------------------------------------------------------------------

TEST( Margins, nonsense_is_a_margin )
{
	SeededRng rng;
	World world = randomWorld( rng, false );
	while ( world.objects < 2 )
	{
		world = randomWorld( rng, false );
	}
	const uint32_t links = lw_robot_link_count( world.robot.get() );
	const auto refuse = [&]( const std::string& want, const std::function<void( Margins& )>& spoil )
	{
		world.margins = Margins();
		spoil( world.margins );
		lw_diag diag = {};
		CheckerPtr checker;
		EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, world.build( checker, &diag, nullptr ) ) << want;
		EXPECT_EQ( checker, nullptr );
		EXPECT_NE( std::string( diag.message ).find( want ), std::string::npos ) << diag.message;
	};
	for ( const double bad : { -1e-9, inf, std::nan( "" ) } )
	{
		refuse( "environment is", [&]( Margins& m ) { m.environment = bad; } );
		refuse( "self is", [&]( Margins& m ) { m.self = bad; } );
		refuse( "link_environment of link 'l0'", [&]( Margins& m ) { m.link.assign( links, 0 ), m.link[1] = bad; } );
		refuse( "link_self of link 'l0'", [&]( Margins& m ) { m.link_self.assign( links, 0 ), m.link_self[1] = bad; } );
		refuse( "object 'object1'", [&]( Margins& m ) { m.object.assign( world.objects, 0 ), m.object[1] = bad; } );
		refuse( "pair 'l0', 'object1'", [&]( Margins& m ) { m.pairs[{ 1, 1 }] = bad; } );
		refuse( "self pair 'l1', 'l0'", [&]( Margins& m ) { m.self_pairs[{ 1, 2 }] = bad; } );
	}
	refuse( "index out of range", [&]( Margins& m ) { m.pairs[{ links, 0 }] = 0.1; } );
	refuse( "index out of range", [&]( Margins& m ) { m.pairs[{ 0, world.objects }] = 0.1; } );
	refuse( "index out of range", [&]( Margins& m ) { m.self_pairs[{ 0, links }] = 0.1; } );
	refuse( "with itself", [&]( Margins& m ) { m.self_pairs[{ 1, 1 }] = 0.1; } );

	lw_checker_def def = lw_checker_def_default();
	def.robot = world.robot.get();
	def.scene = world.scene.get();
	const lw_pair_margin twice[] = { { 0, 1, 0.1 }, { 1, 0, 0.2 }, { 0, 1, 0.1 } };
	lw_diag diag = {};
	lw_checker* checker = nullptr;
	def.margins.environment_pairs = twice;
	def.margins.environment_pair_count = 3;
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_checker_create( &def, nullptr, &diag, &checker ) );
	EXPECT_STREQ( diag.message, "margins: pair 'root', 'object1' is there twice; keep one of them" );
	def.margins = {};
	def.margins.self_pairs = twice;
	def.margins.self_pair_count = 2;
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_checker_create( &def, nullptr, &diag, &checker ) );
	EXPECT_STREQ( diag.message, "margins: self pair 'root', 'l0' is there twice; keep one of them" );
	def.margins.self_pairs = nullptr;
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_checker_create( &def, nullptr, &diag, &checker ) );
	EXPECT_STREQ( diag.message, "margins: self pairs are NULL, their count is not 0" );
}

TEST( Margins, leak_without_memory )
{
	SeededRng rng;
	World world = randomWorld( rng, false );
	while ( world.objects == 0 )
	{
		world = randomWorld( rng, false );
	}
	world.margins = randomMargins( rng, world );
	world.margins.object.assign( world.objects, 0.01 );
	world.margins.pairs[{ 0, 0 }] = 0.2;
	world.margins.self_pairs[{ 0, 1 }] = 0.2;
	CheckerPtr checker;
	lw_status status = LW_ERROR_OUT_OF_MEMORY;
	for ( int allowed = 0; status != LW_OK && !HasFailure(); ++allowed )
	{
		CountingAllocator memory;
		memory.left = allowed;
		const lw_allocator allocator = memory.get();
		lw_diag diag = {};
		status = world.build( checker, &diag, nullptr, inf, &allocator );
		EXPECT_TRUE( status == LW_OK || status == LW_ERROR_OUT_OF_MEMORY );
		checker.reset();
		EXPECT_EQ( memory.live, 0 ) << allowed;
		EXPECT_EQ( memory.bytes, 0u ) << allowed;
	}
}
