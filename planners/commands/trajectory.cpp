// SPDX-License-Identifier: BSD-3-Clause
// leeway audit --trajectory, --steps: timed trajectories, proved as a controller drives them, in a world that changes in between.
#include "leeway/motions/corridor.hpp"
#include "leeway/motions/motion_files.hpp"
#include "leeway/motions/path_constraints.hpp"
#include "leeway/motions/stage.hpp"
#include "motions/report.hpp"
#include "commands/certificate_file.hpp"
#include "commands/limits_file.hpp"
#include "commands/page_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <set>

namespace leeway::cli
{
namespace
{

/// A step, with its trajectories.
struct Act
{
	Step step;
	std::vector<TrajectoryFile> files;
};

std::vector<Act> readActs( const AuditOptions& options )
{
	std::vector<Act> acts;
	if ( options.steps.empty() )
	{
		acts.push_back( { {}, readTrajectories( options.trajectory ) } );
		readsFile( "--trajectory", options.trajectory );
		return acts;
	}
	for ( const Step& step : readSteps( options.steps ) )
	{
		const bool driven = step.kind == Step::Kind::trajectory;
		acts.push_back( { step, driven ? readTrajectories( step.file ) : std::vector<TrajectoryFile>() } );
		if ( driven )
		{
			readsFile( "--steps", step.file );
		}
	}
	readsFile( "--steps", options.steps );
	return acts;
}

std::vector<TrajectoryFile> filesOf( const std::vector<Act>& acts )
{
	std::vector<TrajectoryFile> files;
	for ( const Act& act : acts )
	{
		files.insert( files.end(), act.files.begin(), act.files.end() );
	}
	return files;
}

/// The options for joints of this group, and for all joints. Those of other groups' joints are for other steps.
std::vector<Tolerance> tolerancesFor( const AuditOptions& options, const io::Problem& problem )
{
	const std::vector<std::string>& names = problem.variable_names;
	std::vector<Tolerance> out = givenTolerances( options.tolerance );
	const auto other = [&]( const Tolerance& tolerance )
	{
		return !options.steps.empty() && !tolerance.variable.empty() &&
		       std::find( names.begin(), names.end(), tolerance.variable ) == names.end() &&
		       variableOf( problem.robot.get(), tolerance.variable ) != LW_INVALID_INDEX;
	};
	out.erase( std::remove_if( out.begin(), out.end(), other ), out.end() );
	return out;
}

/// Trajectories of one group that follow one another in one world: a part of the page, or a certificate.
struct Chapter
{
	std::shared_ptr<const io::Problem> problem;
	std::string name;
	std::vector<double> tolerance = {}; ///< the largest of the trajectories; empty: none
	std::vector<Segment> segments = {};
};

std::string describe( const Step& change )
{
	const bool attach = change.kind == Step::Kind::attach, release = change.kind == Step::Kind::release;
	return attach || release ? fmt::format( "{} {}", attach ? "attach" : "release", change.object )
	                         : fmt::format( "{} contact of {} and {}", change.kind == Step::Kind::allow ? "allow" : "forbid",
	                               change.link, change.object );
}

/// Drives the trajectories, and keeps them for reports and pages.
class Driver
{
public:
	Driver( const AuditOptions& options, const Input& input, Stage& stage, Notices& notices, TrajectorySettings settings )
	    : m_options( options ), m_input( input ), m_stage( stage ), m_notices( notices ),
	      m_settings( std::move( settings ) ), m_drive( input.request ? input.request->start.values : Values() )
	{
	}

	/// The problem of a group in the world as it is now.
	std::shared_ptr<const io::Problem> use( const std::string& group )
	{
		Progress progress( "building the checker" );
		ReachProgress reach_progress( progress );
		if ( m_stage.options().find_reach )
		{
			reach_progress.attach( m_stage.options().find_reach->def );
		}
		std::shared_ptr<const io::Problem> problem = m_stage.use( group );
		if ( m_shown.insert( group ).second )
		{
			m_notices.add( "the model", problem->notices );
			noteState( m_input, *problem, m_notices );
		}
		return problem;
	}

	/// The world changes before the next trajectory.
	void change( const Step& step )
	{
		m_stage.change( step, m_options.steps );
		m_changes += describe( step ) + ", ";
	}

	void drive( const TrajectoryFile& file )
	{
		const std::string group = groupOf( file, m_options.common.group, m_input.robot );
		const std::shared_ptr<const io::Problem> problem = use( group );
		m_notices.add( "fields of the trajectory", file.notices );
		m_settings.tolerance = tolerances( *problem, file.file, file.path_tolerance, tolerancesFor( m_options, *problem ) );
		const TrajectoryAudit& audit = m_drive.add( *problem, m_input.robot, file, m_settings );
		m_notices.add( "first points", m_drive.notices() );
		if ( !m_options.profile.empty() )
		{
			profile += profileCsv( *problem, m_drive.segments(), m_settings.edge.flags, file.file );
		}
		keep( problem, file.file );
		m_stage.moved( stateAt( m_drive.segments(), whole().duration ) );
		Json step = toJson( audit );
		told += fmt::format( "step        {:.4f} to {:.4f} s, {}: {}, {}\n", m_drive.begin(), whole().duration,
		    group.empty() ? "all joints" : group, file.file, step["verdict"].get<std::string>() );
		step["file"] = file.file;
		step["group"] = group;
		step["begin"] = m_drive.begin();
		steps.push_back( step );
	}

	const TrajectoryAudit& whole() const { return m_drive.whole(); }
	std::string profile = "time,environment,self\n", told;
	Json steps = Json::array();
	std::vector<Chapter> chapters;

private:
	void keep( const std::shared_ptr<const io::Problem>& problem, const std::string& file )
	{
		if ( chapters.empty() || chapters.back().problem != problem )
		{
			chapters.push_back( { problem, m_changes + std::filesystem::path( file ).filename().string() } );
		}
		m_changes.clear();
		std::vector<double>& most = chapters.back().tolerance;
		most.resize( std::max( most.size(), m_settings.tolerance.size() ), 0 );
		for ( std::size_t i = 0; i < m_settings.tolerance.size(); ++i )
		{
			most[i] = std::max( most[i], m_settings.tolerance[i] );
		}
		const std::vector<Segment>& driven = m_drive.segments();
		chapters.back().segments.insert( chapters.back().segments.end(), driven.begin(), driven.end() );
	}

	const AuditOptions& m_options;
	const Input& m_input;
	Stage& m_stage;
	Notices& m_notices;
	TrajectorySettings m_settings;
	Drive m_drive;
	std::set<std::string> m_shown; ///< groups whose notices were given
	std::string m_changes;         ///< of the world since the last trajectory
};

Json reportOf( const AuditOptions& options, const Input& input, const std::string& group, const Driver& driver,
    const Notices& notices, const Json& constraints )
{
	Json json;
	json[options.steps.empty() ? "trajectory" : "steps_file"] = options.steps.empty() ? options.trajectory : options.steps;
	json["robot"] = input.robot.name;
	json["group"] = group;
	json["audit"] = motions::toJson( driver.whole() );
	if ( !constraints.empty() )
	{
		json["path_constraints"] = constraints;
	}
	json["notices"] = notices.all();
	if ( !options.steps.empty() )
	{
		json["steps"] = driver.steps;
	}
	return json;
}

/// The request's constraints along the path, of all chapters.
std::vector<ConstraintProof> proveConstraints( const io::PathConstraints& path, const Driver& driver )
{
	std::vector<ConstraintProof> all;
	for ( const Chapter& chapter : driver.chapters )
	{
		const std::vector<ConstraintProof> proofs =
		    motions::proveConstraints( *chapter.problem, path, chapter.segments, chapter.tolerance );
		all.insert( all.end(), proofs.begin(), proofs.end() );
	}
	return all;
}

Json toJson( const std::vector<ConstraintProof>& proofs )
{
	Json json = Json::array();
	for ( const ConstraintProof& proof : proofs )
	{
		json.push_back( { { "constraint", proof.element }, { "verdict", lw_verdict_name( proof.verdict ) } } );
		if ( proof.verdict != LW_VERDICT_FREE )
		{
			json.back()["time"] = proof.time;
			json.back()["error"] = proof.error;
			json.back()["value"] = proof.value;
			json.back()["excess"] = proof.excess;
		}
	}
	return json;
}

/// A world for each chapter.
std::vector<PageInput> pagesOf(
    const AuditOptions& options, const Input& input, const Driver& driver, const lw_edge_def& edge )
{
	std::vector<PageInput> pages;
	for ( const Chapter& chapter : driver.chapters )
	{
		const std::string& file = options.steps.empty() ? options.trajectory : options.steps;
		PageInput page = pageOf( input, *chapter.problem,
		    motionOfTrajectory( { *chapter.problem, edge.flags, edge.min_d, file }, chapter.segments ), edge.flags );
		page.min_d = edge.min_d;
		page.source = file;
		page.notes = driver.whole().problems;
		page.chapter = chapter.name;
		pages.push_back( std::move( page ) );
	}
	return pages;
}

/// @return false: a certificate is wanted, and there is none
bool writeCertificate( const AuditOptions& options, const Input& input, const Driver& driver, const lw_edge_def& edge,
    CertificateFile& certificate, std::vector<OutputFile*>& files )
{
	if ( options.certificate.empty() )
	{
		return true;
	}
	if ( driver.chapters.size() != 1 )
	{
		throw io::Error( "command line", "--certificate",
		    fmt::format( "a certificate has one world and one group, and this motion has {}", driver.chapters.size() ),
		    "audit each part with its own world by --trajectory" );
	}
	const Chapter& chapter = driver.chapters.front();
	const std::string& file = options.steps.empty() ? options.trajectory : options.steps;
	std::vector<certify::Piece> pieces;
	for ( const Segment& segment : chapter.segments )
	{
		pieces.push_back( { segment.degree, segment.points, segment.seconds } );
	}
	certify::Settings claim = claimOf( edge.min_d, edge.flags, filesOf( options.common, file ) );
	claim.tolerance = chapter.tolerance;
	claim.seconds = options.time;
	return certificate.write( *chapter.problem, input, pieces, claim, file, files );
}

/// Finds and writes the corridor. @return a line for people
std::string writeCorridor( const AuditOptions& options, const std::vector<TrajectoryFile>& files, const Driver& driver,
    const lw_edge_def& edge, OutputFile& out )
{
	if ( files.size() != 1 )
	{
		throw io::Error( options.trajectory, "--corridor", fmt::format( "the file has {} trajectories", files.size() ),
		    "give them one by one" );
	}
	const Chapter& chapter = driver.chapters.front();
	CorridorSettings settings;
	settings.edge = edge;
	settings.seconds = options.time;
	const Corridor corridor = widestCorridor( *chapter.problem, chapter.segments, settings );
	out.text = goalWithCorridor( *chapter.problem, files.front(), corridor.tolerance );
	std::string text = fmt::format( "corridor    proved {} times in {:.3f} s:", corridor.proofs, corridor.seconds );
	for ( std::size_t v = 0; v < corridor.tolerance.size(); ++v )
	{
		text += fmt::format( "{} {} {:.3g}", v == 0 ? "" : ",", chapter.problem->variable_names[v], corridor.tolerance[v] );
	}
	return text + "\n";
}

} // namespace

int runTrajectoryAudit( const AuditOptions& options )
{
	Notices notices( options.common.verbose );
	const std::vector<Act> acts = readActs( options );
	TrajectorySettings settings;
	settings.interpolation = interpolationOf( options.interpolation );
	settings.limits = limitsOfFile( options.joint_limits );
	OutputFile report( "--report", options.report ), profile_file( "--profile", options.profile );
	OutputFile corridor_file( "--corridor", options.corridor );
	CertificateFile certificate( options.certificate );
	ViewFile view( options.view );
	io::PathConstraints path;
	const Input input = loadInput( options.common, notices, &path );
	if ( !path.items.empty() )
	{
		throw io::Error( path.file, "items",
		    "are a sequence, and no trajectory says where its motions begin and the scene changes",
		    "give its motions by --steps, or the request of one motion" );
	}
	note( settings.limits, options.joint_limits, input.robot, notices );
	settings.edge.min_d = options.common.min_d;
	settings.edge.flags = options.common.checkFlags();
	const std::vector<TrajectoryFile> files = filesOf( acts );
	const std::string group = groupOf( files.front(), options.common.group, input.robot );
	std::vector<io::Notice> unused;
	const Values start = startValues( files, input.robot, unused );
	notices.add( "unused joints", unused );
	const Values standing_at = standing( input.robot, input.request ? &*input.request : nullptr, start );
	Stage stage( input.robot, problemOptions( input, group, {} ), standing_at );
	Driver driver( options, input, stage, notices, settings );
	{
		const std::shared_ptr<const io::Problem> problem = driver.use( group );
		// Joints that the motion does not move stand where the file says, inside of their limits or not
		for ( const std::string& violation : limitViolations( problem->robot.get(), problem->reference ) )
		{
			notices.add( "joint limits", fmt::format( "{}: start state: {}", files.front().file, violation ) );
		}
	}
	for ( const Act& act : acts )
	{
		if ( act.files.empty() )
		{
			driver.change( act.step );
		}
		for ( const TrajectoryFile& file : act.files )
		{
			driver.drive( file );
		}
	}
	const std::vector<ConstraintProof> constraints = proveConstraints( path, driver );
	std::string told = motions::describe( constraints );
	std::vector<OutputFile*> out;
	if ( !options.report.empty() )
	{
		report.text = jsonText( reportOf( options, input, group, driver, notices, toJson( constraints ) ) );
		out.push_back( &report );
	}
	if ( !options.profile.empty() )
	{
		profile_file.text = driver.profile;
		out.push_back( &profile_file );
	}
	if ( !options.corridor.empty() && driver.whole().valid() )
	{
		told += writeCorridor( options, files, driver, settings.edge, corridor_file );
		out.push_back( &corridor_file );
	}
	const bool is_certified =
	    !driver.whole().valid() || writeCertificate( options, input, driver, settings.edge, certificate, out );
	if ( view.isWanted() )
	{
		view.write( pagesOf( options, input, driver, settings.edge ), out );
	}
	commitTogether( out );
	printOut(
	    ( options.steps.empty() ? "" : driver.told ) + motions::describe( driver.whole() ) + told + certificate.told() );
	return driver.whole().valid() && areKept( constraints ) && is_certified ? exit_yes : exit_no;
}

} // namespace leeway::cli
