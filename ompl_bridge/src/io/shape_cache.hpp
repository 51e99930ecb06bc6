// SPDX-License-Identifier: BSD-3-Clause
// Mesh shapes of a robot, kept between runs.
#pragma once

#include "io_internal.hpp"

namespace leeway::io::detail
{

/// Between its constructor and save() the shapes are loaded.
class ShapeCache
{
public:
	/// @param urdf the file's text
	/// @param meshes files and scales in the order of the URDF. Those of formats that may name further files are left to the
	/// reader. @throws Error
	ShapeCache( const LoadOptions& options, const std::string& robot, const std::string& urdf,
	    const std::vector<MeshKey>& meshes, LoadReport& report );

	/// Shapes that were found; empty if the file is not there or not good.
	const std::map<MeshKey, BuiltMesh>& shapes() const { return m_shapes; }
	/// Writes the shapes of `loaded` if they were not found.
	void save( const std::map<MeshKey, BuiltMesh>& loaded );

private:
	void read();
	LoadReport& m_report;
	std::vector<MeshKey> m_meshes; ///< distinct, those that are kept
	lw_digest m_key{};
	std::string m_file;
	std::map<MeshKey, BuiltMesh> m_shapes;
};

} // namespace leeway::io::detail
