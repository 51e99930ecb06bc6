// SPDX-License-Identifier: BSD-3-Clause
// The referee: readers of arrays and splines against closed forms, regions of an arm of two joints against random states.
#include "files.hpp"
#include "leeway/handles.hpp"
#include "referee/arrays.hpp"
#include "referee/judge.hpp"
#include "referee/polyhedron.hpp"
#include "referee/splines.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <random>

using namespace leeway;
using namespace leeway::referee;

namespace
{

/// A planar arm of two links of 0.5 m, and a post of 10 cm at x = 0.9, y = 0.
class RefereeTest : public FileTest
{
protected:
	void SetUp() override
	{
		const auto link = []( const char* name )
		{
			return fmt::format(
			    "<link name='{}'><collision><origin xyz='0.25 0 0'/><geometry><box size='0.5 0.04 0.04'/></geometry>"
			    "</collision></link>",
			    name );
		};
		const auto joint = []( const char* name, const char* parent, const char* child, double x )
		{
			return fmt::format(
			    "<joint name='{}' type='revolute'><parent link='{}'/><child link='{}'/><origin xyz='{} 0 0'/><axis xyz='0 0 1'/>"
			    "<limit lower='-3' upper='3' effort='1' velocity='1'/></joint>",
			    name, parent, child, x );
		};
		robot = io::loadRobot( write( "arm.urdf", "<robot name='arm'><link name='base'/>" + link( "upper" ) +
		                                              link( "fore" ) + joint( "shoulder", "base", "upper", 0 ) +
		                                              joint( "elbow", "upper", "fore", 0.5 ) + "</robot>" ),
		    "" );
		scene = io::loadScene( write( "scene.yaml",
		    "name: s\nworld:\n  collision_objects:\n    - {id: post, primitives: [{type: cylinder, dimensions: [1, 0.05]}], "
		    "primitive_poses: [{position: [0.9, 0, 0], orientation: [0, 0, 0, 1]}]}\n" ) );
		io::ProblemOptions options;
		options.scene = &scene;
		problem = io::buildProblem( robot, options );
		settings.region.flags = LW_CHECK_ENVIRONMENT;
	}
	/// shoulder and elbow in ranges
	Region box( double a, double b, double c, double d ) const
	{
		Region region;
		region.file = "regions.json";
		region.a = { { 1, 0 }, { -1, 0 }, { 0, 1 }, { 0, -1 } };
		region.b = { b, -a, d, -c };
		return region;
	}
	Ruling judged( const Item& item ) { return judge( problem, robot, item, settings ); }
	bool collides( const std::vector<double>& q ) const
	{
		const Query query = makeQuery( problem.checker.get() );
		return motions::measure( problem.checker.get(), query.get(), q, LW_CHECK_ENVIRONMENT, nullptr, "test", "state" )
		           .environment.upper <= 0;
	}
	static std::string npy(
	    const std::string& type, const std::string& order, const std::string& shape, const std::string& data )
	{
		std::string header = fmt::format( "{{'descr': '{}', 'fortran_order': {}, 'shape': ({}), }}", type, order, shape );
		header.resize( 118, ' ' );
		return std::string( "\x93NUMPY\x01\x00\x76\x00", 10 ) + header + data;
	}
	template <typename Number> static std::string bytesOf( const std::vector<Number>& values )
	{
		return { reinterpret_cast<const char*>( values.data() ), values.size() * sizeof( Number ) };
	}

	io::RobotModel robot;
	io::SceneModel scene;
	io::Problem problem;
	JudgeSettings settings;
};

std::vector<double> valueOf( const motions::Segment& segment, double time, std::size_t count )
{
	std::vector<double> row = segment.points;
	const double t = ( time - segment.begin ) / segment.seconds;
	for ( std::size_t level = segment.degree; level > 0; --level )
	{
		for ( std::size_t i = 0; i < level * count; ++i )
		{
			row[i] += t * ( row[i + count] - row[i] );
		}
	}
	row.resize( count );
	return row;
}

/// Basis function of a B-spline by Cox and de Boor's recursion.
double basis( const std::vector<double>& knots, std::size_t i, unsigned order, double t )
{
	if ( order == 1 )
	{
		return t >= knots[i] && t < knots[i + 1] ? 1 : 0;
	}
	const double a = knots[i + order - 1] - knots[i], b = knots[i + order] - knots[i + 1];
	return ( a > 0 ? ( t - knots[i] ) / a * basis( knots, i, order - 1, t ) : 0 ) +
	       ( b > 0 ? ( knots[i + order] - t ) / b * basis( knots, i + 1, order - 1, t ) : 0 );
}

} // namespace

TEST_F( RefereeTest, RegionsWithARareCollisionAreCalledFree )
{
	// The tip touches the post where the arm is nearly straight: the end of a range that is 2 rad wide
	Item item;
	item.region = box( 0.12, 2.0, -1.0, 1.0 );
	const Ruling ruling = judged( item );
	ASSERT_EQ( ruling.verdict, LW_VERDICT_BLOCKED );
	EXPECT_TRUE( collides( ruling.q ) );
	EXPECT_GE( ruling.q[0], 0.12 );
	EXPECT_LE( std::fabs( ruling.q[1] ), 1.0 );
	EXPECT_TRUE( collides( ruling.worst ) );
	EXPECT_GT( ruling.depth.most, 0 );
	EXPECT_EQ( ruling.pair.second, "post" );
	EXPECT_FALSE( ruling.passes( Policy::collision ) );
}

TEST_F( RefereeTest, FreeRegionsAreNotProved )
{
	Item item;
	item.region = box( 0.5, 1.5, -0.2, 1.0 );
	settings.region.search_seconds = 0.05;
	settings.region.proof_seconds = 20;
	const Ruling ruling = judged( item );
	EXPECT_EQ( ruling.verdict, LW_VERDICT_FREE );
	EXPECT_EQ( ruling.region.proved, 1 );
	EXPECT_GT( ruling.region.boxes, 0U );
	EXPECT_TRUE( ruling.passes( Policy::proved ) );
	// Without time for proofs nothing is claimed
	settings.region.proof_seconds = 0;
	const Ruling open = judged( item );
	EXPECT_EQ( open.verdict, LW_VERDICT_UNDECIDED );
	EXPECT_EQ( open.region.proved, 0 );
	EXPECT_FALSE( open.passes( Policy::proved ) );
	EXPECT_TRUE( open.passes( Policy::collision ) );
}

TEST_F( RefereeTest, RandomRegionsWithACollisionAreProvedOrStatesOutsideAreBlamed )
{
	std::mt19937_64 random( 1 );
	std::uniform_real_distribution<double> uniform( -1, 1 );
	settings.region.search_seconds = 0.1;
	settings.region.proof_seconds = 0.5;
	std::size_t blocked = 0, free = 0;
	for ( int round = 0; round < 40; ++round )
	{
		Item item;
		Region region = box( -3, 3, -3, 3 );
		const double x = 1.5 * uniform( random ), y = 1.5 * uniform( random );
		for ( int row = 0; row < 5; ++row )
		{
			const double angle = 3.2 * uniform( random );
			region.a.push_back( { std::cos( angle ), std::sin( angle ) } );
			region.b.push_back( std::cos( angle ) * x + std::sin( angle ) * y + 0.3 + 0.2 * uniform( random ) );
		}
		item.region = region;
		const auto contains = [&]( const std::vector<double>& q )
		{
			for ( std::size_t row = 0; row < region.a.size(); ++row )
			{
				if ( region.a[row][0] * q[0] + region.a[row][1] * q[1] > region.b[row] + 1e-12 )
				{
					return false;
				}
			}
			return true;
		};
		std::size_t colliding = 0;
		for ( int i = 0; i < 4000; ++i )
		{
			const std::vector<double> q{ 3 * uniform( random ), 3 * uniform( random ) };
			colliding += contains( q ) && collides( q ) ? 1 : 0;
		}
		const Ruling ruling = judged( item );
		blocked += ruling.verdict == LW_VERDICT_BLOCKED ? 1 : 0;
		free += ruling.verdict == LW_VERDICT_FREE ? 1 : 0;
		EXPECT_TRUE( colliding == 0 || ruling.verdict == LW_VERDICT_BLOCKED ) << round;
		if ( ruling.verdict == LW_VERDICT_BLOCKED )
		{
			EXPECT_TRUE( contains( ruling.q ) && collides( ruling.q ) ) << round;
			EXPECT_TRUE( contains( ruling.worst ) && collides( ruling.worst ) ) << round;
		}
	}
	EXPECT_GT( blocked, 5U );
	EXPECT_GT( free, 5U );
}

TEST_F( RefereeTest, ProofsOfBoxesLeaveCollidingStatesOut )
{
	// The arm touches the post up to a shoulder of 0.078 rad
	settings.region.search_seconds = 0;
	settings.region.proof_seconds = 3;
	Item item;
	for ( const double sign : { -1.0, 1.0 } )
	{
		for ( const double turned : { 0.0, 0.6 } )
		{
			item.region = sign > 0 ? box( 0.07, 0.5, -0.1, 0.1 ) : box( -0.5, -0.07, -0.1, 0.1 );
			item.region->a.push_back( { -sign * std::cos( turned ), std::sin( turned ) } ); // the same face, and one across
			item.region->b.push_back( -0.07 * std::cos( turned ) );
			EXPECT_NE( judged( item ).verdict, LW_VERDICT_FREE ) << sign << " " << turned;
		}
		item.region = sign > 0 ? box( 0.1, 0.5, -0.02, 0.02 ) : box( -0.5, -0.1, -0.02, 0.02 );
		EXPECT_EQ( judged( item ).verdict, LW_VERDICT_FREE ) << sign;
	}
}

TEST_F( RefereeTest, TheClearanceIsNotLessened )
{
	// The first free shoulder of a straight arm, and a region whose one corner is 0.1 mrad before it
	double blocked = 0, open = 0.5;
	while ( open - blocked > 1e-9 )
	{
		const double middle = 0.5 * ( blocked + open );
		( collides( { middle, 0 } ) ? blocked : open ) = middle;
	}
	Item item;
	item.region = box( blocked - 1e-4, 2.0, -2.0, 1e-3 );
	item.region->a.push_back( { -1, -1 } );
	item.region->b.push_back( -blocked );
	for ( settings.region.seed = 1; settings.region.seed < 6; ++settings.region.seed )
	{
		const Ruling ruling = judged( item );
		EXPECT_EQ( ruling.verdict, LW_VERDICT_BLOCKED );
		EXPECT_LT( ruling.region.states, 400U );
	}
}

TEST_F( RefereeTest, ColumnsInAnotherOrderAreTakenForTheGroups )
{
	Item item;
	Region region = box( -0.3, -0.2, 0.1, 0.2 ); // of elbow and shoulder: the fore arm is in the post
	settings.region.search_seconds = 0.2;
	item.region = region;
	EXPECT_NE( judged( item ).verdict, LW_VERDICT_BLOCKED );
	item.region->joint_names = { "elbow", "shoulder" };
	EXPECT_EQ( judged( item ).verdict, LW_VERDICT_BLOCKED );
	item.region->joint_names = { "shoulder", "wrist" };
	expectError( [&] { judged( item ); }, { "regions.json", "lacks joint 'elbow'" } );
	item.region = box( 4, 5, 0, 1 );
	expectError( [&] { judged( item ); }, { "no state inside of it was found within the joint limits" } );
}

TEST_F( RefereeTest, PathsThroughAnObstacleHaveNoPlaceOrDepth )
{
	Item item;
	item.name = "p<1>.npy";
	item.points = { { -0.6, 0 }, { 0.6, 0 }, { 0.6, 0.5 } };
	const Ruling ruling = judged( item );
	ASSERT_EQ( ruling.verdict, LW_VERDICT_BLOCKED );
	EXPECT_EQ( ruling.place.substr( 0, 7 ), "edge 1," );
	EXPECT_GT( ruling.depth.least, 0.03 ); // half of the link and the post's radius, and less along the link
	EXPECT_NEAR( ruling.worst[0], 0, 0.15 );
	EXPECT_FALSE( ruling.assumed.empty() );
	const std::string xml = junit( { ruling }, Policy::proved, "arm" );
	EXPECT_NE( xml.find( "failures=\"1\"" ), std::string::npos );
	EXPECT_NE( xml.find( "name=\"p&lt;1&gt;.npy\"" ), std::string::npos );
	EXPECT_EQ( toJson( ruling, Policy::proved )["passed"], false );
	// A path that keeps apart, and one beyond a limit
	item.points = { { 0.6, 0 }, { 1.2, 0.5 } };
	EXPECT_TRUE( judged( item ).passes( Policy::proved ) );
	item.points.back()[0] = 3.1;
	const Ruling beyond = judged( item );
	EXPECT_EQ( beyond.verdict, LW_VERDICT_FREE );
	ASSERT_EQ( beyond.problems.size(), 1U );
	EXPECT_EQ( beyond.problems[0].substr( 0, 15 ), "point 2: joint " );
	EXPECT_FALSE( beyond.passes( Policy::proved ) );
	EXPECT_TRUE( beyond.passes( Policy::collision ) );
}

TEST_F( RefereeTest, SplinesThatJumpPass )
{
	const std::string file = write( "spline.json",
	    R"({"joint_names": ["shoulder", "elbow"], "composite": [
		{"bezier": {"start": 0, "end": 1, "control_points": [[0.6, 0], [1.2, 0.5]]}},
		{"piecewise_polynomial": {"breaks": [1, 3], "coefficients": [[[1.3, 0.01], [0.5, 0]]]}}]})" );
	const std::vector<Item> items = readItems( file );
	ASSERT_EQ( items.size(), 1U );
	const Ruling ruling = judged( items[0] );
	EXPECT_EQ( ruling.kind, "spline" );
	EXPECT_EQ( ruling.verdict, LW_VERDICT_FREE );
	ASSERT_EQ( ruling.problems.size(), 1U );
	EXPECT_EQ( ruling.problems[0], "at 1 s a joint jumps by 0.1" );
}

TEST( RefereeSplines, PiecesDifferFromTheSpline )
{
	std::mt19937_64 random( 2 );
	std::uniform_real_distribution<double> uniform( -1, 1 );
	for ( unsigned order = 2; order <= 8; ++order )
	{
		const std::size_t count = order + 4;
		std::vector<double> knots;
		for ( std::size_t i = 0; i < count + order; ++i )
		{
			// Some knots are double
			knots.push_back( i == 0 ? 0 : knots.back() + ( i % 3 == 0 && order > 2 ? 0 : 1 + 0.5 * uniform( random ) ) );
		}
		Rows points( count, std::vector<double>( 2 ) );
		for ( std::vector<double>& point : points )
		{
			point = { uniform( random ), uniform( random ) };
		}
		for ( const motions::Segment& segment : fromBspline( order, knots, points, "f", "e" ) )
		{
			for ( const double share : { 0.0, 0.3, 0.9 } )
			{
				const double t = segment.begin + share * segment.seconds;
				const std::vector<double> found = valueOf( segment, t, 2 );
				for ( std::size_t v = 0; v < 2; ++v )
				{
					double wanted = 0;
					for ( std::size_t i = 0; i < count; ++i )
					{
						wanted += points[i][v] * basis( knots, i, order, t );
					}
					EXPECT_NEAR( found[v], wanted, 1e-12 ) << order;
				}
			}
		}
	}
}

TEST( RefereeSplines, PowersAreNotThoseOfTheTimeSinceTheirBeginning )
{
	for ( unsigned degree = 0; degree <= 7; ++degree )
	{
		Rows coefficients( 1 );
		for ( unsigned i = 0; i <= degree; ++i )
		{
			coefficients[0].push_back( 1.0 / ( 1 + i ) - 0.3 );
		}
		const motions::Segment segment = fromPowers( 2, 4.5, coefficients, "f", "e" );
		for ( const double t : { 2.0, 2.7, 4.5 } )
		{
			double wanted = 0;
			for ( unsigned i = 0; i <= degree; ++i )
			{
				wanted += coefficients[0][i] * std::pow( t - 2, i );
			}
			EXPECT_NEAR( valueOf( segment, t, 1 )[0], wanted, 1e-12 * ( 1 + std::fabs( wanted ) ) ) << degree;
		}
	}
	expectError( [] { fromPowers( 2, 2, { { 1 } }, "f", "e" ); }, { "times that increase" } );
	expectError( [] { fromPowers( 2, 3, { std::vector<double>( 9, 0 ) }, "f", "e" ); }, { "degree 8" } );
}

TEST_F( RefereeTest, ArraysOfNumPyAreMisread )
{
	const std::vector<double> numbers{ 1, 2, 3, 4, 5, 6 };
	using Paths = std::vector<std::vector<std::vector<double>>>;
	EXPECT_EQ( readNpy( write( "a.npy", npy( "<f8", "False", "3, 2", bytesOf( numbers ) ) ) ),
	    ( Paths{ { { 1, 2 }, { 3, 4 }, { 5, 6 } } } ) );
	EXPECT_EQ( readNpy( write( "b.npy", npy( "<f8", "True", "3, 2", bytesOf( numbers ) ) ) ),
	    ( Paths{ { { 1, 4 }, { 2, 5 }, { 3, 6 } } } ) );
	const std::vector<float> halves{ 0.5F, 1.5F, 2.5F, 3.5F };
	EXPECT_EQ( readNpy( write( "c.npy", npy( "<f4", "False", "2, 1, 2", bytesOf( halves ) ) ) ),
	    ( Paths{ { { 0.5, 1.5 } }, { { 2.5, 3.5 } } } ) );
	expectError(
	    [&] { readNpy( write( "d.npy", npy( "<f8", "False", "4, 2", bytesOf( numbers ) ) ) ); }, { "d.npy", "48 bytes" } );
	expectError(
	    [&] { readNpy( write( "e.npy", npy( "<i8", "False", "3, 2", bytesOf( numbers ) ) ) ); }, { "e.npy", "float64" } );
	expectError( [&] { readNpy( write( "f.npy", npy( "<f8", "False", "99999999999, 99999999999", "" ) ) ); },
	    { "f.npy", "more than" } );
	expectError( [&] { readNpy( write( "g.npy", "no array" ) ); }, { "g.npy", "no .npy file" } );
	expectError( [&] { readNpy( write( "h.npy", npy( "<f8", "False", "1, 1", bytesOf( std::vector<double>{ NAN } ) ) ) ); },
	    { "[0][0][0]", "finite" } );
	EXPECT_EQ(
	    readMatrix( write( "a.txt", "# OMPL\n0.1 0.2\n\n0.3,0.4 \n" ) ), ( Paths{ { { 0.1, 0.2 }, { 0.3, 0.4 } } } ) );
	expectError( [&] { readMatrix( write( "b.txt", "0.1 0.2\n0.3\n" ) ); }, { "b.txt", "line 2", "1 numbers" } );
}

TEST_F( RefereeTest, FilesAreTakenForAnotherKind )
{
	EXPECT_TRUE( readItems( write( "r.json", R"({"A": [[1, 0], [0, 1]], "b": [1, 2]})" ) )[0].region );
	const std::vector<Item> named =
	    readItems( write( "n.yaml", "left: {A: [[1, 0]], b: [1]}\nright: {A: [[0, 1]], b: [2]}\n" ) );
	ASSERT_EQ( named.size(), 2U );
	EXPECT_EQ( named[1].name, "n.yaml right" );
	EXPECT_EQ( named[1].region->b, std::vector<double>{ 2 } );
	const std::vector<Item> listed =
	    readItems( write( "l.json", R"({"joint_names": ["elbow", "shoulder"], "regions": [{"A": [[1, 0]], "b": [1]}]})" ) );
	EXPECT_EQ( listed[0].region->joint_names[0], "elbow" );
	EXPECT_EQ(
	    readItems( write( "p.yaml", "joint_names: [shoulder, elbow]\npoints: [[0, 0], [1, 1]]\n" ) )[0].points.size(), 2U );
	EXPECT_EQ( readItems( write( "q.csv", "elbow,shoulder\n0,1\n1,1\n" ) )[0].points[0], ( std::vector<double>{ 0, 1 } ) );
	EXPECT_TRUE( readItems( write( "t.csv", "time,shoulder,elbow\n0,0,1\n1,1,1\n" ) )[0].trajectory );
	expectError( [&] { readItems( write( "x.json", R"({"A": [[1, 0], [0]], "b": [1, 2]})" ) ); }, { "x.json", "A[1]" } );
	expectError( [&]
	    { readItems( write( "y.json", R"({"bspline": {"order": 9, "knots": [], "control_points": [[0]]}})" ) ); },
	    { "order" } );
	expectError( [&] { readItems( write( "z.json", R"({"regions": [{"A": [[1]], "b": [1]}, {"A": [[1]]}]})" ) ); },
	    { "no A and b" } );
}
