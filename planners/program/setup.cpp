// SPDX-License-Identifier: BSD-3-Clause
// Loading, the reference state, and checkers that follow joints outside of the group.
#include "program/setup.hpp"

#include "motions/csv.hpp"
#include "motions/names.hpp"
#include "tools/xacro.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <set>
#include <utility>

namespace leeway::cli
{
namespace
{

std::string problemText( const io::RobotModel& robot )
{
	return robot.srdf_file.empty() ? robot.urdf_file : robot.urdf_file + " + " + robot.srdf_file;
}

// Meshes, point clouds, maps: no result may take their place either.
void readsShapes( const std::string& option, const io::LoadReport& report )
{
	std::set<std::string> files;
	for ( const io::LoadedShape& shape : report.shapes )
	{
		files.insert( shape.file );
	}
	for ( const std::string& file : files )
	{
		readsFile( "a mesh of " + option, file );
	}
}

/// Files of the objects that a sequence brings.
void readsItems( const io::PathConstraints& path )
{
	io::LoadReport report;
	for ( const io::SequenceItem& item : path.items )
	{
		report.shapes.insert( report.shapes.end(), item.scene.shapes.begin(), item.scene.shapes.end() );
	}
	readsShapes( "--request", report );
}

// Of --allow. Names may have colons of their own: the pair is cut where both halves are known.
std::vector<std::pair<std::string, std::string>> allowedPairs( const std::vector<std::string>& given, const Input& input )
{
	std::set<std::string> links, objects;
	for ( const io::LinkModel& link : input.robot.links )
	{
		links.insert( link.name );
	}
	if ( input.scene )
	{
		for ( const io::AttachedObject& attached : input.scene->attached )
		{
			links.insert( attached.object.name );
		}
		for ( const io::SceneObject& object : input.scene->objects )
		{
			objects.insert( object.name );
		}
	}
	std::vector<std::string> known( links.begin(), links.end() );
	known.insert( known.end(), objects.begin(), objects.end() );
	const auto is = [&]( const std::string& name ) { return links.count( name ) + objects.count( name ) > 0; };
	std::vector<std::pair<std::string, std::string>> pairs;
	for ( const std::string& text : given )
	{
		std::string first = text.substr( 0, text.find( ':' ) ), second;
		for ( std::size_t colon = text.find( ':' ); colon != std::string::npos; colon = text.find( ':', colon + 1 ) )
		{
			const std::string a = text.substr( 0, colon ), b = text.substr( colon + 1 );
			if ( second.empty() || ( is( a ) && is( b ) ) )
			{
				first = a;
				second = b;
			}
		}
		if ( second.empty() || first.empty() )
		{
			throw io::Error( "command line", "--allow " + text, "is not a pair", "write LINK:OBJECT or LINK:LINK" );
		}
		for ( const std::string& name : { first, second } )
		{
			if ( !is( name ) )
			{
				throw io::Error( "command line", "--allow " + text,
				    fmt::format( "there is no link{} {}", input.scene ? " or object" : "", name ), useOneOf( name, known ) );
			}
		}
		if ( links.count( first ) + links.count( second ) == 0 )
		{
			throw io::Error( "command line", "--allow " + text,
			    "both are objects of the scene, which are never checked against each other",
			    "name a link and an object, or two links" );
		}
		pairs.emplace_back( first, second );
	}
	return pairs;
}

// A folder that is not there would only be missed later, as a package that is found nowhere or somewhere else.
void checkPackagePaths( const std::vector<std::string>& entries )
{
	for ( const std::string& entry : entries )
	{
		const std::size_t equals = entry.find( '=' );
		std::error_code error;
		const bool named = equals != std::string::npos && std::filesystem::is_directory( entry.substr( equals + 1 ), error );
		if ( !named && !std::filesystem::is_directory( entry, error ) )
		{
			throw io::Error( "command line", "--package-path " + entry, "no such folder",
			    "name a folder that contains the package, or NAME=FOLDER" );
		}
	}
}

/// Refuses a group of a robot that has none, and tells of --strict without an SRDF.
void checkWithoutSrdf( const CommonOptions& options, const io::RobotModel& robot, Notices& notices )
{
	if ( !options.srdf.empty() )
	{
		return;
	}
	if ( !options.group.empty() && robot.groups.empty() )
	{
		throw io::Error( "command line", "--group", fmt::format( "'{}' needs an SRDF that defines it", options.group ),
		    "add --srdf FILE, or leave it out: then all joints can move" );
	}
	if ( options.strict && !options.all_pairs )
	{
		notices.add( "the robot",
		    { { options.robot, "no SRDF",
		        "with --strict neighbouring links are checked against each other too; where they overlap by design, give "
		        "an SRDF that disables these pairs: `leeway pairs --robot R.urdf --out S.srdf` writes one" } } );
	}
}

void readRobot( const CommonOptions& options, io::LoadOptions load, Input& input )
{
	const Progress progress( "reading the robot and building its trees" );
	const double start = now();
	load.skip_missing_meshes = options.missing_meshes == "skip";
	load.expand_xacro = [&]( const std::string& file )
	{
		tools::XacroSettings settings;
		settings.arguments = options.xacro_arguments;
		settings.package_paths = options.package_paths;
		return tools::expandXacro( file, settings );
	};
	input.robot = io::loadRobot( options.robot, options.srdf, load );
	input.robot_seconds = now() - start;
	if ( !options.xacro_arguments.empty() && input.robot.expanded_urdf.empty() )
	{
		throw io::Error( "command line", options.xacro_arguments.front(),
		    fmt::format( "is an argument of xacro, and {} is no xacro file", options.robot ), "leave it out" );
	}
}

/// The files of the command line.
void readsNamed( const CommonOptions& options )
{
	for ( const auto& [option, file] : { std::pair( "--robot", &options.robot ), std::pair( "--srdf", &options.srdf ),
	          std::pair( "--scene", &options.scene ), std::pair( "--request", &options.request ),
	          std::pair( "--margins", &options.margins ), std::pair( "--padding", &options.padding ),
	          std::pair( "--world", &options.cell ) } )
	{
		readsFile( option, *file );
	}
}

void readWorld( const CommonOptions& options, io::LoadOptions load, Input& input )
{
	const Progress progress( "reading the world and building its trees" );
	const double start = now();
	load.skip_missing_meshes = options.missing_meshes == "skip";
	input.world = io::loadWorld( options.cell, load );
	input.robot_seconds = now() - start;
	input.robot = input.world->robot;
	input.scene = input.world->scene;
	for ( const std::string& file : input.world->files )
	{
		readsFile( "a file of --world", file );
	}
}

} // namespace

io::LoadOptions loadOptionsOf( const CommonOptions& options )
{
	io::LoadOptions load;
	checkPackagePaths( options.package_paths );
	load.package_paths = options.package_paths;
	load.cache = options.cache;
	load.use_visual = options.visual;
	load.strict = options.strict || options.all_pairs;
	load.detail = 1e-3 * options.detail;
	load.cache_limit = static_cast<std::uint64_t>( options.cache_limit * 1e6 );
	return load;
}

Input loadInput( const CommonOptions& options, Notices& notices, io::PathConstraints* path )
{
	const io::LoadOptions load = loadOptionsOf( options );
	readsNamed( options );
	Input input;
	if ( !options.cache.empty() )
	{
		input.reach = io::ReachOptions();
		input.reach->cache = options.cache;
		input.reach->cache_limit = load.cache_limit;
		input.reach->def.seconds = options.proofs;
	}
	else if ( !options.no_default_cache.empty() && notices.verbose() )
	{
		notices.add( "the cache",
		    { { "", "no cache", options.no_default_cache + ": trees, motion hulls and proofs are not kept" } } );
	}
	input.min_d = options.min_d;
	input.margins = options.margins.empty() ? io::Margins() : io::loadMargins( options.margins );
	input.margins.environment = options.margin_given ? options.margin : input.margins.environment;
	input.margins.self = options.self_margin_given ? options.self_margin : input.margins.self;
	input.padding = options.padding.empty() ? io::Padding() : io::loadPadding( options.padding );
	input.robot_file = options.robot;
	input.scene_file = options.scene;
	input.request_file = options.request;
	if ( !options.request.empty() )
	{
		input.request = path != nullptr ? io::loadConstrainedRequest( options.request, *path, load )
		                                : io::loadRequest( options.request );
		notices.add( "the request", input.request->notices );
		path != nullptr ? readsItems( *path ) : void();
	}
	if ( !options.cell.empty() )
	{
		readWorld( options, load, input );
	}
	else
	{
		readRobot( options, load, input );
		checkWithoutSrdf( options, input.robot, notices );
	}
	notices.add( "the robot", input.robot.report.notices );
	if ( !options.scene.empty() )
	{
		const Progress progress( "reading the scene and building its trees" );
		const double start = now();
		input.scene = io::loadScene( options.scene, load );
		input.scene_seconds = now() - start;
	}
	if ( input.scene )
	{
		notices.add( "the scene", input.scene->report.notices );
	}
	readsShapes( "--robot", input.robot.report );
	if ( input.scene )
	{
		readsShapes( "--scene", input.scene->report );
		for ( const io::Articulation& part : input.scene->articulations )
		{
			readsFile( "an articulation of --scene", part.model.urdf_file );
			readsShapes( "--scene", part.model.report );
		}
	}
	input.allowed = allowedPairs( options.allowed, input );
	if ( input.world )
	{
		input.allowed.insert( input.allowed.end(), input.world->allowed.begin(), input.world->allowed.end() );
	}
	return input;
}

namespace
{

/// Seconds. Proofs that may take longer are announced, and so are hulls that have taken a third of it.
constexpr double moment = 1.5;

} // namespace

void ReachProgress::attach( lw_reach_def& def )
{
	def.progress = report;
	def.progress_user = this;
	m_budget = def.seconds;
	m_hulls_only = def.hulls_only;
	m_begin = now();
}

bool ReachProgress::report( void* self, const char* stage, double share )
{
	ReachProgress& progress = *static_cast<ReachProgress*>( self );
	const bool hulls = std::string( stage ) == "hulls";
	if ( !progress.m_told && ( progress.m_budget > moment || ( hulls && now() - progress.m_begin > moment / 3 ) ) )
	{
		const std::string proofs = progress.m_hulls_only ? ""
		                           : progress.m_budget > 0
		                               ? fmt::format( "up to {} s for proofs of its pairs of links", progress.m_budget )
		                               : "proofs of its pairs of links by hulls";
		tell( "leeway: {}{}\n",
		    hulls ? "building motion hulls of the robot" + std::string( proofs.empty() ? "" : "; then " ) : "", proofs );
		progress.m_told = true;
	}
	progress.m_progress.stage( stage, share );
	progress.m_ended = progress.m_ended || now() - progress.m_begin > progress.m_limit;
	return !progress.m_ended;
}

void noteState( const Input& input, const io::Problem& problem, Notices& notices )
{
	const std::map<std::string, double> none;
	for ( const auto& [name, value] : input.scene ? input.scene->state.values : none )
	{
		const std::uint32_t at = variableOf( problem.robot.get(), name );
		const bool in_group = std::find( problem.variables.begin(), problem.variables.end(), at ) != problem.variables.end();
		if ( at != LW_INVALID_INDEX && !in_group && problem.reference[at] != value )
		{
			notices.add( "joints of the scene",
			    fmt::format(
			        "{}: robot_state.joint_state: joint {} is at {} there; here it stands at {}, and the scene is not asked",
			        input.scene->file, name, value, problem.reference[at] ) );
		}
	}
}

Workbench::Workbench( const Input& input, std::string group, const Values& values, Notices& notices )
    : m_input( input ), m_group( std::move( group ) ), m_notices( notices ),
      m_values( standing( input.robot, input.request ? &*input.request : nullptr, values ) )
{
	build( m_values );
	noteState( m_input, m_problem, m_notices );
}

io::ProblemOptions problemOptions( const Input& input, const std::string& group, const Values& values )
{
	io::ProblemOptions options;
	options.group = group;
	options.scene = input.scene ? &*input.scene : nullptr;
	options.request = input.request ? &*input.request : nullptr;
	options.overrides.values = values;
	options.find_reach = input.reach;
	options.margins = input.margins;
	options.padding = input.padding;
	options.allowed = input.allowed;
	options.min_d = input.min_d;
	options.max_d = input.max_d;
	return options;
}

io::ProblemOptions Workbench::options( const Values& values ) const
{
	io::ProblemOptions options = problemOptions( m_input, m_group, values );
	options.reach = m_reach.reach;
	options.notice_enclosed = !m_built;
	return options;
}

void Workbench::build( const Values& values )
{
	Progress progress( "building the checker" );
	const double start = now();
	io::ProblemOptions options = this->options( values );
	ReachProgress reach_progress( progress );
	if ( options.find_reach )
	{
		reach_progress.attach( options.find_reach->def );
	}
	m_query.reset();
	try
	{
		m_problem = io::buildProblem( m_input.robot, options );
		m_query = makeQuery( m_problem.checker.get() );
	}
	catch ( const CoreError& error )
	{
		throw io::Error( problemText( m_input.robot ), m_group.empty() ? "robot" : "group " + m_group, error.what(),
		    "correct the named element of the description" );
	}
	m_seconds = now() - start;
	if ( m_built )
	{
		return;
	}
	m_built = true;
	m_reach = m_problem.reach;
	m_notices.add( "the model", m_problem.notices );
	const std::uint32_t count = lw_robot_variable_count( robot() );
	m_in_group.assign( count, false );
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		m_names.push_back( io::variableName( robot(), i ) );
	}
	for ( std::uint32_t i : m_problem.variables )
	{
		m_in_group[i] = true;
	}
}

bool Workbench::proveTables( const io::ReachOptions& reach, double seconds ) const
{
	Progress progress( "proving which links never meet" );
	ReachProgress reach_progress( progress );
	io::ProblemOptions options = this->options( m_values );
	options.reach = Reach();
	options.find_reach = reach;
	reach_progress.attach( options.find_reach->def );
	reach_progress.endAfter( seconds );
	try
	{
		m_notices.add( "the cache", io::buildProblem( m_input.robot, options ).reach.notices );
	}
	catch ( const CoreError& )
	{
		if ( !reach_progress.isEnded() )
		{
			throw;
		}
	}
	return !reach_progress.isEnded();
}

bool Workbench::use( const std::vector<double>& full )
{
	bool same = true;
	for ( std::uint32_t i = 0; i < full.size(); ++i )
	{
		same = same && ( m_in_group[i] || full[i] == m_problem.reference[i] );
	}
	if ( same )
	{
		return false;
	}
	Values values = m_values;
	for ( std::uint32_t i = 0; i < full.size(); ++i )
	{
		values[m_names[i]] = full[i];
	}
	build( values );
	return true;
}

lw_state_result measure( const Workbench& bench, const std::vector<double>& q, lw_check_flags flags, const lw_range* range,
    const std::string& file, const std::string& element )
{
	return motions::measure( bench.checker(), bench.query(), q, flags, range, file, element );
}

Audit audited(
    const Workbench& bench, const std::vector<std::vector<double>>& points, AuditSettings settings, const std::string& file )
{
	Progress progress( "auditing the path" );
	settings.progress = shownBy( progress );
	return auditPath( bench.problem(), points, settings, file );
}

std::vector<Tolerance> givenTolerances( const std::vector<std::string>& options )
{
	std::vector<Tolerance> tolerances;
	for ( const std::string& text : options )
	{
		const std::size_t at = text.rfind( '=' );
		const std::optional<double> value = finiteNumber( at == std::string::npos ? text : text.substr( at + 1 ) );
		if ( !value || !( *value >= 0 ) )
		{
			throw io::Error( "command line", "--tolerance " + text, "is no number of 0 or more",
			    "give radians or metres for all joints, or JOINT=VALUE" );
		}
		tolerances.push_back( { at == std::string::npos ? "" : trimmed( text.substr( 0, at ) ), *value, "command line",
		    "--tolerance " + text } );
	}
	return tolerances;
}

Interpolation interpolationOf( const std::string& name )
{
	const std::map<std::string, Interpolation> known = { { "auto", Interpolation::automatic },
	    { "linear", Interpolation::linear }, { "cubic", Interpolation::cubic }, { "quintic", Interpolation::quintic } };
	const auto found = known.find( name );
	if ( found == known.end() )
	{
		throw io::Error( "command line", "--interpolation", "is unknown", "give auto, linear, cubic or quintic" );
	}
	return found->second;
}

} // namespace leeway::cli
