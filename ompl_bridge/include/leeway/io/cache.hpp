// SPDX-License-Identifier: BSD-3-Clause
// The cache folder, which keeps trees, hulls and tables between runs: its contents, and its size limit.
//
// Files are written under a temporary name and renamed, and are read whole: any number of processes may use a folder at the
// same time, and any file may be removed at any time. Files with names that leeway did not give are never changed.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace leeway::io
{

struct CacheEntry
{
	enum Kind
	{
		tree,     ///< the sphere tree of a mesh
		reach,    ///< motion hulls and pair tables of a robot
		leftover, ///< from an interrupted write or an older version of leeway
		foreign   ///< not written by leeway
	};
	std::string file; ///< path, folder included
	std::string name; ///< of the mesh or robot
	Kind kind = foreign;
	std::uint64_t bytes = 0;
	std::int64_t used = 0;       ///< seconds since 1970: last read or written by leeway
	bool good = true;            ///< tree or reach: the checksums match and the version is current
	std::string problem;         ///< why good is false
	std::uint32_t triangles = 0; ///< of a tree
	double seconds = 0;          ///< reach: time spent on proofs; the next members are as in lw_reach_info
	std::uint32_t pairs = 0, proved = 0, contact = 0, open = 0;
	bool complete = false;
};

/// The default cache folder: $XDG_CACHE_HOME/leeway, else $HOME/.cache/leeway. Empty if neither variable is an absolute
/// path. The folder need not exist.
std::string defaultCacheFolder();

/// True if files can be created in the folder, which is created if it is missing. False for "".
bool isUsableCache( const std::string& folder );

/// Contents of a folder, most recently used first. Reads and checks every file.
/// @throws Error if there is no such folder
std::vector<CacheEntry> listCache( const std::string& folder );

struct TrimmedCache
{
	std::size_t files = 0;       ///< removed files
	std::uint64_t bytes = 0;     ///< bytes of the removed files
	std::uint64_t remaining = 0; ///< bytes of the files that remain, without foreign ones
};

/// Removes leftovers (of writes: after an hour), then the least recently used files until at most `limit` bytes remain; 0
/// removes all.
/// @throws Error if there is no such folder
TrimmedCache trimCache( const std::string& folder, std::uint64_t limit );

} // namespace leeway::io
