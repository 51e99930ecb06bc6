// SPDX-License-Identifier: BSD-3-Clause
// The robot with pairs of every class.
#include "pairs_fixture.hpp"

namespace
{

std::string box( const std::string& name, const std::string& size, const std::string& at = "0 0 0" )
{
	return "  <link name=\"" + name + "\"><collision><origin xyz=\"" + at + "\"/><geometry><box size=\"" + size +
	       "\"/></geometry></collision></link>\n";
}

std::string joint( const std::string& child, const std::string& type, const std::string& at, const std::string& axis,
    const std::string& limits, const std::string& more = "", const std::string& parent = "base" )
{
	const std::string limit = limits.empty() ? "" : "<limit " + limits + " effort=\"1\" velocity=\"1\"/>";
	return "  <joint name=\"" + child + "_joint\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" +
	       child + "\"/><origin xyz=\"" + at + "\"/><axis xyz=\"" + axis + "\"/>" + limit + more + "</joint>\n";
}

std::string urdf()
{
	const std::string small = "0.1 0.1 0.1";
	std::string text = "<robot name=\"many\">\n" + box( "base", "1 0.2 0.2" );
	for ( const char* name : { "left", "right", "jaw_a", "jaw_b", "lid", "nut", "flag", "pin" } )
	{
		text += box( name, small );
	}
	text += box( "pot", "0.2 0.2 0.2" ) + box( "bolt", "0.05 0.05 0.3" );
	text += box( "gear_a", small, "0.5 0 0" ) + box( "gear_b", small, "-0.5 0 0" );
	text += joint( "left", "prismatic", "-0.4 0.3 0", "0 1 0", "lower=\"0\" upper=\"0.2\"" );
	text += joint( "right", "prismatic", "0.4 0.3 0", "0 1 0", "lower=\"0\" upper=\"0.2\"" );
	text += joint( "gear_a", "revolute", "0 0 3", "0 0 1", "lower=\"-3\" upper=\"3\"" );
	text += joint( "gear_b", "revolute", "0 0 3", "0 0 1", "lower=\"-3\" upper=\"3\"", "<mimic joint=\"gear_a_joint\"/>" );
	text += joint( "jaw_a", "prismatic", "0 2 0", "1 0 0", "lower=\"0\" upper=\"0.3\"" );
	text += joint( "jaw_b", "prismatic", "0.5 2 0", "-1 0 0", "lower=\"0\" upper=\"0.3\"" );
	text += joint( "pot", "revolute", "0 -2 0", "0 0 1", "lower=\"-1\" upper=\"1\"" );
	text += joint( "lid", "prismatic", "0 -2 0.1", "0 0 1", "lower=\"0\" upper=\"0.5\"" );
	text += joint( "nut", "revolute", "0 -4 0", "0 0 1", "lower=\"-1\" upper=\"1\"" );
	text += joint( "bolt", "continuous", "0 -4 0", "0 0 1", "" );
	text += joint( "flag", "fixed", "0 0 0.5", "1 0 0", "" );
	text += joint( "pin", "fixed", "0 0 0.5", "1 0 0", "", "", "flag" );
	return text + "</robot>\n";
}

const char* const srdf = R"(<?xml version="1.0"?>
<!-- written by hand -->
<robot name="many">
  <group name="jaws">
    <joint name="jaw_a_joint"/> <!-- the first -->
    <joint name="jaw_b_joint"/>
  </group>
  <group_state name="open" group="jaws"><joint name="jaw_a_joint" value="0"/></group_state>
  <end_effector name="grip" parent_link="base" group="jaws"/>
  <passive_joint name="pot_joint"/>
  <virtual_joint name="stand" type="fixed" parent_frame="hall" child_link="base"/>
  <something_new value="1 &amp; 2"/>
  <!-- pairs -->
  <disable_collisions link1="jaw_a" link2="jaw_b" reason="Never"/>
  <disable_collisions link1="left" link2="right" reason="Never"/>
  <disable_collisions link1="base" link2="jaw_a" reason="Adjacent"/>
  <disable_collisions link1="lid" link2="pot" reason="Default"/>
  <disable_collisions link1="nut" link2="bolt" reason="Always"/>
  <disable_collisions link1="left" link2="jaw_a" reason="I never drive there"/>
  <disable_collisions link1="gear_b" link2="gear_a" reason="User"/>
  <disable_collisions link1="left" link2="tail" reason="Never"/>
  <link_sphere_approximation link="base"/>
</robot>
)";

} // namespace

void Pairs::SetUp()
{
	Cli::SetUp();
	write( "many.urdf", urdf() );
	write( "many.srdf", srdf );
}

Outcome Pairs::pairs( const std::vector<std::string>& more ) const
{
	std::vector<std::string> arguments = { "pairs", "--robot", "many.urdf", "--budget", "1", "--samples", "200" };
	arguments.insert( arguments.end(), more.begin(), more.end() );
	return run( arguments );
}

nlohmann::json Pairs::entry( const nlohmann::json& list, const std::string& a, const std::string& b )
{
	for ( const nlohmann::json& item : list )
	{
		if ( ( item["link1"] == a && item["link2"] == b ) || ( item["link1"] == b && item["link2"] == a ) )
		{
			return item;
		}
	}
	return nullptr;
}
