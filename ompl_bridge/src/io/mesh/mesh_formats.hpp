// SPDX-License-Identifier: BSD-3-Clause
// Formats of mesh files: COLLADA and glTF are read here; of OBJ and PLY it is checked, or written anew, what assimp is to read. Its
// readers believe more of a file than is good for them. What fuzzing found is refused in words (tests/fuzz).
#pragma once

#include "base/binary_data.hpp"

namespace leeway::io::detail
{

/// Why a file is refused.
struct MeshProblem
{
	std::string text;
};

/// A mesh file, and who names it: for errors that are thrown where a limit is passed.
struct MeshPlace
{
	const std::string &mesh_file, &from_file, &element;

	/// Where a mesh is placed a thousand times, a small file has a large soup: asked before it is made.
	/// @throws Error if so many more are too many
	void checkRoom( const TriangleSoup& soup, std::size_t triangles, std::size_t vertices ) const;
	/// @param depth of a node below the root @throws Error
	void checkDepth( std::size_t depth ) const;
};

/// What assimp is to read of a file, after the check that its extension calls for, if any. @throws MeshProblem
std::string checkedMesh( const std::string& extension, std::string bytes );

/// A text whose lines are those of OBJ files, with numbers where there have to be some. @throws MeshProblem
void checkObj( const std::string& bytes );

/// A PLY file that has all the elements that its header counts, and no more, with faces that name vertices that it has.
/// @return its mesh alone, as binary PLY in this machine's byte order with double coordinates: faces as they are, strips as
/// triangles
/// @throws MeshProblem
std::string plainPly( std::string bytes );

/// The triangles of the scene of a COLLADA document. @throws MeshProblem, and Error beyond a limit
TriangleSoup readCollada( const MeshPlace& place, const std::string& bytes );

/// The triangles of the scene of a glTF 2.0 file, binary or text; buffers in files beside it are read.
/// @throws MeshProblem, and Error beyond a limit
TriangleSoup readGltf( const MeshPlace& place, const std::string& bytes );

} // namespace leeway::io::detail
