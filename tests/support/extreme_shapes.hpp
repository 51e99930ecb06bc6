// SPDX-License-Identifier: BSD-3-Clause
// Pairs of shapes at poses at the extremes, with their parts: for tests and for long runs.
#pragma once

#include "exact_shapes.hpp"
#include "extreme_pairs.hpp"
#include "leeway/leeway.h"

#include <memory>
#include <vector>

namespace extremes
{
struct ReleaseShape
{
	void operator()( lw_shape* shape ) const { lw_shape_release( shape ); }
};

struct Subject
{
	std::unique_ptr<lw_shape, ReleaseShape> shape;
	exact::Body body;
};

/// Two shapes and where they are.
struct ShapePair
{
	Subject a, b;
	lw_transform world_from_a, world_from_b;
	const char* name;
	bool skewed =
	    false; ///< rotations that are ones to 1e-6 only: the meaning of a product of such is not the product of their meanings
};

enum Arrangement
{
	apart_by_a_gap,   ///< 1e-12 to 1e3 of the larger size
	touching_exactly, ///< a corner of one on the other; or faces, edges, corners shared
	overlapping,
	nested,
	coinciding, ///< the same geometry twice
	arrangement_count
};

constexpr const char* arrangement_names[arrangement_count] = { "apart", "touching", "overlapping", "nested", "coinciding" };

inline lw_transform randomRotation( Random& random )
{
	lw_transform m = lw_transform_identity();
	const double zero[3] = { 0, 0, 0 };
	double q[4];
	for ( double& c : q )
	{
		c = random.unit();
	}
	switch ( random.below( 6 ) )
	{
	case 0:
		return m;
	case 1: // a quarter turn, exactly
		m.r[0][0] = m.r[1][1] = 0;
		m.r[0][1] = -1;
		m.r[1][0] = 1;
		return m;
	case 2: // nearly none
		q[0] *= 1e-9, q[1] *= 1e-9, q[2] *= 1e-9;
		break;
	default:
		break;
	}
	lw_transform_from_quaternion( zero, q, &m );
	return m;
}

/// The parts of a body become a shape, with any kind of tree. @return null if the core refuses it
inline std::unique_ptr<lw_shape, ReleaseShape> makeShape( Random& random, const exact::Body& body )
{
	lw_tree_def tree = lw_tree_def_default();
	tree.fit = static_cast<lw_sphere_fit>( 1 + random.below( 3 ) );
	tree.leaf_size = 1 + random.below( 8 );
	std::vector<double> numbers;
	std::uint32_t count = static_cast<std::uint32_t>( body.items.size() );
	lw_shape* shape = nullptr;
	lw_status status = LW_ERROR_UNSUPPORTED;
	const exact::Item& first = body.items[0];
	switch ( body.type )
	{
	case LW_SHAPE_BOX:
	{
		const double edges[3] = { 2 * body.boxes[0].max[0], 2 * body.boxes[0].max[1], 2 * body.boxes[0].max[2] };
		status = lw_shape_create_primitive( LW_SHAPE_BOX, edges, nullptr, nullptr, &shape );
		break;
	}
	case LW_SHAPE_CAPSULE:
	{
		const double size[3] = { first.radius, 2 * first.v[1].z, 0 };
		status = lw_shape_create_primitive( LW_SHAPE_CAPSULE, size, nullptr, nullptr, &shape );
		break;
	}
	case LW_SHAPE_BOXES:
		status = lw_shape_create_boxes(
		    body.boxes[0].min, static_cast<std::uint32_t>( body.boxes.size() ), &tree, nullptr, nullptr, &shape );
		break;
	case LW_SHAPE_SPHERES:
		for ( const exact::Item& item : body.items )
		{
			numbers.insert( numbers.end(), { item.v[0].x, item.v[0].y, item.v[0].z, item.radius } );
		}
		status = lw_shape_create_spheres( numbers.data(), count, &tree, nullptr, nullptr, &shape );
		break;
	default:
	{
		std::vector<std::uint32_t> indices( 3 * body.items.size() );
		for ( std::uint32_t i = 0; i < 3 * count; ++i )
		{
			const lw_vec3& v = body.items[i / 3].v[i % 3];
			numbers.insert( numbers.end(), { v.x, v.y, v.z } );
			indices[i] = i;
		}
		lw_mesh_def def = lw_mesh_def_default();
		def.vertices = numbers.data();
		def.vertex_count = 3 * count;
		def.indices = indices.data();
		def.triangle_count = count;
		def.tree = tree;
		status = lw_shape_create_mesh( &def, nullptr, nullptr, &shape );
	}
	}
	return std::unique_ptr<lw_shape, ReleaseShape>( status == LW_OK ? shape : nullptr );
}

/// A body of about the size 1: soups of all kinds of triangles, grids that face each other, balls, boxes.
inline exact::Body randomBody( Random& random )
{
	exact::Body body;
	std::uint32_t kind = random.below( 9 ), count = 1 + random.below( kind == 0 ? 1 : 24 );
	double part = random.below( 3 ) == 0 ? 1 : random.octave( -40, 0 ); // size of the parts
	if ( kind == 8 )                                                    // a primitive: box, capsule
	{
		double x = random.octave( -20, 0 ), y = random.octave( -20, 0 ), z = random.octave( -20, 0 );
		body.type = random.below( 2 ) == 0 ? LW_SHAPE_BOX : LW_SHAPE_CAPSULE;
		if ( body.type == LW_SHAPE_BOX )
		{
			body.addBox( { { -x, -y, -z }, { x, y, z } } );
			return body;
		}
		body.items.push_back( { { { 0, 0, -z }, { 0, 0, z }, { 0, 0, z } }, x } );
		return body;
	}
	body.type = kind == 6 ? LW_SHAPE_SPHERES : kind == 7 ? LW_SHAPE_BOXES : LW_SHAPE_MESH;
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		lw_vec3 at = random.point();
		if ( kind == 6 ) // balls
		{
			body.items.push_back( { { at, at, at }, part * random.uniform( 0.1, 1 ) } );
			continue;
		}
		if ( kind == 7 ) // boxes, flat ones too
		{
			exact::Box box;
			const double c[3] = { at.x, at.y, at.z };
			for ( int k = 0; k < 3; ++k )
			{
				double edge = random.below( 4 ) == 0 ? 0 : part * random.uniform( 0, 1 );
				box.min[k] = c[k];
				box.max[k] = c[k] + edge;
			}
			body.addBox( box );
			i += 2;
			continue;
		}
		exact::Item item;
		item.radius = 0;
		std::uint32_t family = random.below( family_count );
		TrianglePair p = basicPair( random, static_cast<Family>( family ) );
		const lw_vec3* t = random.below( 2 ) == 0 ? p.a : p.b;
		for ( int k = 0; k < 3; ++k )
		{
			item.v[k] = plus( at, part, t[k] );
		}
		if ( kind == 5 ) // a sheet: z = 0 but for a few roundoffs
		{
			for ( lw_vec3& v : item.v )
			{
				v.z *= random.below( 2 ) == 0 ? 0 : 0x1p-50;
			}
		}
		body.items.push_back( item );
		if ( random.below( 8 ) == 0 )
		{
			body.items.push_back( item ); // duplicates
		}
	}
	return body;
}

/// Scaled by one factor, shifted before that.
inline void scaleBody( exact::Body& body, lw_vec3 shift, double factor )
{
	auto moved = [&]( double c, double s ) { return factor * ( c + s ); };
	for ( exact::Item& item : body.items )
	{
		for ( lw_vec3& v : item.v )
		{
			v = { moved( v.x, shift.x ), moved( v.y, shift.y ), moved( v.z, shift.z ) };
		}
		item.radius *= factor;
	}
	const double s[3] = { shift.x, shift.y, shift.z };
	for ( exact::Box& box : body.boxes )
	{
		for ( int k = 0; k < 3; ++k )
		{
			box.min[k] = moved( box.min[k], s[k] );
			box.max[k] = moved( box.max[k], s[k] );
		}
	}
}

/// Sizes from `least` octaves (1e-9 m by default) to 1e9 m, ratios to 1e12, offsets in the shapes' own frames and in the
/// world to 1e7.
inline ShapePair randomShapes( Random& random, Arrangement arrangement, int least = -30 )
{
	ShapePair p;
	p.name = arrangement_names[arrangement];
	p.a.body = randomBody( random );
	p.b.body = arrangement == coinciding ? p.a.body : randomBody( random );
	double size_a = random.below( 3 ) == 0 ? 1 : random.octave( least, 27 );
	double ratio = random.below( 2 ) == 0 || arrangement == coinciding ? 1 : random.octave( -40, 40 );
	double size_b = std::fmin( std::fmax( size_a * ratio, std::ldexp( 1.0, least - 10 ) ), 0x1p27 );
	lw_vec3 none = { 0, 0, 0 }, own = none;
	if ( random.below( 4 ) == 0 ) // stored far from their frame's origin
	{
		own = random.point();
		double far = random.octave( 0, 20 );
		double most = 0x1p29 / std::fmax( size_a, size_b ); // stay within 1e9 m
		far = std::fmin( far, most );
		own = { far * own.x, far * own.y, far * own.z };
	}
	bool primitive = p.a.body.type == LW_SHAPE_BOX || p.a.body.type == LW_SHAPE_CAPSULE; // these are about their origins
	scaleBody( p.a.body, primitive ? none : own, size_a );
	scaleBody( p.b.body, arrangement == coinciding && !primitive ? own : none, size_b );
	p.a.shape = makeShape( random, p.a.body );
	p.b.shape = makeShape( random, p.b.body );

	p.world_from_a = randomRotation( random );
	p.world_from_b = arrangement == coinciding ? p.world_from_a : randomRotation( random );
	double larger = std::fmax( size_a, size_b ), smaller = std::fmin( size_a, size_b );
	// a place near a: a corner of it, or anywhere around
	const exact::Item& item = p.a.body.items[random.below( static_cast<std::uint32_t>( p.a.body.items.size() ) )];
	const exact::Item& mine = p.b.body.items[random.below( static_cast<std::uint32_t>( p.b.body.items.size() ) )];
	lw_vec3 target = arrangement == nested ? plus( item.v[0], 0.1 * size_a, random.point() ) : pointOf( random, item.v );
	lw_vec3 at = lw_transform_point( &p.world_from_a, target ), from = lw_transform_point( &p.world_from_b, mine.v[0] );
	double gap = 0;
	if ( arrangement == apart_by_a_gap )
	{
		gap = random.below( 2 ) == 0 ? larger * random.octave( -40, 10 ) : smaller * random.octave( -40, 10 );
		gap = std::fmin( gap, 0x1p30 );
	}
	if ( arrangement == overlapping )
	{
		gap = smaller * 0.5 * random.unit();
	}
	lw_vec3 t = plus( minus( at, from ), gap, random.point() );
	double world = random.below( 2 ) == 0 ? 0 : random.octave( 0, 24 );
	lw_vec3 offset = random.point();
	const double c[3] = { t.x, t.y, t.z }, o[3] = { world * offset.x, world * offset.y, world * offset.z };
	for ( int k = 0; k < 3; ++k )
	{
		p.world_from_a.t[k] = o[k];
		p.world_from_b.t[k] = arrangement == coinciding ? o[k] : c[k] + o[k];
	}
	return p;
}
} // namespace extremes
