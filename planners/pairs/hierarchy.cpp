// SPDX-License-Identifier: BSD-3-Clause
// The tree of links with the spheres of its nodes, and counts of pair classes.
#include "leeway/pairs/hierarchy.hpp"
#include "leeway/io/joint_type.hpp"
#include "pairs/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace leeway::pairs
{
namespace
{

struct TreeLine
{
	std::uint32_t link, depth;
};

// Depth first, children in the order of their links.
std::vector<TreeLine> treeOf( const lw_robot* robot )
{
	std::vector<std::vector<std::uint32_t>> children( lw_robot_link_count( robot ) );
	std::uint32_t root = 0;
	for ( std::uint32_t link = 0; link < children.size(); ++link )
	{
		const std::uint32_t joint = lw_robot_link_joint( robot, link );
		if ( joint == LW_INVALID_INDEX )
		{
			root = link;
			continue;
		}
		children[lw_robot_joint_parent( robot, joint )].push_back( link );
	}
	std::vector<TreeLine> lines, open = { { root, 0 } };
	while ( !open.empty() )
	{
		const TreeLine line = open.back();
		open.pop_back();
		lines.push_back( line );
		for ( auto child = children[line.link].rbegin(); child != children[line.link].rend(); ++child )
		{
			open.push_back( { *child, line.depth + 1 } );
		}
	}
	return lines;
}

std::string radiusText( const lw_sphere& sphere )
{
	return sphere.radius < 0 ? "-" : std::isinf( sphere.radius ) ? "unbounded" : fmt::format( "{:.4f}", sphere.radius );
}

// JSON has no infinity: an unbounded sphere has the radius null, an empty one is null itself.
Json sphereJson( const lw_sphere& sphere )
{
	if ( sphere.radius < 0 )
	{
		return nullptr;
	}
	return { { "center", { motions::jsonNumber( sphere.center[0] ), motions::jsonNumber( sphere.center[1] ),
	                         motions::jsonNumber( sphere.center[2] ) } },
	    { "radius", motions::jsonNumber( sphere.radius ) } };
}

std::size_t pairsOf( const lw_reach* reach, lw_pair_class kind )
{
	std::size_t count = 0;
	const std::uint32_t links = lw_robot_link_count( lw_reach_robot( reach ) );
	for ( std::uint32_t a = 0; a < links; ++a )
	{
		for ( std::uint32_t b = a + 1; b < links; ++b )
		{
			count += lw_reach_get_pair( reach, a, b ).kind == kind ? 1 : 0;
		}
	}
	return count;
}

constexpr lw_pair_class classes[] = {
    LW_PAIR_RIGID, LW_PAIR_ADJACENT, LW_PAIR_ALLOWED, LW_PAIR_NEVER, LW_PAIR_ALWAYS, LW_PAIR_CHECK };

} // namespace

io::ReachOptions hullsOnly()
{
	io::ReachOptions options;
	options.def.hulls_only = true;
	options.def.seconds = 0;
	return options;
}

io::LoadedReach findHulls( const io::Problem& problem, const io::ReachOptions& options )
{
	return problem.reach.reach ? problem.reach : io::loadReach( problem.robot, options );
}

std::string hierarchyText( const io::LoadedReach& hulls )
{
	const lw_robot* robot = lw_reach_robot( hulls.reach.get() );
	const std::vector<TreeLine> lines = treeOf( robot );
	std::size_t width = 4;
	for ( const TreeLine& line : lines )
	{
		width = std::max( width, 2 * line.depth + std::string( lw_robot_link_name( robot, line.link ) ).size() );
	}
	std::string text = fmt::format(
	    "hierarchy, {} in {:.1f} ms; radii in metres\n", hulls.cached ? "from the cache" : "built", hulls.milliseconds );
	text +=
	    fmt::format( "  {:<{}} {:>9} {:>9} {:>9} {:>7} {:>8}  joint\n", "link", width, "R", "M", "MR", "points", "excess" );
	for ( const TreeLine& line : lines )
	{
		const lw_reach_node node = lw_reach_get_node( hulls.reach.get(), line.link );
		const std::uint32_t joint = lw_robot_link_joint( robot, line.link );
		const std::string name = std::string( 2 * line.depth, ' ' ) + lw_robot_link_name( robot, line.link );
		text += fmt::format( "  {:<{}} {:>9} {:>9} {:>9} {:>7} {:>8}  {}\n", name, width, radiusText( node.r ),
		    radiusText( node.m ), radiusText( node.mr ), node.hull_point_count,
		    node.hull_point_count > 0 ? fmt::format( "{:.4f}", node.excess ) : "-",
		    joint == LW_INVALID_INDEX ? std::string( "(root)" )
		                              : fmt::format( "{} ({}{})", lw_robot_joint_name( robot, joint ),
		                                    io::jointTypeName( lw_robot_joint_type( robot, joint ) ),
		                                    lw_robot_joint_mimic( robot, joint ) == LW_INVALID_INDEX ? "" : ", mimic" ) );
	}
	return text;
}

Json hierarchyJson( const io::LoadedReach& hulls )
{
	const lw_robot* robot = lw_reach_robot( hulls.reach.get() );
	Json json = { { "cached", hulls.cached }, { "milliseconds", hulls.milliseconds } };
	for ( const TreeLine& line : treeOf( robot ) )
	{
		const lw_reach_node node = lw_reach_get_node( hulls.reach.get(), line.link );
		const std::uint32_t joint = lw_robot_link_joint( robot, line.link );
		Json entry = { { "link", lw_robot_link_name( robot, line.link ) }, { "depth", line.depth },
		    { "r", sphereJson( node.r ) }, { "m", sphereJson( node.m ) }, { "mr", sphereJson( node.mr ) },
		    { "hull_points", node.hull_point_count }, { "dilation", motions::jsonNumber( node.dilation ) },
		    { "excess", motions::jsonNumber( node.excess ) } };
		entry["joint"] = joint == LW_INVALID_INDEX ? Json( nullptr ) : Json( lw_robot_joint_name( robot, joint ) );
		entry["joint_type"] =
		    joint == LW_INVALID_INDEX ? Json( nullptr ) : Json( io::jointTypeName( lw_robot_joint_type( robot, joint ) ) );
		json["links"].push_back( entry );
	}
	return json;
}

std::string pairClassText( const io::LoadedReach& tables )
{
	std::string text;
	for ( const lw_pair_class kind : classes )
	{
		text += fmt::format(
		    "{}{} {}", text.empty() ? "" : ", ", pairsOf( tables.reach.get(), kind ), lw_pair_class_name( kind ) );
	}
	const lw_reach_info& info = tables.info;
	text = fmt::format( "pair tables of all joints, from the cache: {}\n", text );
	text += fmt::format(
	    "  of {} pairs that may not touch {} are proved to stay apart ({:.0f} %), {} can touch, {} cannot be proved, {} are open; "
	    "grids of {} pairs; {} random states\n",
	    info.pairs, info.proved, info.pairs > 0 ? 100.0 * info.proved / info.pairs : 100.0, info.contact, info.unprovable,
	    info.open, info.grids, info.samples );
	return text +
	       ( info.complete
	               ? fmt::format( "  proofs are complete, after {:.1f} s\n", info.seconds )
	               : fmt::format(
	                     "  proofs are not complete after {:.1f} s: the next runs continue them (--proofs S); or leeway pairs "
	                     "--budget S at once\n",
	                     info.seconds ) );
}

Json pairClassJson( const io::LoadedReach& tables )
{
	Json json;
	for ( const lw_pair_class kind : classes )
	{
		json[lw_pair_class_name( kind )] = pairsOf( tables.reach.get(), kind );
	}
	const lw_reach_info& info = tables.info;
	json["seconds_spent"] = info.seconds;
	json["proofs"] = { { "pairs", info.pairs }, { "proved", info.proved }, { "contact", info.contact },
	    { "unprovable", info.unprovable }, { "open", info.open }, { "grids", info.grids }, { "samples", info.samples },
	    { "complete", info.complete } };
	return json;
}

} // namespace leeway::pairs
