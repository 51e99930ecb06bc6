// SPDX-License-Identifier: BSD-3-Clause
// An analysis of pairs as JSON: see report.hpp.
#include "pairs/report.hpp"

namespace leeway::pairs
{
namespace
{

Json rowJson( const PairRow& row )
{
	Json json = { { "link1", row.first }, { "link2", row.second }, { "class", lw_pair_class_name( row.pair.kind ) },
	    { "proof", row.pair.separation > 0 ? Json( lw_pair_proof_name( row.pair.proof ) ) : Json( nullptr ) },
	    { "separation", row.pair.separation }, { "closest", motions::jsonNumber( row.pair.closest ) },
	    { "contact_share", row.contactShare() }, { "contact_states", row.states },
	    { "never_seen_states", row.never_seen > 0 ? Json( row.never_seen ) : Json( nullptr ) },
	    { "adjacent", row.pair.adjacent }, { "reason", row.disabled ? Json( row.reason ) : Json( nullptr ) } };
	json["opinion"] = row.opinion == Opinion::NOTHING ? Json( nullptr ) : Json( opinionName( row.opinion ) );
	return json;
}

Json findingJson( const PairTable& table, const PairRow& row )
{
	Json json = { { "link1", row.first }, { "link2", row.second }, { "reason", row.reason },
	    { "adjacent", row.pair.adjacent }, { "always", row.always }, { "contact_share", row.contactShare() } };
	json["joints"] = Json::object();
	for ( const auto& [name, value] : table.evidence( row ) )
	{
		json["joints"][name] = value;
	}
	json["state"] = table.evidenceState( row );
	return json;
}

} // namespace

Json toJson( const Analysis& analysis, const io::RobotModel& model, const Settings& settings )
{
	const PairTable& table = analysis.table;
	const lw_robot* robot = analysis.robot.get();
	const io::LoadedReach& reach = analysis.reach;
	Json json;
	json["robot"] = model.name;
	json["urdf"] = model.urdf_file;
	json["srdf"] = model.srdf_file.empty() ? Json( nullptr ) : Json( model.srdf_file );
	for ( const lw_pair_class kind :
	    { LW_PAIR_RIGID, LW_PAIR_ADJACENT, LW_PAIR_ALLOWED, LW_PAIR_NEVER, LW_PAIR_ALWAYS, LW_PAIR_CHECK } )
	{
		json["classes"][lw_pair_class_name( kind )] = table.count( kind );
	}
	json["variables"] = Json::array();
	for ( std::uint32_t i = 0; i < lw_robot_variable_count( robot ); ++i )
	{
		json["variables"].push_back( io::variableName( robot, i ) );
	}
	json["findings"] = Json::array();
	json["pairs"] = Json::array();
	for ( const PairRow& row : table.rows() )
	{
		const bool touched = row.opinion == Opinion::FINDING || row.opinion == Opinion::ADJACENT_CONTACT ||
		                     row.opinion == Opinion::ALWAYS || row.opinion == Opinion::BY_DESIGN;
		if ( touched )
		{
			json["findings"].push_back( findingJson( table, row ) );
		}
		json["pairs"].push_back( rowJson( row ) );
	}
	json["budget"] = settings.reach.def.seconds;
	json["seconds_spent"] = reach.info.seconds;
	json["complete"] = reach.info.complete;
	json["samples"] = settings.samples.states;
	json["seed"] = settings.samples.seed;
	json["cached"] = reach.cached;
	json["seconds"] = reach.milliseconds / 1000;
	addUse( json, table, analysis.samples, model, analysis.newSrdf() );
	if ( analysis.srdf )
	{
		json["written"] = analysis.srdf->document.written.size();
		json["kept"] = analysis.srdf->document.kept.size();
	}
	return json;
}

} // namespace leeway::pairs
