// SPDX-License-Identifier: BSD-3-Clause
// URDFs in scenes: placed, opened and shut, always the same shapes.
#include "files.hpp"
#include "seeded_rng.hpp"

#include <cmath>
#include <cstring>

using namespace leeway::io;

namespace
{

const std::string box = "<collision><geometry><box size=\"0.1 0.1 0.1\"/></geometry></collision>";
const std::string limits = "<limit lower=\"-2\" upper=\"2\" effort=\"1\" velocity=\"1\"/>";

/// A cabinet with a door (revolute about z at y = 1; its handle hangs on it) and a drawer along x that a lid mimics.
const std::string cabinet =
    "<robot name=\"cabinet\"><link name=\"body\">" + box +
    "</link><link name=\"door\"><collision><origin xyz=\"1 0 0\"/>"
    "<geometry><box size=\"2 0.02 1\"/></geometry></collision></link><link name=\"handle\">" +
    box + box + "</link><link name=\"drawer\">" + box + "</link><link name=\"lid\">" + box +
    "</link><link name=\"empty\"/>"
    "<joint name=\"hinge\" type=\"revolute\"><origin xyz=\"0 1 0\"/><parent link=\"body\"/><child link=\"door\"/><axis "
    "xyz=\"0 0 1\"/>" +
    limits +
    "</joint><joint name=\"grip\" type=\"fixed\"><origin xyz=\"2 0 0\"/><parent "
    "link=\"door\"/><child link=\"handle\"/></joint><joint name=\"rail\" type=\"prismatic\"><parent link=\"body\"/><child "
    "link=\"drawer\"/><axis xyz=\"1 0 0\"/>" +
    limits +
    "</joint><joint name=\"belt\" type=\"prismatic\"><parent "
    "link=\"body\"/><child link=\"lid\"/><axis xyz=\"0 0 1\"/>" +
    limits +
    "<mimic joint=\"rail\" multiplier=\"0.5\" "
    "offset=\"0.25\"/></joint><joint name=\"none\" type=\"fixed\"><parent link=\"body\"/><child link=\"empty\"/></joint>"
    "</robot>";

class ArticulationTest : public FileTest
{
protected:
	ArticulationTest() { write( "cabinet.urdf", cabinet ); }
	SceneModel load( const std::string& content, const std::string& objects = "" )
	{
		return loadScene( write(
		    "scene.yaml", "world: {collision_objects: [" + objects + "], leeway_articulations: [" + content + "]}\n" ) );
	}
	static const lw_transform& pose( const SceneModel& scene, const std::string& object, std::size_t shape = 0 )
	{
		for ( const SceneObject& candidate : scene.objects )
		{
			if ( candidate.name == object )
			{
				return candidate.shapes.at( shape ).pose;
			}
		}
		throw std::runtime_error( "no object " + object );
	}
	void expectBad( const std::string& content, std::vector<std::string> parts, const std::string& objects = "" )
	{
		parts.push_back( "scene.yaml" );
		expectError( [&] { load( content, objects ); }, parts );
	}
};

const std::string plain = "{id: k, resource: cabinet.urdf}";

} // namespace

TEST_F( ArticulationTest, LinksAreObjectsWhereTheJointsPutThem )
{
	SceneModel scene = load( "{id: k, header: {frame_id: floor}, pose: {position: [10, 0, 0], orientation: [0, 0, 1, 0]}, "
	                         "resource: cabinet.urdf, joint_values: {hinge: 1.5707963267948966, rail: 0.5}}" );
	ASSERT_EQ( scene.objects.size(), 5u );
	for ( const SceneObject& object : scene.objects )
	{
		EXPECT_EQ( object.name.substr( 0, 2 ), "k/" );
		EXPECT_EQ( object.frame, "floor" );
	}
	expectPoint( pose( scene, "k/body" ), 10, 0, 0 );
	expectPoint( pose( scene, "k/door" ), 10, -2, 0 ); // (0, 1) + 1 along y, turned by half a turn
	expectPoint( pose( scene, "k/handle", 1 ), 10, -3, 0 );
	expectPoint( pose( scene, "k/drawer" ), 9.5, 0, 0 );
	expectPoint( pose( scene, "k/lid" ), 10, 0, 0.5 );
	EXPECT_EQ( scene.report.links_without_geometry, std::vector<std::string>{ "k/empty" } );
	EXPECT_EQ( scene.report.shapes.size(), 6u );
	EXPECT_EQ( scene.report.shapes.at( 1 ).owner, "k/door" );
	EXPECT_TRUE( scene.report.notices.empty() ) << allNotices( scene.report.notices );
	ASSERT_EQ( scene.articulations.size(), 1u );
	EXPECT_EQ( scene.articulations[0].objects.back(), "" );
}

TEST_F( ArticulationTest, SetTouchesPosesOnlyAndEqualsAFreshLoad )
{
	SeededRng rng;
	std::string other = "{id: other, resource: cabinet.urdf, joint_values: {rail: 1}}";
	SceneModel first = load( plain + ", " + other ), scene = first;
	double hinge = 0, rail = 0;
	for ( int i = 0; i < 30; ++i )
	{
		std::map<std::string, double> values;
		if ( rng.integer( 0, 1 ) == 0 )
		{
			values["hinge"] = hinge = rng.uniform( -2, 2 );
		}
		if ( rng.integer( 0, 1 ) == 0 )
		{
			values["rail"] = rail = rng.uniform( -2, 2 );
		}
		scene = setArticulation( scene, "k", values );
		char text[200];
		std::snprintf(
		    text, sizeof text, "{id: k, resource: cabinet.urdf, joint_values: {hinge: %.17g, rail: %.17g}}", hinge, rail );
		SceneModel fresh = load( text + ( ", " + other ) );
		ASSERT_EQ( scene.objects.size(), fresh.objects.size() );
		for ( std::size_t k = 0; k < scene.objects.size(); ++k )
		{
			ASSERT_EQ( scene.objects[k].name, fresh.objects[k].name );
			for ( std::size_t j = 0; j < scene.objects[k].shapes.size(); ++j )
			{
				EXPECT_EQ( scene.objects[k].shapes[j].shape.get(), first.objects[k].shapes[j].shape.get() );
				EXPECT_EQ( std::memcmp(
				               &scene.objects[k].shapes[j].pose, &fresh.objects[k].shapes[j].pose, sizeof( lw_transform ) ),
				    0 )
				    << scene.objects[k].name;
			}
		}
	}
	expectPoint( pose( first, "k/drawer" ), 0, 0, 0 );
}

TEST_F( ArticulationTest, SetThatCannotBe )
{
	SceneModel scene = load( plain );
	expectError( [&] { setArticulation( scene, "fridge", {} ); }, { "scene.yaml", "articulation fridge", "use one of k" } );
	expectError(
	    [&] {
		    setArticulation( scene, "k", { { "hing", 1 } } );
	    },
	    { "k", "no movable joint hing", "hinge, rail" } );
	expectError( [&] { setArticulation( scene, "k", { { "belt", 1 } } ); }, { "no movable joint belt" } );
	expectError( [&] { setArticulation( scene, "k", { { "rail", NAN } } ); }, { "rail", "not finite" } );
	scene.objects[1].shapes.clear();
	expectError( [&] { setArticulation( scene, "k", { { "rail", 1 } } ); }, { "k/door", "shapes of its link" } );
}

TEST_F( ArticulationTest, RemovedAndAttachedPartsStaySo )
{
	SceneModel scene = loadScene( write(
	    "scene.yaml", "world: {leeway_articulations: [" + plain +
	                      "]}\nrobot_state: {attached_collision_objects: [{link_name: hand, object: {id: k/drawer}}]}\n" ) );
	ASSERT_EQ( scene.attached.size(), 1u );
	ASSERT_EQ( scene.objects.size(), 4u );
	SceneModel moved = setArticulation( scene, "k", { { "rail", 1 } } );
	EXPECT_EQ( moved.objects.size(), 4u );
	expectPoint( moved.attached.at( 0 ).object.shapes.at( 0 ).pose, 0, 0, 0 );
	expectPoint( pose( moved, "k/lid" ), 0, 0, 0.75 );
}

TEST_F( ArticulationTest, BadEntries )
{
	expectBad( "{id: k, resource: gone.urdf}",
	    { "leeway_articulations[0] k", "URDF gone.urdf was not found", path( "gone.urdf" ) } );
	expectBad( "{id: k, resource: cabinet.urdf, joint_values: {hatch: 1}}", { "no movable joint hatch", "hinge, rail" } );
	expectBad( "{id: k, resource: cabinet.urdf, joint_values: {grip: 1}}", { "no movable joint grip" } );
	expectBad( "{id: k, resource: cabinet.urdf, joint_values: {hinge: .nan}}", { "joint_values.hinge", "not finite" } );
	expectBad( "{id: k, resource: cabinet.urdf, joint_values: [1]}", { "joint_values", "not a map" } );
	expectBad( "{id: k, resource: cabinet.urdf, joints: {hinge: 1}}", { "joints", "not known" } );
	expectBad( "{resource: cabinet.urdf}", { "id", "missing" } );
	expectBad( plain + ", " + plain, { "leeway_articulations[1] k", "before" } );
	expectBad(
	    plain, { "k/door" }, "{id: k/door, pose: {position: [0, 0, 0]}, primitives: [{type: sphere, dimensions: [1]}]}" );
	write( "cabinet.urdf", "<robot name=\"r\"><link name=\"a\"><collision><geometry><mesh filename=\"gone.stl\"/></geometry>"
	                       "</collision></link></robot>" );
	expectError( [&] { load( plain ); }, { "cabinet.urdf", "gone.stl was not found" } );
}

TEST_F( ArticulationTest, ValuesBeyondLimitsAreSaid )
{
	SceneModel scene = load( "{id: k, resource: cabinet.urdf, joint_values: {hinge: 2.5}}" );
	EXPECT_NOTICE( scene.report.notices, "joint hinge is at 2.5, outside of its limits -2 to 2" );
}

TEST_F( ArticulationTest, AUrdfAloneIsAnArticulationToo )
{
	SceneModel scene = loadScene( path( "cabinet.urdf" ) );
	SceneModel moved = setArticulation( scene, "cabinet", { { "rail", 1 } } );
	expectPoint( pose( scene, "drawer" ), 0, 0, 0 );
	expectPoint( pose( moved, "drawer" ), 1, 0, 0 );
}
