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
#include "oracle_subject.hpp"
#include "sanitized.hpp"

#include <limits>
#include <string>

using namespace oracle;

namespace
{
const double inf = std::numeric_limits<double>::infinity();
constexpr real roundoff = 0x1p-53L;

/// Pairs per combination: a tenth under the sanitizers, which cost five to ten times. LEEWAY_ORACLE_PAIRS overrides it.
int pair_count()
{
	if ( const char* text = std::getenv( "LEEWAY_ORACLE_PAIRS" ) )
	{
		return std::max( 180, std::atoi( text ) );
	}
	return unlessSanitized( 3600, 360 );
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

/// One random pair in a world, and the findings about it.
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
	Interval truth = truth_of( p.a, p.pose_a, p.b, p.pose_b, p.scale );
	++tally.decades[decade];
	count_pair( p, c, truth, regime, tally );
	check_exact( p, c, truth, tally );
	if ( i % 4 == 0 )
	{
		check_range( rng, p, truth, query, tally );
	}
}
} // namespace

TEST_P( ShapeOracle, EngineContradictsBruteForce )
{
	auto [ta, tb] = GetParam();
	SeededRng rng( 20260201u + 10u * (unsigned)ta + (unsigned)tb );
	QueryPtr query = makeQuery();
	Tally tally;
	// meshes and boxes cost the oracle most: every edge against every box
	const int count =
	    std::max( ta, tb ) == 8 && ( ta == 0 || ta == 2 || tb == 2 || ta == 8 ) ? pair_count() / 4 : pair_count();
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

INSTANTIATE_TEST_SUITE_P( combinations, ShapeOracle, ::testing::ValuesIn( all_combinations() ),
    []( const auto& pair ) { return std::string( type_names[pair.param.first] ) + "_" + type_names[pair.param.second]; } );
