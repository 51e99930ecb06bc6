// SPDX-License-Identifier: BSD-3-Clause
// leeway pairs: the links that can ever meet, findings about an SRDF, and a new SRDF with proofs as reasons.
#include "leeway/pairs/new_srdf.hpp"
#include "view/page.hpp"

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
		return "in contact in every measured state (no proof)";
	case LW_PAIR_CHECK:
		return "to be checked";
	default:
		return "";
	}
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

// ---- printed text

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
	for ( const Opinion opinion : { Opinion::FINDING, Opinion::ADJACENT_CONTACT, Opinion::ALWAYS, Opinion::BY_DESIGN,
	          Opinion::CONFIRMED, Opinion::NEVER_SEEN, Opinion::NOT_PROVED, Opinion::COULD_BE_DISABLED } )
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

// ---- JSON

Json rowJson( const PairRow& row )
{
	Json json = { { "link1", row.first }, { "link2", row.second }, { "class", lw_pair_class_name( row.pair.kind ) },
	    { "proof", row.pair.separation > 0 ? Json( lw_pair_proof_name( row.pair.proof ) ) : Json( nullptr ) },
	    { "separation", row.pair.separation }, { "closest", jsonNumber( row.pair.closest ) },
	    { "contact_share", row.contactShare() }, { "contact_states", row.states },
	    { "never_seen_states", row.never_seen > 0 ? Json( row.never_seen ) : Json( nullptr ) }, { "adjacent", row.pair.adjacent },
	    { "reason", row.disabled ? Json( row.reason ) : Json( nullptr ) } };
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
		const bool touched = row.opinion == Opinion::FINDING || row.opinion == Opinion::ADJACENT_CONTACT ||
		                     row.opinion == Opinion::ALWAYS || row.opinion == Opinion::BY_DESIGN;
		if ( touched )
		{
			json["findings"].push_back( findingJson( table, row ) );
		}
		json["pairs"].push_back( rowJson( row ) );
	}
	return json;
}

/// States in contact, findings first, with their pairs marked: the SRDF allows some of them.
PageInput contactPage( const Input& input, const Workbench& bench, const PairTable& table )
{
	constexpr std::size_t most_states = 100;
	std::vector<std::vector<double>> states;
	std::vector<std::string> labels;
	std::vector<lwv_pair> marked;
	std::size_t contacts = 0;
	for ( const bool findings : { true, false } )
	{
		for ( const PairRow& row : table.rows() )
		{
			const bool touches =
			    !table.evidenceState( row ).empty() && ( row.pair.closest <= 0 || !row.contact_state.empty() );
			if ( !touches || ( row.opinion == Opinion::FINDING ) != findings || ++contacts > most_states )
			{
				continue;
			}
			states.push_back( bench.groupState( table.evidenceState( row ) ) );
			labels.push_back(
			    fmt::format( "{} in contact{}", pairText( row ), findings ? ": the SRDF disables this pair" : "" ) );
			marked.push_back( { true, row.link_a, row.link_b } );
		}
	}
	if ( states.empty() )
	{
		states.push_back( io::startState( bench.problem() ) );
	}
	PageInput page = {
	    input, bench, motionOfStates( bench, states, labels, LW_CHECK_SELF, input.robot_file ), LW_CHECK_SELF };
	for ( std::size_t i = 0; i < marked.size(); ++i )
	{
		page.motion.steps[i].marked = { marked[i] };
	}
	page.notes = {
	    fmt::format( "pairs of links with a state in contact: {}; {} are on this page", contacts, marked.size() ) };
	return page;
}

io::LoadedReach findReach( const PairsOptions& options, const Robot& robot, Notices& notices )
{
	io::ReachOptions reach;
	reach.cache = options.common.cache;
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
	ViewFile view( options.view );
	const Input input = loadInput( options.common, notices );
	const Robot robot = io::buildRobot( input.robot );
	const io::LoadedReach reach = findReach( options, robot, notices );
	requireReach( reach, options.common.robot );
	PairTable table( input.robot, robot, reach.reach );
	const ContactSamples samples( robot, table, { options.samples, options.seed, options.never_after } );
	const bool writes = !options.out.empty();
	const NewSrdf srdf = writes ? newSrdf( table, input.robot ) : NewSrdf();

	std::string text = fmt::format( "robot {} ({}): {} links with geometry, {} pairs; tables {} in {:.2f} s\n",
	    input.robot.name, input.robot.urdf_file, table.linksWithGeometry(), table.rows().size(),
	    !reach.cached    ? "built"
	    : reach.advanced ? "of earlier runs continued"
	                     : "of earlier runs read",
	    reach.milliseconds / 1000 );
	text += fmt::format( "  proofs {} after {:.1f} s: {} of {} pairs that may not touch are proved to stay apart, {} can touch, {} cannot be proved, "
	                     "{} are open\n",
	    reach.info.complete ? "complete" : "not complete", reach.info.seconds, reach.info.proved, reach.info.pairs, reach.info.contact,
	    reach.info.unprovable, reach.info.open );
	text += classTable( table );
	if ( !input.robot.srdf_file.empty() )
	{
		text += comparison( table, input.robot );
		text += findings( table, Opinion::FINDING, "findings: the SRDF disables these, but a state in contact was found" );
		text += findings( table, Opinion::ALWAYS, "disabled, and in contact in every measured state" );
		text += findings( table, Opinion::BY_DESIGN,
		    "disabled, and in contact in most states: taken for design, which is evidence and no proof" );
		text += findings(
		    table, Opinion::ADJACENT_CONTACT, "disabled neighbours for which a state in contact was found (usually meant)" );
	}
	text += classLists( table, options.common.verbose );
	text += describeNear( table, samples, writes ? &srdf : nullptr );
	Json json;
	std::vector<OutputFile*> files;
	if ( !options.json.empty() )
	{
		json = toJson( table, input.robot, robot.get() );
		json["budget"] = options.budget;
		json["seconds_spent"] = reach.info.seconds;
		json["complete"] = reach.info.complete;
		json["samples"] = options.samples;
		json["seed"] = options.seed;
		json["cached"] = reach.cached;
		json["seconds"] = reach.milliseconds / 1000;
		addUse( json, table, samples, input.robot, writes ? &srdf : nullptr );
	}
	if ( writes )
	{
		text += describe( srdf, options.out, options.common.verbose );
		out.text = srdf.document.text;
		files.push_back( &out );
		json["written"] = srdf.document.written.size();
		json["kept"] = srdf.document.kept.size();
	}
	text += describeUse( table, samples, input.robot, writes ? &srdf : nullptr );
	if ( !options.json.empty() )
	{
		json_file.text = jsonText( json );
		files.push_back( &json_file );
	}
	if ( view.isWanted() )
	{
		const Workbench bench( input, "", {}, notices );
		view.write( contactPage( input, bench, table ), files );
	}
	commitTogether( files );
	printOut( text );
	return table.count( Opinion::FINDING ) > 0 ? exit_no : exit_yes;
}

} // namespace leeway::cli
