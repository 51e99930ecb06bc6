// SPDX-License-Identifier: BSD-3-Clause
// leeway audit: an independent look at a path file.
#include "leeway/handles.hpp"
#include "leeway/motions/audit.hpp"
#include "leeway/motions/motion_files.hpp"
#include "leeway/motions/roundings.hpp"
#include "leeway/motions/trajectory.hpp"
#include "motions/names.hpp"
#include "leeway/motions/path_file.hpp"
#include "view/page.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

namespace leeway::cli
{
namespace
{

// ---- roundings of corners --------------------------------------------------------------------------------------------

struct RoundingAudit
{
	double radius = 0, seconds = 0, min_d = 0;
	RoundingProof proof;
	Named pair;
	bool valid() const { return proof.verdict == LW_VERDICT_FREE; }
};

/// Angles go on without wrapping: edges of continuous joints go the shorter way.
std::vector<std::vector<double>> unwrapped( const Workbench& bench, std::vector<std::vector<double>> points )
{
	for ( std::size_t v = 0; v < bench.problem().variables.size(); ++v )
	{
		for ( std::size_t i = 1; i < points.size(); ++i )
		{
			const double from = points[i - 1][v];
			const double shorter = shorterWay( bench.robot(), bench.problem().variables[v], from, points[i][v] );
			points[i][v] = shorter == points[i][v] - from ? points[i][v] : from + shorter;
		}
	}
	return points;
}

RoundingAudit proveCorners(
    const Workbench& bench, const std::vector<std::vector<double>>& points, const AuditOptions& options, double min_d )
{
	for ( const std::uint32_t variable : bench.problem().variables )
	{
		if ( lw_robot_joint_type( bench.robot(), lw_robot_variable( bench.robot(), variable ).joint ) == LW_JOINT_FLOATING )
		{
			throw io::Error( "command line", "--corner-blend",
			    "the group has a floating joint, whose turns have no straight edges",
			    "leave --corner-blend out, or choose a group without it" );
		}
	}
	lw_edge_def def = lw_edge_def_default();
	const std::vector<double> tolerance = tolerances( bench, "command line", {}, options.tolerance );
	def.tolerance = tolerance.empty() ? nullptr : tolerance.data();
	def.min_d = min_d;
	def.flags = options.common.checkFlags();
	RoundingAudit audit;
	audit.radius = options.corner_blend;
	audit.min_d = min_d;
	const auto start = std::chrono::steady_clock::now();
	require(
	    proveRoundings( bench.checker(), bench.query(), unwrapped( bench, points ), options.corner_blend, def, audit.proof ),
	    "proof of roundings" );
	audit.seconds = std::chrono::duration<double>( std::chrono::steady_clock::now() - start ).count();
	const RoundingProof& proof = audit.proof;
	lw_clearance pair = proof.pair;
	if ( proof.verdict == LW_VERDICT_BLOCKED ) // a proof looks no closer at a contact than it has to
	{
		const lw_state_result state =
		    measure( bench, proof.q, def.flags, nullptr, options.path, "the state of the violation" );
		pair = proof.self ? state.self : state.environment;
	}
	audit.pair = proof.self ? nameSelf( bench.checker(), pair ) : nameEnvironment( bench.checker(), pair );
	return audit;
}

std::string describe( const RoundingAudit& audit, const Workbench& bench )
{
	const RoundingProof& proof = audit.proof;
	std::string out = fmt::format( "roundings   {} by up to {:g}: ", counted( proof.corners, "corner" ), audit.radius );
	const std::string work = fmt::format( "{} states in {:.4f} s", proof.queries, audit.seconds );
	if ( audit.valid() )
	{
		return out + fmt::format( "FREE, clearance at least {:.6g} m, proved for all of them; --min-d {:g} m; {}\n",
		                 proof.lower_bound, audit.min_d, work );
	}
	out += fmt::format( "{} {} points[{}], {} - {}, {} clearance {:.6g} m{}; {}\n",
	    proof.verdict == LW_VERDICT_BLOCKED ? "BLOCKED" : "UNDECIDED", proof.on_edge ? "on the edge to" : "at", proof.corner,
	    audit.pair.first, audit.pair.second, proof.self ? "self" : "environment", audit.pair.least(),
	    audit.pair.marginText(), work );
	for ( std::size_t k = 0; k < proof.q.size(); ++k )
	{
		out += fmt::format( "{}{} {:.6g}", k == 0 ? "state       " : ", ", bench.problem().variable_names[k], proof.q[k] );
	}
	out += "\n";
	return proof.on_edge ? out
	                     : out + fmt::format( "            roundings of this corner by up to {:.4g} are proved free\n",
	                                 proof.free_radius );
}

Json toJson( const RoundingAudit& audit, const Workbench& bench )
{
	const RoundingProof& proof = audit.proof;
	Json json;
	json["verdict"] = proof.verdict == LW_VERDICT_FREE      ? "FREE"
	                  : proof.verdict == LW_VERDICT_BLOCKED ? "BLOCKED"
	                                                        : "UNDECIDED";
	json["radius"] = audit.radius;
	json["corners"] = proof.corners;
	json["lower_bound"] = proof.lower_bound;
	json["states"] = proof.queries;
	json["seconds"] = audit.seconds;
	if ( !audit.valid() )
	{
		json["point"] = proof.corner;
		json["on_edge"] = proof.on_edge;
		json["free_radius"] = proof.free_radius;
		json["pair"] = { audit.pair.first, audit.pair.second };
		json["clearance"] = audit.pair.least();
		for ( std::size_t k = 0; k < proof.q.size(); ++k )
		{
			json["state"][bench.problem().variable_names[k]] = proof.q[k];
		}
	}
	return json;
}

} // namespace

int runAudit( const AuditOptions& options )
{
	Notices notices( options.common.verbose );
	const PathFile path = readPath( options.path );
	readsFile( "--path", options.path );
	OutputFile report( "--report", options.report ), profile_file( "--profile", options.profile );
	ViewFile view( options.view );
	const Input input = loadInput( options.common, notices );
	if ( !path.robot.empty() && path.robot != input.robot.name )
	{
		notices.add( "the path",
		    fmt::format( "{}: it was planned for robot '{}', this is '{}'", path.file, path.robot, input.robot.name ) );
	}
	const std::string group = groupOf( path, options.common.group, input.robot );
	Workbench bench( input, group, startValues( path, input.robot, notices ), notices );
	const std::vector<std::vector<double>> points = groupPoints( path, bench );
	notices.add( "keys of the path", path.notices );
	for ( const std::string& violation : limitViolations( bench, bench.problem().reference ) )
	{
		notices.add( "joint limits", fmt::format( "{}: start_state: {}", path.file, violation ) );
	}

	AuditSettings settings;
	settings.min_d = options.common.min_d_given ? options.common.min_d : path.min_d;
	settings.resolution = options.resolution;
	settings.time = options.time;
	settings.flags = options.common.checkFlags();
	Audit audit = auditPath( bench, points, settings, path.file );
	if ( input.request )
	{
		auditEnds( bench, *input.request, points, audit );
	}
	std::optional<RoundingAudit> corners;
	if ( options.corner_blend > 0 )
	{
		corners = proveCorners( bench, points, options, settings.min_d );
	}
	std::vector<OutputFile*> files;
	if ( !options.report.empty() )
	{
		Json json;
		json["path"] = options.path;
		json["robot"] = input.robot.name;
		json["group"] = group;
		json["points"] = points.size();
		json["audit"] = toJson( audit, settings );
		if ( corners )
		{
			json["roundings"] = toJson( *corners, bench );
		}
		report.text = jsonText( json );
		files.push_back( &report );
	}
	if ( !options.profile.empty() )
	{
		profile_file.text = profileCsv( audit );
		files.push_back( &profile_file );
	}
	if ( view.isWanted() )
	{
		PageInput page = { input, bench, motionOfPath( bench, points, settings.flags, path.file ), settings.flags };
		page.min_d = settings.min_d;
		page.source = options.path;
		page.notes = audit.problems;
		view.write( page, files );
	}
	commitTogether( files );
	printOut( describe( audit, settings, points ) + ( corners ? describe( *corners, bench ) : "" ) );
	return audit.valid && ( !corners || corners->valid() ) ? exit_yes : exit_no;
}

} // namespace leeway::cli
