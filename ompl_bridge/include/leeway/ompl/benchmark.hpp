// SPDX-License-Identifier: BSD-3-Clause
// leeway's counters in the log of OMPL's Benchmark, and from there in its database and Planner Arena.
#pragma once

#include "leeway/ompl/validity.hpp"

#include <ompl/tools/benchmark/Benchmark.h>

#include <map>
#include <string>

namespace leeway::ompl
{

/// Counts between two calls of Engine::counters().
Counters difference( const Counters& later, const Counters& earlier );

/// Counters as properties of a run: "leeway states INTEGER", "leeway edges INTEGER", "leeway edges free INTEGER", "...
/// blocked ...", "... undecided ...", "leeway edge queries INTEGER", "leeway motion costs INTEGER", "leeway cost edges
/// INTEGER", "leeway cost queries INTEGER". The last word is the column's type, for ompl_benchmark_statistics.py.
std::map<std::string, std::string> runProperties( const Counters& counters );

/// Adds runProperties() of each run to its properties. Sets the benchmark's pre-run and post-run events; Benchmark keeps one
/// of each and cannot return it, so pass your own events here: they are called after leeway's. Call it before benchmark().
///
/// OMPL calls the post-run event last: the counts include OMPL's checks of the solution (a second check of the path, its
/// clearance) and its simplification.
void addRunProperties( ::ompl::tools::Benchmark& benchmark, std::shared_ptr<const Engine> engine,
    ::ompl::tools::Benchmark::PreSetupEvent pre_run = {}, ::ompl::tools::Benchmark::PostSetupEvent post_run = {} );

} // namespace leeway::ompl
