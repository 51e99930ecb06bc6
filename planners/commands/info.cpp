// SPDX-License-Identifier: BSD-3-Clause
// leeway info: reports input files, built objects, and the objects that the checker keeps or drops, with reasons.
#include "motions/names.hpp"
#include "pairs/report.hpp"
#include "program/setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

namespace leeway::cli
{

using namespace pairs;

namespace
{

// One collision element: its source and its shape.
struct ShapeLine
{
	std::string owner, source;
	bool shared = false, cached = false;
	double milliseconds = 0;
	lw_shape_info info{};
};

struct Totals
{
	std::size_t elements = 0, shapes = 0, triangles = 0, distinct_triangles = 0, nodes = 0, leaves = 0, bytes = 0;
	std::size_t stands_for = 0; // triangles, points and balls of the shapes before --detail
	double excess = 0;          // metres, the largest
	double milliseconds = 0;
};

void add( std::vector<ShapeLine>& lines, const std::string& owner, const std::vector<io::PlacedShape>& shapes,
    const io::LoadReport& report )
{
	// The report has one line per collision element, in order, for every owner.
	std::vector<const io::LoadedShape*> loaded;
	for ( const io::LoadedShape& shape : report.shapes )
	{
		if ( shape.owner == owner )
		{
			loaded.push_back( &shape );
		}
	}
	for ( std::size_t i = 0; i < shapes.size(); ++i )
	{
		ShapeLine line;
		line.owner = owner;
		line.info = lw_shape_get_info( shapes[i].shape.get() );
		if ( i < loaded.size() )
		{
			line.source = loaded[i]->source;
			line.shared = loaded[i]->shared;
			line.cached = loaded[i]->cached;
			line.milliseconds = loaded[i]->totalMilliseconds();
		}
		lines.push_back( line );
	}
}

// @param report whose time for the cache counts too; may be nullptr
Totals total( const std::vector<ShapeLine>& lines, const io::LoadReport* report = nullptr )
{
	Totals totals;
	totals.milliseconds = report != nullptr ? report->cache_milliseconds : 0;
	for ( const ShapeLine& line : lines )
	{
		++totals.elements;
		totals.triangles += line.info.triangle_count;
		totals.stands_for += line.info.original_count;
		totals.excess = std::max( totals.excess, line.info.excess );
		totals.milliseconds += line.milliseconds;
		if ( !line.shared )
		{
			++totals.shapes;
			totals.distinct_triangles += line.info.triangle_count;
			totals.nodes += line.info.node_count;
			totals.leaves += line.info.leaf_count;
			totals.bytes += line.info.bytes;
		}
	}
	return totals;
}

// Why pairs of links with geometry are checked or not.
struct PairCounts
{
	std::size_t all = 0, rigid = 0, disabled = 0, still = 0, checked = 0;
	std::map<std::string, std::size_t> reasons; // of the SRDF
};

// The links whose pose relative to `link` no variable of the group can change share its label.
std::vector<std::uint32_t> rigidLabels( const Workbench& bench, bool group_only )
{
	const lw_robot* robot = bench.robot();
	std::vector<std::uint32_t> label( lw_robot_link_count( robot ) );
	const auto moves = [&]( std::uint32_t joint )
	{
		const std::uint32_t leader = lw_robot_joint_mimic( robot, joint );
		const std::uint32_t variable = lw_robot_joint_variable( robot, leader == LW_INVALID_INDEX ? joint : leader );
		return variable != LW_INVALID_INDEX && ( !group_only || bench.inGroup( variable ) );
	};
	for ( std::uint32_t link = 0; link < label.size(); ++link )
	{
		std::uint32_t root = link;
		for ( std::uint32_t joint = lw_robot_link_joint( robot, root ); joint != LW_INVALID_INDEX && !moves( joint );
		      joint = lw_robot_link_joint( robot, root ) )
		{
			root = lw_robot_joint_parent( robot, joint );
		}
		label[link] = root;
	}
	return label;
}

PairCounts countPairs( const Workbench& bench, const io::RobotModel& model )
{
	PairCounts counts;
	const lw_robot* robot = bench.robot();
	std::set<std::uint32_t> links;
	for ( std::uint32_t i = 0; i < lw_robot_body_count( robot ); ++i )
	{
		links.insert( lw_robot_body( robot, i ).link );
	}
	const std::vector<std::uint32_t> rigid = rigidLabels( bench, false ), still = rigidLabels( bench, true );
	for ( auto a = links.begin(); a != links.end(); ++a )
	{
		for ( auto b = std::next( a ); b != links.end(); ++b )
		{
			++counts.all;
			++( rigid[*a] == rigid[*b]                   ? counts.rigid
			    : lw_robot_pair_allowed( robot, *a, *b ) ? counts.disabled
			    : still[*a] == still[*b]                 ? counts.still
			                                             : counts.checked );
		}
	}
	for ( const io::DisabledPair& pair : model.disabled )
	{
		++counts.reasons[pair.reason.empty() ? "no reason given" : pair.reason];
	}
	return counts;
}

std::string shapeTable( const std::vector<ShapeLine>& lines )
{
	std::size_t owner_width = 5, source_width = 6;
	for ( const ShapeLine& line : lines )
	{
		owner_width = std::max( owner_width, line.owner.size() );
		source_width = std::max( source_width, line.source.size() );
	}
	const bool coarser =
	    std::any_of( lines.begin(), lines.end(), []( const ShapeLine& line ) { return line.info.excess > 0; } );
	std::string text = fmt::format( "  {:<{}}  {:<{}} {:>9} {:>8} {:>10} {:>9}{}\n", "owner", owner_width, "source",
	    source_width, "triangles", "nodes", "bytes", "ms", coarser ? "  stands for  excess mm" : "" );
	for ( const ShapeLine& line : lines )
	{
		const bool own = line.info.excess > 0;
		fmt::format_to( std::back_inserter( text ), "  {:<{}}  {:<{}} {:>9} {:>8} {:>10} {:>9}{}\n", line.owner, owner_width,
		    line.source, source_width, line.info.triangle_count, line.shared ? "" : std::to_string( line.info.node_count ),
		    line.shared ? "" : std::to_string( line.info.bytes ),
		    line.shared   ? "shared"
		    : line.cached ? "cached"
		                  : fmt::format( "{:.2f}", line.milliseconds ),
		    own ? fmt::format( "  {:>10}  {:>9.3f}", line.info.original_count, 1000 * line.info.excess ) : "" );
	}
	return text;
}

std::string totalLine( const char* what, const Totals& totals )
{
	const double per_triangle =
	    totals.distinct_triangles == 0 ? 0 : double( totals.bytes ) / double( totals.distinct_triangles );
	const std::string coarser =
	    totals.excess > 0 ? fmt::format( "; they stand for {} triangles or points, with an excess of at most {:.3f} mm",
	                            totals.stands_for, 1000 * totals.excess )
	                      : "";
	return fmt::format(
	    "{}: {} collision elements with {} triangles from {} distinct shapes ({} triangles, {} tree nodes, {} leaves, {} "
	    "bytes, {:.0f} bytes per triangle); read and built in {:.1f} ms{}\n",
	    what, totals.elements, totals.triangles, totals.shapes, totals.distinct_triangles, totals.nodes, totals.leaves,
	    totals.bytes, per_triangle, totals.milliseconds, coarser );
}

Json totalJson( const Totals& totals )
{
	return { { "elements", totals.elements }, { "triangles", totals.triangles }, { "stands_for", totals.stands_for },
	    { "excess", totals.excess }, { "distinct_shapes", totals.shapes },
	    { "distinct_triangles", totals.distinct_triangles }, { "nodes", totals.nodes }, { "leaves", totals.leaves },
	    { "bytes", totals.bytes }, { "milliseconds", totals.milliseconds } };
}

Json shapesJson( const std::vector<ShapeLine>& lines )
{
	Json json = Json::array();
	for ( const ShapeLine& line : lines )
	{
		json.push_back( { { "owner", line.owner }, { "source", line.source }, { "triangles", line.info.triangle_count },
		    { "degenerate", line.info.degenerate_count }, { "nodes", line.info.node_count },
		    { "leaves", line.info.leaf_count }, { "depth", line.info.depth }, { "bytes", line.info.bytes },
		    { "milliseconds", line.milliseconds }, { "shared", line.shared }, { "cached", line.cached },
		    { "stands_for", line.info.original_count }, { "excess", line.info.excess } } );
	}
	return json;
}

std::string joined( const std::vector<std::string>& names )
{
	std::string text;
	for ( const std::string& name : names )
	{
		text += ( text.empty() ? "" : ", " ) + name;
	}
	return text;
}

std::string robotText( const io::RobotModel& model, const Workbench& bench, const std::vector<ShapeLine>& shapes )
{
	std::size_t mimic = 0, fixed = 0;
	for ( const io::JointModel& joint : model.joints )
	{
		mimic += joint.mimic.empty() ? 0 : 1;
		fixed += joint.type == LW_JOINT_FIXED ? 1 : 0;
	}
	std::string text = fmt::format( "robot {} ({})\n", model.name, model.urdf_file );
	text += fmt::format( "  {} links, {} of them without collision geometry; {} joints: {} movable, {} mimic, {} fixed\n",
	    model.links.size(), model.report.links_without_geometry.size(), model.joints.size(),
	    model.joints.size() - mimic - fixed, mimic, fixed );
	text += fmt::format( "  {} variables; root {}, planning frame {}\n", bench.variableNames().size(), model.root_link,
	    model.planning_frame );
	for ( const io::Group& group : model.groups )
	{
		text += fmt::format( "  group {}: {}\n", group.name,
		    group.defect.empty() ? counted( group.joints.size(), "joint" ) : "cannot be used: " + group.defect );
	}
	text += shapeTable( shapes ) + "  " + totalLine( "total", total( shapes, &model.report ) );
	if ( !model.report.cache.empty() )
	{
		text += fmt::format( "  cache {}: {:.1f} ms of these for digests and looking files up\n", model.report.cache,
		    model.report.cache_milliseconds );
	}
	return text;
}

std::string sceneText( const io::SceneModel& scene, const std::vector<ShapeLine>& shapes )
{
	std::string text = fmt::format( "scene {} ({})\n  {} objects, {} attached to the robot\n", scene.name, scene.file,
	    scene.objects.size(), scene.attached.size() );
	return text + shapeTable( shapes ) + "  " + totalLine( "total", total( shapes, &scene.report ) );
}

std::string checkerText( const Workbench& bench, const PairCounts& pairs, const lw_checker_info& info )
{
	const io::Problem& problem = bench.problem();
	std::string text = fmt::format( "checker for {}\n", problem.group.empty() ? "all joints" : "group " + problem.group );
	text += fmt::format( "  state: {}\n", joined( problem.variable_names ) );
	text += fmt::format( "  kept: {} moving and {} static bodies, {} environment pairs, {} self pairs of bodies; {} bytes, "
	                     "built in {:.1f} ms\n",
	    info.moving_bodies, info.static_bodies, info.environment_pairs, info.self_pairs, info.bytes,
	    1000 * bench.buildSeconds() );
	text += fmt::format( "  pairs of links with geometry: {}; checked {}; dropped: {} rigidly attached, {} disabled, {} "
	                     "that this group cannot "
	                     "move against each other\n",
	    pairs.all, pairs.checked, pairs.rigid, pairs.disabled, pairs.still );
	for ( const auto& [reason, count] : pairs.reasons )
	{
		text += fmt::format( "  disabled: {}, reason {}\n", counted( count, "pair" ), reason );
	}
	if ( hasMargins( bench.checker() ) )
	{
		text +=
		    fmt::format( "  margins: up to {} m to obstacles, {} m between links; clearances are distances less margins\n",
		        info.environment_margin, info.self_margin );
	}
	const Named fixed = nameEnvironment( bench.checker(), info.static_environment );
	return text + ( fixed.first.empty() ? "  static bodies: nothing near\n"
	                                    : fmt::format( "  static bodies: environment clearance {} m, {} - {}{}\n",
	                                          fixed.least(), fixed.first, fixed.second, fixed.marginText() ) );
}

Json pairsJson( const PairCounts& pairs )
{
	return { { "all", pairs.all }, { "checked", pairs.checked }, { "rigid", pairs.rigid }, { "disabled", pairs.disabled },
	    { "group_cannot_move", pairs.still }, { "srdf_reasons", pairs.reasons } };
}

/// Lines for the shapes of the robot's links, and of the scene's objects, attached ones included.
void addShapes( const Input& input, std::vector<ShapeLine>& robot_shapes, std::vector<ShapeLine>& scene_shapes )
{
	for ( const io::LinkModel& link : input.robot.links )
	{
		add( robot_shapes, link.name, link.collision, input.robot.report );
	}
	if ( input.scene )
	{
		for ( const io::SceneObject& object : input.scene->objects )
		{
			add( scene_shapes, object.name, object.shapes, input.scene->report );
		}
		for ( const io::AttachedObject& attached : input.scene->attached )
		{
			add( scene_shapes, attached.object.name, attached.object.shapes, input.scene->report );
		}
	}
}

io::LoadedReach hullsOf( const Workbench& bench )
{
	io::ReachOptions options = hullsOnly();
	Progress progress( "motion hulls" );
	ReachProgress report( progress );
	report.attach( options.def );
	return findHulls( bench.problem(), options );
}

} // namespace

int runInfo( const InfoOptions& options )
{
	Notices notices( options.common.verbose );
	OutputFile json_file( "--json", options.json );
	Input input = loadInput( options.common, notices );
	if ( input.reach )
	{
		input.reach->build = options.common.proofs_given; // otherwise info only reads the cache
	}
	input.max_d = options.common.max_d;
	const Workbench bench( input, options.common.group, {}, notices );
	const Required required = findRequired(
	    bench.problem(), input.robot, input.scene ? &*input.scene : nullptr ); // from here on everything is made
	std::vector<ShapeLine> robot_shapes, scene_shapes;
	addShapes( input, robot_shapes, scene_shapes );
	const PairCounts pairs = countPairs( bench, input.robot );
	const lw_checker_info info = lw_checker_get_info( bench.checker() );
	std::vector<ShapeLine> all = robot_shapes;
	all.insert( all.end(), scene_shapes.begin(), scene_shapes.end() );

	std::string text = robotText( input.robot, bench, robot_shapes );
	text += input.scene ? sceneText( *input.scene, scene_shapes ) : "no scene\n";
	text += checkerText( bench, pairs, info ) + requiredText( bench.problem(), required );
	text += bench.reach().reach ? pairClassText( bench.reach() )
	        : input.reach
	            ? fmt::format( "no pair tables in the cache yet: check, edge, plan, audit and tune make them, {} s a run\n",
	                  input.reach->def.seconds )
	            : "";
	const io::LoadedReach hulls = hullsOf( bench );
	notices.add( "motion hulls", hulls.notices );
	text += hulls.reach ? hierarchyText( hulls ) : "";
	text += totalLine( "all", total( all, &input.robot.report ) );
	text += fmt::format( "files read in {:.3f} s; {}\n", input.robot_seconds + input.scene_seconds,
	    counted( notices.all().size(), "notice" ) );
	if ( !options.json.empty() )
	{
		Json json;
		json["robot"] = { { "name", input.robot.name }, { "file", input.robot.urdf_file },
		    { "links", input.robot.links.size() }, { "joints", input.robot.joints.size() },
		    { "variables", bench.variableNames() }, { "links_without_geometry", input.robot.report.links_without_geometry },
		    { "shapes", shapesJson( robot_shapes ) }, { "total", totalJson( total( robot_shapes, &input.robot.report ) ) },
		    { "seconds", input.robot_seconds } };
		json["scene"] = nullptr;
		if ( input.scene )
		{
			json["scene"] = { { "name", input.scene->name }, { "file", input.scene->file },
			    { "objects", input.scene->objects.size() }, { "attached", input.scene->attached.size() },
			    { "shapes", shapesJson( scene_shapes ) },
			    { "total", totalJson( total( scene_shapes, &input.scene->report ) ) }, { "seconds", input.scene_seconds } };
		}
		json["checker"] = { { "group", bench.problem().group }, { "variables", bench.problem().variable_names },
		    { "moving_bodies", info.moving_bodies }, { "static_bodies", info.static_bodies },
		    { "environment_pairs", info.environment_pairs }, { "self_pairs", info.self_pairs },
		    { "largest_margin", { { "environment", info.environment_margin }, { "self", info.self_margin } } },
		    { "bytes", info.bytes }, { "seconds", bench.buildSeconds() }, { "link_pairs", pairsJson( pairs ) },
		    { "static_environment", jsonClearance( nameEnvironment( bench.checker(), info.static_environment ) ) } };
		json["required"] = requiredJson( required );
		json["cache"] = {
		    { "folder", input.robot.report.cache }, { "milliseconds", input.robot.report.cache_milliseconds } };
		json["pair_classes"] = bench.reach().reach ? pairClassJson( bench.reach() ) : Json( nullptr );
		json["hierarchy"] = hulls.reach ? hierarchyJson( hulls ) : Json( nullptr );
		json["total"] = totalJson( total( all, &input.robot.report ) );
		json["notices"] = notices.all();
		json_file.text = jsonText( json );
		json_file.commit();
	}
	printOut( text );
	return exit_yes;
}

} // namespace leeway::cli
