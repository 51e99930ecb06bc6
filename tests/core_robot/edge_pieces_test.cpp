// SPDX-License-Identifier: BSD-3-Clause
// Dense meshes whose hulls meet and whose pieces are apart (core/docs/edges.md): time lost where planes of pieces would do,
// and FREE where a piece, its motion or the inside of a solid was left out.
#include "edge_model.hpp"

#include "shape/shape.h"

namespace
{

constexpr double PI = 3.14159265358979323846;

struct Surface
{
	std::vector<double> vertices;
	std::vector<std::uint32_t> indices;

	lw_shape* shape( bool solid = false ) const
	{
		lw_mesh_def def = lw_mesh_def_default();
		def.vertices = vertices.data();
		def.vertex_count = static_cast<std::uint32_t>( vertices.size() / 3 );
		def.indices = indices.data();
		def.triangle_count = static_cast<std::uint32_t>( indices.size() / 3 );
		def.solid = solid;
		lw_shape* made = nullptr;
		lw_diag diag = {};
		EXPECT_EQ( LW_OK, lw_shape_create_mesh( &def, nullptr, &diag, &made ) ) << diag.message;
		return made;
	}
};

/// A part of a ring about z, a tube of 24 sides: 48 triangles for each of its `rings`. A whole ring is closed.
Surface ring( double bend, double thick, double from, double to, int rings )
{
	constexpr int sides = 24;
	const bool whole = to - from > 2 * PI - 1e-9;
	Surface out;
	for ( int i = 0; i < ( whole ? rings : rings + 1 ); ++i )
	{
		for ( int k = 0; k < sides; ++k )
		{
			const double along = from + ( to - from ) * i / rings, around = 2 * PI * k / sides;
			const double r = bend + thick * std::cos( around );
			out.vertices.insert(
			    out.vertices.end(), { r * std::cos( along ), r * std::sin( along ), thick * std::sin( around ) } );
		}
	}
	const auto corner = [&]( int i, int k )
	{ return static_cast<std::uint32_t>( ( whole ? i % rings : i ) * sides + k % sides ); };
	for ( int i = 0; i < rings; ++i )
	{
		for ( int k = 0; k < sides; ++k )
		{
			const std::uint32_t a = corner( i, k ), b = corner( i + 1, k ), c = corner( i, k + 1 ),
			                    d = corner( i + 1, k + 1 );
			out.indices.insert( out.indices.end(), { a, b, c, c, b, d } );
		}
	}
	return out;
}

/// A ball of triangles, closed.
Surface ball( double radius, int rings )
{
	constexpr int sides = 24;
	Surface out;
	out.vertices = { 0, 0, radius, 0, 0, -radius };
	const auto corner = [&]( int i, int k ) { return static_cast<std::uint32_t>( 2 + i * sides + k % sides ); };
	for ( int i = 0; i < rings; ++i )
	{
		const double down = PI * ( i + 1 ) / ( rings + 1 );
		for ( int k = 0; k < sides; ++k )
		{
			const double around = 2 * PI * k / sides;
			out.vertices.insert(
			    out.vertices.end(), { radius * std::sin( down ) * std::cos( around ),
			                            radius * std::sin( down ) * std::sin( around ), radius * std::cos( down ) } );
			out.indices.insert( out.indices.end(),
			    i == 0 ? std::initializer_list<std::uint32_t>{ 0, corner( 0, k ), corner( 0, k + 1 ) }
			           : std::initializer_list<std::uint32_t>{ corner( i - 1, k ), corner( i, k ), corner( i, k + 1 ),
			                 corner( i - 1, k ), corner( i, k + 1 ), corner( i - 1, k + 1 ) } );
			if ( i + 1 == rings )
			{
				out.indices.insert( out.indices.end(), { 1, corner( i, k + 1 ), corner( i, k ) } );
			}
		}
	}
	return out;
}

/// A fixed link, and one that slides along x and turns about an axis of its own.
void twoLinks( World& world, lw_shape* fixed, lw_shape* moving, const lw_transform& place )
{
	world.model.link( "base" );
	lw_joint_def& slide = world.model.joint( "slide", LW_JOINT_PRISMATIC, 0 );
	slide.axis[0] = 1;
	slide.axis[2] = 0;
	slide.lower = -2;
	slide.upper = 2;
	world.model.joint( "turn", LW_JOINT_CONTINUOUS, 1 );
	world.model.body( 0, fixed, lw_transform_identity() );
	world.model.body( 2, moving, place );
	world.open();
}

} // namespace

// A block turns inside of a C, some 3 cm from its wall all along: their hulls meet, and by distances 12 cm of motion take
// windows of 3 cm. Planes between the block and pieces of the C hold for wider ones.
TEST( EdgePieces, LinkThatMovesInsideOfAnothersHullTakesFewStates )
{
	World world;
	lw_shape* c = ring( 0.2, 0.03, 0.8, 2 * PI - 0.8, 40 ).shape();
	ASSERT_GT( c->piece_count, 1u );
	twoLinks( world, c, primitive( LW_SHAPE_BOX, 0.04, 0.04, 0.04 ), at( -0.115, 0, 0 ) );
	for ( const double turn : { 1.4, 2.0, 2.6 } )
	{
		const lw_edge_result r = world.edge( { 0, -0.5 * turn }, { 0, 0.5 * turn }, lw_edge_def_default() );
		EXPECT_EQ( r.verdict, LW_VERDICT_FREE );
		EXPECT_LE( r.queries, 5u ) << "turn by " << turn;
	}
}

// Rings, arcs and balls at random places, of two links and of the scene: an edge that is FREE is apart in 200 of its states.
TEST( EdgePieces, FreeMotionsAreApartEverywhere )
{
	SeededRng rng;
	int free = 0, blocked = 0;
	for ( int i = 0; i < 160; ++i )
	{
		World world;
		const auto shape = [&]
		{
			const double bend = rng.uniform( 0.1, 0.25 ), thick = rng.uniform( 0.01, 0.05 ), from = rng.uniform( 0, 6 );
			return rng.integer( 0, 4 ) == 0
			           ? ball( rng.uniform( 0.02, 0.08 ), 12 ).shape()
			           : ring( bend, thick, from, from + rng.uniform( 1, 5.5 ), rng.integer( 6, 20 ) ).shape();
		};
		const int objects = rng.integer( 0, 2 );
		for ( int k = 0; k < objects; ++k )
		{
			world.object( rng.integer( 0, 1 ) == 0 ? shape() : primitive( LW_SHAPE_BOX, 0.05, 0.2, 0.05 ),
			    randomTransform( rng, 0.25 ) );
		}
		lw_shape* fixed = rng.integer( 0, 2 ) == 0 ? primitive( LW_SHAPE_BOX, 0.05, 0.2, 0.05 ) : shape();
		lw_shape* moving = rng.integer( 0, 2 ) == 0 ? primitive( LW_SHAPE_SPHERE, 0.03 ) : shape();
		twoLinks( world, fixed, moving, randomTransform( rng, 0.2 ) );
		for ( int k = 0; k < 12; ++k )
		{
			const double x = rng.uniform( -0.3, 0.3 ), turn = rng.uniform( -3, 3 ), way = rng.decade( -2, -0.5 );
			const State a = { x, turn }, b = { x + rng.uniform( -way, way ), turn + 3 * rng.uniform( -way, way ) };
			const lw_edge_result r = world.edge( a, b, lw_edge_def_default() );
			blocked += r.verdict == LW_VERDICT_BLOCKED ? 1 : 0;
			for ( int t = 0; r.verdict == LW_VERDICT_FREE && t <= 200; ++t )
			{
				const double clearance = world.clearanceAt( a, b, t / 200.0, lw_edge_def_default().flags );
				ASSERT_GT( clearance, 0 ) << "world " << i << ", edge " << k << ", t = " << t / 200.0;
				ASSERT_GE( clearance, r.lower_bound - 1e-12 ) << "world " << i << ", edge " << k << ", t = " << t / 200.0;
			}
			free += r.verdict == LW_VERDICT_FREE ? 1 : 0;
		}
	}
	EXPECT_GT( free, 100 );
	EXPECT_GT( blocked, 100 );
}

// Inside of a solid everything is in contact, though it is far from each piece of the solid's surface.
TEST( EdgePieces, InsideOfASolidNothingIsFree )
{
	World world;
	twoLinks( world, ball( 0.3, 20 ).shape( true ), ball( 0.05, 12 ).shape(), lw_transform_identity() );
	EXPECT_EQ( world.edge( { -0.05, 0 }, { 0.05, 0.5 }, lw_edge_def_default() ).verdict, LW_VERDICT_BLOCKED );
	World shell;
	twoLinks( shell, ball( 0.3, 20 ).shape(), ball( 0.05, 12 ).shape(), lw_transform_identity() );
	EXPECT_EQ( shell.edge( { -0.05, 0 }, { 0.05, 0.5 }, lw_edge_def_default() ).verdict, LW_VERDICT_FREE );
}

// A piece is only what is below its child, but all of that: every triangle is in the box and sphere of some piece, and every
// extreme point of a piece in its own.
TEST( EdgePieces, EveryTriangleIsInAPiece )
{
	SeededRng rng;
	for ( int i = 0; i < 20; ++i )
	{
		const Surface surface =
		    ring( rng.uniform( 0.1, 2 ), rng.decade( -3, -1 ), 0, rng.uniform( 0.5, 6 ), rng.integer( 6, 60 ) );
		const ShapePtr owned( surface.shape() );
		const lw_shape& s = *owned;
		ASSERT_GT( s.piece_count, 1u );
		const auto holds = [&]( const lw_shape& piece, const double* v )
		{
			bool in = true;
			double sq = 0;
			for ( int k = 0; k < 3; ++k )
			{
				in = in && v[k] >= piece.box_min[k] && v[k] <= piece.box_max[k];
				sq += ( v[k] - piece.sphere_center[k] ) * ( v[k] - piece.sphere_center[k] );
			}
			return in && std::sqrt( sq ) <= piece.sphere_radius;
		};
		for ( std::size_t t = 0; t < surface.indices.size(); t += 3 )
		{
			bool found = false;
			for ( std::uint32_t p = 0; p < s.piece_count && !found; ++p )
			{
				found = holds( s.pieces[p], &surface.vertices[3 * surface.indices[t]] ) &&
				        holds( s.pieces[p], &surface.vertices[3 * surface.indices[t + 1]] ) &&
				        holds( s.pieces[p], &surface.vertices[3 * surface.indices[t + 2]] );
			}
			ASSERT_TRUE( found ) << "triangle " << t / 3;
		}
		for ( std::uint32_t p = 0; p < s.piece_count; ++p )
		{
			for ( std::uint32_t j = 0; j < s.pieces[p].extreme_blocks * LWI_WIDTH; ++j )
			{
				const auto& at = s.pieces[p].extreme_points[j / LWI_WIDTH].at;
				const double v[3] = { s.origin[0] + static_cast<double>( at[0][j % LWI_WIDTH] ),
				    s.origin[1] + static_cast<double>( at[1][j % LWI_WIDTH] ),
				    s.origin[2] + static_cast<double>( at[2][j % LWI_WIDTH] ) };
				EXPECT_TRUE( holds( s.pieces[p], v ) ) << "piece " << p;
			}
		}
	}
}
