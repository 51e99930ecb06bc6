// SPDX-License-Identifier: BSD-3-Clause
// leeway as OMPL's StateValidityChecker and MotionValidator. One immutable checker, one query per thread.
//
//     auto space = leeway::ompl::makeStateSpace( checker );
//     auto si = std::make_shared<ompl::base::SpaceInformation>( space );
//     leeway::ompl::install( si, checker, { .min_d = 0.01 } );
#pragma once

#include "leeway/handles.hpp"

#include <ompl/base/MotionValidator.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/StateSpace.h>
#include <ompl/base/StateValidityChecker.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace leeway::ompl
{

/// How states and motions are judged.
struct Options
{
	double min_d = 0;     ///< metres: smaller clearances are invalid
	/// Clearances are not measured beyond this; clearance() never returns more. +inf = always the exact distance.
	double max_d = 0.5;
	double alpha = 0;     ///< relative tolerance of clearance()
	double slack = 0.001; ///< metres: certified edges may refuse clearances in (min_d, min_d + slack]
	lw_edge_method method = LW_EDGE_CERTIFIED;
	double step = 0.01;   ///< metres: motion of any robot point per step, method LW_EDGE_STEPS
	lw_what what = LW_WHAT_BOTH;
};

/// The state space of a checker's group: RealVector if all variables are bounded numbers, otherwise a compound of
/// RealVector (bounded joints), SO2 (continuous joints), SE2 (planar) and SE3 (floating), subspaces named by joint.
/// Infinite position limits are replaced by +-`unbounded` metres.
/// @throws std::invalid_argument if a limit is unusable, naming the joint
std::shared_ptr<::ompl::base::StateSpace> makeStateSpace( const Checker& checker, double unbounded = 10.0 );

/// Copies states of a space (made by makeStateSpace(), or any nesting of RealVector, SO2, SE2, SE3 and compound spaces whose
/// dimensions fit, in order) to and from the checker's state vector. Understands constrained-space wrappers.
class StateAdapter
{
public:
	/// @throws std::invalid_argument if the space does not fit the checker or interpolates differently (Dubins, Reeds-Shepp, ...)
	StateAdapter( const ::ompl::base::StateSpacePtr& space, const Checker& checker );
	void toVector( const ::ompl::base::State* state, double* q ) const;
	void fromVector( const double* q, ::ompl::base::State* state ) const;
	std::size_t size() const { return m_size; }

private:
	struct Part
	{
		int kind;                       ///< of the subspace
		std::vector<std::size_t> path;  ///< subspace indices from the top
		std::size_t first, count;       ///< entries of the state vector
	};
	std::vector<Part> m_parts;
	std::size_t m_size = 0;
	bool m_constrained = false;
};

/// Totals of all threads since construction.
struct Counters
{
	std::uint64_t states = 0, edges = 0, free = 0, blocked = 0, refused = 0, edge_queries = 0;
};

/// What the checker and the validator share: checker, options, adapter, and a pool of queries, one per thread in use.
class Engine
{
public:
	Engine( const ::ompl::base::StateSpacePtr& space, Checker checker, const Options& options );
	~Engine();

	/// A query of the pool for the lifetime of the lease; no allocation once every thread has had one.
	class Lease
	{
	public:
		explicit Lease( const Engine& engine );
		~Lease();
		Lease( const Lease& ) = delete;
		Lease& operator=( const Lease& ) = delete;
		lw_query* query() const;
		double* a() const; ///< scratch state vectors of the adapter's size
		double* b() const;

	private:
		const Engine& m_engine;
		struct Slot* m_slot;
		friend class Engine;
	};

	const Checker& checker() const { return m_checker; }
	const Options& options() const { return m_options; }
	const StateAdapter& adapter() const { return m_adapter; }
	Counters counters() const;

private:
	friend class StateValidityChecker;
	friend class MotionValidator;
	struct Slot* acquire() const;
	void release( struct Slot* slot ) const;

	Checker m_checker;
	Options m_options;
	StateAdapter m_adapter;
	mutable std::atomic<struct Slot*> m_slots{ nullptr }; ///< all slots ever made, linked; each has a busy flag
	mutable std::atomic<std::uint64_t> m_states{ 0 }, m_edges{ 0 }, m_free{ 0 }, m_blocked{ 0 }, m_refused{ 0 }, m_queries{ 0 };
};

/// Valid = every clearance > min_d, proved, and the state is within the space's bounds. Errors are invalid.
class StateValidityChecker : public ::ompl::base::StateValidityChecker
{
public:
	StateValidityChecker( const ::ompl::base::SpaceInformationPtr& si, std::shared_ptr<const Engine> engine );
	bool isValid( const ::ompl::base::State* state ) const override;
	/// One evaluation for both answers.
	bool isValid( const ::ompl::base::State* state, double& dist ) const override;
	/// No state is offered: validStateAvailable is always set to false.
	bool isValid( const ::ompl::base::State* state, double& dist, ::ompl::base::State* validState,
		bool& validStateAvailable ) const override;
	/// Metres: a lower bound of (distance - min_d), capped at max_d - min_d; 0 in violation, where no depth is measured.
	double clearance( const ::ompl::base::State* state ) const override;
	double clearance( const ::ompl::base::State* state, ::ompl::base::State* validState,
		bool& validStateAvailable ) const override;

private:
	std::shared_ptr<const Engine> m_engine;
};

/// checkMotion() proved along the whole edge (or fixed steps), see lw_checker_edge().
class MotionValidator : public ::ompl::base::MotionValidator
{
public:
	MotionValidator( const ::ompl::base::SpaceInformationPtr& si, std::shared_ptr<const Engine> engine );
	bool checkMotion( const ::ompl::base::State* s1, const ::ompl::base::State* s2 ) const override;
	/// lastValid.first may alias s1 or s2; neither field is touched on success.
	bool checkMotion( const ::ompl::base::State* s1, const ::ompl::base::State* s2,
		std::pair<::ompl::base::State*, double>& lastValid ) const override;

private:
	std::shared_ptr<const Engine> m_engine;
};

/// Sets both on `si` and returns the shared engine. Call si->setup() afterwards as usual.
std::shared_ptr<const Engine> install( const ::ompl::base::SpaceInformationPtr& si, Checker checker, const Options& options = {} );

} // namespace leeway::ompl
