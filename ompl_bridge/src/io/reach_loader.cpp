// SPDX-License-Identifier: BSD-3-Clause
// Motion hulls and pair tables of a robot: from the cache, or built and kept there.
#include "cache_file.hpp"

#include <cstring>

namespace leeway::io
{

namespace
{

/// What a cached reach was built with, kept beside it.
struct Effort
{
	double seconds = 0;
	std::uint64_t samples = 0, seed = 0;

	std::vector<std::uint64_t> words() const
	{
		std::uint64_t bits;
		std::memcpy( &bits, &seconds, sizeof( bits ) );
		return { bits, samples, seed };
	}
	bool set( const std::vector<std::uint64_t>& words )
	{
		if ( words.size() != 3 )
		{
			return false;
		}
		std::memcpy( &seconds, &words[0], sizeof( seconds ) );
		samples = words[1];
		seed = words[2];
		return true;
	}
	bool covers( const Effort& other ) const
	{
		return seconds >= other.seconds && samples >= other.samples && seed == other.seed;
	}
};

/// Robots that differ in anything that matters have other keys; so has another version of the library.
lw_digest keyOf( const lw_robot* robot )
{
	return detail::digestWords( lw_robot_digest( robot ), { lw_version() } );
}

/// Empty, with a notice, if this build of the library cannot make hulls: they are there for speed only.
Reach build( const Robot& robot, lw_reach_def def, std::vector<Notice>& notices )
{
	lw_reach* reach = nullptr;
	lw_diag diag{};
	def.robot = robot.get();
	lw_status status = lw_reach_create( &def, nullptr, &diag, &reach );
	if ( status == LW_ERROR_UNSUPPORTED )
	{
		notices.push_back( { "", "motion hulls", std::string( "are not used: " ) + diag.message } );
		return Reach();
	}
	require( status, diag );
	return Reach::adopt( reach );
}

} // namespace

double detail::reachSeconds( const std::vector<std::uint64_t>& words )
{
	Effort effort;
	return effort.set( words ) ? effort.seconds : 0;
}

LoadedReach loadReach( const Robot& robot, const ReachOptions& options )
{
	detail::Stopwatch watch;
	LoadedReach loaded;
	Effort wanted{ options.def.seconds, options.def.samples, options.def.seed };
	lw_digest key{};
	if ( !options.cache.empty() )
	{
		detail::prepareCacheFolder( options.cache );
		key = keyOf( robot.get() );
		loaded.file = detail::cacheFileName( options.cache, lw_robot_name( robot.get() ), key, "reach" );
		Effort spent;
		lw_reach* reach = nullptr;
		bool good = detail::readCacheFile( loaded.file, key, loaded.notices,
		    [&]( detail::CacheFile& content, lw_diag& diag )
		    {
			    return !spent.set( content.words ) ? LW_ERROR_DAMAGED
			                                       : lw_blob_read_reach( content.blob.data(), content.blob.size(), key,
			                                             robot.get(), nullptr, &diag, &reach );
		    } );
		Reach cached = Reach::adopt( good ? reach : nullptr );
		if ( good && ( options.accept_less || spent.covers( wanted ) ) )
		{
			loaded.reach = cached;
			loaded.cached = true;
			loaded.seconds_spent = spent.seconds;
		}
	}
	if ( !loaded.reach && options.build )
	{
		loaded.reach = build( robot, options.def, loaded.notices );
		loaded.seconds_spent = wanted.seconds;
		if ( loaded.reach && !loaded.file.empty() )
		{
			lw_blob_def def = lw_blob_def_default();
			def.key = key;
			def.reach = loaded.reach.get();
			detail::writeCacheFile( loaded.file, key, def, wanted.words(), options.cache_limit, loaded.notices );
		}
	}
	loaded.milliseconds = watch.milliseconds();
	return loaded;
}

} // namespace leeway::io
