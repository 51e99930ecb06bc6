// SPDX-License-Identifier: BSD-3-Clause
#include "robot/colours.hpp"

#include <cmath>
#include <cstring>
#include <locale>
#include <sstream>

namespace leeway::io::detail
{
namespace
{

std::optional<Colour> colourOf( const tinyxml2::XMLElement& material )
{
	const tinyxml2::XMLElement* element = material.FirstChildElement( "color" );
	const char* text = element != nullptr ? element->Attribute( "rgba" ) : nullptr;
	std::istringstream stream( text != nullptr ? text : "" );
	stream.imbue( std::locale::classic() );
	Colour colour;
	for ( double& part : colour )
	{
		if ( !( stream >> part ) || !( part >= 0 && part <= 1 ) )
		{
			return std::nullopt;
		}
	}
	return colour;
}

std::optional<Colour> namedColour( const XmlFile& xml, const char* name )
{
	for ( const tinyxml2::XMLElement& material : children( xml.root(), "material" ) )
	{
		const char* own = material.Attribute( "name" );
		if ( name != nullptr && own != nullptr && std::strcmp( own, name ) == 0 )
		{
			return colourOf( material );
		}
	}
	return std::nullopt;
}

} // namespace

std::optional<Colour> linkColour( const XmlFile& xml, const tinyxml2::XMLElement& link )
{
	for ( const char* kind : { "visual", "collision" } ) // visuals may serve as collision geometry
	{
		for ( const tinyxml2::XMLElement& shape : children( link, kind ) )
		{
			const tinyxml2::XMLElement* material = shape.FirstChildElement( "material" );
			std::optional<Colour> colour = material != nullptr ? colourOf( *material ) : std::nullopt;
			if ( material != nullptr && !colour )
			{
				colour = namedColour( xml, material->Attribute( "name" ) );
			}
			if ( colour )
			{
				return colour;
			}
		}
	}
	return std::nullopt;
}

} // namespace leeway::io::detail
