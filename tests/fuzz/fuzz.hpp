// SPDX-License-Identifier: BSD-3-Clause
// Shared by fuzz targets: their table, a folder for the file that a reader is given, and the permitted effects of bad
// input.
//
// A target takes any bytes and returns. It ends the process (by an exception that leaves it, a sanitizer, expect()) only
// where the library broke a promise: bytes are read, or they are an io::Error that names file and remedy.
#pragma once

#include "leeway/io/model.hpp"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace fuzz
{

/// The bytes of one input.
using Input = std::string_view;

struct Target
{
	const char* name;
	void ( *run )( Input );
	std::size_t longest; ///< bytes: longer input is slow and shows nothing new
	const char* seeds;   ///< folder of the corpus, where several targets share one
};

/// All of them.
const std::vector<Target>& targets();
const Target* findTarget( const std::string& name );

// In the order of the table, by source
void meshStl( Input ), meshObj( Input ), meshPly( Input ), meshDae( Input ), meshGltf( Input );
void cloudPcd( Input ), cloudPly( Input ), octomap( Input ), heightMap( Input );
void urdf( Input ), mjcf( Input ), srdf( Input ), scene( Input ), request( Input ), settings( Input ), world( Input );
void csv( Input ), path( Input ), steps( Input );
void refereeText( Input ), refereeArray( Input );
void shapeBlob( Input ), reachBlob( Input ), cacheFile( Input );
void coreCalls( Input );

/// Seeds that are no text, or follow from the format of this version: (target, name, bytes).
struct Seed
{
	std::string target, name, bytes;
};
std::vector<Seed> generatedSeeds();

/// Ends the process with a message: a promise was broken.
void expect( bool holds, const char* promise );

/// A folder of this process, removed when it ends; where package paths of the machine do not reach.
/// @return its path joined with `name`
std::string pathOf( const std::string& name );
/// Writes a file into it. @return its path
std::string put( const std::string& name, Input bytes );
/// The same, once for each name: files that inputs refer to.
std::string putOnce( const std::string& name, const std::string& bytes );

/// Runs a reader. @return true if it read; false if it threw an io::Error as it should be: one line, with file and remedy.
/// Any other exception passes.
template <typename F> bool reads( F reader )
{
	try
	{
		reader();
		return true;
	}
	catch ( const leeway::io::Error& error )
	{
		const std::string text = error.what();
		expect( text.find( '\n' ) == std::string::npos, "an error is one line" );
		expect( !error.file().empty(), "an error names the file" );
		expect( !error.remedy().empty(), "an error names the remedy" );
		return false;
	}
}

/// Asks for distances from the shape to another, and checks its tree: whatever a reader let through has to be usable.
void useShape( const lw_shape* shape );

/// Files tetrahedron.obj and tetrahedron.stl, for models to name. For each OBJ, assimp clears 16 MB: a hundred inputs in a
/// second.
void putMeshes();
/// The robot that scenes, requests and semantics are about: two boxes and a mesh, joints j (revolute) and k (prismatic).
extern const char* const robot_urdf;
extern const char* const robot_srdf;
const leeway::io::RobotModel& fixedRobot();

} // namespace fuzz
