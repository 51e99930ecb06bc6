// SPDX-License-Identifier: BSD-3-Clause
#include "referee/columns.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace leeway::referee
{

std::vector<std::size_t> groupColumns( const io::Problem& problem, const std::vector<std::string>& names, std::size_t count,
    const std::string& file, const std::string& element )
{
	const std::vector<std::string>& wanted = problem.variable_names;
	const std::vector<std::string>& given = names.empty() ? wanted : names;
	if ( given.size() != count || count != wanted.size() )
	{
		throw io::Error( file, element,
		    fmt::format( "has {} columns{}, and the group has the {} variables {}", count,
		        given.size() == count ? "" : fmt::format( " for {} joint_names", names.size() ), wanted.size(),
		        fmt::join( wanted, ", " ) ),
		    "choose --group, or name the columns by joint_names" );
	}
	std::vector<std::size_t> columns;
	for ( const std::string& name : wanted )
	{
		const auto found = std::find( given.begin(), given.end(), name );
		if ( found == given.end() )
		{
			throw io::Error( file, element, fmt::format( "lacks joint '{}' of the group", name ), "choose --group" );
		}
		columns.push_back( static_cast<std::size_t>( found - given.begin() ) );
	}
	return columns;
}

} // namespace leeway::referee
