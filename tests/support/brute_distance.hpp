// SPDX-License-Identifier: BSD-3-Clause
// Distance of two shapes by every pair of their pieces: no trees, no kernels, nothing that an engine shares.
//
// Pieces are triangles and solids; two of them are measured by alternating projections in long double (convex_oracle.hpp),
// which give an interval. Pairs whose boxes are further apart than the best so far are passed over. Spheres and capsules are
// a point and a segment with a radius.
#pragma once

#include "convex_oracle.hpp"

#include "leeway/shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <stdexcept>
#include <vector>

class BruteShape
{
public:
	/// @throws std::runtime_error for sets of points, spheres or boxes, half-spaces and planes
	explicit BruteShape( const lw_shape* shape )
	{
		const lw_shape_info info = lw_shape_get_info( shape );
		const double* d = info.dimensions;
		switch ( info.type )
		{
		case LW_SHAPE_MESH:
			addTriangles( lw_shape_vertices( shape ), lw_shape_triangles( shape ), info.triangle_count );
			break;
		case LW_SHAPE_BOX:
			addSolid( LWI_CONVEX_BOX, { 0.5 * d[0], 0.5 * d[1], 0.5 * d[2] } );
			break;
		case LW_SHAPE_CYLINDER:
			addSolid( LWI_CONVEX_CYLINDER, { d[0], 0.5 * d[1], 0 } );
			break;
		case LW_SHAPE_CONE:
			addSolid( LWI_CONVEX_CONE, { d[0], 0.5 * d[1], 0 } );
			break;
		case LW_SHAPE_SPHERE:
		case LW_SHAPE_CAPSULE:
		{
			const double half = info.type == LW_SHAPE_CAPSULE ? 0.5 * d[1] : 0;
			radius = d[0];
			addTriangle( { 0, 0, -half }, { 0, 0, half }, { 0, 0, half } );
			break;
		}
		default:
			throw std::runtime_error( "no brute force for shapes of this kind" );
		}
	}

	std::vector<lwi_convex> pieces; ///< in the shape's frame
	double radius = 0;              ///< around all of them

private:
	void addSolid( lwi_convex_type type, std::array<double, 3> size )
	{
		lwi_convex piece{};
		piece.type = type;
		std::copy( size.begin(), size.end(), piece.size );
		pieces.push_back( piece );
	}

	void addTriangle( lw_vec3 a, lw_vec3 b, lw_vec3 c )
	{
		lwi_convex piece{};
		piece.type = LWI_CONVEX_TRIANGLE;
		piece.vertex[0] = a;
		piece.vertex[1] = b;
		piece.vertex[2] = c;
		pieces.push_back( piece );
	}

	void addTriangles( const double* vertices, const std::uint32_t* corners, std::size_t count )
	{
		const auto vertex = [&]( std::size_t corner )
		{
			const double* v = vertices + 3 * std::size_t{ corners[corner] };
			return lw_vec3{ v[0], v[1], v[2] };
		};
		for ( std::size_t i = 0; i < count; ++i )
		{
			addTriangle( vertex( 3 * i ), vertex( 3 * i + 1 ), vertex( 3 * i + 2 ) );
		}
	}
};

/// Shapes that were asked about stay known by their address: they must live as long as this.
class BruteDistance
{
public:
	static constexpr double width = 1e-9; ///< of the intervals, metres, beside the allowance below `bound`

	/// @param bound metres: nothing at or above it needs a distance; then lower = upper = bound
	oracle::Interval distance( const lw_shape* a, const lw_transform& world_from_a, const lw_shape* b,
	    const lw_transform& world_from_b, double bound )
	{
		const BruteShape &x = known( a ), &y = known( b );
		const lw_transform from_world = lw_transform_inverse( &world_from_a ),
		                   a_from_b = lw_transform_multiply( &from_world, &world_from_b );
		const double both = x.radius + y.radius;
		oracle::Interval best = { bound + both, bound + both };
		const Box all_x = boxOf( lw_shape_get_info( a ), lw_transform_identity() ),
		          all_y = boxOf( lw_shape_get_info( b ), a_from_b );
		if ( gap( all_x, all_y ) < bound )
		{
			const std::vector<Near> of_x = nearPieces( x, lw_transform_identity(), all_y, bound + both ),
			                        of_y = nearPieces( y, a_from_b, all_x, bound + both );
			for ( const Near& i : of_x )
			{
				for ( const Near& k : of_y )
				{
					if ( gap( i.box, k.box ) < static_cast<double>( best.upper ) && best.upper > both )
					{
						const oracle::Interval found =
						    oracle::distance( x.pieces[i.piece], y.pieces[k.piece], a_from_b, width, 20000, best.upper );
						best.lower = std::min( best.lower, found.lower );
						best.upper = std::min( best.upper, found.upper );
					}
				}
			}
		}
		return { std::max<oracle::real>( 0, best.lower - both ), std::max<oracle::real>( 0, best.upper - both ) };
	}

private:
	struct Box
	{
		double low[3], high[3];
	};
	struct Near
	{
		std::size_t piece;
		Box box;
	};

	static double gap( const Box& a, const Box& b )
	{
		double squared = 0;
		for ( int i = 0; i < 3; ++i )
		{
			const double d = std::max( 0.0, std::max( a.low[i] - b.high[i], b.low[i] - a.high[i] ) );
			squared += d * d;
		}
		return std::sqrt( squared );
	}

	/// Boxes are a little too large: their rounding is far below `width`.
	static Box boxOf( const lw_shape_info& info, const lw_transform& pose )
	{
		Box box;
		for ( int i = 0; i < 3; ++i )
		{
			double center = pose.t[i], half = width / 16;
			for ( int j = 0; j < 3; ++j )
			{
				center += pose.r[i][j] * 0.5 * ( info.box_min[j] + info.box_max[j] );
				half += std::abs( pose.r[i][j] ) * 0.5 * ( info.box_max[j] - info.box_min[j] );
			}
			box.low[i] = center - half;
			box.high[i] = center + half;
		}
		return box;
	}

	static Box boxOf( const lwi_convex& piece, const lw_transform& pose )
	{
		Box box;
		for ( int i = 0; i < 3; ++i )
		{
			const double* r = pose.r[i];
			if ( piece.type == LWI_CONVEX_TRIANGLE )
			{
				double along[3];
				for ( int v = 0; v < 3; ++v )
				{
					along[v] = r[0] * piece.vertex[v].x + r[1] * piece.vertex[v].y + r[2] * piece.vertex[v].z;
				}
				box.low[i] = std::min( along[0], std::min( along[1], along[2] ) );
				box.high[i] = std::max( along[0], std::max( along[1], along[2] ) );
			}
			else
			{
				box.high[i] = static_cast<double>( oracle::Body{ piece }.reach( { r[0], r[1], r[2] } ) );
				box.low[i] = -box.high[i]; // solids are symmetric
				if ( piece.type == LWI_CONVEX_CONE )
				{
					box.low[i] = -static_cast<double>( oracle::Body{ piece }.reach( { -r[0], -r[1], -r[2] } ) );
				}
			}
			box.low[i] += pose.t[i] - width / 16;
			box.high[i] += pose.t[i] + width / 16;
		}
		return box;
	}

	static std::vector<Near> nearPieces( const BruteShape& shape, const lw_transform& pose, const Box& other, double bound )
	{
		std::vector<Near> near;
		for ( std::size_t i = 0; i < shape.pieces.size(); ++i )
		{
			const Box box = boxOf( shape.pieces[i], pose );
			if ( gap( box, other ) < bound )
			{
				near.push_back( { i, box } );
			}
		}
		return near;
	}

	const BruteShape& known( const lw_shape* shape )
	{
		std::unique_ptr<BruteShape>& entry = m_known[shape];
		if ( !entry )
		{
			entry = std::make_unique<BruteShape>( shape );
		}
		return *entry;
	}

	std::map<const lw_shape*, std::unique_ptr<BruteShape>> m_known;
};
