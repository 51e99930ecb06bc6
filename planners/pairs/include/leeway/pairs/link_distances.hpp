// SPDX-License-Identifier: BSD-3-Clause
// Distances of pairs of links, as lw_robot_fk() and lw_shape_distance() give them.
#pragma once

#include "leeway/handles.hpp"

#include <vector>

namespace leeway::pairs
{

/// Measures links of a robot in one state after the other. One thread.
class LinkDistances
{
public:
	explicit LinkDistances( Robot robot );

	/// @param q [variable_count]
	void move( const std::vector<double>& q );
	/// The least distance of their bodies in the last state, as far as it is below `max_d`; contact ends the search.
	lw_clearance measure( std::uint32_t link_a, std::uint32_t link_b, double max_d );

private:
	Robot m_robot;
	Query m_query;
	std::vector<std::vector<lw_body_def>> m_bodies; ///< by link
	std::vector<lw_transform> m_poses;              ///< world_from_link
};

} // namespace leeway::pairs
