// SPDX-License-Identifier: BSD-3-Clause
// Everything that answers promise, judged at the extremes: counts, the worst error in units of the promise, and broken
// promises.
#pragma once

#include "extreme_solids.hpp"
#include "same_bits.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>

#include "distance/tri_tri.h"

namespace extremes
{

/// So many cases, times the environment variable LEEWAY_EXTREMES: 1000 makes a long hunt of a test.
inline std::uint64_t caseCount( std::uint64_t usual )
{
	const char* times = std::getenv( "LEEWAY_EXTREMES" );
	return times != nullptr ? usual * std::max( 1ull, std::strtoull( times, nullptr, 10 ) ) : usual;
}

enum Stage
{
	triangle_distance, ///< |lwi_tri_tri() - truth| in LWI_TRI_TRI_ERROR of the extent
	triangle_witness,  ///< its points beside their triangles, in the same and one roundoff of their coordinates
	query_lower, ///< of the allowance for rounding in a measured distance, the share that was needed (neither boxes nor curved)
	query_upper,    ///< truth - upper, in the promised rounding
	query_width,    ///< upper - lower for alpha 0, in the promised rounding (neither boxes nor curved)
	box_width,      ///< the same with boxes
	curved_width,   ///< the same with cylinders and cones
	query_witness,  ///< points beside the shapes, and their distance from upper
	query_exchange, ///< answers for a, b and for b, a
	query_moved,    ///< answers before and after a rigid motion of both
	stage_count
};

constexpr const char* stage_names[stage_count] = { "triangle distance", "triangle witness", "query lower", "query upper",
    "query width", "query width, boxes", "query width, curved", "query witness", "query exchanged", "query moved" };

/// Findings so far.
struct Findings
{
	std::uint64_t pairs = 0, queries = 0, placements = 0, refused = 0;
	std::uint64_t efforts[3] = {}; ///< triangle pairs settled by a certificate, in 64 bits, in 113
	std::uint64_t kinds[5] = {};   ///< answers by class
	double worst[stage_count] = {};
	std::uint64_t broken = 0;
	std::vector<std::string> examples; ///< the first few broken promises

	void add( Stage stage, double ratio, const std::string& where )
	{
		worst[stage] = std::max( worst[stage], ratio );
		if ( !( ratio <= 1 ) )
		{
			fail( std::string( stage_names[stage] ) + ": " + std::to_string( ratio ) + " of what is promised, " + where );
		}
	}
	void fail( const std::string& text )
	{
		++broken;
		if ( examples.size() < 20 )
		{
			examples.push_back( text );
		}
	}
	void require( bool holds, const char* what, const std::string& where )
	{
		if ( !holds )
		{
			fail( std::string( what ) + ": " + where );
		}
	}
	void merge( const Findings& other )
	{
		pairs += other.pairs, queries += other.queries, placements += other.placements, refused += other.refused,
		    broken += other.broken;
		for ( int i = 0; i < 3; ++i )
		{
			efforts[i] += other.efforts[i];
		}
		for ( int i = 0; i < 5; ++i )
		{
			kinds[i] += other.kinds[i];
		}
		for ( int i = 0; i < stage_count; ++i )
		{
			worst[i] = std::max( worst[i], other.worst[i] );
		}
		for ( const std::string& text : other.examples )
		{
			if ( examples.size() < 20 )
			{
				examples.push_back( text );
			}
		}
	}
};

inline double largestCoordinate( lw_vec3 v )
{
	return std::max( { std::abs( v.x ), std::abs( v.y ), std::abs( v.z ) } );
}

inline double distanceOf( lw_vec3 a, lw_vec3 b )
{
	return std::hypot( a.x - b.x, a.y - b.y, a.z - b.z );
}

/// One pair of triangles. `name` tells where it comes from.
inline void judgeTriangles( const TrianglePair& p, const char* name, std::uint64_t index, Findings& findings )
{
	++findings.pairs;
	lwi_tri_result r = lwi_tri_tri( p.a, p.b );
	double extent = exact::extentOf( p.a, p.b );
	double promise = LWI_TRI_TRI_ERROR * extent + 4 * std::numeric_limits<double>::denorm_min();
	// nothing that was not yet seen to be worse needs to be known more exactly than that it is not
	double known = std::max( 0.02, findings.worst[triangle_distance] );
	exact::Wide outside = 0;
	exact::Enclosure truth = exact::distanceNear( p.a, p.b, r.point_a, r.point_b, r.distance, known * promise, &outside );
	++findings.efforts[truth.effort];
	double error = static_cast<double>( exact::worstError( truth, r.distance ) ) / promise;
	double near = promise + 2 * 0x1p-53 * std::max( largestCoordinate( r.point_a ), largestCoordinate( r.point_b ) );
	double beside = static_cast<double>( outside ) / near;
	if ( beside > std::max( 0.1, findings.worst[triangle_witness] ) ) // feet in needles need more digits
	{
		exact::Quad from_a = exact::pointDistance<exact::Quad>( p.a, r.point_a );
		exact::Quad from_b = exact::pointDistance<exact::Quad>( p.b, r.point_b );
		beside = static_cast<double>( std::max( from_a, from_b ) ) / near;
	}
	if ( error > findings.worst[triangle_distance] || beside > findings.worst[triangle_witness] )
	{
		std::string where = std::string( name ) + " " + std::to_string( index );
		findings.add( triangle_distance, error, where );
		findings.add( triangle_witness, beside, where );
	}
}

/// The questions about one placement of two shapes.
class ShapeJudge
{
public:
	ShapeJudge( const ShapePair& pair, std::uint64_t index, lw_query* query, Findings& findings )
	    : m_pair( pair ), m_query( query ), m_findings( findings ),
	      m_where( std::string( pair.name ) + " " + std::to_string( index ) ),
	      m_promise( exact::promiseOf( pair.a.body, pair.world_from_a, pair.b.body, pair.world_from_b ) ),
	      m_width( pair.a.body.isCurved() || pair.b.body.isCurved()     ? curved_width
	               : pair.a.body.isOfBoxes() || pair.b.body.isOfBoxes() ? box_width
	                                                                    : query_width ),
	      m_truth(
	          exact::distance( pair.a.body, pair.world_from_a, pair.b.body, pair.world_from_b, 0.01 * m_promise.rounding ) )
	{
		++findings.placements;
		require( m_truth.upper - m_truth.lower <= 0.1 * m_promise.rounding, "the oracle is too wide" );
	}

	void run( Random& random )
	{
		answers( random );
		exchange();
		if ( !m_pair.skewed )
		{
			move( random );
		}
		ascend( random );
	}

	/// Against the truth alone.
	void answers( Random& random )
	{
		lw_range everything = lw_range_exact();
		lw_clearance exactly = ask( everything );
		judge( exactly, everything );
		judgeWitness( exactly );
		m_exact = exactly;
		for ( int i = 0; i < 5; ++i )
		{
			lw_range range = randomRange( random, static_cast<double>( m_truth.upper ) );
			lw_clearance first = ask( range );
			judge( first, range );
			lw_query_reset( m_query );
			lw_clearance again = ask( range );
			judge( again, range );
			// within alpha there is a choice, which earlier questions may decide
			requireSame( range.alpha == 0 ? first : again, again, range );
			lw_query_reset( m_query );
			requireSame( ask( range ), again, range );
		}
	}

private:
	lw_clearance ask( const lw_range& range )
	{
		return ask( m_pair.a, m_pair.world_from_a, m_pair.b, m_pair.world_from_b, range );
	}
	lw_clearance ask( const Subject& a, const lw_transform& world_from_a, const Subject& b, const lw_transform& world_from_b,
	    const lw_range& range )
	{
		lw_clearance out;
		++m_findings.queries;
		lw_status status =
		    lw_shape_distance( a.shape.get(), &world_from_a, b.shape.get(), &world_from_b, &range, m_query, &out );
		require( status == LW_OK, "no answer" );
		++m_findings.kinds[out.kind];
		return out;
	}

	/// A range: all kinds of ends, some of them next to the true distance.
	static lw_range randomRange( Random& random, double truth )
	{
		const double alphas[4] = { 0, 1 - 0x1p-20, 0.5, random.uniform( 0, 1 ) };
		lw_range range = { 0, INFINITY, alphas[random.below( 4 )] };
		double about = truth > 0 ? truth : random.octave( -40, 10 );
		switch ( random.below( 5 ) )
		{
		case 0:
			break;
		case 1:
			range.min_d = about * random.octave( -3, 3 );
			break;
		case 2:
			range.min_d = about * ( 1 + random.unit() * 0x1p-45 );
			break;
		default:
			range.min_d = random.below( 2 ) == 0 ? 0 : about * random.octave( -20, 2 );
			range.max_d = about * ( random.below( 2 ) == 0 ? 1 + random.unit() * 0x1p-45 : random.octave( -3, 3 ) );
			break;
		}
		// min_d = max_d but for one double: no range at all is refused
		range.max_d = range.max_d > range.min_d ? range.max_d : std::nextafter( range.min_d, INFINITY );
		return range;
	}

	void requireSame( const lw_clearance& one, const lw_clearance& other, const lw_range& range )
	{
		m_range = &range;
		m_got = &one;
		require( sameBits( one, other ), "not the same bits again" );
		m_range = nullptr;
	}

	void judge( const lw_clearance& got, const lw_range& range )
	{
		m_range = &range;
		m_got = &got;
		double promise = m_promise.rounding;
		require( got.lower <= m_truth.upper, "lower is above the truth" );
		require( got.lower <= got.upper, "lower is above upper" );
		double width = got.upper - got.lower - range.alpha * got.upper;
		switch ( got.kind )
		{
		case LW_CLEARANCE_FAR:
			require( got.lower == range.max_d && got.upper == INFINITY, "far, but not as far as asked" );
			m_range = nullptr;
			return;
		case LW_CLEARANCE_NEAR:
			require( got.lower > range.min_d, "near, but perhaps a violation" );
			break;
		case LW_CLEARANCE_VIOLATION:
			require( got.upper <= range.min_d && got.lower == 0, "no violation" );
			width = 0;
			break;
		case LW_CLEARANCE_UNDECIDED:
			require( got.lower <= range.min_d && got.upper > range.min_d, "undecided, but decided" );
			width = got.upper - got.lower; // whatever alpha
			break;
		default:
			require( false, "unknown" );
		}
		add( m_width, width / m_promise.width );
		add( query_upper, static_cast<double>( m_truth.lower - got.upper ) / promise );
		if ( range.alpha == 0 && got.kind == LW_CLEARANCE_NEAR && m_width == query_width )
		{
			add( query_lower, static_cast<double>( ( got.upper - m_truth.lower ) / ( got.upper - got.lower ) ) );
		}
		m_range = nullptr;
	}

	/// Distance of a point from the body that it should be a point of; world coordinates.
	double beside( const Subject& subject, const lw_transform& world_from_shape, lw_vec3 point, std::uint32_t element ) const
	{
		exact::Rotation rotation( world_from_shape );
		exact::Vec<exact::Wide> w = { exact::Wide( point.x ) - world_from_shape.t[0],
		    exact::Wide( point.y ) - world_from_shape.t[1], exact::Wide( point.z ) - world_from_shape.t[2] };
		exact::Vec<exact::Wide> v = rotation.back( w );
		lw_vec3 p = { static_cast<double>( v.x ), static_cast<double>( v.y ), static_cast<double>( v.z ) };
		const exact::Body& body = subject.body;
		if ( !body.pieces.empty() )
		{
			return static_cast<double>( exact::outside( body, p, element, 0.01 * m_promise.rounding ) );
		}
		double least = INFINITY;
		for ( const exact::Box& box : body.boxes )
		{
			double x = std::max( { 0.0, box.min[0] - p.x, p.x - box.max[0] } ),
			       y = std::max( { 0.0, box.min[1] - p.y, p.y - box.max[1] } );
			double z = std::max( { 0.0, box.min[2] - p.z, p.z - box.max[2] } );
			std::uint32_t index = static_cast<std::uint32_t>( &box - body.boxes.data() );
			least = element == LW_INVALID_INDEX || element == index ? std::min( least, std::hypot( x, y, z ) ) : least;
		}
		for ( std::size_t i = 0; i < body.items.size() && body.boxes.empty(); ++i )
		{
			if ( element == LW_INVALID_INDEX || element == i )
			{
				double d =
				    static_cast<double>( exact::pointDistance<exact::Quad>( body.items[i].v, p ) ) - body.items[i].radius;
				least = std::min( least, std::max( 0.0, d ) );
			}
		}
		return least;
	}

	void judgeWitness( const lw_clearance& got )
	{
		double coordinates = largestCoordinate( got.point_a ) + largestCoordinate( got.point_b );
		double allowed = m_promise.rounding + 4 * 0x1p-53 * coordinates; // they are rounded in the world
		double worst = std::max( beside( m_pair.a, m_pair.world_from_a, got.point_a, got.a ),
		    beside( m_pair.b, m_pair.world_from_b, got.point_b, got.b ) );
		worst = std::max( worst, std::abs( distanceOf( got.point_a, got.point_b ) - got.upper ) );
		add( query_witness, worst / allowed );
	}

	void exchange()
	{
		lw_range everything = lw_range_exact();
		lw_clearance other = ask( m_pair.b, m_pair.world_from_b, m_pair.a, m_pair.world_from_a, everything );
		judge( other, everything );
		double allowed = 2 * m_promise.width;
		add( query_exchange, std::abs( other.upper - m_exact.upper ) / allowed );
	}

	/// Both turned about the world's origin and shifted; poses round, and that is not the engine's.
	void move( Random& random )
	{
		lw_transform by = randomRotation( random );
		double far = random.below( 2 ) == 0 ? 0 : random.octave( 0, 24 );
		for ( double& c : by.t )
		{
			c = far * random.unit();
		}
		lw_transform a = lw_transform_multiply( &by, &m_pair.world_from_a ),
		             b = lw_transform_multiply( &by, &m_pair.world_from_b );
		double coordinates = 0;
		for ( int k = 0; k < 3; ++k )
		{
			coordinates += std::abs( a.t[k] ) + std::abs( b.t[k] ) + std::abs( m_pair.world_from_a.t[k] ) +
			               std::abs( m_pair.world_from_b.t[k] );
		}
		lw_clearance moved = ask( m_pair.a, a, m_pair.b, b, lw_range_exact() );
		double allowed = 2 * m_promise.width + 8 * 0x1p-53 * coordinates;
		add( query_moved, std::abs( moved.upper - m_exact.upper ) / allowed );
		require( moved.lower <= m_truth.upper + allowed, "a motion raises lower" );
	}

	/// FAR for less and less, VIOLATION for more and more, but for values within rounding of the truth.
	void ascend( Random& random )
	{
		double about = m_truth.upper > 0 ? static_cast<double>( m_truth.upper ) : random.octave( -40, 10 );
		bool was_near = false, was_violated = false;
		const double share = random.uniform( 0, 1 );
		for ( double factor : { 0.25, 1 - 0x1p-48, 1.0, 1 + 0x1p-48, 1 + share, 4.0 } )
		{
			double at = about * factor;
			if ( !( at > 0 ) )
			{
				continue;
			}
			bool loose = std::abs( at - static_cast<double>( m_truth.upper ) ) <= m_promise.width;
			lw_range below = { 0, at, random.below( 2 ) == 0 ? 0 : share }, above = { at, INFINITY, below.alpha };
			bool near = ask( below ).kind != LW_CLEARANCE_FAR, violated = ask( above ).kind == LW_CLEARANCE_VIOLATION;
			require( near || !was_near || loose, "far, but not from farther away" );
			require( violated || !was_violated || loose, "a violation, but not of a larger margin" );
			was_near = near && !loose;
			was_violated = violated && !loose;
		}
	}

	void add( Stage stage, double ratio )
	{
		if ( ratio > m_findings.worst[stage] || ratio != ratio )
		{
			m_findings.add( stage, ratio, where() );
		}
	}
	void require( bool holds, const char* what )
	{
		if ( !holds )
		{
			m_findings.fail( std::string( what ) + ": " + where() );
		}
	}
	std::string where() const
	{
		char text[400];
		int n = std::snprintf( text, sizeof text, "%s, truth [%.17Lg, %.17Lg], rounding %.3g", m_where.c_str(),
		    m_truth.lower, m_truth.upper, m_promise.rounding );
		if ( m_range != nullptr )
		{
			std::snprintf( text + n, sizeof text - static_cast<std::size_t>( n ),
			    ", range %.17g %.17g %.17g, got [%.17g, %.17g] class %d", m_range->min_d, m_range->max_d, m_range->alpha,
			    m_got->lower, m_got->upper, static_cast<int>( m_got->kind ) );
		}
		return text;
	}

	const ShapePair& m_pair;
	lw_query* m_query;
	Findings& m_findings;
	std::string m_where;
	exact::Promise m_promise;
	Stage m_width; ///< the stage of its widths
	exact::Enclosure m_truth;
	lw_clearance m_exact = lw_clearance_unknown();
	const lw_range* m_range = nullptr; ///< of the answer that is judged
	const lw_clearance* m_got = nullptr;
};

/// Some twenty questions about two random shapes, by either of the generators.
inline void judgeShapes( Random& random, Arrangement arrangement, std::uint64_t index, lw_query* query, Findings& findings,
    int least = -30, ShapePair ( *generate )( Random&, Arrangement, int ) = randomShapes )
{
	ShapePair pair = generate( random, arrangement, least );
	if ( pair.a.shape == nullptr || pair.b.shape == nullptr )
	{
		++findings.refused; // coordinates beyond 1e9 m
		return;
	}
	ShapeJudge( pair, index, query, findings ).run( random );
}
} // namespace extremes
