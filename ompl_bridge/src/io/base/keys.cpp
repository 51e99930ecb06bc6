// SPDX-License-Identifier: BSD-3-Clause
// Misspelt names: edit distance with swaps of neighbours (optimal string alignment).
#include "leeway/io/keys.hpp"

#include <algorithm>
#include <cctype>

namespace leeway::io
{

namespace
{

/// The key in lower case, without '_', '-' and blanks: "collisionobjects" for collisionObjects and collision-objects.
std::string bareKey( const std::string& key )
{
	std::string bare;
	for ( const char c : key )
	{
		if ( c != '_' && c != '-' && c != ' ' )
		{
			bare += static_cast<char>( std::tolower( static_cast<unsigned char>( c ) ) );
		}
	}
	return bare;
}

} // namespace

std::size_t editDistance( const std::string& a, const std::string& b )
{
	std::vector<std::size_t> before( b.size() + 1 ), last( b.size() + 1 ), row( b.size() + 1 );
	for ( std::size_t k = 0; k <= b.size(); ++k )
	{
		last[k] = k;
	}
	for ( std::size_t i = 1; i <= a.size(); ++i )
	{
		row[0] = i;
		for ( std::size_t k = 1; k <= b.size(); ++k )
		{
			row[k] = std::min( { last[k] + 1, row[k - 1] + 1, last[k - 1] + ( a[i - 1] == b[k - 1] ? 0u : 1u ) } );
			if ( i > 1 && k > 1 && a[i - 1] == b[k - 2] && a[i - 2] == b[k - 1] )
			{
				row[k] = std::min( row[k], before[k - 2] + 1 );
			}
		}
		before = last;
		last = row;
	}
	return last[b.size()];
}

std::string meantKey( const std::string& key, const std::vector<std::string>& known )
{
	if ( std::find( known.begin(), known.end(), key ) != known.end() )
	{
		return "";
	}
	const std::string bare = bareKey( key );
	for ( const std::string& candidate : known )
	{
		const std::string other = bareKey( candidate );
		// A long key is no slip of a short one; in words of two letters one of them is half of the word
		const bool near = other.size() > 2 && bare.size() > 1 && bare.size() <= other.size() + 1;
		if ( other == bare || ( near && editDistance( bare, other ) == 1 ) )
		{
			return candidate;
		}
	}
	return "";
}

} // namespace leeway::io
