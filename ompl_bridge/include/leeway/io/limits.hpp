// SPDX-License-Identifier: BSD-3-Clause
// Limits on input files: sizes that no honest model has, but that a hostile or damaged file can demand with few bytes (a
// compressed picture, aliases of aliases, a mesh that is placed a million times).
//
// The innermost LimitScope of the calling thread is in force, or else the defaults.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace leeway::io
{

/// Default limits: far above real models, low enough for any machine. For larger models raise the limit that the error
/// names.
struct Limits
{
	std::uint64_t file_bytes = std::uint64_t( 4 ) << 30; ///< of any file or stream
	std::uint64_t triangles = 200'000'000;               ///< of one mesh, each instance in its file counted
	std::uint64_t points = 500'000'000;                  ///< of one cloud; boxes of one octomap; heights of one height map
	std::uint64_t links = 10'000;          ///< of one robot or articulation: tables of pairs grow with their square
	std::uint64_t objects = 1'000'000;     ///< of one scene
	std::uint64_t alias_nodes = 1'000'000; ///< of one YAML file: nodes that its aliases add
	std::uint64_t nesting = 128;           ///< depth of YAML lists and maps, and of the node tree of a mesh file
};

/// Each limit with its name in errors and options.
const std::vector<std::pair<std::string, std::uint64_t Limits::*>>& limitNames();

/// Sets the limits of the calling thread for its lifetime.
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

/// The limits of the calling thread.
const Limits& currentLimits();

/// The bytes of a regular file, or of a stream that the program was started with (/dev/stdin and /dev/fd/N: the name that a
/// shell gives for <(COMMAND)), within Limits::file_bytes.
/// @throws Error if it is missing, a folder, a device, another pipe, unreadable, empty or too large, or if it changes while
/// it is read
std::string readWholeFile( const std::string& file );

namespace detail
{

/// @param count of `what` ("triangles") in `element` of `file` @throws Error, with the limit's name, if it is above the
/// limit
void checkLimit( std::uint64_t Limits::*limit, std::uint64_t count, const std::string& what, const std::string& file,
    const std::string& element );

} // namespace detail
} // namespace leeway::io
