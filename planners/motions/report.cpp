// SPDX-License-Identifier: BSD-3-Clause
// Audits as JSON: see report.hpp.
#include "motions/report.hpp"

namespace leeway::motions
{
namespace
{

const char* verdictName( lw_verdict verdict )
{
	return verdict == LW_VERDICT_FREE ? "FREE" : verdict == LW_VERDICT_BLOCKED ? "BLOCKED" : "UNDECIDED";
}

Json leastJson( const AuditLeast& least, double between )
{
	Json json = jsonClearance( least.clearance );
	if ( !json.is_null() )
	{
		json["edge"] = least.place.edge;
		json["t"] = least.place.t;
		json["s"] = least.place.s;
		json["between_states"] = jsonNumber( between );
	}
	return json;
}

} // namespace

Json toJson( const Audit& audit, const AuditSettings& settings )
{
	Json json;
	json["valid"] = audit.valid;
	json["problems"] = audit.problems;
	json["min_d"] = settings.min_d;
	json["resolution"] = settings.resolution;
	json["states"] = audit.states;
	json["length"] = audit.length;
	json["seconds"] = audit.seconds;
	json["environment"] = leastJson( audit.environment, audit.environment_between );
	json["self"] = leastJson( audit.self, audit.self_between );
	json["profile"] = Json::array();
	for ( const AuditSample& part : profile( audit, 100 ) )
	{
		json["profile"].push_back( { { "s", part.place.s }, { "environment", jsonNumber( part.environment ) },
		    { "self", jsonNumber( part.self ) } } );
	}
	return json;
}

Json toJson( const RoundingAudit& audit )
{
	const RoundingProof& proof = audit.proof;
	Json json;
	json["verdict"] = verdictName( proof.verdict );
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
			json["state"][audit.names[k]] = proof.q[k];
		}
	}
	return json;
}

Json toJson( const TrajectoryAudit& audit )
{
	Json json;
	json["valid"] = audit.valid();
	json["segments"] = {
	    { "linear", audit.by_degree[1] }, { "cubic", audit.by_degree[3] }, { "quintic", audit.by_degree[5] } };
	json["duration"] = audit.duration;
	json["min_d"] = audit.min_d;
	const Violation& v = audit.violation;
	json["verdict"] = verdictName( v.verdict );
	json["lower_bound"] = jsonNumber( audit.lower_bound );
	json["proof_seconds"] = audit.proof_seconds;
	json["states"] = audit.states;
	for ( const auto& [name, value] : audit.tolerance )
	{
		json["tolerance"][name] = value;
	}
	if ( v.verdict != LW_VERDICT_FREE )
	{
		Json& out = json["violation"];
		out["time"] = v.time;
		out["kind"] = v.self ? "self" : "environment";
		out["pair"] = { v.pair.first, v.pair.second };
		out["clearance"] = jsonNumber( v.pair.least() );
		for ( std::size_t k = 0; k < v.q.size(); ++k )
		{
			out["state"][v.names[k]] = v.q[k];
		}
	}
	json["problems"] = audit.problems;
	return json;
}

Json toJson( const ScheduleAudit& audit )
{
	Json json;
	json["valid"] = audit.valid();
	json["from"] = audit.from;
	json["to"] = audit.to;
	json["min_d"] = audit.min_d;
	json["verdict"] = verdictName( audit.verdict );
	json["lower_bound"] = jsonNumber( audit.lower_bound );
	json["proved_until"] = audit.proved_until;
	json["pieces"] = audit.pieces;
	json["states"] = audit.states;
	json["seconds"] = audit.seconds;
	if ( !audit.valid() )
	{
		Json& out = json["violation"];
		out["time"] = audit.time;
		out["kind"] = audit.self ? "self" : "environment";
		out["by_unknown_motion"] = audit.by_spread;
		out["pair"] = { audit.pair.first, audit.pair.second };
		out["clearance"] = jsonNumber( audit.pair.least() );
		for ( std::size_t k = 0; k < audit.q.size(); ++k )
		{
			out["state"][audit.names[k]] = audit.q[k];
		}
	}
	return json;
}

} // namespace leeway::motions
