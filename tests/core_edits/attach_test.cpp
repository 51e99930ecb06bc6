// SPDX-License-Identifier: BSD-3-Clause
// Robots with objects in their hands: equal to those of a longer def, and calls that cannot attach or detach.
#include "changing_world.hpp"

#include "leeway/blob.h"
#include "robot/robot.h"

#include <gtest/gtest.h>

namespace
{

TEST( Attach, RobotDiffersFromOneOfALongerDef )
{
	SeededRng rng( 20261126 );
	int compared = 0, several = 0;
	for ( int k = 0; k < 40; ++k )
	{
		ChangingWorld world( rng, false );
		for ( int i = 0; i < 30; ++i )
		{
			world.change( rng );
			const leeway::Robot other = world.robotFromNothing();
			const lw_robot *a = world.robot.get(), *b = other.get();
			ASSERT_TRUE( lw_digest_equal( lw_robot_digest( a ), lw_robot_digest( b ) ) );
			ASSERT_EQ( lw_robot_link_count( a ), lw_robot_link_count( b ) );
			for ( std::uint32_t link = 0; link < lw_robot_link_count( a ); ++link )
			{
				EXPECT_STREQ( lw_robot_link_name( a, link ), lw_robot_link_name( b, link ) );
				EXPECT_EQ( lw_robot_link_joint( a, link ), lw_robot_link_joint( b, link ) );
				EXPECT_EQ( lw_robot_is_attached( a, link ), link >= lw_robot_link_count( world.bare.get() ) );
				for ( std::uint32_t m = 0; m < link; ++m )
				{
					EXPECT_EQ( lw_robot_pair_allowed( a, link, m ), lw_robot_pair_allowed( b, link, m ) );
				}
			}
			for ( std::uint32_t joint = 0; joint < lw_robot_joint_count( a ); ++joint )
			{
				EXPECT_STREQ( lw_robot_joint_name( a, joint ), lw_robot_joint_name( b, joint ) );
			}
			std::vector<lw_transform> x( lw_robot_link_count( a ) ), y( x.size() );
			ASSERT_EQ( lw_robot_fk( a, world.reference.data(), x.data() ), LW_OK );
			ASSERT_EQ( lw_robot_fk( b, world.reference.data(), y.data() ), LW_OK );
			EXPECT_EQ( std::memcmp( x.data(), y.data(), x.size() * sizeof( lw_transform ) ), 0 );
			EXPECT_EQ( lwi_robot_bare( a ), world.bare.get() );
			++compared;
			several += world.attached.size() > 1;
		}
	}
	EXPECT_EQ( compared, 1200 );
	EXPECT_GT( several, 100 );
}

class BadAttach : public ::testing::Test
{
protected:
	BadAttach()
	{
		model.link( "base" );
		model.joint( "hand", LW_JOINT_REVOLUTE, 0 );
		robot = leeway::Robot::adopt( model.create().release() );
		const double size[3] = { 0.1, 0.1, 0.1 };
		lw_shape* made = nullptr;
		leeway::require( lw_shape_create_primitive( LW_SHAPE_BOX, size, nullptr, nullptr, &made ), "box" );
		box = leeway::Shape::adopt( made );
		shape = box.get();
		def.name = "cup";
		def.link = 1;
		def.shapes = &shape;
		def.link_from_shape = &pose;
		def.shape_count = 1;
	}

	void expectRefused( const std::string& part )
	{
		lw_robot* out = nullptr;
		lw_diag diag = {};
		EXPECT_EQ( lw_robot_attach( robot.get(), &def, nullptr, &diag, &out ), LW_ERROR_INVALID_ARGUMENT ) << part;
		EXPECT_EQ( out, nullptr );
		EXPECT_NE( std::string( diag.message ).find( part ), std::string::npos ) << diag.message;
	}

	RobotModel model;
	leeway::Robot robot;
	leeway::Shape box;
	const lw_shape* shape = nullptr;
	lw_transform pose = lw_transform_identity();
	lw_attachment_def def = lw_attachment_def_default();
};

TEST_F( BadAttach, LinkThatTheRobotLacks )
{
	def.link = 2;
	expectRefused( "link 2 is not one of the 2 links" );
	def.link = 1;
	const std::uint32_t touch[] = { 0, 5 };
	def.touch_links = touch;
	def.touch_link_count = 2;
	expectRefused( "touch link 5 is not one of the 2 links" );
}

TEST_F( BadAttach, NameThatIsTaken )
{
	def.name = "hand";
	expectRefused( "a link of robot 'test' has this name" );
	def.name = "";
	expectRefused( "needs a name" );
	def.name = "cup";
	lw_robot* out = nullptr;
	ASSERT_EQ( lw_robot_attach( robot.get(), &def, nullptr, nullptr, &out ), LW_OK );
	robot = leeway::Robot::adopt( out );
	expectRefused( "has this name" );
}

TEST_F( BadAttach, ShapeOrPoseThatCannotMove )
{
	pose.t[0] = INFINITY;
	expectRefused( "not a rigid transform" );
	pose = lw_transform_identity();
	shape = nullptr;
	expectRefused( "has no shape" );
	lw_shape* plane = nullptr;
	ASSERT_EQ( lw_shape_create_primitive( LW_SHAPE_PLANE, nullptr, nullptr, nullptr, &plane ), LW_OK );
	shape = plane;
	expectRefused( "half-space or plane" );
	lw_shape_release( plane );
	def.shapes = nullptr;
	expectRefused( "an array is NULL" );
	def = {};
	lw_robot* out = nullptr;
	EXPECT_EQ( lw_robot_attach( robot.get(), &def, nullptr, nullptr, &out ), LW_ERROR_INVALID_DEF );
}

TEST_F( BadAttach, DetachedWithoutBeingAttached )
{
	lw_robot* out = nullptr;
	lw_diag diag = {};
	EXPECT_EQ( lw_robot_detach( robot.get(), "cup", nullptr, &diag, &out ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_NE( std::string( diag.message ).find( "nothing of this name is attached" ), std::string::npos ) << diag.message;
	EXPECT_EQ( lw_robot_detach( robot.get(), "hand", nullptr, &diag, &out ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_NE( std::string( diag.message ).find( "it is a link of" ), std::string::npos ) << diag.message;

	ASSERT_EQ( lw_robot_attach( robot.get(), &def, nullptr, &diag, &out ), LW_OK );
	const leeway::Robot with_cup = leeway::Robot::adopt( out );
	def.name = "spoon";
	def.link = 2; // the cup
	ASSERT_EQ( lw_robot_attach( with_cup.get(), &def, nullptr, &diag, &out ), LW_OK );
	const leeway::Robot with_both = leeway::Robot::adopt( out );
	EXPECT_EQ( lw_robot_detach( with_both.get(), "cup", nullptr, &diag, &out ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_NE( std::string( diag.message ).find( "'spoon' is attached to it" ), std::string::npos ) << diag.message;
	ASSERT_EQ( lw_robot_detach( with_both.get(), "spoon", nullptr, &diag, &out ), LW_OK );
	const leeway::Robot again = leeway::Robot::adopt( out );
	ASSERT_EQ( lw_robot_detach( again.get(), "cup", nullptr, &diag, &out ), LW_OK );
	EXPECT_EQ( out, robot.get() ); // the robot itself
	lw_robot_release( out );
}

} // namespace
