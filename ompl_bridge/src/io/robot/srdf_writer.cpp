// SPDX-License-Identifier: BSD-3-Clause
// SRDF: a robot's own document with its computed pairs replaced and everything else kept.
#include "base/xml.hpp"

#include <algorithm>
#include <set>

namespace leeway::io
{

namespace
{

using tinyxml2::XMLElement;
using NamePair = std::pair<std::string, std::string>;

NamePair sorted( const std::string& a, const std::string& b )
{
	return std::minmax( a, b );
}

std::string attribute( const XMLElement& element, const char* name )
{
	const char* value = element.Attribute( name );
	return value != nullptr ? value : "";
}

/// A document split into the elements that a person decided on, which stay, and the position of the computed ones.
class Document
{
public:
	Document( tinyxml2::XMLDocument& xml, const RobotModel& model );
	/// Takes out the computed elements and notes the kept ones.
	void removeComputed();
	void insert( const std::vector<DisabledPair>& pairs );
	/// True if an element that stays disables this pair.
	bool covers( const NamePair& pair ) const;
	const std::vector<DisabledPair>& kept() const { return m_kept; }

private:
	bool known( const std::string& link ) const { return m_links.count( link ) != 0; }

	tinyxml2::XMLDocument& m_xml;
	std::set<std::string> m_links, m_disabled_links; ///< of the robot; disabled with all others
	std::set<NamePair> m_enabled, m_kept_pairs;
	std::vector<DisabledPair> m_kept;
	tinyxml2::XMLNode* m_before = nullptr; ///< after this child of the root (nullptr: before its first child)
	bool m_has_place = false;
};

Document::Document( tinyxml2::XMLDocument& xml, const RobotModel& model ) : m_xml( xml )
{
	for ( const LinkModel& link : model.links )
	{
		m_links.insert( link.name );
	}
	for ( const XMLElement& e : detail::children( *xml.RootElement(), "disable_default_collisions" ) )
	{
		m_disabled_links.insert( attribute( e, "link" ) );
	}
	for ( const XMLElement& e : detail::children( *xml.RootElement(), "enable_collisions" ) )
	{
		m_enabled.insert( sorted( attribute( e, "link1" ), attribute( e, "link2" ) ) );
	}
}

void Document::removeComputed()
{
	XMLElement* root = m_xml.RootElement();
	for ( XMLElement* e = root->FirstChildElement( "disable_collisions" ); e != nullptr; )
	{
		XMLElement* next = e->NextSiblingElement( "disable_collisions" );
		DisabledPair pair{ attribute( *e, "link1" ), attribute( *e, "link2" ), attribute( *e, "reason" ) };
		if ( isComputedReason( pair.reason ) && known( pair.link1 ) && known( pair.link2 ) )
		{
			if ( !m_has_place )
			{
				m_before = e->PreviousSibling();
				m_has_place = true;
			}
			root->DeleteChild( e );
		}
		else
		{
			m_kept.push_back( pair );
			m_kept_pairs.insert( sorted( pair.link1, pair.link2 ) );
		}
		e = next;
	}
	if ( !m_has_place )
	{
		XMLElement* last = root->LastChildElement( "disable_collisions" );
		m_before = last != nullptr ? last : root->LastChild();
	}
}

bool Document::covers( const NamePair& pair ) const
{
	bool by_default = ( m_disabled_links.count( pair.first ) != 0 || m_disabled_links.count( pair.second ) != 0 ) &&
	                  m_enabled.count( pair ) == 0;
	return by_default || m_kept_pairs.count( pair ) != 0;
}

void Document::insert( const std::vector<DisabledPair>& pairs )
{
	XMLElement* root = m_xml.RootElement();
	for ( const DisabledPair& pair : pairs )
	{
		XMLElement* e = m_xml.NewElement( "disable_collisions" );
		e->SetAttribute( "link1", pair.link1.c_str() );
		e->SetAttribute( "link2", pair.link2.c_str() );
		e->SetAttribute( "reason", pair.reason.c_str() );
		m_before = m_before != nullptr ? root->InsertAfterChild( m_before, e ) : root->InsertFirstChild( e );
	}
}

} // namespace

bool isComputedReason( const std::string& reason )
{
	for ( const char* word : { "Adjacent", "Never", "Default", "Always" } )
	{
		std::string computed = word;
		if ( reason == computed || reason.compare( 0, computed.size() + 2, computed + " (" ) == 0 )
		{
			return true;
		}
	}
	return false;
}

WrittenSrdf writeSrdf( const RobotModel& model, const std::vector<DisabledPair>& pairs )
{
	detail::SrdfDraft draft( model );
	tinyxml2::XMLDocument& xml = draft.document();
	Document document( xml, model );
	document.removeComputed();

	WrittenSrdf result;
	std::map<NamePair, std::string> reasons;
	for ( const DisabledPair& pair : pairs )
	{
		NamePair names = sorted( pair.link1, pair.link2 );
		if ( !document.covers( names ) )
		{
			reasons.emplace( names, pair.reason );
		}
	}
	for ( const auto& [names, reason] : reasons )
	{
		result.written.push_back( { names.first, names.second, reason } );
	}
	document.insert( result.written );
	result.kept = document.kept();
	result.text = detail::printed( xml );
	return result;
}

} // namespace leeway::io
