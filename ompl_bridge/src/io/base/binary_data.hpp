// SPDX-License-Identifier: BSD-3-Clause
// Bytes and words of untrusted files: every read is checked against the end of the data.
#pragma once

#include "base/io_internal.hpp"

#include <cstdint>
#include <string_view>

namespace leeway::io::detail
{

/// Number types of point cloud files.
enum class ScalarType
{
	int8,
	uint8,
	int16,
	uint16,
	int32,
	uint32,
	int64,
	uint64,
	float32,
	float64
};

std::size_t scalarSize( ScalarType type );
/// @param bytes scalarSize() of them. @param big_endian of the file, whatever this machine is
double decodeScalar( const char* bytes, ScalarType type, bool big_endian );

/// A place in a text of bytes. Nothing is copied: the text outlives this.
class ByteReader
{
public:
	explicit ByteReader( std::string_view bytes ) : m_bytes( bytes ) {}

	std::size_t left() const { return m_bytes.size() - m_at; }
	/// The next `count` bytes; an empty optional if there are fewer.
	std::optional<std::string_view> take( std::size_t count );
	/// The next line without its end (\n or \r\n); an empty optional at the end of the text.
	std::optional<std::string_view> line();
	/// The next run of characters that are no blanks; empty at the end of the text.
	std::string_view word();
	std::string_view rest() const { return m_bytes.substr( m_at ); }

private:
	std::string_view m_bytes;
	std::size_t m_at = 0;
};

/// a * b; an empty optional if that is more than `limit`. Products of a header's numbers must not wrap around.
std::optional<std::size_t> productUpTo( std::size_t a, std::size_t b, std::size_t limit );

/// A whole number >= 0 that is all of `word`.
std::optional<std::size_t> parseCount( std::string_view word );

} // namespace leeway::io::detail
