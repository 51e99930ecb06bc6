// SPDX-License-Identifier: BSD-3-Clause
// Worlds that change by the ids of their objects, against problems built anew; the names that users get wrong.
#include "files.hpp"

#include "leeway/io/world.hpp"
#include "seeded_rng.hpp"

#include <cmath>

using namespace leeway;
using namespace leeway::io;

namespace
{

/// A gantry: slides along x, then y, with a hand below, and two fingers.
class WorldTest : public FileTest
{
protected:
	RobotModel robot()
	{
		std::string urdf = "<robot name=\"r\"><link name=\"base\"/>";
		for ( const char* name : { "bridge", "hand", "left", "right" } )
		{
			urdf += "<link name=\"" + std::string( name ) +
			        "\"><collision><geometry><box size=\"0.1 0.1 0.1\"/></geometry></collision></link>";
		}
		const auto joint = [&]( const char* name, const char* parent, const char* child, const char* more )
		{
			urdf += "<joint name=\"" + std::string( name ) + "\" type=\"prismatic\"><parent link=\"" + parent + "\"/><child link=\"" +
			        child + "\"/>" + more + "<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint>";
		};
		joint( "x", "base", "bridge", "<axis xyz=\"1 0 0\"/>" );
		joint( "y", "bridge", "hand", "<origin xyz=\"0 0 -0.3\"/><axis xyz=\"0 1 0\"/>" );
		joint( "l", "hand", "left", "<origin xyz=\"0.2 0 0\"/><axis xyz=\"1 0 0\"/>" );
		joint( "r", "hand", "right", "<origin xyz=\"-0.2 0 0\"/><axis xyz=\"1 0 0\"/>" );
		write( "r.urdf", urdf + "</robot>" );
		write( "r.srdf", "<robot name=\"r\"><group name=\"arm\"><joint name=\"x\"/><joint name=\"y\"/></group></robot>" );
		return loadRobot( path( "r.urdf" ), path( "r.srdf" ) );
	}

	SceneModel scene( const std::string& more = "" )
	{
		return loadScene( write( "scene.yaml", "world: {collision_objects: [" + object( "cup", "0.5, 0.5, -0.6" ) + ", " +
		                                           object( "jar", "-0.5, 0.5, -0.6" ) + "]}\n" + more ) );
	}
	static std::string object( const std::string& id, const std::string& position )
	{
		return "{id: " + id + ", pose: {position: [" + position +
		       "], orientation: [0, 0, 0, 1]}, primitives: [{type: box, dimensions: [0.1, 0.1, 0.1]}], "
		       "primitive_poses: [{position: [0, 0, 0.05], orientation: [0, 0, 0, 1]}]}";
	}
	static lw_transform at( double x, double y, double z )
	{
		lw_transform pose = lw_transform_identity();
		pose.t[0] = x;
		pose.t[1] = y;
		pose.t[2] = z;
		return pose;
	}
	static lw_state_result ask( const Checker& checker, std::vector<double> q )
	{
		const Query query = makeQuery( checker.get() );
		lw_state_result result;
		EXPECT_EQ( lw_checker_state( checker.get(), query.get(), q.data(), LW_WHAT_BOTH, nullptr, false, &result ), LW_OK );
		return result;
	}
	static std::string obstacle( const Checker& checker, const lw_state_result& result )
	{
		return lw_scene_object_name( lw_checker_scene( checker.get() ), result.environment.b );
	}
	template <typename Change> static std::string refusal( Change change )
	{
		try
		{
			change();
		}
		catch ( const Error& error )
		{
			return error.what();
		}
		ADD_FAILURE() << "nothing was refused";
		return "";
	}
};

TEST_F( WorldTest, moved_object_is_where_it_was )
{
	const SceneModel model = scene();
	ProblemOptions options;
	options.group = "arm";
	options.scene = &model;
	World world( robot(), options );
	const Checker before = world.problem()->checker;
	const Checker after = world.move( "cup", at( 0, 0, -0.45 ) ); // its shape is 5 cm above: top at -0.35, where the hand begins
	EXPECT_NEAR( ask( after, { 0, 0 } ).environment.upper, 0, 1e-9 );
	EXPECT_EQ( obstacle( after, ask( after, { 0, 0 } ) ), "cup" );
	EXPECT_GT( ask( before, { 0, 0 } ).environment.upper, 0.3 );
	EXPECT_EQ( world.problem()->checker.get(), after.get() );
	EXPECT_NEAR( world.problem()->object_poses.at( "cup" ).t[2], -0.45, 1e-12 );
}

TEST_F( WorldTest, attached_object_stays_behind_or_touches_its_fingers )
{
	const SceneModel model = scene( "allowed_collision_matrix: {entry_names: [jar, left], entry_values: [[false, true], [true, false]]}" );
	ProblemOptions options;
	options.group = "arm";
	options.scene = &model;
	World world( robot(), options );
	world.move( "cup", at( 0.2, 0.1, -0.45 ) ); // right below the left finger at y = 0.1
	const Checker held = world.attach( "cup", "hand", { "left" }, { 0, 0.1 } );
	EXPECT_EQ( lw_scene_object_count( lw_checker_scene( held.get() ) ), 1u );
	EXPECT_TRUE( lw_robot_is_attached( lw_checker_robot( held.get() ),
	    lw_robot_find_link( lw_checker_robot( held.get() ), "cup" ) ) );
	// right above the jar, whose top is 5 cm below the cup
	const lw_state_result over = ask( held, { -0.7, 0.5 } );
	EXPECT_NEAR( over.environment.upper, 0.05, 1e-9 );
	EXPECT_STREQ( lw_robot_link_name( lw_checker_robot( held.get() ), over.environment.a ), "cup" );
	EXPECT_GT( ask( held, { 0, 0.1 } ).self.upper, 0 ); // the finger that touches it does not count
	const Checker down = world.detach( "cup", { 0.4, -0.3 } );
	EXPECT_NEAR( world.problem()->object_poses.at( "cup" ).t[0], 0.6, 1e-12 );
	EXPECT_NEAR( world.problem()->object_poses.at( "cup" ).t[1], -0.3, 1e-12 );
	EXPECT_EQ( obstacle( down, ask( down, { 0.4, -0.3 } ) ), "cup" );
	EXPECT_EQ( lw_checker_robot( down.get() ), lw_robot_bare( lw_checker_robot( held.get() ) ) );
	// the matrix holds for the name whenever there is such an object
	world.remove( "jar" );
	const Shape box = model.objects[1].shapes[0].shape;
	const Checker jar = world.add( "jar", { { box, lw_transform_identity() } }, at( 0.2, 0, -0.35 ) );
	EXPECT_GT( ask( jar, { 0, 0 } ).environment.upper, 0 ) << "left finger and jar are allowed to touch";
	EXPECT_EQ( ask( world.allow( "left", "jar", false ), { 0, 0 } ).verdict, LW_VERDICT_BLOCKED );
	EXPECT_NE( ask( world.allow( "left", "jar", true ), { 0, 0 } ).verdict, LW_VERDICT_BLOCKED );
}

TEST_F( WorldTest, margin_is_lost_by_a_change )
{
	const SceneModel model = scene();
	ProblemOptions options;
	options.group = "arm";
	options.scene = &model;
	options.margins.objects["cup"] = 0.02;
	World world( robot(), options );
	const double far = ask( world.move( "cup", at( 0, 0, -0.55 ) ), { 0, 0 } ).environment.upper;
	EXPECT_NEAR( far, 0.08, 1e-9 );
	world.attach( "cup", "hand", {} );
	EXPECT_NEAR( ask( world.detach( "cup" ), { 0, 0 } ).environment.upper, 0.08, 1e-9 );
	Margins margins;
	margins.environment = 0.03;
	EXPECT_NEAR( ask( world.setMargins( margins ), { 0, 0 } ).environment.upper, 0.07, 1e-9 );
	EXPECT_NEAR( ask( world.remove( "jar" ), { 0, 0 } ).environment.upper, 0.07, 1e-9 );
	margins.objects["teapot"] = 0.01;
	EXPECT_NE( refusal( [&] { world.setMargins( margins ); } ).find( "teapot" ), std::string::npos );
	EXPECT_NEAR( ask( world.problem()->checker, { 0, 0 } ).environment.upper, 0.07, 1e-9 );
}

TEST_F( WorldTest, names_that_are_wrong )
{
	const SceneModel model = scene();
	ProblemOptions options;
	options.group = "arm";
	options.scene = &model;
	World world( robot(), options );
	const Checker before = world.problem()->checker;
	const Shape box = model.objects[0].shapes[0].shape;
	const auto has = [&]( const std::string& text, const std::string& part )
	{ EXPECT_NE( text.find( part ), std::string::npos ) << text; };
	has( refusal( [&] { world.move( "teapot", at( 0, 0, 0 ) ); } ), "object teapot: there is no such object" );
	has( refusal( [&] { world.attach( "cup", "thumb", {} ); } ), "has no link thumb" );
	has( refusal( [&] { world.attach( "cup", "hand", { "left", "thumb" } ); } ), "has no link thumb" );
	has( refusal( [&] { world.attach( "cup", "hand", {}, { 0, 0, 0 } ); } ), "has 3 values instead of 2" );
	has( refusal( [&] { world.detach( "cup" ); } ), "is not attached" );
	has( refusal( [&] { world.add( "cup", { { box, at( 0, 0, 0 ) } }, at( 0, 0, 0 ) ); } ), "has this name already" );
	has( refusal( [&] { world.add( "hand", { { box, at( 0, 0, 0 ) } }, at( 0, 0, 0 ) ); } ), "has this name already" );
	lw_transform bad = at( 0, NAN, 0 );
	has( refusal( [&] { world.move( "cup", bad ); } ), "not finite or not a rotation" );
	has( refusal( [&] { world.attachAt( "cup", "hand", {}, bad ); } ), "not a rigid transform" );
	has( refusal( [&] { world.allow( "thumb", "cup", true ); } ), "has no link thumb" );
	EXPECT_EQ( world.problem()->checker.get(), before.get() ) << "a refused change changed something";
	world.attach( "cup", "hand", {} );
	has( refusal( [&] { world.attach( "cup", "hand", {} ); } ), "is attached to link hand already" );
	has( refusal( [&] { world.move( "cup", at( 0, 0, 0 ) ); } ), "detach it before it is moved" );
}

/// Many changes by name, each against a problem of a scene that was built so.
TEST_F( WorldTest, changes_differ_from_a_problem_built_anew )
{
	SeededRng rng( 20261128 );
	SceneModel model = scene();
	ProblemOptions options;
	options.group = "arm";
	options.scene = &model;
	const RobotModel r = robot();
	World world( r, options );
	const Shape box = model.objects[0].shapes[0].shape;
	SceneModel now = model;
	int blocked = 0, with_attached = 0;
	for ( int i = 0; i < 300 || ( i < 3000 && blocked <= 20 ); ++i )
	{
		const lw_transform pose = at( rng.uniform( -0.8, 0.8 ), rng.uniform( -0.8, 0.8 ), rng.uniform( -0.7, 0 ) );
		const int kind = rng.integer( 0, 4 );
		const auto take = [&]( std::size_t k )
		{
			SceneObject object = now.objects[k];
			now.objects.erase( now.objects.begin() + static_cast<std::ptrdiff_t>( k ) );
			return object;
		};
		const std::size_t any =
		    now.objects.empty() ? 0 : static_cast<std::size_t>( rng.integer( 0, static_cast<int>( now.objects.size() ) - 1 ) );
		Checker checker;
		if ( kind == 0 || now.objects.empty() )
		{
			now.objects.push_back( { "o" + std::to_string( i ), "", { { box, pose } }, pose } );
			checker = world.add( now.objects.back().name, { { box, lw_transform_identity() } }, pose );
		}
		else if ( kind == 1 )
		{
			checker = world.remove( take( any ).name );
		}
		else if ( kind == 2 && now.attached.size() < 3 )
		{
			SceneObject object = take( any );
			object.frame = "";
			object.shapes[0].pose = pose;
			lw_transform in_object = lw_transform_inverse( &object.pose );
			in_object = lw_transform_multiply( &in_object, &pose );
			now.attached.push_back( { object, "hand", { "left", "right" } } );
			// the shape's pose in the object's frame differs between the two kinds of objects here
			const bool from_file = object.name == "cup" || object.name == "jar";
			checker = world.attachAt( object.name, "hand", { "left", "right" },
			    from_file ? at( pose.t[0], pose.t[1], pose.t[2] - 0.05 ) : pose );
		}
		else if ( kind == 3 && !now.attached.empty() )
		{
			SceneObject object = now.attached[0].object;
			now.attached.erase( now.attached.begin() );
			checker = world.detach( object.name );
			const lw_transform object_pose = world.problem()->object_poses.at( object.name );
			object.shapes[0].pose = lw_scene_shape( lw_checker_scene( checker.get() ),
			    lw_scene_shape_count( lw_checker_scene( checker.get() ) ) - 1 ).world_from_shape;
			object.pose = object_pose;
			now.objects.push_back( object );
		}
		else
		{
			const bool from_file = now.objects[any].name == "cup" || now.objects[any].name == "jar";
			now.objects[any].shapes[0].pose = pose;
			checker = world.move( now.objects[any].name, from_file ? at( pose.t[0], pose.t[1], pose.t[2] - 0.05 ) : pose );
		}
		options.scene = &now;
		const Problem fresh = buildProblem( r, options );
		const std::vector<double> q = { rng.uniform( -1, 1 ), rng.uniform( -1, 1 ) };
		const lw_state_result x = ask( checker, q ), y = ask( fresh.checker, q );
		EXPECT_EQ( x.verdict, y.verdict ) << i;
		if ( x.environment.kind == LW_CLEARANCE_NEAR )
		{
			EXPECT_NEAR( x.environment.upper, y.environment.upper, 1e-9 ) << i;
		}
		if ( x.self.kind == LW_CLEARANCE_NEAR )
		{
			EXPECT_NEAR( x.self.upper, y.self.upper, 1e-9 ) << i;
		}
		blocked += x.verdict == LW_VERDICT_BLOCKED;
		with_attached += !now.attached.empty();
	}
	EXPECT_GT( blocked, 20 );
	EXPECT_GT( with_attached, 50 );
}

} // namespace
