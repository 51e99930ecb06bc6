// SPDX-License-Identifier: BSD-3-Clause
// What OMPL asks of a state validity checker and of a motion validator, word by word. Where the contract is OMPL's own,
// OMPL's DiscreteMotionValidator goes through the same checks: a test that it fails misreads the contract.
#include "world.hpp"

#include <ompl/base/DiscreteMotionValidator.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>

#include <thread>

namespace
{

// ---- states ----

class CheckerContract : public testing::TestWithParam<World>
{
};

std::string worldName( const testing::TestParamInfo<World>& info ) { return info.param.name; }

TEST_P( CheckerContract, AllAnswersAboutAStateAgree )
{
	SeededRng rng;
	leeway::ompl::Options options;
	options.min_d = 0.02;
	options.max_d = 0.2;
	int valid = 0, invalid = 0, capped = 0;
	for ( double alpha : { 0.0, 0.3 } )
	{
		options.alpha = alpha;
		const Rig rig( GetParam().make(), options );
		const ob::StateValidityChecker& checker = *rig.si->getStateValidityChecker();
		const leeway::Query query = leeway::makeQuery( rig.checker.get() );
		const double cap = options.max_d - options.min_d;
		ob::ScopedState<> state( rig.space ), other( rig.space ), other_before( rig.space );
		rig.sample( rng, other.get() );
		other_before = other;
		for ( int i = 0; i < 1000; ++i )
		{
			rig.sample( rng, state.get() );
			const double exact = exactClearance( rig, query.get(), state.get() );
			double dist = -1, dist_with_state = -1;
			bool available = true, available_too = true;
			const bool is_valid = checker.isValid( state.get() );
			ASSERT_EQ( is_valid, checker.isValid( state.get(), dist ) ) << exact;
			ASSERT_EQ( is_valid, checker.isValid( state.get(), dist_with_state, other.get(), available ) );
			const double clearance = checker.clearance( state.get() );
			ASSERT_NEAR( clearance, checker.clearance( state.get(), other.get(), available_too ), 1e-12 + alpha );
			ASSERT_FALSE( available );
			ASSERT_FALSE( available_too );
			ASSERT_TRUE( other == other_before ) << "no state is offered, so none may be written";

			// a lower bound, and a useful one: not below what alpha permits
			ASSERT_EQ( is_valid, exact > options.min_d ) << exact;
			for ( double value : { dist, dist_with_state, clearance } )
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
			invalid += !is_valid;
			capped += clearance == cap;
		}
	}
	EXPECT_GT( valid, 100 );
	EXPECT_GT( invalid, 100 );
	EXPECT_GT( capped, 10 ) << "max_d never played a part";
}

TEST_P( CheckerContract, NonFiniteStatesAreInvalid )
{
	SeededRng rng;
	const Rig rig( GetParam().make() );
	ob::ScopedState<> good( rig.space ), bad( rig.space ), last( rig.space );
	const ob::MotionValidator& motions = *rig.si->getMotionValidator();
	rig.sampleValid( rng, good.get() );
	std::vector<double> values;
	rig.space->copyToReals( values, good.get() );
	for ( std::size_t i = 0; i < values.size(); ++i )
	{
		for ( double wrong : { nan_value, inf, -inf } )
		{
			bad = good;
			*rig.space->getValueAddressAtIndex( bad.get(), static_cast<unsigned>( i ) ) = wrong;
			double dist = -1;
			EXPECT_FALSE( rig.si->isValid( bad.get() ) ) << i << " " << wrong;
			EXPECT_FALSE( rig.si->getStateValidityChecker()->isValid( bad.get(), dist ) ) << i << " " << wrong;
			EXPECT_EQ( dist, 0 );
			EXPECT_EQ( rig.si->getStateValidityChecker()->clearance( bad.get() ), 0 );
			EXPECT_FALSE( motions.checkMotion( good.get(), bad.get() ) );
			EXPECT_FALSE( motions.checkMotion( bad.get(), good.get() ) );
			std::pair<ob::State*, double> last_valid( last.get(), 0.3 );
			EXPECT_FALSE( motions.checkMotion( good.get(), bad.get(), last_valid ) );
			EXPECT_EQ( last_valid.second, 0 );
			EXPECT_TRUE( last == good );
		}
	}
}

TEST_P( CheckerContract, StatesOutOfBoundsAreInvalidWithRoomToSpare )
{
	// no obstacles: the bounds alone decide
	SeededRng rng;
	const Rig rig( GetParam().make() );
	ob::ScopedState<> good( rig.space ), bad( rig.space ), last( rig.space );
	const ob::MotionValidator& motions = *rig.si->getMotionValidator();
	const lw_robot* robot = lw_checker_robot( rig.checker.get() );
	int seen = 0;
	for ( int round = 0; round < 200; ++round )
	{
		rig.sampleValid( rng, good.get() );
		const std::uint32_t count = lw_checker_variable_count( rig.checker.get() );
		const auto i = static_cast<std::uint32_t>( rng.integer( 0, int( count ) - 1 ) );
		const lw_variable_info info = lw_robot_variable( robot, lw_checker_variable( rig.checker.get(), i ) );
		if ( info.wraps || std::isinf( info.upper ) || info.component >= 3 )
		{
			continue;
		}
		std::vector<double> q = rig.vector( good.get() );
		q[i] = rng.integer( 0, 1 ) == 0 ? info.lower - 0.01 : info.upper + 0.01;
		rig.engine->adapter().fromVector( q.data(), bad.get() );
		seen += rig.si->getStateValidityChecker()->clearance( bad.get() ) > 0;
		double dist;
		EXPECT_FALSE( rig.si->isValid( bad.get() ) );
		EXPECT_FALSE( rig.si->getStateValidityChecker()->isValid( bad.get(), dist ) );
		EXPECT_FALSE( motions.checkMotion( good.get(), bad.get() ) );
		EXPECT_FALSE( motions.checkMotion( bad.get(), good.get() ) );
		std::pair<ob::State*, double> last_valid( last.get(), 0.3 );
		EXPECT_FALSE( motions.checkMotion( good.get(), bad.get(), last_valid ) );
		EXPECT_TRUE( rig.si->isValid( last.get() ) );
	}
	EXPECT_GT( seen, 10 ) << "no state was out of bounds and clear of everything";
}

TEST( CheckerSpecs, ClearanceIsALowerBound )
{
	const Rig rig( gantryWorld() );
	const ob::StateValidityCheckerSpecs& specs = rig.si->getStateValidityChecker()->getSpecs();
	EXPECT_EQ( specs.clearanceComputationType, ob::StateValidityCheckerSpecs::BOUNDED_APPROXIMATE );
	EXPECT_FALSE( specs.hasValidDirectionComputation );
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

TEST( CheckerSpecs, OnlyWhatIsAskedForCounts )
{
	// the arm folded onto itself, far from the scene
	leeway::ompl::Options options;
	options.what = LW_WHAT_ENVIRONMENT;
	const Rig environment( armWorld(), options );
	options.what = LW_WHAT_SELF;
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

// ---- motions ----

enum class Validator
{
	discrete,
	certified,
	steps
};

const char* nameOf( Validator validator )
{
	const char* const names[] = { "Discrete", "Certified", "Steps" };
	return names[static_cast<int>( validator )];
}

void PrintTo( Validator validator, std::ostream* out ) { *out << nameOf( validator ); }

class MotionContract : public testing::TestWithParam<std::tuple<World, Validator>>
{
protected:
	MotionContract() : rig( std::get<0>( GetParam() ).make(), options() )
	{
		if ( std::get<1>( GetParam() ) == Validator::discrete )
		{
			rig.si->setMotionValidator( std::make_shared<ob::DiscreteMotionValidator>( rig.si ) );
			rig.si->setup();
		}
	}
	static leeway::ompl::Options options()
	{
		leeway::ompl::Options result;
		result.min_d = 0.01;
		result.method = std::get<1>( GetParam() ) == Validator::steps ? LW_EDGE_STEPS : LW_EDGE_CERTIFIED;
		return result;
	}
	const ob::MotionValidator& motions() const { return *rig.si->getMotionValidator(); }

	SeededRng rng;
	Rig rig;
};

std::string motionName( const testing::TestParamInfo<std::tuple<World, Validator>>& info )
{
	return std::string( std::get<0>( info.param ).name ) + nameOf( std::get<1>( info.param ) );
}

TEST_P( MotionContract, LastValidIsWrittenOnFailureOnly )
{
	ob::ScopedState<> s1( rig.space ), s2( rig.space ), first( rig.space ), untouched( rig.space );
	ob::ScopedState<> on_curve( rig.space );
	rig.sample( rng, untouched.get() );
	int free = 0, stopped_on_the_way = 0;
	for ( int i = 0; i < 300; ++i )
	{
		rig.sampleValid( rng, s1.get() );
		rig.sample( rng, s2.get() );
		if ( i % 2 == 0 )
		{
			// shorter ones, or none would be free
			rig.space->interpolate( s1.get(), s2.get(), 0.2, s2.get() );
		}
		const ob::ScopedState<> s1_before( s1 ), s2_before( s2 );
		const bool valid = motions().checkMotion( s1.get(), s2.get() );

		first = untouched;
		std::pair<ob::State*, double> last_valid( first.get(), 0.37 );
		ASSERT_EQ( valid, motions().checkMotion( s1.get(), s2.get(), last_valid ) );
		ASSERT_EQ( last_valid.first, first.get() );
		ASSERT_TRUE( s1 == s1_before );
		ASSERT_TRUE( s2 == s2_before );
		std::pair<ob::State*, double> time_only( nullptr, 0.37 );
		ASSERT_EQ( valid, motions().checkMotion( s1.get(), s2.get(), time_only ) );
		ASSERT_EQ( time_only.first, nullptr );
		if ( valid )
		{
			++free;
			ASSERT_TRUE( first == untouched );
			ASSERT_EQ( last_valid.second, 0.37 );
			ASSERT_EQ( time_only.second, 0.37 );
			continue;
		}
		ASSERT_GE( last_valid.second, 0 );
		ASSERT_LT( last_valid.second, 1 );
		ASSERT_GE( time_only.second, 0 );
		ASSERT_LT( time_only.second, 1 );
		ASSERT_TRUE( rig.si->isValid( first.get() ) );
		rig.space->interpolate( s1.get(), s2.get(), last_valid.second, on_curve.get() );
		// for rotations OMPL's distance is an arc cosine: its noise is the root of the rounding
		ASSERT_LT( rig.space->distance( first.get(), on_curve.get() ), 1e-6 ) << last_valid.second;
		stopped_on_the_way += last_valid.second > 0;
	}
	EXPECT_GT( free, 30 );
	EXPECT_GT( stopped_on_the_way, 30 );
}

TEST_P( MotionContract, LastValidMayBeEitherEnd )
{
	ob::ScopedState<> s1( rig.space ), s2( rig.space ), separate( rig.space );
	ob::ScopedState<> copy1( rig.space ), copy2( rig.space );
	int free = 0, failed = 0;
	for ( int i = 0; i < 200; ++i )
	{
		rig.sampleValid( rng, s1.get() );
		rig.sample( rng, s2.get() );
		if ( i % 2 == 0 )
		{
			rig.space->interpolate( s1.get(), s2.get(), 0.2, s2.get() );
		}
		std::pair<ob::State*, double> apart( separate.get(), 0.37 );
		const bool valid = motions().checkMotion( s1.get(), s2.get(), apart );
		free += valid;
		failed += !valid;
		for ( bool start : { true, false } )
		{
			copy1 = s1;
			copy2 = s2;
			std::pair<ob::State*, double> alias( start ? copy1.get() : copy2.get(), 0.37 );
			ASSERT_EQ( valid, motions().checkMotion( copy1.get(), copy2.get(), alias ) );
			ASSERT_TRUE( ( start ? copy2 : copy1 ) == ( start ? s2 : s1 ) ) << "the other end was written";
			ob::ScopedState<>& result = start ? copy1 : copy2;
			if ( valid )
			{
				ASSERT_TRUE( result == ( start ? s1 : s2 ) );
				ASSERT_EQ( alias.second, 0.37 );
				continue;
			}
			ASSERT_TRUE( rig.si->isValid( result.get() ) );
			rig.space->interpolate( s1.get(), s2.get(), alias.second, separate.get() );
			ASSERT_LT( rig.space->distance( result.get(), separate.get() ), 1e-6 );
		}
	}
	EXPECT_GT( free, 20 );
	EXPECT_GT( failed, 20 );
}

TEST_P( MotionContract, EveryCheckIsCounted )
{
	rig.si->getMotionValidator()->resetMotionCounter();
	ob::ScopedState<> s1( rig.space ), s2( rig.space ), first( rig.space );
	unsigned valid = 0, invalid = 0;
	for ( int i = 0; i < 200; ++i )
	{
		rig.sampleValid( rng, s1.get() );
		rig.sample( rng, s2.get() );
		if ( i % 4 == 3 && rig.space->getType() == ob::STATE_SPACE_REAL_VECTOR )
		{
			s2[0] = 5; // out of bounds counts as well
		}
		std::pair<ob::State*, double> last_valid( first.get(), 0 );
		const bool answer = i % 2 == 0 ? motions().checkMotion( s1.get(), s2.get() )
									   : motions().checkMotion( s1.get(), s2.get(), last_valid );
		++( answer ? valid : invalid );
		ASSERT_EQ( motions().getValidMotionCount(), valid );
		ASSERT_EQ( motions().getInvalidMotionCount(), invalid );
	}
	EXPECT_GT( valid, 0u );
	EXPECT_GT( invalid, 0u );
}

TEST_P( MotionContract, LastValidOfAnInvalidEndIsNotTheEnd )
{
	// the end alone is invalid, by a hair: what is returned must be valid all the same
	ob::ScopedState<> s1( rig.space ), s2( rig.space ), low( rig.space ), high( rig.space ), middle( rig.space );
	for ( int i = 0; i < 30; ++i )
	{
		do
		{
			rig.sampleValid( rng, s1.get() );
			rig.sample( rng, s2.get() );
		} while ( rig.si->isValid( s2.get() ) );
		low = s1;
		high = s2;
		for ( int k = 0; k < 60; ++k )
		{
			rig.space->interpolate( low.get(), high.get(), 0.5, middle.get() );
			( rig.si->isValid( middle.get() ) ? low : high ) = middle;
		}
		std::pair<ob::State*, double> last_valid( middle.get(), 0.37 );
		ASSERT_FALSE( motions().checkMotion( s1.get(), high.get(), last_valid ) );
		ASSERT_LT( last_valid.second, 1 );
		ASSERT_TRUE( rig.si->isValid( middle.get() ) ) << last_valid.second;
	}
}

INSTANTIATE_TEST_SUITE_P( Worlds, MotionContract,
	testing::Combine( testing::ValuesIn( worlds() ),
		testing::Values( Validator::discrete, Validator::certified, Validator::steps ) ),
	motionName );

// ---- more than OMPL asks ----

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
	int free = 0, proved_on_the_way = 0, wrongly_refused = 0;
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
		wrongly_refused += !valid && lowest > options.min_d + 0.03;
	}
	EXPECT_GT( free, 20 );
	EXPECT_GT( proved_on_the_way, 10 );
	EXPECT_EQ( wrongly_refused, 0 );
}

INSTANTIATE_TEST_SUITE_P( Worlds, CertifiedMotion, testing::ValuesIn( worlds() ), worldName );

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
	EXPECT_EQ( after.free + after.blocked + after.refused, after.edges );
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

TEST( MotionCounters, ThreadsLoseNone )
{
	// motions out of bounds are answered at once: nothing but counting
	constexpr unsigned threads = 4, count = 200000;
	const Rig rig( gantryWorld() );
	ob::ScopedState<> good( rig.space ), bad( rig.space );
	good[0] = good[1] = -0.8;
	bad[0] = bad[1] = 2;
	rig.si->getMotionValidator()->resetMotionCounter();
	std::vector<std::thread> pool;
	for ( unsigned i = 0; i < threads; ++i )
	{
		pool.emplace_back( [&]
			{
				for ( unsigned k = 0; k < count; ++k )
				{
					rig.si->checkMotion( good.get(), bad.get() );
				}
			} );
	}
	for ( std::thread& thread : pool )
	{
		thread.join();
	}
	EXPECT_EQ( rig.si->getMotionValidator()->getInvalidMotionCount(), threads * count );
}

} // namespace
