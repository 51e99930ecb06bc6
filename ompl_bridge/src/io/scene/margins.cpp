// SPDX-License-Identifier: BSD-3-Clause
// Margins of pairs: read from a file, and bound to the links and objects of a problem.
#include "scene/margins.hpp"

#include "base/yaml.hpp"

#include <cmath>
#include <fmt/format.h>

namespace leeway::io
{

namespace
{

using detail::BoundMargins;
using detail::YamlNode;

/// Margins may be written by a program: they are checked as a file is.
double checked( double value, const std::string& file, const std::string& element )
{
	if ( !( value >= 0 ) || !std::isfinite( value ) )
	{
		throw Error( file, element, fmt::format( "{} is no margin", value ), "give metres, 0 or more" );
	}
	return value;
}

std::map<std::string, double> readMap( const YamlNode& node )
{
	std::map<std::string, double> values = node.numberMap();
	for ( const auto& [name, value] : values )
	{
		const YamlNode entry = node[name.c_str()];
		checked( value, entry.file(), entry.place() );
	}
	return values;
}

void readPair( const YamlNode& node, Margins& margins )
{
	if ( !node.isList() || node.size() != 3 )
	{
		node.fail( "is no pair", "write [link, object, metres] or [link, link, metres]" );
	}
	std::string a = node[std::size_t{ 0 }].text(), b = node[1].text();
	const YamlNode value = node[2];
	const bool known = margins.pairs.count( { a, b } ) != 0 || margins.pairs.count( { b, a } ) != 0;
	if ( known )
	{
		node.fail( fmt::format( "{}, {} is there twice", a, b ), "keep one of them" );
	}
	margins.pairs[{ a, b }] = checked( value.number(), value.file(), value.place() );
}

/// Adds margins to links, objects and pairs, which it finds by name.
class Binder
{
public:
	Binder( const Margins& margins, const Problem& problem )
	    : m_file( margins.file.empty() ? "margins" : margins.file ), m_robot( problem.robot.get() ),
	      m_scene( problem.scene.get() )
	{
	}

	std::uint32_t link( const std::string& name ) const { return lw_robot_find_link( m_robot, name.c_str() ); }
	std::uint32_t object( const std::string& name ) const
	{
		return m_scene != nullptr ? lw_scene_find_object( m_scene, name.c_str() ) : LW_INVALID_INDEX;
	}

	void add( const std::map<std::string, double>& values, const char* what, bool objects, std::vector<double>& out ) const
	{
		for ( const auto& [name, value] : values )
		{
			checked( value, m_file, fmt::format( "{}.{}", what, name ) );
			const std::uint32_t index = objects ? object( name ) : link( name );
			if ( index != LW_INVALID_INDEX )
			{
				out[index] += value;
			}
			else if ( value != 0 )
			{
				throw Error( m_file, fmt::format( "{}.{}", what, name ),
				    objects ? fmt::format( "the scene has no object {}", name )
				            : fmt::format( "robot {} has no link {}", lw_robot_name( m_robot ), name ),
				    "correct the name, or remove the entry" );
			}
		}
	}

	void addPair( const std::string& a, const std::string& b, double margin, BoundMargins& out ) const
	{
		const std::string element = fmt::format( "pairs [{}, {}]", a, b );
		checked( margin, m_file, element );
		const std::uint32_t link_a = link( a ), link_b = link( b ), object_a = object( a ), object_b = object( b );
		for ( const auto& [name, as_link, as_object] :
		    { std::tuple( &a, link_a, object_a ), std::tuple( &b, link_b, object_b ) } )
		{
			if ( as_link == LW_INVALID_INDEX && as_object == LW_INVALID_INDEX )
			{
				throw Error( m_file, element, fmt::format( "{} is neither a link nor an object", *name ),
				    "correct the name, or remove the entry" );
			}
			if ( as_link != LW_INVALID_INDEX && as_object != LW_INVALID_INDEX )
			{
				throw Error( m_file, element, fmt::format( "{} is a link and an object too", *name ), "rename the object" );
			}
		}
		if ( link_a == LW_INVALID_INDEX && link_b == LW_INVALID_INDEX )
		{
			throw Error( m_file, element, "are two objects, and their distance is not asked for",
			    "name a link and an object, or two links" );
		}
		if ( link_a == link_b )
		{
			throw Error( m_file, element, "is a link with itself", "name two links" );
		}
		if ( link_a != LW_INVALID_INDEX && link_b != LW_INVALID_INDEX )
		{
			out.self_pairs.push_back( { link_a, link_b, margin } );
			return;
		}
		const bool forth = link_a != LW_INVALID_INDEX;
		out.pairs.push_back( { forth ? link_a : link_b, forth ? object_b : object_a, margin } );
	}

private:
	const std::string m_file;
	const lw_robot* m_robot;
	const lw_scene* m_scene;
};

/// Margins of pairs whose contact is allowed have no effect: a notice names the pairs, in case the author expects one.
void noticeAllowed( const Margins& margins, const Problem& problem,
    const std::vector<std::pair<std::string, std::string>>& allowed, std::vector<Notice>& notices )
{
	const std::set<std::pair<std::string, std::string>> contacts( allowed.begin(), allowed.end() );
	std::vector<std::string> names;
	for ( const auto& entry : margins.pairs )
	{
		const auto& [a, b] = entry.first;
		const lw_robot* robot = problem.robot.get();
		const std::uint32_t link_a = lw_robot_find_link( robot, a.c_str() ), link_b = lw_robot_find_link( robot, b.c_str() );
		const bool self = link_a != LW_INVALID_INDEX && link_b != LW_INVALID_INDEX;
		if ( self ? lw_robot_pair_allowed( robot, link_a, link_b )
		          : contacts.count( { a, b } ) + contacts.count( { b, a } ) > 0 )
		{
			names.push_back( a + " - " + b );
		}
	}
	if ( !names.empty() )
	{
		notices.push_back( { margins.file, "pairs",
		    fmt::format( "margins of pairs whose contact is allowed are in vain: {}", detail::joinNames( names ) ) } );
	}
}

} // namespace

Margins loadMargins( const std::string& file )
{
	std::vector<Notice> notices;
	const YamlNode root = YamlNode::load( file, notices );
	root.refuseUnknownKeys( { "environment", "self", "links", "self_links", "objects", "pairs" } );
	Margins margins;
	margins.file = file;
	for ( const auto& [key, target] :
	    { std::pair( "environment", &margins.environment ), std::pair( "self", &margins.self ) } )
	{
		const YamlNode node = root[key];
		*target = node.defined() ? checked( node.number(), file, node.place() ) : 0;
	}
	margins.links = readMap( root["links"] );
	margins.self_links = readMap( root["self_links"] );
	margins.objects = readMap( root["objects"] );
	const YamlNode pairs = root["pairs"];
	for ( std::size_t i = 0; i < pairs.size(); ++i )
	{
		readPair( pairs[i], margins );
	}
	return margins;
}

namespace detail
{

lw_margins BoundMargins::def() const
{
	lw_margins out{};
	out.environment = environment;
	out.self = self;
	out.link_environment = links.data();
	out.link_self = self_links.data();
	out.object = objects.data();
	out.environment_pairs = pairs.data();
	out.environment_pair_count = static_cast<std::uint32_t>( pairs.size() );
	out.self_pairs = self_pairs.data();
	out.self_pair_count = static_cast<std::uint32_t>( self_pairs.size() );
	return out;
}

BoundMargins bindMargins( const Margins& margins, const Problem& problem, const std::set<std::string>& attached,
    const std::vector<std::pair<std::string, std::string>>& allowed, std::vector<Notice>& notices )
{
	const Binder binder( margins, problem );
	const std::string file = margins.file.empty() ? "margins" : margins.file;
	BoundMargins out;
	out.environment = checked( margins.environment, file, "environment" );
	out.self = checked( margins.self, file, "self" );
	out.links.assign( lw_robot_link_count( problem.robot.get() ), 0 );
	out.self_links = out.links;
	out.objects.assign( problem.scene ? lw_scene_object_count( problem.scene.get() ) : 0, problem.padding.object );
	// MoveIt pads links against the world, and checks the robot against itself without
	for ( const auto& [name, padding] : problem.padding.link_padding )
	{
		out.links[binder.link( name )] = padding; // paddingOf() has the links of this robot only
	}
	for ( const std::string& name : attached )
	{
		out.links[binder.link( name )] = problem.padding.attached;
	}
	binder.add( margins.links, "links", false, out.links );
	binder.add( margins.self_links, "self_links", false, out.self_links );
	binder.add( margins.objects, "objects", true, out.objects );
	for ( const auto& [names, margin] : margins.pairs )
	{
		binder.addPair( names.first, names.second, margin, out );
	}
	noticeAllowed( margins, problem, allowed, notices );
	return out;
}

} // namespace detail
} // namespace leeway::io
