// SPDX-License-Identifier: BSD-3-Clause
// OMPL's rules for a state validity checker and for a motion validator, word by word, as tests of any pair of them. Compile
// conformance.cpp into a test program, and there
//
//     INSTANTIATE_TEST_SUITE_P( Mine, Conformance, testing::Values( subject ), conformance::name );
//
// The rules are those of OMPL's headers (StateValidityChecker.h, MotionValidator.h). Tests that go further, or that OMPL's
// own classes do not pass, may be left out by a subject that states why.
#pragma once

#include "seeded_rng.hpp"

#include <gtest/gtest.h>

#include <ompl/base/SpaceInformation.h>

#include <functional>
#include <ostream>
#include <string>
#include <vector>

namespace conformance
{

/// A promise that a subject does not make: the reason, or null if it does.
struct Exceptions
{
	const char* clearance = nullptr;    ///< clearance() is a lower bound of the truth, above 0 for valid states, else <= 0
	const char* bounds = nullptr;       ///< states out of the space's bounds are invalid, motions from or to them as well
	const char* non_finite = nullptr;   ///< so are those with a number that is not finite
	const char* start = nullptr;        ///< a motion from an invalid state is invalid (OMPL lets validators assume it valid)
	const char* whole_motion = nullptr; ///< nothing of a motion found valid is invalid, nor before the last valid state
	const char* again = nullptr;        ///< the motion from the start to the last valid state is valid
	const char* same_clearance = nullptr; ///< clearance() is the same number whatever was asked before
	const char* still = nullptr;          ///< the motion from a valid state to itself is valid
	const char* thread_counts = nullptr;  ///< the motion counters lose nothing when threads share the validator
};

/// States as numbers in the order of StateSpace::copyToReals().
struct Motion
{
	std::vector<double> from, to;
	bool valid;
};

/// One pair of checker and validator, ready to be asked, and the known truth.
struct Instance
{
	::ompl::base::SpaceInformationPtr si; ///< set up
	/// Writes a random state within the bounds, valid or not.
	std::function<void( SeededRng&, ::ompl::base::State* )> sample;
	/// By how much a state is valid, found by other means than those under test: > 0 valid, else invalid. In the unit of
	/// clearance(). Called from one thread at a time.
	std::function<double( const ::ompl::base::State* )> room;
	double tolerance = 1e-9;                         ///< of `room`: nearer to 0 than this either answer is right
	std::vector<std::vector<double>> valid, invalid; ///< states within the bounds
	std::vector<Motion> motions;                     ///< between valid states; at least one of each kind
	/// Makes a state of the given one that is out of bounds; empty if the space has none.
	std::function<void( SeededRng&, ::ompl::base::State* )> leave_bounds;
};

struct Subject
{
	std::string name; ///< letters and digits
	std::function<Instance()> make;
	Exceptions exceptions;
};

void PrintTo( const Subject& subject, std::ostream* out );
std::string name( const testing::TestParamInfo<Subject>& info );

} // namespace conformance

/// Checks are made with the seed that is printed when one fails.
class Conformance : public testing::TestWithParam<conformance::Subject>
{
protected:
	Conformance();
	~Conformance() override;

	const ::ompl::base::StateValidityChecker& checker() const { return *instance.si->getStateValidityChecker(); }
	const ::ompl::base::MotionValidator& motions() const { return *instance.si->getMotionValidator(); }
	::ompl::base::StateSpace& space() const { return *instance.si->getStateSpace(); }

	/// A state that lives as long as the test.
	::ompl::base::State* state();
	::ompl::base::State* state( const std::vector<double>& numbers );
	::ompl::base::State* copy( const ::ompl::base::State* other );
	void sampleValid( ::ompl::base::State* out );
	/// Both valid or not, every second one near the first.
	void samplePair( int round, ::ompl::base::State* s1, ::ompl::base::State* s2 );
	bool same( const ::ompl::base::State* a, const ::ompl::base::State* b ) const { return space().equalStates( a, b ); }

	conformance::Instance instance;
	SeededRng rng;

private:
	std::vector<::ompl::base::State*> m_states;
};
