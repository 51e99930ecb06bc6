// SPDX-License-Identifier: BSD-3-Clause
// Certified distances of whole shapes at poses: all pairs of triangles, segments, points and boxes, in more than double precision.
#pragma once

#include "exact_triangles.hpp"
#include "leeway/distance.h"

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

/// What a shape is made of, in its frame. The faces of boxes are items too.
struct Body
{
	std::vector<Item> items;
	std::vector<Box> boxes;
	lw_shape_type type = LW_SHAPE_MESH;

	void addBox( const Box& box )
	{
		boxes.push_back( box );
		auto corner = [&]( int i ) -> lw_vec3
		{ return { i & 1 ? box.max[0] : box.min[0], i & 2 ? box.max[1] : box.min[1], i & 4 ? box.max[2] : box.min[2] }; };
		const int faces[12][3] = { { 0, 1, 3 }, { 0, 3, 2 }, { 4, 5, 7 }, { 4, 7, 6 }, { 0, 1, 5 }, { 0, 5, 4 }, { 2, 3, 7 }, { 2, 7, 6 },
			{ 0, 2, 6 }, { 0, 6, 4 }, { 1, 3, 7 }, { 1, 7, 5 } };
		for ( const int* f : faces )
		{
			items.push_back( { { corner( f[0] ), corner( f[1] ), corner( f[2] ) }, 0 } );
		}
	}

	/// Largest |coordinate|, radii included.
	double coordinates() const
	{
		double most = 0;
		for ( const Item& item : items )
		{
			for ( lw_vec3 v : item.v )
			{
				most = std::max( { most, std::abs( v.x ) + item.radius, std::abs( v.y ) + item.radius, std::abs( v.z ) + item.radius } );
			}
		}
		return most;
	}
};

/// The rotation that is meant by a matrix that is one to rounding, or to what lw_transform_is_valid() takes: its rows made orthonormal.
struct Rotation
{
	Vec<Wide> row[3];

	Rotation() : row{ { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } {}
	explicit Rotation( const lw_transform& m )
	{
		for ( int i = 0; i < 2; ++i )
		{
			row[i] = { m.r[i][0], m.r[i][1], m.r[i][2] };
		}
		row[0] = ( 1 / length( row[0] ) ) * row[0];
		for ( int i = 0; i < 2; ++i ) // the second time for what rounding left of the first
		{
			row[1] = row[1] - dot( row[0], row[1] ) * row[0];
			row[1] = ( 1 / length( row[1] ) ) * row[1];
		}
		row[2] = cross( row[0], row[1] );
	}
	Vec<Wide> operator()( lw_vec3 p ) const { return ( *this )( Vec<Wide>{ p.x, p.y, p.z } ); }
	Vec<Wide> operator()( Vec<Wide> v ) const { return { dot( row[0], v ), dot( row[1], v ), dot( row[2], v ) }; }
	Rotation operator*( const Rotation& other ) const
	{
		Rotation out;
		for ( int i = 0; i < 3; ++i )
		{
			out.row[i] = row[i].x * other.row[0] + row[i].y * other.row[1] + row[i].z * other.row[2];
		}
		return out;
	}
	Vec<Wide> back( Vec<Wide> v ) const { return v.x * row[0] + v.y * row[1] + v.z * row[2]; }
};

/// A rotation about a unit axis (Rodrigues).
inline Rotation turn( Vec<Wide> axis, Wide angle )
{
	Wide c = std::cos( angle ), s = std::sin( angle ), d = 1 - c;
	Rotation out;
	out.row[0] = { c + d * axis.x * axis.x, d * axis.x * axis.y - s * axis.z, d * axis.x * axis.z + s * axis.y };
	out.row[1] = { d * axis.x * axis.y + s * axis.z, c + d * axis.y * axis.y, d * axis.y * axis.z - s * axis.x };
	out.row[2] = { d * axis.x * axis.z - s * axis.y, d * axis.y * axis.z + s * axis.x, c + d * axis.z * axis.z };
	return out;
}

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
		p.reach = std::max( std::max( length( p.v[0] - p.center ), length( p.v[1] - p.center ) ), length( p.v[2] - p.center ) ) + item.radius;
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
			if ( p.x >= box.min[0] && p.x <= box.max[0] && p.y >= box.min[1] && p.y <= box.max[1] && p.z >= box.min[2] && p.z <= box.max[2] )
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

/// The distance of two bodies, [lower, upper], to about `width`; the poses are taken as the rotations that they mean.
inline Enclosure distance( const Body& a, const lw_transform& world_from_a, const Body& b, const lw_transform& world_from_b, double width )
{
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

/// What lw_clearance promises (leeway/distance.h), relative to the size of the question.
struct Promise
{
	double rounding; ///< 2^-46, and 1e-56 m: upper is not below the truth by more
	double width;    ///< upper - lower with alpha 0: the same, with boxes 1e-12 more
};

inline Promise promiseOf( const Body& a, const lw_transform& world_from_a, const Body& b, const lw_transform& world_from_b )
{
	double apart = 0;
	for ( int i = 0; i < 3; ++i )
	{
		apart = std::hypot( apart, world_from_b.t[i] - world_from_a.t[i] );
	}
	double size = apart + 3 * ( a.coordinates() + b.coordinates() );
	double boxes = a.boxes.empty() && b.boxes.empty() ? 0 : 1e-12;
	return { 0x1p-46 * size + 0x1p-186, ( 0x1p-46 + boxes ) * size + 0x1p-186 };
}
} // namespace exact
