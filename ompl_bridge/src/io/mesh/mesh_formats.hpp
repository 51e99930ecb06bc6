// SPDX-License-Identifier: BSD-3-Clause
// Formats of mesh files. STL as text, COLLADA and glTF are read here. OBJ and OFF are checked and PLY is written anew before assimp reads them,
// because assimp's readers trust the numbers of a file. Defects that fuzzing found are refused with a message (tests/fuzz).
#pragma once

#include "base/binary_data.hpp"

namespace leeway::io::detail
{

/// Why a file is refused.
struct MeshProblem
{
	std::string text;
};

/// A mesh file, and the file and element that name it: for the errors thrown beyond a limit.
struct MeshPlace
{
	const std::string &mesh_file, &from_file, &element;

	/// Call this before appending: a small file that places a mesh a thousand times has a large soup.
	/// @throws Error if that many more triangles or vertices exceed a limit
	void checkRoom( const TriangleSoup& soup, std::size_t triangles, std::size_t vertices ) const;
	/// @param depth of a node below the root @throws Error
	void checkDepth( std::size_t depth ) const;
};

/// The bytes for assimp: PLY written anew, OBJ and OFF after their check, other formats unchanged. @throws MeshProblem
std::string checkedMesh( const std::string& extension, std::string bytes );

/// A text whose lines are those of OBJ files, with numbers where there have to be some. @throws MeshProblem
void checkObj( const std::string& bytes );

/// A PLY file that has all the elements that its header counts, and no more, with faces that name vertices that it has.
/// @return its mesh alone, as binary PLY in this machine's byte order with double coordinates: faces as they are, strips as
/// triangles
/// @throws MeshProblem
std::string plainPly( std::string bytes );

/// The triangles of all solids of an STL file that is text. @throws MeshProblem, and Error beyond a limit
TriangleSoup readStlText( const MeshPlace& place, std::string_view text );

/// An OFF file whose words are numbers, but for its first. @throws MeshProblem
void checkOff( std::string_view bytes );

/// The triangles of the scene of a COLLADA document. @throws MeshProblem, and Error beyond a limit
TriangleSoup readCollada( const MeshPlace& place, const std::string& bytes );

/// The triangles of the scene of a glTF 2.0 file, binary or text; buffers in files beside it are read.
/// @throws MeshProblem, and Error beyond a limit
TriangleSoup readGltf( const MeshPlace& place, const std::string& bytes );

/// False only if no part of a binary glTF file can be in another file. Cheap: true where a name could be hidden.
bool gltfNamesFiles( std::string_view bytes );

} // namespace leeway::io::detail
