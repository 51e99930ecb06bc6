// SPDX-License-Identifier: BSD-3-Clause
// Meshes that LoadOptions::skip_missing_meshes leaves out of one robot.
#pragma once

#include "base/io_internal.hpp"

#include <set>

namespace leeway::io::detail
{

/// Nothing collides with such a mesh, so each mesh and its link are named.
class MissingMeshes
{
public:
	void add( const std::string& mesh, const std::string& link, int line );
	/// One notice for all of them; none if there are none.
	/// @param others the robot has shapes beside them @throws Error if it has none
	void report( const std::string& file, bool others, std::vector<Notice>& notices ) const;

private:
	std::vector<std::string> m_meshes; ///< "arm.stl of link arm (line 3)"
	std::set<std::string> m_links;
};

} // namespace leeway::io::detail
