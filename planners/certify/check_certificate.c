// SPDX-License-Identifier: BSD-3-Clause
// Checks a certificate of free motions. One file, no code of leeway, nothing but libm:
//
//     cc -O2 -o check check_certificate.c -lm
//     ./check [--files] [--pairs] certificate.lwc
//
// Exit status 0: accepted. 1: rejected; the line names the piece, the pair, the window and the reason. 2: the file is damaged.
//
// Accepted means: at every time of the motion, and for every deviation within the stated tolerances, the distance of every pair of
// shapes that is not listed as allowed exceeds min_d plus the pair's margin. FORMAT.md has the format and the proof of each test.
// Trusted: this program, its compiler and libm (sines and cosines to 1e-14); that the numbers in the file describe the robot and its
// surroundings; that allowed pairs may touch. --pairs lists the latter, --files the SHA-256 of the files that it was made from.
// Short, to be read at one sitting:
// clang-format off
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct { double x, y, z; } vec;
typedef struct { vec c[3], t; } pose; // columns of the rotation, and the shift
static vec vec_of( double x, double y, double z ) { vec v = { x, y, z }; return v; }
static vec add( vec a, vec b ) { return vec_of( a.x + b.x, a.y + b.y, a.z + b.z ); }
static vec unit_vec( int k ) { return vec_of( k == 0, k == 1, k == 2 ); }
static vec scale( double s, vec a ) { return vec_of( s * a.x, s * a.y, s * a.z ); }
static vec sub( vec a, vec b ) { return vec_of( a.x - b.x, a.y - b.y, a.z - b.z ); }
static double dot( vec a, vec b ) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static vec cross( vec a, vec b ) { return vec_of( a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x ); }
static double norm( vec a ) { return sqrt( dot( a, a ) ); }
static vec rotate( const pose* p, vec v ) { return add( scale( v.x, p->c[0] ), add( scale( v.y, p->c[1] ), scale( v.z, p->c[2] ) ) ); }
static vec rotate_back( const pose* p, vec v ) { return vec_of( dot( p->c[0], v ), dot( p->c[1], v ), dot( p->c[2], v ) ); }
static vec apply( const pose* p, vec v ) { return add( rotate( p, v ), p->t ); }
static pose compose( const pose* a, const pose* b ) {
	pose p = { { rotate( a, b->c[0] ), rotate( a, b->c[1] ), rotate( a, b->c[2] ) }, apply( a, b->t ) };
	return p;
}

// ---- the file as bytes; anything unexpected ends the program

static unsigned char* file_bytes;
static size_t file_size, at;
static void damaged( const char* why ) { printf( "damaged: %s (byte %zu)\n", why, at ), exit( 2 ); }
static void* new_array( size_t count, size_t size ) {
	void* memory = calloc( count + 1, size );
	if ( !memory ) damaged( "it needs more memory than there is" );
	return memory;
}
static unsigned byte( void ) { return at < file_size ? file_bytes[at++] : ( damaged( "it ends too early" ), 0u ); }
static uint64_t little_endian( int bytes ) {
	uint64_t value = 0;
	for ( int i = 0; i < bytes; ++i ) value |= (uint64_t)byte() << ( 8 * i );
	return value;
}
static uint32_t count( void ) { // seven bits a byte, the lowest first
	uint64_t value = 0;
	unsigned b = 128;
	for ( int shift = 0; b > 127 && shift < 35; shift += 7 ) value |= (uint64_t)( ( b = byte() ) & 127 ) << shift;
	if ( b > 127 || value > 0x7fffffff ) damaged( "a count is too large" );
	return (uint32_t)value;
}
static uint32_t count_of( size_t least_bytes ) { // a number of things that follow, each of so many bytes at least
	uint32_t n = count();
	if ( n > ( file_size - at ) / least_bytes ) damaged( "it ends too early" );
	return n;
}
static uint32_t below( uint32_t limit ) {
	uint32_t i = count();
	if ( i >= limit ) damaged( "an index is too large" );
	return i;
}
static double checked( double value, double least, double most ) {
	if ( !( value >= least && value <= most ) ) damaged( "a number is out of its range" );
	return value;
}
static double any_real( void ) {
	uint64_t bits = little_endian( 8 );
	double value;
	memcpy( &value, &bits, 8 );
	return value;
}
static double real( double least, double most ) { return checked( any_real(), least, most ); }
static double short_real( void ) {
	uint32_t bits = (uint32_t)little_endian( 4 );
	float value;
	memcpy( &value, &bits, 4 );
	return checked( value, -1e6, 1e6 );
}
static char* words( void ) {
	uint32_t n = count_of( 1 );
	char* text = new_array( n, 1 );
	for ( uint32_t i = 0; i < n; ++i ) {
		unsigned c = byte();
		text[i] = c < 32 || c == 127 ? '?' : (char)c;
	}
	return text;
}
static vec unit( vec v ) { return scale( 1 / checked( norm( v ), 1e-6, 1e6 ), v ); }
static vec read_vec( void ) {
	double x = real( -1e6, 1e6 ), y = real( -1e6, 1e6 ), z = real( -1e6, 1e6 );
	return vec_of( x, y, z );
}
static pose read_pose( void ) { // x y z, and a quaternion x y z w of any length
	pose p;
	p.t = read_vec();
	double q[4], size = 0;
	for ( int i = 0; i < 4; ++i ) q[i] = real( -2, 2 ), size += q[i] * q[i];
	size = sqrt( checked( size, 0.01, 16 ) );
	double x = q[0] / size, y = q[1] / size, z = q[2] / size, w = q[3] / size;
	p.c[0] = vec_of( 1 - 2 * ( y * y + z * z ), 2 * ( x * y + w * z ), 2 * ( x * z - w * y ) );
	p.c[1] = vec_of( 2 * ( x * y - w * z ), 1 - 2 * ( x * x + z * z ), 2 * ( y * z + w * x ) );
	p.c[2] = vec_of( 2 * ( x * z + w * y ), 2 * ( y * z - w * x ), 1 - 2 * ( x * x + y * y ) );
	return p;
}

// ---- shapes: convex elements, and a tree of halves of their index range

enum { TRIANGLES = 1, BALLS, BOXES, CYLINDER, CAPSULE, CONE, HALFSPACE, PLANE };
typedef struct { uint32_t begin, end; vec middle, half; double radius; } range; // its box, and a sphere around the box's middle
typedef struct {
	unsigned kind, solid;
	double radius, height, *numbers;
	uint32_t elements, *corners;
	range* ranges; // in the order whole, first half with its halves, second half
} shape;
static int unbounded( const shape* s ) { return s->kind == HALFSPACE || s->kind == PLANE; }
static uint32_t second_half( const range* r, uint32_t i ) { return i + 2 * ( ( r[i].end - r[i].begin ) / 2 ); }
static vec number_vec( const shape* s, size_t first ) { return vec_of( s->numbers[first], s->numbers[first + 1], s->numbers[first + 2] ); }
static vec corner( const shape* s, uint32_t element, int i ) { return number_vec( s, 3 * (size_t)s->corners[3 * (size_t)element + (size_t)i] ); }
/// Height of the farthest point of an element in direction n, whose length is `size`.
static double element_support( const shape* s, uint32_t e, vec n, double size ) {
	double flat = sqrt( n.x * n.x + n.y * n.y ), up = fabs( n.z ) * s->height / 2;
	const double *b = s->numbers + 6 * (size_t)e, *c = s->numbers + 4 * (size_t)e;
	switch ( s->kind ) {
	case TRIANGLES: return fmax( dot( corner( s, e, 0 ), n ), fmax( dot( corner( s, e, 1 ), n ), dot( corner( s, e, 2 ), n ) ) ) + s->radius * size;
	case BALLS: return c[0] * n.x + c[1] * n.y + c[2] * n.z + c[3] * size;
	case BOXES: return fmax( b[0] * n.x, b[3] * n.x ) + fmax( b[1] * n.y, b[4] * n.y ) + fmax( b[2] * n.z, b[5] * n.z );
	case CYLINDER: return up + s->radius * flat;
	case CAPSULE: return up + s->radius * size;
	default: return fmax( n.z * s->height / 2, -n.z * s->height / 2 + s->radius * flat ); // a cone: its apex or its base
	}
}
/// Radius of a sphere around `from` that contains an element.
static double element_radius( const shape* s, uint32_t e, vec from ) {
	if ( s->kind == TRIANGLES ) return s->radius + fmax( norm( sub( corner( s, e, 0 ), from ) ), fmax( norm( sub( corner( s, e, 1 ), from ) ), norm( sub( corner( s, e, 2 ), from ) ) ) );
	if ( s->kind == BALLS ) return norm( sub( number_vec( s, 4 * (size_t)e ), from ) ) + s->numbers[4 * (size_t)e + 3];
	if ( s->kind == BOXES ) {
		vec a = number_vec( s, 6 * (size_t)e ), b = number_vec( s, 6 * (size_t)e + 3 );
		return norm( sub( scale( 0.5, add( a, b ) ), from ) ) + norm( scale( 0.5, sub( b, a ) ) );
	}
	return norm( from ) + ( s->kind == CAPSULE ? s->height / 2 + s->radius : sqrt( s->radius * s->radius + s->height * s->height / 4 ) );
}
static uint32_t make_ranges( shape* s, uint32_t i, uint32_t begin, uint32_t end ) { // returns the next free index
	range* r = s->ranges + i;
	r->begin = begin, r->end = end;
	vec high, low;
	if ( end - begin == 1 ) {
		double side[6];
		for ( int k = 0; k < 6; ++k ) side[k] = element_support( s, begin, scale( k < 3 ? 1 : -1, unit_vec( k % 3 ) ), 1 );
		high = vec_of( side[0], side[1], side[2] ), low = vec_of( -side[3], -side[4], -side[5] );
		r->middle = scale( 0.5, add( low, high ) ), r->half = scale( 0.5, sub( high, low ) );
		r->radius = element_radius( s, begin, r->middle );
		return i + 1;
	}
	uint32_t middle = begin + ( end - begin ) / 2, second = make_ranges( s, i + 1, begin, middle ), next = make_ranges( s, second, middle, end );
	const range *a = r + 1, *b = s->ranges + second;
	vec a_high = add( a->middle, a->half ), b_high = add( b->middle, b->half ), a_low = sub( a->middle, a->half ), b_low = sub( b->middle, b->half );
	high = vec_of( fmax( a_high.x, b_high.x ), fmax( a_high.y, b_high.y ), fmax( a_high.z, b_high.z ) );
	low = vec_of( fmin( a_low.x, b_low.x ), fmin( a_low.y, b_low.y ), fmin( a_low.z, b_low.z ) );
	r->middle = scale( 0.5, add( low, high ) ), r->half = scale( 0.5, sub( high, low ) );
	r->radius = fmin( norm( r->half ), fmax( norm( sub( a->middle, r->middle ) ) + a->radius, norm( sub( b->middle, r->middle ) ) + b->radius ) );
	return next;
}
static double box_support( const range* r, vec n ) {
	return dot( r->middle, n ) + fabs( n.x ) * r->half.x + fabs( n.y ) * r->half.y + fabs( n.z ) * r->half.z;
}
/// The greatest height of a range's points in direction n, or `best` if that is more: parts whose boxes are lower are passed over.
static double support( const shape* s, uint32_t i, vec n, double size, double best ) {
	const range* r = s->ranges;
	if ( r[i].end - r[i].begin == 1 ) return fmax( best, element_support( s, r[i].begin, n, size ) );
	uint32_t first = i + 1, second = second_half( r, i );
	double a = box_support( r + first, n ), b = box_support( r + second, n );
	if ( a >= b && a > best ) best = support( s, first, n, size, best );
	if ( b > best ) best = support( s, second, n, size, best );
	return a < b && a > best ? support( s, first, n, size, best ) : best;
}

// ---- the model

#define NONE 0xffffffffu
typedef struct { char *name, *joint; uint32_t parent, depth; pose origin; unsigned type; vec axis; uint32_t variable; double multiplier, offset; } link;
typedef struct { char* name; double lower, upper, tolerance, lag, spread, since; uint32_t track; unsigned moves; } variable;
typedef struct { uint32_t owner; const shape* shape; pose pose; } placed;
typedef struct { unsigned object; uint32_t a, b; double value; char* reason; } rule; // an allowed pair, or a margin
typedef struct { const placed *a, *b; unsigned object, moves, late; uint32_t ancestor; double need; } pair; // late: of several tracks
static double min_d, rounding; static unsigned claims;
static link* links; static variable* variables; static shape* shapes; static placed *bodies, *obstacles;
static char** objects; static rule *allowed, *margins; static pair* pairs;
static uint32_t link_count, variable_count, shape_count, body_count, object_count, obstacle_count, allowed_count, margin_count, pair_count;
static void read_links( void ) {
	link_count = count_of( 60 );
	links = new_array( link_count, sizeof( *links ) );
	for ( uint32_t i = 0; i < link_count; ++i ) {
		link* l = links + i;
		l->name = words(), l->joint = words();
		l->parent = below( i == 0 ? 1 : i );
		l->depth = i == 0 ? 0 : links[l->parent].depth + 1;
		checked( l->depth, 0, 100 );
		l->origin = read_pose(), l->type = byte(), l->variable = NONE;
		checked( l->type, 0, i == 0 ? 0 : 2 );
		if ( l->type != 0 ) {
			l->axis = unit( read_vec() );
			l->variable = below( variable_count + 1 ) - 1; // 0: none
			l->multiplier = real( -1000, 1000 ), l->offset = real( -1000, 1000 );
		}
	}
	checked( link_count, 1, 1e6 );
}
static void read_shapes( void ) {
	shape_count = count_of( 20 );
	shapes = new_array( shape_count, sizeof( *shapes ) );
	for ( uint32_t i = 0; i < shape_count; ++i ) {
		shape* s = shapes + i;
		free( words() );
		s->kind = byte();
		unsigned flags = byte();
		checked( s->kind, TRIANGLES, PLANE );
		checked( flags, 0, 3 );
		s->solid = flags >> 1;
		s->radius = real( 0, 1e6 ), s->height = real( 0, 1e6 );
		uint32_t n = count_of( flags & 1 ? 4 : 8 );
		s->numbers = new_array( n, sizeof( double ) );
		for ( uint32_t k = 0; k < n; ++k ) s->numbers[k] = flags & 1 ? short_real() : real( -1e6, 1e6 );
		uint32_t m = count_of( 1 ), wide = s->kind == BALLS ? 4 : s->kind == BOXES ? 6 : 3;
		s->corners = new_array( m, sizeof( *s->corners ) );
		for ( uint32_t k = 0; k < m; ++k ) s->corners[k] = below( n / 3 );
		s->elements = s->kind == TRIANGLES ? m / 3 : s->kind <= BOXES ? n / wide : 1;
		if ( n % wide != 0 || m % 3 != 0 || s->elements == 0 || ( s->kind != TRIANGLES && m != 0 ) || ( s->kind > BOXES && n != 0 ) ) damaged( "a shape is not as its kind demands" );
		for ( uint32_t e = 0; e < s->elements && s->kind <= BOXES; ++e ) {
			for ( size_t k = 0; k < 3 && s->kind == BOXES; ++k ) checked( s->numbers[6 * (size_t)e + 3 + k], s->numbers[6 * (size_t)e + k], 1e6 );
			if ( s->kind == BALLS ) checked( s->numbers[4 * (size_t)e + 3], 0, 1e6 );
		}
		if ( unbounded( s ) ) continue;
		s->ranges = new_array( 2 * (size_t)s->elements, sizeof( range ) );
		make_ranges( s, 0, 0, s->elements );
		double whole = 0;
		for ( uint32_t e = 0; e < s->elements; ++e ) whole = fmax( whole, element_radius( s, e, s->ranges[0].middle ) );
		s->ranges[0].radius = fmin( s->ranges[0].radius, whole );
	}
}
static placed* read_placed( uint32_t* n, uint32_t owners, int bounded ) {
	*n = count_of( 58 );
	placed* list = new_array( *n, sizeof( placed ) );
	for ( uint32_t i = 0; i < *n; ++i ) {
		list[i].owner = below( owners ), list[i].shape = shapes + below( shape_count ), list[i].pose = read_pose();
		if ( bounded && unbounded( list[i].shape ) ) damaged( "a body of the robot is unbounded" );
	}
	return list;
}
static rule* read_rules( uint32_t* n, int with_value ) {
	*n = count_of( 4 );
	rule* list = new_array( *n, sizeof( rule ) );
	for ( uint32_t i = 0; i < *n; ++i ) {
		checked( list[i].object = byte(), 0, 1 );
		list[i].a = below( link_count );
		list[i].b = below( list[i].object ? object_count : link_count );
		if ( with_value ) list[i].value = real( 0, 1e6 );
		else list[i].reason = words();
	}
	return list;
}
static void skip_digest( int tells ) { // SHA-256: --files prints those of the sources, check_certificate.py compares
	for ( unsigned i = 0, b = 0; i < 32; ++i ) if ( b = byte(), tells ) printf( "%02x", b );
}
static void read_sources( int tells ) {
	uint32_t n = count_of( 33 );
	for ( uint32_t i = 0; i < n; ++i ) {
		char* name = words();
		skip_digest( tells );
		if ( tells ) printf( "  %s\n", name );
		free( name );
	}
}
static void read_model( int tells ) {
	for ( const char* c = "LWCERT2\n"; *c; ++c ) if ( byte() != (unsigned char)*c ) damaged( "it is no certificate of version 2" );
	checked( claims = byte(), 1, 3 );
	variable_count = count_of( 17 );
	variables = new_array( variable_count, sizeof( *variables ) );
	for ( uint32_t i = 0; i < variable_count; ++i ) variables[i].name = words(), variables[i].lower = any_real(), variables[i].upper = any_real();
	read_links();
	read_shapes();
	bodies = read_placed( &body_count, link_count, 1 );
	object_count = count_of( 1 );
	objects = new_array( object_count, sizeof( *objects ) );
	for ( uint32_t i = 0; i < object_count; ++i ) objects[i] = words();
	obstacles = read_placed( &obstacle_count, object_count, 0 );
	allowed = read_rules( &allowed_count, 0 );
	margins = read_rules( &margin_count, 1 );
	skip_digest( 0 );
	min_d = real( 0, 1e6 );
	read_sources( tells );
	for ( variable* v = variables; v < variables + variable_count; ++v ) {
		v->track = count(), v->tolerance = real( 0, 1000 ), v->lag = real( 0, 1e6 ), v->spread = real( 0, 1e6 ), v->since = real( -1e9, 1e9 );
	}
}

// ---- the pairs that must be proved

static int is_about( const rule* r, unsigned object, uint32_t a, uint32_t b ) {
	return r->object == object && ( ( r->a == a && r->b == b ) || ( !object && r->a == b && r->b == a ) );
}
static void add_pair( const placed* a, const placed* b, unsigned object ) {
	for ( uint32_t i = 0; i < allowed_count; ++i ) if ( is_about( allowed + i, object, a->owner, b->owner ) ) return;
	// Up to the lowest link above both; obstacles stand in the frame above the root
	uint32_t x = a->owner, y = object ? 0 : b->owner, track = NONE;
	pair p = { a, b, object, 0, 0, 0, min_d };
	while ( x != y ) {
		uint32_t *lower = links[x].depth >= links[y].depth ? &x : &y, v = links[*lower].variable;
		p.moves |= v != NONE;
		if ( v != NONE && variables[v].moves ) p.late |= track != NONE && track != variables[v].track, track = variables[v].track;
		*lower = links[*lower].parent;
	}
	if ( !object && !p.moves ) return; // rigid against each other
	p.ancestor = x;
	double margin = 0;
	for ( uint32_t i = 0; i < margin_count; ++i ) if ( is_about( margins + i, object, a->owner, b->owner ) ) margin = fmax( margin, margins[i].value );
	p.need += margin;
	pairs[pair_count++] = p;
}
static void make_pairs( void ) {
	pairs = new_array( (size_t)body_count * obstacle_count + (size_t)body_count * body_count / 2, sizeof( *pairs ) );
	for ( uint32_t i = 0; i < body_count; ++i ) for ( uint32_t j = 0; j < obstacle_count && ( claims & 1 ); ++j ) add_pair( bodies + i, obstacles + j, 1 );
	for ( uint32_t i = 0; i < body_count; ++i ) for ( uint32_t j = i + 1; j < body_count && ( claims & 2 ); ++j ) add_pair( bodies + i, bodies + j, 0 );
}

// ---- windows

static uint32_t piece, piece_count;
static size_t* rows;  // of each piece: its first control point, the last one of the piece before
static double *points_of_all, *times, *timely, *late; // times: of the pieces' ends
/// How far each variable may be from the piece, and how much farther beside another track: FORMAT.md, "One clock"
static void make_tubes( void ) {
	double most_lag = 0;
	for ( size_t j = 0; j < variable_count; ++j ) most_lag = fmax( most_lag, variables[j].lag );
	for ( size_t j = 0; j < variable_count; ++j ) {
		const variable* v = variables + j;
		double until = fmin( times[piece + 1] + most_lag, times[piece_count] ), low = HUGE_VAL, high = -HUGE_VAL, speed = 0;
		timely[j] = v->tolerance + v->spread * fmax( 0, until - v->since ), late[j] = 0;
		for ( uint32_t i = 0; v->lag > 0 && i < piece_count; ++i ) {
			if ( times[i] > times[piece + 1] + v->lag + 1e-6 || times[i + 1] < times[piece] - v->lag - 1e-6 ) continue;
			for ( size_t k = rows[i]; k <= rows[i + 1]; ++k ) {
				double q = points_of_all[k * variable_count + j], step = k > rows[i] ? fabs( q - points_of_all[( k - 1 ) * variable_count + j] ) : 0;
				low = fmin( low, q ), high = fmax( high, q );
				if ( step > 0 ) speed = fmax( speed, (double)( rows[i + 1] - rows[i] ) * step / ( times[i + 1] - times[i] ) );
			}
			late[j] = fmin( high - low, v->lag * speed );
		}
	}
}

typedef struct window {
	double *points, *speed, *rest; // control points; |value - middle - s speed| <= rest for an s in [-1, 1]
	pose* poses;                   // world from link at the middle state
	double begin, end;
	struct window* halves[2];
} window;
static void halve( const double* points, unsigned degree, double* first, double* second ) {
	size_t n = variable_count;
	memcpy( second, points, ( degree + 1 ) * n * sizeof( double ) );
	for ( unsigned level = 0; level <= degree; ++level ) { // de Casteljau at one half; `second` becomes the later half from its end
		memcpy( first + level * n, second, n * sizeof( double ) );
		for ( size_t i = 0; i < ( degree - level ) * n; ++i ) second[i] = 0.5 * ( second[i] + second[i + n] );
	}
}
static window* new_window( const double* points, unsigned degree, double begin, double end ) {
	size_t n = variable_count, size = ( degree + 1 ) * n;
	window* w = new_array( 1, sizeof( window ) );
	w->points = new_array( 3 * size + 2 * n, sizeof( double ) );
	w->speed = w->points + size, w->rest = w->speed + n;
	w->begin = begin, w->end = end;
	memcpy( w->points, points, size * sizeof( double ) );
	double *first = w->rest + n, *middle = first + size;
	halve( points, degree, first, middle );
	for ( size_t j = 0; j < n; ++j ) {
		w->speed[j] = 0.5 * ( points[degree * n + j] - points[j] );
		double rest = 0;
		for ( unsigned i = 0; i <= degree; ++i ) rest = fmax( rest, fabs( points[i * n + j] - middle[j] - ( 2.0 * i / degree - 1 ) * w->speed[j] ) );
		w->rest[j] = rest + timely[j];
	}
	w->poses = new_array( link_count, sizeof( pose ) );
	for ( uint32_t i = 0; i < link_count; ++i ) {
		const link* l = links + i;
		double value = checked( l->offset + ( l->variable != NONE ? l->multiplier * middle[l->variable] : 0 ), -1000, 1000 );
		pose p = l->origin;
		if ( l->type == 2 ) p.t = apply( &p, scale( value, l->axis ) );
		if ( l->type == 1 ) { // Rodrigues' formula for each column
			pose turn = { { unit_vec( 0 ), unit_vec( 1 ), unit_vec( 2 ) }, { 0, 0, 0 } };
			for ( int k = 0; k < 3; ++k ) {
				vec e = turn.c[k];
				turn.c[k] = add( scale( cos( value ), e ), add( scale( sin( value ), cross( l->axis, e ) ), scale( ( 1 - cos( value ) ) * dot( l->axis, e ), l->axis ) ) );
			}
			p = compose( &p, &turn );
		}
		w->poses[i] = i == 0 ? p : compose( w->poses + l->parent, &p );
	}
	return w;
}
static void free_window( window* w ) {
	for ( int i = 0; w && i < 2; ++i ) free_window( w->halves[i] );
	if ( w ) free( w->points ), free( w->poses );
	free( w );
}

// ---- one side of a pair at a middle state, and how it moves in the window: FORMAT.md, "Motion in a window"

typedef struct { const placed* body; const shape* shape; uint32_t range, owner, ancestor; unsigned late; } part;
typedef struct { pose pose; vec middle, turn, shift; double radius, rest, path; } side;
static side side_of( const part* p, int on_link, const window* w ) {
	side s;
	memset( &s, 0, sizeof( s ) );
	s.pose = on_link ? compose( w->poses + p->owner, &p->body->pose ) : p->body->pose;
	if ( unbounded( p->shape ) ) return s;
	s.radius = p->shape->ranges[p->range].radius;
	s.middle = apply( &s.pose, p->shape->ranges[p->range].middle );
	double below_sum = 0, turns = 0;
	for ( uint32_t i = p->owner; on_link && i != p->ancestor; i = links[i].parent ) {
		const link* l = links + i;
		if ( l->variable == NONE ) continue;
		double tube = w->rest[l->variable] + ( p->late ? late[l->variable] : 0 );
		double speed = l->multiplier * w->speed[l->variable], rest = fabs( l->multiplier ) * tube, e = fabs( speed ) + rest;
		vec axis = rotate( w->poses + i, l->axis ), origin = w->poses[i].t;
		if ( l->type == 2 ) {
			s.shift = add( s.shift, scale( speed, axis ) );
			s.rest += rest, s.path += e, below_sum += e;
			continue;
		}
		double centre = norm( cross( axis, sub( s.middle, origin ) ) ), rho = centre + s.radius;
		s.turn = add( s.turn, scale( speed, axis ) );
		s.shift = add( s.shift, scale( speed, cross( origin, axis ) ) );
		s.rest += rho * ( rest + e * e / 2 ) + e * below_sum;
		s.path += centre * e, below_sum += rho * e, turns += e;
	}
	if ( turns > 50 ) s.rest = s.path = HUGE_VAL; // the rounding does not cover that
	return s;
}
static double spheres_room( const part* a, const part* b, const pair* p, const window* w ) {
	side x = side_of( a, 1, w ), y = side_of( b, !p->object, w );
	double gap = norm( sub( y.middle, x.middle ) );
	if ( unbounded( b->shape ) ) gap = dot( y.pose.c[2], sub( x.middle, y.pose.t ) );
	if ( b->shape->kind == PLANE ) gap = fabs( gap );
	return gap - x.radius - y.radius - x.path - y.path - p->need - rounding;
}
static double plane_room( const part* a, const part* b, const pair* p, const window* w, vec n ) {
	side x = side_of( a, 1, w ), y = side_of( b, !p->object, w );
	// Of a plane: its own, from the side that it may be seen from
	if ( unbounded( b->shape ) ) n = b->shape->kind == PLANE && dot( n, y.pose.c[2] ) > 0 ? y.pose.c[2] : scale( -1, y.pose.c[2] );
	double room = HUGE_VAL;
	for ( int s = -1; s <= 1; s += 2 ) {
		vec up = add( n, scale( s, cross( n, x.turn ) ) ), down = scale( -1, add( n, scale( s, cross( n, y.turn ) ) ) );
		double top = support( a->shape, a->range, rotate_back( &x.pose, up ), norm( up ), -HUGE_VAL ) + dot( up, x.pose.t ) + s * dot( n, x.shift );
		double bottom = dot( n, y.pose.t );
		if ( !unbounded( b->shape ) ) bottom = s * dot( n, y.shift ) - support( b->shape, b->range, rotate_back( &y.pose, down ), norm( down ), -HUGE_VAL ) - dot( down, y.pose.t );
		room = fmin( room, bottom - top );
	}
	return room - x.rest - y.rest - p->need - rounding;
}
static uint64_t windows;
static void demand( double room, const pair* p, const window* w, const char* test ) {
	++windows;
	if ( !( room > 0 ) ) {
		printf( "rejected: piece %u, %s - %s, t in [%g, %g]: %s leaves %.3g m\n", piece + 1, links[p->a->owner].name,
			p->object ? objects[p->b->owner] : links[p->b->owner].name, w->begin, w->end, test, room );
		exit( 1 );
	}
}
static void check( const pair* p, part a, part b, unsigned degree, window* w ) {
	unsigned word = byte();
	if ( word == 0 ) { // the window's halves
		double middle = 0.5 * ( w->begin + w->end );
		if ( !( w->end - w->begin > 1e-15 ) ) damaged( "a window is too short" );
		if ( !w->halves[0] ) {
			size_t size = ( degree + 1 ) * (size_t)variable_count;
			double* points = new_array( 2 * size, sizeof( double ) );
			halve( w->points, degree, points, points + size );
			w->halves[0] = new_window( points, degree, w->begin, middle );
			w->halves[1] = new_window( points + size, degree, middle, w->end );
			free( points );
		}
		check( p, a, b, degree, w->halves[0] );
		check( p, a, b, degree, w->halves[1] );
	} else if ( word == 1 ) demand( spheres_room( &a, &b, p, w ), p, w, "the distance of two spheres" );
	else if ( word <= 4 ) {
		double n[3];
		int bytes = 1 << ( word - 2 ); // two's complement, all three scaled alike
		for ( int i = 0; i < 3; ++i ) n[i] = (int32_t)( (uint32_t)little_endian( bytes ) << ( 32 - 8 * bytes ) );
		vec direction = vec_of( n[0], n[1], n[2] );
		checked( norm( direction ), 1, 1e10 );
		demand( plane_room( &a, &b, p, w, scale( 1 / norm( direction ), direction ) ), p, w, "a separating plane" );
	} else if ( word <= 6 ) { // the halves of a part
		part* divided = word == 5 ? &a : &b;
		const shape* s = divided->shape;
		uint32_t i = divided->range;
		if ( unbounded( s ) || s->solid || s->ranges[i].end - s->ranges[i].begin < 2 ) damaged( "a part is divided that has no parts" );
		divided->range = i + 1;
		check( p, a, b, degree, w );
		divided->range = second_half( s->ranges, i );
		check( p, a, b, degree, w );
	} else damaged( "an unknown word" );
}
static void check_piece( unsigned degree, const double* points ) {
	make_tubes();
	window* whole = new_window( points, degree, 0, 1 );
	uint64_t by_spheres = count();
	for ( uint32_t i = 0; i < pair_count; ++i ) {
		const pair* p = pairs + i;
		if ( piece > 0 && !p->moves ) continue; // at rest: proved on the first piece
		part a = { p->a, p->a->shape, 0, p->a->owner, p->ancestor, p->late }, b = { p->b, p->b->shape, 0, p->b->owner, p->ancestor, p->late };
		if ( by_spheres > 0 ) {
			--by_spheres;
			demand( spheres_room( &a, &b, p, whole ), p, whole, "the distance of two spheres" );
			continue;
		}
		check( p, a, b, degree, whole );
		by_spheres = count();
	}
	if ( by_spheres != 0 ) damaged( "it counts more pairs than there are" );
	free_window( whole );
}
static double extent( const placed* p ) {
	return norm( p->pose.t ) + ( unbounded( p->shape ) ? 0 : norm( p->shape->ranges[0].middle ) + norm( p->shape->ranges[0].half ) );
}
/// Metres that cover the rounding of every test: 1e-10 of all lengths. FORMAT.md, "Rounding"
static double rounding_of( const double* points, size_t n ) {
	double robot = 0, body = 0, obstacle = 0;
	for ( uint32_t i = 0; i < link_count; ++i ) {
		double most = 0;
		for ( size_t k = 0; k < n && links[i].variable != NONE; ++k ) most = fmax( most, fabs( points[k * variable_count + links[i].variable] ) );
		robot += norm( links[i].origin.t ) + ( links[i].type == 2 ? fabs( links[i].offset ) + fabs( links[i].multiplier ) * most : 0 );
	}
	for ( uint32_t i = 0; i < body_count; ++i ) body = fmax( body, extent( bodies + i ) );
	for ( uint32_t i = 0; i < obstacle_count; ++i ) obstacle = fmax( obstacle, extent( obstacles + i ) );
	return 1e-10 * ( robot + body + obstacle );
}
static void check_motion( void ) {
	double begin = real( -1e9, 1e9 );
	piece_count = count_of( 17 );
	size_t n = variable_count;
	checked( variable_count, 1, 1e6 );
	checked( piece_count, 1, 1e9 );
	rows = new_array( piece_count + 1, sizeof( *rows ) );
	double* q = points_of_all = new_array( ( file_size - at ) / 8, sizeof( double ) );
	times = new_array( piece_count + 1, sizeof( double ) ), timely = new_array( n, sizeof( double ) ), late = new_array( n, sizeof( double ) );
	times[0] = begin;
	for ( uint32_t k = 0; k <= piece_count; ++k ) { // the first point, then each piece's others: pieces are joined
		unsigned degree = k > 0 ? byte() : 1;
		checked( degree, 1, 7 );
		if ( k > 0 ) times[k] = times[k - 1] + real( 0, 1e9 ), rows[k] = rows[k - 1] + degree;
		for ( size_t i = 0; i < degree * n; ++i ) *q++ = real( -1000, 1000 );
	}
	size_t used = rows[piece_count] + 1;
	for ( size_t i = 0; i < used * n; ++i ) variables[i % n].moves |= points_of_all[i] != points_of_all[i % n];
	make_pairs();
	rounding = rounding_of( points_of_all, used );
	if ( file_size - at < 32 ) damaged( "it ends too early" );
	file_size -= 32; // of the last SHA-256
	for ( piece = 0; piece < piece_count; ++piece ) check_piece( (unsigned)( rows[piece + 1] - rows[piece] ), points_of_all + rows[piece] * n );
	unsigned outside = 0;
	for ( size_t i = 0; i < used * n; ++i ) outside += !( points_of_all[i] >= variables[i % n].lower - 1e-5 && points_of_all[i] <= variables[i % n].upper + 1e-5 );
	if ( at != file_size ) damaged( "bytes follow the proof" );
	printf( "accepted: %u pieces from %g to %g s, %u pairs (%s), %llu windows; distances > %.9g m; joint limits %s; %u pairs may touch and are not proved\n",
		piece_count, times[0], times[piece_count], pair_count, claims == 3 ? "obstacles and links" : claims == 1 ? "obstacles" : "links", (unsigned long long)windows,
		min_d, outside ? "exceeded" : "kept", allowed_count );
}

int main( int argc, char** argv ) {
	const char* name = NULL;
	int lists = 0, files = 0, i = 1;
	for ( ; i < argc; ++i ) strcmp( argv[i], "--files" ) == 0 ? files = 1 : strcmp( argv[i], "--pairs" ) == 0 ? lists = 1 : ( name = argv[i], 0 );
	FILE* in = name ? fopen( name, "rb" ) : NULL;
	if ( !in ) {
		printf( "damaged: no certificate can be read; usage: check [--files] [--pairs] FILE\n" );
		return 2;
	}
	for ( size_t room = 1u << 20, got = 1; got > 0; room *= 2 ) {
		unsigned char* larger = realloc( file_bytes, room );
		if ( !larger ) damaged( "it needs more memory than there is" );
		file_bytes = larger;
		file_size += got = fread( file_bytes + file_size, 1, room - file_size, in );
	}
	fclose( in );
	read_model( files );
	check_motion();
	for ( uint32_t k = 0; k < allowed_count && lists; ++k ) {
		const rule* r = allowed + k;
		printf( "not proved: %s - %s (%s)\n", links[r->a].name, r->object ? objects[r->b] : links[r->b].name, r->reason );
	}
	return 0;
}
