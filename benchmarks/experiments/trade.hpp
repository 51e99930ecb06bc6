// SPDX-License-Identifier: BSD-3-Clause
// The experiment `trade`: the accuracy that each knob gives up for speed, observed beside promised.
//
// The truth comes from independent sources: FCL for states (in worlds that it can represent), the auditor of tests/support
// for motions, doubles for floats.
#pragma once

#include "experiments/trade_promise.hpp"

#include <memory>

/// Errors that can be put into the answers, to see that the run fails.
struct TradeSettings
{
	std::string inject; ///< empty, or a knob: alpha, min_d, max_d, range, float, slack, certified, steps
};

/// States: alpha, min_d, max_d, and random ranges.
void addTradeStates( const ExperimentSettings& settings, const TradeSettings& trade, Progress& progress, Outcome& out );

/// Motions: slack and alpha of certificates, fixed steps with and without a margin.
void addTradeMotions( const ExperimentSettings& settings, const TradeSettings& trade, Progress& progress, Outcome& out );

/// The float filters against doubles.
void addTradeFloats( const ExperimentSettings& settings, const TradeSettings& trade, Progress& progress, Outcome& out );

std::unique_ptr<Experiment> makeTradeExperiment( const TradeSettings& trade );
std::unique_ptr<Experiment> makeTradeExperiment();
