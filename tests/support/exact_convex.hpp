// SPDX-License-Identifier: BSD-3-Clause
// Certified distances of convex pieces, independent of the engine: hulls of points, cylinders, cones, all with a radius
// around them, and half-spaces and planes.
//
// The code measures the difference of two pieces, which support functions describe. A point of a simplex of its
// support points bounds the distance from above, whatever chose it; the support plane across any direction bounds it from
// below. Both are found by the iteration of Gilbert, Johnson and Keerthi (1988) with the projection onto triangles of
// exact_triangles.hpp, first in 64 bits, then in 113; neither is trusted for having been found: the interval holds.
#pragma once

#include "exact_rotation.hpp"

#include <vector>

namespace exact
{
/// In the frame of its shape.
struct Piece
{
	enum Kind
	{
		hull,      ///< of its points
		cylinder,  ///< about z
		cone,      ///< about z, apex at +half
		halfspace, ///< z <= 0
		plane      ///< z = 0
	};
	Kind kind = hull;
	std::vector<lw_vec3> points;
	double r = 0, half = 0; ///< radius and half the height of cylinder and cone
	double radius = 0;      ///< around all of it

	bool isUnbounded() const { return kind == halfspace || kind == plane; }
	/// Largest |coordinate|, radius included; 0 if unbounded.
	double coordinates() const
	{
		double most = std::max( r, half );
		for ( lw_vec3 p : points )
		{
			most = std::max( { most, std::abs( p.x ), std::abs( p.y ), std::abs( p.z ) } );
		}
		return most + radius;
	}
};

/// A bounded piece in the world, without its radius.
template <class R> struct PlacedPiece
{
	Piece::Kind kind;
	std::vector<Vec<R>> points;
	Vec<R> center, axis;
	R r, half, reach; ///< nothing is farther than reach from the centre

	PlacedPiece( const Piece& piece, const RotationOf<R>& rotation, Vec<R> offset )
	    : kind( piece.kind ), center( offset ), axis( rotation( Vec<R>{ 0, 0, 1 } ) ), r( piece.r ), half( piece.half ),
	      reach( r + half )
	{
		for ( lw_vec3 p : piece.points )
		{
			points.push_back( rotation( p ) + offset );
		}
		if ( kind == Piece::hull )
		{
			center = points[0];
			for ( const Vec<R>& p : points )
			{
				R d = length( p - center );
				reach = d > reach ? d : reach;
			}
		}
	}

	/// A point that is farthest along n, which is not 0: off the piece, and short of the farthest, by a few roundoffs of its
	/// size.
	Vec<R> support( Vec<R> n ) const
	{
		if ( kind == Piece::hull )
		{
			const Vec<R>* best = &points[0];
			R most = dot( n, points[0] - center );
			for ( const Vec<R>& p : points )
			{
				R along = dot( n, p - center );
				best = along > most ? &p : best;
				most = along > most ? along : most;
			}
			return *best;
		}
		R along = dot( n, axis );
		Vec<R> flat = n - along * axis;
		flat = flat - dot( flat, axis ) * axis;
		R rho = length( flat );
		rho = rho > 16 * R( Unit<R>::roundoff ) * length( n ) ? rho
		                                                      : R( 0 ); // else it is all rounding, and leads out of the disc
		Vec<R> rim = rho > 0 ? center + ( r / rho ) * flat : center;
		if ( kind == Piece::cylinder )
		{
			return rim + ( along < 0 ? -half : half ) * axis;
		}
		return half * along >= r * rho - half * along ? center + half * axis : rim - half * axis;
	}
};

/// Up to four points whose hull is looked at.
template <class R> struct Simplex
{
	Vec<R> w[4];
	int count = 0;
};

template <class R> inline R determinant( Vec<R> a, Vec<R> b, Vec<R> c )
{
	return dot( a, cross( b, c ) );
}

template <class R> inline Vec<R> weighted( const Simplex<R>& s, const R weight[4] )
{
	return weight[0] * s.w[0] + weight[1] * s.w[1] + weight[2] * s.w[2] + weight[3] * s.w[3];
}

/// If four points surround the origin: the size of a point of their hull, 0 but for rounding; else infinity. Weights from
/// determinants of a flat simplex have few digits, so what is left of the point is taken off again, some times.
template <class R> inline R surrounds( const Simplex<R>& s, R enough )
{
	const Vec<R> e[3] = { s.w[1] - s.w[0], s.w[2] - s.w[0], s.w[3] - s.w[0] };
	R volume = determinant( e[0], e[1], e[2] );
	R weight[4] = { 1, 0, 0, 0 };
	Vec<R> left = s.w[0];
	for ( int round = 0; round < 6 && volume != 0; ++round )
	{
		const R part[3] = { determinant( left, e[1], e[2] ) / volume, determinant( e[0], left, e[2] ) / volume,
		    determinant( e[0], e[1], left ) / volume };
		for ( int i = 0; i < 3; ++i )
		{
			weight[i + 1] = weight[i + 1] - part[i];
		}
		weight[0] = 1 - weight[1] - weight[2] - weight[3];
		left = weighted( s, weight );
		if ( length( left ) <= enough )
		{
			// the origin may be on a face, and beyond it by rounding
			R sum = 0;
			for ( R& w : weight )
			{
				w = w > 0 ? w : R( 0 );
				sum = sum + w;
			}
			R inside = length( weighted( s, weight ) ) / sum;
			return inside <= enough ? inside : R( INFINITY );
		}
	}
	return R( INFINITY );
}

/// The point of the simplex's faces that is nearest to the origin, to rounding; the rest of the simplex is dropped.
template <class R> inline Vec<R> reduce( Simplex<R>& s )
{
	const Vec<R> origin = { 0, 0, 0 };
	const int faces[4][3] = { { 0, 1, 2 }, { 0, 1, 3 }, { 0, 2, 3 }, { 1, 2, 3 } };
	Foot<R> best = { origin, R( INFINITY ), -1 };
	const int* face = nullptr;
	int few[3] = { 0, s.count > 1 ? 1 : 0, s.count > 2 ? 2 : s.count > 1 ? 1 : 0 };
	for ( int i = 0; i < ( s.count == 4 ? 4 : 1 ); ++i )
	{
		const int* corners = s.count == 4 ? faces[i] : few;
		const Vec<R> t[3] = { s.w[corners[0]], s.w[corners[1]], s.w[corners[2]] };
		Foot<R> foot = nearestPoint( t, origin );
		if ( face == nullptr || foot.square < best.square )
		{
			best = foot;
			face = corners;
		}
	}
	Simplex<R> kept;
	int on = best.corner, first = on < 0 ? 0 : on % 3, count = on < 0 ? 3 : on < 3 ? 2 : 1;
	for ( int i = 0; i < count; ++i )
	{
		kept.w[kept.count++] = s.w[face[( first + i ) % 3]];
	}
	s = kept;
	return best.point;
}

/// Between two pieces without their radii; before rounding.
/// @param width that will do. @param enough a lower bound that will do
template <class R> inline Bounds<R> between( const PlacedPiece<R>& a, const PlacedPiece<R>& b, R width, R enough )
{
	Bounds<R> out;
	Vec<R> v = a.center - b.center;
	v = dot( v, v ) > 0 ? v : Vec<R>{ 1, 0, 0 };
	Simplex<R> simplex;
	Vec<R> w = { 0, 0, 0 };
	int stalled = 0;
	for ( int i = 0; i < 400; ++i )
	{
		// if v is normal to an edge, several points are equally far along v: after a stall, tilt v to get another one of them
		Vec<R> along = stalled > 0 ? v + ( std::ldexp( 1.0, -60 + 4 * stalled ) * length( v ) / length( w ) ) * w : v;
		w = a.support( R( -1 ) * along ) - b.support( along );
		R gap = dot( along, w ) / length( along );
		out.lower = gap > out.lower ? gap : out.lower;
		if ( out.upper - out.lower <= width || out.lower >= enough )
		{
			break;
		}
		simplex.w[simplex.count++] = w;
		R inside = simplex.count == 4 ? surrounds( simplex, width ) : R( INFINITY );
		if ( inside <= width )
		{
			out.upper = inside < out.upper ? inside : out.upper;
			break;
		}
		Vec<R> next = reduce( simplex );
		R upper = length( next );
		stalled = upper < out.upper ? 0 : stalled + 1;
		if ( stalled > 8 ) // nothing is gained any more in this arithmetic
		{
			break;
		}
		upper = upper < out.upper ? upper : out.upper;
		out.upper = upper;
		v = next;
		if ( !( upper > 0 ) || out.upper - out.lower <= width )
		{
			break;
		}
	}
	return out;
}

/// The widening of bounds between pieces, in terms of a size that all coordinates are within: rotating a corner is
/// 16 roundoffs of it (5 of them of the rotation itself), a rim 8 more, a difference 2, a foot 14, lengths and products with
/// directions 7.
template <class R> inline R convexError( R size )
{
	return 64 * R( Unit<R>::roundoff ) * size;
}

/// Heights of a piece above a plane; radius included.
template <class R>
inline Enclosure heightAbove( const Piece& plane, const RotationOf<R>& plane_rotation, Vec<R> plane_offset,
    const Piece& piece, const PlacedPiece<R>& placed, R size )
{
	Vec<R> normal = plane_rotation( Vec<R>{ 0, 0, 1 } );
	R low = dot( normal, placed.support( R( -1 ) * normal ) - plane_offset ) - piece.radius;
	R high = dot( normal, placed.support( normal ) - plane_offset ) + piece.radius;
	R d = low > 0 ? low : plane.kind == Piece::plane && high < 0 ? -high : R( 0 );
	Bounds<R> bounds;
	bounds.lower = bounds.upper = d;
	R error = convexError( size );
	Wide lower = d > error ? static_cast<Wide>( d - error ) : 0, upper = static_cast<Wide>( d + error );
	return { lower * ( 1 - 2 * Unit<Wide>::roundoff ), upper * ( 1 + 2 * Unit<Wide>::roundoff ), 2 };
}

/// Two bounded pieces with their radii.
template <class R>
inline Enclosure distance(
    const PlacedPiece<R>& a, const PlacedPiece<R>& b, R radii, R size, double width, Wide enough, int effort )
{
	R beyond = R( enough ) + radii, error = convexError( size );
	Bounds<R> bounds = between( a, b, R( width ) - 2 * error > 0 ? R( width ) - 2 * error : R( 0 ), 2 * error + beyond );
	R lower = bounds.lower - error - radii, upper = bounds.upper + error - radii;
	upper = upper > error ? upper : error; // never exactly 0: the radii round too
	Wide low = lower > 0 ? static_cast<Wide>( lower ) : 0, high = static_cast<Wide>( upper );
	return { low * ( 1 - 2 * Unit<Wide>::roundoff ), high * ( 1 + 2 * Unit<Wide>::roundoff ), effort };
}

/// All pieces of a shape at a pose, about the origin of the first shape's frame.
struct PieceSet
{
	const std::vector<Piece>& pieces;
	const lw_transform& pose;
	Vec<Quad> offset;
	double coordinates = 0;

	PieceSet( const std::vector<Piece>& list, const lw_transform& world_from_shape, Vec<Quad> from_first )
	    : pieces( list ), pose( world_from_shape ), offset( from_first )
	{
		for ( const Piece& piece : list )
		{
			coordinates = std::max( coordinates, piece.coordinates() );
		}
	}
	template <class R> PlacedPiece<R> place( const Piece& piece ) const
	{
		return PlacedPiece<R>( piece, RotationOf<R>( pose ), { R( offset.x ), R( offset.y ), R( offset.z ) } );
	}
};

/// The distance of two sets of pieces, as enclosed as 64 bits can or 113 need.
inline Enclosure distance( const PieceSet& a, const PieceSet& b, double width )
{
	Quad size = length( b.offset - a.offset ) + 2 * Quad( a.coordinates ) + 2 * Quad( b.coordinates );
	Enclosure best = { INFINITY, INFINITY, 0 };
	std::vector<PlacedPiece<Wide>> placed_b;
	for ( const Piece& piece : b.pieces )
	{
		placed_b.push_back( b.place<Wide>( piece ) );
	}
	for ( const Piece& x : a.pieces )
	{
		const PlacedPiece<Wide> pa = a.place<Wide>( x );
		for ( const Piece& y : b.pieces )
		{
			const PlacedPiece<Wide>& pb = placed_b[static_cast<std::size_t>( &y - b.pieces.data() )];
			Enclosure one;
			if ( x.isUnbounded() || y.isUnbounded() )
			{
				one = x.isUnbounded() ? heightAbove( x, RotationOf<Quad>( a.pose ), a.offset, y, b.place<Quad>( y ), size )
				                      : heightAbove( y, RotationOf<Quad>( b.pose ), b.offset, x, a.place<Quad>( x ), size );
			}
			else
			{
				double radii = x.radius + y.radius; // of culled pieces; it rounds
				if ( ( length( pb.center - pa.center ) - pa.reach - pb.reach - radii ) * ( 1 - 0x1p-40L ) >= best.upper )
				{
					continue;
				}
				one = distance<Wide>( pa, pb, Wide( x.radius ) + y.radius, static_cast<Wide>( size ), width, best.upper, 1 );
				if ( one.upper - one.lower > width && one.lower < best.upper )
				{
					Enclosure better = distance<Quad>(
					    a.place<Quad>( x ), b.place<Quad>( y ), Quad( x.radius ) + y.radius, size, width, best.upper, 2 );
					one = { std::max( one.lower, better.lower ), std::min( one.upper, better.upper ), 2 };
				}
			}
			best.lower = std::min( best.lower, one.lower );
			best.upper = std::min( best.upper, one.upper );
			best.effort = std::max( best.effort, one.effort );
		}
	}
	return best;
}
} // namespace exact
