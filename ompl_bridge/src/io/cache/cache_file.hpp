// SPDX-License-Identifier: BSD-3-Clause
// Files of a cache folder: a blob of the core, and a few words of its owner beside it.
#pragma once

#include "base/io_internal.hpp"
#include "leeway/io/cache.hpp"

#include <cstdint>
#include <functional>

namespace leeway::io::detail
{

/// Makes the folder if it is missing. @throws Error if it is no folder and cannot be made one
void prepareCacheFolder( const std::string& folder );

/// "<folder>/<name>-<key as 32 hex digits>.<ending>"; characters of the name that are unfit for file names become _.
std::string cacheFileName( const std::string& folder, const std::string& name, lw_digest key, const char* ending );

/// The digest of a text or a file's bytes, continued.
lw_digest digestText( lw_digest from, const std::string& text );
lw_digest digestWords( lw_digest from, const std::vector<std::uint64_t>& words );

struct CacheFile
{
	std::string blob;
	std::vector<std::uint64_t> words;
};

/// The triangle count in the words of a mesh's cache file; 0 if the words are not those of a mesh.
std::uint32_t treeTriangles( const std::vector<std::uint64_t>& words );
/// Copies the counts of pairs and the time in the words of a robot's cache file to the entry.
void fillReachEntry( const std::vector<std::uint64_t>& words, CacheEntry& entry );

/// Reads a cache file and passes its content to `use`.
/// @param use returns a status of the core; the notice about a failure quotes its diag
/// @return true if the file exists and `use` accepted it. Any other file gets a notice, and will be replaced.
bool readCacheFile( const std::string& file, lw_digest key, std::vector<Notice>& notices,
    const std::function<lw_status( CacheFile&, lw_diag& )>& use );

/// Splits the bytes of a file; false if they are none of ours.
bool splitCacheFile( std::string bytes, lw_digest key, CacheFile& out );

/// Writes under a temporary name and renames. Now and then it removes the least recently used files, until the folder holds
/// at most `limit` bytes. A cache that cannot be written costs only time, and gets a notice.
void writeCacheFile( const std::string& file, lw_digest key, const lw_blob_def& content,
    const std::vector<std::uint64_t>& words, std::uint64_t limit, std::vector<Notice>& notices );

} // namespace leeway::io::detail
