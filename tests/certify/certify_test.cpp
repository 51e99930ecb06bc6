// SPDX-License-Identifier: BSD-3-Clause
// The writer of certificates: motions without one, schedules, and the digests that it stores.
#include "certify/schedule.hpp"
#include "files.hpp"
#include "seeded_rng.hpp"

#include <fmt/format.h>

#include <cmath>

using namespace leeway;
using namespace leeway::certify;

namespace
{

std::string hexOf( const std::string& bytes )
{
	std::string out;
	Digest digest;
	digest.add( bytes.data(), bytes.size() / 3 );
	digest.add( bytes.data() + bytes.size() / 3, bytes.size() - bytes.size() / 3 );
	for ( const std::uint8_t byte : digest.value() )
	{
		out += fmt::format( "{:02x}", byte );
	}
	return out;
}

/// An arm that turns about z with a box from 0.1 to 0.5 m, beside a post of 10 cm at 0.4 m in direction `post`, radians.
class CertifyTest : public FileTest
{
protected:
	void make( double post, const std::string& joint = "revolute" )
	{
		robot = io::loadRobot(
		    write( "arm.urdf",
		        "<robot name='arm'><link name='base'/><link name='arm'><collision><origin xyz='0.3 0 0'/><geometry><box size='0.4 0.1 "
		        "0.1'/></geometry></collision></link><joint name='turn' type='" +
		            joint +
		            "'><parent link='base'/><child link='arm'/><axis xyz='0 0 1'/>"
		            "<limit lower='-3' upper='3' effort='1' velocity='1'/></joint></robot>" ),
		    "" );
		scene = io::loadScene( write( "scene.yaml",
		    fmt::format(
		        "name: s\nworld:\n  collision_objects:\n    - {{id: post, primitives: [{{type: cylinder, dimensions: [1, 0.05]}}], "
		        "primitive_poses: [{{position: [{}, {}, 0], orientation: [0, 0, 0, 1]}}]}}\n",
		        0.4 * std::cos( post ), 0.4 * std::sin( post ) ) ) );
		io::ProblemOptions options;
		options.scene = &scene;
		problem = io::buildProblem( robot, options );
	}
	void expectError( const std::vector<Piece>& pieces, const std::string& part, const Settings& settings = {} )
	{
		try
		{
			certify::certify( problem, robot, pieces, settings, "motion.yaml" );
			ADD_FAILURE() << "no error; expected one with " << part;
		}
		catch ( const io::Error& error )
		{
			EXPECT_NE( std::string( error.what() ).find( part ), std::string::npos ) << error.what();
			EXPECT_EQ( error.file(), "motion.yaml" );
			EXPECT_FALSE( error.remedy().empty() );
		}
	}

	io::RobotModel robot;
	io::SceneModel scene;
	io::Problem problem;
};

} // namespace

// FIPS 180-4, and a block that is just full
TEST( Digest, DiffersFromThePublishedOnes )
{
	EXPECT_EQ( hexOf( "" ), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855" );
	EXPECT_EQ( hexOf( "abc" ), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad" );
	EXPECT_EQ( hexOf( "abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq" ),
	    "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1" );
	EXPECT_EQ( hexOf( std::string( 1000000, 'a' ) ), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0" );
}

TEST_F( CertifyTest, MotionsThroughTheObstacleGetOne )
{
	make( 1.0 );
	const Certificate made =
	    certify::certify( problem, robot, piecesOf( problem, { { -1.0 }, { 0.5 } } ), {}, "motion.yaml" );
	EXPECT_EQ( made.pairs, 1U );
	EXPECT_GT( made.windows(), 1U );
	EXPECT_LT( made.proof_size, 100U );
	expectError( piecesOf( problem, { { -1.0 }, { 0.5 }, { 1.5 } } ), "piece 2" );
	expectError( piecesOf( problem, { { -1.0 }, { 0.5 }, { 1.5 } } ), "arm - post is not farther apart than required" );
	// A curve whose ends are free and whose middle is not
	expectError( { { 2, { 0.0, 2.0, 0.0 }, 0 } }, "arm - post" );
	// free without a distance, and without a tolerance
	Settings far, loose;
	far.min_d = 0.2;
	expectError( piecesOf( problem, { { -1.0 }, { 0.5 } } ), "arm - post", far );
	loose.tolerance = { 0.5 };
	expectError( piecesOf( problem, { { -1.0 }, { 0.5 } } ), "arm - post is too near", loose );
}

TEST_F( CertifyTest, MotionsThatTheFormatCannotHoldGetOne )
{
	make( 1.0 );
	expectError( { { 1, { -1.0, 0.0 }, 0 }, { 1, { 0.1, 0.2 }, 0 } }, "it does not begin where the piece before ends" );
	expectError( {}, "certificates hold 1 piece or more" );
	expectError( { { 8, std::vector<double>( 9, 0.0 ), 0 } }, "degree 1 to 7" );
	expectError( { { 1, { 0.0, NAN }, 0 } }, "values of at most 1000" );
	make( 1.0, "floating" );
	std::vector<double> from( 7, 0.0 ), to = from;
	from[6] = to[3] = 1;
	std::vector<double> points = from;
	points.insert( points.end(), to.begin(), to.end() );
	expectError( { { 1, points, 0 } }, "certificates cannot hold a floating joint that turns" );
}

TEST_F( CertifyTest, JointsWithoutEndTurnTheLongWayAround )
{
	make( 1.0, "continuous" );
	const std::vector<Piece> pieces = piecesOf( problem, { { 3.0 }, { -3.0 }, { 3.0 } } );
	ASSERT_EQ( pieces.size(), 2U );
	EXPECT_NEAR( pieces[0].points[1], 6.283185307179586 - 3, 1e-12 );
	EXPECT_NEAR( pieces[1].points[0], 6.283185307179586 - 3, 1e-12 );
	EXPECT_NEAR( pieces[1].points[1], 3, 1e-12 );
}

namespace
{

/// Two arms as in CertifyTest, the second 0.75 m to the right of the first and turned by half a turn: their tips meet if both point at the other one.
class ScheduleTest : public CertifyTest
{
protected:
	void SetUp() override
	{
		const std::string box =
		    "<collision><origin xyz='0.3 0 0'/><geometry><box size='0.4 0.1 0.1'/></geometry></collision></link>";
		const auto joint = []( const std::string& name, const std::string& child, const std::string& origin )
		{
			return "<joint name='" + name + "' type='revolute'><parent link='base'/><child link='" + child + "'/>" + origin +
			       "<axis xyz='0 0 1'/><limit lower='-3' upper='3' effort='1' velocity='1'/></joint>";
		};
		robot = io::loadRobot(
		    write( "arms.urdf", "<robot name='arms'><link name='base'/><link name='l'>" + box + "<link name='r'>" + box +
		                            joint( "left", "l", "" ) +
		                            joint( "right", "r", "<origin xyz='0.75 0 0' rpy='0 0 3.14159265358979'/>" ) +
		                            "</robot>" ),
		    "" );
		problem = io::buildProblem( robot, {} );
	}
	/// The first arm sweeps past the second one's place and is gone when that one comes, 0.5 s later.
	Schedule scheduled( double lag_left, double lag_right )
	{
		static const double left[] = { -1.0, 1.0 }, right[] = { -1.0, 0.0 };
		static const lw_timed_piece pieces[] = { { 0, 1, 1, left }, { 1, 2, 1, right } };
		static const std::uint32_t variables[] = { 0, 1 };
		tracks[0] = { variables, 1, &pieces[0], 1, lag_left, nullptr, 0, 0 };
		tracks[1] = { variables + 1, 1, &pieces[1], 1, lag_right, nullptr, 0, 0 };
		clock = { tracks, 2, rest };
		return scheduleOf( problem, clock, 0, 2 );
	}
	Settings settingsOf( const Schedule& schedule ) const
	{
		Settings settings;
		settings.tolerance = schedule.tolerance;
		settings.tracks = schedule.tracks;
		settings.begin = schedule.begin;
		return settings;
	}
	lw_track tracks[2];
	double rest[2] = { 0, 0 };
	lw_clock clock;
};

} // namespace

TEST_F( ScheduleTest, PiecesOfTracksAreNotJoined )
{
	const Schedule schedule = scheduled( 0, 0.25 );
	EXPECT_EQ( schedule.begin, -0.25 );
	ASSERT_EQ( schedule.pieces.size(), 4U ); // the lag before, two, the lag behind
	EXPECT_EQ( schedule.pieces[1].points, ( std::vector<double>{ -1, -1, 1, -1 } ) );
	EXPECT_EQ( schedule.pieces[2].points, ( std::vector<double>{ 1, -1, 1, 0 } ) );
	EXPECT_EQ( schedule.pieces[3].seconds, 0.25 );
	const std::vector<double> cubic{ 0, 1, 3, 2 };
	EXPECT_EQ( partOf( cubic, 1, 0, 1 ), cubic );
	const std::vector<double> part = partOf( cubic, 1, 0.5, 0.75 );
	EXPECT_NEAR( part[0], 1.75, 1e-15 );
	EXPECT_NEAR( part[3], 2.25, 1e-15 ); // of t = 3/4
}

TEST_F( ScheduleTest, LagsOfTwoTracksTakeNoClearance )
{
	const auto written = [&]( const Schedule& schedule )
	{ return Writer( problem, robot ).write( schedule.pieces, settingsOf( schedule ), "motion.yaml" ); };
	EXPECT_GT( written( scheduled( 0, 0 ) ).windows(), 0U );
	EXPECT_GT( written( scheduled( 0.02, 0.02 ) ).windows(), 0U );
	const Schedule late = scheduled( 0.1, 0.7 );
	expectError( late.pieces, "l - r", settingsOf( late ) );
	// The same lag of one track that moves both takes none
	Settings together = settingsOf( late );
	together.tracks = { { { 0, 1 }, 0.7, 0, 0 } };
	EXPECT_GT( Writer( problem, robot ).write( late.pieces, together, "motion.yaml" ).windows(), 0U );
	// Whoever may go anywhere
	Settings free = settingsOf( scheduled( 0, 0 ) );
	free.tolerance = { 0, 1.0 };
	expectError( scheduled( 0, 0 ).pieces, "l - r", free );
}

TEST_F( ScheduleTest, CommonPartsDifferBetweenCertificates )
{
	const Schedule schedule = scheduled( 0.02, 0.02 );
	Writer writer( problem, robot );
	const Certificate first = writer.write( schedule.pieces, settingsOf( schedule ), "motion.yaml" );
	writer.write( scheduled( 0, 0 ).pieces, {}, "motion.yaml" );
	EXPECT_EQ( writer.write( schedule.pieces, settingsOf( schedule ), "motion.yaml" ).bytes, first.bytes );
	EXPECT_EQ(
	    certify::certify( problem, robot, schedule.pieces, settingsOf( schedule ), "motion.yaml" ).bytes, first.bytes );
}

// By brute force: a variable that is late or early is no farther from its place than its tube says
TEST( Tubes, VariablesLeaveThem )
{
	SeededRng rng;
	for ( int world = 0; world < 200; ++world )
	{
		std::vector<Piece> pieces;
		double last = rng.uniform( -1, 1 ), begin = rng.uniform( -2, 2 ), end = begin;
		for ( int k = rng.integer( 1, 5 ); k > 0; --k )
		{
			const auto degree = static_cast<unsigned>( rng.integer( 1, 5 ) );
			Piece piece{ degree, { last }, std::pow( 10.0, rng.uniform( -1, 1 ) ) };
			const double size = std::pow( 10.0, rng.uniform( -2, 1 ) );
			for ( unsigned i = 0; i < degree; ++i )
			{
				piece.points.push_back( piece.points.back() + size * rng.uniform( -1, 1 ) );
			}
			last = piece.points.back();
			end += piece.seconds;
			pieces.push_back( std::move( piece ) );
		}
		const auto at = [&]( double time )
		{
			double start = begin;
			for ( const Piece& piece : pieces )
			{
				if ( time <= start + piece.seconds || &piece == &pieces.back() )
				{
					const double s = std::min( 1.0, std::max( 0.0, ( time - start ) / piece.seconds ) );
					return partOf( piece.points, 1, s, s )[0];
				}
				start += piece.seconds;
			}
			return 0.0;
		};
		const Deviation deviation{ 1, 0.25, std::pow( 10.0, rng.uniform( -2, 1 ) ), 0.5, rng.uniform( -2, 5 ) };
		double start = begin;
		for ( std::size_t k = 0; k < pieces.size(); ++k )
		{
			const Tubes tubes = tubesOf( pieces, k, begin, { deviation } );
			for ( int i = 0; i < 100; ++i )
			{
				const double t = start + pieces[k].seconds * rng.uniform( 0, 1 );
				const double d = deviation.lag * ( i % 2 == 0 ? rng.uniform( -1, 1 ) : i % 4 == 1 ? 1 : -1 );
				EXPECT_LE( std::fabs( at( t + d ) - at( t ) ), tubes.late[0] + 1e-9 )
				    << "world " << world << ", piece " << k;
				const double spread = 0.25 + 0.5 * std::max( 0.0, std::min( t + std::fabs( d ), end ) - deviation.since );
				EXPECT_LE( spread, tubes.timely[0] + 1e-9 );
			}
			start += pieces[k].seconds;
		}
	}
}
