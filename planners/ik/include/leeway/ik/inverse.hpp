// SPDX-License-Identifier: BSD-3-Clause
// Inverse kinematics of one frame: the states of a group in which a tip has a pose, one state or all branches.
//
//     leeway::ik::Inverse inverse( robot, problem, { hand, tool } );
//     leeway::ik::InverseStates found = inverse.solve( pose, start );
//     for ( const leeway::ik::InverseState& state : found.states ) { ... }       // or found.problem says why there is none
//
// Revolute, continuous, prismatic and planar joints, in any number, and joints that mimic others. Descents of damped least squares (descent.hpp)
// begin at the start and at random states. A state counts if the engine's own forward kinematics has the tip within 1e-9 m and 1e-9 rad of
// the pose, and all joints are within their limits. Goals with tolerances and of several links: goal_states.hpp.
#pragma once

#include "leeway/ik/goal_states.hpp"

#include <cmath>
#include <memory>

namespace leeway::ik
{

struct InverseOptions
{
	/// The search ends with this many; with 1 at the first, to which the start leads if it leads to any. With `clearances` those
	/// above min_d count.
	std::size_t states = 16;
	std::size_t searches = 500; ///< descents, at most; a quarter of them if none reaches the pose
	/// The search ends after this many descents in a row, for each state that is known and one more, that find known states only.
	/// One of several branches of equal shares is missed once in exp( patience ) poses.
	double patience = 8;
	std::uint64_t seed = 1; ///< of random starts: equal seeds give equal states
	/// Two states that differ by less in every variable, whole turns left out, are one. Radians or metres.
	double apart = 0.01;
	/// Joints with limits at least a whole turn apart have several values for one pose. False: the nearest to the start; true: each
	/// is a state.
	bool turns = false;
	bool clearances = false; ///< certify them: InverseState::lower, upper
	lw_check_flags flags = LW_CHECK_BOTH;
	double min_d = 0;        ///< metres: states with a larger clearance come first
	double max_d = HUGE_VAL; ///< metres: larger clearances are not measured
};

struct InverseState
{
	std::vector<double> q; ///< [variables of the group] within the limits
	double lower = NAN,
	       upper = NAN; ///< metres: the least clearance is between them, see lw_clearance; NaN without `clearances`
};

struct InverseStates
{
	/// The nearest to the start first (Euclidean, radians and metres alike); with `clearances` all with lower > min_d before the others.
	/// Variables that do not move the tip in the base keep their start value, or the nearest within their limits.
	/// Continuous joints are within half a turn of the start.
	std::vector<InverseState> states;
	Failure failure = Failure::NONE; ///< IN_COLLISION: there are states, none with a clearance above min_d
	std::string problem, remedy;     ///< of the failure, for people
	std::size_t searches = 0;
	/// UNREACHABLE, OUT_OF_LIMITS: metres and radians between the pose and the nearest that a descent within the limits came to; else 0.
	double metres = 0, radians = 0;
};

/// For one group and one pair of frames. One thread at a time; make one for each thread.
class Inverse
{
public:
	/// @param robot the model that `problem` was built from; both must outlive it
	/// @param tip the frame that has the pose @param base of the pose; its link may move
	/// @throws io::Error: the group moves neither frame, or has a floating joint (goal_states.hpp takes these)
	/// Cost: 20 us
	Inverse( const io::RobotModel& robot, const io::Problem& problem, const io::Frame& tip, const io::Frame& base = {} );
	~Inverse();
	Inverse( Inverse&& ) noexcept;
	Inverse& operator=( Inverse&& ) noexcept;

	/// States in which the tip has a pose in the base. For arms of up to six joints the branches, found by random starts and so without a
	/// proof that none is missed; with more joints samples of the family of states, of which the nearest to the start are the densest.
	/// @param start [variables] the first descent begins there; nullptr: io::startState(). Other joints are at problem.reference.
	/// @param query of problem.checker, for clearances; nullptr: one of its own
	/// @throws io::Error: a pose that is no rigid motion, a start that is not finite, options out of their ranges. CoreError
	/// Cost: 5 to 20 us for one state of a seven-joint arm from a near start, 1 to 4 ms for all branches of a six-joint arm, clearances apart
	InverseStates solve( const lw_transform& pose, const double* start = nullptr, const InverseOptions& options = {},
	    lw_query* query = nullptr );

private:
	class Search;
	std::unique_ptr<Search> m_search;
};

} // namespace leeway::ik
