// SPDX-License-Identifier: BSD-3-Clause
// Mesh files by assimp (STL, OBJ, DAE, PLY, glTF): the triangles as they are, in metres. Binary STL, which most robots
// come in, is a list of numbers: it is read without.
//
// Conventions are those of RViz and MoveIt (geometric_shapes): a COLLADA file's <unit> is applied, its <up_axis> is not,
// because robot descriptions place the mesh as it is drawn; glTF nodes are applied, its y-up convention is not turned.
// Nothing is merged, sorted or removed: open, degenerate and duplicate triangles are the core's business.
#include "io_internal.hpp"

#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <filesystem>
#include <fmt/format.h>

namespace leeway::io::detail
{

namespace
{

using Matrix = std::array<std::array<double, 4>, 4>;

/// parent * node, in double: assimp's matrices are float, and chains of them would round at every level.
Matrix multiply( const Matrix& parent, const aiMatrix4x4& node )
{
	Matrix product{};
	for ( unsigned row = 0; row < 4; ++row )
	{
		for ( unsigned column = 0; column < 4; ++column )
		{
			for ( unsigned k = 0; k < 4; ++k )
			{
				product[row][column] += parent[row][k] * static_cast<double>( node[k][column] );
			}
		}
	}
	return product;
}

void appendMesh( const aiMesh& mesh, const Matrix& root_from_mesh, TriangleSoup& soup )
{
	std::uint32_t base = static_cast<std::uint32_t>( soup.vertices.size() / 3 );
	for ( unsigned i = 0; i < mesh.mNumVertices; ++i )
	{
		const aiVector3D& v = mesh.mVertices[i];
		for ( const std::array<double, 4>& row : { root_from_mesh[0], root_from_mesh[1], root_from_mesh[2] } )
		{
			soup.vertices.push_back( row[0] * static_cast<double>( v.x ) + row[1] * static_cast<double>( v.y ) +
			                         row[2] * static_cast<double>( v.z ) + row[3] );
		}
	}
	for ( unsigned i = 0; i < mesh.mNumFaces; ++i )
	{
		const aiFace& face = mesh.mFaces[i];
		if ( face.mNumIndices != 3 )
		{
			++soup.dropped_faces;
			continue;
		}
		for ( unsigned k = 0; k < 3; ++k )
		{
			soup.indices.push_back( base + face.mIndices[k] );
		}
	}
}

void appendNode( const aiScene& scene, const aiNode& node, const Matrix& root_from_parent, TriangleSoup& soup )
{
	Matrix root_from_node = multiply( root_from_parent, node.mTransformation );
	for ( unsigned i = 0; i < node.mNumMeshes; ++i )
	{
		appendMesh( *scene.mMeshes[node.mMeshes[i]], root_from_node, soup );
	}
	for ( unsigned i = 0; i < node.mNumChildren; ++i )
	{
		appendNode( scene, *node.mChildren[i], root_from_node, soup );
	}
}

} // namespace

bool isBinaryStl( const std::string& bytes )
{
	constexpr std::size_t header = 80;
	std::uint32_t count = 0;
	if ( bytes.size() < header + sizeof( count ) || __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__ )
	{
		return false;
	}
	std::memcpy( &count, bytes.data() + header, sizeof( count ) );
	return count > 0 && bytes.size() == header + sizeof( count ) + 50 * static_cast<std::size_t>( count );
}

TriangleSoup readMeshFile( const std::string& mesh_file, const std::string& from_file, const std::string& element )
{
	std::string extension = std::filesystem::path( mesh_file ).extension().string();
	Assimp::Importer importer;
	if ( !extension.empty() && !importer.IsExtensionSupported( extension ) )
	{
		throw Error( from_file, element, fmt::format( "mesh {} is of a type that cannot be read", mesh_file ),
		    "convert it to STL, OBJ, DAE, PLY or glTF" );
	}
	importer.SetPropertyBool( AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true );
	const aiScene* scene = importer.ReadFile( mesh_file, aiProcess_Triangulate );
	if ( scene == nullptr || scene->mRootNode == nullptr )
	{
		throw Error( from_file, element, fmt::format( "mesh {} cannot be read: {}", mesh_file, importer.GetErrorString() ),
		    "repair the mesh file, or export it again" );
	}
	TriangleSoup soup;
	Matrix identity{};
	for ( unsigned i = 0; i < 4; ++i )
	{
		identity[i][i] = 1;
	}
	appendNode( *scene, *scene->mRootNode, identity, soup );
	if ( soup.indices.empty() )
	{
		throw Error( from_file, element, fmt::format( "mesh {} has no triangles", mesh_file ),
		    "export it with its faces, or remove the element" );
	}
	return soup;
}

} // namespace leeway::io::detail
