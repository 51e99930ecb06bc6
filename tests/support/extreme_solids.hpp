// SPDX-License-Identifier: BSD-3-Clause
// Pairs of all types of shape at poses at the extremes, as convex pieces: primitives, sets, triangles, solid meshes,
// half-spaces and planes. Beside extreme_shapes.hpp, whose larger meshes have an oracle that is quicker.
#pragma once

#include "extreme_shapes.hpp"

namespace extremes
{
constexpr lw_shape_type solid_types[] = { LW_SHAPE_MESH, LW_SHAPE_MESH, LW_SHAPE_POINTS, LW_SHAPE_BOX, LW_SHAPE_SPHERE,
    LW_SHAPE_CYLINDER, LW_SHAPE_CAPSULE, LW_SHAPE_CONE, LW_SHAPE_SPHERES, LW_SHAPE_BOXES, LW_SHAPE_HALFSPACE,
    LW_SHAPE_PLANE };
constexpr std::uint32_t solid_type_count = 12, bounded_type_count = 10;

inline exact::Piece ballPiece( lw_vec3 at, double radius )
{
	exact::Piece piece;
	piece.points = { at };
	piece.radius = radius;
	return piece;
}

inline exact::Piece boxPiece( const double min[3], const double max[3] )
{
	exact::Piece piece;
	for ( int i = 0; i < 8; ++i )
	{
		piece.points.push_back( { i & 1 ? max[0] : min[0], i & 2 ? max[1] : min[1], i & 4 ? max[2] : min[2] } );
	}
	return piece;
}

/// A piece of a solid mesh with its faces: a tetrahedron of any shape, or a box, which has pairs of faces in one plane.
inline void addSolid( Random& random, lw_vec3 at, double part, exact::Body& body )
{
	if ( random.below( 3 ) == 0 )
	{
		exact::Body box; // knows its faces
		const double a[3] = { at.x, at.y, at.z };
		exact::Box edges;
		for ( int k = 0; k < 3; ++k )
		{
			edges.min[k] = a[k];
			edges.max[k] = a[k] + part * random.octave( -12, 1 );
		}
		box.addBox( edges );
		body.items.insert( body.items.end(), box.items.begin(), box.items.end() );
		body.pieces.push_back( boxPiece( edges.min, edges.max ) );
		return;
	}
	exact::Piece piece;
	lw_vec3 t[4];
	random.below( 3 ) == 0 ? randomNeedle( random, t ) : randomTriangle( random, t );
	t[3] = random.below( 3 ) == 0 ? plus( pointOf( random, t ), random.octave( -40, 0 ), unitNormal( t ) ) : random.point();
	for ( lw_vec3& v : t )
	{
		v = plus( at, part, v );
		piece.points.push_back( v );
	}
	const int faces[4][3] = { { 0, 1, 2 }, { 0, 1, 3 }, { 0, 2, 3 }, { 1, 2, 3 } };
	for ( const int* f : faces )
	{
		body.items.push_back( { { t[f[0]], t[f[1]], t[f[2]] }, 0 } );
	}
	body.pieces.push_back( piece );
}

/// Of about the size 1; plates, wires and needles to an aspect of 2^40. `kind` is an index of solid_types; 1 is a solid
/// mesh.
inline exact::Body randomPieces( Random& random, std::uint32_t kind )
{
	exact::Body body;
	body.type = solid_types[kind];
	exact::Piece piece;
	double size[3], part = random.below( 3 ) == 0 ? random.octave( -30, 0 ) : 1;
	for ( double& c : size )
	{
		c = random.below( 3 ) == 0 ? random.octave( -40, 0 ) : random.octave( -4, 0 );
	}
	std::uint32_t count = 1 + ( random.below( 2 ) == 0 ? 0 : random.below( 5 ) );
	switch ( body.type )
	{
	case LW_SHAPE_BOX:
	{
		const double min[3] = { -size[0], -size[1], -size[2] };
		body.pieces.push_back( boxPiece( min, size ) );
		return body;
	}
	case LW_SHAPE_SPHERE:
		body.pieces.push_back( ballPiece( { 0, 0, 0 }, size[0] ) );
		return body;
	case LW_SHAPE_CAPSULE:
		piece.points = { { 0, 0, -size[1] }, { 0, 0, size[1] } };
		piece.radius = size[0];
		body.pieces.push_back( piece );
		return body;
	case LW_SHAPE_CYLINDER:
	case LW_SHAPE_CONE:
		piece.kind = body.type == LW_SHAPE_CONE ? exact::Piece::cone : exact::Piece::cylinder;
		piece.r = size[0];
		piece.half = size[1];
		body.pieces.push_back( piece );
		return body;
	case LW_SHAPE_HALFSPACE:
	case LW_SHAPE_PLANE:
		piece.kind = body.type == LW_SHAPE_PLANE ? exact::Piece::plane : exact::Piece::halfspace;
		body.pieces.push_back( piece );
		return body;
	default:
		break;
	}
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		lw_vec3 at = random.point();
		switch ( body.type )
		{
		case LW_SHAPE_POINTS:
			body.pieces.push_back( ballPiece( at, size[0] ) );
			break;
		case LW_SHAPE_SPHERES:
			body.pieces.push_back( ballPiece( at, part * random.uniform( 0, 1 ) ) );
			break;
		case LW_SHAPE_BOXES:
		{
			const double min[3] = { at.x, at.y, at.z };
			const double max[3] = { at.x + part * size[0], at.y + part * size[1], at.z + part * size[2] };
			body.pieces.push_back( boxPiece( min, max ) );
			break;
		}
		default:
			if ( kind == 1 )
			{
				addSolid( random, at, part, body );
				break;
			}
			TrianglePair p = basicPair( random, static_cast<Family>( random.below( family_count ) ) );
			piece.points.clear();
			for ( const lw_vec3& v : p.a )
			{
				piece.points.push_back( plus( at, part, v ) );
			}
			body.pieces.push_back( piece );
		}
	}
	return body;
}

inline void scalePieces( exact::Body& body, lw_vec3 shift, double factor )
{
	auto moved = [&]( lw_vec3 v ) -> lw_vec3 {
		return { factor * ( v.x + shift.x ), factor * ( v.y + shift.y ), factor * ( v.z + shift.z ) };
	};
	for ( exact::Item& item : body.items )
	{
		for ( lw_vec3& v : item.v )
		{
			v = moved( v );
		}
	}
	for ( exact::Piece& piece : body.pieces )
	{
		for ( lw_vec3& v : piece.points )
		{
			v = moved( v );
		}
		piece.r *= factor;
		piece.half *= factor;
		piece.radius *= factor;
	}
}

/// @return null if the core refuses it
inline std::unique_ptr<lw_shape, ReleaseShape> makeSolid( Random& random, const exact::Body& body )
{
	lw_tree_def tree = lw_tree_def_default();
	tree.fit = static_cast<lw_sphere_fit>( 1 + random.below( 3 ) );
	tree.leaf_size = 1 + random.below( 8 );
	const exact::Piece& first = body.pieces[0];
	std::uint32_t count = static_cast<std::uint32_t>( body.pieces.size() );
	std::vector<double> numbers;
	lw_shape* shape = nullptr;
	lw_status status = LW_ERROR_UNSUPPORTED;
	double size[3] = { 0, 0, 0 };
	switch ( body.type )
	{
	case LW_SHAPE_MESH:
	{
		std::vector<std::uint32_t> indices;
		auto add = [&]( lw_vec3 v )
		{
			indices.push_back( static_cast<std::uint32_t>( indices.size() ) );
			numbers.insert( numbers.end(), { v.x, v.y, v.z } );
		};
		for ( const exact::Item& item : body.items )
		{
			std::for_each( item.v, item.v + 3, add );
		}
		for ( const exact::Piece& piece : body.pieces )
		{
			if ( body.items.empty() )
			{
				std::for_each( piece.points.begin(), piece.points.end(), add );
			}
		}
		lw_mesh_def def = lw_mesh_def_default();
		def.vertices = numbers.data();
		def.indices = indices.data();
		def.vertex_count = static_cast<std::uint32_t>( indices.size() );
		def.triangle_count = def.vertex_count / 3;
		def.solid = body.isSolidMesh();
		def.tree = tree;
		status = lw_shape_create_mesh( &def, nullptr, nullptr, &shape );
		break;
	}
	case LW_SHAPE_POINTS:
	case LW_SHAPE_SPHERES:
		for ( const exact::Piece& piece : body.pieces )
		{
			numbers.insert( numbers.end(), { piece.points[0].x, piece.points[0].y, piece.points[0].z } );
			if ( body.type == LW_SHAPE_SPHERES )
			{
				numbers.push_back( piece.radius );
			}
		}
		status = body.type == LW_SHAPE_POINTS
		             ? lw_shape_create_points( numbers.data(), count, first.radius, &tree, nullptr, nullptr, &shape )
		             : lw_shape_create_spheres( numbers.data(), count, &tree, nullptr, nullptr, &shape );
		break;
	case LW_SHAPE_BOXES:
		for ( const exact::Piece& piece : body.pieces )
		{
			const lw_vec3 &min = piece.points[0], &max = piece.points[7];
			numbers.insert( numbers.end(), { min.x, min.y, min.z, max.x, max.y, max.z } );
		}
		status = lw_shape_create_boxes( numbers.data(), count, &tree, nullptr, nullptr, &shape );
		break;
	default:
		if ( body.type == LW_SHAPE_BOX )
		{
			size[0] = 2 * first.points[7].x, size[1] = 2 * first.points[7].y, size[2] = 2 * first.points[7].z;
		}
		else
		{
			size[0] = body.isCurved() ? first.r : first.radius;
			size[1] = body.isCurved() ? 2 * first.half : body.type == LW_SHAPE_CAPSULE ? 2 * first.points[1].z : 0;
		}
		status = lw_shape_create_primitive( body.type, first.isUnbounded() ? nullptr : size, nullptr, nullptr, &shape );
	}
	return std::unique_ptr<lw_shape, ReleaseShape>( status == LW_OK ? shape : nullptr );
}

/// The point of a piece that is farthest along n (world), of a shape at a pose without its shift; of an unbounded one a
/// point beside its origin, by up to 2^24.
inline lw_vec3 farthest( Random& random, const exact::Piece& piece, const lw_transform& pose, lw_vec3 n )
{
	if ( piece.isUnbounded() )
	{
		double lever = random.below( 2 ) == 0 ? 0 : random.octave( -24, 24 );
		lw_vec3 p = random.point();
		return lw_transform_point( &pose, { lever * p.x, lever * p.y, 0 } );
	}
	exact::PlacedPiece<exact::Wide> placed( piece, exact::Rotation( pose ), { 0, 0, 0 } );
	exact::Vec<exact::Wide> p = placed.support( { n.x, n.y, n.z } );
	return plus( { static_cast<double>( p.x ), static_cast<double>( p.y ), static_cast<double>( p.z ) }, piece.radius, n );
}

/// A rotation as far from one as lw_transform_is_valid() accepts, or less.
inline void skew( Random& random, lw_transform& pose )
{
	double by = random.octave( -52, -22 );
	for ( double( &row )[3] : pose.r )
	{
		for ( double& c : row )
		{
			c += by * random.unit();
		}
	}
}

/// The gap that an arrangement has between bodies of these sizes; negative if they overlap.
inline double gapOf( Random& random, Arrangement arrangement, double size_a, double size_b )
{
	const double larger = std::fmax( size_a, size_b ), smaller = std::fmin( size_a, size_b );
	switch ( arrangement )
	{
	case apart_by_a_gap:
		return std::fmin( ( random.below( 2 ) == 0 ? larger : smaller ) * random.octave( -45, 10 ), 0x1p30 );
	case overlapping:
		return -smaller * random.octave( -45, 1 );
	case nested:
		return -size_a * random.uniform( 0, 1 );
	default:
		return 0;
	}
}

/// As randomShapes(): sizes from `least` octaves to 1e9 m, ratios to 1e12, places stored far from their frames and in worlds
/// to 1.6e7 m. Axes and faces are parallel as often as not; some rotations are not quite ones. Half-spaces and planes are
/// always the first.
inline ShapePair randomSolids( Random& random, Arrangement arrangement, int least = -30 )
{
	ShapePair p;
	p.name = arrangement_names[arrangement];
	p.a.body = randomPieces( random, random.below( arrangement == coinciding ? bounded_type_count : solid_type_count ) );
	p.b.body = arrangement == coinciding ? p.a.body : randomPieces( random, random.below( bounded_type_count ) );
	double size_a = random.below( 3 ) == 0 ? 1 : random.octave( least, 27 );
	double ratio = random.below( 2 ) == 0 || arrangement == coinciding ? 1 : random.octave( -40, 40 );
	double size_b = std::fmin( std::fmax( size_a * ratio, std::ldexp( 1.0, least - 10 ) ), 0x1p27 );
	for ( int i = 0; i < 2; ++i )
	{
		exact::Body& body = i == 0 ? p.a.body : p.b.body;
		double size = i == 0 ? size_a : size_b;
		lw_vec3 own = { 0, 0, 0 };
		bool anywhere = body.type == LW_SHAPE_MESH || body.type == LW_SHAPE_POINTS || body.type == LW_SHAPE_SPHERES ||
		                body.type == LW_SHAPE_BOXES;
		if ( anywhere && arrangement != coinciding && random.below( 4 ) == 0 ) // stored far from their frame's origin
		{
			own = random.point();
			double far = std::fmin( random.octave( 0, 20 ), 0x1p29 / size );
			own = { far * own.x, far * own.y, far * own.z };
		}
		scalePieces( body, own, size );
	}
	p.a.shape = makeSolid( random, p.a.body );
	p.b.shape = makeSolid( random, p.b.body );

	p.world_from_a = randomRotation( random );
	bool aligned = arrangement == coinciding || random.below( 4 ) == 0;
	p.world_from_b = aligned ? p.world_from_a : randomRotation( random );
	const exact::Piece& mine = p.a.body.pieces[random.below( static_cast<std::uint32_t>( p.a.body.pieces.size() ) )];
	const exact::Piece& other = p.b.body.pieces[random.below( static_cast<std::uint32_t>( p.b.body.pieces.size() ) )];
	lw_vec3 n = { 0, 0, 1 };
	if ( mine.isUnbounded() || random.below( 3 ) == 0 ) // along an axis of a, or of the world, or in any direction
	{
		n = lw_transform_point( &p.world_from_a, n ); // no shift yet
	}
	else if ( random.below( 2 ) == 0 )
	{
		n = random.point();
		double length = std::hypot( n.x, n.y, n.z );
		n = { n.x / length, n.y / length, n.z / length };
	}
	lw_vec3 at = farthest( random, mine, p.world_from_a, n ),
	        from = farthest( random, other, p.world_from_b, { -n.x, -n.y, -n.z } );
	const double gap = gapOf( random, arrangement, size_a, size_b ), smaller = std::fmin( size_a, size_b );
	lw_vec3 t = plus( minus( at, from ), gap, n );
	if ( random.below( 3 ) == 0 ) // beside each other, too
	{
		t = plus( t, smaller * random.octave( -10, 1 ), random.point() );
	}
	double world = random.below( 2 ) == 0 ? 0 : random.octave( 0, 24 );
	lw_vec3 offset = random.point();
	const double c[3] = { t.x, t.y, t.z }, o[3] = { world * offset.x, world * offset.y, world * offset.z };
	for ( int k = 0; k < 3; ++k )
	{
		p.world_from_a.t[k] = o[k];
		p.world_from_b.t[k] = arrangement == coinciding ? o[k] : c[k] + o[k];
	}
	p.skewed = random.below( 8 ) == 0;
	if ( p.skewed )
	{
		skew( random, p.world_from_a );
		skew( random, p.world_from_b );
	}
	return p;
}
} // namespace extremes
