// SPDX-License-Identifier: BSD-3-Clause
// leeway referee: rulings on results of other planners.
#include "leeway/motions/path_file.hpp"
#include "commands/page_file.hpp"
#include "commands/limits_file.hpp"
#include "referee/judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <list>

namespace leeway::cli
{
namespace
{

using namespace referee;

std::vector<Item> readAll( const RefereeOptions& options, Notices& notices )
{
	std::vector<Item> items;
	for ( const std::string& file : options.items )
	{
		readsFile( "--item", file );
		for ( Item& item : readItems( file ) )
		{
			notices.add( "fields of " + item.name, item.notices );
			items.push_back( std::move( item ) );
		}
	}
	return items;
}

/// The group that has just the joints of an item.
std::string groupOf( const Item& item, const std::string& chosen, const io::RobotModel& robot )
{
	TrajectoryFile file;
	file.file = item.file;
	file.element = item.element;
	file.joint_names = item.trajectory ? item.trajectory->joint_names
	                   : item.region   ? item.region->joint_names
	                                   : item.joint_names;
	return !chosen.empty() || file.joint_names.empty() ? chosen : motions::groupOf( file, "", robot );
}

Values startOf( const Item& item, const io::RobotModel& robot, Notices& notices )
{
	PathFile path;
	path.file = item.file;
	path.start_state = item.start_state;
	std::vector<io::Notice> unused;
	const Values values =
	    item.trajectory ? startValues( { *item.trajectory }, robot, unused ) : startValues( path, robot, unused );
	notices.add( "unused joints", unused );
	return values;
}

/// Checkers for the groups and starts of the items; each is kept, for the page.
class Benches
{
public:
	Benches( const RefereeOptions& options, const Input& input, Notices& notices )
	    : m_options( options ), m_input( input ), m_notices( notices )
	{
	}
	const Workbench& of( const Item& item )
	{
		const std::string group = groupOf( item, m_options.common.group, m_input.robot );
		const Values values = standing(
		    m_input.robot, m_input.request ? &*m_input.request : nullptr, startOf( item, m_input.robot, m_notices ) );
		for ( const Kept& kept : m_kept )
		{
			if ( kept.group == group && kept.values == values )
			{
				return kept.bench;
			}
		}
		m_kept.push_back( { group, values, Workbench( m_input, group, values, m_notices ) } );
		return m_kept.back().bench;
	}

private:
	struct Kept
	{
		std::string group;
		Values values;
		Workbench bench;
	};
	const RefereeOptions& m_options;
	const Input& m_input;
	Notices& m_notices;
	std::list<Kept> m_kept;
};

struct Judged
{
	const Workbench* bench;
	Ruling ruling;
};

/// The worst state of each item that fails, for each checker a chapter: collisions first, the deepest of all at its head.
std::vector<PageInput> pagesOf(
    const Input& input, const std::vector<Judged>& all, const JudgeSettings& settings, const RefereeOptions& options )
{
	std::vector<const Judged*> shown;
	for ( const Judged& judged : all )
	{
		if ( !judged.ruling.q.empty() )
		{
			shown.push_back( &judged );
		}
	}
	std::stable_sort( shown.begin(), shown.end(),
	    []( const Judged* a, const Judged* b )
	    {
		    const bool first = a->ruling.verdict == LW_VERDICT_BLOCKED, second = b->ruling.verdict == LW_VERDICT_BLOCKED;
		    return first != second ? first : b->ruling.depth < a->ruling.depth;
	    } );
	std::vector<const Workbench*> benches;
	for ( const Judged* judged : shown )
	{
		if ( std::find( benches.begin(), benches.end(), judged->bench ) == benches.end() )
		{
			benches.push_back( judged->bench );
		}
	}
	if ( benches.empty() )
	{
		benches.push_back( all.front().bench );
	}
	std::vector<PageInput> pages;
	for ( const Workbench* bench : benches )
	{
		std::vector<std::vector<double>> states;
		std::vector<std::string> labels, notes;
		for ( const Judged* judged : shown )
		{
			if ( judged->bench == bench )
			{
				const Ruling& ruling = judged->ruling;
				states.push_back( ruling.worst.empty() ? ruling.q : ruling.worst );
				labels.push_back( fmt::format( "{} {}", lw_verdict_name( ruling.verdict ), ruling.name ) );
			}
		}
		for ( const Judged& judged : all )
		{
			notes.push_back( describe( judged.ruling ) );
		}
		if ( states.empty() )
		{
			states.push_back( bench->groupState( bench->problem().reference ) );
			labels.emplace_back( "start: nothing failed" );
		}
		const lw_check_flags flags = settings.region.flags;
		PageInput page = pageOf( input, bench->problem(),
		    motionOfStates( bench->problem(), states, labels, flags, options.items.front() ), flags );
		page.min_d = settings.region.min_d;
		page.source = "leeway referee";
		page.notes = notes;
		page.chapter = bench->problem().group.empty() ? "all joints" : bench->problem().group;
		pages.push_back( std::move( page ) );
	}
	return pages;
}

} // namespace

int runReferee( const RefereeOptions& options )
{
	Notices notices( options.common.verbose );
	JudgeSettings settings;
	settings.interpolation = interpolationOf( options.interpolation );
	settings.tolerance = givenTolerances( options.tolerance );
	settings.region.min_d = options.common.min_d;
	settings.region.flags = options.common.checkFlags();
	settings.region.search_seconds = options.search;
	settings.region.proof_seconds = options.proof;
	settings.region.seed = options.seed;
	const Policy policy = options.policy == "collision" ? Policy::collision : Policy::proved;
	const std::vector<Item> items = readAll( options, notices );
	settings.limits = limitsOfFile( options.joint_limits );
	OutputFile json_file( "--json", options.json ), junit_file( "--junit", options.junit );
	ViewFile view( options.view );
	const Input input = loadInput( options.common, notices );
	note( settings.limits, options.joint_limits, input.robot, notices );
	settings.start = input.request ? input.request->start.values : Values();
	Benches benches( options, input, notices );
	std::vector<Judged> all;
	std::vector<Ruling> rulings;
	std::string text;
	std::size_t passed = 0;
	{
		Progress progress( "judging", items.size() );
		for ( const Item& item : items )
		{
			const Workbench& bench = benches.of( item );
			all.push_back( { &bench, judge( bench.problem(), input.robot, item, settings ) } );
			rulings.push_back( all.back().ruling );
			passed += rulings.back().passes( policy ) ? 1 : 0;
			text += describe( rulings.back() );
			progress.step( all.size() );
		}
	}
	std::vector<OutputFile*> out;
	if ( !options.json.empty() )
	{
		Json json;
		json["robot"] = input.robot.name;
		json["min_d"] = settings.region.min_d;
		json["policy"] = options.policy;
		json["passed"] = passed == rulings.size();
		json["items"] = Json::array();
		for ( const Ruling& ruling : rulings )
		{
			json["items"].push_back( toJson( ruling, policy ) );
		}
		json["notices"] = notices.all();
		json_file.text = jsonText( json );
		out.push_back( &json_file );
	}
	if ( !options.junit.empty() )
	{
		junit_file.text = junit( rulings, policy, input.robot.name );
		out.push_back( &junit_file );
	}
	if ( view.isWanted() )
	{
		view.write( pagesOf( input, all, settings, options ), out );
	}
	commitTogether( out );
	printOut( fmt::format( "{}{} of {} pass by --policy {}\n", text, passed, rulings.size(), options.policy ) );
	return passed == rulings.size() ? exit_yes : exit_no;
}

} // namespace leeway::cli
