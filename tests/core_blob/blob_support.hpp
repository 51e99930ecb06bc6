// SPDX-License-Identifier: BSD-3-Clause
// Blobs in tests: bytes in a heap block of exactly their size, so that a sanitizer sees every read past the end.
#pragma once

#include "blob/blob.h"
#include "random_reach.hpp"
#include "reachability/reach.h"
#include "seeded_rng.hpp"
#include "shapes.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <string>

/// Exact-size copies that may also begin at any offset from an aligned address.
class Bytes
{
public:
	Bytes( const void* data, std::size_t size, std::size_t offset = 0 )
	    : m_memory( new unsigned char[size + offset] ), m_offset( offset ), m_size( size )
	{
		if ( size > 0 )
		{
			std::memcpy( begin(), data, size );
		}
	}
	unsigned char* begin() const { return m_memory.get() + m_offset; }
	std::size_t size() const { return m_size; }
	void seal() { lwi_blob_seal( begin(), m_size ); }
	template <typename T> T get( std::size_t at ) const
	{
		T value;
		std::memcpy( &value, begin() + at, sizeof( T ) );
		return value;
	}
	template <typename T> void put( std::size_t at, T value ) { std::memcpy( begin() + at, &value, sizeof( T ) ); }
	bool operator==( const Bytes& other ) const
	{
		return m_size == other.m_size && std::memcmp( begin(), other.begin(), m_size ) == 0;
	}

private:
	std::unique_ptr<unsigned char[]> m_memory;
	std::size_t m_offset, m_size;
};

inline lw_tree_def treeDef( lw_sphere_fit fit, std::uint32_t leafSize, double tileRadius )
{
	return { fit, leafSize, tileRadius };
}

inline const lw_digest test_key = { { 0x0123456789abcdefull, 42 } };

inline Bytes writeBlob(
    const std::vector<const lw_shape*>& shapes, const lw_reach* reach = nullptr, const lw_allocator* allocator = nullptr )
{
	lw_blob_def def = lw_blob_def_default();
	def.key = test_key;
	def.shapes = shapes.data();
	def.shape_count = static_cast<std::uint32_t>( shapes.size() );
	def.reach = reach;
	void* bytes = nullptr;
	std::size_t size = 0;
	lw_diag diag = {};
	EXPECT_EQ( lw_blob_write( &def, allocator, &diag, &bytes, &size ), LW_OK ) << diag.message;
	Bytes copy( bytes, size );
	lw_blob_free( allocator, bytes, size );
	return copy;
}

inline Bytes writeBlob( const std::vector<ShapePtr>& shapes )
{
	std::vector<const lw_shape*> pointers;
	for ( const ShapePtr& shape : shapes )
	{
		pointers.push_back( shape.get() );
	}
	return writeBlob( pointers );
}

/// Reads `count` shapes; empty on failure.
inline std::vector<ShapePtr> readShapes( const Bytes& blob, std::size_t count, lw_status* status, lw_diag* diag = nullptr,
    const lw_allocator* allocator = nullptr )
{
	std::vector<lw_shape*> raw( count );
	for ( lw_shape*& shape : raw )
	{
		shape = reinterpret_cast<lw_shape*>( &raw ); // must be overwritten whatever happens
	}
	*status = lw_blob_read_shapes(
	    blob.begin(), blob.size(), test_key, allocator, diag, raw.data(), static_cast<std::uint32_t>( count ) );
	std::vector<ShapePtr> shapes;
	for ( lw_shape* shape : raw )
	{
		EXPECT_EQ( shape == nullptr, *status != LW_OK );
		if ( *status == LW_OK )
		{
			shapes.emplace_back( shape );
		}
	}
	return shapes;
}

inline lw_status readStatus( const Bytes& blob, std::size_t count, lw_diag* diag = nullptr )
{
	lw_status status = LW_OK;
	readShapes( blob, count, &status, diag );
	return status;
}
