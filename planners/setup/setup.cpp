// SPDX-License-Identifier: BSD-3-Clause
// Loading, the reference state, and checkers that follow joints outside of the group.
#include "setup/setup.hpp"

#include "text/names.hpp"

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
			throw io::Error( "command line", "--allow " + text, "both are objects of the scene, which are never checked against each other",
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

} // namespace

Input loadInput( const CommonOptions& options, Notices& notices )
{
	io::LoadOptions load;
	checkPackagePaths( options.package_paths );
	load.package_paths = options.package_paths;
	load.cache = options.cache;
	load.use_visual = options.visual;
	load.strict = options.strict;
	load.detail = 1e-3 * options.detail;
	load.cache_limit = static_cast<std::uint64_t>( options.cache_limit * 1e6 );
	for ( const auto& [option, file] : { std::pair( "--robot", &options.robot ), std::pair( "--srdf", &options.srdf ),
	          std::pair( "--scene", &options.scene ), std::pair( "--request", &options.request ),
	          std::pair( "--margins", &options.margins ), std::pair( "--padding", &options.padding ) } )
	{
		readsFile( option, *file );
	}
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
		notices.add( "the cache", { { "", "no cache", options.no_default_cache + ": trees, motion hulls and proofs are not kept" } } );
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
		input.request = io::loadRequest( options.request );
		notices.add( "the request", input.request->notices );
	}
	{
		const Progress progress( "reading the robot and building its trees" );
		const double start = now();
		input.robot = io::loadRobot( options.robot, options.srdf, load );
		input.robot_seconds = now() - start;
	}
	notices.add( "the robot", input.robot.report.notices );
	if ( options.srdf.empty() )
	{
		notices.add(
		    "the robot", { { options.robot, "no SRDF",
		                     "neighbouring links are checked against each other too; where they overlap by design, give "
		                     "an SRDF that disables these pairs: `leeway pairs --robot R.urdf --out S.srdf` writes one" } } );
	}
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
		const std::string proofs = progress.m_hulls_only       ? ""
		                           : progress.m_budget > 0     ? fmt::format( "up to {} s for proofs of its pairs of links", progress.m_budget )
		                                                       : "proofs of its pairs of links by hulls";
		tell( "leeway: {}{}\n", hulls ? "building motion hulls of the robot" + std::string( proofs.empty() ? "" : "; then " ) : "", proofs );
		progress.m_told = true;
	}
	progress.m_progress.stage( stage, share );
	return true;
}

void requireReach( const io::LoadedReach& loaded, const std::string& robot_file )
{
	if ( !loaded.reach )
	{
		throw io::Error( robot_file, "motion hulls", "this build of leeway cannot make them", "build it with qhull" );
	}
}

/// Tells about joints that a scene's robot_state puts elsewhere than they stand. Tables and motions say where those of the group are.
static void noteState( const Input& input, const Workbench& bench, Notices& notices )
{
	if ( !input.scene )
	{
		return;
	}
	for ( const auto& [name, value] : input.scene->state.values )
	{
		const std::uint32_t at = bench.variable( name );
		if ( at != LW_INVALID_INDEX && !bench.inGroup( at ) && bench.problem().reference[at] != value )
		{
			notices.add( "joints of the scene",
			    fmt::format( "{}: robot_state.joint_state: joint {} is at {} there; here it stands at {}, and the scene is not asked", input.scene->file,
			        name, value, bench.problem().reference[at] ) );
		}
	}
}

Workbench::Workbench( const Input& input, std::string group, const Values& values, Notices& notices )
    : m_input( input ), m_group( std::move( group ) ), m_notices( notices )
{
	// Zero where nobody says otherwise: the reader's own default is the limit nearest to zero, or the scene's robot_state.
	for ( const io::JointModel& joint : input.robot.joints )
	{
		const bool single =
		    joint.type == LW_JOINT_REVOLUTE || joint.type == LW_JOINT_CONTINUOUS || joint.type == LW_JOINT_PRISMATIC;
		const bool in_request = input.request && input.request->start.values.count( joint.name ) != 0;
		if ( single && joint.mimic.empty() && !in_request )
		{
			m_values[joint.name] = 0;
		}
	}
	for ( const auto& [name, value] : values )
	{
		m_values[name] = value;
	}
	build( m_values );
	noteState( m_input, *this, m_notices );
}

io::ProblemOptions Workbench::options( const Values& values ) const
{
	io::ProblemOptions options;
	options.group = m_group;
	options.scene = m_input.scene ? &*m_input.scene : nullptr;
	options.request = m_input.request ? &*m_input.request : nullptr;
	options.overrides.values = values;
	options.reach = m_reach.reach;
	options.find_reach = m_input.reach;
	options.margins = m_input.margins;
	options.padding = m_input.padding;
	options.allowed = m_input.allowed;
	options.min_d = m_input.min_d;
	options.max_d = m_input.max_d;
	options.notice_enclosed = !m_built;
	return options;
}

std::unique_ptr<io::World> Workbench::makeWorld() const
{
	return std::make_unique<io::World>( m_input.robot, options( m_values ) );
}

void Workbench::adopt( const io::Problem& problem )
{
	m_query.reset();
	m_problem = problem;
	m_query = makeQuery( m_problem.checker.get() );
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

void Workbench::proveTables( const io::ReachOptions& reach ) const
{
	Progress progress( "proving which links never meet" );
	ReachProgress reach_progress( progress );
	io::ProblemOptions options = this->options( m_values );
	options.reach = Reach();
	options.find_reach = reach;
	reach_progress.attach( options.find_reach->def );
	m_notices.add( "the cache", io::buildProblem( m_input.robot, options ).reach.notices );
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

std::vector<double> Workbench::groupState( const std::vector<double>& full ) const
{
	std::vector<double> q;
	for ( std::uint32_t i : m_problem.variables )
	{
		q.push_back( full[i] );
	}
	return q;
}

std::vector<double> Workbench::fullState( const std::vector<double>& q ) const
{
	std::vector<double> full = m_problem.reference;
	for ( std::size_t i = 0; i < q.size(); ++i )
	{
		full[m_problem.variables[i]] = q[i];
	}
	return full;
}

std::uint32_t Workbench::variable( const std::string& name ) const
{
	for ( std::uint32_t i = 0; i < m_names.size(); ++i )
	{
		if ( m_names[i] == name )
		{
			return i;
		}
	}
	return LW_INVALID_INDEX;
}

namespace
{

void addViolation(
    const Workbench& bench, std::uint32_t variable, double value, double tolerance, std::vector<std::string>& lines )
{
	const lw_variable_info info = lw_robot_variable( bench.robot(), variable );
	if ( !info.wraps && !( value >= info.lower - tolerance && value <= info.upper + tolerance ) )
	{
		const bool below = value < info.lower;
		lines.push_back( fmt::format( "joint {}: {} is {} its limit {}", bench.variableNames()[variable], value,
		    below ? "below" : "above", below ? info.lower : info.upper ) );
	}
}

} // namespace

std::vector<std::string> limitViolations( const Workbench& bench, const std::vector<double>& full, double tolerance )
{
	std::vector<std::string> lines;
	for ( std::uint32_t i = 0; i < full.size(); ++i )
	{
		addViolation( bench, i, full[i], tolerance, lines );
	}
	return lines;
}

std::vector<std::string> groupLimitViolations( const Workbench& bench, const std::vector<double>& q, double tolerance )
{
	std::vector<std::string> lines;
	for ( std::size_t i = 0; i < q.size(); ++i )
	{
		addViolation( bench, bench.problem().variables[i], q[i], tolerance, lines );
	}
	return lines;
}

namespace
{

Named named( const lw_clearance& clearance, bool asked )
{
	Named result;
	result.asked = asked;
	result.lower = clearance.lower;
	result.upper = clearance.upper;
	result.has_points = std::isfinite( clearance.upper );
	result.point_a = clearance.point_a;
	result.point_b = clearance.point_b;
	return result;
}

std::string text( const char* name )
{
	return name == nullptr ? "" : name;
}

} // namespace

std::string Named::marginText() const
{
	return margin > 0 ? fmt::format( ", margin {} m", margin ) : "";
}

bool hasMargins( const lw_checker* checker )
{
	const lw_checker_info info = lw_checker_get_info( checker );
	return info.environment_margin > 0 || info.self_margin > 0;
}

Named nameEnvironment( const lw_checker* checker, const lw_clearance& clearance, bool asked )
{
	Named result = named( clearance, asked );
	if ( clearance.a != LW_INVALID_INDEX && clearance.b != LW_INVALID_INDEX && lw_checker_scene( checker ) != nullptr )
	{
		result.first = text( lw_robot_link_name( lw_checker_robot( checker ), clearance.a ) );
		result.second = text( lw_scene_object_name( lw_checker_scene( checker ), clearance.b ) );
		result.margin = lw_checker_environment_margin( checker, clearance.a, clearance.b );
	}
	return result;
}

Named nameSelf( const lw_checker* checker, const lw_clearance& clearance, bool asked )
{
	Named result = named( clearance, asked );
	if ( clearance.a != LW_INVALID_INDEX && clearance.b != LW_INVALID_INDEX )
	{
		result.first = text( lw_robot_link_name( lw_checker_robot( checker ), clearance.a ) );
		result.second = text( lw_robot_link_name( lw_checker_robot( checker ), clearance.b ) );
		result.margin = lw_checker_self_margin( checker, clearance.a, clearance.b );
	}
	return result;
}

lw_state_result measure( const Workbench& bench, const std::vector<double>& q, lw_check_flags flags, const lw_range* range,
    const std::string& file, const std::string& element )
{
	lw_state_result result;
	const lw_status status = lw_checker_state( bench.checker(), bench.query(), q.data(), flags, range, false, &result );
	if ( status != LW_OK )
	{
		throw io::Error( file, element, std::string( "the state cannot be used (" ) + lw_status_name( status ) + ")",
		    "give finite joint values and quaternions that are not zero" );
	}
	return result;
}

} // namespace leeway::cli
