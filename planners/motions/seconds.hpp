// SPDX-License-Identifier: BSD-3-Clause
// Time that a search has taken.
#pragma once

#include <chrono>

namespace leeway
{

inline double secondsSince( std::chrono::steady_clock::time_point begin )
{
	return std::chrono::duration<double>( std::chrono::steady_clock::now() - begin ).count();
}

} // namespace leeway
