// SPDX-License-Identifier: BSD-3-Clause
// Blobs: header, checksum, table of sections; the checks that come before any content is read. Docs: blobs.md.
#include "blob/blob.h"
#include "simd/tree_layout.h"

enum
{
	BLOB_COOKIE = 0x6c77426c, // "lwBl"
	VERSION = 7,              // raised when the format, or the promises of its contents, change
	SECTION_SHAPE = 1,        // shapes come first
	SECTION_REACH = 2         // at most one, last
};

/// Not text (first byte), not cut to 7 bits, line ends not converted, not printed by a careless `type`: as PNG's.
static const unsigned char magic[8] = { 0x8c, 'L', 'W', 'B', '\r', '\n', 0x1a, '\n' };

/// The properties of a build on which the bytes in memory depend.
static void get_layout( unsigned char layout[8] )
{
	const uint32_t order = 0x01020304u;
	memcpy( layout, &order, sizeof( order ) );
	layout[4] = sizeof( double );
	layout[5] = sizeof( float );
	layout[6] = LWI_WIDTH;
	layout[7] = LWI_MAX_DEPTH;
}

// ---- numbers of the header: little-endian, so that the checksum can be tested on any machine ------------------------

static uint64_t load_number( const unsigned char* p, int size )
{
	uint64_t value = 0;
	for ( int i = 0; i < size; ++i )
	{
		value |= (uint64_t)p[i] << 8 * i;
	}
	return value;
}

static void store_number( unsigned char* p, uint64_t value, int size )
{
	for ( int i = 0; i < size; ++i )
	{
		p[i] = (unsigned char)( value >> 8 * i );
	}
}

static lw_digest load_digest( const unsigned char* p )
{
	return ( lw_digest ){ { load_number( p, 8 ), load_number( p + 8, 8 ) } };
}

static void store_digest( unsigned char* p, lw_digest digest )
{
	store_number( p, digest.word[0], 8 );
	store_number( p + 8, digest.word[1], 8 );
}

/// Of everything but itself.
static lw_digest checksum( const unsigned char* bytes, size_t size )
{
	lw_digest before = lw_digest_bytes( ( lw_digest ){ { 0, 0 } }, bytes, LWI_BLOB_CHECKSUM );
	return lw_digest_bytes( before, bytes + LWI_BLOB_VERSION, size - LWI_BLOB_VERSION );
}

void lwi_blob_seal( unsigned char* bytes, size_t size )
{
	store_digest( bytes + LWI_BLOB_CHECKSUM, checksum( bytes, size ) );
}

// ---- writing --------------------------------------------------------------------------------------------------------

lw_blob_def lw_blob_def_default( void )
{
	return ( lw_blob_def ){ .cookie = BLOB_COOKIE };
}

static size_t aligned( size_t size )
{
	return ( size + ( LWI_BLOB_SECTION_ALIGNMENT - 1 ) ) & ~(size_t)( LWI_BLOB_SECTION_ALIGNMENT - 1 );
}

static lw_status check_def( const lw_blob_def* def, void** out_bytes, size_t* out_size, lw_diag* diag )
{
	if ( out_bytes == NULL || out_size == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"out_bytes or out_size is NULL; pass where to store the blob" );
	}
	*out_bytes = NULL;
	*out_size = 0;
	if ( def == NULL || def->cookie != BLOB_COOKIE )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_DEF, LW_INVALID_INDEX,
			"the blob def was not made by lw_blob_def_default()" );
	}
	for ( uint32_t i = 0; i < def->shape_count; ++i )
	{
		if ( def->shapes == NULL || def->shapes[i] == NULL )
		{
			return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, i, "shape %u of %u is NULL; leave missing shapes out", i,
				def->shape_count );
		}
	}
	for ( uint32_t i = 0; i < def->shape_count; ++i )
	{
		lw_status status = lw_shape_complete( def->shapes[i], diag );
		if ( status != LW_OK )
		{
			return status;
		}
	}
	return LW_OK;
}

/// Header without checksum, and the table, into w->bytes; sections behind them. Only counts if w->bytes is NULL.
static void write_sections( lwi_writer* w, const lw_blob_def* def )
{
	static const unsigned char zeros[LWI_BLOB_SECTION_ALIGNMENT] = { 0 };
	size_t count = (size_t)def->shape_count + ( def->reach != NULL ? 1u : 0u );
	w->at = LWI_BLOB_TABLE + count * LWI_BLOB_TABLE_ENTRY;
	for ( size_t i = 0; i < count; ++i )
	{
		bool is_shape = i < def->shape_count;
		size_t begin = w->at;
		if ( is_shape )
		{
			lwi_blob_write_shape( w, def->shapes[i] );
		}
		else
		{
			lwi_blob_write_reach( w, def->reach );
		}
		size_t size = w->at - begin;
		lwi_write( w, zeros, aligned( size ) - size );
		if ( w->bytes != NULL )
		{
			unsigned char* entry = w->bytes + LWI_BLOB_TABLE + i * LWI_BLOB_TABLE_ENTRY;
			store_number( entry, is_shape ? SECTION_SHAPE : SECTION_REACH, 4 );
			store_number( entry + 4, 0, 4 );
			store_number( entry + 8, size, 8 );
		}
	}
	if ( w->bytes != NULL )
	{
		memcpy( w->bytes + LWI_BLOB_MAGIC, magic, sizeof( magic ) );
		store_number( w->bytes + LWI_BLOB_SIZE, w->at, 8 );
		store_number( w->bytes + LWI_BLOB_VERSION, VERSION, 4 );
		store_number( w->bytes + LWI_BLOB_SECTION_COUNT, count, 4 );
		get_layout( w->bytes + LWI_BLOB_LAYOUT );
		store_digest( w->bytes + LWI_BLOB_KEY, def->key );
	}
}

lw_status lw_blob_write( const lw_blob_def* def, const lw_allocator* allocator, lw_diag* diag, void** out_bytes,
	size_t* out_size )
{
	lw_status status = check_def( def, out_bytes, out_size, diag );
	if ( status != LW_OK )
	{
		return status;
	}
	lwi_writer counter = { NULL, 0, 0 };
	write_sections( &counter, def );
	lw_allocator memory = lwi_allocator_or_default( allocator );
	lwi_writer w = { lwi_alloc( &memory, counter.at ), counter.at, 0 };
	if ( w.bytes == NULL )
	{
		return lwi_out_of_memory( diag, "a blob" );
	}
	write_sections( &w, def );
	lwi_blob_seal( w.bytes, w.at );
	*out_bytes = w.bytes;
	*out_size = w.at;
	return LW_OK;
}

void lw_blob_free( const lw_allocator* allocator, void* bytes, size_t size )
{
	lw_allocator memory = lwi_allocator_or_default( allocator );
	lwi_free( &memory, bytes, size );
}

// ---- reading --------------------------------------------------------------------------------------------------------

/// A blob whose header and table hold.
typedef struct envelope
{
	const unsigned char* bytes;
	size_t size;
	lw_digest key;
	uint32_t section_count, shape_count;
} envelope;

/// Complete and unchanged since it was written: magic, size, checksum. Holds for blobs of all versions.
static lw_status check_intact( const unsigned char* bytes, size_t size, lw_diag* diag )
{
	if ( bytes == NULL || size < LWI_BLOB_TABLE )
	{
		return lwi_fail( diag, LW_ERROR_DAMAGED, LW_INVALID_INDEX, "blob: %zu bytes are too few for any" LWI_BLOB_REMEDY,
			bytes != NULL ? size : 0 );
	}
	if ( memcmp( bytes + LWI_BLOB_MAGIC, magic, sizeof( magic ) ) != 0 )
	{
		return lwi_fail( diag, LW_ERROR_DAMAGED, LW_INVALID_INDEX, "not a blob of leeway: its first bytes are others" );
	}
	uint64_t stated = load_number( bytes + LWI_BLOB_SIZE, 8 );
	if ( stated != size )
	{
		return lwi_fail( diag, LW_ERROR_DAMAGED, LW_INVALID_INDEX,
			"blob: it was written with %llu bytes and has %zu" LWI_BLOB_REMEDY, (unsigned long long)stated, size );
	}
	if ( !lw_digest_equal( load_digest( bytes + LWI_BLOB_CHECKSUM ), checksum( bytes, size ) ) )
	{
		return lwi_fail( diag, LW_ERROR_DAMAGED, LW_INVALID_INDEX,
			"blob: its checksum does not match, it was changed after it was written" LWI_BLOB_REMEDY );
	}
	return LW_OK;
}

/// Checks the version of the format, and that this build has the same numbers and trees byte by byte.
static lw_status check_origin( const unsigned char* bytes, lw_diag* diag )
{
	uint64_t version = load_number( bytes + LWI_BLOB_VERSION, 4 );
	if ( version != VERSION )
	{
		return lwi_fail( diag, LW_ERROR_STALE, LW_INVALID_INDEX,
			"blob: format version %llu, this library reads %d" LWI_BLOB_REMEDY, (unsigned long long)version, (int)VERSION );
	}
	unsigned char layout[8];
	get_layout( layout );
	const unsigned char* written = bytes + LWI_BLOB_LAYOUT;
	if ( memcmp( written, layout, 4 ) != 0 )
	{
		return lwi_fail( diag, LW_ERROR_STALE, LW_INVALID_INDEX,
			"blob: written on a machine of another byte order" LWI_BLOB_REMEDY );
	}
	if ( memcmp( written, layout, sizeof( layout ) ) != 0 )
	{
		return lwi_fail( diag, LW_ERROR_STALE, LW_INVALID_INDEX,
			"blob: written by a build with another layout of trees (nodes of %u children, here %u)" LWI_BLOB_REMEDY,
			(unsigned)written[6], (unsigned)layout[6] );
	}
	return LW_OK;
}

/// Shapes first, then at most one reach, and together as long as the blob.
static bool table_holds( envelope* e )
{
	if ( e->section_count > ( e->size - LWI_BLOB_TABLE ) / LWI_BLOB_TABLE_ENTRY )
	{
		return false;
	}
	size_t left = e->size - LWI_BLOB_TABLE - (size_t)e->section_count * LWI_BLOB_TABLE_ENTRY;
	for ( uint32_t i = 0; i < e->section_count; ++i )
	{
		const unsigned char* entry = e->bytes + LWI_BLOB_TABLE + (size_t)i * LWI_BLOB_TABLE_ENTRY;
		uint64_t kind = load_number( entry, 4 ), size = load_number( entry + 8, 8 );
		bool known = kind == SECTION_SHAPE || ( kind == SECTION_REACH && i + 1 == e->section_count );
		// the first comparison keeps aligned() from overflowing
		if ( !known || load_number( entry + 4, 4 ) != 0 || size > left || aligned( (size_t)size ) > left )
		{
			return false;
		}
		e->shape_count += kind == SECTION_SHAPE ? 1u : 0u;
		left -= aligned( (size_t)size );
	}
	return left == 0;
}

static lw_status open_envelope( const void* bytes, size_t size, lw_diag* diag, envelope* out )
{
	lw_status status = check_intact( bytes, size, diag );
	if ( status == LW_OK )
	{
		status = check_origin( bytes, diag );
	}
	if ( status != LW_OK )
	{
		return status;
	}
	const unsigned char* b = bytes;
	*out =
		( envelope ){ b, size, load_digest( b + LWI_BLOB_KEY ), (uint32_t)load_number( b + LWI_BLOB_SECTION_COUNT, 4 ), 0 };
	if ( !table_holds( out ) )
	{
		return lwi_fail( diag, LW_ERROR_DAMAGED, LW_INVALID_INDEX,
			"blob: its table of sections makes no sense" LWI_BLOB_REMEDY );
	}
	return LW_OK;
}

/// The same, and made from the caller's inputs.
static lw_status open_keyed( const void* bytes, size_t size, lw_digest key, lw_diag* diag, envelope* out )
{
	lw_status status = open_envelope( bytes, size, diag, out );
	if ( status == LW_OK && !lw_digest_equal( out->key, key ) )
	{
		status = lwi_fail( diag, LW_ERROR_STALE, LW_INVALID_INDEX,
			"blob: made of other contents (key %016llx, now %016llx)" LWI_BLOB_REMEDY, (unsigned long long)out->key.word[0],
			(unsigned long long)key.word[0] );
	}
	return status;
}

static size_t first_section( const envelope* e )
{
	return LWI_BLOB_TABLE + (size_t)e->section_count * LWI_BLOB_TABLE_ENTRY;
}

/// Section number `section`, which begins at *at; *at becomes the begin of the next one.
static lwi_reader next_section( const envelope* e, uint32_t section, size_t* at )
{
	const unsigned char* entry = e->bytes + LWI_BLOB_TABLE + (size_t)section * LWI_BLOB_TABLE_ENTRY;
	size_t size = (size_t)load_number( entry + 8, 8 ), begin = *at;
	*at += aligned( size );
	return ( lwi_reader ){ e->bytes + begin, size, 0, false };
}

lw_status lw_blob_get_info( const void* bytes, size_t size, lw_diag* diag, lw_blob_info* out )
{
	if ( out == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "out is NULL" );
	}
	*out = ( lw_blob_info ){ 0 };
	envelope e;
	lw_status status = open_envelope( bytes, size, diag, &e );
	if ( status == LW_OK )
	{
		*out = ( lw_blob_info ){ VERSION, e.key, e.shape_count, e.section_count > e.shape_count };
	}
	return status;
}

lw_status lw_blob_read_shapes( const void* bytes, size_t size, lw_digest key, const lw_allocator* allocator, lw_diag* diag,
	lw_shape** out_shapes, uint32_t shape_count )
{
	if ( out_shapes == NULL && shape_count > 0 )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "out_shapes is NULL; pass room for %u shapes",
			shape_count );
	}
	for ( uint32_t i = 0; i < shape_count; ++i )
	{
		out_shapes[i] = NULL;
	}
	envelope e;
	lw_status status = open_keyed( bytes, size, key, diag, &e );
	if ( status == LW_OK && e.shape_count != shape_count )
	{
		status = lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"the blob holds %u shapes, room was given for %u; lw_blob_get_info() tells the count", e.shape_count,
			shape_count );
	}
	lw_allocator memory = lwi_allocator_or_default( allocator );
	size_t at = status == LW_OK ? first_section( &e ) : 0;
	for ( uint32_t i = 0; status == LW_OK && i < shape_count; ++i )
	{
		lwi_reader r = next_section( &e, i, &at );
		status = lwi_blob_read_shape( &r, i, &memory, diag, &out_shapes[i] );
	}
	for ( uint32_t i = 0; status != LW_OK && i < shape_count; ++i )
	{
		lw_shape_release( out_shapes[i] );
		out_shapes[i] = NULL;
	}
	return status;
}

lw_status lw_blob_read_reach( const void* bytes, size_t size, lw_digest key, const lw_robot* robot,
	const lw_allocator* allocator, lw_diag* diag, lw_reach** out_reach )
{
	if ( out_reach == NULL || robot == NULL )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX, "robot or out_reach is NULL" );
	}
	*out_reach = NULL;
	envelope e;
	lw_status status = open_keyed( bytes, size, key, diag, &e );
	if ( status != LW_OK )
	{
		return status;
	}
	if ( e.section_count == e.shape_count )
	{
		return lwi_fail( diag, LW_ERROR_INVALID_ARGUMENT, LW_INVALID_INDEX,
			"the blob holds no reach, only %u shapes; lw_blob_get_info() tells", e.shape_count );
	}
	lw_allocator memory = lwi_allocator_or_default( allocator );
	size_t at = first_section( &e );
	for ( uint32_t i = 0; i < e.shape_count; ++i )
	{
		next_section( &e, i, &at );
	}
	lwi_reader r = next_section( &e, e.shape_count, &at );
	return lwi_blob_read_reach( &r, robot, &memory, diag, out_reach );
}
