// SPDX-License-Identifier: BSD-3-Clause
// Results of other planners, as the referee reads them.
#include "fuzz.hpp"

#include "referee/items.hpp"
#include "referee/judge.hpp"

namespace fuzz
{

namespace
{

namespace io = leeway::io;
namespace referee = leeway::referee;

const io::Problem& fixedProblem()
{
	static const io::Problem problem = io::buildProblem( fixedRobot(), {} );
	return problem;
}

/// Reads a file, and judges its items, which takes a millisecond or some motions.
void judgeFile( const std::string& file )
{
	constexpr std::size_t most_items = 4, most_segments = 16;
	std::vector<referee::Item> items;
	reads( [&] { items = referee::readItems( file ); } );
	referee::JudgeSettings settings;
	settings.region.search_seconds = settings.region.proof_seconds = 0.001;
	for ( std::size_t i = 0; i < items.size() && i < most_items; ++i )
	{
		const referee::Item& item = items[i];
		const int kinds = ( item.points.empty() ? 0 : 1 ) + ( item.trajectory ? 1 : 0 ) + ( item.segments.empty() ? 0 : 1 ) +
		                  ( item.region ? 1 : 0 );
		expect( kinds == 1, "an item is of one kind" );
		expect( !item.name.empty() && !item.file.empty(), "an item has a name" );
		if ( item.points.size() > most_segments || item.segments.size() > most_segments ||
		     ( item.trajectory && item.trajectory->points.size() > most_segments ) )
		{
			continue;
		}
		reads(
		    [&]
		    {
			    const referee::Ruling ruling = referee::judge( fixedProblem(), fixedRobot(), item, settings );
			    expect( ruling.verdict != LW_VERDICT_UNKNOWN, "what can be judged has a verdict" );
			    expect( ruling.verdict != LW_VERDICT_BLOCKED || ruling.worst.size() == ruling.names.size(),
			        "a contact has its state" );
			    expect( !referee::junit( { ruling }, referee::Policy::proved, "robot" ).empty(), "a ruling is written" );
			    (void)leeway::motions::jsonText( toJson( ruling, referee::Policy::proved ) );
		    } );
	}
}

} // namespace

void refereeText( Input input )
{
	for ( const char* name : { "input.yaml", "input.txt", "input.csv" } )
	{
		judgeFile( put( name, input ) );
	}
}

void refereeArray( Input input )
{
	judgeFile( put( "input.npy", input ) );
}

} // namespace fuzz
