// SPDX-License-Identifier: BSD-3-Clause
// leeway-bench's commands about experiments: one for each, --report for all of them, `report` and `compare` for stored
// results.
#pragma once

#include "report/experiment.hpp"

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

class ExperimentCommands
{
public:
	/// Adds subcommands and options. The app, and this, outlive the parse.
	explicit ExperimentCommands( CLI::App& app );
	/// True if something here was asked for.
	bool chosen() const;
	/// @return exit status: 0; 1 if a promise is broken, or compare found something worse; 77 without data
	/// @throws std::exception
	int run();

private:
	void addCommon( CLI::App& app );
	int runExperiments();
	int runCompare() const;

	std::vector<std::unique_ptr<Experiment>> m_all;
	std::vector<CLI::App*> m_commands; ///< of m_all
	CLI::App *m_app, *m_redraw, *m_compare;
	ExperimentSettings m_settings;
	std::string m_report, m_json, m_file, m_folder, m_before, m_after;
	std::vector<std::string> m_only;
	double m_threshold = 3;
	bool m_list_all = false, m_absolute = false;
};
