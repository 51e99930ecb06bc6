// SPDX-License-Identifier: BSD-3-Clause
#include "view/encode.hpp"

#include <zlib.h>

namespace leeway::view
{

std::size_t PageBytes::append( const void* data, std::size_t size )
{
	m_bytes.resize( ( m_bytes.size() + 3 ) / 4 * 4 );
	const std::size_t at = m_bytes.size();
	m_bytes.append( static_cast<const char*>( data ), size );
	return at;
}

std::string gzip( const std::string& bytes )
{
	constexpr int gzip_format = 15 + 16; // the largest window, with the header of gzip
	z_stream stream = {};
	if ( deflateInit2( &stream, 9, Z_DEFLATED, gzip_format, 8, Z_DEFAULT_STRATEGY ) != Z_OK )
	{
		throw io::Error( "the page", "its data", "cannot be compressed", "free some memory" );
	}
	std::string out( deflateBound( &stream, static_cast<uLong>( bytes.size() ) ), '\0' );
	stream.next_in = reinterpret_cast<Bytef*>( const_cast<char*>( bytes.data() ) ); // zlib does not write there
	stream.avail_in = static_cast<uInt>( bytes.size() );
	stream.next_out = reinterpret_cast<Bytef*>( out.data() );
	stream.avail_out = static_cast<uInt>( out.size() );
	const int result = bytes.size() < UINT32_MAX ? deflate( &stream, Z_FINISH ) : Z_BUF_ERROR;
	out.resize( out.size() - stream.avail_out );
	deflateEnd( &stream );
	if ( result != Z_STREAM_END )
	{
		throw io::Error( "the page", "its data", "are larger than 4 GB", "show fewer meshes, or coarser ones (--detail)" );
	}
	return out;
}

std::string base64( const std::string& bytes )
{
	static const char* const digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	std::string out;
	out.reserve( ( bytes.size() + 2 ) / 3 * 4 );
	for ( std::size_t i = 0; i < bytes.size(); i += 3 )
	{
		std::uint32_t word = 0;
		for ( std::size_t k = 0; k < 3; ++k )
		{
			word = word << 8 | ( i + k < bytes.size() ? static_cast<unsigned char>( bytes[i + k] ) : 0U );
		}
		for ( std::size_t k = 0; k < 4; ++k )
		{
			out += i + k <= bytes.size() ? digits[word >> ( 18 - 6 * k ) & 63] : '=';
		}
	}
	return out;
}

std::string jsonForScript( const Json& json )
{
	std::string out;
	for ( const char c : json.dump( -1, ' ', false, Json::error_handler_t::replace ) )
	{
		// Inside of JSON these stand in strings only
		out += c == '<' ? "\\u003c" : c == '>' ? "\\u003e" : c == '&' ? "\\u0026" : std::string( 1, c );
	}
	return out;
}

} // namespace leeway::view
