// SPDX-License-Identifier: BSD-3-Clause
// The experiments there are: see experiments.hpp.
#include "experiments/experiments.hpp"

std::vector<std::unique_ptr<Experiment>> allExperiments()
{
	std::vector<std::unique_ptr<Experiment>> all;
	all.push_back( makePaperExperiment() );
	all.push_back( makeAblationExperiment() );
	all.push_back( makeTradeExperiment() );
	return all;
}
