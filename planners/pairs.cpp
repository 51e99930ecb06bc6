// SPDX-License-Identifier: BSD-3-Clause
// leeway pairs: which links can ever meet, what an SRDF says about them, and a new SRDF with proofs as reasons.
#include "json.hpp"
#include "pair_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

namespace leeway::cli
{
namespace
{

const std::vector<lw_pair_class> classes = {
    LW_PAIR_RIGID, LW_PAIR_ADJACENT, LW_PAIR_ALLOWED, LW_PAIR_NEVER, LW_PAIR_ALWAYS, LW_PAIR_CHECK };
constexpr std::size_t shown_pairs = 20; // of a class without --verbose

const char* classMeaning( lw_pair_class kind )
{
	switch ( kind )
	{
	case LW_PAIR_RIGID:
		return "no joint between the two moves";
	case LW_PAIR_ADJACENT:
		return "one hangs on the other, no geometry in between";
	case LW_PAIR_ALLOWED:
		return "disabled by the SRDF";
	case LW_PAIR_NEVER:
		return "proved to stay apart";
	case LW_PAIR_ALWAYS:
		return "in contact in every state looked at (no proof)";
	case LW_PAIR_CHECK:
		return "to be checked";
	default:
		return "";
	}
}

// What a proof is called in a reason of an SRDF.
const char* neverReason( lw_pair_proof proof )
{
	return proof == LW_PROOF_HULL ? "Never (hulls apart)" : "Never (joint box certified)";
}

std::string pairText( const PairRow& row )
{
	return row.first + " - " + row.second;
}

std::string reasonText( const PairRow& row )
{
	return row.reason.empty() ? "no reason given" : row.reason;
}

// Millimetres, rounded down: a bound must not grow by printing it.
std::string millimetresBelow( double metres )
{
	return fmt::format( "{:.2f} mm", std::floor( 1e5 * metres ) / 100 );
}

std::string contactText( const PairRow& row )
{
	return row.always ? "in contact in every state looked at"
	       : row.pair.contact_share > 0
	           ? fmt::format( "in contact in {:.3g} % of the random states", 100 * row.pair.contact_share )
	           : "in contact where the search led";
}

std::string factsText( const PairRow& row )
{
	std::vector<std::string> facts;
	if ( row.disabled )
	{
		facts.push_back( "disabled: " + reasonText( row ) );
	}
	if ( row.pair.separation > 0 )
	{
		facts.push_back( fmt::format(
		    "proved ({}) to keep {}", lw_pair_proof_name( row.pair.proof ), millimetresBelow( row.pair.separation ) ) );
	}
	else if ( !( row.pair.closest > 0 ) )
	{
		facts.push_back( contactText( row ) );
	}
	else if ( std::isfinite( row.pair.closest ) )
	{
		facts.push_back( fmt::format( "closest seen {:.2f} mm", 1000 * row.pair.closest ) );
	}
	if ( row.opinion != Opinion::NOTHING && row.opinion != Opinion::ALWAYS )
	{
		facts.push_back( opinionName( row.opinion ) );
	}
	std::string text;
	for ( const std::string& fact : facts )
	{
		text += ( text.empty() ? "" : "; " ) + fact;
	}
	return text;
}

// Short enough to read; the JSON file has all digits.
std::string evidenceText( const PairTable& table, const PairRow& row )
{
	std::string text;
	for ( const auto& [name, value] : table.evidence( row ) )
	{
		text += fmt::format( "{}{}={:.6g}", text.empty() ? "" : " ", name, value );
	}
	return text.empty() ? "" : ", at " + text;
}

// ---- what is printed

std::string classTable( const PairTable& table )
{
	std::size_t hulls = 0, boxes = 0;
	for ( const PairRow& row : table.rows() )
	{
		hulls += row.pair.kind == LW_PAIR_NEVER && row.pair.proof == LW_PROOF_HULL ? 1 : 0;
		boxes += row.pair.kind == LW_PAIR_NEVER && row.pair.proof == LW_PROOF_SUBDIVISION ? 1 : 0;
	}
	std::string text = fmt::format( "  {:<9} {:>6}\n", "class", "pairs" );
	for ( const lw_pair_class kind : classes )
	{
		text += fmt::format( "  {:<9} {:>6}  {}", lw_pair_class_name( kind ), table.count( kind ), classMeaning( kind ) );
		text += kind == LW_PAIR_NEVER ? fmt::format( ": {} by hulls, {} by subdivision\n", hulls, boxes ) : "\n";
	}
	return text;
}

std::string comparison( const PairTable& table, const io::RobotModel& model )
{
	std::string text = fmt::format( "SRDF {}: {} pairs disabled\n", model.srdf_file, model.disabled.size() );
	for ( const Opinion opinion : { Opinion::FINDING, Opinion::ADJACENT_CONTACT, Opinion::ALWAYS, Opinion::CONFIRMED,
	          Opinion::NOT_PROVED, Opinion::COULD_BE_DISABLED } )
	{
		text += fmt::format( "  {:>6} {}\n", table.count( opinion ), opinionName( opinion ) );
	}
	return text;
}

// Pairs with one opinion. Claims that are wrong come before somebody's decisions.
std::string findings( const PairTable& table, Opinion opinion, const char* heading )
{
	std::vector<const PairRow*> rows;
	for ( const PairRow& row : table.rows() )
	{
		if ( row.opinion == opinion )
		{
			rows.push_back( &row );
		}
	}
	std::stable_partition(
	    rows.begin(), rows.end(), []( const PairRow* row ) { return row->reason.rfind( "Never", 0 ) == 0; } );
	std::string text = rows.empty() ? "" : fmt::format( "{}\n", heading );
	for ( const PairRow* row : rows )
	{
		text += fmt::format( "  {} ({}): {}{}\n", pairText( *row ), reasonText( *row ), contactText( *row ),
		    row->always ? "" : evidenceText( table, *row ) );
	}
	return text;
}

std::string classLists( const PairTable& table, bool all )
{
	std::string text;
	for ( const lw_pair_class kind : classes )
	{
		std::size_t index = 0;
		for ( const PairRow& row : table.rows() )
		{
			if ( row.pair.kind != kind || ( index++ >= shown_pairs && !all ) )
			{
				continue;
			}
			const std::string facts = factsText( row );
			text += index == 1 ? fmt::format( "{} pairs: {}\n", lw_pair_class_name( kind ), classMeaning( kind ) ) : "";
			text += "  " + pairText( row ) + ( facts.empty() ? "\n" : ": " + facts + "\n" );
		}
		if ( index > shown_pairs && !all )
		{
			text += fmt::format( "  ... and {} more (--verbose shows all)\n", index - shown_pairs );
		}
	}
	return text;
}

// ---- the new SRDF

struct NewSrdf
{
	io::WrittenSrdf document;
	std::vector<const PairRow*> enabled_again, free_elsewhere;
};

// Empty: the pair is to be checked.
std::string newReason( const PairTable& table, const PairRow& row )
{
	if ( row.pair.adjacent )
	{
		return "Adjacent";
	}
	if ( row.pair.kind == LW_PAIR_RIGID )
	{
		return "Never (rigidly attached)";
	}
	if ( row.pair.separation > 0 )
	{
		return neverReason( row.pair.proof );
	}
	return row.always || table.touchAtDefault( row ) ? "Default" : "";
}

NewSrdf newSrdf( const PairTable& table, const io::RobotModel& model )
{
	std::vector<io::DisabledPair> pairs;
	for ( const PairRow& row : table.rows() )
	{
		const std::string reason = newReason( table, row );
		if ( !reason.empty() )
		{
			pairs.push_back( { row.first, row.second, reason } );
		}
	}
	NewSrdf result;
	result.document = io::writeSrdf( model, pairs );
	std::map<std::pair<std::string, std::string>, std::string> now_disabled;
	for ( const std::vector<io::DisabledPair>* list : { &result.document.written, &result.document.kept } )
	{
		for ( const io::DisabledPair& pair : *list )
		{
			now_disabled.emplace( std::minmax( pair.link1, pair.link2 ), pair.reason );
		}
	}
	for ( const PairRow& row : table.rows() )
	{
		const auto found = now_disabled.find( { row.first, row.second } );
		if ( found == now_disabled.end() && row.disabled && io::isComputedReason( row.reason ) )
		{
			result.enabled_again.push_back( &row );
		}
		if ( found != now_disabled.end() && found->second == "Default" && !row.always )
		{
			result.free_elsewhere.push_back( &row );
		}
	}
	return result;
}

std::string describe( const NewSrdf& srdf, const std::string& file )
{
	std::map<std::string, std::size_t> reasons;
	for ( const io::DisabledPair& pair : srdf.document.written )
	{
		++reasons[pair.reason];
	}
	std::string text = fmt::format( "new SRDF {}: {} pairs disabled, {} of them kept as they were\n", file,
	    srdf.document.written.size() + srdf.document.kept.size(), srdf.document.kept.size() );
	for ( const auto& [reason, count] : reasons )
	{
		text += fmt::format( "  {:>6} {}\n", count, reason );
	}
	for ( const PairRow* row : srdf.enabled_again )
	{
		text += fmt::format( "  enabled again: {} was disabled as {}, {}\n", pairText( *row ), row->reason,
		    row->pair.closest > 0 ? "which is not proved" : "but " + contactText( *row ) );
	}
	for ( const PairRow* row : srdf.free_elsewhere )
	{
		text += fmt::format( "  disabled as Default, in contact at the default state, but free in others: {}, {}\n",
		    pairText( *row ), contactText( *row ) );
	}
	return text;
}

// ---- JSON

Json rowJson( const PairRow& row )
{
	Json json = { { "link1", row.first }, { "link2", row.second }, { "class", lw_pair_class_name( row.pair.kind ) },
	    { "proof", row.pair.separation > 0 ? Json( lw_pair_proof_name( row.pair.proof ) ) : Json( nullptr ) },
	    { "separation", row.pair.separation }, { "closest", jsonNumber( row.pair.closest ) },
	    { "contact_share", row.pair.contact_share }, { "adjacent", row.pair.adjacent },
	    { "reason", row.disabled ? Json( row.reason ) : Json( nullptr ) } };
	json["opinion"] = row.opinion == Opinion::NOTHING ? Json( nullptr ) : Json( opinionName( row.opinion ) );
	return json;
}

Json findingJson( const PairTable& table, const PairRow& row )
{
	Json json = { { "link1", row.first }, { "link2", row.second }, { "reason", row.reason },
	    { "adjacent", row.pair.adjacent }, { "always", row.always }, { "contact_share", row.pair.contact_share } };
	json["joints"] = Json::object();
	for ( const auto& [name, value] : table.evidence( row ) )
	{
		json["joints"][name] = value;
	}
	json["state"] = table.evidenceState( row );
	return json;
}

Json toJson( const PairTable& table, const io::RobotModel& model, const lw_robot* robot )
{
	Json json;
	json["robot"] = model.name;
	json["urdf"] = model.urdf_file;
	json["srdf"] = model.srdf_file.empty() ? Json( nullptr ) : Json( model.srdf_file );
	for ( const lw_pair_class kind : classes )
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
		const bool touched =
		    row.opinion == Opinion::FINDING || row.opinion == Opinion::ADJACENT_CONTACT || row.opinion == Opinion::ALWAYS;
		if ( touched )
		{
			json["findings"].push_back( findingJson( table, row ) );
		}
		json["pairs"].push_back( rowJson( row ) );
	}
	return json;
}

io::LoadedReach findReach( const PairsOptions& options, const Robot& robot, Notices& notices )
{
	io::ReachOptions reach;
	reach.cache = options.common.cache;
	reach.accept_less = false;
	reach.def.seconds = options.budget;
	reach.def.samples = options.samples;
	reach.def.seed = options.seed;
	Progress progress( "motion hulls and pair tables" );
	ReachProgress report( progress );
	report.attach( reach.def );
	io::LoadedReach loaded = io::loadReach( robot, reach );
	notices.add( "the cache", loaded.notices );
	return loaded;
}

} // namespace

int runPairs( const PairsOptions& options )
{
	Notices notices( options.common.verbose );
	OutputFile out( "--out", options.out ), json_file( "--json", options.json );
	const Input input = loadInput( options.common, notices );
	const Robot robot = io::buildRobot( input.robot );
	const io::LoadedReach reach = findReach( options, robot, notices );
	requireReach( reach, options.common.robot );
	const PairTable table( input.robot, robot, reach.reach );

	std::string text = fmt::format( "robot {} ({}): {} links with geometry, {} pairs; tables {} in {:.2f} s\n",
	    input.robot.name, input.robot.urdf_file, table.linksWithGeometry(), table.rows().size(),
	    reach.cached ? fmt::format( "of an earlier run ({} s for proofs) read", reach.seconds_spent ) : "built",
	    reach.milliseconds / 1000 );
	text += classTable( table );
	if ( !input.robot.srdf_file.empty() )
	{
		text += comparison( table, input.robot );
		text += findings( table, Opinion::FINDING, "findings: the SRDF disables these, but a state in contact was found" );
		text += findings( table, Opinion::ALWAYS, "disabled, and in contact in every state looked at" );
		text += findings(
		    table, Opinion::ADJACENT_CONTACT, "disabled neighbours for which a state in contact was found (usually meant)" );
	}
	text += classLists( table, options.common.verbose );
	Json json;
	std::vector<OutputFile*> files;
	if ( !options.json.empty() )
	{
		json = toJson( table, input.robot, robot.get() );
		json["budget"] = reach.seconds_spent;
		json["samples"] = options.samples;
		json["seed"] = options.seed;
		json["cached"] = reach.cached;
		json["seconds"] = reach.milliseconds / 1000;
	}
	if ( !options.out.empty() )
	{
		const NewSrdf srdf = newSrdf( table, input.robot );
		text += describe( srdf, options.out );
		out.text = srdf.document.text;
		files.push_back( &out );
		json["written"] = srdf.document.written.size();
		json["kept"] = srdf.document.kept.size();
	}
	if ( !options.json.empty() )
	{
		json_file.text = jsonText( json );
		files.push_back( &json_file );
	}
	commitTogether( files );
	printOut( text );
	return table.count( Opinion::FINDING ) > 0 ? exit_no : exit_yes;
}

} // namespace leeway::cli
