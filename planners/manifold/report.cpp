// SPDX-License-Identifier: BSD-3-Clause
// Plans with constraints along the path, in words.
#include "leeway/manifold/plan.hpp"

#include <fmt/format.h>

namespace leeway::manifold
{

const char* name( Outcome outcome )
{
	static const char* const names[] = { "solved", "the start breaks constraints", "the start is not free",
	    "the goal breaks constraints", "the goal is not free", "the constraints exclude each other", "timed out",
	    "no motion along the path is proved" };
	return names[static_cast<int>( outcome )];
}

std::string summary( const Result& r )
{
	std::string all = name( r.outcome );
	for ( const std::string& reason : r.reasons )
	{
		all += ( &reason == &r.reasons.front() ? ": " : "; " ) + reason;
	}
	return all;
}

std::string describe( const Result& r )
{
	if ( !r.solved() )
	{
		std::string text = fmt::format( "no path     {}", name( r.outcome ) );
		for ( const std::string& reason : r.reasons )
		{
			text += fmt::format( "\n            {}", reason );
		}
		return text +
		       fmt::format( "\nsearch      {:.3f} s, {} of {} samples led to the constraints; {} nodes from the start, {} "
		                    "from the goal\n",
		           r.search_seconds, r.projected, r.samples, r.start_nodes, r.goal_nodes );
	}
	std::string text;
	if ( r.mended > 0 )
	{
		text = fmt::format(
		    "mended      until {:.4f} s the motion leads the start to the constraints, {:.4g} long; they are kept from "
		    "then on\n",
		    r.mended, r.mended_distance );
	}
	return text +
	       fmt::format(
	           "path        {} straight and {} bent pieces, length {:.6g}, before shortcuts {:.6g}; {} rests on its way\n",
	           r.straight, r.bent, r.length, r.raw_length, r.rests ) +
	       fmt::format(
	           "search      {:.3f} s, shortcuts {:.3f} s, timing {:.3f} s; {} nodes from the start, {} from the goal\n",
	           r.search_seconds, r.shortcut_seconds, r.drive_seconds, r.start_nodes, r.goal_nodes );
}

} // namespace leeway::manifold
