// SPDX-License-Identifier: BSD-3-Clause
// Robot states from the columns of a table, and the columns of clearances that go out.
#include "program/states.hpp"

#include "motions/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace leeway::cli
{

StateColumns::StateColumns(
    const CsvTable& table, const std::string& prefix, const Workbench& bench, const io::RobotModel& robot, Notices& notices )
    : m_table( table )
{
	std::vector<std::string> unknown;
	for ( std::size_t column = 0; column < table.header.size(); ++column )
	{
		const std::string& title = table.header[column];
		if ( title.rfind( prefix, 0 ) != 0 )
		{
			continue;
		}
		const std::string name = title.substr( prefix.size() );
		const std::uint32_t variable = bench.variable( name );
		if ( variable != LW_INVALID_INDEX )
		{
			m_used.emplace_back( column, variable );
			continue;
		}
		const UnknownVariable why = explainUnknown( name, robot );
		if ( why.moving ) // meant, and wrongly named: its value must not be dropped
		{
			throw io::Error( table.file, fmt::format( "column '{}'", title ), why.problem, why.remedy );
		}
		if ( why.joint )
		{
			notices.add(
			    "unused columns", fmt::format( "{}: column {}: {}; it is ignored", table.file, title, why.problem ) );
			continue;
		}
		unknown.push_back( title );
	}
	if ( !unknown.empty() )
	{
		notices.add( "unused columns", fmt::format( "{}: columns that do not name a joint of the robot are ignored: {}",
		                                   table.file, listed( unknown, SIZE_MAX ) ) );
	}
	noteMissing( prefix, bench, notices );
}

// A joint that was forgotten and one that is left alone look the same: say where they stand.
void StateColumns::noteMissing( const std::string& prefix, const Workbench& bench, Notices& notices ) const
{
	std::vector<std::string> missing;
	if ( m_used.empty() || prefix == "to:" ) // nothing can be read; the same as "from:"
	{
		return;
	}
	for ( std::uint32_t i = 0; i < bench.variableNames().size(); ++i )
	{
		if ( std::none_of( m_used.begin(), m_used.end(), [i]( const auto& column ) { return column.second == i; } ) )
		{
			missing.push_back( fmt::format( "{} = {}", bench.variableNames()[i], bench.problem().reference[i] ) );
		}
	}
	if ( !missing.empty() )
	{
		notices.add( "joints without a column", fmt::format( "{}: joints without a column keep their start value: {}",
		                                            m_table.file, listed( missing, notices.verbose() ? SIZE_MAX : 12 ) ) );
	}
}

std::vector<double> StateColumns::full( std::size_t row, const std::vector<double>& base ) const
{
	std::vector<double> state = base;
	for ( const auto& [column, variable] : m_used )
	{
		state[variable] = m_table.value( row, column );
	}
	return state;
}

std::string clearanceHeader( bool margins )
{
	const std::string header = "env_lower,env_upper,env_link,env_object,self_lower,self_upper,self_link1,self_link2";
	return margins ? header + ",env_margin,self_margin" : header;
}

std::string clearanceCells( const Named& environment, const Named& self, bool margins )
{
	std::string cells;
	for ( const Named* clearance : { &environment, &self } )
	{
		cells += cells.empty() ? "" : ",";
		cells += !clearance->asked ? ",,,"
		                           : fmt::format( "{},{},{},{}", clearance->lower, clearance->upper,
		                                 csvCell( clearance->first ), csvCell( clearance->second ) );
	}
	for ( const Named* clearance : { &environment, &self } )
	{
		cells += !margins ? "" : clearance->first.empty() ? "," : "," + number( clearance->margin );
	}
	return cells;
}

void noteEmpty( Notices& notices, const CsvTable& table )
{
	if ( table.rows.empty() )
	{
		notices.add( "the table", fmt::format( "{}: has a header and no rows: nothing is checked", table.file ) );
	}
}

void noteLimits( Notices& notices, const std::string& file, std::size_t row, const std::vector<std::string>& violations )
{
	for ( const std::string& violation : violations )
	{
		notices.add( "joint limits", fmt::format( "{}: row {}: {}; it is used unchanged", file, row, violation ) );
	}
}

std::pair<double, double> medianAndMean( std::vector<double> values )
{
	if ( values.empty() )
	{
		return { 0, 0 };
	}
	const double mean = std::accumulate( values.begin(), values.end(), 0.0 ) / double( values.size() );
	std::sort( values.begin(), values.end() );
	const std::size_t middle = values.size() / 2;
	const double median = values.size() % 2 == 1 ? values[middle] : ( values[middle - 1] + values[middle] ) / 2;
	return { median, mean };
}

} // namespace leeway::cli
