// SPDX-License-Identifier: BSD-3-Clause
// What has to hold of a mesh file before assimp gets it: its readers believe more of a file than is good for them. What
// fuzzing found is refused here, in words (tests/fuzz), or written so that there is nothing left to believe.
#pragma once

#include "binary_data.hpp"

namespace leeway::io::detail
{

/// Why a file is refused.
struct MeshProblem
{
	std::string text;
};

/// What assimp is to read of a file, after the check that its extension calls for, if any. @throws MeshProblem
std::string checkedMesh( const std::string& extension, std::string bytes );

/// A text whose lines are those of OBJ files, with numbers where there have to be some. @throws MeshProblem
void checkObj( const std::string& bytes );

/// A binary glTF file whose chunks are as long as its header says. @throws MeshProblem
void checkGlb( const std::string& bytes );

/// A COLLADA document whose accessors stay within their arrays. @throws MeshProblem
void checkCollada( const std::string& bytes );

/// A PLY file that has all the elements that its header counts, and no more, with faces that name vertices that it has.
/// @return its mesh alone, as binary PLY in this machine's byte order with double coordinates: faces as they are, strips as
/// triangles
/// @throws MeshProblem
std::string plainPly( std::string bytes );

} // namespace leeway::io::detail
