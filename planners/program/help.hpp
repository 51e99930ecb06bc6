// SPDX-License-Identifier: BSD-3-Clause
// Help texts of the program. `--help` fits a screen: common options and a summary. `--help-all` adds the other options and the details.
#pragma once

#include <string>

namespace CLI
{
class App;
class Option;
} // namespace CLI

namespace leeway::cli
{

/// Notes whether the command line asks for the short help or for all of it. Call it once, before options are added.
void chooseHelp( int argc, const char* const* argv );

/// Marks an option that only --help-all lists; it works either way.
CLI::Option* rare( CLI::Option* option );

/// Sets the footer of a subcommand: `summary`, and with --help-all also `details`.
void addHelp( CLI::App& command, const std::string& summary, const std::string& details );

/// Texts of `leeway --help`.
extern const char* const about;
extern const char* const footer;

/// Texts of one subcommand.
struct HelpText
{
	const char* summary;
	const char* details;
};
extern const HelpText info_help, pairs_help, cache_help, spherize_help, check_help, edge_help, plan_help, audit_help,
    referee_help, guard_help, tune_help, world_help, view_help;

} // namespace leeway::cli
