// SPDX-License-Identifier: BSD-3-Clause
// Pairs that keep their distance along a motion, such as a wrist and its gripper: they are near by design, and where they are the
// nearest they hide all others.
#pragma once

#include "leeway/motions/states.hpp"
#include "view/engine/apart.h"

#include <memory>
#include <string>
#include <vector>

namespace leeway::view
{

struct ApartPair
{
	lwv_pair pair = {};
	double least = 0, most = 0; ///< clearance along the motion, metres
};

/// Clearances without some pairs.
class Others
{
public:
	/// @param file for errors @throws io::Error if memory is too small
	Others( const lw_checker* checker, const std::vector<lwv_pair>& pairs, const std::string& file );
	/// @throws io::Error
	lw_state_result measured( const std::vector<double>& q, lw_check_flags flags ) const;
	/// Clearances of the pairs themselves, [pairs]; +inf where they are not below `distance`.
	std::vector<double> ofPairs( const std::vector<double>& q, double distance ) const;

private:
	std::unique_ptr<lwv_apart, void ( * )( lwv_apart* )> m_apart;
	std::size_t m_count;
	std::string m_file;
};

/// A state and its clearances without the pairs that are set apart already.
struct SeenState
{
	const std::vector<double>* q;
	const lw_state_result* result;
};

/// Pairs that are the nearest at more than half of the states, are farther than min_d at each of them, and whose clearance changes
/// by at most 1 % or 0.1 mm. An obstacle only with a link that at most one joint of the group moves: a gripper that follows a
/// table keeps its distance too, and by its path instead of by design.
std::vector<ApartPair> keepingDistance(
    const io::Problem& problem, const std::vector<SeenState>& states, double min_d, const std::string& file );

} // namespace leeway::view
