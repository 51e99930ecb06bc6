// SPDX-License-Identifier: BSD-3-Clause
// Convex hulls of points, one by one (Kallay 1984; van den Bergen 2001 for depths). Faces that see a new point go, and those between it
// and their rim come. Whether a face sees a point is decided exactly, so that the faces are those of the hull of the points
// as they are stored, however flat: no degenerate face can arise (core/docs/depth.md).
#include "depth/polytope.h"
#include "base/exact_sign.h"
#include "base/math_inline.h"

/// Edges of the rim of what a point sees.
typedef struct rim
{
	uint16_t edge[3 * LWI_POLYTOPE_FACES][2];
	uint32_t count;
} rim;

/// Positive if the point is behind the face, exactly. Most signs are those of a height in double (core/docs/depth.md).
static inline int side( const lwi_polytope* p, const lwi_polytope_face* face, const double point[3] )
{
	const double* a = p->points[face->corner[0]].w;
	const lw_vec3 d = { a[0] - point[0], a[1] - point[1], a[2] - point[2] };
	const double height = lwi_dot( face->normal, d ), bound = face->error * ( fabs( d.x ) + fabs( d.y ) + fabs( d.z ) );
	if ( fabs( height ) > bound )
	{
		return height > 0 ? 1 : -1;
	}
	return lwi_exact_side( a, p->points[face->corner[1]].w, p->points[face->corner[2]].w, point );
}

/// Adds a face in place: to copy one that was just written takes longer than to make it.
static void add_face( lwi_polytope* p, uint16_t i, uint16_t j, uint16_t k )
{
	static const double origin[3] = { 0, 0, 0 };
	lwi_polytope_face* face = &p->faces[p->face_count++];
	face->corner[0] = i;
	face->corner[1] = j;
	face->corner[2] = k;
	const lw_vec3 a = lwi_load( p->points[i].w ), b = lwi_load( p->points[j].w ), c = lwi_load( p->points[k].w );
	const lw_vec3 e = lwi_sub( b, a ), f = lwi_sub( c, a ), n = lwi_cross( e, f );
	const double most = lwi_larger( fabs( n.x ), lwi_larger( fabs( n.y ), fabs( n.z ) ) );
	// of a face too thin for a normal any direction will do: offsets hold for whatever it is, and no sign is taken from it
	const bool squares = most > 0x1p-400; // these do not underflow
	const double first = squares || !( most > 0 ) ? 1 : 1 / most;
	const lw_vec3 scaled = most > 0 ? lwi_scale( first, n ) : lwi_v3( 1, 0, 0 );
	const double second = 1 / lwi_length( scaled );
	face->normal = lwi_scale( second, scaled );
	const double x = fabs( e.y * f.z ) + fabs( e.z * f.y ), y = fabs( e.z * f.x ) + fabs( e.x * f.z ),
				 z = fabs( e.x * f.y ) + fabs( e.y * f.x );
	face->error = most > 0 ? 12 * LWI_U64 * lwi_larger( x, lwi_larger( y, z ) ) * first * second : INFINITY;
	face->offset =
		lwi_smaller( lwi_dot( face->normal, a ), lwi_smaller( lwi_dot( face->normal, b ), lwi_dot( face->normal, c ) ) );
	face->behind = side( p, face, origin ) > 0;
}

bool lwi_polytope_begin( lwi_polytope* p, const lwi_polytope_point points[4] )
{
	p->point_count = 4;
	p->face_count = 0;
	for ( int i = 0; i < 4; ++i )
	{
		p->points[i] = points[i];
	}
	const int behind = lwi_exact_side( points[0].w, points[1].w, points[2].w, points[3].w );
	if ( behind == 0 )
	{
		return false;
	}
	const uint16_t j = behind > 0 ? 1 : 2, k = behind > 0 ? 2 : 1; // 0, j, k sees nothing of 3
	add_face( p, 0, j, k );
	add_face( p, 0, 3, j );
	add_face( p, j, 3, k );
	add_face( p, k, 3, 0 );
	return true;
}

const lwi_polytope_face* lwi_polytope_nearest( const lwi_polytope* p )
{
	uint32_t best = 0;
	double least = p->faces[0].offset; // loaded again from faces[best], each face would wait for the one before
	for ( uint32_t i = 1; i < p->face_count; ++i )
	{
		const double offset = p->faces[i].offset;
		best = offset < least ? i : best;
		least = offset < least ? offset : least;
	}
	return &p->faces[best];
}

double lwi_polytope_ball( const lwi_polytope* p )
{
	double least = INFINITY;
	for ( uint32_t i = 0; i < p->face_count; ++i )
	{
		const double offset = p->faces[i].behind ? p->faces[i].offset : fmin( p->faces[i].offset, 0 );
		least = offset < least ? offset : least;
	}
	return least;
}

/// Adds a face's edge, or takes the same edge of its neighbour away.
static void toggle( rim* r, uint16_t from, uint16_t to )
{
	for ( uint32_t i = 0; i < r->count; ++i )
	{
		if ( r->edge[i][0] == to && r->edge[i][1] == from )
		{
			r->count--;
			r->edge[i][0] = r->edge[r->count][0];
			r->edge[i][1] = r->edge[r->count][1];
			return;
		}
	}
	r->edge[r->count][0] = from;
	r->edge[r->count][1] = to;
	r->count++;
}

bool lwi_polytope_add( lwi_polytope* p, const lwi_polytope_point* point )
{
	for ( uint32_t i = 0; i < p->point_count; ++i )
	{
		const double* w = p->points[i].w;
		if ( w[0] == point->w[0] && w[1] == point->w[1] && w[2] == point->w[2] )
		{
			return false; // in the planes of its faces: signs would be costly
		}
	}
	uint16_t seen[LWI_POLYTOPE_FACES]; // their numbers: nobody can foresee which they are, so no branch asks
	uint32_t count = 0, kept = p->face_count;
	for ( uint32_t i = 0; i < p->face_count; ++i )
	{
		seen[count] = (uint16_t)i;
		count += side( p, &p->faces[i], point->w ) < 0;
	}
	rim r; // not cleared as a whole
	r.count = 0;
	for ( uint32_t i = 0; i < count; ++i )
	{
		const uint16_t* corner = p->faces[seen[i]].corner;
		toggle( &r, corner[0], corner[1] );
		toggle( &r, corner[1], corner[2] );
		toggle( &r, corner[2], corner[0] );
	}
	if ( count == 0 || p->point_count == LWI_POLYTOPE_POINTS || p->face_count - count + r.count > LWI_POLYTOPE_FACES )
	{
		return false;
	}
	for ( uint32_t i = count; i-- > 0; )
	{
		p->faces[seen[i]] = p->faces[--kept];
	}
	const uint16_t added = (uint16_t)p->point_count;
	p->points[p->point_count++] = *point;
	p->face_count = kept;
	for ( uint32_t i = 0; i < r.count; ++i )
	{
		add_face( p, r.edge[i][0], r.edge[i][1], added );
	}
	return true;
}

void lwi_polytope_weights( const lwi_polytope* p, const lwi_polytope_face* face, double weight[3] )
{
	// areas of the triangles between the foot of the origin and the sides, as the normal sees them
	lw_vec3 corner[3];
	double sum = 0;
	const lw_vec3 foot = lwi_scale( face->offset, face->normal );
	for ( int k = 0; k < 3; ++k )
	{
		corner[k] = lwi_sub( lwi_load( p->points[face->corner[k]].w ), foot );
	}
	for ( int k = 0; k < 3; ++k )
	{
		const double area = lwi_dot( face->normal, lwi_cross( corner[( k + 1 ) % 3], corner[( k + 2 ) % 3] ) );
		weight[k] = area > 0 ? area : 0;
		sum += weight[k];
	}
	for ( int k = 0; k < 3; ++k )
	{
		weight[k] = sum > 0 ? weight[k] / sum : 1.0 / 3;
	}
}
