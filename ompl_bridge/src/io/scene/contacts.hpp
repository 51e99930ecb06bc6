// SPDX-License-Identifier: BSD-3-Clause
// A planning scene's allowed collision matrix, by names of links and objects that need not exist yet.
#pragma once

#include "leeway/io/model.hpp"

#include <algorithm>
#include <set>

namespace leeway::io::detail
{

class AllowedNames
{
public:
	/// @param scene nullptr: nothing is allowed
	explicit AllowedNames( const SceneModel* scene )
	{
		for ( std::size_t i = 0; scene != nullptr && i < scene->allowed.size(); ++i )
		{
			m_pairs.insert( std::minmax( scene->allowed[i].first, scene->allowed[i].second ) );
		}
		if ( scene != nullptr )
		{
			m_defaults.insert( scene->default_allowed.begin(), scene->default_allowed.end() );
			m_decided.insert( scene->matrix_names.begin(), scene->matrix_names.end() );
		}
	}

	bool empty() const { return m_pairs.empty() && m_defaults.empty(); }

	bool allows( const std::string& a, const std::string& b ) const
	{
		const std::pair<std::string, std::string> pair = std::minmax( a, b );
		if ( m_pairs.count( pair ) != 0 )
		{
			return true;
		}
		// an entry of the matrix is more specific than a default
		const bool decided = m_forbidden.count( pair ) != 0 || ( m_decided.count( a ) != 0 && m_decided.count( b ) != 0 );
		return !decided && ( m_defaults.count( a ) != 0 || m_defaults.count( b ) != 0 );
	}

	void set( const std::string& a, const std::string& b, bool allowed )
	{
		const std::pair<std::string, std::string> pair = std::minmax( a, b );
		( allowed ? m_pairs : m_forbidden ).insert( pair );
		( allowed ? m_forbidden : m_pairs ).erase( pair );
	}

private:
	std::set<std::pair<std::string, std::string>> m_pairs, m_forbidden;
	std::set<std::string> m_defaults, m_decided;
};

} // namespace leeway::io::detail
