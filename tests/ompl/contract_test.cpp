// SPDX-License-Identifier: BSD-3-Clause
// OMPL's two interfaces: the conformance tests, run on leeway's classes and on OMPL's own (a test that those fail misreads
// the contract), and leeway's promises beyond them.
#include "conformance.hpp"
#include "leeway/ompl/objective.hpp"
#include "world.hpp"

#include <ompl/base/DiscreteMotionValidator.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/spaces/WrapperStateSpace.h>

#include <thread>

namespace
{

// ---- conformance ----

enum class Kind
{
	ompl,  ///< OMPL's DiscreteMotionValidator, and a checker that says no more than OMPL demands: is the state valid
	mixed, ///< OMPL's DiscreteMotionValidator on leeway's checker
	certified,
	steps,
	coarse,   ///< certified, by distances within half of their size, and with a slack twice min_d
	tolerant, ///< certified, for all motions near it
	wrapped   ///< certified, in a space wrapped once more
};

/// The same for all variables that may have one.
std::vector<double> toleranceOf( const lw_checker* checker, double tolerance )
{
	std::vector<double> out;
	for ( std::uint32_t i = 0; i < lw_checker_variable_count( checker ); ++i )
	{
		const lw_variable_info info = lw_robot_variable( lw_checker_robot( checker ), lw_checker_variable( checker, i ) );
		const bool floats = lw_robot_joint_type( lw_checker_robot( checker ), info.joint ) == LW_JOINT_FLOATING;
		out.push_back( floats && info.component >= 3 ? 0 : tolerance );
	}
	return out;
}

/// All but isValid( state ) is OMPL's default.
class PlainChecker : public ob::StateValidityChecker
{
public:
	PlainChecker( const ob::SpaceInformationPtr& si, ob::StateValidityCheckerPtr judge )
	    : ob::StateValidityChecker( si ), m_judge( std::move( judge ) )
	{
	}
	bool isValid( const ob::State* state ) const override { return m_judge->isValid( state ); }

private:
	ob::StateValidityCheckerPtr m_judge;
};

/// Moves a bounded variable out of its limits.
void leaveBounds( const Rig& rig, SeededRng& rng, ob::State* state )
{
	const lw_robot* robot = lw_checker_robot( rig.checker.get() );
	std::vector<double> q = rig.vector( state );
	for ( ;; )
	{
		const auto i = static_cast<std::uint32_t>( rng.integer( 0, int( q.size() ) - 1 ) );
		const lw_variable_info info = lw_robot_variable( robot, lw_checker_variable( rig.checker.get(), i ) );
		if ( !info.wraps && std::isfinite( info.upper ) && info.component < 3 )
		{
			q[i] = rng.integer( 0, 1 ) == 0 ? info.lower - 0.01 : info.upper + 0.01;
			rig.engine->adapter().fromVector( q.data(), state );
			return;
		}
	}
}

conformance::Instance makeInstance( const World& world, Kind kind )
{
	leeway::ompl::Options options;
	options.min_d = 0.01;
	options.method = kind == Kind::steps ? LW_EDGE_STEPS : LW_EDGE_CERTIFIED;
	if ( kind == Kind::coarse )
	{
		options.alpha = 0.5;
		options.slack = 0.02;
	}
	const leeway::Checker checker = world.make();
	if ( kind == Kind::tolerant )
	{
		options.tolerance = toleranceOf( checker.get(), 0.003 );
	}
	ob::StateSpacePtr space = leeway::ompl::makeStateSpace( checker );
	if ( kind == Kind::wrapped )
	{
		space = std::make_shared<ob::WrapperStateSpace>( space );
	}
	const auto rig = std::make_shared<Rig>( checker, options, space );
	if ( kind == Kind::ompl || kind == Kind::mixed )
	{
		if ( kind == Kind::ompl )
		{
			rig->si->setStateValidityChecker(
			    std::make_shared<PlainChecker>( rig->si, rig->si->getStateValidityChecker() ) );
		}
		rig->si->setMotionValidator( std::make_shared<ob::DiscreteMotionValidator>( rig->si ) );
		rig->si->setup();
	}

	conformance::Instance instance;
	instance.si = rig->si;
	instance.sample = [rig]( SeededRng& rng, ob::State* state ) { rig->sample( rng, state ); };
	const auto query = std::make_shared<leeway::Query>( leeway::makeQuery( rig->checker.get() ) );
	instance.room = [rig, query, options]( const ob::State* state )
	{ return exactClearance( *rig, query->get(), state ) - options.min_d; };
	instance.leave_bounds = [rig]( SeededRng& rng, ob::State* state ) { leaveBounds( *rig, rng, state ); };
	instance.valid = { world.start, world.goal };
	instance.invalid = { world.inside };
	ob::ScopedState<> start( rig->space ), goal( rig->space ), near_start( rig->space );
	rig->engine->adapter().fromVector( world.start.data(), start.get() );
	rig->engine->adapter().fromVector( world.goal.data(), goal.get() );
	rig->space->interpolate( start.get(), goal.get(), 0.02, near_start.get() );
	instance.motions = { { world.start, world.goal, false }, { world.start, rig->vector( near_start.get() ), true } };
	return instance;
}

conformance::Exceptions exceptionsOf( Kind kind )
{
	conformance::Exceptions exceptions;
	if ( kind == Kind::steps )
	{
		exceptions.whole_motion = "fixed steps: nothing is looked at in between";
		exceptions.again = "the steps of a shorter motion are at other places";
	}
	if ( kind == Kind::coarse )
	{
		exceptions.same_clearance = "with alpha above 0 the bound within it depends on where the search began";
	}
	if ( kind == Kind::tolerant )
	{
		exceptions.still =
		    "a state that is nearer than motions within the tolerance may come is valid, but no motion from it";
	}
	if ( kind == Kind::ompl )
	{
		exceptions.clearance = "OMPL's default for clearance() is 0, everywhere";
	}
	if ( kind == Kind::ompl || kind == Kind::mixed )
	{
		exceptions.bounds = "DiscreteMotionValidator takes the start for valid and has no bounds of its own";
		exceptions.non_finite = "DiscreteMotionValidator makes an integer of the distance, which is undefined for a NaN";
		exceptions.start = "DiscreteMotionValidator takes the start for valid";
		exceptions.whole_motion = "DiscreteMotionValidator looks at states of a resolution, at nothing in between";
		exceptions.again = "DiscreteMotionValidator divides a shorter motion at other places";
		exceptions.thread_counts = "DiscreteMotionValidator counts in plain integers";
	}
	return exceptions;
}

std::vector<conformance::Subject> subjects()
{
	std::vector<conformance::Subject> result;
	auto add = [&]( const World& world, Kind kind, const char* kind_name )
	{
		result.push_back( { std::string( world.name ) + kind_name, [world, kind] { return makeInstance( world, kind ); },
		    exceptionsOf( kind ) } );
	};
	for ( const World& world : worlds() )
	{
		add( world, Kind::ompl, "Ompl" );
		add( world, Kind::certified, "Certified" );
		add( world, Kind::steps, "Steps" );
		add( world, Kind::coarse, "Coarse" );
		add( world, Kind::tolerant, "Tolerant" );
	}
	add( worlds()[1], Kind::mixed, "OmplOnLeeway" );
	add( worlds()[3], Kind::wrapped, "Wrapped" );
	add( worlds()[4], Kind::wrapped, "Wrapped" );
	return result;
}

INSTANTIATE_TEST_SUITE_P( Worlds, Conformance, testing::ValuesIn( subjects() ), conformance::name );

// ---- more than OMPL asks: states ----

class CheckerContract : public testing::TestWithParam<World>
{
};

std::string worldName( const testing::TestParamInfo<World>& info )
{
	return info.param.name;
}

TEST_P( CheckerContract, ClearanceIsAsTightAsAlphaSays )
{
	SeededRng rng;
	leeway::ompl::Options options;
	options.min_d = 0.02;
	options.max_d = 0.2;
	int valid = 0, capped = 0;
	for ( double alpha : { 0.0, 0.3 } )
	{
		options.alpha = alpha;
		const Rig rig( GetParam().make(), options );
		const ob::StateValidityChecker& checker = *rig.si->getStateValidityChecker();
		const leeway::Query query = leeway::makeQuery( rig.checker.get() );
		const double cap = options.max_d - options.min_d;
		ob::ScopedState<> state( rig.space );
		for ( int i = 0; i < 1000; ++i )
		{
			rig.sample( rng, state.get() );
			const double exact = exactClearance( rig, query.get(), state.get() );
			double dist = -1;
			const bool is_valid = checker.isValid( state.get(), dist );
			ASSERT_EQ( is_valid, exact > options.min_d ) << exact;
			for ( double value : { dist, checker.clearance( state.get() ) } )
			{
				if ( !is_valid )
				{
					ASSERT_EQ( value, 0 );
					continue;
				}
				ASSERT_GT( value, 0 );
				ASSERT_LE( value, std::min( exact - options.min_d, cap ) + 1e-12 );
				ASSERT_GE( value, std::min( ( 1 - alpha ) * exact - options.min_d, cap ) - 1e-12 );
			}
			valid += is_valid;
			capped += dist == cap;
		}
	}
	EXPECT_GT( valid, 100 );
	EXPECT_GT( capped, 10 ) << "max_d never played a part";
}

TEST_P( CheckerContract, StatesOutOfBoundsAreInvalidWithRoomToSpare )
{
	// no obstacles: the bounds alone decide
	SeededRng rng;
	const Rig rig( GetParam().make() );
	ob::ScopedState<> bad( rig.space );
	int seen = 0;
	for ( int round = 0; round < 200; ++round )
	{
		rig.sampleValid( rng, bad.get() );
		leaveBounds( rig, rng, bad.get() );
		EXPECT_FALSE( rig.si->isValid( bad.get() ) );
		seen += rig.si->getStateValidityChecker()->clearance( bad.get() ) > 0;
	}
	EXPECT_GT( seen, 10 ) << "no state was out of bounds and clear of everything";
}

TEST( CheckerSpecs, NothingToTouchIsAsFarAsMaxD )
{
	leeway::ompl::Options options;
	options.min_d = 0.1;
	options.max_d = 0.7;
	const Rig rig( makeChecker( { slider( "rail", 0, 0, 1, makeBall( 0.1 ) ) }, {} ), options );
	ob::ScopedState<> state( rig.space );
	state[0] = 0.5;
	double dist = 0;
	EXPECT_TRUE( rig.si->getStateValidityChecker()->isValid( state.get(), dist ) );
	EXPECT_DOUBLE_EQ( dist, 0.6 );
	EXPECT_TRUE( rig.si->checkMotion( state.get(), state.get() ) );
}

// A ball on a rail before a wall, 1.4 m from it at 0: the clearance told to a planner is less by the margin, all along a
// motion too.
TEST( CheckerSpecs, MarginsCountForStatesMotionsAndCosts )
{
	const double of_object = 0.2;
	lw_margins margins = {};
	margins.environment = 0.05;
	margins.object = &of_object;
	const std::vector<Obstacle> wall = { { makeBox( 1, 2, 2 ), at( 2, 0, 0 ) } };
	leeway::ompl::Options options;
	options.max_d = 10;
	const Rig rig( makeChecker( { slider( "rail", 0, 0, 1.3, makeBall( 0.1 ) ) }, wall, {}, margins ), options );
	const auto checker = rig.si->getStateValidityChecker();
	ob::ScopedState<> from( rig.space ), to( rig.space );
	double dist = 0;
	for ( const double x : { 0.0, 0.7, 1.1, 1.14, 1.16, 1.25 } )
	{
		from[0] = x;
		const double clearance = 1.4 - x - 0.25;
		EXPECT_EQ( checker->isValid( from.get(), dist ), clearance > 0 ) << x;
		EXPECT_NEAR( dist, std::max( 0.0, clearance ), 1e-9 );
		EXPECT_NEAR( checker->clearance( from.get() ), std::max( 0.0, clearance ), 1e-9 );
	}
	from[0] = 0;
	to[0] = 1;
	EXPECT_TRUE( rig.si->checkMotion( from.get(), to.get() ) );
	const leeway::ompl::ClearanceObjective objective( rig.si, rig.engine );
	EXPECT_NEAR( objective.motionCost( from.get(), to.get() ).value(), 0.15, 0.15 * 0.1 );
	to[0] = 1.25;
	std::pair<ob::State*, double> last( nullptr, 0 );
	EXPECT_FALSE( rig.si->checkMotion( from.get(), to.get(), last ) );
	EXPECT_LE( last.second, 1.15 / 1.25 );
	// the verdict takes one state, so the run has 8, half of which go to windows that reach the wall and are halved: to 9/10
	EXPECT_GT( last.second, 1.02 / 1.25 );
}

TEST( CheckerSpecs, OnlyTheRequestedPartCounts )
{
	// the arm folded onto itself, far from the scene
	leeway::ompl::Options options;
	options.flags = LW_CHECK_ENVIRONMENT;
	const Rig environment( armWorld(), options );
	options.flags = LW_CHECK_SELF;
	const Rig self( armWorld(), options );
	const Rig both( armWorld() );
	const double folded[3] = { -1.57, 2.8, 2.4 }, pillar[3] = { 0.62, 0, 0 };
	ob::ScopedState<> state( both.space );
	both.engine->adapter().fromVector( folded, state.get() );
	EXPECT_TRUE( environment.si->isValid( state.get() ) );
	EXPECT_FALSE( self.si->isValid( state.get() ) );
	EXPECT_FALSE( both.si->isValid( state.get() ) );
	EXPECT_GT( environment.si->getStateValidityChecker()->clearance( state.get() ), 0 );
	EXPECT_FALSE( self.si->checkMotion( state.get(), state.get() ) );
	EXPECT_TRUE( environment.si->checkMotion( state.get(), state.get() ) );
	both.engine->adapter().fromVector( pillar, state.get() );
	EXPECT_FALSE( environment.si->isValid( state.get() ) );
	EXPECT_TRUE( self.si->isValid( state.get() ) );
	EXPECT_FALSE( both.si->isValid( state.get() ) );
	EXPECT_GT( self.si->getStateValidityChecker()->clearance( state.get() ), 0 );
}

INSTANTIATE_TEST_SUITE_P( Worlds, CheckerContract, testing::ValuesIn( worlds() ), worldName );

// ---- more than OMPL asks: motions ----

class CertifiedMotion : public testing::TestWithParam<World>
{
};

TEST_P( CertifiedMotion, EverythingUpToLastValidIsFree )
{
	SeededRng rng;
	leeway::ompl::Options options;
	options.min_d = 0.01;
	const Rig rig( GetParam().make(), options );
	const leeway::Query query = leeway::makeQuery( rig.checker.get() );
	ob::ScopedState<> s1( rig.space ), s2( rig.space ), between( rig.space );
	int free = 0, proved_on_the_way = 0, wrongly_undecided = 0;
	for ( int i = 0; i < 150; ++i )
	{
		rig.sampleValid( rng, s1.get() );
		rig.sample( rng, s2.get() );
		if ( i % 2 == 0 )
		{
			rig.space->interpolate( s1.get(), s2.get(), 0.3, s2.get() );
		}
		std::pair<ob::State*, double> last_valid( nullptr, 1 );
		const bool valid = rig.si->checkMotion( s1.get(), s2.get(), last_valid );
		double lowest = inf;
		for ( int k = 0; k <= 200; ++k )
		{
			const double t = k / 200.0;
			rig.space->interpolate( s1.get(), s2.get(), t, between.get() );
			const double clearance = exactClearance( rig, query.get(), between.get() );
			lowest = std::min( lowest, clearance );
			if ( t <= last_valid.second )
			{
				ASSERT_GT( clearance, options.min_d - 1e-9 ) << "t = " << t << " of " << last_valid.second;
			}
		}
		free += valid;
		proved_on_the_way += !valid && last_valid.second > 0.05;
		// far above the band that the slack permits, and 200 samples cannot have missed more than their spacing
		wrongly_undecided += !valid && lowest > options.min_d + 0.03;
	}
	EXPECT_GT( free, 20 );
	EXPECT_GT( proved_on_the_way, 10 );
	EXPECT_EQ( wrongly_undecided, 0 );
}

TEST_P( CertifiedMotion, ValidMotionsAreFreeWithinTheirTolerance )
{
	SeededRng rng;
	leeway::ompl::Options options;
	const leeway::Checker checker = GetParam().make();
	const leeway::Query query = leeway::makeQuery( checker.get() );
	int valid = 0, only_without = 0;
	for ( const double tolerance : { 0.01, 0.1 } )
	{
		options.tolerance = toleranceOf( checker.get(), tolerance );
		const Rig rig( checker, options ), exact( checker );
		ob::ScopedState<> s1( rig.space ), s2( rig.space ), between( rig.space );
		for ( int i = 0; i < 150; ++i )
		{
			rig.sampleValid( rng, s1.get() );
			rig.sample( rng, s2.get() );
			rig.space->interpolate( s1.get(), s2.get(), rng.uniform( 0, 0.5 ), s2.get() );
			std::pair<ob::State*, double> last_valid( nullptr, 1 );
			const bool is_valid = rig.si->checkMotion( s1.get(), s2.get(), last_valid );
			valid += is_valid;
			only_without += !is_valid && exact.si->checkMotion( s1.get(), s2.get() );
			const double until = is_valid ? 1 : last_valid.second;
			for ( int k = 0; k <= 40 && until > 0; ++k )
			{
				rig.space->interpolate( s1.get(), s2.get(), until * k / 40, between.get() );
				std::vector<double> q = rig.vector( between.get() );
				for ( std::size_t v = 0; v < q.size(); ++v )
				{
					q[v] += ( 1 - 1e-9 ) * options.tolerance[v] * ( rng.integer( 0, 1 ) ? 1 : -1 );
				}
				bool free = false;
				ASSERT_EQ(
				    lw_checker_is_free( checker.get(), query.get(), q.data(), LW_CHECK_BOTH, 0, &free, nullptr ), LW_OK );
				ASSERT_TRUE( free ) << "beside t = " << until * k / 40;
			}
		}
	}
	EXPECT_GT( valid, 20 );
	EXPECT_GT( only_without, 5 );
}

TEST( CheckerSpecs, ToleranceMustFitTheStates )
{
	const leeway::Checker checker = worlds()[0].make();
	const std::size_t size = lw_checker_variable_count( checker.get() );
	leeway::ompl::Options options;
	for ( const std::vector<double>& wrong : { std::vector<double>( size + 1, 0.1 ), std::vector<double>( size, -0.1 ),
	          std::vector<double>( size, inf ), std::vector<double>( size, nan_value ) } )
	{
		options.tolerance = wrong;
		EXPECT_THROW( Rig( checker, options ), std::invalid_argument );
	}
	options.tolerance.assign( size, 0.1 );
	EXPECT_NO_THROW( Rig( checker, options ) );
	options.method = LW_EDGE_STEPS;
	EXPECT_THROW( Rig( checker, options ), std::invalid_argument );
}

TEST_P( CertifiedMotion, StartWithinTheSlackIsNoReasonToStayThere )
{
	// grips begin like this, and so do planners that go on from a last valid state
	SeededRng rng;
	leeway::ompl::Options options;
	options.min_d = 0.01;
	const Rig rig( GetParam().make(), options );
	const leeway::Query query = leeway::makeQuery( rig.checker.get() );
	ob::ScopedState<> inside( rig.space ), start( rig.space ), goal( rig.space ), between( rig.space ), last( rig.space );
	int leaves = 0, stays = 0;
	for ( int i = 0; i < 400; ++i )
	{
		rig.sampleValid( rng, start.get() );
		do
		{
			rig.sample( rng, inside.get() );
		} while ( rig.si->isValid( inside.get() ) );
		double room = inf;
		for ( int k = 0; k < 40 && room > 0.3 * options.slack; ++k )
		{
			rig.space->interpolate( start.get(), inside.get(), 0.5, between.get() );
			rig.space->copyState( rig.si->isValid( between.get() ) ? start.get() : inside.get(), between.get() );
			room = exactClearance( rig, query.get(), start.get() ) - options.min_d;
		}
		rig.sample( rng, goal.get() );
		std::pair<ob::State*, double> last_valid( last.get(), 0 );
		if ( !( room > 0.05 * options.slack && room < 0.3 * options.slack ) ||
		     rig.si->checkMotion( start.get(), goal.get(), last_valid ) )
		{
			continue;
		}
		bool away = true;
		for ( int k = 0; k <= 200 && away; ++k )
		{
			rig.space->interpolate( start.get(), goal.get(), 0.05 * k / 200, between.get() );
			away = exactClearance( rig, query.get(), between.get() ) - options.min_d > 0.5 * room;
		}
		leaves += away;
		stays += away && !( last_valid.second > 0 );
		ASSERT_TRUE( rig.si->isValid( last.get() ) );
		ASSERT_TRUE( rig.si->checkMotion( start.get(), last.get() ) ) << last_valid.second;
		ASSERT_TRUE( rig.si->checkMotion( last.get(), start.get() ) ) << last_valid.second;
	}
	EXPECT_GT( leaves, 5 );
	EXPECT_EQ( stays, 0 ) << "of " << leaves;
}

INSTANTIATE_TEST_SUITE_P( Worlds, CertifiedMotion, testing::ValuesIn( worlds() ), worldName );

TEST( MotionBounds, LastValidStatesAreTheEndsOfFreeMotions )
{
	// a ball that begins within the slack of a wall at its left, and is driven into one at its right
	SeededRng rng;
	const leeway::ompl::Options options;
	constexpr double radius = 0.1, wall = 0.4; // half of a wall
	int moved = 0;
	for ( int i = 0; i < 400; ++i )
	{
		const double gap = rng.uniform( 0.3, 1 );
		const Rig rig( makeChecker( { slider( "rail", 0, -2, 2, makeBall( radius ) ) },
		    { { makeBox( 2 * wall, 1, 1 ), at( -radius - wall, 0, 0 ) },
		        { makeBox( 2 * wall, 1, 1 ), at( gap + radius + wall, 0, 0 ) } } ) );
		ob::ScopedState<> s1( rig.space ), s2( rig.space ), last( rig.space );
		s1[0] = rng.uniform( 0.01, 0.9 ) * options.slack;
		s2[0] = gap + rng.uniform( 0.001, 0.3 );
		std::pair<ob::State*, double> last_valid( last.get(), 1 );
		ASSERT_FALSE( rig.si->checkMotion( s1.get(), s2.get(), last_valid ) );
		moved += last_valid.second > 0;
		ASSERT_TRUE( rig.si->isValid( last.get() ) );
		ASSERT_TRUE( rig.si->checkMotion( s1.get(), last.get() ) ) << s1[0] << " to " << last[0] << " of " << gap;
		ASSERT_TRUE( rig.si->checkMotion( last.get(), s1.get() ) ) << s1[0] << " to " << last[0] << " of " << gap;
	}
	EXPECT_GT( moved, 200 );
}

/// Two rails without the neighbourhood of a point, as a user may derive a space with a hole.
struct RailsWithAHole : ob::RealVectorStateSpace
{
	RailsWithAHole() : ob::RealVectorStateSpace( 2 ) { setBounds( -1, 1 ); }
	bool satisfiesBounds( const ob::State* state ) const override
	{
		const double* q = state->as<StateType>()->values;
		return std::hypot( q[0] + 0.1, q[1] + 0.5 ) > 0.1 && ob::RealVectorStateSpace::satisfiesBounds( state );
	}
};

TEST( MotionBounds, LastValidInAHoleOfTheSpaceIsNotTaken )
{
	// the proved run ends before the wall, in the hole
	const Rig rig( gantryWorld(), {}, std::make_shared<RailsWithAHole>() );
	ob::ScopedState<> s1( rig.space ), s2( rig.space ), last( rig.space );
	s1[0] = -0.5;
	s1[1] = s2[1] = -0.5;
	s2[0] = 0.5;
	const ob::ScopedState<> s1_before( s1 );
	for ( ob::State* out : { last.get(), s1.get() } )
	{
		std::pair<ob::State*, double> last_valid( out, 0.3 );
		EXPECT_FALSE( rig.si->checkMotion( s1.get(), s2.get(), last_valid ) );
		EXPECT_EQ( last_valid.second, 0 );
		EXPECT_TRUE( rig.space->equalStates( out, s1_before.get() ) );
	}
}

TEST( MotionCounters, EngineTotalsAddUp )
{
	SeededRng rng;
	const Rig rig( armWorld() );
	ob::ScopedState<> s1( rig.space ), s2( rig.space );
	const leeway::ompl::Counters before = rig.engine->counters();
	std::uint64_t states = 0, valid = 0;
	for ( int i = 0; i < 100; ++i )
	{
		rig.sample( rng, s1.get() );
		rig.sample( rng, s2.get() );
		rig.si->isValid( s1.get() );
		rig.si->getStateValidityChecker()->clearance( s1.get() );
		states += 2;
		valid += rig.si->checkMotion( s1.get(), s2.get() );
	}
	const leeway::ompl::Counters after = rig.engine->counters();
	EXPECT_EQ( after.states - before.states, states );
	EXPECT_EQ( after.edges - before.edges, 100u );
	EXPECT_EQ( after.free - before.free, valid );
	EXPECT_EQ( after.free + after.blocked + after.undecided, after.edges );
	EXPECT_GE( after.edge_queries - before.edge_queries, 100u );
	EXPECT_EQ( rig.engine->queryCount(), 1u ) << "one thread needs one query";
}

// ---- threads ----

struct Answer
{
	bool state = false, motion = false;
	double clearance = 0;
};

/// Asks everything about motions [first, count) in steps of `stride`.
void askAll( const Rig& rig, const std::vector<ob::State*>& states, std::size_t first, std::size_t stride,
    std::vector<Answer>& answers )
{
	const ob::StateValidityChecker& checker = *rig.si->getStateValidityChecker();
	ob::State* last = rig.si->allocState();
	for ( std::size_t i = first; i + 1 < states.size(); i += stride )
	{
		Answer& answer = answers[i];
		answer.state = checker.isValid( states[i] );
		answer.clearance = checker.clearance( states[i] );
		std::pair<ob::State*, double> last_valid( last, 1 );
		answer.motion = i % 2 == 0 ? rig.si->checkMotion( states[i], states[i + 1] )
		                           : rig.si->checkMotion( states[i], states[i + 1], last_valid );
		if ( !answer.motion && answer.state && i % 2 == 1 )
		{
			// a slot shared by two threads would mix their states
			answer.motion = !checker.isValid( last );
		}
	}
	rig.si->freeState( last );
}

/// True if a motion's clearance comes so near to the band above min_d that the history of a query may decide.
bool isClose( const Rig& rig, lw_query* query, const ob::State* s1, const ob::State* s2 )
{
	ob::ScopedState<> between( rig.space );
	double lowest = inf;
	for ( int k = 0; k <= 100; ++k )
	{
		rig.space->interpolate( s1, s2, k / 100.0, between.get() );
		lowest = std::min( lowest, exactClearance( rig, query, between.get() ) );
	}
	return lowest > 0 && lowest < 0.03;
}

// A ball that slides along a wall within rounding: the planner must hear the pair in the way of all proofs.
TEST( MotionCounters, RefusedPairsAreNamed )
{
	const leeway::Checker checker = makeChecker( { slider( "cart", 0, -1, 1, makeBox( 0.2, 0.2, 0.2 ) ) },
	    { { makeBox( 4, 1, 4 ), at( 0, 0.6 + 1e-10, 0 ) }, { makeBox( 0.1, 0.1, 0.1 ), at( 0, -1, 0 ) } } );
	Rig rig( checker, {} );
	EXPECT_TRUE( rig.engine->undecidedPairs().empty() );
	EXPECT_EQ( "", rig.engine->describeUndecided() );
	ob::ScopedState<> from( rig.space ), to( rig.space );
	for ( int i = 0; i < 3; ++i )
	{
		const double a = -0.5 + 0.1 * i, b = 0.5;
		rig.engine->adapter().fromVector( &a, from.get() );
		rig.engine->adapter().fromVector( &b, to.get() );
		EXPECT_FALSE( rig.si->checkMotion( from.get(), to.get() ) );
	}
	const std::vector<leeway::ompl::UndecidedPair> undecided_pairs = rig.engine->undecidedPairs();
	ASSERT_EQ( 1u, undecided_pairs.size() );
	EXPECT_EQ( 3u, undecided_pairs[0].count );
	EXPECT_FALSE( undecided_pairs[0].self );
	EXPECT_EQ( "cart link", undecided_pairs[0].first );
	EXPECT_EQ( lw_scene_object_name( lw_checker_scene( checker.get() ), 0 ), undecided_pairs[0].second );
	EXPECT_NEAR( 1e-10, undecided_pairs[0].clearance, 1e-12 );
	EXPECT_NE( std::string::npos, rig.engine->describeUndecided().find( "3 of 3 motions" ) );
	std::const_pointer_cast<leeway::ompl::Engine>( rig.engine )->update( checker );
	EXPECT_TRUE( rig.engine->undecidedPairs().empty() );
}

TEST( CheckerThreads, EightThreadsGetTheAnswersOfOne )
{
	constexpr std::size_t threads = 8, count = 801;
	for ( const World& world : worlds() )
	{
		SeededRng rng;
		const Rig rig( world.make() );
		std::vector<ob::State*> states( count );
		for ( ob::State*& state : states )
		{
			state = rig.si->allocState();
			rig.sample( rng, state );
		}
		std::vector<Answer> alone( count ), together( count );
		askAll( rig, states, 0, 1, alone );
		rig.si->getMotionValidator()->resetMotionCounter();
		const leeway::ompl::Counters before = rig.engine->counters();

		std::vector<std::thread> pool;
		for ( std::size_t i = 0; i < threads; ++i )
		{
			pool.emplace_back( [&, i] { askAll( rig, states, i, threads, together ); } );
		}
		for ( std::thread& thread : pool )
		{
			thread.join();
		}
		const leeway::Query query = leeway::makeQuery( rig.checker.get() );
		for ( std::size_t i = 0; i + 1 < count; ++i )
		{
			ASSERT_EQ( alone[i].state, together[i].state ) << world.name << " " << i;
			ASSERT_NEAR( alone[i].clearance, together[i].clearance, 1e-12 ) << world.name << " " << i;
			if ( alone[i].motion != together[i].motion )
			{
				ASSERT_TRUE( isClose( rig, query.get(), states[i], states[i + 1] ) ) << world.name << " " << i;
			}
		}
		EXPECT_EQ( rig.si->getMotionValidator()->getCheckedMotionCount(), count - 1 ) << "a count was lost";
		EXPECT_EQ( rig.engine->counters().edges - before.edges, count - 1 );
		EXPECT_LE( rig.engine->queryCount(), threads + 1 );
		for ( ob::State* state : states )
		{
			rig.si->freeState( state );
		}
	}
}

} // namespace
