// SPDX-License-Identifier: BSD-3-Clause
// leeway guard: a recorded drive, and in each cycle whether the rest of the motion is still proved.
#include "leeway/motions/motion_files.hpp"
#include "commands/page_file.hpp"
#include "replay/replay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace leeway::cli
{
namespace
{

/// The trajectories of the file as one motion, in a row.
std::vector<Segment> motionOf(
    const GuardOptions& options, const std::vector<TrajectoryFile>& files, const io::Problem& problem )
{
	std::vector<Segment> segments;
	double begin = 0;
	for ( const TrajectoryFile& file : files )
	{
		// on the file's clock: a first point may come later than its time 0
		const std::vector<Segment> own =
		    segmentsOf( problem, file, interpolationOf( options.interpolation ), begin + file.points.front().time );
		segments.insert( segments.end(), own.begin(), own.end() );
		begin += file.points.back().time;
	}
	return segments;
}

/// Of every joint. @throws io::Error
std::vector<double> decelerations( const GuardOptions& options, const io::Problem& problem )
{
	if ( options.deceleration.empty() )
	{
		return {};
	}
	std::vector<Tolerance> given = givenTolerances( options.deceleration );
	for ( Tolerance& one : given )
	{
		one.file = "command line";
		one.element = "--deceleration";
	}
	const std::vector<double> values = tolerances( problem, options.trajectory, {}, given );
	for ( std::size_t i = 0; i < problem.variables.size(); ++i )
	{
		if ( values.empty() || !( values[i] > 0 ) )
		{
			throw io::Error( "command line", "--deceleration",
			    fmt::format( "says none above 0 for joint {}", problem.variable_names[i] ),
			    "give one for all joints, or its own" );
		}
	}
	return values;
}

replay::Settings settingsOf(
    const GuardOptions& options, const io::Problem& problem, const std::vector<TrajectoryFile>& files )
{
	replay::Settings settings;
	settings.guard.edge.min_d = options.common.min_d;
	settings.guard.edge.flags = options.common.checkFlags();
	settings.guard.window = options.window;
	settings.guard.lag = options.lag;
	settings.guard.reaction = options.reaction;
	settings.guard.deceleration = decelerations( options, problem );
	settings.guard.tolerance =
	    tolerances( problem, files.front().file, files.front().path_tolerance, givenTolerances( options.tolerance ) );
	settings.rate = options.rate;
	settings.budget = options.budget;
	settings.stale = options.stale;
	settings.separation = options.people;
	return settings;
}

/// Each world between two changes is a chapter, with the robot every 20 ms.
std::vector<PageInput> pagesOf(
    const GuardOptions& options, const Input& input, const replay::Result& result, const std::vector<Segment>& segments )
{
	constexpr double step = 0.02;
	std::vector<PageInput> pages;
	std::vector<std::string> notes;
	const std::string text = replay::describe( result );
	for ( std::size_t at = 0, end = text.find( '\n' ); end != std::string::npos; at = end + 1, end = text.find( '\n', at ) )
	{
		notes.push_back( text.substr( at, end - at ) );
	}
	for ( std::size_t i = 0; i < result.sceneries.size(); ++i )
	{
		const replay::Scenery& scenery = result.sceneries[i];
		const double end = i + 1 < result.sceneries.size() ? result.sceneries[i + 1].begin : result.cycles.back().time;
		std::vector<std::vector<double>> states;
		std::vector<std::string> labels;
		std::vector<double> times;
		std::vector<Curve> curves = {
		    { "speed scale", "", {} }, { "proved for", "s", {} }, { "age of the sight", "ms", {} } };
		auto cycle = result.cycles.begin();
		for ( double time = scenery.begin; time <= end; time += step )
		{
			cycle = std::find_if(
			    cycle, result.cycles.end() - 1, [&]( const replay::Cycle& c ) { return c.time >= time - 1e-9; } );
			states.push_back( stateAt( segments, time ) );
			times.push_back( time );
			curves[0].values.push_back( cycle->scale );
			curves[1].values.push_back( cycle->proved_until - cycle->time );
			curves[2].values.push_back( 1e3 * cycle->age );
			labels.push_back( fmt::format( "{:.2f} s: {}, proved until {:.2f} s, scale {:.2f}, {:.0f} us", time,
			    lw_verdict_name( cycle->verdict ), cycle->proved_until, cycle->scale, cycle->microseconds ) );
		}
		const lw_check_flags flags = options.common.checkFlags();
		ViewMotion motion = motionOfStates( *scenery.problem, states, labels, flags, options.log );
		motion.unit = StepUnit::seconds;
		for ( std::size_t k = 0; k < times.size(); ++k )
		{
			motion.steps[k].at = times[k];
		}
		PageInput page = pageOf( input, *scenery.problem, motion, flags );
		page.curves = std::move( curves );
		page.min_d = options.common.min_d;
		page.source = "leeway guard";
		page.notes = notes;
		page.chapter = fmt::format( "from {:.2f} s", scenery.begin );
		pages.push_back( std::move( page ) );
	}
	return pages;
}

} // namespace

int runGuard( const GuardOptions& options )
{
	Notices notices( options.common.verbose );
	readsFile( "--trajectory", options.trajectory );
	readsFile( "--replay", options.log );
	const std::vector<TrajectoryFile> files = readTrajectories( options.trajectory );
	OutputFile json_file( "--json", options.json ), profile_file( "--profile", options.profile );
	ViewFile view( options.view );
	const Input input = loadInput( options.common, notices );
	io::LoadOptions load;
	load.package_paths = options.common.package_paths;
	const replay::Log log = replay::readLog( options.log, load );
	notices.add( "shapes of the log", log.notices );
	for ( const TrajectoryFile& file : files )
	{
		notices.add( "fields of the trajectory", file.notices );
	}
	const std::string group = groupOf( files.front(), options.common.group, input.robot );
	std::vector<io::Notice> unused;
	const Values values =
	    standing( input.robot, input.request ? &*input.request : nullptr, startValues( files, input.robot, unused ) );
	notices.add( "unused joints", unused );
	const io::ProblemOptions problem_options = problemOptions( input, group, values );
	const io::Problem problem = io::buildProblem( input.robot, problem_options );
	notices.add( "the model", problem.notices );
	const std::vector<Segment> segments = motionOf( options, files, problem );
	const replay::Settings settings = settingsOf( options, problem, files );
	replay::Result result;
	{
		Progress progress( "driving" );
		result = replay::replay( input.robot, problem_options, segments, log, settings );
	}
	std::vector<OutputFile*> out;
	if ( !options.json.empty() )
	{
		Json json = replay::toJson( result, settings );
		json["robot"] = input.robot.name;
		json["group"] = group;
		json["trajectory"] = options.trajectory;
		json["log"] = options.log;
		json["notices"] = notices.all();
		json_file.text = jsonText( json );
		out.push_back( &json_file );
	}
	if ( !options.profile.empty() )
	{
		profile_file.text = replay::profileCsv( result );
		out.push_back( &profile_file );
	}
	if ( view.isWanted() )
	{
		view.write( pagesOf( options, input, result, segments ), out );
	}
	commitTogether( out );
	printOut( replay::describe( result ) );
	return result.passes() ? exit_yes : exit_no;
}

} // namespace leeway::cli
