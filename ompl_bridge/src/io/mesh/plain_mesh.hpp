// SPDX-License-Identifier: BSD-3-Clause
// A mesh as a file for assimp that says no more than it has to: binary PLY in this machine's byte order.
#pragma once

#include <array>
#include <cstdint>
#include <fmt/format.h>
#include <string>
#include <vector>

namespace leeway::io::detail
{

class PlainMesh
{
public:
	void addVertex( const std::array<double, 3>& xyz )
	{
		append( m_vertices, xyz.data(), sizeof( xyz ) );
		++m_vertex_count;
	}
	void addFace( const std::vector<std::uint32_t>& corners )
	{
		const std::uint32_t count = static_cast<std::uint32_t>( corners.size() );
		append( m_faces, &count, sizeof( count ) );
		append( m_faces, corners.data(), corners.size() * sizeof( corners[0] ) );
		++m_face_count;
	}
	std::size_t vertexCount() const { return m_vertex_count; }
	std::size_t faceCount() const { return m_face_count; }
	std::string bytes() const
	{
		return fmt::format( "ply\nformat binary_{}_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\n"
		                    "property double z\nelement face {}\nproperty list uint uint vertex_indices\nend_header\n",
		           __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__ ? "big" : "little", m_vertex_count, m_face_count ) +
		       m_vertices + m_faces;
	}

private:
	static void append( std::string& bytes, const void* data, std::size_t size )
	{
		bytes.append( static_cast<const char*>( data ), size );
	}

	std::string m_vertices, m_faces;
	std::size_t m_vertex_count = 0, m_face_count = 0;
};

/// The triangles into which assimp cuts the faces, as three vertex numbers each. @throws MeshProblem
std::vector<std::uint32_t> cutIntoTriangles( const PlainMesh& mesh );

} // namespace leeway::io::detail
