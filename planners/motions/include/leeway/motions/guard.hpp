// SPDX-License-Identifier: BSD-3-Clause
// A motion that runs while its world changes: leeway/guard.h for problems and trajectories.
//
//     leeway::motions::Guard guard( *world.problem(), segments, settings );
//     guard.publish( world.move( "cup", pose ), stamp );                    // the writer's thread
//     const lw_guard_answer answer = guard.ask( now, 800 );                 // the controller's cycle
#pragma once

#include "leeway/guard.h"
#include "leeway/io/model.hpp"
#include "leeway/motions/trajectory.hpp"

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

namespace leeway::motions
{

struct GuardSettings
{
	lw_edge_def edge = lw_edge_def_default(); ///< min_d, slack, flags; without its tolerance
	double contact_resolution = 1e-3;         ///< seconds, to which the first contact is searched for; 0: any contact
	double window = 0.5;                      ///< seconds, > 0: proved at a time
	std::vector<double> tolerance;            ///< [group variables] of the controller, radians and metres; empty: none
	double lag = 0;                           ///< seconds, >= 0: it may be early or late
	std::vector<double> deceleration; ///< [group variables] per squared second, > 0; empty: Guard::stop() is an error
	double reaction = 0;              ///< seconds, >= 0, from an order to stop to the braking
	std::uint32_t spare_shapes = 256; ///< worlds may have so many shapes more than the first one
	std::uint32_t spare_bodies = 8;   ///< of objects that are attached later
};

/// One thread publishes, another one asks; calls of either kind take turns among themselves. Times are seconds of the motion. The asking
/// calls allocate nothing and take no lock, but throw if the core refuses: for a hard cycle use get() and leeway/guard.h.
class Guard
{
public:
	/// The checker of the problem is the first world; a reference is kept. @param segments of all variables of the group @throws io::Error
	Guard( const io::Problem& problem, const std::vector<Segment>& segments, const GuardSettings& settings );
	/// Several parts on one clock, as Schedule::clock() has it. `settings` has no deceleration, tolerance and lag: the tracks have these.
	Guard( const io::Problem& problem, const lw_clock& clock, double end, const GuardSettings& settings );

	/// @param checker of io::World, or lw_checker_edit() @param stamp above that before @throws io::Error
	void publish( const Checker& checker, std::uint64_t stamp );

	static constexpr double no_budget = std::numeric_limits<double>::infinity();
	/// @param budget microseconds @throws io::Error
	lw_guard_answer ask( double now, double budget = no_budget );
	/// @throws io::Error
	lw_guard_answer stop( double from, double budget = no_budget );
	/// NaN if no stop is proved. @throws io::Error
	double brakeBy( double now, double until, double step, double budget = no_budget );
	/// @throws io::Error
	lw_guard_scale speed(
	    const lw_separation& separation, double now, double age, double highest = 1, double budget = no_budget );

	double end() const { return m_end; }
	lw_guard* get() const { return m_guard.get(); }

private:
	void make( const io::Problem& problem, const lw_clock& clock, const GuardSettings& settings );
	std::string m_file; ///< for errors
	double m_end;
	GuardHandle m_guard;
};

} // namespace leeway::motions
