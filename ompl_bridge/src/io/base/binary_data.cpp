// SPDX-License-Identifier: BSD-3-Clause
// Bytes and words of untrusted files: every read is checked against the end of the data.
#include "base/binary_data.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>

namespace leeway::io::detail
{

namespace
{

constexpr std::string_view blanks = " \t\r\n\v\f";

template <typename T> double decode( const char* bytes )
{
	T value;
	std::memcpy( &value, bytes, sizeof value );
	return static_cast<double>( value );
}

bool machineIsBigEndian()
{
	const std::uint16_t one = 1;
	char first = 0;
	std::memcpy( &first, &one, 1 );
	return first == 0;
}

} // namespace

std::size_t scalarSize( ScalarType type )
{
	switch ( type )
	{
	case ScalarType::int8:
	case ScalarType::uint8:
		return 1;
	case ScalarType::int16:
	case ScalarType::uint16:
		return 2;
	case ScalarType::int32:
	case ScalarType::uint32:
	case ScalarType::float32:
		return 4;
	default:
		return 8;
	}
}

double decodeScalar( const char* bytes, ScalarType type, bool big_endian )
{
	std::array<char, 8> turned{};
	if ( big_endian != machineIsBigEndian() )
	{
		std::size_t size = scalarSize( type );
		std::reverse_copy( bytes, bytes + size, turned.begin() );
		bytes = turned.data();
	}
	switch ( type )
	{
	case ScalarType::int8:
		return decode<std::int8_t>( bytes );
	case ScalarType::uint8:
		return decode<std::uint8_t>( bytes );
	case ScalarType::int16:
		return decode<std::int16_t>( bytes );
	case ScalarType::uint16:
		return decode<std::uint16_t>( bytes );
	case ScalarType::int32:
		return decode<std::int32_t>( bytes );
	case ScalarType::uint32:
		return decode<std::uint32_t>( bytes );
	case ScalarType::int64:
		return decode<std::int64_t>( bytes );
	case ScalarType::uint64:
		return decode<std::uint64_t>( bytes );
	case ScalarType::float32:
		return decode<float>( bytes );
	case ScalarType::float64:
		break;
	}
	return decode<double>( bytes );
}

std::optional<std::string_view> ByteReader::take( std::size_t count )
{
	if ( count > left() )
	{
		return std::nullopt;
	}
	std::string_view bytes = m_bytes.substr( m_at, count );
	m_at += count;
	return bytes;
}

std::optional<std::string_view> ByteReader::line()
{
	if ( left() == 0 )
	{
		return std::nullopt;
	}
	std::size_t end = m_bytes.find( '\n', m_at );
	std::string_view text = m_bytes.substr( m_at, end == std::string_view::npos ? end : end - m_at );
	m_at = end == std::string_view::npos ? m_bytes.size() : end + 1;
	if ( !text.empty() && text.back() == '\r' )
	{
		text.remove_suffix( 1 );
	}
	return text;
}

std::string_view ByteReader::word()
{
	std::size_t first = m_bytes.find_first_not_of( blanks, m_at );
	if ( first == std::string_view::npos )
	{
		m_at = m_bytes.size();
		return {};
	}
	std::size_t end = std::min( m_bytes.find_first_of( blanks, first ), m_bytes.size() );
	m_at = end;
	return m_bytes.substr( first, end - first );
}

std::optional<std::size_t> productUpTo( std::size_t a, std::size_t b, std::size_t limit )
{
	if ( b != 0 && a > limit / b )
	{
		return std::nullopt;
	}
	return a * b;
}

std::optional<std::size_t> parseCount( std::string_view word )
{
	std::size_t value = 0;
	auto [end, error] = std::from_chars( word.data(), word.data() + word.size(), value );
	return error == std::errc() && end == word.data() + word.size() ? std::optional<std::size_t>( value ) : std::nullopt;
}

} // namespace leeway::io::detail
