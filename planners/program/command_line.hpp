// SPDX-License-Identifier: BSD-3-Clause
// All subcommands with their options.
#pragma once

#include "program/options.hpp"

namespace leeway::cli
{

/// The options of each subcommand.
struct Commands
{
	InfoOptions info;
	CacheOptions cache;
	PairsOptions pairs;
	SpherizeOptions spherize;
	CheckOptions check;
	EdgeCommandOptions edge;
	PlanOptions plan;
	AuditOptions audit;
	RefereeOptions referee;
	TuneOptions tune;
	WorldOptions world;
	GuardOptions guard;
	ViewOptions view;
};

/// Adds the subcommands to the program; the options are written when it parses.
void addCommands( CLI::App& app, Commands& commands );

} // namespace leeway::cli
