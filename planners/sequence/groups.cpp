// SPDX-License-Identifier: BSD-3-Clause
// Groups of legs: their variables among those of the plan, and states and motions of both.
#include "sequence/groups.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace leeway::sequence
{

std::string nameOf( const std::vector<Leg>& legs, std::size_t i )
{
	return legs[i].element.empty() ? fmt::format( "legs[{}]", i ) : legs[i].element;
}

[[noreturn]] void wrong( const std::string& element, const std::string& problem, const std::string& remedy )
{
	throw io::Error( "sequence", element, problem, remedy );
}

State Scene::narrow( const State& state ) const
{
	State own;
	for ( const std::size_t entry : entries )
	{
		own.push_back( state[entry] );
	}
	return entries.empty() ? state : own;
}

motions::MotionLimits Scene::narrow( motions::MotionLimits limits ) const
{
	for ( std::vector<double>* values : { &limits.velocity, &limits.acceleration, &limits.jerk } )
	{
		*values = values->empty() ? *values : narrow( *values );
	}
	return limits;
}

State Scene::widen( const State& own ) const
{
	State state = entries.empty() ? own : stands;
	for ( std::size_t i = 0; i < entries.size(); ++i )
	{
		state[entries[i]] = own[i];
	}
	return state;
}

std::vector<motions::Segment> Scene::widen( std::vector<motions::Segment> segments ) const
{
	for ( motions::Segment& segment : segments )
	{
		const auto count = static_cast<std::ptrdiff_t>( segment.points.size() / ( segment.degree + 1 ) );
		std::vector<double> points;
		for ( auto at = segment.points.begin(); at != segment.points.end(); at += count )
		{
			const State point = widen( State( at, at + count ) );
			points.insert( points.end(), point.begin(), point.end() );
		}
		segment.points = std::move( points );
	}
	return segments;
}

namespace
{

/// The file of a leg's request, for errors.
std::string fileOf( const Leg& leg )
{
	return leg.request ? leg.request->file : leg.way ? leg.way->file : "sequence";
}

/// Variables of a group. @throws io::Error that names file and element if there is none
std::vector<std::string> variablesOf(
    const io::RobotModel& robot, const std::string& group, const std::string& file, const std::string& element )
{
	try
	{
		return io::groupVariables( robot, group );
	}
	catch ( const io::Error& error )
	{
		throw io::Error( file, element, error.element() + ": " + error.problem(), error.remedy() );
	}
}

/// @throws io::Error for a group that is not there, or has joints that the plan has not
Entries entriesOf( const io::RobotModel& robot, const io::Problem& problem, const Leg& leg, const std::string& name )
{
	if ( leg.group.empty() || leg.group == problem.group )
	{
		return {};
	}
	const std::string file = fileOf( leg ), element = name + ( leg.request || leg.way ? ".req.group_name" : "" );
	Entries entries;
	for ( const std::string& variable : variablesOf( robot, leg.group, file, element ) )
	{
		const auto at = std::find( problem.variable_names.begin(), problem.variable_names.end(), variable );
		if ( at == problem.variable_names.end() )
		{
			throw io::Error( file, element,
			    fmt::format(
			        "is {}, which moves {}, and the plan is of group '{}' without it", leg.group, variable, problem.group ),
			    "plan for a group that has the joints of all legs, such as left+right" );
		}
		entries.push_back( static_cast<std::size_t>( at - problem.variable_names.begin() ) );
	}
	for ( const State& goal : leg.goals )
	{
		if ( goal.size() != entries.size() )
		{
			wrong( name,
			    fmt::format(
			        "has a goal of {} values, and group {} has {} variables", goal.size(), leg.group, entries.size() ),
			    "give a value for each variable of the leg's group" );
		}
	}
	return entries.size() == problem.variables.size() && std::is_sorted( entries.begin(), entries.end() ) ? Entries()
	                                                                                                      : entries;
}

} // namespace

std::vector<Entries> groupsOf( const io::RobotModel& robot, const io::Problem& problem, const std::vector<Leg>& legs )
{
	std::vector<Entries> groups;
	for ( std::size_t i = 0; i < legs.size(); ++i )
	{
		groups.push_back( entriesOf( robot, problem, legs[i], nameOf( legs, i ) ) );
		if ( i > 0 && legs[i - 1].blend > 0 && groups[i] != groups[i - 1] )
		{
			throw io::Error( fileOf( legs[i - 1] ), nameOf( legs, i - 1 ),
			    fmt::format( "has a blend, and the next line is of another group, '{}'", legs[i].group ),
			    "give 0: the robot rests where another group begins to move" );
		}
	}
	return groups;
}

bool hasGroups( const io::PathConstraints& sequence )
{
	return std::any_of( sequence.items.begin(), sequence.items.end(),
	    [&]( const io::SequenceItem& item ) { return item.request.group != sequence.items.front().request.group; } );
}

void requireGroups( const io::RobotModel& robot, const io::PathConstraints& sequence )
{
	for ( const io::SequenceItem& item : sequence.items )
	{
		item.request.group.empty()
		    ? void()
		    : void( variablesOf( robot, item.request.group, sequence.file, item.element + ".req.group_name" ) );
	}
}

} // namespace leeway::sequence
