// SPDX-License-Identifier: BSD-3-Clause
// Margins from files: by name to the right pairs, padding the same as margins that say so, and margins that make no sense.
#include "files.hpp"
#include "leeway/handles.hpp"
#include "same_bits.hpp"
#include "seeded_rng.hpp"

#include <cmath>

using namespace leeway::io;

namespace
{

class MarginsTest : public FileTest
{
protected:
	MarginsTest()
	{
		const auto link = []( const std::string& name ) {
			return "<link name=\"" + name +
			       "\"><collision><geometry><box size=\"0.1 0.1 0.1\"/></geometry></collision></link>";
		};
		std::string urdf = "<robot name=\"r\">" + link( "base" ) + link( "arm" ) + link( "hand" );
		std::string last = "base";
		for ( std::string name : { "arm", "hand" } )
		{
			urdf += "<joint name=\"to_" + name +
			        "\" type=\"prismatic\"><origin xyz=\"0.5 0 0\"/><axis xyz=\"1 0 0\"/><parent link=\"" + last +
			        "\"/><child link=\"" + name +
			        "\"/><limit lower=\"-0.3\" upper=\"0.3\" effort=\"1\" velocity=\"1\"/></joint>";
			last = name;
		}
		m_robot = loadRobot( write( "r.urdf", urdf + "</robot>" ), "" );
		m_scene = loadScene( write( "scene.yaml", scene_text ) );
	}
	Margins margins( const std::string& text ) { return loadMargins( write( "margins.yaml", text ) ); }
	Problem build( const Margins& margins = {}, const Padding& padding = {} )
	{
		ProblemOptions options;
		options.scene = &m_scene;
		options.margins = margins;
		options.padding = padding;
		return buildProblem( m_robot, options );
	}
	static double toObject( const Problem& problem, const char* link, const char* object )
	{
		return lw_checker_environment_margin( problem.checker.get(), lw_robot_find_link( problem.robot.get(), link ),
		    lw_scene_find_object( problem.scene.get(), object ) );
	}
	static double ofLinks( const Problem& problem, const char* a, const char* b )
	{
		return lw_checker_self_margin( problem.checker.get(), lw_robot_find_link( problem.robot.get(), a ),
		    lw_robot_find_link( problem.robot.get(), b ) );
	}

	const std::string box = "primitives: [{type: box, dimensions: [0.1, 0.1, 0.1]}], primitive_poses: [{position: ";
	const std::string scene_text =
	    "world: {collision_objects: [{id: table, header: {frame_id: base}, " + box +
	    "[1.6, 0, 0]}]}, {id: person, header: {frame_id: base}, " + box +
	    "[0.5, 1.5, 0]}]}]}\n"
	    "robot_state: {attached_collision_objects: [{link_name: hand, touch_links: [hand], object: {id: "
	    "cup, header: {frame_id: hand}, " +
	    box + "[0.1, 0, 0]}]}}]}\n";
	RobotModel m_robot;
	SceneModel m_scene;
};

} // namespace

TEST_F( MarginsTest, PartsAddUpAndPairsStandAlone )
{
	const Problem problem =
	    build( margins( "environment: 0.01\nself: 0.002\nlinks: {hand: 0.03, cup: 0.005}\n"
	                    "self_links: {arm: 0.001}\nobjects: {person: 0.4}\n"
	                    "pairs:\n  - [hand, table, 0]\n  - [person, arm, 0.5]\n  - [cup, base, 0.07]\n" ) );
	EXPECT_TRUE( problem.notices.empty() ) << allNotices( problem.notices );
	EXPECT_EQ( toObject( problem, "hand", "person" ), 0.01 + 0.03 + 0.4 );
	EXPECT_EQ( toObject( problem, "cup", "person" ), 0.01 + 0.005 + 0.4 );
	EXPECT_EQ( toObject( problem, "base", "table" ), 0.01 );
	EXPECT_EQ( toObject( problem, "hand", "table" ), 0 );
	EXPECT_EQ( toObject( problem, "arm", "person" ), 0.5 );
	EXPECT_EQ( ofLinks( problem, "base", "hand" ), 0.002 );
	EXPECT_EQ( ofLinks( problem, "hand", "arm" ), 0.002 + 0.001 );
	EXPECT_EQ( ofLinks( problem, "base", "cup" ), 0.07 );
	// The cup ends at x = 1.15, the table begins at 1.55; the hand may touch it, and of the way to the person 0.5 m do not
	// count
	lw_state_result state;
	const leeway::Query query = leeway::makeQuery( problem.checker.get() );
	const double q[2] = { 0, 0 };
	ASSERT_EQ(
	    lw_checker_state( problem.checker.get(), query.get(), q, LW_CHECK_ENVIRONMENT, nullptr, false, &state ), LW_OK );
	EXPECT_STREQ( lw_robot_link_name( problem.robot.get(), state.environment.a ), "cup" );
	EXPECT_NEAR( state.environment.upper, 0.4 - 0.01 - 0.005, 1e-12 );
}

TEST_F( MarginsTest, PaddingIsTheMarginThatSaysTheSame )
{
	m_scene = loadScene( write( "padded.yaml", scene_text + "link_padding: [{link_name: arm, padding: 0.04}]\n" ) );
	const Padding padding = loadPadding( write( "parameters.yaml",
	    "default_robot_padding: 0.01\ndefault_object_padding: 0.02\ndefault_attached_padding: 0.015\n"
	    "default_robot_link_padding: {hand: 0.03, arm: 0.5}\n" ) );
	const Problem padded = build( {}, padding );
	EXPECT_EQ( allNotices( padded.notices ).find( "adding" ), std::string::npos );
	m_scene = loadScene( write( "bare.yaml", scene_text ) );
	const Problem explicit_one =
	    build( margins( "links: {base: 0.01, arm: 0.04, hand: 0.03, cup: 0.015}\nobjects: {table: 0.02, person: 0.02}\n" ) );
	const leeway::Query one = leeway::makeQuery( padded.checker.get() ),
	                    other = leeway::makeQuery( explicit_one.checker.get() );
	SeededRng rng;
	int near = 0;
	for ( int i = 0; i < 200; ++i )
	{
		const double q[2] = { rng.uniform( -0.3, 0.3 ), rng.uniform( -0.3, 0.3 ) };
		lw_state_result a, b;
		ASSERT_EQ( lw_checker_state( padded.checker.get(), one.get(), q, LW_CHECK_BOTH, nullptr, false, &a ), LW_OK );
		ASSERT_EQ(
		    lw_checker_state( explicit_one.checker.get(), other.get(), q, LW_CHECK_BOTH, nullptr, false, &b ), LW_OK );
		EXPECT_EQ( a.verdict, b.verdict );
		EXPECT_TRUE( sameBits( a.environment, b.environment ) );
		EXPECT_TRUE( sameBits( a.self, b.self ) );
		near += a.environment.upper < 0.1;
	}
	EXPECT_GE( near, 20 );
	EXPECT_EQ( toObject( padded, "hand", "table" ), 0.03 + 0.02 );
	EXPECT_EQ( ofLinks( padded, "hand", "base" ), 0 ) << "MoveIt checks a robot against itself without padding";
	EXPECT_NE( toObject( build(), "hand", "table" ), toObject( padded, "hand", "table" ) );
}

TEST_F( MarginsTest, PaddingAndMarginsAddUpButNotForListedPairs )
{
	Padding padding;
	padding.link_padding["hand"] = 0.03;
	const Problem problem = build( margins( "links: {hand: 0.01}\npairs: [[hand, table, 0.004]]\n" ), padding );
	EXPECT_EQ( toObject( problem, "hand", "person" ), 0.03 + 0.01 );
	EXPECT_EQ( toObject( problem, "hand", "table" ), 0.004 );
}

TEST_F( MarginsTest, ValuesThatMakeNoSense )
{
	const auto bad = [&]( const std::string& text, std::vector<std::string> parts )
	{
		parts.push_back( "margins.yaml" );
		expectError( [&] { build( margins( text ) ); }, parts );
	};
	bad( "environment: -0.01\n", { "environment", "-0.01 is no margin" } );
	bad( "self: .inf\n", { "self", "not finite" } );
	bad( "link: {hand: 0.1}\n", { "link", "is links meant?" } );
	bad( "forearm: 0.1\n", { "forearm", "self_links" } );
	bad( "links: [0.1]\n", { "links", "not a map" } );
	bad( "links: {hand: -1}\n", { "links.hand", "-1 is no margin" } );
	bad( "links: {hnad: 0.1}\n", { "links.hnad", "no link hnad" } );
	bad( "self_links: {person: 0.1}\n", { "self_links.person", "no link person" } );
	bad( "objects: {hand: 0.1}\n", { "objects.hand", "no object hand" } );
	bad( "pairs: [[hand, table]]\n", { "pairs[0]", "is no pair" } );
	bad( "pairs: {hand: 0.1}\n", { "pairs" } );
	bad( "pairs: [[hand, table, x]]\n", { "pairs[0]", "not a number" } );
	bad( "pairs: [[hand, table, -0.1]]\n", { "pairs[0]", "-0.1 is no margin" } );
	bad( "pairs: [[hand, table, 0.1], [table, hand, 0.2]]\n", { "pairs[1]", "there twice" } );
	bad( "pairs: [[hand, chair, 0]]\n", { "pairs [hand, chair]", "chair is neither a link nor an object" } );
	bad( "pairs: [[person, table, 0.1]]\n", { "pairs [person, table]", "two objects" } );
	bad( "pairs: [[hand, hand, 0.1]]\n", { "pairs [hand, hand]", "itself" } );
	expectError( [&] { loadMargins( path( "none.yaml" ) ); }, { "none.yaml", "no such file" } );

	Margins by_program;
	by_program.links["hand"] = NAN;
	expectError( [&] { build( by_program ); }, { "links.hand", "no margin" } );
	by_program.links.clear();
	by_program.environment = -1;
	expectError( [&] { build( by_program ); }, { "environment", "-1 is no margin" } );
	EXPECT_NO_THROW( build( margins( "links: {someone: 0}\nobjects: {something: 0}\n" ) ) ) << "these change nothing";
	EXPECT_NOTICE( build( margins( "pairs: [[cup, hand, 0.1]]\n" ) ).notices, "in vain: cup - hand" );

	std::string both = scene_text;
	both.replace( both.find( "id: person" ), 10, "id: arm" );
	m_scene = loadScene( write( "both.yaml", both ) );
	bad( "pairs: [[hand, arm, 0.1]]\n", { "pairs [hand, arm]", "a link and an object too" } );
}
