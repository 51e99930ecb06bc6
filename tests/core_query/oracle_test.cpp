// SPDX-License-Identifier: BSD-3-Clause
// lw_shape_distance against brute force (shape_oracle.hpp): 117,900 random pairs in one run, all 45 combinations of shapes
// in both orders, ratios of sizes over 9 decades, sizes from 1e-5 to 1e4.
//
// The stated bounds, with u = 2^-53 and scale = distance of the shapes' frames + twice the size of each (size = farthest
// point from the frame's origin):
// - `lower` is proven, so only the oracle's own rounding may put it above: 8 u scale with a cylinder, a cone or two boxes,
//   whose poses or corners it rounds to double, and 0.01 u scale else;
// - `upper` is attained to rounding, 64 u scale: pose products and moved vertices 16 u, rotations that are orthonormal only
//   to 8 epsilon and taken as given 28 u (16 u per entry, sqrt 3), dilation and the kernels' own differences the rest;
// - width: 1e-10 of the scale with a cylinder or cone, 2e-12 else (core/docs/convex_distance.md: 1e-12 of the extent for
//   polytopes, plus those 80 u of core/docs/distance.md);
// - witnesses are on their pieces and `upper` apart to 64 u scale + 16 u times the world's coordinates.
#include "shape_oracle.hpp"
#include "shapes.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

using namespace oracle;

namespace
{
const double inf = std::numeric_limits<double>::infinity();
constexpr real roundoff = 0x1p-53L;

#if defined( __has_feature )
#if __has_feature( address_sanitizer ) || __has_feature( thread_sanitizer )
#define SLOW_BUILD
#endif
#endif
#if defined( __SANITIZE_ADDRESS__ ) || defined( __SANITIZE_THREAD__ )
#define SLOW_BUILD
#endif

/// Pairs per combination: a tenth under the sanitizers, which cost five to ten times. LEEWAY_ORACLE_PAIRS overrides it.
int pair_count()
{
	if ( const char* text = std::getenv( "LEEWAY_ORACLE_PAIRS" ) )
	{
		return std::max( 180, std::atoi( text ) );
	}
#ifdef SLOW_BUILD
	return 360;
#else
	return 3600;
#endif
}

constexpr int type_count = 9;
constexpr lw_shape_type types[type_count] = { LW_SHAPE_MESH, LW_SHAPE_POINTS, LW_SHAPE_BOX, LW_SHAPE_SPHERE,
	LW_SHAPE_CYLINDER, LW_SHAPE_CAPSULE, LW_SHAPE_CONE, LW_SHAPE_SPHERES, LW_SHAPE_BOXES };
constexpr const char* type_names[type_count] = { "mesh", "points", "box", "sphere", "cylinder", "capsule", "cone", "spheres",
	"boxes" };

/// One sphere or box of a set: a model about its own centre.
struct Part
{
	Model model;
	Vec center;
};

/// A shape twice: for the engine and for the oracle, both from the same numbers.
struct Subject
{
	ShapePtr shape;
	lw_shape_type type = LW_SHAPE_MESH;
	Model model;             ///< of a set: only its size
	std::vector<Part> parts; ///< of a set, else empty
};

bool is_set( const Subject& s ) { return s.type == LW_SHAPE_SPHERES || s.type == LW_SHAPE_BOXES; }
std::size_t item_count( const Subject& s ) { return is_set( s ) ? s.parts.size() : s.model.count(); }

Vec random_point( SeededRng& rng, double size )
{
	return { rng.uniform( -size, size ), rng.uniform( -size, size ), rng.uniform( -size, size ) };
}

/// How many triangles or points: mostly one to twelve, one in forty enough for inner nodes.
int soup_count( SeededRng& rng )
{
	return rng.integer( 0, 39 ) == 0 ? rng.integer( 100, 400 ) : rng.integer( 1, 12 );
}

/// A soup of triangles of all kinds: ordinary, slivers down to 1e-14, segments, points, repeated ones, neighbours.
std::vector<Vec> random_triangles( SeededRng& rng, double size )
{
	const int count = soup_count( rng );
	const double part = count > 12 ? 0.2 * size : size * rng.decade( -1.5, 0 );
	// some meshes are not about their frame's origin
	Vec shift = rng.integer( 0, 4 ) == 0 ? random_point( rng, size * rng.decade( 0, 2 ) ) : Vec{ 0, 0, 0 };
	std::vector<Vec> points;
	for ( int i = 0; i < count; ++i )
	{
		Vec center = shift + random_point( rng, size );
		Vec v[3];
		for ( Vec& corner : v )
		{
			corner = center + random_point( rng, part );
		}
		switch ( rng.integer( 0, 9 ) )
		{
		case 0:
			v[2] = v[0] + (real)rng.uniform( 0, 1 ) * ( v[1] - v[0] ) + random_point( rng, part * rng.decade( -14, -2 ) );
			break;
		case 1:
			v[rng.integer( 1, 2 )] = v[0];
			break;
		case 2:
			v[1] = v[2] = v[0];
			break;
		case 3:
			if ( i > 0 )
			{
				std::copy( points.end() - 3, points.end(), v );
			}
			break;
		case 4:
			if ( i > 0 )
			{
				v[0] = points[points.size() - 1];
				v[1] = points[points.size() - 2];
			}
			break;
		default:
			break;
		}
		points.insert( points.end(), v, v + 3 );
	}
	return points;
}

std::vector<double> rounded( std::vector<Vec>& points )
{
	std::vector<double> out;
	for ( Vec& p : points )
	{
		lw_vec3 q = to_double( p );
		out.insert( out.end(), { q.x, q.y, q.z } );
		p = from( q );
	}
	return out;
}

void make_soup( SeededRng& rng, double size, Subject& out )
{
	if ( out.type == LW_SHAPE_MESH )
	{
		out.model.corners = 3;
		out.model.points = random_triangles( rng, size );
		std::vector<double> vertices = rounded( out.model.points );
		std::vector<uint32_t> indices;
		for ( std::size_t i = 0; i < out.model.points.size(); ++i )
		{
			indices.push_back( static_cast<uint32_t>( i ) );
		}
		out.shape = makeMesh( vertices, indices );
		return;
	}
	out.model.corners = 1;
	const int count = soup_count( rng );
	for ( int i = 0; i < count; ++i )
	{
		bool again = i > 0 && rng.integer( 0, 9 ) == 0;
		out.model.points.push_back( again ? out.model.points.back() : random_point( rng, size ) );
	}
	std::vector<double> points = rounded( out.model.points );
	out.model.radius = rng.integer( 0, 3 ) == 0 ? 0 : size * rng.decade( -3, 0 );
	lw_shape* shape = nullptr;
	lw_status status = lw_shape_create_points( points.data(), static_cast<uint32_t>( count ), out.model.radius, nullptr,
		nullptr, nullptr, &shape );
	ASSERT_EQ( LW_OK, status );
	out.shape.reset( shape );
}

/// Spheres of radii over four decades, some of them points; boxes of all sizes, some of them plates, segments or points.
void make_set( SeededRng& rng, double size, Subject& out )
{
	const bool spheres = out.type == LW_SHAPE_SPHERES;
	const int count = soup_count( rng );
	Vec shift = rng.integer( 0, 4 ) == 0 ? random_point( rng, size * rng.decade( 0, 2 ) ) : Vec{ 0, 0, 0 };
	std::vector<double> numbers;
	for ( int i = 0; i < count; ++i )
	{
		Part part;
		lw_vec3 c = to_double( shift + random_point( rng, size ) );
		double extent = size * rng.decade( count > 12 ? -3 : -4, count > 12 ? -1 : 0 );
		if ( spheres )
		{
			part.model.corners = 1;
			part.model.points.assign( 1, { 0, 0, 0 } );
			part.model.radius = part.model.size = rng.integer( 0, 9 ) == 0 ? 0 : extent;
			part.center = from( c );
			numbers.insert( numbers.end(), { c.x, c.y, c.z, part.model.radius } );
		}
		else
		{
			double low[3] = { c.x, c.y, c.z }, high[3], middle[3];
			for ( int k = 0; k < 3; ++k )
			{
				high[k] = low[k] + ( rng.integer( 0, 9 ) == 0 ? 0 : extent * rng.uniform( 0.05, 1 ) );
				part.model.solid.size[k] = 0.5 * ( high[k] - low[k] );
				middle[k] = to_double( 0.5L * ( (real)low[k] + high[k] ) );
			}
			part.model.solid.type = LWI_CONVEX_BOX;
			part.model.size = Body{ part.model.solid }.radius();
			part.center = { middle[0], middle[1], middle[2] };
			numbers.insert( numbers.end(), low, low + 3 );
			numbers.insert( numbers.end(), high, high + 3 );
		}
		out.model.size = std::max( out.model.size, length( part.center ) + part.model.size );
		out.parts.push_back( part );
	}
	lw_shape* shape = nullptr;
	lw_diag diag = {};
	auto n = static_cast<uint32_t>( count );
	lw_status status = spheres ? lw_shape_create_spheres( numbers.data(), n, nullptr, nullptr, &diag, &shape )
							   : lw_shape_create_boxes( numbers.data(), n, nullptr, nullptr, &diag, &shape );
	ASSERT_EQ( LW_OK, status ) << diag.message;
	ASSERT_EQ( LW_OK, lw_shape_validate( shape, &diag ) ) << diag.message;
	out.shape.reset( shape );
}

/// A quarter of the primitives are plates, wires or needles.
void make_primitive( SeededRng& rng, double size, Subject& out )
{
	double thinnest = rng.integer( 0, 3 ) == 0 ? -6 : -0.7, d[3];
	for ( double& x : d )
	{
		x = size * rng.decade( thinnest, 0 );
	}
	Model& m = out.model;
	switch ( out.type )
	{
	case LW_SHAPE_SPHERE:
	case LW_SHAPE_CAPSULE:
	{
		d[1] = out.type == LW_SHAPE_SPHERE || rng.integer( 0, 19 ) == 0 ? 0 : d[1];
		m.radius = d[0];
		real half = 0.5L * d[1];
		m.corners = out.type == LW_SHAPE_SPHERE ? 1 : 2;
		m.points.assign( 1, { 0, 0, -half } );
		m.points.resize( static_cast<std::size_t>( m.corners ), { 0, 0, half } );
		break;
	}
	case LW_SHAPE_BOX:
		m.solid = { LWI_CONVEX_BOX, { 0.5 * d[0], 0.5 * d[1], 0.5 * d[2] }, {}, nullptr, 0 };
		break;
	default:
		m.solid = { out.type == LW_SHAPE_CONE ? LWI_CONVEX_CONE : LWI_CONVEX_CYLINDER, { d[0], 0.5 * d[1], 0 }, {}, nullptr, 0 };
	}
	out.shape = makePrimitive( out.type, d[0], d[1], d[2] );
}

Subject make_subject( SeededRng& rng, lw_shape_type type, double size )
{
	Subject out;
	out.type = type;
	if ( is_set( out ) )
	{
		make_set( rng, size, out );
		return out;
	}
	if ( type == LW_SHAPE_MESH || type == LW_SHAPE_POINTS )
	{
		make_soup( rng, size, out );
	}
	else
	{
		make_primitive( rng, size, out );
	}
	real core = out.model.corners == 0 ? Body{ out.model.solid }.radius() : (real)0;
	for ( Vec p : out.model.points )
	{
		core = std::max( core, length( p ) );
	}
	out.model.size = core + out.model.radius;
	return out;
}

bool is_solid( const Subject& s )
{
	return s.type != LW_SHAPE_MESH && s.type != LW_SHAPE_POINTS;
}

/// A random point of the shape: of its surface if it is a mesh, well inside if it is a primitive.
Vec point_of( SeededRng& rng, const Subject& s )
{
	if ( is_set( s ) )
	{
		return s.parts[static_cast<std::size_t>( rng.integer( 0, (int)s.parts.size() - 1 ) )].center;
	}
	const Model& m = s.model;
	if ( m.corners == 0 )
	{
		return Body{ m.solid }.nearest( random_point( rng, 1e-3 * *std::min_element( m.solid.size, m.solid.size + 2 ) ) );
	}
	auto corners = static_cast<std::size_t>( m.corners );
	std::size_t first = corners * static_cast<std::size_t>( rng.integer( 0, (int)m.count() - 1 ) );
	real left = 1;
	Vec p = { 0, 0, 0 };
	for ( std::size_t k = 0; k < corners; ++k )
	{
		real part = k + 1 == corners ? left : left * (real)rng.uniform( 0, 1 );
		p = p + part * m.points[first + k];
		left -= part;
	}
	return p;
}

enum Regime
{
	FREE,     ///< frames up to three sizes apart
	DISTANT,  ///< ten to a thousand sizes
	CLOSE,    ///< moved along the witness line until 1e-9 to 1e-3 of the smaller shape is left
	TOUCHING, ///< the same until nothing is left
	INSIDE,   ///< one common point, of the solids well inside
	REGIMES
};

/// One random pair in a world, and what was found out about it.
struct Pair
{
	Subject a, b;
	lw_transform pose_a, pose_b;
	real scale, world;

	void measure_scale()
	{
		scale = length( offset( pose_b ) - offset( pose_a ) ) + 2 * ( a.model.size + b.model.size );
		world = length( offset( pose_a ) ) + length( offset( pose_b ) );
	}
	bool curved() const
	{
		auto is = []( const Subject& s ) { return s.type == LW_SHAPE_CYLINDER || s.type == LW_SHAPE_CONE; };
		return is( a ) || is( b );
	}
	real lower_bound() const
	{
		bool rounds = curved() || ( a.type == LW_SHAPE_BOX && b.type == LW_SHAPE_BOX ) || is_set( a ) || is_set( b );
		return ( rounds ? 8 : 0.01L ) * roundoff * scale;
	}
	real bound() const { return 64 * roundoff * scale; }
	real width() const { return ( curved() ? (real)LWI_CONVEX_WIDTH_CURVED : 2e-12L ) * scale; }
};

lw_transform random_pose( SeededRng& rng, double far )
{
	lw_transform m = random_rotation( rng );
	if ( rng.integer( 0, 4 ) == 0 )
	{
		// axes along axes: faces, edges and rims are parallel
		m = lw_transform_identity();
		int turn = rng.integer( 0, 2 );
		for ( int i = 0; i < 3; ++i )
		{
			m.r[i][i] = 0;
		}
		for ( int i = 0; i < 3; ++i )
		{
			m.r[i][( i + turn ) % 3] = 1;
		}
	}
	lw_vec3 d = random_direction( rng );
	m.t[0] = far * d.x;
	m.t[1] = far * d.y;
	m.t[2] = far * d.z;
	return m;
}

/// Moves b so that `left` of the distance remains (less where another part of it gets in the way).
void approach( Pair& p, lw_query* query, double left )
{
	lw_clearance c;
	ASSERT_EQ( LW_OK, lw_shape_distance( p.a.shape.get(), &p.pose_a, p.b.shape.get(), &p.pose_b, nullptr, query, &c ) );
	if ( c.upper == 0 )
	{
		// they overlap, and would stay so: out first
		p.pose_b.t[0] = p.pose_a.t[0] + 1.5 * to_double( p.a.model.size + p.b.model.size );
		ASSERT_EQ( LW_OK, lw_shape_distance( p.a.shape.get(), &p.pose_a, p.b.shape.get(), &p.pose_b, nullptr, query, &c ) );
	}
	if ( c.upper > 0 )
	{
		Vec step = ( left / c.upper - 1 ) * ( from( c.point_b ) - from( c.point_a ) );
		p.pose_b.t[0] += to_double( step.x );
		p.pose_b.t[1] += to_double( step.y );
		p.pose_b.t[2] += to_double( step.z );
	}
}

void place( SeededRng& rng, lw_query* query, Regime regime, Pair& p )
{
	double sizes = to_double( p.a.model.size + p.b.model.size );
	double smaller = to_double( std::min( p.a.model.size, p.b.model.size ) );
	p.pose_a = random_pose( rng, rng.integer( 0, 2 ) == 0 ? sizes * rng.decade( -1, 2 ) : 0.0 );
	double far = regime == DISTANT ? sizes * rng.decade( 1, 3 ) : sizes * rng.uniform( 0, regime == FREE ? 3 : 1.2 );
	p.pose_b = random_pose( rng, far );
	Vec goal = offset( p.pose_a ) + offset( p.pose_b );
	if ( regime == INSIDE )
	{
		goal = rotate( p.pose_a, point_of( rng, p.a ) ) + offset( p.pose_a ) - rotate( p.pose_b, point_of( rng, p.b ) );
	}
	lw_vec3 t = to_double( goal );
	p.pose_b.t[0] = t.x;
	p.pose_b.t[1] = t.y;
	p.pose_b.t[2] = t.z;
	if ( regime == CLOSE || regime == TOUCHING )
	{
		approach( p, query, regime == CLOSE ? smaller * rng.decade( -9, -3 ) : 0.0 );
	}
	p.measure_scale();
}

struct Tally
{
	int pairs = 0, separated = 0, close = 0, touching = 0, overlapping = 0, contained = 0, distant = 0, decided = 0;
	int decades[9] = {}, first_smaller = 0, trees = 0, kinds[5] = {};
	real width = 0, above = 0, below = 0, outside = 0;
};

std::ostream& operator<<( std::ostream& out, const Pair& p )
{
	out << "scale " << p.scale << ", sizes " << p.a.model.size << " " << p.b.model.size;
	out << ", items " << item_count( p.a ) << " " << item_count( p.b );
	return out << ", types " << p.a.type << " " << p.b.type;
}

/// How far a witness is from the piece that it is said to be on.
real outside( const Subject& s, const lw_transform& pose, lw_vec3 point, uint32_t index )
{
	Vec local = unrotate( pose, from( point ) - offset( pose ) );
	bool is_soup = s.type == LW_SHAPE_MESH || s.type == LW_SHAPE_POINTS;
	if ( ( is_soup || is_set( s ) ) && index >= item_count( s ) )
	{
		return INFINITY;
	}
	if ( is_set( s ) )
	{
		const Part& part = s.parts[index];
		return part.model.piece( 0, still() ).distance_of( local - part.center ) - part.model.radius;
	}
	return s.model.piece( is_soup ? index : 0, still() ).distance_of( local ) - s.model.radius;
}

void check_witnesses( const Pair& p, const lw_clearance& c, Tally& tally )
{
	real off = std::max( outside( p.a, p.pose_a, c.point_a, c.a ), outside( p.b, p.pose_b, c.point_b, c.b ) );
	off = std::max( off, std::fabs( length( from( c.point_a ) - from( c.point_b ) ) - c.upper ) );
	tally.outside = std::max( tally.outside, off / ( p.scale + p.world ) );
	ASSERT_LE( off, 64 * roundoff * p.scale + 16 * roundoff * p.world ) << p;
}

void check_exact( const Pair& p, const lw_clearance& c, const Interval& truth, Tally& tally )
{
	tally.above = std::max( tally.above, ( c.lower - truth.upper ) / p.scale );
	tally.below = std::max( tally.below, ( truth.lower - c.upper ) / p.scale );
	tally.width = std::max( tally.width, ( c.upper - c.lower ) / p.scale );
	ASSERT_LE( 0, c.lower );
	ASSERT_LE( c.lower, c.upper );
	ASSERT_LE( c.lower, truth.upper + p.lower_bound() ) << "not a lower bound: " << p << ", oracle " << truth.lower;
	ASSERT_GE( c.upper, truth.lower - p.bound() ) << "not an upper bound: " << p << ", oracle " << truth.upper;
	ASSERT_LE( c.upper - c.lower, p.width() ) << p << ", oracle " << truth.lower << " " << truth.upper;
	lw_clearance_class apart = c.lower > 0 ? LW_CLEARANCE_NEAR : LW_CLEARANCE_UNDECIDED;
	lw_clearance_class kind = c.upper == 0 ? LW_CLEARANCE_VIOLATION : apart;
	ASSERT_EQ( kind, c.kind );
	check_witnesses( p, c, tally );
}

/// A query with tolerance and limits around the distance that the oracle found.
void check_range( SeededRng& rng, const Pair& p, const Interval& truth, lw_query* query, Tally& tally )
{
	double d = to_double( truth.upper );
	lw_range range = { 0, inf, 0.3 };
	if ( d > 1e-9 * to_double( p.scale ) )
	{
		range.min_d = rng.integer( 0, 1 ) * d * rng.uniform( 0.1, 2 );
		range.max_d = rng.integer( 0, 1 ) == 0 ? inf : range.min_d + d * rng.uniform( 0.1, 2 );
	}
	lw_clearance c;
	ASSERT_EQ( LW_OK, lw_shape_distance( p.a.shape.get(), &p.pose_a, p.b.shape.get(), &p.pose_b, &range, query, &c ) );
	::testing::Message story;
	story << p << " oracle " << truth.lower << " " << truth.upper << " range " << range.min_d << " " << range.max_d;
	SCOPED_TRACE( story << " got " << c.lower << " " << c.upper << " class " << c.kind );
	++tally.kinds[c.kind];
	ASSERT_LE( c.lower, truth.upper + p.lower_bound() );
	ASSERT_GE( c.upper, truth.lower - p.bound() );
	switch ( c.kind )
	{
	case LW_CLEARANCE_FAR:
		ASSERT_EQ( c.lower, range.max_d );
		ASSERT_EQ( c.upper, inf );
		return;
	case LW_CLEARANCE_NEAR:
		ASSERT_GT( c.lower, range.min_d );
		ASSERT_LE( c.upper - c.lower, range.alpha * c.upper + p.width() );
		break;
	case LW_CLEARANCE_VIOLATION:
		ASSERT_LE( c.upper, range.min_d );
		ASSERT_EQ( c.lower, 0 );
		break;
	default:
		ASSERT_EQ( c.kind, LW_CLEARANCE_UNDECIDED );
		ASSERT_LE( c.lower, range.min_d );
		ASSERT_LE( c.upper - range.min_d, p.width() );
	}
	check_witnesses( p, c, tally );
}

void count_pair( const Pair& p, const lw_clearance& c, const Interval& truth, Regime regime, Tally& tally )
{
	real smaller = std::min( p.a.model.size, p.b.model.size );
	++tally.pairs;
	tally.first_smaller += p.a.model.size < p.b.model.size;
	tally.separated += c.lower > 0;
	tally.close += c.lower > 0 && c.upper <= 2e-3L * smaller;
	tally.touching += truth.lower <= p.bound() && regime == TOUCHING;
	tally.overlapping += truth.lower <= p.bound() && regime != TOUCHING;
	tally.contained += regime == INSIDE && ( is_solid( p.a ) || is_solid( p.b ) ) && c.upper == 0;
	tally.distant += c.lower > 4 * ( p.a.model.size + p.b.model.size );
	tally.decided += truth.upper - truth.lower <= 1e-9L * p.scale;
	tally.trees += std::max( item_count( p.a ), item_count( p.b ) ) > 64;
}

class ShapeOracle : public ::testing::TestWithParam<std::pair<int, int>>
{
};

std::vector<std::pair<int, int>> all_combinations()
{
	std::vector<std::pair<int, int>> out;
	for ( int a = 0; a < type_count; ++a )
	{
		for ( int b = a; b < type_count; ++b )
		{
			out.push_back( { a, b } );
		}
	}
	return out;
}

/// The parts of a subject; of what is no set, itself.
std::vector<Part> parts_of( const Subject& s )
{
	return is_set( s ) ? s.parts : std::vector<Part>{ { s.model, { 0, 0, 0 } } };
}

/// The least over all pairs of parts, nearest spheres first; both placed in a frame where a rests.
Interval truth_of( const Pair& p )
{
	if ( !is_set( p.a ) && !is_set( p.b ) )
	{
		return shape_distance( p.a.model, p.pose_a, p.b.model, p.pose_b, p.scale );
	}
	Pose a_from_b = relative( p.pose_a, p.pose_b );
	std::vector<Part> a = parts_of( p.a ), b = parts_of( p.b );
	struct Candidate
	{
		real gap;
		const Part *a, *b;
		Vec offset;
	};
	std::vector<Candidate> candidates;
	for ( const Part& x : a )
	{
		for ( const Part& y : b )
		{
			Vec offset = a_from_b.apply( y.center ) - x.center;
			candidates.push_back( { length( offset ) - x.model.size - y.model.size, &x, &y, offset } );
		}
	}
	std::sort( candidates.begin(), candidates.end(), []( const Candidate& x, const Candidate& y ) { return x.gap < y.gap; } );
	Interval best = { INFINITY, INFINITY };
	for ( const Candidate& c : candidates )
	{
		if ( c.gap >= best.upper || best.upper == 0 )
		{
			break;
		}
		Pose place = a_from_b;
		place.t = c.offset;
		Interval d = shape_distance( c.a->model, lw_transform_identity(), c.b->model, to_transform( place ), p.scale );
		best.lower = std::min( best.lower, d.lower );
		best.upper = std::min( best.upper, d.upper );
	}
	return best;
}

void one_pair( SeededRng& rng, int i, int ta, int tb, lw_query* query, Tally& tally )
{
	int decade = i % 9;
	double ratio = decade + rng.uniform( 0, 1 ), smaller = rng.decade( -5, 4 - ratio );
	double larger = smaller * std::pow( 10, ratio );
	bool first = rng.integer( 0, 1 ) == 0;
	Pair p = {};
	p.a = make_subject( rng, types[ta], first ? smaller : larger );
	p.b = make_subject( rng, types[tb], first ? larger : smaller );
	Regime regime = static_cast<Regime>( rng.integer( 0, REGIMES - 1 ) );
	place( rng, query, regime, p );
	lw_clearance c;
	ASSERT_EQ( LW_OK, lw_shape_distance( p.a.shape.get(), &p.pose_a, p.b.shape.get(), &p.pose_b, nullptr, query, &c ) );
	Interval truth = truth_of( p );
	++tally.decades[decade];
	count_pair( p, c, truth, regime, tally );
	check_exact( p, c, truth, tally );
	if ( i % 4 == 0 )
	{
		check_range( rng, p, truth, query, tally );
	}
}
} // namespace

TEST_P( ShapeOracle, engine_contradicts_brute_force )
{
	auto [ta, tb] = GetParam();
	SeededRng rng( 20260201u + 10u * (unsigned)ta + (unsigned)tb );
	QueryPtr query = makeQuery();
	Tally tally;
	// meshes and boxes cost the oracle most: every edge against every box
	const int count = std::max( ta, tb ) == 8 && ( ta == 0 || ta == 2 || tb == 2 || ta == 8 ) ? pair_count() / 4 : pair_count();
	for ( int i = 0; i < count; ++i )
	{
		one_pair( rng, i, ta, tb, query.get(), tally );
		ASSERT_FALSE( HasFatalFailure() ) << "pair " << i;
		std::swap( ta, tb );
	}
	std::printf( "%d pairs: %d separated (%d close, %d distant), %d touching, %d overlapping, %d contained; %d with trees\n",
		tally.pairs, tally.separated, tally.close, tally.distant, tally.touching, tally.overlapping, tally.contained,
		tally.trees );
	std::printf( "oracle within 1e-9: %d; ranges: %d near, %d far, %d violation, %d undecided\n", tally.decided,
		tally.kinds[1], tally.kinds[2], tally.kinds[3], tally.kinds[4] );
	std::printf( "worst, of the scale: width %.2Lg, lower above oracle %.2Lg, upper below oracle %.2Lg, witness %.2Lg\n",
		tally.width, tally.above, tally.below, tally.outside );
	EXPECT_GE( tally.separated, count / 4 );
	EXPECT_GE( tally.close, count / 40 );
	EXPECT_GE( tally.distant, count / 20 );
	EXPECT_GE( tally.touching, count / 40 );
	EXPECT_GE( tally.overlapping, count / 10 );
	EXPECT_GE( tally.first_smaller, count / 3 );
	EXPECT_LE( tally.first_smaller, 2 * count / 3 );
	EXPECT_GE( *std::min_element( tally.decades, tally.decades + 9 ), count / 9 );
	EXPECT_GE( tally.decided, count * 9 / 10 ) << "the oracle has lost its teeth";
	EXPECT_GE( std::min( { tally.kinds[1], tally.kinds[2], tally.kinds[3] } ), count / 200 );
	bool any_solid = std::max( ta, tb ) >= 2;
	EXPECT_GE( tally.contained, any_solid ? count / 20 : 0 );
	bool any_tree = std::min( ta, tb ) < 2 || std::max( ta, tb ) >= 7;
	EXPECT_GE( tally.trees, any_tree ? count / 100 : 0 );
}

INSTANTIATE_TEST_SUITE_P( combinations, ShapeOracle, ::testing::ValuesIn( all_combinations() ), []( const auto& pair ) {
	return std::string( type_names[pair.param.first] ) + "_" + type_names[pair.param.second];
} );
