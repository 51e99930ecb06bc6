// SPDX-License-Identifier: BSD-3-Clause
// Attributes and sections that MJCF has: a misspelt one would be silently without effect.
//
// The names are those of the schema of MuJoCo 4.0 and the ones that older versions had.
#include "mjcf/known.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace leeway::io::detail::mjcf
{

namespace
{

struct Known
{
	const char *element, *attributes;
};

constexpr Known known_attributes[] = {
    { "compiler",
        "alignfree angle assetdir autolimits balanceinertia boundinertia boundmass conflict convexhull coordinate discardvisual "
        "eulerseq exactmeshinertia fitaabb fusestatic inertiafromgeom inertiagrouprange meshdir passthrough savecanonical "
        "savecompiled saveinertial settotalmass strippath texturedir usethread" },
    { "worldbody", "childclass name" },
    { "body", "axisangle childclass euler fuse gravcomp mocap name pos quat simple sleep user xyaxes zaxis" },
    { "frame", "axisangle childclass euler massscale name pos quat scale scaling xyaxes zaxis" },
    { "replicate", "count euler offset sep" },
    { "joint",
        "actuatorfrclimited actuatorfrcrange actuatorgravcomp armature axis class damping frictionloss group limited margin name pos "
        "range ref solimpfriction solimplimit solreffriction solreflimit springdamper springref springyield stiffness type user" },
    { "freejoint", "align group name" },
    { "geom",
        "adhesion axisangle castshadow class conaffinity condim contype density euler fitscale fluidcoef fluidshape friction fromto "
        "gap group hfield margin mass material mesh name pos priority quat rgba shellinertia size solimp solmix solref surfacevel type "
        "user xyaxes zaxis" },
    { "mesh",
        "builtin class content_type face file inertia material maxhullvert name normal params refpos refquat scale smoothnormal "
        "texcoord vertex" },
    { "hfield", "content_type elevation file name ncol nrow size" },
    { "exclude", "body1 body2 name" },
    { "pair", "adhesion class condim friction gap geom1 geom2 margin name solimp solref solreffriction" },
    { "key", "act ctrl mpos mquat name plastic qpos qvel time" },
};

constexpr const char* sections =
    "compiler option size statistic visual default extension asset worldbody deformable contact tendon equality "
    "actuator sensor custom keyframe";

bool contains( const std::string& words, const std::string& word )
{
	const std::vector<std::string> all = splitBlanks( words );
	return std::find( all.begin(), all.end(), word ) != all.end();
}

class Finder
{
public:
	explicit Finder( const Document& document ) : m_document( document ) {}
	/// The element and all below it.
	void look( const XMLElement& e )
	{
		const auto known = std::find_if( std::begin( known_attributes ), std::end( known_attributes ),
		    [&]( const Known& one ) { return std::string( e.Name() ) == one.element; } );
		for ( const tinyxml2::XMLAttribute* a = e.FirstAttribute(); known != std::end( known_attributes ) && a != nullptr;
		      a = a->Next() )
		{
			if ( !contains( known->attributes, a->Name() ) )
			{
				add( e, fmt::format( "{} of <{}>", a->Name(), e.Name() ) );
			}
		}
		for ( const XMLElement* child : m_document.children( e ) )
		{
			look( *child );
		}
	}
	void add( const XMLElement& at, const std::string& what )
	{
		found.push_back( fmt::format( "{} (line {})", what, at.GetLineNum() ) );
	}

	std::vector<std::string> found;

private:
	const Document& m_document;
};

} // namespace

void noticeUnknown( const Document& document, std::vector<Notice>& notices )
{
	Finder finder( document );
	for ( const XMLElement* section : document.children( document.root() ) )
	{
		const std::string kind = section->Name();
		if ( !contains( sections, kind ) )
		{
			finder.add( *section, "<" + kind + ">" );
		}
		if ( contains( "compiler worldbody default asset contact keyframe", kind ) )
		{
			finder.look( *section );
		}
	}
	if ( !finder.found.empty() )
	{
		notices.push_back( { document.path(), "<mujoco>",
		    fmt::format( "{} attributes and sections that MJCF does not know were ignored: {}", finder.found.size(),
		        joinNames( finder.found ) ) } );
	}
}

} // namespace leeway::io::detail::mjcf
