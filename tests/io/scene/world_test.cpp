// SPDX-License-Identifier: BSD-3-Clause
// Worlds that change by the ids of their objects, against problems built anew; the names that users get wrong.
#include "files.hpp"

#include "leeway/io/world.hpp"
#include "poses.hpp"
#include "seeded_rng.hpp"

#include <algorithm>
#include <array>
#include <cmath>

using namespace leeway;
using namespace leeway::io;

namespace
{

/// A gantry: slides along x, then y, with a hand below, and two fingers. Or an arm: slides along x, then turns about a skew
/// axis.
class WorldTest : public FileTest
{
protected:
	RobotModel robot( bool turning = false )
	{
		std::string urdf = "<robot name=\"r\"><link name=\"base\"/>";
		for ( const char* name : { "bridge", "hand", "left", "right" } )
		{
			urdf += "<link name=\"" + std::string( name ) +
			        "\"><collision><geometry><box size=\"0.1 0.1 0.1\"/></geometry></collision></link>";
		}
		const auto joint =
		    [&]( const char* name, const char* parent, const char* child, const char* more, const char* type = "prismatic" )
		{
			urdf += "<joint name=\"" + std::string( name ) + "\" type=\"" + type + "\"><parent link=\"" + parent +
			        "\"/><child link=\"" + child + "\"/>" + more +
			        "<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint>";
		};
		joint( "x", "base", "bridge", "<axis xyz=\"1 0 0\"/>" );
		if ( turning )
		{
			joint( "y", "bridge", "hand", "<origin xyz=\"0 0 -0.3\" rpy=\"0 0 1\"/><axis xyz=\"0.6 0 0.8\"/>", "revolute" );
		}
		else
		{
			joint( "y", "bridge", "hand", "<origin xyz=\"0 0 -0.3\"/><axis xyz=\"0 1 0\"/>" );
		}
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
	static lw_state_result ask( const Checker& checker, std::vector<double> q )
	{
		const Query query = makeQuery( checker.get() );
		lw_state_result result;
		EXPECT_EQ( lw_checker_state( checker.get(), query.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &result ), LW_OK );
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

TEST_F( WorldTest, MovedObjectIsWhereItWas )
{
	const SceneModel model = scene();
	ProblemOptions options;
	options.group = "arm";
	options.scene = &model;
	World world( robot(), options );
	const Checker before = world.problem()->checker;
	const Checker after =
	    world.move( "cup", at( 0, 0, -0.45 ) ); // its shape is 5 cm above: top at -0.35, where the hand begins
	EXPECT_NEAR( ask( after, { 0, 0 } ).environment.upper, 0, 1e-9 );
	EXPECT_EQ( obstacle( after, ask( after, { 0, 0 } ) ), "cup" );
	EXPECT_GT( ask( before, { 0, 0 } ).environment.upper, 0.3 );
	EXPECT_EQ( world.problem()->checker.get(), after.get() );
	EXPECT_NEAR( world.problem()->object_poses.at( "cup" ).t[2], -0.45, 1e-12 );
}

TEST_F( WorldTest, AContactThatOptionsAllowIsForgottenByAChange )
{
	const RobotModel model = robot();
	const SceneModel objects = scene();
	ProblemOptions options;
	options.group = "arm";
	options.scene = &objects;
	options.allowed = { { "hand", "cup" }, { "later", "hand" } };
	World world( model, options );
	const auto clearance = [&]( const Checker& checker ) { return ask( checker, { 0, 0 } ).environment.lower; };
	lw_transform at_hand = lw_transform_identity();
	at_hand.t[2] = -0.35;
	EXPECT_GT( clearance( world.move( "cup", at_hand ) ), 0 );
	EXPECT_EQ( clearance( world.move( "jar", at_hand ) ), 0 );
	lw_transform away = at_hand;
	away.t[0] = 5;
	world.move( "jar", away );
	std::vector<PlacedShape> shapes = objects.objects.front().shapes;
	shapes.front().pose = at( 0, 0, 0.05 );
	const Checker later = world.add( "later", shapes, at_hand );
	EXPECT_GT( clearance( later ), 0 );
	EXPECT_EQ( clearance( world.allow( "hand", "later", false ) ), 0 );
}

TEST_F( WorldTest, AttachedObjectStaysBehindOrTouchesItsFingers )
{
	const SceneModel model =
	    scene( "allowed_collision_matrix: {entry_names: [jar, left], entry_values: [[false, true], [true, false]]}" );
	ProblemOptions options;
	options.group = "arm";
	options.scene = &model;
	World world( robot(), options );
	const lw_robot* bare = lw_checker_robot( world.problem()->checker.get() );
	world.move( "cup", at( 0.2, 0.1, -0.45 ) ); // right below the left finger at y = 0.1
	const Checker held = world.attach( "cup", "hand", { "left" }, { 0, 0.1 } );
	EXPECT_EQ( lw_scene_object_count( lw_checker_scene( held.get() ) ), 1u );
	EXPECT_TRUE( lw_robot_is_attached(
	    lw_checker_robot( held.get() ), lw_robot_find_link( lw_checker_robot( held.get() ), "cup" ) ) );
	// right above the jar, whose top is 5 cm below the cup
	const lw_state_result over = ask( held, { -0.7, 0.5 } );
	EXPECT_NEAR( over.environment.upper, 0.05, 1e-9 );
	EXPECT_STREQ( lw_robot_link_name( lw_checker_robot( held.get() ), over.environment.a ), "cup" );
	EXPECT_GT( ask( held, { 0, 0.1 } ).self.upper, 0 ); // the finger that touches it does not count
	const Checker down = world.detach( "cup", { 0.4, -0.3 } );
	EXPECT_NEAR( world.problem()->object_poses.at( "cup" ).t[0], 0.6, 1e-12 );
	EXPECT_NEAR( world.problem()->object_poses.at( "cup" ).t[1], -0.3, 1e-12 );
	EXPECT_EQ( obstacle( down, ask( down, { 0.4, -0.3 } ) ), "cup" );
	EXPECT_EQ( lw_checker_robot( down.get() ), bare );
	// the matrix holds for the name whenever there is such an object
	world.remove( "jar" );
	const Shape box = model.objects[1].shapes[0].shape;
	const Checker jar = world.add( "jar", { { box, lw_transform_identity() } }, at( 0.2, 0, -0.35 ) );
	EXPECT_GT( ask( jar, { 0, 0 } ).environment.upper, 0 ) << "left finger and jar are allowed to touch";
	EXPECT_EQ( ask( world.allow( "left", "jar", false ), { 0, 0 } ).verdict, LW_VERDICT_BLOCKED );
	EXPECT_NE( ask( world.allow( "left", "jar", true ), { 0, 0 } ).verdict, LW_VERDICT_BLOCKED );
}

TEST_F( WorldTest, MarginIsLostByAChange )
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

TEST_F( WorldTest, NamesThatAreWrong )
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

lw_transform product( const lw_transform& a, const lw_transform& b )
{
	return lw_transform_multiply( &a, &b );
}

lw_transform inverse( const lw_transform& a )
{
	return lw_transform_inverse( &a );
}

/// Rotation by an angle about a unit axis (Rodrigues), then a translation.
lw_transform turned( double angle, const std::array<double, 3>& axis, const std::array<double, 3>& shift )
{
	lw_transform result = lw_transform_identity();
	const double cross[3][3] = { { 0, -axis[2], axis[1] }, { axis[2], 0, -axis[0] }, { -axis[1], axis[0], 0 } };
	for ( std::size_t i = 0; i < 3; ++i )
	{
		for ( std::size_t k = 0; k < 3; ++k )
		{
			result.r[i][k] = ( i == k ? std::cos( angle ) : 0 ) + std::sin( angle ) * cross[i][k] +
			                 ( 1 - std::cos( angle ) ) * axis[i] * axis[k];
		}
		result.t[i] = shift[i];
	}
	return result;
}

/// Forward kinematics of the turning robot's hand, by hand.
lw_transform worldFromHand( const std::vector<double>& q )
{
	return product( turned( 1, { 0, 0, 1 }, { q[0], 0, -0.3 } ), turned( q[1], { 0.6, 0, 0.8 }, { 0, 0, 0 } ) );
}

/// Random changes by name to a world whose hand turns and whose objects are rotated; beside it the scene as it has to be,
/// whose poses are composed here.
class ChangedByName
{
public:
	ChangedByName( SceneModel model, const RobotModel& robot, ProblemOptions options )
	    : m_rng( 20261128 ), m_now( std::move( model ) ), m_options( std::move( options ) ), m_robot( robot ),
	      m_world( robot, m_options ), m_box( m_now.objects[0].shapes[0].shape )
	{
	}

	Checker change()
	{
		switch ( m_now.objects.empty() ? 0 : m_rng.integer( 0, 4 ) )
		{
		case 0:
			return add();
		case 1:
			return m_world.remove( take().name );
		case 2:
			return m_now.attached.size() < 3 ? attach() : move();
		case 3:
			return m_now.attached.empty() ? move() : detach();
		default:
			return move();
		}
	}
	Problem fresh()
	{
		m_options.scene = &m_now;
		return buildProblem( m_robot, m_options );
	}
	std::vector<double> state() { return { m_rng.uniform( -1, 1 ), m_rng.uniform( -1, 1 ) }; }
	bool holdsSomething() const { return !m_now.attached.empty(); }

private:
	std::size_t any()
	{
		return static_cast<std::size_t>( m_rng.integer( 0, static_cast<int>( m_now.objects.size() ) - 1 ) );
	}
	SceneObject take()
	{
		const std::size_t k = any();
		SceneObject object = m_now.objects[k];
		m_now.objects.erase( m_now.objects.begin() + static_cast<std::ptrdiff_t>( k ) );
		return object;
	}
	lw_transform pose()
	{
		lw_transform result = lw_transform_identity();
		double xyzw[4];
		m_rng.quaternion( xyzw );
		const double shift[3] = { m_rng.uniform( -0.8, 0.8 ), m_rng.uniform( -0.8, 0.8 ), m_rng.uniform( -0.7, 0 ) };
		const double half = std::acos( std::max( -1.0, std::min( 1.0, xyzw[3] ) ) ), s = std::sin( half );
		if ( s > 1e-6 )
		{
			result = turned( 2 * half, { xyzw[0] / s, xyzw[1] / s, xyzw[2] / s }, { shift[0], shift[1], shift[2] } );
		}
		return result;
	}
	/// The shape of an object of the file is 5 cm above the object's origin.
	static lw_transform objectFromShape( const std::string& name )
	{
		return turned( 0, { 0, 0, 1 }, { 0, 0, name == "cup" || name == "jar" ? 0.05 : 0 } );
	}

	Checker add()
	{
		const lw_transform at = pose();
		m_now.objects.push_back( { "o" + std::to_string( m_made++ ), "", { { m_box, at } }, at } );
		return m_world.add( m_now.objects.back().name, { { m_box, lw_transform_identity() } }, at );
	}
	Checker move()
	{
		SceneObject& object = m_now.objects[any()];
		object.shapes[0].pose = pose();
		object.pose = product( object.shapes[0].pose, inverse( objectFromShape( object.name ) ) );
		return m_world.move( object.name, object.pose );
	}
	Checker attach()
	{
		SceneObject object = take();
		object.frame = "";
		const bool where_it_is = m_rng.integer( 0, 1 ) == 0;
		const std::vector<double> q = state();
		const lw_transform link_from_object = where_it_is ? product( inverse( worldFromHand( q ) ), object.pose ) : pose();
		object.shapes[0].pose = product( link_from_object, objectFromShape( object.name ) );
		object.pose = link_from_object;
		m_now.attached.push_back( { object, "hand", { "left", "right" } } );
		return where_it_is ? m_world.attach( object.name, "hand", { "left", "right" }, q )
		                   : m_world.attachAt( object.name, "hand", { "left", "right" }, link_from_object );
	}
	Checker detach()
	{
		SceneObject object = m_now.attached[0].object;
		m_now.attached.erase( m_now.attached.begin() );
		const std::vector<double> q = state();
		object.pose = product( worldFromHand( q ), object.pose );
		object.shapes[0].pose = product( object.pose, objectFromShape( object.name ) );
		m_now.objects.push_back( object );
		Checker checker = m_world.detach( object.name, q );
		const lw_transform& is = m_world.problem()->object_poses.at( object.name );
		for ( std::size_t i = 0; i < 3; ++i )
		{
			EXPECT_NEAR( is.t[i], object.pose.t[i], 1e-9 ) << object.name;
			EXPECT_NEAR( is.r[i][0], object.pose.r[i][0], 1e-9 ) << object.name;
		}
		return checker;
	}

	SeededRng m_rng;
	SceneModel m_now;
	ProblemOptions m_options;
	const RobotModel& m_robot;
	World m_world;
	Shape m_box;
	int m_made = 0;
};

TEST_F( WorldTest, ChangesDifferFromAProblemBuiltAnew )
{
	const SceneModel model = scene();
	const RobotModel r = robot( true );
	ProblemOptions options;
	options.group = "arm";
	options.scene = &model;
	ChangedByName changed( model, r, options );
	int blocked = 0, with_attached = 0;
	for ( int i = 0; i < 300 || ( i < 3000 && blocked <= 20 ); ++i )
	{
		const Checker checker = changed.change();
		const Problem fresh = changed.fresh();
		const std::vector<double> q = changed.state();
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
		with_attached += changed.holdsSomething();
	}
	EXPECT_GT( blocked, 20 );
	EXPECT_GT( with_attached, 50 );
}

} // namespace
