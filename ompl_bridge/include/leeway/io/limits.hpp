// SPDX-License-Identifier: BSD-3-Clause
// How much a file may ask for before it is refused: sizes that no honest model has, and that a hostile or damaged one
// reaches with few bytes (a compressed picture, aliases of aliases, a mesh that is placed a million times).
//
// The limits in force are those of the innermost LimitScope of the calling thread, or else the defaults.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace leeway::io
{

/// Far beyond real models, below what a machine chokes on. Whoever has more raises the one that the error names.
struct Limits
{
	std::uint64_t file_bytes = std::uint64_t( 4 ) << 30; ///< of any file that is read; of a pipe or device too
	std::uint64_t triangles = 200'000'000;               ///< of one mesh, each instance in its file counted
	std::uint64_t points = 500'000'000;                  ///< of one cloud; boxes of one octomap; heights of one height map
	std::uint64_t links = 10'000;          ///< of one robot or articulation: tables of pairs grow with their square
	std::uint64_t objects = 1'000'000;     ///< of one scene
	std::uint64_t alias_nodes = 1'000'000; ///< of one YAML file: what its aliases add to what it spells out
	std::uint64_t nesting = 128;           ///< YAML lists and maps in each other; nodes of a mesh file above each other
};

/// Each limit with its name, as errors and options give it.
const std::vector<std::pair<std::string, std::uint64_t Limits::*>>& limitNames();

/// While it lives, these limits hold for what this thread reads.
class LimitScope
{
public:
	explicit LimitScope( const Limits& limits );
	~LimitScope();
	LimitScope( const LimitScope& ) = delete;
	LimitScope& operator=( const LimitScope& ) = delete;

private:
	Limits m_limits;
	const Limits* m_outer;
};

/// In force on this thread.
const Limits& currentLimits();

/// The bytes of a file, pipe or device, within Limits::file_bytes.
/// @throws Error if it is missing, a folder, unreadable, empty or too large, or if it changes while it is read
std::string readWholeFile( const std::string& file );

namespace detail
{

/// @param count of `what` ("triangles") in `element` of `file` @throws Error, with the limit's name, if it is above the
/// limit
void checkLimit( std::uint64_t Limits::*limit, std::uint64_t count, const std::string& what, const std::string& file,
    const std::string& element );

} // namespace detail
} // namespace leeway::io
