// SPDX-License-Identifier: BSD-3-Clause
// Certified distances of whole shapes at poses: all pairs of triangles, segments, points and boxes, or of convex pieces, in
// more than double precision.
#pragma once

#include "exact_convex.hpp"
#include "leeway/distance.h"

#include <cstdint>
#include <vector>

namespace exact
{
/// A triangle (or segment, or point) with a radius around it.
struct Item
{
	lw_vec3 v[3];
	double radius;
};

/// A solid box along the axes of the shape frame.
struct Box
{
	double min[3], max[3];
};

/// The parts of a shape, in its frame: items and boxes, whose faces are items too; or pieces.
struct Body
{
	std::vector<Item> items; ///< of a body of pieces only if it is a solid mesh: its faces
	std::vector<Box> boxes;
	std::vector<Piece> pieces;
	lw_shape_type type = LW_SHAPE_MESH;

	bool isSolidMesh() const { return type == LW_SHAPE_MESH && !items.empty() && !pieces.empty(); }
	bool isOfBoxes() const { return type == LW_SHAPE_BOX || type == LW_SHAPE_BOXES; }
	bool isCurved() const { return type == LW_SHAPE_CYLINDER || type == LW_SHAPE_CONE; }

	void addBox( const Box& box )
	{
		boxes.push_back( box );
		auto corner = [&]( int i ) -> lw_vec3 {
			return { i & 1 ? box.max[0] : box.min[0], i & 2 ? box.max[1] : box.min[1], i & 4 ? box.max[2] : box.min[2] };
		};
		const int faces[12][3] = { { 0, 1, 3 }, { 0, 3, 2 }, { 4, 5, 7 }, { 4, 7, 6 }, { 0, 1, 5 }, { 0, 5, 4 }, { 2, 3, 7 },
		    { 2, 7, 6 }, { 0, 2, 6 }, { 0, 6, 4 }, { 1, 3, 7 }, { 1, 7, 5 } };
		for ( const int* f : faces )
		{
			items.push_back( { { corner( f[0] ), corner( f[1] ), corner( f[2] ) }, 0 } );
		}
	}

	/// Largest |coordinate|, radii included.
	double coordinates() const
	{
		double most = 0;
		for ( const Piece& piece : pieces )
		{
			most = std::max( most, piece.coordinates() );
		}
		for ( const Item& item : items )
		{
			for ( lw_vec3 v : item.v )
			{
				most = std::max(
				    { most, std::abs( v.x ) + item.radius, std::abs( v.y ) + item.radius, std::abs( v.z ) + item.radius } );
			}
		}
		return most;
	}
};

/// An item in the world, about the origin of the first shape.
struct Placed
{
	Vec<Wide> v[3];
	double radius;
	Vec<Wide> center;
	Wide reach; ///< of the item about it
};

inline std::vector<Placed> place( const Body& body, const Rotation& rotation, Vec<Wide> offset )
{
	std::vector<Placed> out;
	out.reserve( body.items.size() );
	for ( const Item& item : body.items )
	{
		Placed p;
		p.radius = item.radius;
		for ( int i = 0; i < 3; ++i )
		{
			p.v[i] = rotation( item.v[i] ) + offset;
		}
		p.center = ( 1 / Wide( 3 ) ) * ( p.v[0] + p.v[1] + p.v[2] );
		p.reach =
		    std::max( std::max( length( p.v[0] - p.center ), length( p.v[1] - p.center ) ), length( p.v[2] - p.center ) ) +
		    item.radius;
		out.push_back( p );
	}
	return out;
}

/// True if a corner of an item is in a box of the body that is turned by `rotation` and shifted by `offset`.
inline bool isInside( const std::vector<Placed>& items, const Body& body, const Rotation& rotation, Vec<Wide> offset )
{
	for ( const Placed& item : items )
	{
		Vec<Wide> p = rotation.back( item.v[0] - offset );
		for ( const Box& box : body.boxes )
		{
			if ( p.x >= box.min[0] && p.x <= box.max[0] && p.y >= box.min[1] && p.y <= box.max[1] && p.z >= box.min[2] &&
			     p.z <= box.max[2] )
			{
				return true;
			}
		}
	}
	return false;
}

/// Lowers an enclosure to the distance of two sets of items in one frame.
inline void lowerTo( Enclosure& best, const std::vector<Placed>& pa, const std::vector<Placed>& pb, double width )
{
	for ( const Placed& x : pa )
	{
		for ( const Placed& y : pb )
		{
			Wide apart = length( y.center - x.center ) - x.reach - y.reach;
			if ( apart * ( 1 - 64 * Unit<Wide>::roundoff ) - width >= best.upper )
			{
				continue;
			}
			Enclosure one = distance( x.v, y.v, width );
			Wide radii = Wide( x.radius ) + y.radius;
			best.lower = std::min( best.lower, std::max<Wide>( 0, one.lower - radii ) );
			best.upper = std::min( best.upper, std::max<Wide>( 0, one.upper - radii ) );
			best.effort = std::max( best.effort, one.effort );
		}
	}
}

/// The distance of two bodies, [lower, upper], to about `width`; the poses are taken as the rotations that they mean. Both
/// are of pieces, or neither.
inline Enclosure distance(
    const Body& a, const lw_transform& world_from_a, const Body& b, const lw_transform& world_from_b, double width )
{
	if ( !a.pieces.empty() )
	{
		Quad between[3];
		for ( int k = 0; k < 3; ++k )
		{
			between[k] = Quad( world_from_b.t[k] ) - world_from_a.t[k];
		}
		return distance( PieceSet( a.pieces, world_from_a, { 0, 0, 0 } ),
		    PieceSet( b.pieces, world_from_b, { between[0], between[1], between[2] } ), width );
	}
	Rotation ra( world_from_a ), rb( world_from_b );
	Vec<Wide> none = { 0, 0, 0 };
	Vec<Wide> offset = { Wide( world_from_b.t[0] ) - world_from_a.t[0], Wide( world_from_b.t[1] ) - world_from_a.t[1],
	    Wide( world_from_b.t[2] ) - world_from_a.t[2] };
	std::vector<Placed> pa = place( a, ra, none ), pb = place( b, rb, offset );
	if ( isInside( pa, b, rb, offset ) || isInside( pb, a, ra, none ) )
	{
		return { 0, 0, 0 };
	}
	Enclosure best = { INFINITY, INFINITY, 0 };
	lowerTo( best, pa, pb, width );
	// moving the corners: nine roundoffs of each, four of the offset between the frames
	Wide moved = 16 * Unit<Wide>::roundoff * ( Wide( a.coordinates() ) + b.coordinates() + length( offset ) );
	return { std::max<Wide>( 0, best.lower - moved ), best.upper + moved, best.effort };
}

/// How far a point (shape frame) is from an element of a body of pieces, or from all of it; at most, and to about `width`.
inline Wide outside( const Body& body, lw_vec3 p, std::uint32_t element, double width )
{
	if ( body.pieces[0].isUnbounded() )
	{
		return body.type == LW_SHAPE_PLANE ? std::abs( p.z ) : std::max( 0.0, p.z );
	}
	std::vector<Piece> point( 1 ), only;
	point[0].points = { p };
	if ( element != LW_INVALID_INDEX && body.isSolidMesh() )
	{
		only.emplace_back();
		only[0].points.assign( body.items[element].v, body.items[element].v + 3 );
	}
	else if ( element != LW_INVALID_INDEX )
	{
		only.push_back( body.pieces[element] );
	}
	const lw_transform here = lw_transform_identity();
	return distance(
	    PieceSet( only.empty() ? body.pieces : only, here, { 0, 0, 0 } ), PieceSet( point, here, { 0, 0, 0 } ), width )
	    .upper;
}

/// The promise of lw_clearance (leeway/distance.h), relative to the size of the question.
struct Promise
{
	double rounding; ///< 2^-46, and 1e-56 m: upper is not below the truth by more
	double width;    ///< upper - lower with alpha 0: the same, with boxes 1e-12 more, with cylinders and cones 1e-10
};

inline Promise promiseOf( const Body& a, const lw_transform& world_from_a, const Body& b, const lw_transform& world_from_b )
{
	double apart = 0;
	for ( int i = 0; i < 3; ++i )
	{
		apart = std::hypot( apart, world_from_b.t[i] - world_from_a.t[i] );
	}
	double size = apart + 3 * ( a.coordinates() + b.coordinates() );
	double wider = a.isCurved() || b.isCurved() ? 1e-10 : a.isOfBoxes() || b.isOfBoxes() ? 1e-12 : 0;
	return { 0x1p-46 * size + 0x1p-186, ( 0x1p-46 + wider ) * size + 0x1p-186 };
}
} // namespace exact
