// SPDX-License-Identifier: BSD-3-Clause
// leeway as OMPL's StateValidityChecker and MotionValidator. One immutable checker, one query per thread.
//
//     auto space = leeway::ompl::makeStateSpace( checker );
//     auto si = std::make_shared<ompl::base::SpaceInformation>( space );
//     leeway::ompl::install( si, checker );
//     si->setup();
//
// Works with OMPL 1.5.2 to 2.0. Any number of threads may call const members at the same time.
#pragma once

#include "leeway/handles.hpp"

#include <ompl/base/MotionValidator.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/StateSpace.h>
#include <ompl/base/StateValidityChecker.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace leeway::ompl
{

/// Settings of the state and motion checks.
struct Options
{
	double min_d = 0; ///< metres, >= 0: smaller clearances are invalid
	/// Metres, > min_d. Larger clearances are not measured; clearance() never returns more than max_d - min_d. +inf = always
	/// the exact distance. A cap makes plateaus: an objective that maximises clearance sees no gain above it.
	double max_d = 0.5;
	double alpha = 0; ///< relative tolerance of clearance(), [0, 1)
	/// Metres, > 0: certified edges may refuse clearances from min_d up to (min_d + slack) / 0.9. It is an upper bound that
	/// needs no tuning: nearer pairs get a slack of their own, see lw_edge_def. Engine::undecidedPairs() lists them.
	double slack = 0.001;
	lw_edge_method method = LW_EDGE_CERTIFIED;
	double step = 0.01; ///< metres, > 0: motion of any robot point per step, method LW_EDGE_STEPS
	lw_check_flags flags = LW_CHECK_BOTH;
	/// Radians and metres, [size of the state vector] or empty: a valid motion is free for every motion within the tolerance of
	/// it, variable by variable, such as a controller may drive before it stops (lw_edge_def::tolerance). 0 for quaternions. Method
	/// CERTIFIED. States and costs know nothing of it: a valid state from which no motion is valid is too near to something.
	std::vector<double> tolerance;
	/// install() makes the deferred meshes that states within the limits can need, on all cores (leeway::prepare()):
	/// milliseconds once, instead of delays while a planner runs.
	bool prepare = true;
};

/// The state space of a checker's group, in the order of its state vector: RealVector if all variables are bounded numbers
/// (dimensions named by joint), otherwise a compound of RealVector (each bounded joint), SO2 (continuous joints), SE2
/// (planar) and SE3 (floating), subspaces named by joint, all of weight 1 so that a radian and a metre count the same.
/// Infinite position limits are replaced by +-`unbounded` metres. A joint whose limits are equal gets a range of 1e-9 about
/// them, because OMPL cannot set up a space without extent. A default projection is registered (the first three numbers;
/// OMPL's own above two dimensions of RealVector).
/// @throws std::invalid_argument if a limit is unusable, or a planar or floating joint's variables are not together and in
/// order, naming the joint
std::shared_ptr<::ompl::base::StateSpace> makeStateSpace( const Checker& checker, double unbounded = 10.0 );

/// Copies states of a space to and from the checker's state vector. The space is one made by makeStateSpace(), or any
/// nesting of RealVector, SO2, SO3, SE2, SE3, compound and wrapper spaces (or of their subclasses with the same state
/// layout) whose numbers, in order, are those of the state vector.
///
/// Certified edges follow lw_robot_interpolate(). The constructor tests whether the space interpolates along the same curve:
/// by type (spaces on a constraint manifold do not) and by comparing the space's interpolate() with the formulas below on
/// random states (Dubins, Reeds-Shepp and other overrides do not). For other curves straight() is false: states can still be
/// checked one by one, and MotionValidator refuses the space.
class StateAdapter
{
public:
	/// @throws std::invalid_argument if the space does not fit the checker; the message says where
	StateAdapter( const ::ompl::base::StateSpacePtr& space, const Checker& checker );

	void toVector( const ::ompl::base::State* state, double* q ) const;
	/// Wraps angles of SO2 subspaces into [-pi, pi) and copies all other numbers unchanged.
	void fromVector( const double* q, ::ompl::base::State* state ) const;
	std::size_t size() const { return m_size; }
	const ::ompl::base::StateSpacePtr& space() const { return m_space; }

	bool straight() const { return m_curve_problem.empty(); }
	const std::string& curveProblem() const { return m_curve_problem; } ///< why straight() is false

	/// The state at t on OMPL's own curve from a to b: linear in RealVector, SO2 and SO3 as OMPL computes them.
	/// @param out [size()], must not alias a or b
	void interpolate( const double* a, const double* b, double t, double* out ) const;

	/// Number of equal parts of OMPL's curve such that on each part the curve and lw_robot_interpolate() agree. Nearly
	/// always 1; more if a wrapping angle moves by pi or more (the long way round in a RealVector dimension, or exactly
	/// opposite), or if two rotations are opposite: there rounding decides the shorter way.
	unsigned pieceCount( const double* a, const double* b ) const;

	/// OMPL treats rotations with |<q1, q2>| > 1 - 1e-9 (less than 9e-5 rad apart) as equal: its curve keeps the first one
	/// and jumps at the end. True if a and b have such rotations that are not identical; replaceCloseRotations() makes them
	/// identical.
	bool hasCloseRotations( const double* a, const double* b ) const;
	/// Copies the rotations of `from` that are close to those of q into q.
	void replaceCloseRotations( const double* from, double* q ) const;

	/// Moves numbers outside the space's bounds (by rounding) back onto them, and normalises quaternions.
	void enforceBounds( double* q ) const;

private:
	enum class Kind
	{
		Vector,  ///< RealVectorStateSpace
		Angle,   ///< SO2StateSpace
		Rotation ///< SO3StateSpace
	};
	struct Part
	{
		Kind kind;
		std::vector<unsigned> path;           ///< component indices from the top
		std::size_t first, count;             ///< entries of the state vector
		const ::ompl::base::StateSpace* leaf; ///< owned by m_space
	};
	void collect( const ::ompl::base::StateSpace* space, std::vector<unsigned>& path );
	void match( const Checker& checker );
	void compareCurves();
	const ::ompl::base::State* component( const ::ompl::base::State* state, const Part& part ) const;

	::ompl::base::StateSpacePtr m_space;
	std::vector<Part> m_parts;
	std::vector<std::size_t> m_wrapping; ///< entries that are angles without limits, in parts of any kind
	std::size_t m_size = 0;
	unsigned m_wrappers = 0; ///< levels of WrapperStateSpace around the space
	std::string m_curve_problem;
};

class EdgeProver; // one motion's proof, private
struct ProvedMotion;

/// Totals of all threads since construction.
struct Counters
{
	std::uint64_t states = 0; ///< states checked
	std::uint64_t edges = 0;  ///< motions checked: free + blocked + undecided + errors
	std::uint64_t free = 0;
	std::uint64_t blocked = 0;
	std::uint64_t undecided = 0;
	std::uint64_t edge_queries = 0; ///< states at which edges measured distances
	std::uint64_t motion_costs = 0; ///< motion costs computed by ClearanceObjectives
	std::uint64_t cost_edges = 0;   ///< edge checks for these costs
	std::uint64_t cost_queries = 0; ///< states at which these costs measured distances
};

/// Motions left undecided by one pair: neither proved free nor found to collide.
struct UndecidedPair
{
	std::uint64_t count = 0;
	bool self = false;
	std::string first, second; ///< links, or a link and an object; both empty: motions too long to check
	double clearance = 0;      ///< metres: the smallest clearance at an undecided verdict
};

/// Shared by the state checker and the motion validator: core checker, options, adapter, and a pool of queries, one per
/// thread in use. The pool grows when a thread first uses it and never shrinks; after that calls neither allocate nor wait,
/// except the first call of a thread after update().
class Engine
{
public:
	/// @throws std::invalid_argument (options, space), CoreError (no memory for the first query)
	Engine( const ::ompl::base::StateSpacePtr& space, Checker checker, const Options& options );
	~Engine();
	Engine( const Engine& ) = delete;
	Engine& operator=( const Engine& ) = delete;

	Checker checker() const; ///< the checker of new calls
	/// Replaces the checker by another one of the same group: from lw_checker_edit() or io::World. Calls in progress finish
	/// with the old checker; later calls use the new one. Any thread may call it at any time; it waits for no other call,
	/// and no other call waits for it. A thread that makes no more calls keeps its last checker in memory until its next
	/// call. Planners keep their own data: edges that they proved earlier are not proved in the new scene.
	/// @throws std::invalid_argument if its state vector differs; the message says where
	void update( Checker checker );
	const Options& options() const { return m_options; }
	const StateAdapter& adapter() const { return m_adapter; }
	Counters counters() const;
	/// Undecided pairs since the last update(), the most frequent first. The list holds up to 32 pairs; counts of further
	/// pairs are only in counters().
	std::vector<UndecidedPair> undecidedPairs() const;
	/// Human-readable summary of undecidedPairs() with a remedy; empty if no motion was undecided.
	std::string describeUndecided() const;
	/// Queries in the pool: the largest number of threads that used the engine at the same time.
	std::size_t queryCount() const;

private:
	struct Slot;

public:
	/// Holds one query of the pool for the lifetime of the lease.
	class Lease
	{
	public:
		explicit Lease( const Engine& engine ) : m_engine( engine ), m_slot( engine.acquire() ) {}
		~Lease();
		Lease( const Lease& ) = delete;
		Lease& operator=( const Lease& ) = delete;
		/// False if there was no memory for another query: treat the state or motion as invalid.
		explicit operator bool() const { return m_slot != nullptr; }
		lw_query* query() const;
		const lw_checker* checker() const; ///< the checker for the lifetime of this lease
		double* a() const;                 ///< scratch state vectors of the adapter's size; null without a slot
		double* b() const;
		/// Adds work that was done with query() by calls of the core: for planners that judge motions without OMPL.
		void count( const Counters& work ) const;
		/// Adds `times` undecided motions of a pair to undecidedPairs(). LW_INVALID_INDEX: motions too long to check.
		void countUndecided( bool self, std::uint32_t a, std::uint32_t b, std::uint64_t times, double clearance ) const;

	private:
		friend class StateValidityChecker;
		friend class EdgeProver;
		const Engine& m_engine;
		Slot* m_slot;
	};

private:
	friend class StateValidityChecker;
	friend class MotionValidator;
	friend class EdgeProver;
	Slot* acquire() const; ///< nullptr if out of memory
	Slot* makeSlot() const;
	bool refresh( Slot& slot ) const;                   ///< the slot gets the snapshot of now; false if out of memory
	Query makeQuery( const lw_checker* checker ) const; ///< null if out of memory
	void noteUndecided( bool self, const lw_clearance& pair ) const; ///< allocates nothing
	void addUndecided( bool self, std::uint32_t a, std::uint32_t b, std::uint64_t times, double clearance ) const;

	struct UndecidedIds
	{
		bool self;
		std::uint32_t a, b; ///< of m_checker; LW_INVALID_INDEX: no pair
		std::uint64_t count;
		double clearance;
	};

	mutable std::mutex m_mutex; ///< of m_checker and undecided pairs, which are rare and cost milliseconds each
	Checker m_checker;
	mutable std::array<UndecidedIds, 32> m_undecided{};
	mutable std::size_t m_undecided_count = 0;
	std::atomic<std::uint64_t> m_version{ 1 }; ///< of m_checker: slots with another one are out of date
	Options m_options;
	StateAdapter m_adapter;
	std::uint64_t m_id;                            ///< never used twice: threads remember their last slot by it
	mutable std::atomic<Slot*> m_slots{ nullptr }; ///< all slots ever made, linked; each has a busy flag
};

/// Valid = every clearance > min_d, proved, and the state is within the space's bounds. Errors are invalid.
class StateValidityChecker : public ::ompl::base::StateValidityChecker
{
public:
	/// @param si its space must be the object that the engine was made with
	/// @throws std::invalid_argument if it is another space
	StateValidityChecker( const ::ompl::base::SpaceInformationPtr& si, std::shared_ptr<const Engine> engine );
	bool isValid( const ::ompl::base::State* state ) const override;
	/// One evaluation for both answers.
	bool isValid( const ::ompl::base::State* state, double& dist ) const override;
	/// Never writes validState: validStateAvailable is always set to false.
	bool isValid( const ::ompl::base::State* state, double& dist, ::ompl::base::State* validState,
	    bool& validStateAvailable ) const override;
	/// Metres: a lower bound of (distance - min_d), capped at max_d - min_d; 0 in violation (penetration is not measured).
	double clearance( const ::ompl::base::State* state ) const override;
	double clearance(
	    const ::ompl::base::State* state, ::ompl::base::State* validState, bool& validStateAvailable ) const override;

	const std::shared_ptr<const Engine>& engine() const { return m_engine; }

private:
	bool evaluate( const ::ompl::base::State* state, double& dist ) const;
	std::shared_ptr<const Engine> m_engine;
};

/// checkMotion() with a proof along the whole edge (or by fixed steps), see lw_checker_edge(). A motion is invalid if an end
/// is out of bounds, if it is undecided, or if an error occurs. The certified curve is OMPL's own, the curve of the space's
/// interpolate() (StateAdapter handles the special cases), up to rounding of single coordinates. Conditions of other state
/// validity checkers are ignored.
class MotionValidator : public ::ompl::base::MotionValidator
{
public:
	/// @param si its space must be the object that the engine was made with
	/// @throws std::invalid_argument if it is another space, or if its curves are not straight edges
	/// (StateAdapter::straight())
	MotionValidator( const ::ompl::base::SpaceInformationPtr& si, std::shared_ptr<const Engine> engine );
	bool checkMotion( const ::ompl::base::State* s1, const ::ompl::base::State* s2 ) const override;
	/// On failure lastValid.first, if not null, receives the end of the proved part of the motion, after a check of that
	/// state by itself; or s1 if that check fails. lastValid.second in [0, 1) is its place. lastValid.first may alias s1 or
	/// s2. On success neither field is changed.
	///
	/// Certified: the proved part ends before the first clearance of (min_d + slack) / 0.9 or less, without a tolerance. So a later check of the
	/// motion from s1 to the last valid state never refuses: planners such as KPIECE1 keep that motion as an edge without
	/// checking it. If s1 itself is nearer than that, the proved part ends later, and the motion to its end is proved in
	/// both directions before it is returned (two to ten proofs more).
	bool checkMotion( const ::ompl::base::State* s1, const ::ompl::base::State* s2,
	    std::pair<::ompl::base::State*, double>& lastValid ) const override;

	const std::shared_ptr<const Engine>& engine() const { return m_engine; }

private:
	ProvedMotion prove( const EdgeProver& prover, const lw_edge_def& def ) const;
	struct ProvedRun
	{
		double until;      ///< place on the motion
		bool within_slack; ///< it may end where the motion up to there would be undecided
	};
	bool isFreeBothWays( const EdgeProver& prover ) const;
	ProvedRun proveRun( const EdgeProver& prover ) const;
	double writeLastValid(
	    const EdgeProver& prover, const ProvedRun& run, const ::ompl::base::State* s1, ::ompl::base::State* out ) const;
	bool count( bool valid ) const;
	std::shared_ptr<const Engine> m_engine;
	lw_edge_def m_def;
	std::vector<double> m_last_tolerance; ///< of m_last_def
	lw_edge_def m_last_def;               ///< for the run up to the last valid state
};

/// Sets a StateValidityChecker and a MotionValidator on `si` and returns their engine. Call si->setup() afterwards as usual.
/// @throws as Engine and MotionValidator. For spaces whose curves are not straight, make an Engine and set only a
/// StateValidityChecker: OMPL's own motion validator then checks states along the motion.
std::shared_ptr<Engine> install( const ::ompl::base::SpaceInformationPtr& si, Checker checker, const Options& options = {} );

} // namespace leeway::ompl
