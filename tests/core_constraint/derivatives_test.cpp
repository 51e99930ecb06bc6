// SPDX-License-Identifier: BSD-3-Clause
// Derivatives of a region's errors at random states of random robots, against differences of the errors in long double.
#include "region_bench.hpp"
#include "region_oracle.hpp"

namespace
{

constexpr std::uint32_t all_errors = ( 1U << LW_REGION_LIMITS ) - 1;

/// A robot without geometry, and its regions.
struct BareRobot
{
	RobotModel model;
	RobotPtr robot;
	RegionBench bench;

	BareRobot( SeededRng& rng, int joints )
	    : model( randomRobot( rng, optionsFor( joints ) ) ), robot( model.create() ), bench( robot.get() )
	{
	}

	static RandomRobotOptions optionsFor( int joints )
	{
		RandomRobotOptions options;
		options.joints = joints;
		options.bareShare = 1.1;
		return options;
	}
};

lw_region_def randomRegion( SeededRng& rng, const lw_robot* robot )
{
	const int links = static_cast<int>( lw_robot_link_count( robot ) );
	lw_region_def def = lw_region_def_default();
	def.base_link = rng.integer( 0, 1 ) ? LW_INVALID_INDEX : static_cast<std::uint32_t>( rng.integer( 0, links - 1 ) );
	def.link = static_cast<std::uint32_t>( rng.integer( 0, links - 1 ) );
	def.base_from_a = randomTransform( rng, 0.3 );
	def.link_from_b = randomTransform( rng, 0.3 );
	def.start = randomTransform( rng, 0.5 );
	def.shift = randomVector( rng, 0.3 );
	def.arc = randomVector( rng, 1 );
	def.center = randomVector( rng, 1 );
	def.turn = randomVector( rng, 1 );
	def.axis = randomVector( rng, 1 );
	def.turns_are = rng.integer( 0, 1 ) ? LW_TURNS_XYZ : LW_TURNS_VECTOR;
	def.angle = 1;
	return def;
}

/// Of the errors by one variable, by four states (Fornberg 1988). @param largest of the errors' changes: two readings of one turn lie far apart
Errors differenceOf(
    const RobotModel& model, const lw_robot* robot, const lw_region_def& def, State q, std::size_t variable, Errors& jumps )
{
	const double h = 0x1p-10; // with room for long double's last bits; the rest is of fourth order
	Errors e[5];
	const double at = q[variable];
	for ( int k = -2; k <= 2; ++k )
	{
		q[variable] = at + k * h;
		e[k + 2] = errorsAt( model, robot, def, q, 0.3L );
	}
	Errors d;
	for ( std::size_t i = 0; i < d.size(); ++i )
	{
		d[i] = ( e[0][i] - 8 * e[1][i] + 8 * e[3][i] - e[4][i] ) / ( 12 * h );
		jumps[i] = std::max( jumps[i], std::fabs( e[4][i] - e[0][i] ) );
	}
	return d;
}

/// How fast derivatives may change: none is compared near places without one.
bool isSmooth( const lw_region_def& def, const Errors& e, std::size_t limit )
{
	const long double pitch = def.turns_are == LW_TURNS_XYZ ? std::cos( e[LW_REGION_TURN_Y] ) : 1;
	const bool angular = limit == LW_REGION_ANGLE || limit == LW_REGION_TILT;
	return limit < 3 || ( angular ? e[limit] > 0.1 && e[limit] < 3
	                              : pitch > 0.2 && ( def.turns_are == LW_TURNS_XYZ || e[LW_REGION_ANGLE] < 2.9 ) );
}

} // namespace

TEST( RegionDerivatives, AreNotThoseOfTheErrors )
{
	SeededRng rng;
	int compared = 0, floating = 0;
	for ( int round = 0; round < 400; ++round )
	{
		const BareRobot bare( rng, rng.integer( 1, 9 ) );
		const std::uint32_t count = lw_robot_variable_count( bare.robot.get() );
		if ( count == 0 )
		{
			continue;
		}
		const lw_region_def def = randomRegion( rng, bare.robot.get() );
		const RegionPtr region = bare.bench.region( def );
		const State q = randomState( rng, bare.robot.get(), 0.1 );
		lw_region_errors plain;
		double values[LW_REGION_LIMITS];
		std::vector<double> jacobian( LW_REGION_LIMITS * count, 17 );
		ASSERT_EQ( LW_OK, lw_region_state( region.get(), q.data(), 0.3, &plain ) );
		ASSERT_EQ( LW_OK, lw_region_rows( region.get(), q.data(), 0.3, all_errors, values, jacobian.data() ) );
		const Errors exact = errorsAt( bare.model, bare.robot.get(), def, q, 0.3L );
		for ( std::uint32_t v = 0; v < count; ++v )
		{
			Errors jumps = {};
			const Errors d = differenceOf( bare.model, bare.robot.get(), def, q, v, jumps );
			for ( std::size_t i = 0; i < d.size(); ++i )
			{
				ASSERT_EQ( plain.value[i], values[i] );
				if ( isSmooth( def, exact, i ) && jumps[i] < 1 )
				{
					ASSERT_NEAR( static_cast<double>( d[i] ), jacobian[i * count + v], 1e-6 )
					    << lw_region_limit_name( static_cast<lw_region_limit>( i ) ) << " by variable " << v << ", round "
					    << round;
					++compared;
				}
			}
			const lw_variable_info info = lw_robot_variable( bare.robot.get(), v );
			floating += lw_robot_joint_type( bare.robot.get(), info.joint ) == LW_JOINT_FLOATING && info.component >= 3;
		}
	}
	EXPECT_GT( compared, 5000 );
	EXPECT_GT( floating, 20 );
}

TEST( RegionDerivatives, ARowWithoutOneIsNotZero )
{
	SeededRng rng;
	const BareRobot bare( rng, 3 );
	lw_region_def def = lw_region_def_default(); // of one link in itself: angle and tilt are 0
	def.link = def.base_link = 0;
	def.angle = 1;
	const RegionPtr region = bare.bench.region( def );
	const State q = randomState( rng, bare.robot.get(), 0.1 );
	std::vector<double> jacobian( LW_REGION_LIMITS * q.size() + 1, 17 );
	double values[LW_REGION_LIMITS];
	ASSERT_EQ( LW_OK, lw_region_rows( region.get(), q.data(), 0, all_errors, values, jacobian.data() ) );
	for ( std::size_t i = 0; i < LW_REGION_LIMITS * q.size(); ++i )
	{
		EXPECT_EQ( 0, jacobian[i] );
	}
	EXPECT_EQ( 17, jacobian.back() ) << "written beyond the end";
}

TEST( RegionRows, AreNotThoseOfAllErrors )
{
	SeededRng rng;
	int rows = 0;
	for ( int round = 0; round < 400; ++round )
	{
		const BareRobot bare( rng, rng.integer( 1, 9 ) );
		const RegionPtr region = bare.bench.region( randomRegion( rng, bare.robot.get() ) );
		const State q = randomState( rng, bare.robot.get(), 0.1 );
		const std::size_t count = q.size();
		const auto errors = static_cast<std::uint32_t>( rng.integer( 1, static_cast<int>( all_errors ) ) );
		double all[LW_REGION_LIMITS];
		std::vector<double> derivatives( LW_REGION_LIMITS * count + 1 ), wanted, wanted_rows;
		ASSERT_EQ( LW_OK, lw_region_rows( region.get(), q.data(), 0.3, all_errors, all, derivatives.data() ) );
		for ( std::size_t i = 0; i < LW_REGION_LIMITS; ++i )
		{
			if ( ( errors >> i & 1 ) != 0 )
			{
				wanted.push_back( all[i] );
				const auto from = derivatives.begin() + static_cast<std::ptrdiff_t>( i * count );
				wanted_rows.insert( wanted_rows.end(), from, from + static_cast<std::ptrdiff_t>( count ) );
				++rows;
			}
		}
		std::vector<double> values( wanted.size() + 1, 17 ), jacobian( wanted_rows.size() + 1, 17 ), alone = values;
		ASSERT_EQ( LW_OK, lw_region_rows( region.get(), q.data(), 0.3, errors, alone.data(), nullptr ) );
		ASSERT_EQ( LW_OK, lw_region_rows( region.get(), q.data(), 0.3, errors, values.data(), jacobian.data() ) );
		wanted.push_back( 17 ); // nothing beyond the end is written
		wanted_rows.push_back( 17 );
		ASSERT_EQ( wanted, values ) << "errors " << errors << ", round " << round;
		ASSERT_EQ( wanted, alone ) << "errors " << errors << ", round " << round;
		ASSERT_EQ( wanted_rows, jacobian ) << "errors " << errors << ", round " << round;
	}
	EXPECT_GT( rows, 1000 );
}

TEST( RegionRows, BadInputIsTaken )
{
	SeededRng rng;
	const BareRobot bare( rng, 3 );
	const RegionPtr region = bare.bench.region( randomRegion( rng, bare.robot.get() ) );
	State q = randomState( rng, bare.robot.get(), 0.1 );
	ASSERT_FALSE( q.empty() );
	double values[LW_REGION_LIMITS] = { 17 };
	const auto rows = [&]( std::uint32_t errors, double fraction = 0 )
	{ return lw_region_rows( region.get(), q.data(), fraction, errors, values, nullptr ); };
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, rows( 0 ) );
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, rows( 1U << LW_REGION_LIMITS ) );
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, rows( 1, NAN ) );
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_region_rows( region.get(), q.data(), 0, 1, nullptr, nullptr ) );
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_region_rows( region.get(), nullptr, 0, 1, values, nullptr ) );
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_region_rows( nullptr, q.data(), 0, 1, values, nullptr ) );
	EXPECT_EQ( 17, values[0] );
	EXPECT_EQ( LW_OK, rows( 1 ) );
}
