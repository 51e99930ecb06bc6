// SPDX-License-Identifier: BSD-3-Clause
// Robots at the extremes: chains of 200 links, joints at 1e6 radians, 1e7 m from the origin; states against exact
// kinematics.
#include "checker_handles.hpp"
#include "extreme_judge.hpp"

#include <gtest/gtest.h>

using namespace extremes;
using exact::Wide;

namespace
{

constexpr std::uint32_t robot_links = 201;

/// The promised error of a state for its poses (leeway/checker.h), but for the share of the distance.
double poseRounding( double length, double root )
{
	return ( 192 * length + 24 * root ) * 0x1p-53 * ( robot_links + 1 );
}

enum Kind
{
	aligned, ///< all about z, a few milliradians each: rounding adds up one way
	skew,
	coiled, ///< a compact heap
	with_shifts,
	kind_count
};

/// A chain of links, a small triangle on each, and its pose in long double.
class Chain
{
public:
	Chain( Random& random, Kind kind ) : m_kind( kind )
	{
		std::vector<const char*> names;
		for ( std::uint32_t i = 0; i < robot_links; ++i )
		{
			m_names.push_back( "l" + std::to_string( i ) );
			m_joint_names.push_back( "j" + std::to_string( i ) );
		}
		for ( const std::string& name : m_names )
		{
			names.push_back( name.c_str() );
		}
		double size = kind == coiled ? 0.02 : 0.05;
		for ( int i = 0; i < 3; ++i )
		{
			lw_vec3 v = random.point();
			m_body.items.resize( 1 );
			m_body.items[0].v[i] = { size * v.x, size * v.y, size * v.z };
		}
		m_shape = makeShape( random, m_body );
		for ( std::uint32_t i = 0; i + 1 < robot_links; ++i )
		{
			lw_joint_def joint = lw_joint_def_default();
			bool shift = kind == with_shifts && i % 20 == 7;
			joint.name = m_joint_names[i].c_str();
			joint.type = shift ? LW_JOINT_PRISMATIC : LW_JOINT_REVOLUTE;
			joint.parent = i;
			joint.child = i + 1;
			joint.lower = -1e7;
			joint.upper = 1e7;
			if ( kind != aligned )
			{
				joint.parent_from_joint = randomRotation( random );
			}
			joint.parent_from_joint.t[0] = kind == coiled ? 0.01 : 0.1;
			joint.parent_from_joint.t[1] = kind == coiled ? 0.02 * random.unit() : 0;
			lw_vec3 axis = kind == aligned          ? lw_vec3{ 0, 0, 1 }
			               : random.below( 2 ) == 0 ? lw_vec3{ 0, 1, 0 }
			                                        : random.point();
			joint.axis[0] = axis.x, joint.axis[1] = axis.y, joint.axis[2] = axis.z;
			m_joints.push_back( joint );
		}
		std::vector<lw_body_def> bodies;
		for ( std::uint32_t i = 0; i < robot_links; ++i )
		{
			bodies.push_back( { m_shape.get(), i, lw_transform_identity() } );
		}
		std::vector<lw_link_pair> allowed; // neighbours, which are always near
		for ( std::uint32_t i = 0; i + 1 < robot_links; ++i )
		{
			for ( std::uint32_t k = i + 1; k < std::min( i + 4, robot_links ); ++k )
			{
				allowed.push_back( { i, k } );
			}
		}
		lw_robot_def def = lw_robot_def_default();
		def.name = "chain";
		def.link_names = names.data();
		def.link_count = robot_links;
		def.joints = m_joints.data();
		def.joint_count = robot_links - 1;
		def.bodies = bodies.data();
		def.body_count = robot_links;
		def.allowed_pairs = allowed.data();
		def.allowed_pair_count = static_cast<std::uint32_t>( allowed.size() );
		double far = random.below( 2 ) == 0 ? 0 : 1e7;
		def.world_from_root.t[0] = far * random.unit();
		m_root = def.world_from_root;
		lw_robot* robot = nullptr;
		lw_diag diag = {};
		EXPECT_EQ( LW_OK, lw_robot_create( &def, nullptr, &diag, &robot ) ) << diag.message;
		m_robot.reset( robot );
	}

	std::vector<double> randomState( Random& random ) const
	{
		std::vector<double> q;
		double same = 0.002 * random.unit();
		for ( const lw_joint_def& joint : m_joints )
		{
			double spread = m_kind == coiled ? 1e6 : m_kind == skew ? 3 : 0.3;
			q.push_back( m_kind == aligned                  ? same
			             : joint.type == LW_JOINT_PRISMATIC ? random.unit()
			                                                : spread * random.unit() );
		}
		return q;
	}

	/// All links, about the root's position in the world.
	std::vector<std::vector<exact::Placed>> poses( const std::vector<double>& q, double* length ) const
	{
		std::vector<std::vector<exact::Placed>> out;
		exact::Rotation r( m_root );
		exact::Vec<Wide> t = { 0, 0, 0 };
		*length = m_body.coordinates() * 4;
		out.push_back( exact::place( m_body, r, t ) );
		for ( std::size_t i = 0; i < m_joints.size(); ++i )
		{
			const lw_joint_def& joint = m_joints[i];
			const double* p = joint.parent_from_joint.t;
			t = t + r( exact::Vec<Wide>{ p[0], p[1], p[2] } );
			r = r * exact::Rotation( joint.parent_from_joint );
			exact::Vec<Wide> axis = { joint.axis[0], joint.axis[1], joint.axis[2] };
			axis = ( 1 / exact::length( axis ) ) * axis;
			*length += std::hypot( p[0], p[1], p[2] );
			if ( joint.type == LW_JOINT_PRISMATIC )
			{
				t = t + r( Wide( q[i] ) * axis );
				*length += std::abs( q[i] );
			}
			else
			{
				r = r * exact::turn( axis, q[i] );
			}
			out.push_back( exact::place( m_body, r, t ) );
		}
		return out;
	}

	const lw_robot* robot() const { return m_robot.get(); }
	const exact::Body& body() const { return m_body; }
	const lw_transform& root() const { return m_root; }

private:
	Kind m_kind;
	std::vector<std::string> m_names, m_joint_names;
	std::vector<lw_joint_def> m_joints;
	exact::Body m_body;
	std::unique_ptr<lw_shape, ReleaseShape> m_shape;
	std::unique_ptr<lw_robot, Releaser<lw_robot, lw_robot_release>> m_robot;
	lw_transform m_root;
};

struct Seen
{
	double lower = 0, upper = 0; ///< worst, in units of the promise
	int answers = 0;
};

/// lower <= truth <= upper + rounding, where the truth is that of exact kinematics.
void judge( const lw_clearance& got, const exact::Enclosure& truth, double poses, double promise, Seen& seen )
{
	++seen.answers;
	EXPECT_LE( got.lower, truth.upper ) << "lower is above the truth, by "
	                                    << static_cast<double>( got.lower - truth.upper ) / poses
	                                    << " of the poses' rounding";
	EXPECT_GE( got.upper + poses + promise, truth.lower );
	EXPECT_LE( got.upper - got.lower, 1.25 * ( poses + promise ) );
	seen.upper = std::max( seen.upper, static_cast<double>( truth.lower - got.upper ) / ( poses + promise ) );
	seen.lower = std::max( seen.lower, static_cast<double>( got.upper - truth.lower ) / ( got.upper - got.lower ) );
}

/// A checker of a chain and of an obstacle near its tip at some state.
struct Tip
{
	exact::Body obstacle;
	lw_transform pose;
	std::unique_ptr<lw_shape, ReleaseShape> shape;
	ScenePtr scene;
	CheckerPtr checker;

	Tip( Random& random, const Chain& chain, const std::vector<double>& q );
};

Tip::Tip( Random& random, const Chain& chain, const std::vector<double>& q )
{
	double length;
	const exact::Vec<Wide> tip = chain.poses( q, &length ).back()[0].center;
	obstacle = randomBody( random );
	scaleBody( obstacle, { 0, 0, 0 }, 0.1 );
	shape = makeShape( random, obstacle );
	const char* names[1] = { "obstacle" };
	lw_scene_shape_def in_scene = { shape.get(), 0, randomRotation( random ) };
	for ( int k = 0; k < 3; ++k )
	{
		const Wide c[3] = { tip.x, tip.y, tip.z };
		in_scene.world_from_shape.t[k] = chain.root().t[k] + static_cast<double>( c[k] ) + 0.2 * random.unit();
	}
	pose = in_scene.world_from_shape;
	lw_scene_def scene_def = lw_scene_def_default();
	scene_def.object_names = names;
	scene_def.object_count = 1;
	scene_def.shapes = &in_scene;
	scene_def.shape_count = 1;
	lw_scene* new_scene = nullptr;
	lw_diag diag = {};
	EXPECT_EQ( LW_OK, lw_scene_create( &scene_def, nullptr, &diag, &new_scene ) ) << diag.message;
	scene.reset( new_scene );
	lw_checker_def checker_def = lw_checker_def_default();
	checker_def.robot = chain.robot();
	checker_def.scene = new_scene;
	lw_checker* made = nullptr;
	EXPECT_EQ( LW_OK, lw_checker_create( &checker_def, nullptr, &diag, &made ) ) << diag.message;
	checker.reset( made );
}

/// Distances by exact kinematics, and the promised roundings of answers.
struct Truth
{
	exact::Enclosure environment = { INFINITY, INFINITY, 0 }, self = environment;
	double poses, promise; ///< metres: of the poses, but for the share of the distance; of the distance
	double stretch = 64 * 0x1p-53 * ( robot_links + 1 ); ///< that share
};

Truth truthOf( const Chain& chain, const Tip& tip, const std::vector<double>& q )
{
	Truth truth;
	double length;
	const std::vector<std::vector<exact::Placed>> links = chain.poses( q, &length );
	const exact::Vec<Wide> offset = { Wide( tip.pose.t[0] ) - chain.root().t[0], Wide( tip.pose.t[1] ) - chain.root().t[1],
	    Wide( tip.pose.t[2] ) - chain.root().t[2] };
	const exact::Rotation turned( tip.pose );
	const std::vector<exact::Placed> there = exact::place( tip.obstacle, turned, offset );
	truth.poses = poseRounding( length, std::abs( chain.root().t[0] ) );
	for ( std::size_t a = 0; a < links.size(); ++a )
	{
		exact::lowerTo( truth.environment, links[a], there, 0.01 * truth.poses );
		if ( exact::isInside( links[a], tip.obstacle, turned, offset ) )
		{
			truth.environment = { 0, 0, 0 };
		}
		for ( std::size_t b = a + 4; b < links.size(); ++b )
		{
			exact::lowerTo( truth.self, links[a], links[b], 0.01 * truth.poses );
		}
	}
	const double size = length + 3 * tip.obstacle.coordinates();
	truth.promise = ( 0x1p-46 + ( tip.obstacle.boxes.empty() ? 0 : 1e-12 ) ) * size;
	return truth;
}

/// Ranges that end within the known interval of the distance: FAR would claim more.
void expectNotFar( const lw_checker* checker, lw_query* query, const std::vector<double>& q, const lw_state_result& known,
    const Truth& truth )
{
	for ( double share : { 0.1, 0.4, 0.7, 0.95 } )
	{
		for ( lw_check_flags flags : { LW_CHECK_ENVIRONMENT, LW_CHECK_SELF } )
		{
			const bool is_self = flags == LW_CHECK_SELF;
			const lw_clearance& of = is_self ? known.self : known.environment;
			const lw_range range = { 0, of.lower + share * ( of.upper - of.lower ), 0 };
			if ( !( of.lower > 0 && range.max_d > of.lower && range.max_d < of.upper ) )
			{
				continue;
			}
			lw_state_result result;
			ASSERT_EQ( LW_OK, lw_checker_state( checker, query, q.data(), flags, &range, false, &result ) );
			const lw_clearance& got = is_self ? result.self : result.environment;
			EXPECT_NE( got.kind, LW_CLEARANCE_FAR )
			    << "max_d " << range.max_d << " in [" << of.lower << ", " << of.upper << "]";
			EXPECT_LE( got.lower, is_self ? truth.self.upper : truth.environment.upper );
		}
	}
}

} // namespace

TEST( ExtremeChains, StateDiffersFromExactKinematics )
{
	double worst = 0;
	for ( int kind = 0; kind < kind_count; ++kind )
	{
		Seen environment, self;
		for ( std::uint64_t seed = 0; seed < 6; ++seed )
		{
			Random random( 100 * seed + static_cast<unsigned>( kind ) );
			Chain chain( random, static_cast<Kind>( kind ) );
			std::vector<double> q = chain.randomState( random );
			const Tip tip( random, chain, q );
			ASSERT_FALSE( HasFailure() );
			for ( bool warm_start : { true, false } )
			{
				QueryPtr query = makeQuery( tip.checker.get(), warm_start );
				for ( int i = 0; i < 3; ++i )
				{
					const Truth truth = truthOf( chain, tip, q );
					double poses = truth.poses;
					lw_state_result result;
					ASSERT_EQ( LW_OK, lw_checker_state( tip.checker.get(), query.get(), q.data(), LW_CHECK_BOTH, nullptr,
					                      false, &result ) );
					SCOPED_TRACE( ::testing::Message()
					              << "kind " << kind << " seed " << seed << " state " << i << " truth "
					              << (double)truth.environment.upper << " own " << (double)truth.self.upper << " got ["
					              << result.environment.lower << ", " << result.environment.upper << "] self ["
					              << result.self.lower << ", " << result.self.upper << "] poses " << poses );
					poses += truth.stretch * std::max( static_cast<double>( truth.environment.upper ),
					                             static_cast<double>( truth.self.upper ) );
					judge( result.environment, truth.environment, poses, truth.promise, environment );
					judge( result.self, truth.self, poses, truth.promise, self );
					expectNotFar( tip.checker.get(), query.get(), q, result, truth );
					q = chain.randomState( random );
				}
			}
		}
		std::printf( "kind %d: worst / promised: environment lower %.4f upper %.4f, self lower %.4f upper %.4f\n", kind,
		    environment.lower, environment.upper, self.lower, self.upper );
		worst = std::max( worst, environment.lower );
	}
	EXPECT_GT( worst, 0.001 ) << "a bound so loose says nothing";
}
