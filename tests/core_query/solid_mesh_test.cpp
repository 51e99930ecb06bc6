// SPDX-License-Identifier: BSD-3-Clause
// Meshes declared solid: when one is closed, when a point is inside. The oracle: winding numbers by solid angles in long
// double (van Oosterom, Strackee 1983), which knows nothing of rays, and brute-force distances of the surfaces.
#include "one_joint.hpp"
#include "oracle_subject.hpp"

#include <array>
#include <cstring>
#include <limits>

using namespace oracle;

// The internal interface, declared here because its headers are C only.
extern "C" bool lwi_mesh_contains( const lw_shape* shape, lw_vec3 point );

namespace
{
const double inf = std::numeric_limits<double>::infinity();
const double pi = 3.14159265358979323846;

/// A triangle mesh made of closed surfaces.
struct Solid
{
	std::vector<Vec> vertices;
	std::vector<uint32_t> indices;
	std::vector<std::size_t> ends; ///< of the surfaces, in triangles

	std::size_t count() const { return indices.size() / 3; }
	Vec corner( std::size_t triangle, int k ) const
	{
		return vertices[indices[3 * triangle + static_cast<std::size_t>( k )]];
	}
};

void add_face( Solid& s, std::size_t a, std::size_t b, std::size_t c )
{
	s.indices.insert( s.indices.end(), { (uint32_t)a, (uint32_t)b, (uint32_t)c } );
}

/// A grid that closes in both directions: a torus, or a sphere with poles of many equal vertices (degenerate triangles).
void add_grid( Solid& s, std::size_t n, std::size_t m, bool torus, real radius, Vec center, lw_transform turn )
{
	std::size_t first = s.vertices.size();
	for ( std::size_t i = 0; i < n; ++i )
	{
		for ( std::size_t j = 0; j < m; ++j )
		{
			real u = 2 * pi * (real)i / (real)n, v = torus ? 2 * pi * (real)j / (real)m : pi * (real)j / (real)( m - 1 );
			real ring = torus ? 1 + 0.4L * std::cos( v ) : std::sin( v ), z = torus ? 0.4L * std::sin( v ) : std::cos( v );
			if ( !torus && ( j == 0 || j + 1 == m ) )
			{
				ring = 0;
			}
			Vec p = { ring * std::cos( u ), ring * std::sin( u ), z };
			s.vertices.push_back( center + radius * rotate( turn, p ) );
		}
	}
	for ( std::size_t i = 0; i < n; ++i )
	{
		for ( std::size_t j = 0; j + ( torus ? 0 : 1 ) < m; ++j )
		{
			std::size_t a = first + i * m + j, b = first + ( i + 1 ) % n * m + j;
			std::size_t c = first + ( i + 1 ) % n * m + ( j + 1 ) % m, d = first + i * m + ( j + 1 ) % m;
			add_face( s, a, b, c );
			add_face( s, a, c, d );
		}
	}
	s.ends.push_back( s.count() );
}

/// A box with every face cut into n x n squares: many vertices at equal coordinates.
void add_box( Solid& s, std::size_t n, Vec half, Vec center, lw_transform turn )
{
	for ( int axis = 0; axis < 3; ++axis )
	{
		for ( int side = -1; side <= 1; side += 2 )
		{
			std::size_t first = s.vertices.size();
			for ( std::size_t i = 0; i <= n; ++i )
			{
				for ( std::size_t j = 0; j <= n; ++j )
				{
					real x[3], h[3] = { half.x, half.y, half.z };
					x[axis] = side * h[axis];
					x[( axis + 1 ) % 3] = h[( axis + 1 ) % 3] * ( 2 * (real)i / (real)n - 1 );
					x[( axis + 2 ) % 3] = h[( axis + 2 ) % 3] * ( 2 * (real)j / (real)n - 1 );
					s.vertices.push_back( center + rotate( turn, { x[0], x[1], x[2] } ) );
				}
			}
			for ( std::size_t i = 0; i < n; ++i )
			{
				for ( std::size_t j = 0; j < n; ++j )
				{
					std::size_t a = first + i * ( n + 1 ) + j, b = a + n + 1;
					add_face( s, a, side > 0 ? b : a + 1, b + 1 );
					add_face( s, a, b + 1, side > 0 ? a + 1 : b );
				}
			}
		}
	}
	s.ends.push_back( s.count() );
}

lw_transform random_turn( SeededRng& rng )
{
	return rng.integer( 0, 1 ) == 0 ? lw_transform_identity() : random_rotation( rng );
}

/// One to three closed surfaces that may cross or contain each other. @param shuffled triangles turned at random
/// @param most cuts around a surface
Solid random_solid( SeededRng& rng, double size, bool shuffled, int most = 14 )
{
	Solid s;
	int surfaces = rng.integer( 1, 3 );
	for ( int i = 0; i < surfaces; ++i )
	{
		Vec center = (real)( i * rng.uniform( 0, 1.2 ) * size ) * from( random_direction( rng ) );
		auto n = static_cast<std::size_t>( rng.integer( 3, most ) ), m = static_cast<std::size_t>( rng.integer( 3, most ) );
		switch ( rng.integer( 0, 2 ) )
		{
		case 0:
			add_grid( s, n, m, true, 0.7L * size, center, random_turn( rng ) );
			break;
		case 1:
			add_grid( s, n, m, false, size * rng.uniform( 0.2, 1 ), center, random_turn( rng ) );
			break;
		default:
			add_box( s, n / 3, { size * rng.uniform( 0.1, 1 ), size * rng.uniform( 0.1, 1 ), size * rng.uniform( 0.1, 1 ) },
			    center, random_turn( rng ) );
		}
	}
	for ( std::size_t t = 0; t < s.count() && shuffled; ++t )
	{
		if ( rng.integer( 0, 1 ) == 0 )
		{
			std::swap( s.indices[3 * t + 1], s.indices[3 * t + 2] );
		}
	}
	return s;
}

lw_status make_solid( Solid& s, double weld, lw_diag* diag, ShapePtr& out, bool solid = true )
{
	std::vector<double> numbers = rounded( s.vertices );
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = numbers.data();
	def.vertex_count = static_cast<uint32_t>( s.vertices.size() );
	def.indices = s.indices.data();
	def.triangle_count = static_cast<uint32_t>( s.count() );
	def.weld_tolerance = weld;
	def.solid = solid;
	lw_shape* shape = nullptr;
	lw_status status = lw_shape_create_mesh( &def, nullptr, diag, &shape );
	out.reset( shape );
	return status;
}

/// Solid angle of a triangle seen from p, over 4 pi.
real solid_angle( const Solid& s, std::size_t triangle, Vec p )
{
	Vec a = s.corner( triangle, 0 ) - p, b = s.corner( triangle, 1 ) - p, c = s.corner( triangle, 2 ) - p;
	real la = length( a ), lb = length( b ), lc = length( c );
	real det = dot( a, cross( b, c ) );
	real sum = la * lb * lc + dot( a, b ) * lc + dot( b, c ) * la + dot( c, a ) * lb;
	return std::atan2( det, sum ) / ( 2 * (real)pi );
}

/// True if p is in some surface; `s` must not be shuffled.
bool is_inside( const Solid& s, Vec p )
{
	std::size_t t = 0;
	for ( std::size_t end : s.ends )
	{
		real winding = 0;
		for ( ; t < end; ++t )
		{
			winding += solid_angle( s, t, p );
		}
		if ( std::fabs( winding ) > 0.5L )
		{
			return true;
		}
	}
	return false;
}

/// The surfaces as the brute-force oracle knows them.
Subject surface_of( const Solid& s )
{
	Subject out;
	out.model.corners = 3;
	for ( uint32_t i : s.indices )
	{
		out.model.points.push_back( s.vertices[i] );
		out.model.size = std::max( out.model.size, length( s.vertices[i] ) );
	}
	return out;
}

/// A point of every piece of a subject.
std::vector<Vec> points_of( const Subject& s )
{
	std::vector<Vec> out;
	for ( const Part& part : parts_of( s ) )
	{
		for ( std::size_t i = 0; i < part.model.points.size(); i += static_cast<std::size_t>( part.model.corners ) )
		{
			out.push_back( part.center + part.model.points[i] );
		}
		if ( part.model.corners == 0 )
		{
			out.push_back( part.center );
		}
	}
	return out;
}

/// A point whose coordinates are often exactly those of vertices, or of points of edges.
Vec awkward_point( SeededRng& rng, const Solid& s, double size )
{
	Vec p = random_point( rng, 1.5 * size );
	auto vertex = [&] { return s.vertices[static_cast<std::size_t>( rng.integer( 0, (int)s.vertices.size() - 1 ) )]; };
	if ( rng.integer( 0, 1 ) == 0 )
	{
		p.x = vertex().x;
	}
	if ( rng.integer( 0, 1 ) == 0 )
	{
		p.y = vertex().y;
	}
	if ( rng.integer( 0, 1 ) == 0 )
	{
		p.z = vertex().z;
	}
	return from( to_double( p ) );
}
} // namespace

TEST( SolidMesh, InsideContradictsTheWindingNumber )
{
	SeededRng rng;
	QueryPtr query = makeQuery();
	int inside = 0, outside = 0, ties = 0;
	for ( int round = 0; round < 300; ++round )
	{
		double size = rng.decade( -3, 2 );
		bool shuffled = round % 2 == 0;
		SeededRng again = rng;
		Solid straight = random_solid( again, size, false ), s = random_solid( rng, size, shuffled );
		ASSERT_EQ( straight.vertices.size(), s.vertices.size() );
		lw_diag diag = {};
		ShapePtr shape;
		ASSERT_EQ( LW_OK, make_solid( s, 1e-12 * size, &diag, shape ) ) << diag.message;
		rounded( straight.vertices );
		ASSERT_TRUE( lw_shape_get_info( shape.get() ).solid );
		for ( int i = 0; i < 60; ++i )
		{
			Vec p = awkward_point( rng, s, size );
			lw_vec3 q = to_double( p );
			double point[3] = { q.x, q.y, q.z };
			lw_shape* raw = nullptr;
			ASSERT_EQ( LW_OK, lw_shape_create_points( point, 1, 0, nullptr, nullptr, nullptr, &raw ) );
			ShapePtr probe( raw );
			lw_transform id = lw_transform_identity();
			lw_clearance c;
			bool first = rng.integer( 0, 1 ) == 0;
			ASSERT_EQ( LW_OK, lw_shape_distance( first ? probe.get() : shape.get(), &id, first ? shape.get() : probe.get(),
			                      &id, nullptr, query.get(), &c ) );
			real surface = INFINITY;
			for ( std::size_t t = 0; t < s.count(); ++t )
			{
				Vec v[3] = { s.corner( t, 0 ), s.corner( t, 1 ), s.corner( t, 2 ) };
				surface = std::min( surface, length( p - foot_on_triangle( v, p ) ) );
			}
			if ( surface < 1e-12L * size )
			{
				++ties;
				ASSERT_LE( c.upper, 1e-11 * size );
				continue;
			}
			bool truth = is_inside( straight, p );
			( truth ? inside : outside ) += 1;
			ASSERT_EQ( truth, c.upper == 0 ) << "round " << round << ", " << surface / size << " sizes from the surface";
			if ( !truth )
			{
				ASSERT_NEAR( to_double( surface ), c.upper, 1e-12 * size );
			}
		}
	}
	std::printf( "%d inside, %d outside, %d on the surface\n", inside, outside, ties );
	EXPECT_GE( inside, 2000 );
	EXPECT_GE( outside, 2000 );
}

/// A box of whole numbers, and points in the planes of its faces and edges: where rays meet corners and edges of triangles.
TEST( SolidMesh, PointsInLineWithCornersAreOnTheWrongSide )
{
	SeededRng rng;
	Solid box;
	for ( std::size_t i = 0; i < 8; ++i )
	{
		box.vertices.push_back( { i & 1 ? 5.0L : -3.0L, i & 2 ? 2.0L : -7.0L, i & 4 ? 4.0L : 1.0L } );
	}
	static const std::size_t quads[6][4] = {
	    { 0, 2, 3, 1 }, { 4, 5, 7, 6 }, { 0, 1, 5, 4 }, { 2, 6, 7, 3 }, { 0, 4, 6, 2 }, { 1, 3, 7, 5 } };
	for ( const auto& q : quads )
	{
		add_face( box, q[0], q[1], q[2] );
		add_face( box, q[0], q[2], q[3] );
	}
	ShapePtr shape;
	lw_diag diag = {};
	ASSERT_EQ( LW_OK, make_solid( box, 0, &diag, shape ) ) << diag.message;
	const lw_vec3 low = { -3, -7, 1 }, high = { 5, 2, 4 };
	int inside = 0, in_line = 0;
	for ( int i = 0; i < 20000; ++i )
	{
		const lw_vec3 p = { rng.integer( -8, 12 ) / 2.0, rng.integer( -16, 6 ) / 2.0, rng.integer( 0, 10 ) / 2.0 };
		const bool within = p.x > low.x && p.x < high.x && p.y > low.y && p.y < high.y && p.z > low.z && p.z < high.z;
		const bool near = p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y && p.z >= low.z && p.z <= high.z;
		if ( within || !near ) // on the surface either will do
		{
			ASSERT_EQ( lwi_mesh_contains( shape.get(), p ), within ) << p.x << ' ' << p.y << ' ' << p.z;
			inside += within;
			in_line += !within &&
			           ( p.x == low.x || p.x == high.x || p.y == low.y || p.y == high.y || p.z == low.z || p.z == high.z );
		}
	}
	EXPECT_GE( std::min( inside, in_line ), 1000 );
}

class SolidMeshPairs : public ::testing::TestWithParam<int>
{
};

/// A solid mesh and another subject, which is a solid (`second`) too if there is one; their poses.
struct SolidPair
{
	Solid solid, second;
	Subject surface, other;
	ShapePtr shape;
	lw_transform pose_a, pose_b;

	/// @param kind index of the other's type; -1: another solid, which may be inside or around
	SolidPair( SeededRng& rng, int kind, double size, bool costly );

	bool is_inside_the_solid() const;  ///< some point of the other
	bool is_inside_the_second() const; ///< some corner of the solid
	real scale() const
	{
		return length( offset( pose_a ) - offset( pose_b ) ) + 2 * ( surface.model.size + other.model.size );
	}
};

SolidPair::SolidPair( SeededRng& rng, int kind, double size, bool costly )
{
	solid = random_solid( rng, size, false, costly ? 5 : 14 );
	lw_diag diag = {};
	EXPECT_EQ( LW_OK, make_solid( solid, 1e-12 * size, &diag, shape ) ) << diag.message;
	surface = surface_of( solid );
	double other_size = size * rng.decade( kind < 0 ? -1.5 : -2, kind < 0 ? 1.5 : 0 );
	if ( kind < 0 )
	{
		second = random_solid( rng, other_size, false, 5 );
		EXPECT_EQ( LW_OK, make_solid( second, 1e-12 * other_size, &diag, other.shape ) ) << diag.message;
		other.model = surface_of( second ).model;
	}
	else
	{
		other = make_subject( rng, types[kind], other_size );
	}
	pose_a = random_pose( rng, rng.uniform( 0, 3 ) * size );
	pose_b = random_pose( rng, 0 );
	const double reach = kind < 0 ? 0.3 * std::max( size, other_size ) : 0.7 * size;
	lw_vec3 goal = to_double( offset( pose_a ) + rotate( pose_a, random_point( rng, reach ) ) );
	pose_b.t[0] = goal.x;
	pose_b.t[1] = goal.y;
	pose_b.t[2] = goal.z;
}

bool SolidPair::is_inside_the_solid() const
{
	bool inside = false;
	for ( Vec p : points_of( other ) )
	{
		inside = inside || is_inside( solid, unrotate( pose_a, rotate( pose_b, p ) + offset( pose_b ) - offset( pose_a ) ) );
	}
	return inside;
}

bool SolidPair::is_inside_the_second() const
{
	bool inside = false;
	for ( std::size_t t = 0; t < solid.count() && second.count() > 0; ++t )
	{
		Vec world = rotate( pose_a, solid.corner( t, 0 ) ) + offset( pose_a );
		inside = inside || is_inside( second, unrotate( pose_b, world - offset( pose_b ) ) );
	}
	return inside;
}

TEST_P( SolidMeshPairs, DistanceContradictsBruteForce )
{
	SeededRng rng( 20260501u + (unsigned)GetParam() );
	QueryPtr query = makeQuery();
	int within = 0, swallowed = 0, crossing = 0, apart = 0;
	// edges against meshes and boxes cost the oracle most
	const bool costly = GetParam() <= 0 || types[std::max( 0, GetParam() )] == LW_SHAPE_BOXES;
	const int rounds = GetParam() < 0 ? 80 : costly ? 60 : 300;
	// how often solids lie within each other depends on the seed: as long as it takes, within reason
	const auto is_enough = [&] { return within >= 5 && crossing + apart >= 10 && swallowed >= ( GetParam() < 0 ? 5 : 0 ); };
	for ( int round = 0; round < rounds || ( round < 10 * rounds && !is_enough() ); ++round )
	{
		double size = rng.decade( -2, 2 );
		const SolidPair pair( rng, GetParam(), size, costly );
		ASSERT_FALSE( HasFailure() );
		const real scale = pair.scale();
		Interval truth = truth_of( pair.surface, pair.pose_a, pair.other, pair.pose_b, scale );
		const bool inside = pair.is_inside_the_solid(), around = pair.is_inside_the_second();
		bool separate = truth.lower > 1e-9L * scale;
		if ( !separate && truth.upper > 0 )
		{
			continue; // the oracle's angles are too near to the surface
		}
		within += separate && inside;
		swallowed += separate && around;
		crossing += !separate;
		apart += separate && !inside && !around;
		if ( inside || around )
		{
			truth = { 0, 0 };
		}
		lw_clearance c;
		bool first = rng.integer( 0, 1 ) == 0;
		const lw_shape *mine = pair.shape.get(), *other = pair.other.shape.get();
		lw_range range = lw_range_exact();
		range.max_d = rng.integer( 0, 2 ) == 0 ? to_double( scale ) * rng.decade( -4, 0 ) : inf;
		ASSERT_EQ( LW_OK, lw_shape_distance( first ? mine : other, first ? &pair.pose_a : &pair.pose_b, first ? other : mine,
		                      first ? &pair.pose_b : &pair.pose_a, &range, query.get(), &c ) );
		::testing::Message story;
		story << "round " << round << " scale " << scale << " oracle " << truth.lower << " " << truth.upper << " got "
		      << c.lower << " " << c.upper << " inside " << inside << " around " << around;
		SCOPED_TRACE( story );
		ASSERT_LE( c.lower, truth.upper + 1e-15L * scale );
		if ( c.kind == LW_CLEARANCE_FAR )
		{
			ASSERT_GE( truth.upper, range.max_d - 1e-13L * scale );
			continue;
		}
		ASSERT_GE( c.upper, truth.lower - 1e-13L * scale );
		ASSERT_LE( c.upper, truth.upper + 1e-10L * scale );
		if ( inside || around )
		{
			ASSERT_EQ( LW_CLEARANCE_VIOLATION, c.kind );
		}
	}
	std::printf( "%d within, %d swallowed, %d crossing, %d apart\n", within, swallowed, crossing, apart );
	EXPECT_TRUE( is_enough() );
}

INSTANTIATE_TEST_SUITE_P( types, SolidMeshPairs, ::testing::Range( -1, type_count ),
    []( const auto& one ) { return std::string( one.param < 0 ? "solid" : type_names[one.param] ); } );

TEST( SolidMesh, OpenMeshIsTakenForClosed )
{
	SeededRng rng;
	for ( int round = 0; round < 50; ++round )
	{
		Solid s = random_solid( rng, 1, false );
		auto gone = static_cast<std::size_t>( rng.integer( 0, (int)s.count() - 1 ) );
		Vec a = s.corner( gone, 0 ), b = s.corner( gone, 1 ), c = s.corner( gone, 2 );
		if ( length( cross( b - a, c - a ) ) < 1e-9L )
		{
			continue; // a pole's: nobody misses it
		}
		s.indices.erase(
		    s.indices.begin() + ( std::ptrdiff_t )( 3 * gone ), s.indices.begin() + ( std::ptrdiff_t )( 3 * gone + 3 ) );
		lw_diag diag = {};
		ShapePtr shape;
		EXPECT_EQ( LW_ERROR_BAD_GEOMETRY, make_solid( s, 1e-12, &diag, shape ) );
		EXPECT_NE( nullptr, std::strstr( diag.message, "edge of triangle" ) ) << diag.message;
		EXPECT_LT( diag.index, s.count() );
		EXPECT_EQ( nullptr, shape.get() );
		EXPECT_EQ( LW_OK, make_solid( s, 1e-12, &diag, shape, false ) ) << "a surface may be open";
	}
}

TEST( SolidMesh, UnweldedSeamsNeedATolerance )
{
	Solid s;
	add_box( s, 2, { 1, 1, 1 }, { 0, 0, 0 }, lw_transform_identity() );
	for ( std::size_t i = 0; i < 9; ++i )
	{
		s.vertices[i].x += 1e-7L; // one face of six, moved
	}
	lw_diag diag = {};
	ShapePtr shape;
	EXPECT_EQ( LW_ERROR_BAD_GEOMETRY, make_solid( s, 0, &diag, shape ) );
	EXPECT_NE( nullptr, std::strstr( diag.message, "weld_tolerance" ) ) << diag.message;
	EXPECT_EQ( LW_OK, make_solid( s, 1e-6, &diag, shape ) ) << diag.message;
}

TEST( SolidMesh, SolidsThatShareAnEdgeOrCornerStayApart )
{
	// two cubes that touch along an edge: four triangles there. Both are solid, the space between them is not
	Solid s;
	add_box( s, 1, { 1, 1, 1 }, { 0, 0, 0 }, lw_transform_identity() );
	add_box( s, 1, { 1, 1, 1 }, { 2, 2, 0 }, lw_transform_identity() );
	lw_diag diag = {};
	ShapePtr shape, ball = makePrimitive( LW_SHAPE_SPHERE, 0.01 );
	ASSERT_EQ( LW_OK, make_solid( s, 0, &diag, shape ) ) << diag.message;
	QueryPtr query = makeQuery();
	lw_transform id = lw_transform_identity();
	auto touches = [&]( double x, double y )
	{
		lw_transform pose = at( x, y, 0.3 );
		lw_clearance c;
		EXPECT_EQ( LW_OK, lw_shape_distance( shape.get(), &id, ball.get(), &pose, nullptr, query.get(), &c ) );
		return c.kind == LW_CLEARANCE_VIOLATION;
	};
	EXPECT_TRUE( touches( 0, 0 ) );
	EXPECT_TRUE( touches( 2, 2 ) );
	EXPECT_FALSE( touches( 1.5, 0.5 ) );
	EXPECT_FALSE( touches( 0.5, 1.5 ) );
}

// Boxes side by side, each with walls of its own: edges of four triangles around each wall, at which the components of two
// boxes meet with one triangle each and would be left open.
TEST( SolidMesh, BoxesThatShareAWallLeaveNoGapAndReachNoFurther )
{
	SeededRng rng;
	int inside = 0, outside = 0;
	for ( int round = 0; round < 60; ++round )
	{
		// columns around a shaft, so high that the nearest side of the box around all lies beyond some of them
		std::vector<Vec> centers;
		Solid s;
		for ( int cell = 0; cell < 25; ++cell )
		{
			if ( cell != 12 && rng.integer( 0, 4 ) > 0 )
			{
				centers.push_back( { 2 * (real)( cell / 5 ), 2 * (real)( cell % 5 ), 0 } );
				add_box( s, 1, { 1, 1, 20 }, centers.back(), lw_transform_identity() );
			}
		}
		for ( std::size_t t = 0; round % 2 == 0 && t < s.count(); ++t ) // facing anywhere, as many exporters leave them
		{
			if ( rng.integer( 0, 1 ) )
			{
				std::swap( s.indices[3 * t + 1], s.indices[3 * t + 2] );
			}
		}
		lw_diag diag = {};
		ShapePtr shape;
		ASSERT_EQ( LW_OK, make_solid( s, 0, &diag, shape ) ) << diag.message;
		for ( int i = 0; i < 200; ++i )
		{
			const Vec p = { rng.uniform( -1, 9 ), rng.uniform( -1, 9 ), rng.uniform( -1, 1 ) };
			bool truth = false;
			for ( const Vec& c : centers )
			{
				truth = truth || std::max( std::fabs( p.x - c.x ), std::fabs( p.y - c.y ) ) < 1;
			}
			( truth ? inside : outside ) += 1;
			ASSERT_EQ( lwi_mesh_contains( shape.get(), to_double( p ) ), truth )
			    << "round " << round << ", " << to_double( p ).x << ' ' << to_double( p ).y << ' ' << to_double( p ).z;
		}
	}
	EXPECT_GE( inside, 1000 );
	EXPECT_GE( outside, 1000 );
}

TEST( SolidMesh, AVoidCountsAsInside )
{
	Solid s;
	add_box( s, 1, { 1, 1, 1 }, { 0, 0, 0 }, lw_transform_identity() );
	add_box( s, 1, { 0.9L, 0.9L, 0.9L }, { 0, 0, 0 }, lw_transform_identity() );
	for ( std::size_t t = s.ends[0]; t < s.ends[1]; ++t )
	{
		std::swap( s.indices[3 * t + 1], s.indices[3 * t + 2] ); // facing inwards, as exporters write voids
	}
	lw_diag diag = {};
	ShapePtr shape, ball = makePrimitive( LW_SHAPE_SPHERE, 0.01 );
	ASSERT_EQ( LW_OK, make_solid( s, 0, &diag, shape ) ) << diag.message;
	lw_transform id = lw_transform_identity();
	lw_clearance c;
	ASSERT_EQ( LW_OK, lw_shape_distance( shape.get(), &id, ball.get(), &id, nullptr, makeQuery().get(), &c ) );
	EXPECT_EQ( 0, c.upper );
}

TEST( SolidMesh, TilesAreRefusedAndAllocationsMayFail )
{
	Solid s;
	add_grid( s, 8, 6, true, 1, { 0, 0, 0 }, lw_transform_identity() );
	std::vector<double> numbers = rounded( s.vertices );
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = numbers.data();
	def.vertex_count = static_cast<uint32_t>( s.vertices.size() );
	def.indices = s.indices.data();
	def.triangle_count = static_cast<uint32_t>( s.count() );
	def.solid = true;
	lw_diag diag = {};
	lw_shape* shape = nullptr;
	for ( std::size_t fail = 1; fail < 100; ++fail )
	{
		FailingAllocator memory;
		memory.fail_at = fail;
		lw_status status = lw_shape_create_mesh( &def, &memory.allocator, &diag, &shape );
		if ( status == LW_OK )
		{
			EXPECT_GT( fail, 15u );
			lw_shape_release( shape );
			EXPECT_EQ( 0u, memory.live );
			break;
		}
		EXPECT_EQ( LW_ERROR_OUT_OF_MEMORY, status );
		EXPECT_EQ( 0u, memory.live ) << fail;
	}
	def.tree.tile_radius = 0.1;
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_shape_create_mesh( &def, nullptr, &diag, &shape ) );
}

namespace
{
/// A body that slides along x, an obstacle at the origin.
struct Slide : OneJoint
{
	Slide( const lw_shape* body, const lw_shape* obstacle )
	{
		const double along_x[3] = { 1, 0, 0 };
		EXPECT_EQ( LW_OK, makeRobot( body, lw_transform_identity(), LW_JOINT_PRISMATIC, along_x, 5, nullptr ) );
		makeChecker( obstacle, lw_transform_identity() );
	}
};
} // namespace

// A ball of 0.1 m and a cube of half edge 1 m, either of them the robot: states and edges find the inner one.
TEST( SolidMesh, CheckerDrivesThroughASolid )
{
	Solid s;
	add_box( s, 3, { 1, 1, 1 }, { 0, 0, 0 }, lw_transform_identity() );
	lw_diag diag = {};
	ShapePtr cube, ball = makePrimitive( LW_SHAPE_SPHERE, 0.1 );
	ASSERT_EQ( LW_OK, make_solid( s, 0, &diag, cube ) ) << diag.message;
	for ( bool robot_is_cube : { false, true } )
	{
		Slide slide( robot_is_cube ? cube.get() : ball.get(), robot_is_cube ? ball.get() : cube.get() );
		QueryPtr query = makeQuery( nullptr, slide.checker );
		lw_edge_def edge = lw_edge_def_default();
		edge.flags = LW_CHECK_ENVIRONMENT;
		for ( double q = -3; q <= 3; q += 0.0625 )
		{
			double truth = std::max( 0.0, std::abs( q ) - 1.1 );
			lw_state_result state;
			ASSERT_EQ(
			    LW_OK, lw_checker_state( slide.checker, query.get(), &q, LW_CHECK_ENVIRONMENT, nullptr, false, &state ) );
			ASSERT_NEAR( truth, state.environment.upper, 1e-13 ) << q;
			ASSERT_LE( state.environment.lower, truth + 1e-15 ) << q;
			double to = q + 0.01;
			lw_edge_result result;
			ASSERT_EQ( LW_OK, lw_checker_edge( slide.checker, query.get(), &q, &to, &edge, &result ) );
			if ( std::abs( std::abs( q ) - 1.1 ) > 0.1 )
			{
				ASSERT_EQ( truth > 0 ? LW_VERDICT_FREE : LW_VERDICT_BLOCKED, result.verdict ) << q;
			}
		}
		double from = -3, to = 3;
		lw_edge_result result;
		ASSERT_EQ( LW_OK, lw_checker_edge( slide.checker, query.get(), &from, &to, &edge, &result ) );
		EXPECT_EQ( LW_VERDICT_BLOCKED, result.verdict );
	}
}
