// SPDX-License-Identifier: BSD-3-Clause
// The list of experiments: one factory each, defined with the experiment.
#pragma once

#include "report/experiment.hpp"

std::unique_ptr<Experiment> makePaperExperiment();
std::unique_ptr<Experiment> makeAblationExperiment();
std::unique_ptr<Experiment> makeTradeExperiment();

/// All of them, in the order of the report.
std::vector<std::unique_ptr<Experiment>> allExperiments();
