// SPDX-License-Identifier: BSD-3-Clause
// Margins of pairs in random worlds: every answer of a checker against brute force over all pairs, distances of
// lw_shape_distance() less margins that are added up here once more.
#pragma once

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

const double inf = std::numeric_limits<double>::infinity();

/// Of distances of a few metres, with poses that are multiplied in another order.
const double rounding = 1e-10;

/// Margins that own their arrays, and their values by pair.
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
		return found != self_pairs.end() ? found->second
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

inline void createScene( World& world )
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

inline ReachPtr makeReach( const lw_robot* robot )
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

inline World randomWorld( SeededRng& rng, bool with_reach )
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
inline Margins randomMargins( SeededRng& rng, const World& world )
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
		bool inside = false;    ///< the nearest of all is closer than its margin, and not touching
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
				const uint32_t a = lw_robot_body( m_world.robot.get(), i ).link,
				               b = lw_robot_body( m_world.robot.get(), k ).link;
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
		return distance(
		    lw_robot_body( m_world.robot.get(), body ).shape, bodyPose( body ), obstacle.shape, obstacle.world_from_shape );
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

/// The claims of an interval about the true clearance.
inline void judge( const lw_clearance& got, double truth, const lw_range& range, double lowest, const char* which )
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

inline void expectSame( const lw_clearance& plain, const lw_clearance& got, const char* which )
{
	EXPECT_EQ( plain.kind, got.kind ) << which << ' ' << plain.upper << ' ' << got.upper;
	if ( plain.kind != LW_CLEARANCE_VIOLATION ) // there any pair at or below min_d will do
	{
		EXPECT_EQ( plain.upper, got.upper ) << which;
		EXPECT_TRUE( plain.lower == got.lower || std::abs( plain.lower - got.lower ) < rounding ) << which;
	}
}

/// The witness is on the geometry: its length is the clearance and the margin of the pair that is named.
inline void judgeWitness( const World& world, const lw_checker* checker, const lw_clearance& got, bool self )
{
	if ( got.upper < inf )
	{
		const double length =
		    std::hypot( got.point_a.x - got.point_b.x, got.point_a.y - got.point_b.y, got.point_a.z - got.point_b.z );
		const double margin = self ? world.margins.ofLinks( got.a, got.b ) : world.margins.toObject( got.a, got.b );
		EXPECT_EQ( margin, self ? lw_checker_self_margin( checker, got.a, got.b )
		                        : lw_checker_environment_margin( checker, got.a, got.b ) );
		EXPECT_NEAR( length - margin, got.upper, rounding );
	}
}

inline lw_state_result ask(
    const lw_checker* checker, lw_query* query, const State& q, const lw_range& range, bool stop = false )
{
	lw_state_result out;
	EXPECT_EQ( LW_OK, lw_checker_state( checker, query, q.data(), LW_CHECK_BOTH, &range, stop, &out ) );
	return out;
}

inline State groupState( SeededRng& rng, const World& world, double excess )
{
	return world.part( randomState( rng, world.robot.get(), excess ) );
}

const lw_range ranges[] = { { 0, inf, 0 }, { 0, 0.05, 0 }, { 0, 0.3, 0 }, { 0.01, 0.1, 0 }, { 0, 5e-324, 0 },
    { 0.02, std::nextafter( 0.02, 1.0 ), 0 }, { 0, inf, 0.3 }, { 0.01, 0.4, 0.5 } };
