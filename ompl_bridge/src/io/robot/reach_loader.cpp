// SPDX-License-Identifier: BSD-3-Clause
// Motion hulls and pair tables of a robot: from the cache, or built and kept there.
#include "cache/cache_file.hpp"
#include "leeway/io/cache.hpp"
#include "leeway/parallel.hpp"

#include <algorithm>
#include <cstring>
#include <thread>

namespace leeway::io
{

namespace
{

/// Robots that differ in anything that matters have other keys; so has another version of the library.
lw_digest keyOf( const lw_robot* robot )
{
	return detail::digestWords( lw_robot_digest( robot ), { lw_version() } );
}

/// Builds one, or goes on with one. Empty, with a notice, if this build of the library cannot make hulls: they are there for speed only.
Reach advance( const Robot& robot, const Reach& from, const ReachOptions& options, std::vector<Notice>& notices )
{
	lw_reach* reach = nullptr;
	lw_diag diag{};
	lw_reach_def def = options.def;
	unsigned threads = options.threads > 0 ? options.threads : std::max( 1u, std::thread::hardware_concurrency() );
	if ( def.parallel == nullptr && threads > 1 )
	{
		def.parallel = runTasks;
		def.parallel_user = &threads;
	}
	def.robot = from ? nullptr : robot.get();
	lw_status status = from ? lw_reach_continue( from.get(), &def, nullptr, &diag, &reach )
	                        : lw_reach_create( &def, nullptr, &diag, &reach );
	if ( status == LW_ERROR_UNSUPPORTED )
	{
		notices.push_back( { "", "motion hulls", std::string( "are not used: " ) + diag.message } );
		return from;
	}
	require( status, diag );
	return Reach::adopt( reach );
}

std::uint64_t bitsOf( double value )
{
	std::uint64_t bits;
	std::memcpy( &bits, &value, sizeof( bits ) );
	return bits;
}

/// Kept beside a reach, so that looking into a folder needs no robot.
std::vector<std::uint64_t> summary( const lw_reach_info& info )
{
	return { bitsOf( info.seconds ), info.pairs, info.proved, info.contact, info.open, info.complete ? 1u : 0u };
}

Reach readReach( const Robot& robot, lw_digest key, LoadedReach& loaded )
{
	lw_reach* reach = nullptr;
	const bool good = detail::readCacheFile( loaded.file, key, loaded.notices,
	    [&]( detail::CacheFile& content, lw_diag& diag ) {
		    return lw_blob_read_reach( content.blob.data(), content.blob.size(), key, robot.get(), nullptr, &diag, &reach );
	    } );
	return Reach::adopt( good ? reach : nullptr );
}

void writeReach( lw_digest key, const ReachOptions& options, LoadedReach& loaded )
{
	lw_blob_def def = lw_blob_def_default();
	def.key = key;
	def.reach = loaded.reach.get();
	detail::writeCacheFile(
	    loaded.file, key, def, summary( lw_reach_get_info( loaded.reach.get() ) ), options.cache_limit, loaded.notices );
}

/// True if there is more to prove, or to measure, than was.
bool isUnfinished( const Reach& reach, const ReachOptions& options )
{
	const lw_reach_info info = lw_reach_get_info( reach.get() );
	const bool more_samples = !options.def.hulls_only && info.samples < options.def.samples;
	return more_samples || ( options.def.seconds > 0 && !options.def.hulls_only && !info.complete );
}

} // namespace

void detail::fillReachEntry( const std::vector<std::uint64_t>& words, CacheEntry& entry )
{
	if ( words.size() == 6 )
	{
		std::memcpy( &entry.seconds, &words[0], sizeof( entry.seconds ) );
		entry.pairs = static_cast<std::uint32_t>( words[1] );
		entry.proved = static_cast<std::uint32_t>( words[2] );
		entry.contact = static_cast<std::uint32_t>( words[3] );
		entry.open = static_cast<std::uint32_t>( words[4] );
		entry.complete = words[5] != 0;
	}
}

ReachOptions cachedReach()
{
	ReachOptions options;
	const std::string folder = defaultCacheFolder();
	options.cache = isUsableCache( folder ) ? folder : "";
	return options;
}

LoadedReach loadReach( const Robot& robot, const ReachOptions& options )
{
	detail::Stopwatch watch;
	LoadedReach loaded;
	lw_digest key{};
	if ( !options.cache.empty() )
	{
		detail::prepareCacheFolder( options.cache );
		key = keyOf( robot.get() );
		loaded.file = detail::cacheFileName( options.cache, lw_robot_name( robot.get() ), key, "reach" );
		loaded.reach = readReach( robot, key, loaded );
		loaded.cached = static_cast<bool>( loaded.reach );
	}
	const bool other = loaded.reach && options.proceed && lw_reach_get_info( loaded.reach.get() ).seed != options.def.seed;
	if ( other )
	{
		loaded.reach = Reach(); // other random states were asked for
		loaded.cached = false;
	}
	if ( options.build && ( !loaded.reach || ( options.proceed && isUnfinished( loaded.reach, options ) ) ) )
	{
		loaded.reach = advance( robot, loaded.reach, options, loaded.notices );
		loaded.advanced = true;
		if ( loaded.reach && !loaded.file.empty() )
		{
			writeReach( key, options, loaded );
		}
	}
	loaded.info = loaded.reach ? lw_reach_get_info( loaded.reach.get() ) : lw_reach_info{};
	loaded.milliseconds = watch.milliseconds();
	return loaded;
}

} // namespace leeway::io
