// SPDX-License-Identifier: BSD-3-Clause
// The folder where trees, hulls and tables are kept between runs: what is in it, and keeping it small.
//
// Files are only ever written under a temporary name and renamed, and are read whole: any number of processes may use a
// folder at the same time, and any file may be removed at any time. Files that leeway did not name are never touched.
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
		leftover, ///< of a write that did not end, or of an older version of leeway
		foreign   ///< not ours
	};
	std::string file; ///< with the folder
	std::string name; ///< of the mesh or robot
	Kind kind = foreign;
	std::uint64_t bytes = 0;
	std::int64_t used = 0;  ///< seconds since 1970: last read or written by leeway
	bool good = true;       ///< of a tree or reach: checksums are right and it is of this version
	std::string problem;    ///< if it is not good
	std::uint32_t triangles = 0; ///< of a tree
	double seconds = 0;     ///< spent on proofs, of a reach; the rest is as in lw_reach_info
	std::uint32_t pairs = 0, proved = 0, contact = 0, open = 0;
	bool complete = false;
};

/// Where leeway keeps its cache unless it is told otherwise: $XDG_CACHE_HOME/leeway, else $HOME/.cache/leeway. Empty if neither is set to
/// an absolute path. The folder need not exist.
std::string defaultCacheFolder();

/// True if the folder can be made (and then it is) and files can be made in it. False for "".
bool isUsableCache( const std::string& folder );

/// What is in a folder, most recently used first. Every file is read and checked.
/// @throws Error if there is no such folder
std::vector<CacheEntry> listCache( const std::string& folder );

struct TrimmedCache
{
	std::size_t files = 0;       ///< removed
	std::uint64_t bytes = 0;     ///< of these
	std::uint64_t remaining = 0; ///< bytes of what is left, foreign files aside
};

/// Removes leftovers (of writes: after an hour), and what was used longest ago until no more than `limit` bytes are left; 0
/// leaves nothing.
/// @throws Error if there is no such folder
TrimmedCache trimCache( const std::string& folder, std::uint64_t limit );

} // namespace leeway::io
