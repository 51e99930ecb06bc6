// SPDX-License-Identifier: BSD-3-Clause
// A cache folder as a whole: telling files apart by their names, looking into them, removing the least recently used.
#include "cache/cache_file.hpp"
#include "leeway/io/cache.hpp"

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace leeway::io
{

namespace
{

namespace fs = std::filesystem;

constexpr std::size_t digest_digits = 32;
constexpr std::int64_t abandoned_seconds = 3600; ///< no write takes that long

bool isHex( const std::string& text )
{
	return text.find_first_not_of( "0123456789abcdef" ) == std::string::npos;
}

/// "<name>-<32 hex digits>": splits it. False for any other stem.
bool splitStem( const std::string& stem, std::string& name, lw_digest& key )
{
	if ( stem.size() < digest_digits + 1 || stem[stem.size() - digest_digits - 1] != '-' ||
	     !isHex( stem.substr( stem.size() - digest_digits ) ) )
	{
		return false;
	}
	name = stem.substr( 0, stem.size() - digest_digits - 1 );
	key.word[0] = std::stoull( stem.substr( stem.size() - digest_digits, 16 ), nullptr, 16 );
	key.word[1] = std::stoull( stem.substr( stem.size() - 16 ), nullptr, 16 );
	return true;
}

/// Kind and name, from the file's name alone. @param key of a tree or reach
CacheEntry classify( const fs::path& file, lw_digest& key )
{
	CacheEntry entry;
	entry.file = file.string();
	std::string leaf = file.filename().string(), ending = file.extension().string();
	std::size_t partial = leaf.rfind( ".partial-" );
	fs::path whole = partial != std::string::npos ? fs::path( leaf.substr( 0, partial ) ) : fs::path( leaf );
	std::string kind = whole.extension().string();
	bool ours =
	    ( kind == ".tree" || kind == ".reach" || kind == ".trees" ) && splitStem( whole.stem().string(), entry.name, key );
	entry.kind = !ours                                              ? CacheEntry::foreign
	             : partial != std::string::npos || kind == ".trees" ? CacheEntry::leftover
	             : kind == ".tree"                                  ? CacheEntry::tree
	                                                                : CacheEntry::reach;
	return entry;
}

/// All regular files, most recently used first.
std::vector<std::pair<CacheEntry, lw_digest>> entries( const std::string& folder )
{
	std::error_code error;
	fs::directory_iterator all( folder, error );
	if ( error )
	{
		throw Error(
		    folder, "cache", "the folder cannot be read: " + error.message(), "name a folder that leeway has used" );
	}
	std::vector<std::pair<CacheEntry, lw_digest>> found;
	for ( fs::directory_iterator end; all != end && !error; all.increment( error ) )
	{
		struct stat status;
		if ( ::lstat( all->path().c_str(), &status ) != 0 || !S_ISREG( status.st_mode ) )
		{
			continue; // removed meanwhile, or no file
		}
		lw_digest key{};
		CacheEntry entry = classify( all->path(), key );
		entry.bytes = static_cast<std::uint64_t>( status.st_size );
		entry.used = static_cast<std::int64_t>( status.st_mtim.tv_sec ); // set by readCacheFile()
		found.emplace_back( entry, key );
	}
	std::sort( found.begin(), found.end(),
	    []( const auto& a, const auto& b )
	    { return a.first.used != b.first.used ? a.first.used > b.first.used : a.first.file < b.first.file; } );
	return found;
}

void lookInto( lw_digest key, CacheEntry& entry )
{
	detail::CacheFile content;
	lw_blob_info info{};
	lw_diag diag{};
	try
	{
		bool whole = detail::splitCacheFile( detail::readFile( entry.file ), key, content );
		lw_status status =
		    whole ? lw_blob_get_info( content.blob.data(), content.blob.size(), &diag, &info ) : LW_ERROR_DAMAGED;
		entry.good =
		    status == LW_OK && lw_digest_equal( info.key, key ) && info.has_reach == ( entry.kind == CacheEntry::reach );
		entry.problem = entry.good ? "" : status == LW_ERROR_STALE ? "of another version of leeway" : "damaged";
	}
	catch ( const Error& unreadable )
	{
		entry.good = false;
		entry.problem = unreadable.problem();
	}
	if ( entry.good )
	{
		entry.triangles = detail::treeTriangles( content.words );
		if ( entry.kind == CacheEntry::reach )
		{
			detail::fillReachEntry( content.words, entry );
		}
	}
}

} // namespace

std::string defaultCacheFolder()
{
	const auto absolute = []( const char* name )
	{
		const char* value = std::getenv( name );
		return value != nullptr && fs::path( value ).is_absolute() ? fs::path( value ) : fs::path();
	};
	const fs::path caches = absolute( "XDG_CACHE_HOME" ), home = absolute( "HOME" );
	return !caches.empty() ? ( caches / "leeway" ).string() : !home.empty() ? ( home / ".cache" / "leeway" ).string() : "";
}

bool isUsableCache( const std::string& folder )
{
	std::error_code error;
	if ( folder.empty() )
	{
		return false;
	}
	fs::create_directories( folder, error );
	return fs::is_directory( folder, error ) && ::access( folder.c_str(), R_OK | W_OK | X_OK ) == 0;
}

std::vector<CacheEntry> listCache( const std::string& folder )
{
	std::vector<CacheEntry> list;
	for ( auto& [entry, key] : entries( folder ) )
	{
		if ( entry.kind == CacheEntry::tree || entry.kind == CacheEntry::reach )
		{
			lookInto( key, entry );
		}
		list.push_back( entry );
	}
	return list;
}

TrimmedCache trimCache( const std::string& folder, std::uint64_t limit )
{
	TrimmedCache result;
	std::int64_t now = static_cast<std::int64_t>( std::time( nullptr ) );
	const auto remove = [&]( const CacheEntry& entry )
	{
		std::error_code error;
		bool gone = fs::remove( entry.file, error ) && !error; // false: somebody else removed it
		result.files += gone ? 1 : 0;
		result.bytes += gone ? entry.bytes : 0;
		return gone || !fs::exists( entry.file, error );
	};
	std::vector<std::pair<CacheEntry, lw_digest>> all = entries( folder );
	for ( const auto& [entry, key] : all )
	{
		result.remaining += entry.kind != CacheEntry::foreign ? entry.bytes : 0;
	}
	const auto abandoned = [&]( const CacheEntry& entry )
	{
		bool write = entry.file.find( ".partial-" ) != std::string::npos;
		return entry.kind == CacheEntry::leftover && ( !write || now - entry.used > abandoned_seconds );
	};
	for ( auto oldest = all.rbegin(); oldest != all.rend(); ++oldest )
	{
		const CacheEntry& entry = oldest->first;
		bool cached = entry.kind == CacheEntry::tree || entry.kind == CacheEntry::reach;
		if ( ( abandoned( entry ) || ( cached && result.remaining > limit ) ) && remove( entry ) )
		{
			result.remaining -= entry.bytes;
		}
	}
	return result;
}

} // namespace leeway::io
