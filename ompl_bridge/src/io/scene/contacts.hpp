// SPDX-License-Identifier: BSD-3-Clause
// A planning scene's allowed collision matrix, by names of links and objects that need not exist yet.
#pragma once

#include "leeway/io/world.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>

namespace leeway::io::detail
{

class AllowedNames
{
public:
	/// @param scene nullptr: nothing is allowed
	explicit AllowedNames( const SceneModel* scene )
	{
		if ( scene != nullptr )
		{
			setMatrix( { scene->allowed, scene->default_allowed, scene->matrix_names, "" } );
		}
	}

	bool empty() const { return m_pairs.empty() && m_defaults.empty() && m_set.empty(); }

	bool allows( const std::string& a, const std::string& b ) const
	{
		const std::pair<std::string, std::string> pair = std::minmax( a, b );
		const auto set = m_set.find( pair );
		if ( set != m_set.end() || m_pairs.count( pair ) != 0 )
		{
			return set == m_set.end() || set->second;
		}
		// an entry of the matrix is more specific than a default
		const bool decided = m_decided.count( a ) != 0 && m_decided.count( b ) != 0;
		return !decided && ( m_defaults.count( a ) != 0 || m_defaults.count( b ) != 0 );
	}

	/// Goes before the matrix.
	void set( const std::string& a, const std::string& b, bool allowed ) { m_set[std::minmax( a, b )] = allowed; }

	/// In place of the matrix so far.
	void setMatrix( const ContactMatrix& matrix )
	{
		m_pairs.clear();
		for ( const auto& [a, b] : matrix.allowed )
		{
			m_pairs.insert( std::minmax( a, b ) );
		}
		m_defaults = { matrix.default_allowed.begin(), matrix.default_allowed.end() };
		m_decided = { matrix.names.begin(), matrix.names.end() };
	}

private:
	std::set<std::pair<std::string, std::string>> m_pairs;
	std::set<std::string> m_defaults, m_decided;
	std::map<std::pair<std::string, std::string>, bool> m_set;
};

} // namespace leeway::io::detail
