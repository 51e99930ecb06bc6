// SPDX-License-Identifier: BSD-3-Clause
// Mesh files by assimp (OBJ, PLY, OFF): the triangles as they are, in metres. Binary STL, which most robots come in, is a
// list of numbers: it is read without; STL as text, COLLADA and glTF by stl_reader.cpp, collada_reader.cpp and gltf_reader.cpp.
//
// Conventions are those of RViz and MoveIt (geometric_shapes): a COLLADA file's <unit> is applied, its <up_axis> is not,
// because robot descriptions place the mesh as it is drawn; glTF nodes are applied, its y-up convention is not turned.
// Nothing is merged, sorted or removed: open, degenerate and duplicate triangles are the core's business.
#include "mesh/mesh_formats.hpp"
#include "mesh/placement.hpp"
#include "mesh/plain_mesh.hpp"

#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <filesystem>
#include <fmt/format.h>

namespace leeway::io::detail
{

namespace
{

Placement placement( const aiMatrix4x4& m )
{
	return { { { double( m.a1 ), double( m.a2 ), double( m.a3 ), double( m.a4 ) },
	    { double( m.b1 ), double( m.b2 ), double( m.b3 ), double( m.b4 ) },
	    { double( m.c1 ), double( m.c2 ), double( m.c3 ), double( m.c4 ) } } };
}

/// assimp passes on the indices of a file, and its own next steps trust them: each face must name existing vertices, each
/// node existing meshes.
struct Checks
{
	const MeshPlace& place;

	void check( const aiScene& scene ) const
	{
		for ( unsigned i = 0; i < scene.mNumMeshes; ++i )
		{
			const aiMesh& mesh = *scene.mMeshes[i];
			for ( unsigned k = 0; k < mesh.mNumFaces; ++k )
			{
				checkFace( mesh.mFaces[k], mesh );
			}
		}
		checkNode( scene, *scene.mRootNode, 0 );
	}

private:
	[[noreturn]] void fail( const std::string& problem ) const
	{
		throw Error( place.from_file, place.element, fmt::format( "mesh {}: {}", place.mesh_file, problem ),
		    "repair the mesh file, or export it again" );
	}

	void checkFace( const aiFace& face, const aiMesh& mesh ) const
	{
		if ( face.mNumIndices == 0 || mesh.mVertices == nullptr )
		{
			fail( "a face has no corners" );
		}
		for ( unsigned i = 0; i < face.mNumIndices; ++i )
		{
			if ( face.mIndices[i] >= mesh.mNumVertices )
			{
				fail( fmt::format( "a face names vertex {} of {}", face.mIndices[i], mesh.mNumVertices ) );
			}
		}
	}

	void checkNode( const aiScene& scene, const aiNode& node, unsigned depth ) const
	{
		place.checkDepth( depth );
		for ( unsigned i = 0; i < node.mNumMeshes; ++i )
		{
			if ( node.mMeshes[i] >= scene.mNumMeshes )
			{
				fail( fmt::format( "a node names mesh {} of {}", node.mMeshes[i], scene.mNumMeshes ) );
			}
		}
		for ( unsigned i = 0; i < node.mNumChildren; ++i )
		{
			checkNode( scene, *node.mChildren[i], depth + 1 );
		}
	}
};

void appendMesh( const aiMesh& mesh, const Placement& root_from_mesh, const MeshPlace& place, TriangleSoup& soup )
{
	place.checkRoom( soup, mesh.mNumFaces, mesh.mNumVertices );
	std::uint32_t base = static_cast<std::uint32_t>( soup.vertices.size() / 3 );
	for ( unsigned i = 0; i < mesh.mNumVertices; ++i )
	{
		const aiVector3D& v = mesh.mVertices[i];
		const std::array<double, 3> at =
		    apply( root_from_mesh, static_cast<double>( v.x ), static_cast<double>( v.y ), static_cast<double>( v.z ) );
		soup.vertices.insert( soup.vertices.end(), at.begin(), at.end() );
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

void appendNode(
    const aiScene& scene, const aiNode& node, const Placement& root_from_parent, const MeshPlace& place, TriangleSoup& soup )
{
	const Placement root_from_node = multiply( root_from_parent, placement( node.mTransformation ) );
	for ( unsigned i = 0; i < node.mNumMeshes; ++i )
	{
		appendMesh( *scene.mMeshes[node.mMeshes[i]], root_from_node, place, soup );
	}
	for ( unsigned i = 0; i < node.mNumChildren; ++i )
	{
		appendNode( scene, *node.mChildren[i], root_from_node, place, soup );
	}
}

/// assimp opens what a mesh file names, such as an OBJ's library of materials: here nothing, neither pipes nor devices. The
/// mesh itself is in memory.
class NoFiles : public Assimp::IOSystem
{
public:
	bool Exists( const char* ) const override { return false; }
	char getOsSeparator() const override { return '/'; }
	Assimp::IOStream* Open( const char*, const char* ) override { return nullptr; }
	void Close( Assimp::IOStream* ) override {}
};

/// @throws MeshProblem, Error
TriangleSoup readByAssimp( const MeshPlace& place, const std::string& extension, std::string bytes )
{
	Assimp::Importer importer;
	if ( !extension.empty() && !importer.IsExtensionSupported( extension ) )
	{
		throw Error( place.from_file, place.element,
		    fmt::format( "mesh {} is of a type that cannot be read", place.mesh_file ),
		    "convert it to STL, OBJ, DAE, PLY or glTF" );
	}
	// assimp reads the checked bytes, not the file, which another program may write meanwhile
	bytes = checkedMesh( extension, std::move( bytes ) );
	importer.SetIOHandler( new NoFiles ); // which the importer owns
	const char* hint = extension.empty() ? "" : extension.c_str() + 1;
	const aiScene* scene = importer.ReadFileFromMemory( bytes.data(), bytes.size(), 0, hint );
	if ( scene != nullptr && scene->mRootNode != nullptr )
	{
		Checks{ place }.check( *scene );
		scene = importer.ApplyPostProcessing( aiProcess_Triangulate );
	}
	if ( scene == nullptr || scene->mRootNode == nullptr )
	{
		throw MeshProblem{ importer.GetErrorString() };
	}
	TriangleSoup soup;
	appendNode( *scene, *scene->mRootNode, IN_PLACE, place, soup );
	return soup;
}

/// Behind a byte order mark.
std::size_t textBegin( const std::string& bytes )
{
	return bytes.compare( 0, 3, "\xef\xbb\xbf" ) == 0 ? 3 : 0;
}

/// Binary files may begin with the same word, but have the size that they state.
bool isStlText( const std::string& bytes )
{
	const std::size_t begin = bytes.find_first_not_of( " \t\r\n", textBegin( bytes ) );
	return !isBinaryStl( bytes ) && begin != std::string::npos &&
	       ( bytes.compare( begin, 5, "solid" ) == 0 || bytes.compare( begin, 5, "SOLID" ) == 0 );
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

bool isSelfContained( const std::string& extension, std::string_view bytes )
{
	if ( extension == ".glb" )
	{
		return !gltfNamesFiles( bytes );
	}
	for ( const char* known : { ".stl", ".obj", ".ply", ".dae", ".off" } )
	{
		if ( extension == known )
		{
			return true;
		}
	}
	return false;
}

std::string lowerExtension( const std::string& file )
{
	std::string ending = std::filesystem::path( file ).extension().string();
	for ( char& c : ending )
	{
		c = c >= 'A' && c <= 'Z' ? static_cast<char>( c - 'A' + 'a' ) : c;
	}
	return ending;
}

std::vector<std::uint32_t> cutIntoTriangles( const PlainMesh& mesh )
{
	const std::string bytes = mesh.bytes();
	Assimp::Importer importer;
	const aiScene* scene = importer.ReadFileFromMemory( bytes.data(), bytes.size(), aiProcess_Triangulate, "ply" );
	if ( scene == nullptr || scene->mNumMeshes != 1 || scene->mMeshes[0]->mNumVertices != mesh.vertexCount() )
	{
		throw MeshProblem{ fmt::format( "its polygons cannot be cut into triangles: {}", importer.GetErrorString() ) };
	}
	std::vector<std::uint32_t> out;
	const aiMesh& cut = *scene->mMeshes[0];
	for ( unsigned i = 0; i < cut.mNumFaces; ++i )
	{
		out.insert( out.end(), cut.mFaces[i].mIndices, cut.mFaces[i].mIndices + cut.mFaces[i].mNumIndices );
	}
	if ( out.size() % 3 != 0 )
	{
		throw MeshProblem{ "its polygons cannot be cut into triangles" };
	}
	return out;
}

TriangleSoup readMeshFile(
    const std::string& mesh_file, const std::string& from_file, const std::string& element, std::string bytes )
{
	const MeshPlace place{ mesh_file, from_file, element };
	const std::string extension = lowerExtension( mesh_file );
	TriangleSoup soup;
	try
	{
		bytes = bytes.empty() ? readFile( mesh_file ) : std::move( bytes );
		soup = extension == ".gltf" || extension == ".glb" ? readGltf( place, bytes )
		       : extension == ".dae"                       ? readCollada( place, bytes )
		       : extension == ".stl" && isStlText( bytes )
		           ? readStlText( place, std::string_view( bytes ).substr( textBegin( bytes ) ) )
		           : readByAssimp( place, extension, std::move( bytes ) );
	}
	catch ( const MeshProblem& problem )
	{
		throw Error( from_file, element, fmt::format( "mesh {} cannot be read: {}", mesh_file, problem.text ),
		    "repair the mesh file, or export it again" );
	}
	catch ( const Error& error )
	{
		if ( error.file() == from_file )
		{
			throw;
		}
		throw Error( from_file, element, fmt::format( "mesh {}: {}", mesh_file, error.problem() ), error.remedy() );
	}
	if ( soup.indices.empty() )
	{
		throw Error( from_file, element, fmt::format( "mesh {} has no triangles", mesh_file ),
		    "export it with its faces, or remove the element" );
	}
	return soup;
}

} // namespace leeway::io::detail
