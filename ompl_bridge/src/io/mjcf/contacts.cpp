// SPDX-License-Identifier: BSD-3-Clause
// Pairs of links that MuJoCo does not check: parent and child, <exclude>, and masks of which no two meet. <pair> overrules all.
//
// MuJoCo's masks are those of geoms; here a pair of links is checked or allowed as a whole, so links of which some geoms may meet
// are checked with all of them: more than MuJoCo checks, never less.
#include "mjcf/robot.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace leeway::io::detail::mjcf
{

namespace
{

std::pair<std::string, std::string> sorted( const std::string& a, const std::string& b )
{
	return a < b ? std::pair( a, b ) : std::pair( b, a );
}

class PairWriter
{
public:
	PairWriter(
	    const Document& document, const Compiler& compiler, const Tree& tree, const GeomPairs& pairs, RobotModel& model );
	void write();
	void writePlane( const PlaneLink& plane );

private:
	void readExcluded();
	bool isFamily( const Body& a, const Body& b ) const;
	bool isPaired( std::size_t a, std::size_t b ) const { return m_paired.count( std::minmax( a, b ) ) != 0; }
	bool isSolid( const Geom& geom ) const
	{
		return geom.type != GeomType::PLANE && ( geom.collides() || m_paired_geoms.count( geom.name ) != 0 );
	}
	std::string reasonFor( std::size_t a, std::size_t b, bool& partly ) const;

	const Document& m_document;
	const Compiler& m_compiler;
	const Tree& m_tree;
	RobotModel& m_model;
	std::map<std::string, std::size_t> m_bodies;
	std::set<std::string> m_paired_geoms;                          ///< of a <pair>: they collide whatever their masks are
	std::set<std::pair<std::size_t, std::size_t>> m_paired;        ///< their bodies
	std::map<std::pair<std::size_t, std::size_t>, int> m_excluded; ///< bodies, with the line
};

PairWriter::PairWriter(
    const Document& document, const Compiler& compiler, const Tree& tree, const GeomPairs& pairs, RobotModel& model )
    : m_document( document ), m_compiler( compiler ), m_tree( tree ), m_model( model )
{
	std::map<std::string, std::size_t> owner;
	for ( std::size_t i = 0; i < tree.bodies.size(); ++i )
	{
		m_bodies.emplace( tree.bodies[i].name, i );
		for ( const Geom& geom : tree.bodies[i].geoms )
		{
			owner.emplace( geom.name, i );
		}
	}
	for ( const auto& [a, b] : pairs )
	{
		m_paired_geoms.insert( { a, b } );
		m_paired.insert( std::minmax( owner.at( a ), owner.at( b ) ) );
	}
}

void PairWriter::readExcluded()
{
	for ( const XMLElement* e : m_document.inSections( "contact", "exclude" ) )
	{
		std::size_t bodies[2] = { 0, 0 };
		for ( std::size_t k = 0; k < 2; ++k )
		{
			const std::string name = m_document.text( *e, "exclude", k == 0 ? "body1" : "body2" );
			const auto found = m_bodies.find( name );
			if ( found == m_bodies.end() )
			{
				m_document.fail( *e, "exclude", fmt::format( "there is no body {}", name ),
				    "correct the name; names in a <replicate> have a suffix" );
			}
			bodies[k] = found->second;
		}
		m_excluded.emplace( std::minmax( bodies[0], bodies[1] ), e->GetLineNum() );
	}
}

/// Parent and child, each with all bodies that are fixed to it; the world is nobody's parent here.
bool PairWriter::isFamily( const Body& a, const Body& b ) const
{
	const auto above = [&]( const Body& body ) { return m_tree.bodies[m_tree.bodies[body.weld].parent].weld; };
	return m_compiler.filter_parent && a.weld != 0 && b.weld != 0 && ( above( a ) == b.weld || above( b ) == a.weld );
}

/// Why MuJoCo does not check two bodies; empty if it does.
/// @param partly set if it checks some of their geoms only
std::string PairWriter::reasonFor( std::size_t a, std::size_t b, bool& partly ) const
{
	const Body &first = m_tree.bodies[a], &second = m_tree.bodies[b];
	if ( first.weld == second.weld || isPaired( a, b ) )
	{
		return "";
	}
	if ( isFamily( first, second ) )
	{
		return "Adjacent (parent and child in MJCF)";
	}
	const auto excluded = m_excluded.find( std::minmax( a, b ) );
	if ( excluded != m_excluded.end() )
	{
		return fmt::format( "excluded in the MJCF (line {})", excluded->second );
	}
	std::size_t met = 0, all = 0;
	for ( const Geom& one : first.geoms )
	{
		for ( const Geom& other : second.geoms )
		{
			const bool counts = isSolid( one ) && isSolid( other );
			all += counts ? 1 : 0;
			met += counts && one.meets( other ) ? 1 : 0;
		}
	}
	partly = met > 0 && met < all;
	return all > 0 && met == 0 ? "contype and conaffinity in the MJCF" : "";
}

void PairWriter::write()
{
	readExcluded();
	std::vector<std::string> partly_checked;
	for ( std::size_t a = 0; a < m_tree.bodies.size(); ++a )
	{
		for ( std::size_t b = a + 1; b < m_tree.bodies.size(); ++b )
		{
			if ( m_tree.bodies[a].geoms.empty() || m_tree.bodies[b].geoms.empty() )
			{
				continue;
			}
			bool partly = false;
			const std::string reason = reasonFor( a, b, partly );
			if ( !reason.empty() )
			{
				m_model.disabled.push_back( { m_tree.bodies[a].name, m_tree.bodies[b].name, reason } );
			}
			else if ( partly )
			{
				partly_checked.push_back( m_tree.bodies[a].name + " - " + m_tree.bodies[b].name );
			}
		}
	}
	if ( !partly_checked.empty() )
	{
		m_model.report.notices.push_back( { m_document.path(), "contype and conaffinity",
		    fmt::format( "{} pairs of bodies are checked with all of their geoms, of which MuJoCo checks some: {}",
		        partly_checked.size(), joinNames( partly_checked, 6 ) ) } );
	}
}

/// Links that are fixed to the world do not collide with its planes.
void PairWriter::writePlane( const PlaneLink& plane )
{
	for ( std::size_t i = 0; i < m_tree.bodies.size(); ++i )
	{
		const Body& body = m_tree.bodies[i];
		const auto meets = [&]( const Geom& geom ) { return geom.type != GeomType::PLANE && geom.meets( *plane.geom ); };
		const bool masked = std::none_of( body.geoms.begin(), body.geoms.end(), meets );
		const auto excluded = m_excluded.find( std::minmax( i, plane.body ) );
		if ( body.geoms.empty() || isPaired( i, plane.body ) )
		{
			continue;
		}
		if ( body.weld == 0 || excluded != m_excluded.end() || masked )
		{
			m_model.disabled.push_back( { plane.link, body.name,
			    body.weld == 0                 ? "fixed to the world in the MJCF"
			    : excluded != m_excluded.end() ? fmt::format( "excluded in the MJCF (line {})", excluded->second )
			                                   : std::string( "contype and conaffinity in the MJCF" ) } );
		}
	}
}

} // namespace

GeomPairs readGeomPairs( const Document& document, const Tree& tree )
{
	std::set<std::string> known;
	for ( const Body& body : tree.bodies )
	{
		for ( const Geom& geom : body.geoms )
		{
			known.insert( geom.name );
		}
	}
	GeomPairs pairs;
	for ( const XMLElement* e : document.inSections( "contact", "pair" ) )
	{
		const std::string one = document.text( *e, "pair", "geom1" ), other = document.text( *e, "pair", "geom2" );
		for ( const std::string& name : { one, other } )
		{
			if ( known.count( name ) == 0 )
			{
				document.fail( *e, "pair", fmt::format( "there is no geom {}", name ),
				    "correct the name; names in a <replicate> have a suffix" );
			}
		}
		pairs.insert( sorted( one, other ) );
	}
	return pairs;
}

void addPairs( const Document& document, const Compiler& compiler, const Tree& tree, const GeomPairs& pairs,
    const std::vector<PlaneLink>& planes, RobotModel& model )
{
	PairWriter writer( document, compiler, tree, pairs, model );
	writer.write();
	std::for_each( planes.begin(), planes.end(), [&]( const PlaneLink& plane ) { writer.writePlane( plane ); } );
}

} // namespace leeway::io::detail::mjcf
