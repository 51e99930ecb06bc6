// SPDX-License-Identifier: BSD-3-Clause
// Template: the point of a simplex (1 to 4 points) nearest to the origin. Included once per number type.
//
// Papers: Ericson, "Real-Time Collision Detection", 2005, 5.1.5 and 5.1.6 (which faces can hold the nearest point);
// Montanari, Petrinic, Barbieri, "Improving the GJK algorithm for faster and more reliable distance queries between convex
// objects", 2017 (weights from volumes, not from Johnson's cofactors). All of it works on differences of the points, and the
// nearest point of a triangle is taken along its normal: the direction then is as good as the triangle, even where the
// distance is tiny.
//
// The includer defines real (a number), NAME( x ) (a suffix for the type), FROM, ADD, SUB, MUL, DIV, SIGN (of a number: a
// double to compare with 0): distance/simplex.h for double, distance/convex_refine.c for double-double.

typedef struct NAME( vec )
{
	real x, y, z;
} NAME( vec );

/// A point of the simplex and its weights; weight 0 = not needed.
typedef struct NAME( nearest )
{
	NAME( vec ) v;
	real sq; ///< |v|^2
	real weight[4];
} NAME( nearest );

static inline NAME( vec ) NAME( sub )( NAME( vec ) a, NAME( vec ) b )
{
	const NAME( vec ) out = { SUB( a.x, b.x ), SUB( a.y, b.y ), SUB( a.z, b.z ) };
	return out;
}

static inline real NAME( dot )( NAME( vec ) a, NAME( vec ) b )
{
	return ADD( ADD( MUL( a.x, b.x ), MUL( a.y, b.y ) ), MUL( a.z, b.z ) );
}

static inline NAME( vec ) NAME( cross )( NAME( vec ) a, NAME( vec ) b )
{
	const NAME( vec ) out = { SUB( MUL( a.y, b.z ), MUL( a.z, b.y ) ), SUB( MUL( a.z, b.x ), MUL( a.x, b.z ) ),
		SUB( MUL( a.x, b.y ), MUL( a.y, b.x ) ) };
	return out;
}

/// a + s b
static inline NAME( vec ) NAME( add_scaled )( NAME( vec ) a, real s, NAME( vec ) b )
{
	const NAME( vec ) out = { ADD( a.x, MUL( s, b.x ) ), ADD( a.y, MUL( s, b.y ) ), ADD( a.z, MUL( s, b.z ) ) };
	return out;
}

/// Squared distance to about double precision: to compare lengths.
static inline double NAME( distance_sq )( NAME( vec ) a, NAME( vec ) b )
{
	double x = SIGN( SUB( a.x, b.x ) ), y = SIGN( SUB( a.y, b.y ) ), z = SIGN( SUB( a.z, b.z ) );
	return x * x + y * y + z * z;
}

static void NAME( offer )( NAME( nearest ) * best, NAME( vec ) v, const int* index, const real* weight, int count )
{
	real sq = NAME( dot )( v, v );
	if ( SIGN( best->sq ) >= 0.0 && !( SIGN( SUB( sq, best->sq ) ) < 0.0 ) )
	{
		return;
	}
	best->v = v;
	best->sq = sq;
	for ( int i = 0; i < 4; ++i )
	{
		best->weight[i] = FROM( 0.0 );
	}
	for ( int i = 0; i < count; ++i )
	{
		best->weight[index[i]] = weight[i];
	}
}

static void NAME( segment )( const NAME( vec ) * w, int i, int j, NAME( nearest ) * best )
{
	NAME( vec ) e = NAME( sub )( w[j], w[i] );
	real ee = NAME( dot )( e, e );
	real top = SUB( FROM( 0.0 ), NAME( dot )( w[i], e ) );
	int index[2] = { i, j };
	real one = FROM( 1.0 );
	if ( !( SIGN( ee ) > 0.0 ) || SIGN( top ) <= 0.0 )
	{
		NAME( offer )( best, w[i], index, &one, 1 );
	}
	else if ( SIGN( SUB( top, ee ) ) >= 0.0 )
	{
		NAME( offer )( best, w[j], index + 1, &one, 1 );
	}
	else
	{
		real t = DIV( top, ee );
		real weight[2] = { SUB( one, t ), t };
		NAME( vec ) v = NAME( add_scaled )( w[i], t, e );
		// Once more: v is then orthogonal to e to rounding of its own length
		v = NAME( add_scaled )( v, SUB( FROM( 0.0 ), DIV( NAME( dot )( v, e ), ee ) ), e );
		NAME( offer )( best, v, index, weight, 2 );
	}
}

/// Turns the triangle so that i is opposite its longest edge. The cross product of the two shorter edges loses least: with
/// two long edges of a needle it would cancel by the ratio of its sides.
static inline void NAME( turn )( const NAME( vec ) * w, int* i, int* j, int* k )
{
	double ij = NAME( distance_sq )( w[*i], w[*j] ), jk = NAME( distance_sq )( w[*j], w[*k] ),
		   ki = NAME( distance_sq )( w[*k], w[*i] );
	int first = *i;
	if ( ki > jk && ki >= ij )
	{
		*i = *j;
		*j = *k;
		*k = first;
	}
	else if ( ij > jk )
	{
		*i = *k;
		*k = *j;
		*j = first;
	}
}

/// The nearest point is inside, or on an edge whose opposite vertex has a negative weight.
static void NAME( triangle )( const NAME( vec ) * w, int i, int j, int k, NAME( nearest ) * best )
{
	NAME( turn )( w, &i, &j, &k );
	NAME( vec ) e = NAME( sub )( w[j], w[i] );
	NAME( vec ) f = NAME( sub )( w[k], w[i] );
	NAME( vec ) n = NAME( cross )( e, f );
	real nn = NAME( dot )( n, n );
	bool degenerate = !( SIGN( nn ) > 0.0 );
	real wj = FROM( 0.0 ), wk = FROM( 0.0 ), wi = FROM( 0.0 );
	if ( !degenerate )
	{
		// For r = -w[i] = wj e + wk f + (along n): r x f and e x r, along n.
		wj = DIV( NAME( dot )( NAME( cross )( f, w[i] ), n ), nn );
		wk = DIV( NAME( dot )( NAME( cross )( w[i], e ), n ), nn );
		wi = SUB( SUB( FROM( 1.0 ), wj ), wk );
		if ( SIGN( wi ) >= 0.0 && SIGN( wj ) >= 0.0 && SIGN( wk ) >= 0.0 )
		{
			int index[3] = { i, j, k };
			real weight[3] = { wi, wj, wk };
			real s = DIV( NAME( dot )( w[i], n ), nn );
			NAME( vec ) v = { MUL( s, n.x ), MUL( s, n.y ), MUL( s, n.z ) };
			NAME( offer )( best, v, index, weight, 3 );
			return;
		}
	}
	if ( degenerate || !( SIGN( wi ) >= 0.0 ) )
	{
		NAME( segment )( w, j, k, best );
	}
	if ( degenerate || !( SIGN( wj ) >= 0.0 ) )
	{
		NAME( segment )( w, i, k, best );
	}
	if ( degenerate || !( SIGN( wk ) >= 0.0 ) )
	{
		NAME( segment )( w, i, j, best );
	}
}

/// Six times the volume, positive if vertex 0 is on the side of face 1 2 3 that its normal points to; from the vertex with
/// the shortest edges, for the same reason as above.
static real NAME( volume )( const NAME( vec ) * w, const int faces[4][3] )
{
	int pivot = 0;
	double shortest = INFINITY;
	for ( int i = 0; i < 4; ++i )
	{
		double sum = 0.0;
		for ( int j = 0; j < 3; ++j )
		{
			sum += NAME( distance_sq )( w[i], w[faces[i][j]] );
		}
		if ( sum < shortest )
		{
			shortest = sum;
			pivot = i;
		}
	}
	const int* f = faces[pivot];
	NAME( vec ) n = NAME( cross )( NAME( sub )( w[f[1]], w[pivot] ), NAME( sub )( w[f[2]], w[pivot] ) );
	real v = NAME( dot )( NAME( sub )( w[f[0]], w[pivot] ), n );
	return pivot % 2 == 0 ? SUB( FROM( 0.0 ), v ) : v;
}

/// Weight of vertex `apex` = height of the origin over the opposite face by the height of the apex. Faces that do not have
/// the origin on the apex's side can hold the nearest point; without any, the origin is inside.
static bool NAME( tetrahedron )( const NAME( vec ) * w, bool all_faces, NAME( nearest ) * best )
{
	static const int faces[4][3] = { { 1, 2, 3 }, { 0, 2, 3 }, { 0, 1, 3 }, { 0, 1, 2 } };
	real weight[4];
	bool outside[4];
	bool inside = true;
	// Heights times the face's area are the volume for each apex, with alternating sign
	real height = NAME( volume )( w, faces );
	outside[3] = false;
	// The last face is the old one, with the new point on the origin's side: it matters only if the origin may be inside
	for ( int apex = 0; apex < ( inside || all_faces ? 4 : 3 ); ++apex )
	{
		int i = faces[apex][0], j = faces[apex][1], k = faces[apex][2];
		NAME( turn )( w, &i, &j, &k );
		NAME( vec ) n = NAME( cross )( NAME( sub )( w[j], w[i] ), NAME( sub )( w[k], w[i] ) );
		real origin = SUB( FROM( 0.0 ), NAME( dot )( w[i], n ) );
		outside[apex] = !( SIGN( height ) > 0.0 ? SIGN( origin ) >= 0.0 : SIGN( height ) < 0.0 && SIGN( origin ) <= 0.0 );
		weight[apex] = outside[apex] ? FROM( 0.0 ) : DIV( origin, height );
		inside = inside && !outside[apex];
		height = SUB( FROM( 0.0 ), height );
	}
	if ( inside )
	{
		real sum = ADD( ADD( weight[0], weight[1] ), ADD( weight[2], weight[3] ) );
		for ( int i = 0; i < 4; ++i )
		{
			best->weight[i] = DIV( weight[i], sum );
		}
		best->v.x = best->v.y = best->v.z = FROM( 0.0 );
		best->sq = FROM( 0.0 );
		return true;
	}
	for ( int apex = 0; apex < 4; ++apex )
	{
		if ( outside[apex] )
		{
			NAME( triangle )( w, faces[apex][0], faces[apex][1], faces[apex][2], best );
		}
	}
	return false;
}

/// @param all_faces of four points: distrust the order in which they came
/// @return true if the origin is inside (count 4 only)
static inline bool NAME( nearest_to_origin )( const NAME( vec ) * w, int count, bool all_faces, NAME( nearest ) * best )
{
	best->sq = FROM( -1.0 );
	if ( count == 4 )
	{
		return NAME( tetrahedron )( w, all_faces, best );
	}
	if ( count == 3 )
	{
		NAME( triangle )( w, 0, 1, 2, best );
	}
	else if ( count == 2 )
	{
		NAME( segment )( w, 0, 1, best );
	}
	else
	{
		int index = 0;
		real one = FROM( 1.0 );
		NAME( offer )( best, w[0], &index, &one, 1 );
	}
	return false;
}

#undef real
#undef NAME
#undef FROM
#undef ADD
#undef SUB
#undef MUL
#undef DIV
#undef SIGN
