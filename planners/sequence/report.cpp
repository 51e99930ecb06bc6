// SPDX-License-Identifier: BSD-3-Clause
// Results of sequences in words.
#include "leeway/sequence/sequence.hpp"

#include <fmt/format.h>

namespace leeway::sequence
{

std::string describe( const Result& result )
{
	if ( !result.solved )
	{
		return fmt::format( "no sequence: leg {} is not found{}{}: {}{}", result.failed + 1,
		    result.goals > 0 ? fmt::format( " from {} goal(s) of the legs before", result.goals ) : "",
		    result.stopped ? ", and the time is over" : "", result.reason,
		    !result.reason.empty() && result.reason.back() == '\n' ? "" : "\n" );
	}
	std::string text = fmt::format( "sequence: {} leg(s), {} cubics, {:.3f} s, planned in {:.3f} s\n", result.legs.size(),
	    result.segments.size(), result.legs.back().begin + result.legs.back().seconds, result.plan_seconds );
	for ( std::size_t i = 0; i < result.legs.size(); ++i )
	{
		const Motion& leg = result.legs[i];
		text += fmt::format( "leg {}: {:.3f} to {:.3f} s, {}\n", i + 1, leg.begin, leg.begin + leg.seconds,
		    leg.is_line ? fmt::format( "a line: each coordinate proved within {:.4f} mm, the angle within {:.4f} degrees",
		                      1000 * leg.position_error, leg.angle_error * 180 / M_PI )
		                : fmt::format( "to one of {} goal(s) from which the next legs go on{}", leg.goals,
		                      leg.tried > 0 ? fmt::format( ", {} tried in vain", leg.tried ) : "" ) );
	}
	return text;
}

} // namespace leeway::sequence
