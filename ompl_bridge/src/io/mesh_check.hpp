// SPDX-License-Identifier: BSD-3-Clause
// What has to hold of a mesh file before assimp gets it: its readers believe more of a file than is good for them. What
// fuzzing found is refused here, in words (tests/fuzz).
#pragma once

#include "binary_data.hpp"

namespace leeway::io::detail
{

/// Why a file is refused.
struct MeshProblem
{
	std::string text;
};

/// The one of these that the extension calls for, if any. @throws MeshProblem
void checkMeshBytes( const std::string& extension, const std::string& bytes );

/// A text whose lines are those of OBJ files, with numbers where there have to be some. @throws MeshProblem
void checkObj( const std::string& bytes );

/// A binary glTF file whose chunks are as long as its header says. @throws MeshProblem
void checkGlb( const std::string& bytes );

/// A COLLADA document whose accessors stay within their arrays. @throws MeshProblem
void checkCollada( const std::string& bytes );

/// A PLY file that has all the elements that its header counts, with faces that name vertices that it has. @throws
/// MeshProblem
void checkPly( const std::string& bytes );

} // namespace leeway::io::detail
