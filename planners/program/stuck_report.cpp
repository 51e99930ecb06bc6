// SPDX-License-Identifier: BSD-3-Clause
// Reasons of a plan without a path, as lines and as JSON.
#include "program/stuck_report.hpp"

#include <fmt/format.h>

#include <sstream>

namespace leeway::cli
{
namespace
{

Json pairJson( const Workbench& bench, const planners::BlockingPair& pair )
{
	const std::string name = planners::pairName( bench.checker(), pair );
	const std::size_t middle = name.find( " - " );
	const bool named = pair.a != LW_INVALID_INDEX && middle != std::string::npos;
	return { { "first", named ? name.substr( 0, middle ) : "" }, { "second", named ? name.substr( middle + 3 ) : "" },
	    { "self", pair.self }, { "edges_blocked", pair.blocked }, { "edges_undecided", pair.undecided },
	    { "states", pair.states }, { "clearance", jsonNumber( pair.clearance ) } };
}

Json endJson( const Workbench& bench, const planners::EndRoom& room )
{
	Json json = { { "free", room.free }, { "enclosed", room.enclosed } };
	json["travel"] = Json::array();
	for ( std::size_t i = 0; i < room.up.size(); ++i )
	{
		json["travel"].push_back(
		    { { "joint", bench.problem().variable_names[i] }, { "down", room.down[i] }, { "up", room.up[i] } } );
	}
	json["pair"] = room.pair.count() > 0 ? pairJson( bench, room.pair ) : Json( nullptr );
	return json;
}

} // namespace

std::string stuckLines( const Workbench& bench, const planners::Stuck& stuck )
{
	if ( stuck.ends[0].empty() && stuck.ends[1].empty() )
	{
		return "";
	}
	std::istringstream lines( planners::describe( bench.checker(), stuck, { "--time", "--min-d", "--seed or --planner" } ) );
	std::string text, line;
	while ( std::getline( lines, line ) )
	{
		text += "leeway:   " + line + "\n";
	}
	return text;
}

Json toJson( const Workbench& bench, const planners::Stuck& stuck )
{
	Json json = { { "trees", nullptr } }; // of leeway's own planner
	const char* const sides[] = { "start", "goal" };
	for ( unsigned side = 0; side < 2; ++side )
	{
		const planners::TreeGrowth& tree = stuck.trees[side];
		if ( stuck.trees[0].nodes > 0 )
		{
			json["trees"].push_back( { { "of", sides[side] }, { "nodes", tree.nodes }, { "tries", tree.tries },
			    { "grown", tree.grown }, { "extent", tree.extent } } );
		}
		for ( const planners::EndRoom& room : stuck.ends[side] )
		{
			json[side == 0 ? "starts" : "goals"].push_back( endJson( bench, room ) );
		}
	}
	json["gap"] = jsonNumber( stuck.gap );
	json["motions_not_free"] = stuck.not_free;
	json["pairs"] = Json::array();
	for ( const planners::BlockingPair& pair : stuck.pairs )
	{
		json["pairs"].push_back( pairJson( bench, pair ) );
	}
	return json;
}

} // namespace leeway::cli
