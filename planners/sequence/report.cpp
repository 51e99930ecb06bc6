// SPDX-License-Identifier: BSD-3-Clause
// Results of sequences in words.
#include "leeway/sequence/sequence.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace leeway::sequence
{

std::vector<std::string> changesOf( const io::SceneDiff& scene )
{
	const std::vector<const char*> verbs = { "attach", "release", "add", "remove", "move" }; // as io::SceneEdit::Kind
	std::vector<std::string> changes;
	if ( scene.matrix )
	{
		changes.push_back( "replace the allowed collision matrix" );
	}
	for ( const io::SceneEdit& edit : scene.edits )
	{
		const bool attaches = edit.kind == io::SceneEdit::Kind::attach;
		changes.push_back( fmt::format( "{} {}{}", verbs.at( static_cast<std::size_t>( edit.kind ) ), edit.object.name,
		    attaches ? " to " + edit.link : "" ) );
	}
	return changes;
}

std::string describe( const Result& result, const std::vector<Leg>& legs )
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
	const bool several =
	    std::any_of( legs.begin(), legs.end(), [&]( const Leg& leg ) { return leg.group != legs.front().group; } );
	for ( std::size_t i = 0; i < result.legs.size(); ++i )
	{
		const Motion& leg = result.legs[i];
		const std::string group = several && i < legs.size() && !legs[i].group.empty() ? legs[i].group + ", " : "";
		for ( const std::string& change : i < legs.size() ? changesOf( legs[i].scene ) : std::vector<std::string>() )
		{
			text += fmt::format( "leg {}: begins with: {}\n", i + 1, change );
		}
		text += fmt::format( "leg {}: {:.3f} to {:.3f} s, {}{}\n", i + 1, leg.begin, leg.begin + leg.seconds, group,
		    leg.is_line ? fmt::format( "a line: each coordinate proved within {:.4f} mm, the angle within {:.4f} degrees",
		                      1000 * leg.position_error, leg.angle_error * 180 / M_PI )
		                : fmt::format( "to one of {} goal(s) from which the next legs go on{}", leg.goals,
		                      leg.tried > 0 ? fmt::format( ", {} tried in vain", leg.tried ) : "" ) );
	}
	return text;
}

} // namespace leeway::sequence
