// SPDX-License-Identifier: BSD-3-Clause
// Bubbles of free states: how far each joint may go from a state, all of them together, by one measurement. Quinlan 1994, chapter 5.
#pragma once

#include "leeway/io/model.hpp"

#include <memory>
#include <vector>

namespace leeway::certify
{

/// Proved boxes around states: a certificate's bound of paths (FORMAT.md, "Path") against the clearances of one state.
class Bubbles
{
public:
	/// @param problem, robot outlive this; `robot` is that of the problem
	/// @param flags which clearances count
	/// @throws io::Error
	Bubbles( const io::Problem& problem, const io::RobotModel& robot, lw_check_flags flags = LW_CHECK_BOTH );
	~Bubbles();
	Bubbles( const Bubbles& ) = delete;
	Bubbles& operator=( const Bubbles& ) = delete;

	/// All joints grow alike, each weighted by the largest lever of its bodies, until the room of a link or of a pair of links is used; its joints then stay, and the
	/// others grow on. Every state r with |r_j - q_j| <= out_j of all variables j keeps its clearances above min_d. Joint limits are not looked at.
	/// @param q [group variables]
	/// @param min_d metres, >= 0
	/// @param most radians and metres, > 0: no joint gets more
	/// @param out [group variables] radians and metres; 0 for quaternions, and for all if the state is not proved free, or on an error
	/// @return LW_OK, or that of lw_checker_near() and lw_checker_state()
	/// Cost: two measurements of a state to 0.3 of their value and 0.2 m, and 2 us. One thread at a time.
	lw_status at( lw_query* query, const double* q, double min_d, double most, double* out );

private:
	struct State;
	std::unique_ptr<State> m_state;
};

} // namespace leeway::certify
