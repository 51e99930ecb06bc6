// SPDX-License-Identifier: BSD-3-Clause
// Robots for tests: a def with owned arrays, random kinematic trees, and forward kinematics in long double written anew.
#pragma once

#include "leeway/robot.h"
#include "seeded_rng.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

using State = std::vector<double>;

struct RobotReleaser
{
	void operator()( lw_robot* robot ) const { lw_robot_release( robot ); }
};
using RobotPtr = std::unique_ptr<lw_robot, RobotReleaser>;

struct ShapeReleaser
{
	void operator()( lw_shape* shape ) const { lw_shape_release( shape ); }
};
using ShapePtr = std::unique_ptr<lw_shape, ShapeReleaser>;

/// A robot def that owns the arrays that it points to.
struct RobotModel
{
	std::vector<std::string> linkNames, jointNames;
	std::vector<lw_joint_def> joints;
	std::vector<lw_body_def> bodies;
	std::vector<lw_link_pair> allowed;
	std::vector<ShapePtr> shapes;
	std::vector<std::vector<lw_vec3>> bodyPoints; ///< points of each body's surface, shape frame
	lw_transform worldFromRoot = lw_transform_identity();

	std::uint32_t link( const std::string& name )
	{
		linkNames.push_back( name );
		return static_cast<std::uint32_t>( linkNames.size() - 1 );
	}

	/// Adds a joint and its child link `name`.
	lw_joint_def& joint( const std::string& name, lw_joint_type type, std::uint32_t parent )
	{
		lw_joint_def j = lw_joint_def_default();
		j.type = type;
		j.parent = parent;
		j.child = link( name );
		j.axis[0] = 0;
		j.axis[2] = 1;
		j.lower = type == LW_JOINT_REVOLUTE ? -3 : -1;
		j.upper = type == LW_JOINT_REVOLUTE ? 3 : 1;
		joints.push_back( j );
		jointNames.push_back( "j_" + name );
		return joints.back();
	}

	/// Takes the shape over.
	void body( std::uint32_t onLink, lw_shape* shape, const lw_transform& linkFromShape, std::vector<lw_vec3> points = {} )
	{
		shapes.emplace_back( shape );
		bodies.push_back( { shape, onLink, linkFromShape } );
		bodyPoints.push_back( std::move( points ) );
	}

	/// Gives the links numbers in another order, so that children may come before their parents.
	void renumberLinks( SeededRng& rng )
	{
		std::vector<std::uint32_t> number( linkNames.size() );
		for ( std::uint32_t i = 0; i < number.size(); ++i )
		{
			number[i] = i;
			std::swap( number[i], number[static_cast<std::size_t>( rng.integer( 0, static_cast<int>( i ) ) )] );
		}
		std::vector<std::string> names( linkNames.size() );
		for ( std::size_t i = 0; i < names.size(); ++i )
		{
			names[number[i]] = linkNames[i];
		}
		linkNames = std::move( names );
		for ( lw_joint_def& joint : joints )
		{
			joint.parent = number[joint.parent];
			joint.child = number[joint.child];
		}
		for ( lw_body_def& body : bodies )
		{
			body.link = number[body.link];
		}
		for ( lw_link_pair& pair : allowed )
		{
			pair = { number[pair.link_a], number[pair.link_b] };
		}
	}

	lw_status create( lw_robot** out, lw_diag* diag = nullptr, const lw_allocator* allocator = nullptr ) const
	{
		std::vector<const char*> names;
		for ( const std::string& name : linkNames )
		{
			names.push_back( name.c_str() );
		}
		std::vector<lw_joint_def> defs = joints;
		for ( std::size_t i = 0; i < defs.size(); ++i )
		{
			defs[i].name = jointNames[i].c_str();
		}
		lw_robot_def def = lw_robot_def_default();
		def.name = "test";
		def.link_names = names.data();
		def.link_count = static_cast<std::uint32_t>( names.size() );
		def.joints = defs.data();
		def.joint_count = static_cast<std::uint32_t>( defs.size() );
		def.bodies = bodies.data();
		def.body_count = static_cast<std::uint32_t>( bodies.size() );
		def.allowed_pairs = allowed.data();
		def.allowed_pair_count = static_cast<std::uint32_t>( allowed.size() );
		def.world_from_root = worldFromRoot;
		return lw_robot_create( &def, allocator, diag, out );
	}

	RobotPtr create() const
	{
		lw_robot* robot = nullptr;
		lw_diag diag = {};
		lw_status status = create( &robot, &diag );
		if ( status != LW_OK )
		{
			std::printf( "%s: %s\n", lw_status_name( status ), diag.message );
		}
		return RobotPtr( robot );
	}
};

inline lw_transform randomTransform( SeededRng& rng, double spread )
{
	double q[4], p[3] = { rng.uniform( -spread, spread ), rng.uniform( -spread, spread ), rng.uniform( -spread, spread ) };
	rng.quaternion( q );
	lw_transform m;
	lw_transform_from_quaternion( p, q, &m );
	return m;
}

/// A soup of triangles within `size` of the origin.
inline lw_shape* randomMesh( SeededRng& rng, int triangles, double size, std::vector<lw_vec3>* points )
{
	std::vector<double> vertices;
	std::vector<std::uint32_t> indices;
	for ( int i = 0; i < triangles; ++i )
	{
		double c[3] = { rng.uniform( -size, size ), rng.uniform( -size, size ), rng.uniform( -size, size ) };
		for ( int v = 0; v < 3; ++v )
		{
			indices.push_back( static_cast<std::uint32_t>( vertices.size() / 3 ) );
			for ( double k : c )
			{
				vertices.push_back( k + rng.uniform( -size, size ) * 0.5 );
			}
			if ( points != nullptr )
			{
				const double* p = &vertices[vertices.size() - 3];
				points->push_back( { p[0], p[1], p[2] } );
			}
		}
	}
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = vertices.data();
	def.vertex_count = static_cast<std::uint32_t>( vertices.size() / 3 );
	def.indices = indices.data();
	def.triangle_count = static_cast<std::uint32_t>( triangles );
	lw_shape* shape = nullptr;
	lw_shape_create_mesh( &def, nullptr, nullptr, &shape );
	return shape;
}

/// A primitive and points of its surface.
inline lw_shape* randomPrimitive( SeededRng& rng, double size, std::vector<lw_vec3>* points )
{
	lw_shape_type type = static_cast<lw_shape_type>( rng.integer( LW_SHAPE_BOX, LW_SHAPE_CONE ) );
	double d[3] = { rng.uniform( 0.2, 1 ) * size, rng.uniform( 0.2, 1 ) * size, rng.uniform( 0.2, 1 ) * size };
	lw_shape* shape = nullptr;
	lw_shape_create_primitive( type, d, nullptr, nullptr, &shape );
	for ( int i = 0; points != nullptr && i < 12; ++i )
	{
		double angle = rng.uniform( -M_PI, M_PI ), z = rng.integer( 0, 1 ) ? 0.5 : -0.5;
		double c = std::cos( angle ), s = std::sin( angle );
		switch ( type )
		{
		case LW_SHAPE_BOX:
			points->push_back( { i & 1 ? d[0] / 2 : -d[0] / 2, i & 2 ? d[1] / 2 : -d[1] / 2, z * d[2] } );
			break;
		case LW_SHAPE_SPHERE:
			points->push_back( { c * d[0], s * d[0], 0 } );
			break;
		case LW_SHAPE_CAPSULE:
			points->push_back( { i < 6 ? c * d[0] : 0, i < 6 ? s * d[0] : 0, z * d[1] + ( i < 6 ? 0 : 2 * z * d[0] ) } );
			break;
		case LW_SHAPE_CONE:
			points->push_back( i < 9 ? lw_vec3{ c * d[0], s * d[0], -0.5 * d[1] } : lw_vec3{ 0, 0, 0.5 * d[1] } );
			break;
		default:
			points->push_back( { c * d[0], s * d[0], z * d[1] } );
			break;
		}
	}
	return shape;
}

struct RandomRobotOptions
{
	int joints = 8;
	bool floating = true; ///< planar and floating joints too
	double meshShare = 0.5;
	int triangles = 6;
	double size = 0.15;   ///< of shapes
	double offset = 0.3;  ///< of joint origins
	double bareShare = 0; ///< of links without geometry, such as flanges
};

/// A random tree of joints of every type, with mimic joints and exact as well as skew axes.
inline RobotModel randomRobot( SeededRng& rng, const RandomRobotOptions& o )
{
	RobotModel model;
	model.worldFromRoot = randomTransform( rng, 1 );
	model.link( "root" );
	for ( int i = 0; i < o.joints; ++i )
	{
		static const lw_joint_type types[] = { LW_JOINT_FIXED, LW_JOINT_REVOLUTE, LW_JOINT_REVOLUTE, LW_JOINT_REVOLUTE,
		    LW_JOINT_CONTINUOUS, LW_JOINT_PRISMATIC, LW_JOINT_PLANAR, LW_JOINT_FLOATING };
		lw_joint_type type = types[rng.integer( 0, o.floating ? 7 : 5 )];
		// mostly chains, sometimes branches
		int last = static_cast<int>( model.linkNames.size() ) - 1;
		std::uint32_t parent = static_cast<std::uint32_t>( rng.integer( 0, 3 ) > 0 ? last : rng.integer( 0, last ) );
		lw_joint_def& j = model.joint( "l" + std::to_string( i ), type, parent );
		j.parent_from_joint = randomTransform( rng, o.offset );
		if ( rng.integer( 0, 2 ) == 0 )
		{
			j.parent_from_joint = lw_transform_identity();
			j.parent_from_joint.t[rng.integer( 0, 2 )] = rng.uniform( -o.offset, o.offset );
		}
		for ( double& a : j.axis )
		{
			a = rng.uniform( -1, 1 );
		}
		if ( rng.integer( 0, 1 ) )
		{
			j.axis[0] = j.axis[1] = j.axis[2] = 0;
			j.axis[rng.integer( 0, 2 )] = rng.integer( 0, 1 ) ? 1 : -1;
		}
		j.lower = rng.uniform( -2, 0.2 ) * ( type == LW_JOINT_PRISMATIC ? 0.3 : 1.0 );
		j.upper = j.lower + rng.uniform( 0, 3 ) * ( type == LW_JOINT_PRISMATIC ? 0.3 : 1.0 );
		for ( int k = 0; k < 3; ++k )
		{
			j.position_lower[k] = rng.integer( 0, 1 ) ? -INFINITY : -0.3;
			j.position_upper[k] = rng.integer( 0, 1 ) ? INFINITY : 0.4;
		}
		bool follows = i > 0 && ( type == LW_JOINT_REVOLUTE || type == LW_JOINT_CONTINUOUS || type == LW_JOINT_PRISMATIC ) &&
		               rng.integer( 0, 3 ) == 0;
		std::uint32_t leader = static_cast<std::uint32_t>( rng.integer( 0, i > 0 ? i - 1 : 0 ) );
		if ( follows && model.joints[leader].type != LW_JOINT_PLANAR && model.joints[leader].type != LW_JOINT_FLOATING )
		{
			j.mimic = leader;
			j.mimic_multiplier = rng.integer( 0, 2 ) ? rng.uniform( -1.5, 1.5 ) : rng.integer( -2, 2 );
			j.mimic_offset = rng.uniform( -0.5, 0.5 );
		}
	}
	for ( std::uint32_t link = 0; link < model.linkNames.size(); ++link )
	{
		std::vector<lw_vec3> points;
		if ( o.bareShare > 0 && rng.uniform( 0, 1 ) < o.bareShare )
		{
			continue;
		}
		lw_shape* shape = rng.uniform( 0, 1 ) < o.meshShare ? randomMesh( rng, o.triangles, o.size, &points )
		                                                    : randomPrimitive( rng, o.size, &points );
		model.body( link, shape, randomTransform( rng, o.size ), points );
	}
	return model;
}

/// A joint that turns, below it two to four that shift along much the same line by up to 1 m, at the tip a ball.
inline RobotModel telescope( SeededRng& rng )
{
	RobotModel model;
	model.worldFromRoot = randomTransform( rng, 1 );
	model.link( "root" );
	model.joint( "turn", LW_JOINT_REVOLUTE, 0 );
	const int stages = rng.integer( 2, 4 );
	for ( int i = 0; i < stages; ++i )
	{
		const lw_joint_type type = i == 0 && rng.integer( 0, 2 ) == 0 ? LW_JOINT_PLANAR : LW_JOINT_PRISMATIC;
		lw_joint_def& j =
		    model.joint( "stage" + std::to_string( i ), type, static_cast<std::uint32_t>( model.linkNames.size() - 1 ) );
		if ( type == LW_JOINT_PRISMATIC )
		{
			j.axis[0] = 1;
			j.axis[1] = rng.uniform( -0.1, 0.1 );
			j.axis[2] = 0;
		}
		for ( int k = 0; k < 3; ++k )
		{
			j.position_lower[k] = -1;
			j.position_upper[k] = 1;
		}
	}
	const double radius = rng.uniform( 0.01, 0.1 );
	lw_shape* ball = nullptr;
	lw_shape_create_primitive( LW_SHAPE_SPHERE, &radius, nullptr, nullptr, &ball );
	std::vector<lw_vec3> points;
	for ( int i = 0; i < 100; ++i )
	{
		points.push_back( { radius * std::cos( 2 * M_PI * i / 100 ), radius * std::sin( 2 * M_PI * i / 100 ), 0 } );
	}
	model.body( static_cast<std::uint32_t>( model.linkNames.size() - 1 ), ball, lw_transform_identity(), points );
	return model;
}

/// A random state; `excess` > 0 leaves the limits by as much.
inline State randomState( SeededRng& rng, const lw_robot* robot, double excess = 0 )
{
	State q( lw_robot_variable_count( robot ) );
	for ( std::uint32_t i = 0; i < q.size(); ++i )
	{
		lw_variable_info info = lw_robot_variable( robot, i );
		double low = std::isfinite( info.lower ) ? info.lower : -0.5;
		double high = std::isfinite( info.upper ) ? info.upper : 0.5;
		q[i] = rng.uniform( low - excess, high + excess );
	}
	return q;
}

// ---- oracle: 4 x 4 matrices in long double ---------------------------------------------------------------------------

using Matrix = std::array<std::array<long double, 4>, 4>;

inline Matrix identityMatrix()
{
	Matrix m = {};
	for ( int i = 0; i < 4; ++i )
	{
		m[i][i] = 1;
	}
	return m;
}

inline Matrix product( const Matrix& a, const Matrix& b )
{
	Matrix m = {};
	for ( int i = 0; i < 4; ++i )
	{
		for ( int j = 0; j < 4; ++j )
		{
			for ( int k = 0; k < 4; ++k )
			{
				m[i][j] += a[i][k] * b[k][j];
			}
		}
	}
	return m;
}

inline Matrix matrixOf( const lw_transform& t )
{
	Matrix m = identityMatrix();
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			m[i][j] = t.r[i][j];
		}
		m[i][3] = t.t[i];
	}
	return m;
}

/// 1 + sin K + (1 - cos) K^2, K the cross product matrix of the unit axis.
inline Matrix rodrigues( std::array<long double, 3> a, long double s, long double c )
{
	long double length = std::sqrt( a[0] * a[0] + a[1] * a[1] + a[2] * a[2] );
	if ( !( length > 0 ) )
	{
		return identityMatrix();
	}
	Matrix k = {};
	k[0][1] = -a[2] / length;
	k[0][2] = a[1] / length;
	k[1][0] = a[2] / length;
	k[1][2] = -a[0] / length;
	k[2][0] = -a[1] / length;
	k[2][1] = a[0] / length;
	Matrix square = product( k, k ), m = identityMatrix();
	for ( int i = 0; i < 3; ++i )
	{
		for ( int j = 0; j < 3; ++j )
		{
			m[i][j] += s * k[i][j] + ( 1 - c ) * square[i][j];
		}
	}
	return m;
}

inline long double oracleValue( const RobotModel& model, const lw_robot* robot, std::uint32_t joint, const State& q )
{
	const lw_joint_def& j = model.joints[joint];
	if ( j.type == LW_JOINT_FIXED )
	{
		return 0;
	}
	if ( j.mimic != LW_INVALID_INDEX )
	{
		return static_cast<long double>( j.mimic_multiplier ) * oracleValue( model, robot, j.mimic, q ) + j.mimic_offset;
	}
	return q[lw_robot_joint_variable( robot, joint )];
}

inline Matrix oracleMotion( const RobotModel& model, const lw_robot* robot, std::uint32_t joint, const State& q )
{
	const lw_joint_def& j = model.joints[joint];
	Matrix m = identityMatrix();
	long double length =
	    std::sqrt( static_cast<long double>( j.axis[0] ) * j.axis[0] + static_cast<long double>( j.axis[1] ) * j.axis[1] +
	               static_cast<long double>( j.axis[2] ) * j.axis[2] );
	std::array<long double, 3> axis = { j.axis[0] / length, j.axis[1] / length, j.axis[2] / length };
	if ( j.type == LW_JOINT_REVOLUTE || j.type == LW_JOINT_CONTINUOUS )
	{
		long double angle = oracleValue( model, robot, joint, q );
		return rodrigues( axis, std::sin( angle ), std::cos( angle ) );
	}
	if ( j.type == LW_JOINT_PRISMATIC )
	{
		for ( int i = 0; i < 3; ++i )
		{
			m[i][3] = axis[i] * oracleValue( model, robot, joint, q );
		}
	}
	if ( j.type == LW_JOINT_PLANAR )
	{
		const double* v = &q[lw_robot_joint_variable( robot, joint )];
		// the shortest rotation that takes z (or -z, whichever is nearer) to the axis carries the plane's directions
		long double sign = j.axis[2] < 0 ? -1 : 1;
		Matrix tilt = rodrigues( { -sign * axis[1], sign * axis[0], 0 }, std::hypot( axis[0], axis[1] ), sign * axis[2] );
		Matrix in = identityMatrix();
		in[0][3] = v[0];
		in[1][3] = sign * v[1];
		Matrix moved = product( tilt, in );
		Matrix turn =
		    rodrigues( axis, std::sin( static_cast<long double>( v[2] ) ), std::cos( static_cast<long double>( v[2] ) ) );
		for ( int i = 0; i < 3; ++i )
		{
			turn[i][3] = moved[i][3];
		}
		return turn;
	}
	if ( j.type == LW_JOINT_FLOATING )
	{
		const double* v = &q[lw_robot_joint_variable( robot, joint )];
		long double sine = std::sqrt( static_cast<long double>( v[3] ) * v[3] + static_cast<long double>( v[4] ) * v[4] +
		                              static_cast<long double>( v[5] ) * v[5] );
		long double angle = 2 * std::atan2( sine, static_cast<long double>( v[6] ) );
		m = rodrigues( { v[3], v[4], v[5] }, std::sin( angle ), std::cos( angle ) );
		for ( int i = 0; i < 3; ++i )
		{
			m[i][3] = v[i];
		}
	}
	return m;
}

inline Matrix oraclePose( const RobotModel& model, const lw_robot* robot, std::uint32_t link, const State& q )
{
	for ( std::uint32_t i = 0; i < model.joints.size(); ++i )
	{
		if ( model.joints[i].child == link )
		{
			Matrix m = product( matrixOf( model.joints[i].parent_from_joint ), oracleMotion( model, robot, i, q ) );
			return product( oraclePose( model, robot, model.joints[i].parent, q ), m );
		}
	}
	return matrixOf( model.worldFromRoot );
}
