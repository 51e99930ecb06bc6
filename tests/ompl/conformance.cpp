// SPDX-License-Identifier: BSD-3-Clause
// The checks. Nothing here knows of leeway.
#include "conformance.hpp"

#include <ompl/util/Console.h>

#include <cmath>
#include <limits>
#include <thread>

namespace ob = ::ompl::base;

namespace conformance
{

void PrintTo( const Subject& subject, std::ostream* out )
{
	*out << subject.name;
}

std::string name( const testing::TestParamInfo<Subject>& info )
{
	return info.param.name;
}

} // namespace conformance

/// Leaves a test out that the subject gives a reason for.
#define PROMISED( what )                                                                                                    \
	if ( GetParam().exceptions.what != nullptr )                                                                            \
	GTEST_SKIP() << GetParam().exceptions.what

// For rotations OMPL's distance is an arc cosine: its noise is the root of the rounding.
constexpr double near_enough = 1e-6;

Conformance::Conformance() : instance( GetParam().make() )
{
	::ompl::msg::setLogLevel( ::ompl::msg::LOG_ERROR );
}

Conformance::~Conformance()
{
	for ( ob::State* state : m_states )
	{
		instance.si->freeState( state );
	}
}

ob::State* Conformance::state()
{
	m_states.push_back( instance.si->allocState() );
	instance.sample( rng, m_states.back() ); // never uninitialised
	return m_states.back();
}

ob::State* Conformance::state( const std::vector<double>& numbers )
{
	ob::State* result = state();
	space().copyFromReals( result, numbers );
	return result;
}

ob::State* Conformance::copy( const ob::State* other )
{
	ob::State* result = state();
	space().copyState( result, other );
	return result;
}

void Conformance::sampleValid( ob::State* out )
{
	do
	{
		instance.sample( rng, out );
	} while ( !checker().isValid( out ) );
}

void Conformance::samplePair( int round, ob::State* s1, ob::State* s2 )
{
	sampleValid( s1 );
	instance.sample( rng, s2 );
	if ( round % 2 == 0 )
	{
		space().interpolate( s1, s2, 0.2, s2 );
	}
}

// ---- states ----------------------------------------------------------------------------------------------------------

TEST_P( Conformance, KnownStatesAreRecognised )
{
	ASSERT_FALSE( instance.valid.empty() || instance.invalid.empty() ) << "nothing is known of this subject";
	for ( const std::vector<double>& numbers : instance.valid )
	{
		const ob::State* known = state( numbers );
		EXPECT_GT( instance.room( known ), 0 ) << "the test's own data";
		EXPECT_TRUE( checker().isValid( known ) );
		EXPECT_TRUE( instance.si->isValid( known ) );
	}
	for ( const std::vector<double>& numbers : instance.invalid )
	{
		const ob::State* known = state( numbers );
		EXPECT_LE( instance.room( known ), 0 ) << "the test's own data";
		EXPECT_FALSE( checker().isValid( known ) );
		EXPECT_FALSE( instance.si->isValid( known ) );
	}
}

TEST_P( Conformance, AllAnswersAboutAStateAgree )
{
	ob::State *asked = state(), *other = state();
	int valid = 0, invalid = 0;
	for ( int i = 0; i < 500; ++i )
	{
		instance.sample( rng, asked );
		const ob::State *asked_before = copy( asked ), *other_before = copy( other );
		double dist = -1, dist_with_state = -1;
		bool available = true, available_too = true;
		const bool is_valid = checker().isValid( asked );
		const double room = instance.room( asked );
		ASSERT_TRUE( is_valid == ( room > 0 ) || std::fabs( room ) <= instance.tolerance ) << room;
		ASSERT_EQ( is_valid, checker().isValid( asked, dist ) );
		ASSERT_EQ( is_valid, checker().isValid( asked, dist_with_state, other, available ) );
		const double clearance = checker().clearance( asked );
		// Subjects with an exception answer with bounds, each of them below the truth, not with one number
		const bool one = GetParam().exceptions.same_clearance == nullptr;
		for ( const double answer : { dist, dist_with_state, checker().clearance( asked, other, available_too ) } )
		{
			ASSERT_TRUE( one ? std::fabs( answer - clearance ) <= 1e-9 : ( answer > 0 ) == ( clearance > 0 ) )
			    << answer << ' ' << clearance;
			ASSERT_TRUE( one || answer <= std::max( room, 0.0 ) + instance.tolerance ) << answer << ' ' << room;
		}
		ASSERT_TRUE( available || same( other, other_before ) ) << "no state is offered, so none may be written";
		ASSERT_TRUE( available || available_too || same( other, other_before ) );
		ASSERT_TRUE( same( asked, asked_before ) ) << "the state asked about was written";
		ASSERT_EQ( is_valid, checker().isValid( asked ) ) << "asked twice";
		valid += is_valid;
		invalid += !is_valid;
	}
	EXPECT_GT( valid, 20 );
	EXPECT_GT( invalid, 20 );
}

TEST_P( Conformance, ClearanceIsALowerBound )
{
	PROMISED( clearance );
	ASSERT_EQ( checker().getSpecs().clearanceComputationType, ob::StateValidityCheckerSpecs::BOUNDED_APPROXIMATE );
	ob::State* asked = state();
	for ( int i = 0; i < 500; ++i )
	{
		instance.sample( rng, asked );
		double dist;
		const double room = instance.room( asked );
		const bool valid = checker().isValid( asked, dist );
		for ( double value : { dist, checker().clearance( asked ) } )
		{
			ASSERT_LE( value, std::fmax( room, 0 ) + instance.tolerance );
			ASSERT_EQ( value > 0, valid );
		}
	}
}

TEST_P( Conformance, NonFiniteStatesAreInvalid )
{
	PROMISED( non_finite );
	ob::State *good = state(), *last = state();
	sampleValid( good );
	std::vector<double> values;
	space().copyToReals( values, good );
	for ( unsigned i = 0; i < values.size(); ++i )
	{
		for ( double wrong : { std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
		          -std::numeric_limits<double>::infinity() } )
		{
			ob::State* bad = copy( good );
			*space().getValueAddressAtIndex( bad, i ) = wrong;
			double dist = -1;
			EXPECT_FALSE( checker().isValid( bad ) ) << i << " " << wrong;
			EXPECT_FALSE( checker().isValid( bad, dist ) ) << i << " " << wrong;
			EXPECT_LE( dist, 0 );
			EXPECT_LE( checker().clearance( bad ), 0 );
			EXPECT_FALSE( motions().checkMotion( good, bad ) );
			EXPECT_FALSE( motions().checkMotion( bad, good ) );
			EXPECT_FALSE( motions().checkMotion( bad, bad ) );
			std::pair<ob::State*, double> last_valid( last, 0.3 );
			EXPECT_FALSE( motions().checkMotion( good, bad, last_valid ) );
			EXPECT_EQ( last_valid.second, 0 );
			EXPECT_TRUE( same( last, good ) );
		}
	}
}

TEST_P( Conformance, StatesOutOfBoundsAreInvalid )
{
	PROMISED( bounds );
	if ( !instance.leave_bounds )
	{
		GTEST_SKIP() << "the space has no bounds";
	}
	ob::State *good = state(), *last = state();
	for ( int i = 0; i < 100; ++i )
	{
		sampleValid( good );
		ob::State* bad = copy( good );
		instance.leave_bounds( rng, bad );
		ASSERT_FALSE( space().satisfiesBounds( bad ) ) << "the test's own data";
		double dist;
		ASSERT_FALSE( checker().isValid( bad ) );
		ASSERT_FALSE( checker().isValid( bad, dist ) );
		ASSERT_FALSE( motions().checkMotion( good, bad ) );
		ASSERT_FALSE( motions().checkMotion( bad, good ) );
		std::pair<ob::State*, double> last_valid( last, 0.3 );
		ASSERT_FALSE( motions().checkMotion( good, bad, last_valid ) );
		ASSERT_TRUE( instance.si->isValid( last ) );
		ASSERT_GE( last_valid.second, 0 );
		ASSERT_LT( last_valid.second, 1 );
	}
}

// ---- motions ---------------------------------------------------------------------------------------------------------

TEST_P( Conformance, KnownMotionsAreRecognised )
{
	bool seen[2] = { false, false };
	for ( const conformance::Motion& motion : instance.motions )
	{
		const ob::State *from = state( motion.from ), *to = state( motion.to );
		ob::State* last = state();
		std::pair<ob::State*, double> last_valid( last, 0.37 );
		EXPECT_TRUE( checker().isValid( from ) && checker().isValid( to ) ) << "the test's own data";
		EXPECT_EQ( motions().checkMotion( from, to ), motion.valid );
		EXPECT_EQ( motions().checkMotion( to, from ), motion.valid );
		EXPECT_EQ( motions().checkMotion( from, to, last_valid ), motion.valid );
		seen[motion.valid] = true;
	}
	EXPECT_TRUE( seen[false] && seen[true] ) << "one of each kind must be known";
}

TEST_P( Conformance, LastValidIsWrittenOnFailureOnly )
{
	ob::State *s1 = state(), *s2 = state(), *first = state(), *on_curve = state();
	int free = 0, stopped_on_the_way = 0;
	for ( int i = 0; i < 300; ++i )
	{
		samplePair( i, s1, s2 );
		const ob::State *untouched = copy( first ), *s1_before = copy( s1 ), *s2_before = copy( s2 );
		std::pair<ob::State*, double> last_valid( first, 0.37 ), time_only( nullptr, 0.37 );
		const bool valid = motions().checkMotion( s1, s2, last_valid );
		ASSERT_EQ( valid, motions().checkMotion( s1, s2 ) );
		ASSERT_EQ( valid, motions().checkMotion( s1, s2, time_only ) );
		ASSERT_EQ( last_valid.first, first ) << "the pointer is the caller's";
		ASSERT_EQ( time_only.first, nullptr );
		ASSERT_TRUE( same( s1, s1_before ) && same( s2, s2_before ) );
		if ( valid )
		{
			++free;
			ASSERT_TRUE( same( first, untouched ) );
			ASSERT_EQ( last_valid.second, 0.37 );
			ASSERT_EQ( time_only.second, 0.37 );
			continue;
		}
		for ( double t : { last_valid.second, time_only.second } )
		{
			ASSERT_GE( t, 0 );
			ASSERT_LT( t, 1 );
		}
		ASSERT_TRUE( checker().isValid( first ) );
		space().interpolate( s1, s2, last_valid.second, on_curve );
		ASSERT_LT( space().distance( first, on_curve ), near_enough ) << last_valid.second;
		stopped_on_the_way += last_valid.second > 0;
	}
	EXPECT_GT( free, 30 );
	EXPECT_GT( stopped_on_the_way, 30 );
}

TEST_P( Conformance, TheMotionToTheLastValidStateIsValid )
{
	// KPIECE1 and its like keep it as an edge of their path, and do not ask again
	PROMISED( again );
	ob::State *s1 = state(), *s2 = state(), *last = state();
	int stopped_on_the_way = 0;
	for ( int i = 0; i < 300; ++i )
	{
		samplePair( i, s1, s2 );
		std::pair<ob::State*, double> last_valid( last, 0 );
		if ( !motions().checkMotion( s1, s2, last_valid ) && last_valid.second > 0 )
		{
			ASSERT_TRUE( motions().checkMotion( s1, last ) ) << last_valid.second;
			ASSERT_TRUE( motions().checkMotion( last, s1 ) ) << last_valid.second;
			++stopped_on_the_way;
		}
	}
	EXPECT_GT( stopped_on_the_way, 30 );
}

TEST_P( Conformance, LastValidMayBeEitherEnd )
{
	ob::State *s1 = state(), *s2 = state(), *separate = state();
	int free = 0, failed = 0;
	for ( int i = 0; i < 200; ++i )
	{
		samplePair( i, s1, s2 );
		std::pair<ob::State*, double> apart( separate, 0.37 );
		const bool valid = motions().checkMotion( s1, s2, apart );
		free += valid;
		failed += !valid;
		for ( bool start : { true, false } )
		{
			ob::State *copy1 = copy( s1 ), *copy2 = copy( s2 );
			ob::State* result = start ? copy1 : copy2;
			std::pair<ob::State*, double> alias( result, 0.37 );
			ASSERT_EQ( valid, motions().checkMotion( copy1, copy2, alias ) );
			ASSERT_TRUE( same( start ? copy2 : copy1, start ? s2 : s1 ) ) << "the other end was written";
			if ( valid )
			{
				ASSERT_TRUE( same( result, start ? s1 : s2 ) );
				ASSERT_EQ( alias.second, 0.37 );
				continue;
			}
			ASSERT_TRUE( checker().isValid( result ) );
			space().interpolate( s1, s2, alias.second, separate );
			ASSERT_LT( space().distance( result, separate ), near_enough );
		}
	}
	EXPECT_GT( free, 20 );
	EXPECT_GT( failed, 20 );
}

TEST_P( Conformance, LastValidOfAnInvalidEndIsNotTheEnd )
{
	// the end alone is invalid, by a hair: the returned state must be valid all the same
	ob::State *s1 = state(), *s2 = state(), *middle = state();
	for ( int i = 0; i < 30; ++i )
	{
		do
		{
			sampleValid( s1 );
			instance.sample( rng, s2 );
		} while ( checker().isValid( s2 ) );
		ob::State *low = copy( s1 ), *high = copy( s2 );
		for ( int k = 0; k < 60; ++k )
		{
			space().interpolate( low, high, 0.5, middle );
			space().copyState( checker().isValid( middle ) ? low : high, middle );
		}
		std::pair<ob::State*, double> last_valid( middle, 0.37 );
		ASSERT_FALSE( motions().checkMotion( s1, high, last_valid ) );
		ASSERT_LT( last_valid.second, 1 );
		ASSERT_TRUE( checker().isValid( middle ) ) << last_valid.second;
	}
}

TEST_P( Conformance, MotionsWithoutLengthAreTheirState )
{
	PROMISED( still );
	ob::State *s = state(), *last = state();
	for ( int i = 0; i < 100; ++i )
	{
		sampleValid( s );
		const ob::State* untouched = copy( last );
		std::pair<ob::State*, double> last_valid( last, 0.37 );
		ASSERT_TRUE( motions().checkMotion( s, s ) );
		ASSERT_TRUE( motions().checkMotion( s, copy( s ), last_valid ) );
		ASSERT_TRUE( same( last, untouched ) );
		ASSERT_EQ( last_valid.second, 0.37 );
	}
	for ( const std::vector<double>& numbers : instance.invalid )
	{
		s = state( numbers );
		EXPECT_FALSE( motions().checkMotion( s, s ) );
	}
}

TEST_P( Conformance, MotionsFromInvalidStatesAreInvalid )
{
	PROMISED( start );
	ob::State* s2 = state();
	for ( const std::vector<double>& numbers : instance.invalid )
	{
		const ob::State* s1 = state( numbers );
		ob::State* last = state();
		for ( int i = 0; i < 20; ++i )
		{
			sampleValid( s2 );
			std::pair<ob::State*, double> last_valid( last, 0.37 );
			EXPECT_FALSE( motions().checkMotion( s1, s2 ) );
			EXPECT_FALSE( motions().checkMotion( s1, s2, last_valid ) );
			EXPECT_EQ( last_valid.second, 0 );
			EXPECT_TRUE( same( last, s1 ) ) << "there is no valid state to return, but one must be written";
		}
	}
}

TEST_P( Conformance, EveryCheckIsCounted )
{
	instance.si->getMotionValidator()->resetMotionCounter();
	ob::State *s1 = state(), *s2 = state(), *first = state();
	unsigned valid = 0, invalid = 0;
	for ( int i = 0; i < 200; ++i )
	{
		samplePair( i / 2, s1, s2 );
		if ( i % 4 == 3 && instance.leave_bounds && GetParam().exceptions.bounds == nullptr )
		{
			instance.leave_bounds( rng, s2 ); // counts as well
		}
		std::pair<ob::State*, double> last_valid( first, 0 );
		const bool answer = i % 2 == 0 ? motions().checkMotion( s1, s2 ) : motions().checkMotion( s1, s2, last_valid );
		++( answer ? valid : invalid );
		ASSERT_EQ( motions().getValidMotionCount(), valid );
		ASSERT_EQ( motions().getInvalidMotionCount(), invalid );
	}
	EXPECT_GT( valid, 0u );
	EXPECT_GT( invalid, 0u );
}

TEST_P( Conformance, NothingOfAValidMotionIsInvalid )
{
	PROMISED( whole_motion );
	ob::State *s1 = state(), *s2 = state(), *between = state();
	int free = 0, partly = 0;
	for ( int i = 0; i < 100; ++i )
	{
		samplePair( i, s1, s2 );
		std::pair<ob::State*, double> last_valid( nullptr, 1 );
		const bool valid = motions().checkMotion( s1, s2, last_valid );
		for ( int k = 0; k <= 200; ++k )
		{
			const double t = last_valid.second * k / 200;
			space().interpolate( s1, s2, t, between );
			ASSERT_GT( instance.room( between ), -instance.tolerance ) << "t = " << t << " of " << last_valid.second;
		}
		free += valid;
		partly += !valid && last_valid.second > 0;
	}
	EXPECT_GT( free, 10 );
	EXPECT_GT( partly, 10 );
}

// ---- threads ---------------------------------------------------------------------------------------------------------

TEST_P( Conformance, ThreadsGetTheAnswersOfOne )
{
	constexpr std::size_t threads = 4, count = 200;
	struct Answer
	{
		bool state, motion, last_is_valid;
		double clearance;
	};
	std::vector<ob::State*> states, last;
	for ( std::size_t i = 0; i <= count; ++i )
	{
		states.push_back( state() );
		sampleValid( states.back() );
		last.push_back( state() );
	}
	auto ask = [&]( std::size_t first, std::size_t stride, std::vector<Answer>& answers )
	{
		for ( std::size_t i = first; i < count; i += stride )
		{
			Answer& answer = answers[i];
			answer.state = checker().isValid( states[i] );
			answer.clearance = checker().clearance( states[i] );
			std::pair<ob::State*, double> last_valid( last[i], 1 );
			answer.motion = motions().checkMotion( states[i], states[i + 1], last_valid );
			answer.last_is_valid = answer.motion || checker().isValid( last[i] );
		}
	};
	std::vector<Answer> alone( count ), together( count );
	ask( 0, 1, alone );
	std::vector<std::thread> pool;
	for ( std::size_t i = 0; i < threads; ++i )
	{
		pool.emplace_back( [&, i] { ask( i, threads, together ); } );
	}
	for ( std::thread& thread : pool )
	{
		thread.join();
	}
	std::size_t different = 0;
	for ( std::size_t i = 0; i < count; ++i )
	{
		ASSERT_EQ( alone[i].state, together[i].state ) << i;
		if ( GetParam().exceptions.same_clearance == nullptr )
		{
			ASSERT_NEAR( alone[i].clearance, together[i].clearance, 1e-9 ) << i;
		}
		ASSERT_TRUE( together[i].last_is_valid ) << i;
		different += alone[i].motion != together[i].motion;
	}
	// a proof near the limit of its slack may depend on earlier questions of its thread
	EXPECT_LE( different, count / 50 );
}

TEST_P( Conformance, ThreadsLoseNoCounts )
{
	PROMISED( thread_counts );
	constexpr unsigned threads = 4, count = 20000;
	ob::State *good = state(), *bad = state();
	sampleValid( good );
	instance.leave_bounds ? instance.leave_bounds( rng, bad ) : sampleValid( bad ); // out of bounds: nothing but counting
	instance.si->getMotionValidator()->resetMotionCounter();
	std::vector<std::thread> pool;
	for ( unsigned i = 0; i < threads; ++i )
	{
		pool.emplace_back(
		    [&]
		    {
			    for ( unsigned k = 0; k < count; ++k )
			    {
				    motions().checkMotion( good, bad );
			    }
		    } );
	}
	for ( std::thread& thread : pool )
	{
		thread.join();
	}
	EXPECT_EQ( motions().getCheckedMotionCount(), threads * count );
}
