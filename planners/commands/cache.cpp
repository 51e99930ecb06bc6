// SPDX-License-Identifier: BSD-3-Clause
// leeway cache: lists the cache folder and limits its size.
#include "motions/json.hpp"
#include "program/options.hpp"
#include "program/output.hpp"

#include "leeway/io/cache.hpp"

#include <fmt/format.h>

#include <ctime>
#include <filesystem>
#include <iterator>

namespace leeway::cli
{
namespace
{

const char* kindName( io::CacheEntry::Kind kind )
{
	switch ( kind )
	{
	case io::CacheEntry::tree:
		return "tree";
	case io::CacheEntry::reach:
		return "reach";
	case io::CacheEntry::leftover:
		return "leftover";
	default:
		return "foreign";
	}
}

std::string describe( const io::CacheEntry& entry )
{
	switch ( entry.kind )
	{
	case io::CacheEntry::tree:
		return !entry.good ? entry.problem : fmt::format( "{} triangles", entry.triangles );
	case io::CacheEntry::reach:
		return !entry.good
		           ? entry.problem
		           : fmt::format( "hulls and tables, {} of {} pairs proved, {} can touch, {} open; {:.1f} s, proofs {}",
		                 entry.proved, entry.pairs, entry.contact, entry.open, entry.seconds,
		                 entry.complete ? "complete" : "not complete" );
	case io::CacheEntry::leftover:
		return "of a write that did not end, or of an older leeway";
	default:
		return "not leeway's, left alone";
	}
}

std::string timeText( std::int64_t seconds )
{
	const std::time_t time = static_cast<std::time_t>( seconds );
	std::tm parts{};
	char text[32] = "";
	if ( gmtime_r( &time, &parts ) != nullptr )
	{
		std::strftime( text, sizeof( text ), "%Y-%m-%dT%H:%M:%SZ", &parts );
	}
	return text;
}

std::string listText( const std::vector<io::CacheEntry>& entries )
{
	std::string text = fmt::format( "{:<8} {:>12} {:<20}  {}\n", "kind", "bytes", "last used", "contents" );
	std::uint64_t bytes = 0;
	std::size_t count = 0;
	for ( const io::CacheEntry& entry : entries )
	{
		const std::string name =
		    entry.kind == io::CacheEntry::foreign ? std::filesystem::path( entry.file ).filename().string() : entry.name;
		fmt::format_to( std::back_inserter( text ), "{:<8} {:>12} {:<20}  {}: {}\n", kindName( entry.kind ), entry.bytes,
		    timeText( entry.used ), name, describe( entry ) );
		bytes += entry.kind == io::CacheEntry::foreign ? 0 : entry.bytes;
		count += entry.kind == io::CacheEntry::foreign ? 0 : 1;
	}
	return text + fmt::format( "{} files of leeway, {} bytes\n", count, bytes );
}

Json listJson( const std::vector<io::CacheEntry>& entries )
{
	Json json = Json::array();
	for ( const io::CacheEntry& entry : entries )
	{
		json.push_back( { { "file", entry.file }, { "kind", kindName( entry.kind ) }, { "name", entry.name },
		    { "bytes", entry.bytes }, { "used", entry.used }, { "good", entry.good }, { "problem", entry.problem },
		    { "triangles", entry.triangles }, { "seconds", entry.seconds }, { "pairs", entry.pairs },
		    { "proved", entry.proved }, { "contact", entry.contact }, { "open", entry.open },
		    { "complete", entry.complete } } );
	}
	return json;
}

} // namespace

int runCache( const CacheOptions& options )
{
	OutputFile json_file( "--json", options.json );
	const std::string folder = options.folder.empty() ? io::defaultCacheFolder() : options.folder;
	if ( folder.empty() )
	{
		throw io::Error(
		    "command line", "--cache", "neither XDG_CACHE_HOME nor HOME says where caches are", "add --cache DIR" );
	}
	if ( options.folder.empty() && !std::filesystem::exists( folder ) )
	{
		printOut( fmt::format( "{}: there is no cache yet\n", folder ) );
		json_file.text = jsonText(
		    Json{ { "folder", folder }, { "removed_files", 0 }, { "removed_bytes", 0 }, { "files", Json::array() } } );
		if ( !options.json.empty() )
		{
			json_file.commit();
		}
		return exit_yes;
	}
	const bool trim = options.clean || options.limit >= 0;
	io::TrimmedCache trimmed;
	if ( trim )
	{
		trimmed = io::trimCache( folder, options.clean ? 0 : static_cast<std::uint64_t>( options.limit * 1e6 ) );
		printOut( fmt::format(
		    "{} files with {} bytes removed, {} bytes left\n", trimmed.files, trimmed.bytes, trimmed.remaining ) );
	}
	const std::vector<io::CacheEntry> entries = io::listCache( folder );
	if ( !trim )
	{
		printOut( folder + "\n" + listText( entries ) );
	}
	if ( !options.json.empty() )
	{
		Json json = { { "folder", folder }, { "removed_files", trimmed.files }, { "removed_bytes", trimmed.bytes },
		    { "files", listJson( entries ) } };
		json_file.text = jsonText( json );
		json_file.commit();
	}
	return exit_yes;
}

} // namespace leeway::cli
