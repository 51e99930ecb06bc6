// SPDX-License-Identifier: BSD-3-Clause
// Objects that move: joints at all times against the pieces of the file, evaluated here once more by other formulas.
#include "world_files.hpp"

#include "seeded_rng.hpp"

#include <array>
#include <cmath>
#include <fmt/format.h>

using namespace leeway::io;

namespace
{

constexpr double pi = 3.14159265358979323846;
const std::string ball = "shapes: [{type: sphere, dimensions: [0.1]}]";

using Vector = std::array<double, 3>;
using Quaternion = std::array<double, 4>; // x, y, z, w

double binomial( unsigned n, unsigned k )
{
	double out = 1;
	for ( unsigned i = 1; i <= k; ++i )
	{
		out *= static_cast<double>( n - k + i ) / i;
	}
	return out;
}

/// Values of a part at a time, by Bernstein's polynomials.
std::map<std::string, double> valuesAt( const WorldPart& part, double time )
{
	const std::size_t count = part.variables.size();
	std::vector<double> values = part.state;
	for ( const TimedPiece& piece : part.pieces )
	{
		const double s = std::fmin( 1, ( time - piece.start ) / ( piece.end - piece.start ) );
		for ( std::size_t v = 0; s >= 0 && v < count; ++v )
		{
			values[v] = 0;
			for ( unsigned k = 0; k <= piece.degree; ++k )
			{
				values[v] += binomial( piece.degree, k ) * std::pow( s, k ) * std::pow( 1 - s, piece.degree - k ) *
				             piece.points[k * count + v];
			}
		}
	}
	std::map<std::string, double> out;
	for ( std::size_t v = 0; v < count; ++v )
	{
		out[part.variables[v]] = values[v];
	}
	return out;
}

lw_transform poseOfQuaternion( const Vector& t, const Quaternion& q )
{
	lw_transform out;
	EXPECT_EQ( lw_transform_from_quaternion( t.data(), q.data(), &out ), LW_OK );
	return out;
}

/// Shoemake's formula.
Quaternion slerp( const Quaternion& a, Quaternion b, double s )
{
	double dot = 0;
	for ( std::size_t i = 0; i < 4; ++i )
	{
		dot += a[i] * b[i];
	}
	const double sign = dot < 0 ? -1 : 1, angle = std::acos( std::fmin( 1, sign * dot ) );
	Quaternion out;
	for ( std::size_t i = 0; i < 4; ++i )
	{
		out[i] = angle < 1e-9
		             ? a[i]
		             : ( std::sin( ( 1 - s ) * angle ) * a[i] + sign * std::sin( s * angle ) * b[i] ) / std::sin( angle );
	}
	return out;
}

Vector bezier( const std::vector<Vector>& points, double s )
{
	Vector out = { 0, 0, 0 };
	const auto n = static_cast<unsigned>( points.size() - 1 );
	for ( unsigned k = 0; k <= n; ++k )
	{
		for ( std::size_t i = 0; i < 3; ++i )
		{
			out[i] += binomial( n, k ) * std::pow( s, k ) * std::pow( 1 - s, n - k ) * points[k][i];
		}
	}
	return out;
}

/// Rodrigues' formula about a line, and a shift along it.
lw_transform screwed( const lw_transform& pose, const Vector& axis, const Vector& point, double angle, double shift )
{
	const double c = std::cos( angle ), s = std::sin( angle );
	lw_transform out = pose;
	const auto rotate = [&]( const Vector& v )
	{
		const double along = axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2];
		const Vector cross = {
		    axis[1] * v[2] - axis[2] * v[1], axis[2] * v[0] - axis[0] * v[2], axis[0] * v[1] - axis[1] * v[0] };
		Vector r;
		for ( std::size_t i = 0; i < 3; ++i )
		{
			r[i] = c * v[i] + s * cross[i] + ( 1 - c ) * along * axis[i];
		}
		return r;
	};
	for ( int k = 0; k < 3; ++k )
	{
		const Vector column = rotate( { pose.r[0][k], pose.r[1][k], pose.r[2][k] } );
		for ( int i = 0; i < 3; ++i )
		{
			out.r[i][k] = column[static_cast<std::size_t>( i )];
		}
	}
	const Vector arm = rotate( { pose.t[0] - point[0], pose.t[1] - point[1], pose.t[2] - point[2] } );
	for ( std::size_t i = 0; i < 3; ++i )
	{
		out.t[i] = point[i] + arm[i] + shift * axis[i];
	}
	return out;
}

std::string text( const Vector& v )
{
	return fmt::format( "[{}, {}, {}]", v[0], v[1], v[2] );
}

std::string text( const Quaternion& q )
{
	return fmt::format( "[{}, {}, {}, {}]", q[0], q[1], q[2], q[3] );
}

Vector randomVector( SeededRng& random )
{
	return { random.uniform( -2, 2 ), random.uniform( -2, 2 ), random.uniform( -2, 2 ) };
}

/// A piece of a motion, evaluated by the formulas above.
class Known
{
public:
	/// A random piece from a pose. @param text of its keys
	Known( SeededRng& random, const Vector& position, const Quaternion& orientation, std::string& keys )
	    : m_from( poseOfQuaternion( position, orientation ) ), m_a( orientation ), m_b( orientation ), m_points{ position }
	{
		const int kind = random.integer( 0, 3 );
		m_screw = kind == 3;
		keys = m_screw ? screw( random ) : curve( random, kind == 0, kind != 1 );
	}
	lw_transform at( double s ) const
	{
		return m_screw ? screwed( m_from, m_axis, m_point, s * m_angle, s * m_shift )
		               : poseOfQuaternion( bezier( m_points, s ), slerp( m_a, m_b, s ) );
	}
	Vector position() const
	{
		const lw_transform end = at( 1 );
		return { end.t[0], end.t[1], end.t[2] };
	}
	Quaternion orientation() const
	{
		const lw_transform end = at( 1 );
		Quaternion q = m_b;
		if ( m_screw )
		{
			lw_transform_to_quaternion( &end, q.data() );
		}
		return q;
	}

private:
	std::string screw( SeededRng& random )
	{
		Quaternion any;
		random.quaternion( any.data() );
		const double size = std::hypot( any[0], any[1], any[2] );
		m_axis = { any[0] / size, any[1] / size, any[2] / size };
		m_point = randomVector( random );
		m_angle = random.uniform( -5, 5 );
		m_shift = random.uniform( -1, 1 );
		return fmt::format(
		    "turn: {{axis: {}, point: {}, angle: {}, shift: {}}}", text( m_axis ), text( m_point ), m_angle, m_shift );
	}
	std::string curve( SeededRng& random, bool straight, bool turns )
	{
		std::string list = text( m_points[0] );
		for ( int k = straight ? 1 : random.integer( 1, 7 ); k > 0; --k )
		{
			m_points.push_back( randomVector( random ) );
			list += ", " + text( m_points.back() );
		}
		if ( turns )
		{
			random.quaternion( m_b.data() );
		}
		return ( turns ? "orientation: " + text( m_b ) + ", " : "" ) +
		       ( straight ? "position: " + text( m_points[1] ) : "points: [" + list + "]" );
	}

	lw_transform m_from;
	Quaternion m_a, m_b;
	std::vector<Vector> m_points;
	Vector m_axis{}, m_point{};
	double m_angle = 0, m_shift = 0;
	bool m_screw = false;
};

class WorldMotionTest : public WorldFileTest
{
protected:
	WorldModel loadObject( const std::string& more )
	{
		return load( "robots: [{name: left, robot: arm.urdf}]\nobjects:\n  - {name: box, " + ball + ", " + more + "}\n" );
	}
	static lw_transform poseAt( const WorldModel& world, double time )
	{
		return poseOf( world.robot, valuesAt( world.part( "box" ), time ), "box" );
	}
	static const JointModel& jointOf( const WorldModel& world, const std::string& name )
	{
		for ( const JointModel& joint : world.robot.joints )
		{
			if ( joint.name == name )
			{
				return joint;
			}
		}
		throw std::runtime_error( "no joint " + name );
	}
};

} // namespace

/// Five pieces of random kinds, one after the other, and rests between them.
TEST_F( WorldMotionTest, AnObjectIsElsewhereThanItsPiecesSay )
{
	SeededRng random;
	for ( int round = 0; round < 20; ++round )
	{
		std::vector<Known> pieces;
		Vector position = randomVector( random );
		Quaternion orientation;
		random.quaternion( orientation.data() );
		const std::string pose =
		    fmt::format( "pose: {{position: {}, orientation: {}}}", text( position ), text( orientation ) );
		std::string motion, keys;
		for ( int i = 0; i < 5; ++i )
		{
			pieces.emplace_back( random, position, orientation, keys );
			motion += fmt::format( "{}{{start: {}, end: {}, {}}}", i > 0 ? ", " : "", 2 * i, 2 * i + 1.5, keys );
			position = pieces.back().position();
			orientation = pieces.back().orientation();
		}
		const WorldModel world = loadObject( pose + ", motion: [" + motion + "]" );
		for ( double time = -0.5; time < 11; time += 0.23 )
		{
			const int i = static_cast<int>( std::fmin( 4, std::fmax( 0, std::floor( time / 2 ) ) ) );
			const double s = std::fmin( 1, std::fmax( 0, ( time - 2 * i ) / 1.5 ) );
			expectNear( poseAt( world, time ), pieces[static_cast<std::size_t>( i )].at( s ), 1e-8,
			    fmt::format( "round {}, {} s", round, time ) );
		}
		for ( const JointModel& joint : world.robot.joints ) // limits contain the motion
		{
			for ( double time = 0; joint.name.rfind( "box/", 0 ) == 0 && joint.type != LW_JOINT_FIXED && time < 11;
			      time += 0.23 )
			{
				const double value = valuesAt( world.part( "box" ), time ).at( joint.name );
				EXPECT_TRUE( value >= joint.lower - 1e-12 && value <= joint.upper + 1e-12 ) << joint.name;
			}
		}
	}
}

TEST_F( WorldMotionTest, AnObjectHasJointsThatItDoesNotNeed )
{
	const auto names = [&]( const std::string& motion )
	{ return loadObject( "motion: [" + motion + "]" ).part( "box" ).variables; };
	using Names = std::vector<std::string>;
	EXPECT_EQ( names( "{start: 0, end: 1, position: [0, 2, 0]}" ), ( Names{ "box/y" } ) );
	EXPECT_EQ( names( "{start: 0, end: 1, position: [1, 0, 3]}" ), ( Names{ "box/x", "box/z" } ) );
	EXPECT_EQ( names( "{start: 0, end: 1, orientation: [0, 0, 1, 1]}" ), ( Names{ "box/turn1" } ) );
	EXPECT_EQ( names( "{start: 0, end: 1, orientation: [0, 0, 1, 1]}, {start: 1, end: 2, orientation: [0, 0, 0, 1]}" ),
	    ( Names{ "box/turn1" } ) );
	EXPECT_EQ(
	    names(
	        "{start: 0, end: 1, turn: {axis: [0, 0, 1], angle: 1}}, {start: 1, end: 2, turn: {axis: [1, 0, 0], angle: 1}}, "
	        "{start: 2, end: 3, turn: {axis: [1, 0, 0], angle: -1}}, {start: 3, end: 4, turn: {axis: [0, 0, -2], angle: 1}}" ),
	    ( Names{ "box/turn1", "box/turn2" } ) );
	EXPECT_EQ(
	    names(
	        "{start: 0, end: 1, turn: {axis: [0, 0, 1], point: [1, 0, 0], angle: 1}}, {start: 1, end: 2, turn: {axis: [0, 0, 1], point: [1, 0, 7], angle: 1}}" ),
	    ( Names{ "box/turn1" } ) );
	EXPECT_EQ(
	    names(
	        "{start: 0, end: 1, turn: {axis: [0, 0, 1], point: [1, 0, 0], angle: 1}}, {start: 1, end: 2, turn: {axis: [0, 0, 1], angle: 1}}" ),
	    ( Names{ "box/turn1", "box/turn2" } ) );
	const WorldModel back = loadObject( "motion: [{start: 0, end: 1, turn: {axis: [0, 0, 1], angle: 1}}, "
	                                    "{start: 1, end: 2, turn: {axis: [0, 0, -2], angle: 0.75}}]" );
	EXPECT_NEAR( valuesAt( back.part( "box" ), 3 ).at( "box/turn1" ), 0.25, 1e-12 ) << "the opposite axis turns back";
	const WorldModel still = loadObject( "motion: [{start: 0, end: 1, position: [0, 0, 0]}]" );
	EXPECT_THROW( still.part( "box" ), Error );
	EXPECT_EQ( poseOf( still.robot, {}, "box" ).t[0], 0 ) << "it is on the robot all the same";
}

TEST_F( WorldMotionTest, LimitsAreWiderThanTheMotion )
{
	const WorldModel world = loadObject(
	    "pose: {position: [5, 0, 0]}, motion: [{start: 0, end: 1, position: [7, 0, 0]}, {start: 1, end: 2, position: [4, 0, 0]}, "
	    "{start: 2, end: 3, turn: {axis: [0, 0, 1], angle: -0.5}}]" );
	EXPECT_EQ( jointOf( world, "box/x" ).lower, -1 );
	EXPECT_EQ( jointOf( world, "box/x" ).upper, 2 );
	EXPECT_NEAR( jointOf( world, "box/turn1" ).lower, -0.5, 1e-15 );
	EXPECT_EQ( jointOf( world, "box/turn1" ).upper, 0 );
}

/// Four sides and four quarters of a turn.
TEST_F( WorldMotionTest, ALoopTurnsBackAtItsEnd )
{
	std::string motion;
	const double corners[5][2] = { { 0, 0 }, { 2, 0 }, { 2, 2 }, { 0, 2 }, { 0, 0 } };
	for ( int i = 0; i < 4; ++i )
	{
		motion += fmt::format(
		    "{}{{start: {}, end: {}, position: [{}, {}, 0]}}, {{start: {}, end: {}, turn: {{axis: [0, 0, 1], angle: {}}}}}",
		    i > 0 ? ", " : "", 2 * i, 2 * i + 1, corners[i + 1][0], corners[i + 1][1], 2 * i + 1, 2 * i + 2, pi / 2 );
	}
	const WorldPart part = loadObject( "motion: [" + motion + "], repeat: 9" ).part( "box" );
	EXPECT_EQ( part.period, 9 );
	ASSERT_EQ( part.variables, ( std::vector<std::string>{ "box/x", "box/y", "box/turn1" } ) );
	ASSERT_EQ( part.advance.size(), 3u );
	EXPECT_EQ( part.advance[0], 0 );
	EXPECT_NEAR( part.advance[2], 2 * pi, 1e-15 );
	EXPECT_EQ( jointOf( loadObject( "motion: [" + motion + "], repeat: 9" ), "box/turn1" ).type, LW_JOINT_CONTINUOUS );
	EXPECT_EQ( jointOf( loadObject( "motion: [" + motion + "]" ), "box/turn1" ).type, LW_JOINT_REVOLUTE );
	const TimedPiece& last = part.pieces.back();
	EXPECT_EQ( last.points.at( last.points.size() - 1 ), part.advance[2] );
}

TEST_F( WorldMotionTest, ASpreadHasNoJointToShift )
{
	const WorldModel world = loadObject( "unknown_motion: {speed: 1.6, from: 2}" );
	const WorldPart& part = world.part( "box" );
	EXPECT_EQ( part.variables, std::vector<std::string>{ "box/x" } );
	EXPECT_EQ( part.spread_speed, 1.6 );
	EXPECT_EQ( part.spread_start, 2 );
	EXPECT_NO_THROW( buildProblem( world.robot, worldProblem( world ) ) );
	EXPECT_EQ( loadObject( "unknown_motion: {speed: 1}, motion: [{start: 0, end: 1, position: [0, 0, 1]}]" )
	               .part( "box" )
	               .variables,
	    ( std::vector<std::string>{ "box/x", "box/z" } ) );
}

TEST_F( WorldMotionTest, ABadMotionIsTakenAsItIs )
{
	const auto bad = [&]( const std::string& more, std::vector<std::string> parts )
	{
		parts.insert( parts.end(), { "cell.yaml", "objects[0] box" } );
		expectError( [&] { loadObject( more ); }, parts );
	};
	const auto piece = [&]( const std::string& more, const std::vector<std::string>& parts )
	{ bad( "motion: [{start: 0, end: 1, " + more + "}]", parts ); };
	piece( "points: [[0, 0, 0.5], [1, 0, 0]]", { "motion[0].points[0]", "jumps: it is 0.5 m" } );
	piece( "points: [[0, 0, 0]]", { "motion[0].points", "1 control points" } );
	piece( "points: [[0,0,0],[0,0,0],[0,0,0],[0,0,0],[0,0,0],[0,0,0],[0,0,0],[0,0,0],[0,0,1]]",
	    { "motion[0].points", "degree 8", "2 to 8 points" } );
	piece( "points: [[0, 0, 0], [1, 0]]", { "motion[0].points[1]", "has 2 numbers" } );
	piece( "position: [1, 0, 0], points: [[0, 0, 0], [1, 0, 0]]", { "motion[0]", "two motions" } );
	piece( "turn: {axis: [0, 0, 1], angle: 1}, orientation: [0, 0, 0, 1]", { "motion[0]", "two motions" } );
	piece( "turn: {axis: [0, 0, 0], angle: 1}", { "motion[0].turn.axis", "no direction" } );
	piece( "turn: {axis: [0, 0, 1]}", { "motion[0].turn.angle", "missing" } );
	piece( "turn: {axis: [0, 0, 1], angl: 1}", { "motion[0].turn.angl", "is angle meant" } );
	piece( "orientation: [0, 0, 0, 0]", { "motion[0].orientation", "quaternion is zero" } );
	piece( "positon: [1, 0, 0]", { "motion[0].positon", "is position meant" } );
	piece( "position: [1, 0, .nan]", { "motion[0].position", "not finite" } );
	bad( "motion: [{start: 0, end: 1}]", { "motion[0]", "has no motion" } );
	bad( "motion: [{start: 1, end: 1, position: [1, 0, 0]}]", { "motion[0]", "the clock runs backwards" } );
	bad( "motion: [{start: 0, end: 2, position: [1, 0, 0]}, {start: 1, end: 3, position: [0, 0, 0]}]",
	    { "motion[1]", "before the end of the one before, 2 s" } );
	bad( "motion: [{start: 0, end: 2, position: [1, 0, 0]}], repeat: 3", { "repeat", "does not close", "1 m" } );
	bad(
	    "motion: [{start: 0, end: 2, orientation: [0, 0, 1, 1]}], repeat: 3", { "repeat", "does not close", "1.5708 rad" } );
	bad( "motion: [{start: 0, end: 1, position: [1, 0, 0]}, {start: 1, end: 2, position: [0, 0, 0]}], repeat: 1",
	    { "repeat", "shorter than the motion" } );
	bad(
	    "motion: [{start: 0, end: 1, turn: {axis: [0, 0, 1], angle: 1.5}}, {start: 1, end: 2, turn: {axis: [1, 0, 0], angle: 1.5}}, {start: 2, end: 3, orientation: [0, 0, 0, 1]}], repeat: 4",
	    { "repeat", "another axis" } );
	bad( "repeat: 1", { "repeat", "no motion to repeat" } );
	bad( "unknown_motion: {speed: 0}", { "unknown_motion.speed", "not above 0" } );
	bad( "unknown_motion: {sped: 1}", { "unknown_motion.sped", "is speed meant" } );
	bad( "lag: -1", { "lag", "negative" } );
	const auto object = [&]( const std::string& text, const std::vector<std::string>& parts )
	{ expectError( [&] { load( "objects: [{name: box, " + text + "}]\n" ); }, parts ); };
	object( "shapes: []", { "objects[0] box.shapes", "there are none" } );
	object( "shapes: [{type: ball, dimensions: [1]}]", { "shapes[0].type", "ball is not known", "box, sphere" } );
	object( "shapes: [{type: box, dimensions: [1, 1]}]", { "shapes[0].dimensions", "2 numbers" } );
	object( "shapes: [{type: mesh, resource: none.stl}]", { "shapes[0]", "none.stl" } );
	object( "shapes: [{type: box, dimensions: [1, 1, 1], radius: 1}]", { "shapes[0].radius", "not known" } );
	object( "shapes: [{type: plane, coef: [0, 0, 1, 0]}], motion: [{start: 0, end: 1, position: [1, 0, 0]}]",
	    { "shapes[0]", "plane cannot move" } );
}

TEST_F( WorldMotionTest, ShapesOfAnObjectAreOthersThanInAScene )
{
	writeTetrahedron( "t.obj" );
	const WorldModel world = load(
	    "robots: [{name: left, robot: arm.urdf}]\nobjects:\n  - name: every\n    pose: {position: [1, 0, 0]}\n    shapes:\n"
	    "      - {type: box, dimensions: [1, 2, 3], pose: {position: [0, 1, 0]}}\n      - {type: cylinder, dimensions: [1, 0.2]}\n"
	    "      - {type: cone, dimensions: [1, 0.2]}\n      - {type: mesh, resource: t.obj, scale: [2, 2, 2], solid: true}\n"
	    "      - {type: spheres, spheres: [[0, 0, 0, 0.1]]}\n      - {type: plane, coef: [0, 0, 1, 0], solid: true}\n" );
	const std::vector<PlacedShape>& shapes = world.scene->objects.at( 0 ).shapes;
	ASSERT_EQ( shapes.size(), 6u );
	EXPECT_EQ( shapes[0].pose.t[0], 1 );
	EXPECT_EQ( shapes[0].pose.t[1], 1 );
	EXPECT_EQ( lw_shape_peek_info( shapes[1].shape.get() ).type, LW_SHAPE_CYLINDER );
	EXPECT_EQ( lw_shape_peek_info( shapes[2].shape.get() ).type, LW_SHAPE_CONE );
	EXPECT_EQ( lw_shape_peek_info( shapes[5].shape.get() ).type, LW_SHAPE_HALFSPACE );
}
