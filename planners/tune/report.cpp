// SPDX-License-Identifier: BSD-3-Clause
// A tuning as JSON: see report.hpp.
#include "tune/report.hpp"

namespace leeway::tune
{
namespace
{

Json toJson( const Row& row, double rate )
{
	const bool certified = row.motion && row.method == LW_EDGE_CERTIFIED;
	Json json = { { "kind", row.motion ? "motion" : "state" }, { "min_d", row.min_d },
	    { "max_d", certified ? Json( nullptr ) : Json( row.max_d ) }, { "alpha", row.alpha },
	    { "validator", row.motion ? Json( validatorName( row ) ) : Json( nullptr ) },
	    { "slack", certified ? Json( row.slack ) : Json( nullptr ) }, { "proof", row.proof }, { "promised", row.promised },
	    { "worst", row.worst }, { "mean", row.mean }, { "free", row.free }, { "missed", row.missed }, { "work", row.work },
	    { "time_us", rate * row.work }, { "measured_us", row.measured }, { "front", row.front } };
	return json;
}

} // namespace

const char* validatorName( const Row& row )
{
	return row.method == LW_EDGE_STEPS ? "steps" : "certified";
}

Json toJson( const Tuning& tuning, const Settings& settings )
{
	const Samples& samples = tuning.samples;
	const Proposal& proposal = tuning.proposal;
	const double rate = tuning.rate;
	static const char* const kinds[] = { "none", "time_per_state_us", "error_m", "edge_conservatism_m" };
	const auto row = [rate]( const Row* r ) { return r == nullptr ? Json( nullptr ) : toJson( *r, rate ); };
	Json json = { { "min_d", settings.min_d }, { "max_d", settings.max_d }, { "seed", settings.seed },
	    { "states", samples.states.size() }, { "free_states", samples.free_states }, { "motions", samples.motions.size() },
	    { "free_motions", samples.free_motions }, { "rate", rate },
	    { "target",
	        { { "kind", kinds[settings.target.kind] }, { "value", settings.target.value }, { "met", proposal.met } } },
	    { "proposal", { { "state", row( proposal.states ) }, { "motion", row( proposal.motions ) } } } };
	json["settings"] = Json::array();
	for ( const Row& r : tuning.rows )
	{
		json["settings"].push_back( toJson( r, rate ) );
	}
	return json;
}

} // namespace leeway::tune
