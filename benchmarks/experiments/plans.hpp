// SPDX-License-Identifier: BSD-3-Clause
// The experiment `plans`: the kitchen reaches end to end, planned with motions judged in different ways, logged by OMPL's
// Benchmark.
#pragma once

#include "experiments/trade_promise.hpp"

#include <memory>

struct PlansSettings
{
	std::size_t runs = 0; ///< of each setting on each reach; 0: by the size of the experiment
	double seconds = 0;   ///< for planning, each run; 0: the same
	std::string only;     ///< reaches whose name has this in it
	std::string inject; ///< empty, or "certified": paths of proved motions are taken for bad ones, to see that the run fails
};

std::unique_ptr<Experiment> makePlansExperiment( const PlansSettings& plans );
std::unique_ptr<Experiment> makePlansExperiment();
