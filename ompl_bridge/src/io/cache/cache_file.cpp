// SPDX-License-Identifier: BSD-3-Clause
// Files of a cache folder. Layout: blob, the owner's words, their count, their digest (which continues from the key).
//
// Everything is in the machine's byte order; a file from a machine with the other one has no digest that fits.
#include "cache/cache_file.hpp"

#include "leeway/io/cache.hpp"

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fcntl.h>
#include <fstream>
#include <sys/stat.h>
#include <unistd.h>

namespace leeway::io::detail
{

namespace
{

constexpr std::size_t word_bytes = sizeof( std::uint64_t );
constexpr std::size_t tail_words = 3;          ///< count and digest
constexpr std::size_t longest_name_part = 100; ///< of the robot's name in a file name: file systems stop at 255

/// A folder is looked through when this process has written a sixteenth of the limit, and before that when it writes its first
/// file: it outgrows the limit by no more than that for each process.
void trimAfterWriting( const std::string& folder, std::size_t size, std::uint64_t limit )
{
	static std::atomic<std::uint64_t> written{ UINT64_MAX / 2 };
	if ( written.fetch_add( size ) + size < limit / 16 )
	{
		return;
	}
	written = 0;
	try
	{
		(void)trimCache( folder, limit );
	}
	catch ( const Error& )
	{
		// it is no folder any more: the next one who needs it will say so
	}
}

/// @return an error in words, empty if all went well
std::string writeBytes( const std::string& file, const std::vector<std::pair<const void*, std::size_t>>& parts )
{
	std::string temporary = file + ".partial-XXXXXX";
	int descriptor = mkstemp( temporary.data() );
	if ( descriptor < 0 )
	{
		return std::strerror( errno );
	}
	int error = 0;
	for ( auto [bytes, left] : parts )
	{
		for ( const char* at = static_cast<const char*>( bytes ); left > 0 && error == 0; )
		{
			ssize_t done = ::write( descriptor, at, left );
			error = done < 0 && errno != EINTR ? errno : 0;
			at += done > 0 ? done : 0;
			left -= done > 0 ? static_cast<std::size_t>( done ) : 0;
		}
	}
	mode_t mask = umask( 0 );
	umask( mask );
	fchmod( descriptor, 0666 & ~mask );
	error = close( descriptor ) != 0 && error == 0 ? errno : error;
	if ( error == 0 && std::rename( temporary.c_str(), file.c_str() ) != 0 )
	{
		error = errno;
	}
	if ( error != 0 )
	{
		unlink( temporary.c_str() );
	}
	return error != 0 ? std::strerror( error ) : "";
}

} // namespace

bool splitCacheFile( std::string bytes, lw_digest key, CacheFile& out )
{
	std::uint64_t tail[tail_words];
	if ( bytes.size() < sizeof( tail ) )
	{
		return false;
	}
	std::memcpy( tail, bytes.data() + bytes.size() - sizeof( tail ), sizeof( tail ) );
	if ( tail[0] > ( bytes.size() - sizeof( tail ) ) / word_bytes )
	{
		return false;
	}
	std::size_t count = static_cast<std::size_t>( tail[0] ), blob_size = bytes.size() - sizeof( tail ) - count * word_bytes;
	out.words.resize( count );
	if ( count > 0 )
	{
		std::memcpy( out.words.data(), bytes.data() + blob_size, count * word_bytes );
	}
	bytes.resize( blob_size );
	out.blob = std::move( bytes );
	return lw_digest_equal( digestWords( key, out.words ), lw_digest{ { tail[1], tail[2] } } );
}

void prepareCacheFolder( const std::string& folder )
{
	std::error_code error;
	std::filesystem::create_directories( folder, error );
	if ( !std::filesystem::is_directory( folder ) )
	{
		throw Error( folder, "cache",
		    error && error != std::errc::not_a_directory && error != std::errc::file_exists
		        ? "the folder cannot be made: " + error.message()
		        : "is not a folder",
		    "name a folder that can be written" );
	}
}

std::string cacheFileName( const std::string& folder, const std::string& name, lw_digest key, const char* ending )
{
	std::string plain = name.substr( 0, longest_name_part );
	for ( char& c : plain )
	{
		bool fit = ( c >= 'a' && c <= 'z' ) || ( c >= 'A' && c <= 'Z' ) || ( c >= '0' && c <= '9' ) || c == '-' || c == '_';
		c = fit ? c : '_';
	}
	std::string file = fmt::format( "{}-{:016x}{:016x}.{}", plain, key.word[0], key.word[1], ending );
	return ( std::filesystem::path( folder ) / file ).string();
}

lw_digest digestText( lw_digest from, const std::string& text )
{
	return lw_digest_bytes( from, text.data(), text.size() );
}

lw_digest digestWords( lw_digest from, const std::vector<std::uint64_t>& words )
{
	return lw_digest_bytes( from, words.data(), words.size() * word_bytes );
}

bool readCacheFile( const std::string& file, lw_digest key, std::vector<Notice>& notices,
    const std::function<lw_status( CacheFile&, lw_diag& )>& use )
{
	std::error_code error;
	const std::filesystem::file_status entry = std::filesystem::symlink_status( file, error );
	if ( !std::filesystem::exists( entry ) )
	{
		return false;
	}
	if ( !std::filesystem::is_regular_file( entry ) ) // reading a pipe would wait, and a link may lead to a device
	{
		notices.push_back( { file, "cache", "not used (it is no regular file): built anew, to replace it" } );
		return false;
	}
	std::string reason;
	try
	{
		CacheFile content;
		lw_diag diag{};
		lw_status status = LW_ERROR_DAMAGED;
		if ( splitCacheFile( readFile( file ), key, content ) )
		{
			status = use( content, diag );
		}
		if ( status == LW_OK )
		{
			// trimCache() goes by the time of the last change. The time of the last read depends on how the file system is
			// mounted, and listing the cache reads files without using them. The key in the name identifies the content,
			// so no real change needs this time.
			const timespec times[2] = { { 0, UTIME_OMIT }, { 0, UTIME_NOW } };
			(void)utimensat( AT_FDCWD, file.c_str(), times, 0 );
			return true;
		}
		reason = diag.message[0] != '\0' ? diag.message : status == LW_ERROR_STALE ? "it is stale" : "it is damaged";
	}
	catch ( const Error& unreadable )
	{
		reason = unreadable.problem();
	}
	notices.push_back( { file, "cache", fmt::format( "not used ({}): built anew, to replace it", reason ) } );
	return false;
}

void writeCacheFile( const std::string& file, lw_digest key, const lw_blob_def& content,
    const std::vector<std::uint64_t>& words, std::uint64_t limit, std::vector<Notice>& notices )
{
	void* blob = nullptr;
	std::size_t size = 0;
	lw_diag diag{};
	require( lw_blob_write( &content, nullptr, &diag, &blob, &size ), diag );
	lw_digest digest = digestWords( key, words );
	std::uint64_t tail[tail_words] = { words.size(), digest.word[0], digest.word[1] };
	std::string problem =
	    writeBytes( file, { { blob, size }, { words.data(), words.size() * word_bytes }, { tail, sizeof( tail ) } } );
	lw_blob_free( nullptr, blob, size );
	if ( !problem.empty() )
	{
		notices.push_back(
		    { file, "cache", fmt::format( "cannot be written ({}): the next start builds it again", problem ) } );
	}
	trimAfterWriting( std::filesystem::path( file ).parent_path().string(), size, limit );
}

} // namespace leeway::io::detail
