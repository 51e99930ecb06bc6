// SPDX-License-Identifier: BSD-3-Clause
// leeway pairs: the links that can ever meet, findings about an SRDF, and a new SRDF with proofs as reasons.
#include "pairs/report.hpp"
#include "commands/page_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

namespace leeway::cli
{

using namespace pairs;

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

/// States in contact, findings first, with their pairs marked: the SRDF allows some of them.
PageInput contactPage( const Input& input, const io::Problem& problem, const PairTable& table )
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
			states.push_back( groupState( problem, table.evidenceState( row ) ) );
			labels.push_back(
			    fmt::format( "{} in contact{}", pairText( row ), findings ? ": the SRDF disables this pair" : "" ) );
			marked.push_back( { true, row.link_a, row.link_b } );
		}
	}
	if ( states.empty() )
	{
		states.push_back( io::startState( problem ) );
	}
	PageInput page =
	    pageOf( input, problem, motionOfStates( problem, states, labels, LW_CHECK_SELF, input.robot_file ), LW_CHECK_SELF );
	for ( std::size_t i = 0; i < marked.size(); ++i )
	{
		page.motion.steps[i].marked = { marked[i] };
	}
	page.notes = {
	    fmt::format( "pairs of links with a state in contact: {}; {} are on this page", contacts, marked.size() ) };
	return page;
}

Settings settingsOf( const PairsOptions& options )
{
	Settings settings;
	settings.reach.cache = options.common.cache;
	settings.reach.def.seconds = options.budget;
	settings.samples = { options.samples, options.seed, options.never_after, {} };
	settings.new_srdf = !options.out.empty();
	return settings;
}

Analysis analysed( const PairsOptions& options, const io::RobotModel& robot, Notices& notices )
{
	Settings settings = settingsOf( options );
	Progress progress( "motion hulls and pair tables" );
	ReachProgress report( progress );
	report.attach( settings.reach.def );
	settings.samples.progress = shownBy( progress );
	Analysis analysis( robot, settings );
	notices.add( "the cache", analysis.reach.notices );
	return analysis;
}

} // namespace

int runPairs( const PairsOptions& options )
{
	Notices notices( options.common.verbose );
	OutputFile out( "--out", options.out ), json_file( "--json", options.json );
	ViewFile view( options.view );
	CommonOptions common = options.common;
	common.all_pairs = common.srdf.empty();
	const Input input = loadInput( common, notices );
	Analysis analysis = analysed( options, input.robot, notices );
	PairTable& table = analysis.table;
	const io::LoadedReach& reach = analysis.reach;
	const NewSrdf* srdf = analysis.newSrdf();

	std::string text = fmt::format( "robot {} ({}): {} links with geometry, {} pairs; tables {} in {:.2f} s\n",
	    input.robot.name, input.robot.urdf_file, table.linksWithGeometry(), table.rows().size(),
	    !reach.cached    ? "built"
	    : reach.advanced ? "of earlier runs continued"
	                     : "of earlier runs read",
	    reach.milliseconds / 1000 );
	text += fmt::format(
	    "  proofs {} after {:.1f} s: {} of {} pairs that may not touch are proved to stay apart, {} can touch, {} cannot be proved, "
	    "{} are open\n",
	    reach.info.complete ? "complete" : "not complete", reach.info.seconds, reach.info.proved, reach.info.pairs,
	    reach.info.contact, reach.info.unprovable, reach.info.open );
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
	text += describeNear( table, analysis.samples, srdf );
	std::vector<OutputFile*> files;
	if ( srdf != nullptr )
	{
		text += describe( *srdf, options.out, options.common.verbose );
		out.text = srdf->document.text;
		files.push_back( &out );
	}
	text += describeUse( table, analysis.samples, input.robot, srdf );
	if ( !options.json.empty() )
	{
		json_file.text = jsonText( toJson( analysis, input.robot, settingsOf( options ) ) );
		files.push_back( &json_file );
	}
	if ( view.isWanted() )
	{
		const Workbench bench( input, "", {}, notices );
		view.write( contactPage( input, bench.problem(), table ), files );
	}
	commitTogether( files );
	printOut( text );
	return table.count( Opinion::FINDING ) > 0 ? exit_no : exit_yes;
}

} // namespace leeway::cli
