// SPDX-License-Identifier: BSD-3-Clause
// A small writer of binary glTF 2.0: meshes with crease-aware normals, nodes, materials, one animation.
#pragma once

#include <nlohmann/json.hpp>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace kitchen
{

/// Vertex data as glTF wants it; triangles share a vertex only where the surface is smooth.
struct ShadedMesh
{
	std::vector<float> positions, normals; ///< x, y, z per vertex
	std::vector<uint32_t> indices;
};

/// Normals weighted by corner angle; edges sharper than `crease` (radians) stay sharp.
/// @param vertices [vertex_count][3]; equal positions count as one vertex
ShadedMesh shade(
    const double* vertices, size_t vertex_count, const uint32_t* triangles, size_t triangle_count, double crease );

struct Surface
{
	std::string name;
	std::array<double, 4> colour; ///< sRGB and alpha
	double roughness, metallic;
};

class Gltf
{
public:
	using Vec = std::array<double, 3>;
	using Quat = std::array<double, 4>; ///< x, y, z, w

	Gltf();
	int addMaterial( const Surface& surface );
	/// Vertex data, shared by all meshes made of it.
	int addGeometry( const ShadedMesh& mesh );
	int addMesh( int geometry, int material );
	/// The same with the material's opacity in the vertices as well: VTK 9.1 (and f3d 1.3 with it) looks for it only there.
	int addTranslucentMesh( int geometry, int material );
	/// @param parent -1: the z-up world
	/// @param mesh -1: none
	int addNode( const std::string& name, int parent, const Vec& translation, const Quat& rotation, int mesh = -1 );
	/// Samples of a node's pose at the given times, seconds, increasing.
	void animate( int node, const std::vector<double>& times, const std::vector<Vec>& translations,
	    const std::vector<Quat>& rotations );
	/// The bytes of the .glb file.
	std::string bytes() const;

private:
	int addAccessor( const void* data, size_t bytes, int count, int component, const char* type, int target,
	    const nlohmann::json& low, const nlohmann::json& high );
	int addTimes( const std::vector<double>& times );

	nlohmann::json m_json;
	std::string m_binary;
	std::vector<double> m_times; ///< of the last animated node, with its accessor: nodes usually share them
	int m_times_accessor = -1;
};

} // namespace kitchen
