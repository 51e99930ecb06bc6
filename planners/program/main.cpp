// SPDX-License-Identifier: BSD-3-Clause
// The program leeway: command line, and errors as one line.
#include "program/command_line.hpp"
#include "program/help.hpp"
#include "motions/names.hpp"
#include "program/output.hpp"

#include "leeway/io/model.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <exception>
#include <filesystem>
#include <functional>
#include <new>
#include <regex>
#include <unistd.h>

namespace leeway::cli
{
namespace
{

/// One question at a time, and no option of the other one.
void validate( const AuditOptions& options )
{
	const auto wrong = []( const char* element, const char* problem, const char* remedy )
	{ throw io::Error( "command line", element, problem, remedy ); };
	const bool path = !options.path.empty(), trajectory = !options.trajectory.empty(), steps = !options.steps.empty();
	if ( path + trajectory + steps != 1 )
	{
		wrong( "--path", path || trajectory ? "is one of several questions: --path, --trajectory, --steps" : "is missing",
		    "give one of --path, --trajectory and --steps" );
	}
	const bool blend = options.corner_blend != 0;
	if ( path && ( !options.joint_limits.empty() || options.interpolation != "auto" ) )
	{
		wrong( "--path", "a path has no times: --interpolation and --joint-limits are for --trajectory",
		    "leave them out, or give a timed trajectory" );
	}
	if ( path && !blend && options.certificate.empty() && !options.tolerance.empty() )
	{
		wrong( "--tolerance", "states of a path are measured, not proved",
		    "add --corner-blend or --certificate, or give a timed trajectory" );
	}
	if ( !path && blend )
	{
		wrong( "--corner-blend", "a timed trajectory is driven as it is, without rounding its corners",
		    "give the path that is yet to be timed, by --path" );
	}
	if ( !trajectory && !options.corridor.empty() )
	{
		wrong( "--corridor", "is about one timed trajectory", "give it by --trajectory" );
	}
}

void validate( const CLI::App& chosen, const ViewOptions& options )
{
	if ( options.out.empty() && options.picture.file.empty() )
	{
		throw io::Error( "command line", "--out", "is missing", "give --out page.html, or --png picture.png" );
	}
	requirePositive( "--triangles", options.triangles );
	cli::validate( chosen, options.picture );
}

void validate( const CLI::App& chosen, const CheckOptions& options )
{
	if ( chosen.get_option( "--near" )->count() > 0 )
	{
		requirePositive( "--near", options.near );
	}
}

void validate( const CLI::App& chosen, const SpherizeOptions& options )
{
	requireNotNegative( "--close-holes", options.close_holes );
	requirePositive( "--time", options.time );
	if ( chosen.get_option( "--spheres" )->count() > 0 )
	{
		requirePositive( "--spheres", options.spheres );
	}
	else if ( chosen.get_option( "--excess" )->count() > 0 )
	{
		requirePositive( "--excess", options.excess );
	}
	else
	{
		throw io::Error( "command line", "--excess", "is missing", "give --excess MM or --spheres N" );
	}
}

void validate( const CLI::App& chosen, const PlanOptions& options )
{
	requirePositive( "--resolution", options.resolution );
	requirePositive( "--seed", options.seed );
	if ( chosen.get_option( "--time" )->count() > 0 )
	{
		requirePositive( "--time", options.time );
	}
	if ( chosen.get_option( "--optimize" )->count() > 0 )
	{
		requirePositive( "--optimize", options.optimize );
	}
	if ( chosen.get_option( "--clearance-goal" )->count() > 0 )
	{
		requirePositive( "--clearance-goal", options.clearance_goal );
	}
	if ( chosen.get_option( "--path-tolerance" )->count() > 0 )
	{
		requireNotNegative( "--path-tolerance", options.path_tolerance );
	}
	if ( chosen.get_option( "--threads" )->count() > 0 )
	{
		requirePositive( "--threads", options.threads );
	}
	if ( chosen.get_option( "--deadline" )->count() > 0 )
	{
		throw io::Error( "command line", "--deadline", "is about a plan in time, and nothing moves",
		    "add --others WORLD.yaml, or leave it out" );
	}
}

int dispatchReferee( const CLI::App& chosen, RefereeOptions& options )
{
	validate( chosen, options.common );
	requireNotNegative( "--search", options.search );
	requireNotNegative( "--prove", options.proof );
	return runReferee( options );
}

int dispatchGuard( const CLI::App& chosen, GuardOptions& options )
{
	validate( chosen, options.common );
	requirePositive( "--rate", options.rate );
	for ( const char* name : { "--budget", "--stale", "--window", "--people-deceleration" } )
	{
		if ( chosen.get_option( name )->count() > 0 )
		{
			requirePositive( name, chosen.get_option( name )->as<double>() );
		}
	}
	for ( const char* name : { "--reaction", "--lag", "--people-speed", "--intrusion", "--people-reaction" } )
	{
		if ( chosen.get_option( name )->count() > 0 )
		{
			requireNotNegative( name, chosen.get_option( name )->as<double>() );
		}
	}
	if ( options.deceleration.empty() && chosen.get_option( "--reaction" )->count() > 0 )
	{
		throw io::Error( "command line", "--reaction", "is about stops, and nothing brakes", "give --deceleration" );
	}
	return runGuard( options );
}

int dispatchAudit( const CLI::App& chosen, AuditOptions& options )
{
	validate( chosen, options.common );
	validate( options );
	if ( options.path.empty() )
	{
		return runTrajectoryAudit( options );
	}
	requirePositive( "--resolution", options.resolution );
	requirePositive( "--time", options.time );
	if ( chosen.get_option( "--corner-blend" )->count() > 0 )
	{
		requirePositive( "--corner-blend", options.corner_blend );
	}
	return runAudit( options );
}

/// Option --input-limit of the chosen subcommand.
std::vector<std::string> givenLimits( const Commands& commands )
{
	std::vector<std::string> given;
	for ( const CommonOptions* common :
	    { &commands.info.common, &commands.pairs.common, &commands.spherize.common, &commands.check.common,
	        &commands.edge.common, &commands.plan.common, &commands.audit.common, &commands.referee.common,
	        &commands.guard.common, &commands.tune.common, &commands.world.common, &commands.view.common } )
	{
		given.insert( given.end(), common->input_limits.begin(), common->input_limits.end() ); // of one: the chosen
	}
	return given;
}

int dispatch( const CLI::App& app, Commands& commands )
{
	const CLI::App* chosen = app.get_subcommands().front();
	const std::string name = chosen->get_name();
	const io::LimitScope limits( inputLimits( givenLimits( commands ) ) );
	if ( name == "info" )
	{
		validate( *chosen, commands.info.common );
		return runInfo( commands.info );
	}
	if ( name == "pairs" )
	{
		validate( *chosen, commands.pairs.common );
		requireNotNegative( "--budget", commands.pairs.budget );
		return runPairs( commands.pairs );
	}
	if ( name == "cache" )
	{
		if ( chosen->get_option( "--limit" )->count() > 0 )
		{
			requireNotNegative( "--limit", commands.cache.limit );
		}
		return runCache( commands.cache );
	}
	if ( name == "spherize" )
	{
		validate( *chosen, commands.spherize.common );
		validate( *chosen, commands.spherize );
		return runSpherize( commands.spherize );
	}
	if ( name == "check" )
	{
		validate( *chosen, commands.check.common );
		validate( *chosen, commands.check );
		return runCheck( commands.check );
	}
	if ( name == "edge" )
	{
		validate( *chosen, commands.edge.common );
		validate( *chosen, commands.edge.edge, commands.edge.common );
		return runEdge( commands.edge );
	}
	if ( name == "plan" )
	{
		validate( *chosen, commands.plan.common );
		validate( *chosen, commands.plan.edge, commands.plan.common );
		validate( *chosen, commands.plan );
		return commands.plan.line.poses.empty() ? runPlan( commands.plan ) : runLine( commands.plan );
	}
	if ( name == "referee" )
	{
		return dispatchReferee( *chosen, commands.referee );
	}
	if ( name == "guard" )
	{
		return dispatchGuard( *chosen, commands.guard );
	}
	if ( name == "tune" )
	{
		validate( *chosen, commands.tune.common );
		validate( *chosen, commands.tune );
		return runTune( commands.tune );
	}
	if ( name == "world" )
	{
		validate( *chosen, commands.world.common );
		validate( *chosen, commands.world );
		return runWorld( commands.world );
	}
	if ( name == "view" )
	{
		validate( *chosen, commands.view.common );
		validate( *chosen, commands.view );
		return runView( commands.view );
	}
	return dispatchAudit( *chosen, commands.audit );
}

// Error text for the first word of the command line; empty if it is a subcommand or an option.
std::string subcommandProblem( const CLI::App& app, int argc, char** argv )
{
	std::vector<std::string> known;
	for ( const CLI::App* command : app.get_subcommands( []( const CLI::App* ) { return true; } ) )
	{
		known.push_back( command->get_name() );
	}
	const std::string word = argc > 1 ? argv[1] : "";
	if ( word.empty() )
	{
		return "no subcommand is given; use one of " + listed( known, known.size() );
	}
	return word[0] == '-' || std::find( known.begin(), known.end(), word ) != known.end()
	           ? ""
	           : fmt::format( "there is no subcommand {}; {}", word, useOneOf( word, known ) );
}

// The parser's words, plainer.
std::string plainWords( const std::string& problem )
{
	static const std::regex twice( "(.*): At Most (\\d+) required but received (\\d+)" );
	std::smatch match;
	return !std::regex_match( problem, match, twice ) ? problem
	       : match[2] == "1" ? fmt::format( "{}: is given {} times; give it once", match[1].str(), match[3].str() )
	                         : fmt::format( "{}: is given {} times; give it at most {} times", match[1].str(),
	                               match[3].str(), match[2].str() );
}

// Error text for the first word that is nearly an option; empty if there is none. This error replaces one about a missing option.
std::string misspeltOption( const CLI::App& command, int argc, char** argv )
{
	std::vector<std::string> known;
	for ( const CLI::Option* option : command.get_options() )
	{
		for ( const std::string& name : option->get_lnames() )
		{
			known.push_back( "--" + name );
		}
	}
	for ( int i = 2; i < argc; ++i )
	{
		const std::string word = std::string( argv[i] ).substr( 0, std::string( argv[i] ).find( '=' ) );
		const bool unknown = word.size() > 2 && word.compare( 0, 2, "--" ) == 0 &&
		                     std::find( known.begin(), known.end(), word ) == known.end();
		const std::vector<std::string> nearest = unknown ? nearNames( word, known, 1 ) : std::vector<std::string>();
		if ( !nearest.empty() )
		{
			return fmt::format( "there is no option {}; use {}", word, nearest[0] );
		}
	}
	return "";
}

// `leeway plan --others W.yaml` is `leeway world plan --world W.yaml`; other words stay as they are.
std::vector<std::string> handedOver( int argc, char** argv )
{
	std::vector<std::string> words( argv, argv + argc );
	const auto isOption = []( const std::string& word, const std::string& option )
	{ return word == option || word.compare( 0, option.size() + 1, option + "=" ) == 0; };
	const auto isOthers = [&]( const std::string& word ) { return isOption( word, "--others" ); };
	if ( argc < 2 || words[1] != "plan" || std::none_of( words.begin(), words.end(), isOthers ) )
	{
		return words;
	}
	words.insert( words.begin() + 1, "world" );
	for ( std::string& word : words )
	{
		for ( const auto& [of_plan, of_world] : { std::pair<std::string, std::string>( "--others", "--world" ),
		          { "--time", "--seconds" }, { "--report", "--json" } } )
		{
			word = isOption( word, of_plan ) ? of_world + word.substr( of_plan.size() ) : word;
		}
	}
	return words;
}

// Every failure becomes one line and exit status 2.
int guarded( const std::function<int()>& run )
{
	const auto fail = []( const std::string& text )
	{
		tell( "leeway: error: {}\n", text );
		return static_cast<int>( exit_error );
	};
	try
	{
		return run();
	}
	catch ( const io::Error& error )
	{
		return fail( error.what() );
	}
	catch ( const std::bad_alloc& )
	{
		return fail( "memory: the machine has too little; load fewer or coarser meshes" );
	}
	catch ( const std::exception& error )
	{
		return fail( fmt::format( "internal: {}; please report it with the command line", error.what() ) );
	}
}

} // namespace

/// The program leeway-bench links the libraries that leeway is compared with.
int runBench( int argc, char** argv )
{
	std::error_code error;
	const std::filesystem::path self = std::filesystem::read_symlink( "/proc/self/exe", error );
	const std::string beside = ( self.parent_path() / "leeway-bench" ).string();
	std::string name = "leeway-bench";
	std::vector<char*> arguments = { name.data() };
	arguments.insert( arguments.end(), argv + 2, argv + argc );
	arguments.push_back( nullptr );
	execv( beside.c_str(), arguments.data() );
	execvp( name.c_str(), arguments.data() ); // on the PATH
	tell( "leeway: error: leeway-bench: {}; it is built with the benchmarks (-DLEEWAY_BUILD_BENCHMARKS=ON), which need "
	      "FCL, and is looked for beside leeway and on the PATH\n",
	    std::strerror( errno ) );
	return exit_error;
}

} // namespace leeway::cli

int main( int given_count, char** given )
{
	using namespace leeway::cli;
	std::vector<std::string> words = handedOver( given_count, given );
	std::vector<char*> pointers;
	for ( std::string& word : words )
	{
		pointers.push_back( word.data() );
	}
	const int argc = static_cast<int>( words.size() );
	pointers.push_back( nullptr );
	char** argv = pointers.data();
	installSignalHandlers();
	Commands commands;
	chooseHelp( argc, argv );
	CLI::App app( about, "leeway" );
	app.footer( footer );
	app.set_help_flag( "-h,--help", "print this help" );
	app.set_help_all_flag( "--help-all", "print all options, file formats and details" );
	app.require_subcommand( 1 );
	app.set_version_flag(
	    "--version", fmt::format( "leeway {}.{}.{}", lw_version() / 10000, lw_version() / 100 % 100, lw_version() % 100 ) );
	addCommands( app, commands );
	if ( argc > 1 && std::string( argv[1] ) == "bench" )
	{
		return runBench( argc, argv );
	}
	if ( const std::string problem = subcommandProblem( app, argc, argv ); !problem.empty() )
	{
		tell( "leeway: error: command line: {}; see leeway --help\n", problem );
		return exit_error;
	}
	try
	{
		app.parse( argc, argv );
	}
	catch ( const CLI::Success& success )
	{
		return app.exit( success ); // --help, --help-all, --version
	}
	catch ( const CLI::ParseError& error )
	{
		const CLI::App* command = app.get_subcommands().empty() ? nullptr : app.get_subcommands().front();
		const std::string misspelt = command != nullptr ? misspeltOption( *command, argc, argv ) : "";
		tell( "leeway: error: command line: {}; see {}\n", misspelt.empty() ? plainWords( error.what() ) : misspelt,
		    command != nullptr ? "leeway " + command->get_name() + " --help" : "leeway --help" );
		return exit_error;
	}
	return guarded( [&] { return dispatch( app, commands ); } );
}
