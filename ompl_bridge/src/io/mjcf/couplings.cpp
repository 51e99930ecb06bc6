// SPDX-License-Identifier: BSD-3-Clause
// <equality> of an MJCF model: joints that follow others linearly. Loops of bodies are not held.
#include "mjcf/robot.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace leeway::io::detail::mjcf
{

namespace
{

class CouplingReader
{
public:
	CouplingReader( const Document& document, const Defaults& defaults, const Tree& tree, std::vector<Notice>& notices )
	    : m_document( document ), m_defaults( defaults ), m_notices( notices )
	{
		for ( const Body& body : tree.bodies )
		{
			for ( const Joint& joint : body.joints )
			{
				m_joints.emplace( joint.name, &joint );
			}
		}
	}
	Couplings read();

private:
	void readJoint( const XMLElement& e );
	const Joint& joint( const XMLElement& e, const std::string& what, const char* attribute ) const;
	void checkCycles() const;

	const Document& m_document;
	const Defaults& m_defaults;
	std::vector<Notice>& m_notices;
	std::map<std::string, const Joint*> m_joints;
	std::map<std::string, const XMLElement*> m_elements; ///< by the joint that follows
	Couplings m_couplings;
};

const Joint& CouplingReader::joint( const XMLElement& e, const std::string& what, const char* attribute ) const
{
	const std::string name = m_document.text( e, what, attribute );
	const auto found = m_joints.find( name );
	if ( found == m_joints.end() )
	{
		m_document.fail(
		    e, what, fmt::format( "there is no joint {}", name ), "correct the name; names in a <replicate> have a suffix" );
	}
	if ( found->second->type != Joint::HINGE && found->second->type != Joint::SLIDE )
	{
		m_document.fail( e, what, fmt::format( "joint {} is neither hinge nor slide", name ), "couple joints of one value" );
	}
	return *found->second;
}

/// y - y0 = a0 + a1 (x - x0) + ...
void CouplingReader::readJoint( const XMLElement& e )
{
	const std::string what = "equality";
	const Joint& follower = joint( e, what, "joint1" );
	const Joint* driver = e.Attribute( "joint2" ) != nullptr ? &joint( e, what, "joint2" ) : nullptr;
	std::vector<double> a = { 0, 1, 0, 0, 0 };
	if ( e.Attribute( "polycoef" ) != nullptr )
	{
		const std::vector<double> given = m_document.numbers( e, what, "polycoef", 1, 5 );
		std::copy( given.begin(), given.end(), a.begin() );
	}
	if ( driver != nullptr && ( a[2] != 0 || a[3] != 0 || a[4] != 0 ) )
	{
		m_notices.push_back( m_document.notice( e, what,
		    fmt::format( "joint {} follows joint {} by a curve, which is not held: it moves freely", follower.name,
		        driver->name ) ) );
		return;
	}
	Coupling coupling;
	if ( driver != nullptr && a[1] != 0 )
	{
		coupling.driver = driver->name;
		coupling.multiplier = a[1];
		coupling.offset = follower.reference + a[0] - a[1] * driver->reference;
	}
	else
	{
		coupling.offset = follower.reference + a[0];
	}
	if ( driver == &follower )
	{
		m_document.fail( e, what, fmt::format( "joint {} follows itself", follower.name ), "name two joints" );
	}
	if ( !m_couplings.emplace( follower.name, coupling ).second )
	{
		m_notices.push_back( m_document.notice(
		    e, what, fmt::format( "joint {} follows a joint already: this coupling is not held", follower.name ) ) );
		return;
	}
	m_elements.emplace( follower.name, &e );
}

/// Two joints that follow each other leave nothing to move.
void CouplingReader::checkCycles() const
{
	for ( const auto& [name, coupling] : m_couplings )
	{
		std::string at = coupling.driver;
		for ( std::size_t steps = 0; m_couplings.count( at ) != 0; ++steps )
		{
			if ( at == name || steps > m_couplings.size() )
			{
				m_document.fail( *m_elements.at( name ), "equality",
				    fmt::format( "joint {} follows itself by way of others", name ), "remove one of the couplings" );
			}
			at = m_couplings.at( at ).driver;
		}
	}
}

Couplings CouplingReader::read()
{
	for ( const XMLElement* e : m_document.inSections( "equality" ) )
	{
		const std::string kind = e->Name();
		const XMLElement* active = m_defaults.find( *e, "", "active", "equality" );
		if ( active != nullptr && m_document.word( *active, "equality", "active", { "true", "false" } ) == "false" )
		{
			continue;
		}
		if ( kind == "joint" )
		{
			readJoint( *e );
			continue;
		}
		const char* first = kind == "tendon" ? "tendon1" : e->Attribute( "site1" ) != nullptr ? "site1" : "body1";
		const char* second = kind == "tendon" ? "tendon2" : e->Attribute( "site2" ) != nullptr ? "site2" : "body2";
		const std::string one = m_document.optionalText( *e, kind, first ),
		                  two = m_document.optionalText( *e, kind, second );
		m_notices.push_back( m_document.notice( *e, kind,
		    fmt::format( "is not held: {} and {} move independently of each other", one.empty() ? "its parts" : one,
		        two.empty() ? "the rest" : two ) ) );
	}
	checkCycles();
	return std::move( m_couplings );
}

} // namespace

Couplings readCouplings( const Document& document, const Defaults& defaults, const Tree& tree, std::vector<Notice>& notices )
{
	return CouplingReader( document, defaults, tree, notices ).read();
}

} // namespace leeway::io::detail::mjcf
