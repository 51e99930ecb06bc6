// SPDX-License-Identifier: BSD-3-Clause
// Colours of MJCF: for pictures alone. A wrong one is none, as in a URDF.
#include "mjcf/tree.hpp"

namespace leeway::io::detail::mjcf
{
namespace
{

std::optional<Colour> colourOf( const XMLElement* carrier )
{
	const char* text = carrier != nullptr ? carrier->Attribute( "rgba" ) : nullptr;
	const std::vector<std::string> words = splitBlanks( text != nullptr ? text : "" );
	Colour colour = {};
	for ( std::size_t i = 0; i < colour.size(); ++i )
	{
		const std::optional<double> part = i < words.size() ? parseNumber( words[i] ) : std::nullopt;
		if ( !part || !( *part >= 0 && *part <= 1 ) )
		{
			return std::nullopt;
		}
		colour[i] = *part;
	}
	return words.size() == colour.size() ? std::optional<Colour>( colour ) : std::nullopt;
}

} // namespace

Colours::Colours( const Document& document, const Defaults& defaults ) : m_defaults( defaults )
{
	for ( const XMLElement* material : document.inSections( "asset", "material" ) )
	{
		const char* name = material->Attribute( "name" );
		m_materials.emplace( name != nullptr ? name : "", material );
	}
}

std::optional<Colour> Colours::of( const XMLElement& geom, const std::string& child_class ) const
{
	if ( const std::optional<Colour> own = colourOf( m_defaults.find( geom, child_class, "rgba" ) ) )
	{
		return own;
	}
	const XMLElement* carrier = m_defaults.find( geom, child_class, "material" );
	const auto found = carrier != nullptr ? m_materials.find( carrier->Attribute( "material" ) ) : m_materials.end();
	return found == m_materials.end() || found->second->Attribute( "texture" ) != nullptr
	           ? std::nullopt
	           : colourOf( m_defaults.find( *found->second, "", "rgba" ) );
}

} // namespace leeway::io::detail::mjcf
