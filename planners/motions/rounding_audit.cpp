// SPDX-License-Identifier: BSD-3-Clause
// Roundings of a path with the names of what is in their way: see roundings.hpp.
#include "leeway/motions/roundings.hpp"
#include "motions/names.hpp"

#include <fmt/format.h>

#include <chrono>

namespace leeway::motions
{

RoundingAudit auditRoundings( const io::Problem& problem, const std::vector<std::vector<double>>& points, double radius,
    const lw_edge_def& def, const std::string& file )
{
	for ( const std::uint32_t variable : problem.variables )
	{
		if ( lw_robot_joint_type( problem.robot.get(), lw_robot_variable( problem.robot.get(), variable ).joint ) ==
		     LW_JOINT_FLOATING )
		{
			throw io::Error( file, "roundings", "the group has a floating joint, whose turns have no straight edges",
			    "leave the roundings out (--corner-blend), or choose a group without it" );
		}
	}
	RoundingAudit audit;
	audit.radius = radius;
	audit.min_d = def.min_d;
	audit.names = problem.variable_names;
	const auto start = std::chrono::steady_clock::now();
	const lw_checker* checker = problem.checker.get();
	const Query query = makeQuery( checker );
	require( proveRoundings( checker, query.get(), unwrapped( problem, points ), radius, def, audit.proof ),
	    "proof of roundings" );
	audit.seconds = std::chrono::duration<double>( std::chrono::steady_clock::now() - start ).count();
	const RoundingProof& proof = audit.proof;
	lw_clearance pair = proof.pair;
	if ( proof.verdict == LW_VERDICT_BLOCKED ) // a proof looks no closer at a contact than it has to
	{
		const lw_state_result state =
		    measure( checker, query.get(), proof.q, def.flags, nullptr, file, "the state of the violation" );
		pair = proof.self ? state.self : state.environment;
	}
	audit.pair = proof.self ? nameSelf( checker, pair ) : nameEnvironment( checker, pair );
	return audit;
}

std::string describe( const RoundingAudit& audit )
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
		out += fmt::format( "{}{} {:.6g}", k == 0 ? "state       " : ", ", audit.names[k], proof.q[k] );
	}
	out += "\n";
	return proof.on_edge ? out
	                     : out + fmt::format( "            roundings of this corner by up to {:.4g} are proved free\n",
	                                 proof.free_radius );
}

} // namespace leeway::motions
