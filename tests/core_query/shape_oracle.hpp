// SPDX-License-Identifier: BSD-3-Clause
// Brute-force distance of two whole shapes in long double: every pair of convex pieces, no tree, no kernel of the engine.
//
// The method for each kind of pair:
// - point against anything: projection in closed form;
// - segment against anything: golden section over the segment of the former, a convex function;
// - polytopes (triangle, box): their nearest points, or a common one, include a point of an edge: the least over all edges;
// - triangle or solid against cylinder or cone: alternating projections with a duality gap (convex_oracle.hpp).
// Pairs whose bounding spheres are farther apart than the best so far are left out, and nothing else.
#pragma once

#include "convex_oracle.hpp"

#include <vector>

namespace oracle
{
/// A rigid motion in long double.
struct Pose
{
	Vec column[3], t;

	Vec apply( Vec p ) const { return p.x * column[0] + p.y * column[1] + p.z * column[2] + t; }
	/// The inverse, as far as the columns are orthonormal.
	Vec undo( Vec p ) const { return { dot( column[0], p - t ), dot( column[1], p - t ), dot( column[2], p - t ) }; }
};

inline Pose pose_from( const lw_transform& m )
{
	Pose out;
	for ( int j = 0; j < 3; ++j )
	{
		out.column[j] = { m.r[0][j], m.r[1][j], m.r[2][j] };
	}
	out.t = offset( m );
	return out;
}

inline Pose relative( const lw_transform& world_from_a, const lw_transform& world_from_b )
{
	Pose out;
	for ( int j = 0; j < 3; ++j )
	{
		out.column[j] = unrotate( world_from_a, { world_from_b.r[0][j], world_from_b.r[1][j], world_from_b.r[2][j] } );
	}
	out.t = unrotate( world_from_a, offset( world_from_b ) - offset( world_from_a ) );
	return out;
}

inline double to_double( real v )
{
	return static_cast<double>( v );
}
inline lw_vec3 to_double( Vec v )
{
	return { to_double( v.x ), to_double( v.y ), to_double( v.z ) };
}

inline lw_transform to_transform( const Pose& p )
{
	lw_transform m = {};
	for ( int j = 0; j < 3; ++j )
	{
		m.r[0][j] = to_double( p.column[j].x );
		m.r[1][j] = to_double( p.column[j].y );
		m.r[2][j] = to_double( p.column[j].z );
	}
	m.t[0] = to_double( p.t.x );
	m.t[1] = to_double( p.t.y );
	m.t[2] = to_double( p.t.z );
	return m;
}

/// Nearest point of a triangle, also of needles: the foot is corrected until its residual is along the normal.
inline Vec foot_on_triangle( const Vec v[3], Vec p )
{
	Vec best = nearest_of_segment( v[0], v[1], p );
	for ( int i = 1; i < 3; ++i )
	{
		Vec q = nearest_of_segment( v[i], v[( i + 1 ) % 3], p );
		best = length( p - q ) < length( p - best ) ? q : best;
	}
	Vec e = v[1] - v[0], f = v[2] - v[0], n = cross( e, f ), rest = p - v[0];
	real nn = dot( n, n ), s = 0, t = 0;
	for ( int i = 0; i < 3 && nn > 0; ++i )
	{
		s += dot( cross( rest, f ), n ) / nn;
		t += dot( cross( e, rest ), n ) / nn;
		rest = p - ( v[0] + s * e + t * f );
	}
	bool inside = nn > 0 && s >= 0 && t >= 0 && s + t <= 1;
	return inside && length( rest ) < length( p - best ) ? p - rest : best;
}

/// A convex piece: 1 to 3 corners, or a solid in its own frame (corners = 0).
struct Piece
{
	int corners;
	Vec v[3];
	const lwi_convex* solid;
	Vec center; ///< of a sphere around it
	real reach;

	real distance_of( Vec p ) const
	{
		switch ( corners )
		{
		case 0:
			return length( p - Body{ *solid }.nearest( p ) );
		case 1:
			return length( p - v[0] );
		case 2:
			return length( p - nearest_of_segment( v[0], v[1], p ) );
		default:
			return length( p - foot_on_triangle( v, p ) );
		}
	}
};

/// A shape as the oracle sees it: pieces of one kind, dilated by one radius, shape frame.
struct Model
{
	int corners = 0;
	std::vector<Vec> points; ///< `corners` per piece
	lwi_convex solid = {};   ///< the only piece if corners = 0
	double radius = 0;
	real size = 0; ///< farthest point from the frame's origin, dilation included

	std::size_t count() const { return corners == 0 ? 1 : points.size() / static_cast<std::size_t>( corners ); }

	/// Piece i in another frame; solids stay in their own.
	Piece piece( std::size_t i, const Pose& pose ) const
	{
		Piece out = { corners, {}, &solid, { 0, 0, 0 }, 0 };
		if ( corners == 0 )
		{
			out.reach = Body{ solid }.radius();
			return out;
		}
		for ( int k = 0; k < corners; ++k )
		{
			out.v[k] = pose.apply( points[i * static_cast<std::size_t>( corners ) + static_cast<std::size_t>( k )] );
			out.center = out.center + ( 1.0L / corners ) * out.v[k];
		}
		for ( int k = 0; k < corners; ++k )
		{
			out.reach = std::max( out.reach, length( out.v[k] - out.center ) );
		}
		return out;
	}
};

inline const Pose& still()
{
	static const Pose pose = pose_from( lw_transform_identity() );
	return pose;
}

/// Lowers best to the least distance of an edge of `edges` and `other`.
inline void over_edges(
    const std::vector<std::pair<Vec, Vec>>& edges, const Piece& other, const Pose& other_from_edges, real& best )
{
	for ( const auto& edge : edges )
	{
		Vec a = other_from_edges.apply( edge.first ), b = other_from_edges.apply( edge.second );
		real half = length( b - a ) / 2;
		if ( length( 0.5L * ( a + b ) - other.center ) - half - other.reach < best )
		{
			best = std::min( best, golden( [&]( real s ) { return other.distance_of( a + s * ( b - a ) ); }, steps ) );
		}
	}
}

inline std::vector<std::pair<Vec, Vec>> edges_of( const Piece& piece )
{
	std::vector<std::pair<Vec, Vec>> edges;
	if ( piece.corners > 0 )
	{
		for ( int i = 0; i < ( piece.corners == 3 ? 3 : 1 ); ++i )
		{
			edges.push_back( { piece.v[i], piece.v[( i + 1 ) % piece.corners] } );
		}
		return edges;
	}
	const double* s = piece.solid->size;
	for ( int i = 0; i < 8; ++i )
	{
		Vec p = { i & 1 ? s[0] : -s[0], i & 2 ? s[1] : -s[1], i & 4 ? s[2] : -s[2] };
		if ( p.x < 0 )
		{
			edges.push_back( { p, { -p.x, p.y, p.z } } );
		}
		if ( p.y < 0 )
		{
			edges.push_back( { p, { p.x, -p.y, p.z } } );
		}
		if ( p.z < 0 )
		{
			edges.push_back( { p, { p.x, p.y, -p.z } } );
		}
	}
	if ( edges.empty() )
	{
		edges.push_back( { { 0, 0, 0 }, { 0, 0, 0 } } ); // a box that is a point
	}
	return edges;
}

/// Two pieces; x in its frame, y in x's frame unless it is a solid, which stands at x_from_y.
/// @param enough the caller does not care for distances that are not below it
inline Interval piece_distance( const Piece& x, const Piece& y, const Pose& x_from_y, real scale, real enough )
{
	auto is_round = []( const Piece& p ) { return p.corners == 0 && p.solid->type != LWI_CONVEX_BOX; };
	bool curved = is_round( x ) || is_round( y );
	real d = enough;
	if ( x.corners == 1 || y.corners == 1 )
	{
		d = x.corners == 1 ? y.distance_of( x.v[0] ) : x.distance_of( y.v[0] );
	}
	else if ( x.corners == 2 || y.corners == 2 )
	{
		x.corners == 2 ? over_edges( edges_of( x ), y, still(), d ) : over_edges( edges_of( y ), x, still(), d );
	}
	else if ( !curved )
	{
		Pose y_from_x = still();
		if ( y.corners == 0 )
		{
			lw_transform m = to_transform( x_from_y ), id = lw_transform_identity();
			y_from_x = relative( m, id );
		}
		over_edges( edges_of( y ), x, y.corners == 0 ? x_from_y : still(), d );
		over_edges( edges_of( x ), y, y_from_x, d );
	}
	else
	{
		lwi_convex triangle = { LWI_CONVEX_TRIANGLE, { 0, 0, 0 },
		    { to_double( y.v[0] ), to_double( y.v[1] ), to_double( y.v[2] ) }, nullptr, 0, nullptr };
		lw_transform m = y.corners == 0 ? to_transform( x_from_y ) : lw_transform_identity();
		return distance( *x.solid, y.corners == 0 ? *y.solid : triangle, m, 1e-11L * scale, 800, enough );
	}
	return { d, d };
}

/// Distance of two shapes, in the frame of a if that is a solid or neither is.
inline Interval shape_distance(
    const Model& a, const lw_transform& pose_a, const Model& b, const lw_transform& pose_b, real scale )
{
	if ( b.corners == 0 && a.corners != 0 )
	{
		return shape_distance( b, pose_b, a, pose_a, scale );
	}
	Pose a_from_b = relative( pose_a, pose_b );
	std::vector<Piece> x, y;
	for ( std::size_t i = 0; i < a.count(); ++i )
	{
		x.push_back( a.piece( i, still() ) );
	}
	for ( std::size_t i = 0; i < b.count(); ++i )
	{
		y.push_back( b.piece( i, a_from_b ) );
	}
	struct Candidate
	{
		real gap;
		const Piece *x, *y;
	};
	auto apart = [&]( const Piece& p, const Piece& q )
	{ return length( ( q.corners == 0 ? a_from_b.t : q.center ) - p.center ); };
	real least = INFINITY; // some pair is not farther than this
	for ( const Piece& p : x )
	{
		for ( const Piece& q : y )
		{
			least = std::min( least, apart( p, q ) + p.reach + q.reach );
		}
	}
	std::vector<Candidate> candidates;
	for ( const Piece& p : x )
	{
		for ( const Piece& q : y )
		{
			real gap = apart( p, q ) - p.reach - q.reach;
			if ( gap <= least )
			{
				candidates.push_back( { gap, &p, &q } );
			}
		}
	}
	auto nearer = []( const Candidate& p, const Candidate& q ) { return p.gap < q.gap; };
	std::sort( candidates.begin(), candidates.end(), nearer );
	const real radii = static_cast<real>( a.radius ) + b.radius, contact = radii + 1e-18L * scale;
	Interval best = { INFINITY, INFINITY };
	for ( const Candidate& c : candidates )
	{
		if ( c.gap >= best.upper || best.upper <= contact )
		{
			break;
		}
		Interval d = piece_distance( *c.x, *c.y, a_from_b, scale, best.upper );
		best.lower = std::min( best.lower, d.lower );
		best.upper = std::min( best.upper, d.upper );
	}
	best.lower = best.upper <= contact ? 0 : std::min( best.lower, best.upper );
	return { std::max( best.lower - radii, (real)0 ), std::max( best.upper - radii, (real)0 ) };
}
} // namespace oracle
