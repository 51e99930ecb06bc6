// SPDX-License-Identifier: BSD-3-Clause
// Triangles of mesh files, as a robot has them and as assimp reads them.
#pragma once

#include "files.hpp"

#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <cmath>

using Triangle = std::array<std::array<double, 3>, 3>;

/// Files that are the mesh of a robot of one link.
class MeshTriangles : public FileTest
{
protected:
	std::vector<Triangle> load( const std::string& mesh )
	{
		const std::string urdf =
		    write( "robot.urdf", "<robot name=\"r\"><link name=\"base\"><collision><geometry><mesh filename=\"" + mesh +
		                             "\"/></geometry></collision></link></robot>" );
		m_model = leeway::io::loadRobot( urdf, "" );
		const lw_shape* shape = m_model.links[0].collision[0].shape.get();
		std::vector<Triangle> out( lw_shape_get_info( shape ).triangle_count );
		for ( std::size_t i = 0; i < 9 * out.size(); ++i )
		{
			out[i / 9][i / 3 % 3][i % 3] = lw_shape_vertices( shape )[3 * lw_shape_triangles( shape )[i / 3] + i % 3];
		}
		return out;
	}
	leeway::io::RobotModel m_model;
};

inline double difference( const Triangle& a, const Triangle& b )
{
	std::array<std::size_t, 3> order = { 0, 1, 2 };
	double least = INFINITY;
	do
	{
		double most = 0;
		for ( std::size_t i = 0; i < 9; ++i )
		{
			most = std::max( most, std::abs( a[i / 3][i % 3] - b[order[i / 3]][i % 3] ) );
		}
		least = std::min( least, most );
	} while ( std::next_permutation( order.begin(), order.end() ) );
	return least;
}

/// Those of both lists, each found in the other once. @return the largest difference of a coordinate
inline double difference( const std::vector<Triangle>& a, std::vector<Triangle> b )
{
	double most = a.size() == b.size() ? 0 : INFINITY;
	for ( const Triangle& one : a )
	{
		const auto nearest = std::min_element( b.begin(), b.end(),
		    [&]( const Triangle& x, const Triangle& y ) { return difference( one, x ) < difference( one, y ); } );
		if ( nearest == b.end() )
		{
			return INFINITY;
		}
		most = std::max( most, difference( one, *nearest ) );
		b.erase( nearest );
	}
	return most;
}

inline void addTriangles(
    const aiScene& scene, const aiNode& node, const aiMatrix4x4& root_from_parent, std::vector<Triangle>& out )
{
	const aiMatrix4x4 root_from_node = root_from_parent * node.mTransformation;
	for ( unsigned m = 0; m < node.mNumMeshes; ++m )
	{
		const aiMesh& mesh = *scene.mMeshes[node.mMeshes[m]];
		for ( unsigned f = 0; f < mesh.mNumFaces; ++f )
		{
			Triangle triangle;
			for ( unsigned k = 0; k < 3 && mesh.mFaces[f].mNumIndices == 3; ++k )
			{
				const aiVector3D at = root_from_node * mesh.mVertices[mesh.mFaces[f].mIndices[k]];
				triangle[k] = { double( at.x ), double( at.y ), double( at.z ) };
			}
			if ( mesh.mFaces[f].mNumIndices == 3 )
			{
				out.push_back( triangle );
			}
		}
	}
	for ( unsigned i = 0; i < node.mNumChildren; ++i )
	{
		addTriangles( scene, *node.mChildren[i], root_from_node, out );
	}
}

/// Those of a file, polygons left out.
inline std::vector<Triangle> trianglesByAssimp( const std::string& file )
{
	Assimp::Importer importer;
	importer.SetPropertyBool( AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true );
	const aiScene* scene = importer.ReadFile( file, 0 );
	std::vector<Triangle> out;
	EXPECT_NE( scene, nullptr ) << importer.GetErrorString();
	if ( scene != nullptr )
	{
		addTriangles( *scene, *scene->mRootNode, aiMatrix4x4(), out );
	}
	return out;
}
