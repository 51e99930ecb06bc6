// SPDX-License-Identifier: BSD-3-Clause
// Meshes that are left out: one notice that names them all.
#include "shape/missing_meshes.hpp"

#include <fmt/format.h>

namespace leeway::io::detail
{

void MissingMeshes::add( const std::string& mesh, const std::string& link, int line )
{
	m_meshes.push_back( fmt::format( "{} of link {} (line {})", mesh, link, line ) );
	m_links.insert( link );
}

void MissingMeshes::report( const std::string& file, bool others, std::vector<Notice>& notices ) const
{
	if ( m_meshes.empty() )
	{
		return;
	}
	const std::string list = joinNames( m_meshes, m_meshes.size() );
	if ( !others )
	{
		throw Error( file, "meshes",
		    fmt::format( "every mesh is missing ({}), and no other shape is left to check: {}", m_meshes.size(), list ),
		    "name the folders of their packages (--package-path)" );
	}
	notices.push_back( { file, "missing meshes",
	    fmt::format( "LEFT OUT, because they were found nowhere, so that nothing collides with them ({}, in links: {}): {}",
	        m_meshes.size(), m_links.size(), list ) } );
}

} // namespace leeway::io::detail
