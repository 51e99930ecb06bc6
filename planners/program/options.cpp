// SPDX-License-Identifier: BSD-3-Clause
// Options shared by the subcommands, and their domains.
#include "program/options.hpp"

#include "leeway/io/cache.hpp"
#include "leeway/io/model.hpp"
#include "program/help.hpp"
#include "program/output.hpp"
#include "tools/xacro.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <map>

namespace leeway::cli
{

void refuseOption( const std::string& option, const std::string& problem, const std::string& remedy )
{
	throw io::Error( "command line", option, problem, remedy );
}

namespace
{

bool given( const CLI::App& app, const std::string& option )
{
	const CLI::Option* found = app.get_option_no_throw( option );
	return found != nullptr && found->count() > 0;
}

void addWorldOptions( CLI::App& app, CommonOptions& options, const std::string& group, const CommonNeeds& needs )
{
	if ( !needs.cell )
	{
		app.add_option( "--scene", options.scene, "obstacles: MoveIt planning scene, or a URDF at its zero pose" )
		    ->type_name( "Y.yaml|U.urdf" )
		    ->group( group );
		app.add_option( "--group", options.group, needs.group_help )->type_name( "NAME" )->group( group );
	}
	app.add_option( "--allow", options.allowed, "a link and an object, or two links, that may touch; repeatable" )
	    ->type_name( "LINK:OBJECT" )
	    ->allow_extra_args( false )
	    ->group( group );
}

void addQuestionOptions( CLI::App& app, CommonOptions& options, const CommonNeeds& needs )
{
	const std::string question = "Question";
	app.add_option( "--min-d", options.min_d, "required clearance in metres: at or below it is BLOCKED (default 0)" )
	    ->type_name( "M" )
	    ->group( question );
	app.add_option( "--margins", options.margins, "margins of links, objects and pairs: clearance = distance - margin" )
	    ->type_name( "M.yaml" )
	    ->group( question );
	rare( app.add_option(
	             "--margin", options.margin, "metres: margin of every link to every object (default: the file's, or 0)" )
	          ->type_name( "M" )
	          ->group( question ) );
	rare( app.add_option( "--self-margin", options.self_margin,
	             "metres: margin of every two links that can move against each other (default: the file's, or 0)" )
	          ->type_name( "M" )
	          ->group( question ) );
	rare( app.add_option( "--padding", options.padding,
	             "MoveIt's padding and scale parameters; link_padding and link_scale of the scene override them" )
	          ->type_name( "P.yaml" )
	          ->group( question ) );
	if ( needs.range )
	{
		app.add_option( "--max-d", options.max_d, "metres: larger clearances are not measured (default inf)" )
		    ->type_name( "M" )
		    ->group( question );
		rare( app.add_option( "--alpha", options.alpha,
		             fmt::format( "relative tolerance of distances in [0, 1); 0 = exact (default {})", options.alpha ) )
		          ->type_name( "A" )
		          ->group( question ) );
	}
	app.add_option( "--what", options.what_name, "clearances to check (default both)" )
	    ->check( CLI::IsMember( { "env", "self", "both" } ).description( "" ) )
	    ->type_name( "env|self|both" )
	    ->group( question );
	rare( app.add_option( "--simd", options.simd_name, "highest instruction set; it changes no answer (default best)" )
	          ->check( CLI::IsMember( { "scalar", "sse2", "avx2", "neon", "best" } ).description( "" ) )
	          ->type_name( "scalar|sse2|avx2|neon|best" )
	          ->group( question ) );
}

void addCacheOptions( CLI::App& app, CommonOptions& options, const CommonNeeds& needs, const std::string& model )
{
	CLI::Option* cache =
	    app.add_option( "--cache", options.cache,
	           "folder of trees, hulls and pair tables (default $XDG_CACHE_HOME/leeway, else ~/.cache/leeway)" )
	        ->type_name( "DIR" )
	        ->group( model );
	rare( cache );
	rare( app.add_flag( "--no-cache", options.no_cache, "use no cache folder: no motion hulls, no pair tables" )
	          ->excludes( cache )
	          ->group( model ) );
	rare( app.add_option( "--cache-limit", options.cache_limit,
	             fmt::format( "megabytes: limit of that folder; the least recently used files are removed (default {:.0f})",
	                 options.cache_limit ) )
	          ->type_name( "MB" )
	          ->group( model ) );
	if ( needs.world )
	{
		rare(
		    app.add_option( "--proofs", options.proofs,
		           fmt::format( "seconds that this run may spend on proofs that links never meet; the cache keeps them, and "
		                        "the next run continues (default {}{})",
		               options.proofs, needs.proofs ? "" : "; info makes none without this option" ) )
		        ->type_name( "S" )
		        ->group( model ) );
	}
}

} // namespace

lw_check_flags CommonOptions::checkFlags() const
{
	return what_name == "env" ? LW_CHECK_ENVIRONMENT : what_name == "self" ? LW_CHECK_SELF : LW_CHECK_BOTH;
}

namespace
{

/// --robot with its arguments, and --srdf; or --world.
void addModelOptions( CLI::App& app, CommonOptions& options, const CommonNeeds& needs, const std::string& model )
{
	if ( needs.cell )
	{
		app.add_option( "--world", options.cell, "robots, objects and their motions in one file" )
		    ->type_name( "W.yaml" )
		    ->required()
		    ->group( model );
		return;
	}
	CLI::Option* robot =
	    app.add_option( "--robot", options.robot, "robot description: URDF, MJCF, SDF, or xacro with its NAME:=VALUE" )
	        ->type_name( "R.urdf" )
	        ->group( model );
	if ( needs.robot )
	{
		robot->required();
	}
	app.validate_positionals(); // other words are unexpected, as if there were no positional argument
	rare( app.add_option( "xacro", options.xacro_arguments, "arguments of the xacro file that --robot names" )
	          ->type_name( "NAME:=VALUE" )
	          ->check( CLI::Validator( []( const std::string& word )
	              { return tools::isXacroArgument( word ) ? "" : "is not NAME:=VALUE"; },
	              "" ) ) );
	app.add_option( "--srdf", options.srdf, "groups and pairs of links that may touch" )
	    ->type_name( "S.srdf" )
	    ->group( model );
}

} // namespace

void addCommonOptions( CLI::App& app, CommonOptions& options, const CommonNeeds& needs )
{
	const std::string model = "Model";
	addModelOptions( app, options, needs, model );
	if ( needs.world )
	{
		addWorldOptions( app, options, model, needs );
	}
	if ( needs.request )
	{
		rare( app.add_option( "--request", options.request, "its start state gives the values of joints without a column" )
		          ->type_name( "Q.yaml" )
		          ->group( model ) );
	}
	app.add_flag( "--visual", options.visual, "use visual geometry for links without collision geometry" )->group( model );
	rare(
	    app.add_flag( "--strict", options.strict,
	           "every unknown name in the SRDF is an error, even if it is not used; without an SRDF all pairs of links are checked" )
	        ->group( model ) );
	app.add_option( "--package-path", options.package_paths,
	       "folder for package://NAME/...: contains NAME, is called NAME, or NAME=FOLDER; repeatable" )
	    ->type_name( "DIR" )
	    ->allow_extra_args( false )
	    ->group( model );
	rare(
	    app.add_option( "--missing-meshes", options.missing_meshes,
	           "of the robot: refuse, or skip: leave them out with a notice, so that nothing collides with them (default refuse)" )
	        ->check( CLI::IsMember( { "refuse", "skip" } ).description( "" ) )
	        ->type_name( "refuse|skip" )
	        ->group( model ) );
	addCacheOptions( app, options, needs, model );
	std::string limits;
	for ( const auto& [name, member] : io::limitNames() )
	{
		limits += fmt::format( "{}{} {}", limits.empty() ? "" : ", ", name, io::Limits().*member );
	}
	rare( app.add_option( "--input-limit", options.input_limits,
	             fmt::format( "limit on input files, NAME=N; repeatable (defaults: {})", limits ) )
	          ->type_name( "NAME=N" )
	          ->allow_extra_args( false )
	          ->group( model ) );
	if ( needs.world )
	{
		addQuestionOptions( app, options, needs );
	}
	if ( needs.detail )
	{
		rare(
		    app.add_option( "--detail", options.detail,
		           "millimetres: use coarser shapes that contain the originals and exceed them by at most this (default 0)" )
		        ->type_name( "MM" )
		        ->group( model ) );
	}
	app.add_flag( "--verbose", options.verbose, "print all notices and pairs, and the planner's own messages" );
}

void addEdgeOptions( CLI::App& app, EdgeOptions& options )
{
	const std::string question = "Question";
	app.add_option( "--validator", options.validator,
	       "certified: prove the whole motion; steps: test states at steps (default certified)" )
	    ->check( CLI::IsMember( { "certified", "steps" } ).description( "" ) )
	    ->type_name( "certified|steps" )
	    ->group( question );
	rare( app.get_option( "--max-d" )->description( "metres, with --validator steps: motion per step (default 0.01)" ) );
	app.add_option( "--slack", options.slack,
	       "metres, certified: clearances above --min-d by less than this may be UNDECIDED (default 0.001)" )
	    ->type_name( "M" )
	    ->group( question );
}

void addViewOption( CLI::App& app, std::string& file )
{
	rare( app.add_option( "--view", file, "the result as a page for browsers; see leeway view" )->type_name( "page.html" ) );
}

void addCertificateOption( CLI::App& app, std::string& file )
{
	rare( app.add_option( "--certificate", file, "a proof that check_certificate.py and check_certificate.c check" )
	          ->type_name( "out.lwc" ) );
}

void addTrajectoryOptions( CLI::App& app, std::string& interpolation, std::string& joint_limits )
{
	rare( app.add_option( "--interpolation", interpolation, "between points of a trajectory (default auto)" )
	          ->type_name( "auto|linear|cubic|quintic" ) );
	rare( app.add_option( "--joint-limits", joint_limits, "of a trajectory: velocities, accelerations, jerks" )
	          ->type_name( "joint_limits.yaml" ) );
}

void addPictureOptions( CLI::App& app, PictureOptions& options )
{
	const std::string picture = "Picture";
	app.add_option( "--png", options.file, "a picture of the page, drawn by Chromium" )
	    ->type_name( "out.png" )
	    ->group( picture );
	rare( app.add_option( "--camera", options.camera, "degrees from x, degrees above the horizon, metres (default: chosen)" )
	          ->type_name( "AZ,EL[,D]" )
	          ->group( picture ) );
	rare( app.add_option( "--at", options.at, "place of the motion: seconds, share, number, or least (default: its start)" )
	          ->type_name( "PLACE" )
	          ->group( picture ) );
	rare( app.add_option( "--width", options.width, "pixels (default 1280)" )->type_name( "N" )->group( picture ) );
	rare( app.add_option( "--height", options.height, "pixels (default 800)" )->type_name( "N" )->group( picture ) );
}

void requirePositive( const std::string& option, double value )
{
	if ( !( value > 0 ) || !std::isfinite( value ) )
	{
		refuseOption( option, fmt::format( "{} is not a finite number above 0", value ), "give a positive number" );
	}
}

void requireNotNegative( const std::string& option, double value )
{
	if ( !( value >= 0 ) || !std::isfinite( value ) )
	{
		refuseOption( option, fmt::format( "{} is not a finite number of at least 0", value ), "give 0 or more" );
	}
}

io::Limits inputLimits( const std::vector<std::string>& given )
{
	io::Limits limits;
	for ( const std::string& text : given )
	{
		const std::size_t equals = text.find( '=' );
		const std::string name = text.substr( 0, equals ),
		                  value = equals != std::string::npos ? text.substr( equals + 1 ) : "";
		std::uint64_t number_ = 0;
		const auto [end, error] = std::from_chars( value.data(), value.data() + value.size(), number_ );
		std::string known;
		bool found = false;
		for ( const auto& [candidate, member] : io::limitNames() )
		{
			known += ( known.empty() ? "" : ", " ) + candidate;
			if ( candidate == name )
			{
				limits.*member = number_;
				found = true;
			}
		}
		if ( !found || value.empty() || error != std::errc() || end != value.data() + value.size() )
		{
			refuseOption( "--input-limit", fmt::format( "{} is not NAME=N", text ),
			    fmt::format( "give a whole number to one of {}", known ) );
		}
	}
	return limits;
}

void validate( const CLI::App& app, CommonOptions& options )
{
	options.min_d_given = given( app, "--min-d" );
	options.max_d_given = given( app, "--max-d" );
	if ( !( options.min_d >= 0 ) || !std::isfinite( options.min_d ) )
	{
		refuseOption(
		    "--min-d", fmt::format( "{} is not a finite number of at least 0", options.min_d ), "give metres, 0 or more" );
	}
	if ( !( options.max_d > options.min_d ) )
	{
		refuseOption( "--max-d", fmt::format( "{} is not above --min-d {}", options.max_d, options.min_d ),
		    "give metres above the margin, or leave it out" );
	}
	options.margin_given = given( app, "--margin" );
	options.self_margin_given = given( app, "--self-margin" );
	requireNotNegative( "--margin", options.margin );
	requireNotNegative( "--self-margin", options.self_margin );
	requireNotNegative( "--detail", options.detail );
	requireNotNegative( "--cache-limit", options.cache_limit );
	requireNotNegative( "--proofs", options.proofs );
	options.proofs_given = given( app, "--proofs" );
	for ( const char* option : { "--cache-limit", "--proofs" } )
	{
		if ( options.no_cache && given( app, option ) )
		{
			refuseOption( option, "has no meaning without a cache", "leave out --no-cache, or this" );
		}
	}
	if ( !options.no_cache && !given( app, "--cache" ) )
	{
		const std::string folder = io::defaultCacheFolder();
		options.default_cache = io::isUsableCache( folder );
		options.cache = options.default_cache ? folder : "";
		options.no_default_cache = options.default_cache ? ""
		                           : folder.empty()      ? "neither XDG_CACHE_HOME nor HOME names a folder"
		                                                 : folder + " cannot be written";
	}
	if ( !( options.alpha >= 0 && options.alpha < 1 ) )
	{
		refuseOption(
		    "--alpha", fmt::format( "{} is outside of [0, 1)", options.alpha ), "give for instance 0.1 for ten per cent" );
	}
	const lw_simd wanted = options.simd_name == "scalar" ? LW_SIMD_SCALAR
	                       : options.simd_name == "sse2" ? LW_SIMD_SSE2
	                       : options.simd_name == "avx2" ? LW_SIMD_AVX2
	                       : options.simd_name == "neon" ? LW_SIMD_NEON
	                                                     : LW_SIMD_BEST;
	if ( wanted != LW_SIMD_BEST )
	{
		if ( !lw_simd_supported( wanted ) )
		{
			refuseOption( "--simd", fmt::format( "this machine or build has no {}", options.simd_name ), "use --simd best" );
		}
		// The cap of every query of the process, those of the planner's threads included.
		setenv( "LW_CPU_MASK", std::to_string( static_cast<int>( wanted ) ).c_str(), 1 );
	}
}

void validate( const CLI::App& app, EdgeOptions& options, const CommonOptions& common )
{
	options.slack_given = given( app, "--slack" );
	requirePositive( "--slack", options.slack );
	if ( options.validator == "certified" && common.max_d_given )
	{
		refuseOption( "--max-d", "has no meaning for --validator certified, which proves the whole motion",
		    "leave it out, or add --validator steps" );
	}
	if ( options.validator == "steps" )
	{
		if ( options.slack_given )
		{
			refuseOption( "--slack", "has no meaning for --validator steps", "leave it out, or use --validator certified" );
		}
		requirePositive( "--max-d", stepLength( common ) );
	}
}

void validate( const CLI::App& app, TuneOptions& options )
{
	options.time_given = given( app, "--time-per-state" );
	options.error_given = given( app, "--error" );
	options.conservatism_given = given( app, "--edge-conservatism" );
	if ( !std::isfinite( options.common.max_d ) )
	{
		refuseOption( "--max-d", "is infinite", "give the largest clearance that matters, in metres" );
	}
	if ( options.time_given )
	{
		requirePositive( "--time-per-state", options.time_per_state );
	}
	if ( options.error_given )
	{
		requireNotNegative( "--error", options.error );
		const double most = 1e3 * ( options.common.max_d - options.common.min_d );
		if ( !( options.error < most ) )
		{
			refuseOption( "--error",
			    fmt::format( "{} mm is not less than the {} mm from --min-d to --max-d", options.error, most ),
			    "give a smaller error: with that one every answer is good" );
		}
	}
	// Proofs near contact take work in inverse proportion
	constexpr double least_conservatism = 1e-3; // millimetres
	if ( options.conservatism_given &&
	     !( options.edge_conservatism >= least_conservatism && std::isfinite( options.edge_conservatism ) ) )
	{
		refuseOption( "--edge-conservatism",
		    fmt::format( "{} is not a finite number of at least {}", options.edge_conservatism, least_conservatism ),
		    "give millimetres: every proof of a motion needs some room" );
	}
	if ( given( app, "--rate" ) )
	{
		requirePositive( "--rate", options.rate );
	}
	requirePositive( "--states", options.states );
	requirePositive( "--edges", options.edges );
}

void validate( const CLI::App& app, WorldOptions& options )
{
	const std::map<std::string, std::vector<std::string>> own = { { "check", { "--time", "--json" } },
	    { "edge", { "--edges", "--out", "--slack" } },
	    { "audit", { "--from", "--to", "--first-contact", "--slack", "--json", "--certificate" } },
	    { "plan", { "--goal", "--from", "--deadline", "--together", "--seconds", "--seed", "--joint-limits", "--out",
	                  "--slack", "--json" } },
	    { "view", { "--from", "--to", "--out", "--slack" } } };
	if ( own.count( options.question ) == 0 )
	{
		refuseOption( "leeway world " + options.question, "is no question", "ask check, edge, audit, plan or view" );
	}
	const std::vector<std::string>& allowed = own.at( options.question );
	for ( const auto& [question, names] : own )
	{
		for ( const std::string& name : names )
		{
			if ( given( app, name ) && std::find( allowed.begin(), allowed.end(), name ) == allowed.end() )
			{
				refuseOption(
				    name, "has no meaning for leeway world " + options.question, "leave it out, or ask " + question );
			}
		}
	}
	options.time_given = given( app, "--time" );
	options.from_given = given( app, "--from" );
	options.to_given = given( app, "--to" );
	requirePositive( "--slack", options.slack );
	for ( const auto& [option, value] :
	    { std::pair( "--time", options.time ), { "--from", options.from }, { "--to", options.to } } )
	{
		if ( !std::isfinite( value ) )
		{
			refuseOption( option, "is not finite", "give seconds" );
		}
	}
	if ( options.from_given && options.to_given && !( options.from <= options.to ) )
	{
		refuseOption(
		    "--to", fmt::format( "{:g} s is before --from {:g} s", options.to, options.from ), "give a later time" );
	}
	if ( options.question == "edge" && options.edges.empty() )
	{
		refuseOption( "--edges", "is missing", "give a table of motions" );
	}
	if ( options.question == "view" && options.out.empty() )
	{
		refuseOption( "--out", "is missing", "name the page" );
	}
	if ( options.question != "plan" )
	{
		return;
	}
	if ( options.goals.empty() )
	{
		refuseOption( "--goal", "is missing", "give ROBOT=STATE of each robot that is to move" );
	}
	if ( !given( app, "--deadline" ) || !( options.deadline > options.from ) || !std::isfinite( options.deadline ) )
	{
		refuseOption( "--deadline", "is missing, or not after --from",
		    "give the seconds on the clock by which the goals are reached" );
	}
	requirePositive( "--seconds", options.search_seconds );
	requirePositive( "--seed", options.seed );
}

void validate( const CLI::App& app, const PictureOptions& options )
{
	for ( const char* option : { "--camera", "--at", "--width", "--height" } )
	{
		if ( options.file.empty() && given( app, option ) )
		{
			refuseOption( option, "is about a picture, and none is asked for", "add --png out.png, or leave it out" );
		}
	}
	const auto is_number = []( const std::string& text )
	{
		double value = 0;
		const auto [end, error] = std::from_chars( text.data(), text.data() + text.size(), value );
		return error == std::errc() && end == text.data() + text.size() && std::isfinite( value );
	};
	std::size_t begin = 0, parts = 0;
	for ( bool more = !options.camera.empty(); more; ++parts )
	{
		const std::size_t comma = options.camera.find( ',', begin );
		more = comma != std::string::npos;
		if ( !is_number( options.camera.substr( begin, comma - begin ) ) )
		{
			refuseOption( "--camera", options.camera + " is no list of numbers",
			    "give AZIMUTH,ELEVATION or AZIMUTH,ELEVATION,DISTANCE" );
		}
		begin = comma + 1;
	}
	if ( parts == 1 || parts > 3 )
	{
		refuseOption( "--camera", options.camera + " has not two or three numbers",
		    "give AZIMUTH,ELEVATION or AZIMUTH,ELEVATION,DISTANCE" );
	}
	if ( !options.at.empty() && options.at != "least" && !is_number( options.at ) )
	{
		refuseOption( "--at", options.at + " is no number", "give a place of the motion, or least" );
	}
	constexpr unsigned most_pixels = 16384;
	for ( const auto& [option, pixels] : { std::pair( "--width", options.width ), std::pair( "--height", options.height ) } )
	{
		if ( pixels < 64 || pixels > most_pixels )
		{
			refuseOption( option, fmt::format( "{} is not between 64 and {}", pixels, most_pixels ), "give pixels" );
		}
	}
}

double stepLength( const CommonOptions& common )
{
	return common.max_d_given ? common.max_d : 0.01;
}

} // namespace leeway::cli
