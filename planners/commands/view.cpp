// SPDX-License-Identifier: BSD-3-Clause
// leeway view: a page with robot, scene, motion and clearances; and pages of other results.
#include "commands/page_file.hpp"
#include "program/states.hpp"

#include "leeway/prepare.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace leeway::cli
{

// ---- pages of results -------------------------------------------------------------------------------------------------

ViewFile::ViewFile( const std::string& path )
{
	if ( !path.empty() )
	{
		requireView( "--view" );
		m_file.emplace( "--view", path );
	}
}

void ViewFile::write( PageInput page, std::vector<OutputFile*>& files )
{
	std::vector<PageInput> one;
	one.push_back( std::move( page ) );
	write( std::move( one ), files );
}

void ViewFile::write( std::vector<PageInput> chapters, std::vector<OutputFile*>& files )
{
	Progress progress( "writing the page" );
	std::vector<const PageInput*> pages;
	for ( PageInput& chapter : chapters )
	{
		chapter.progress = shownBy( progress );
		pages.push_back( &chapter );
	}
	m_file->text = pageHtml( pages );
	files.push_back( &*m_file );
}

PageInput pageOf( const Input& input, const io::Problem& problem, ViewMotion motion, lw_check_flags flags )
{
	PageInput page = { input.robot, input.scene ? &*input.scene : nullptr, problem, std::move( motion ), flags };
	page.robot_file = input.robot_file;
	page.scene_file = input.scene_file;
	return page;
}

// ---- leeway view -----------------------------------------------------------------------------------------------------

namespace
{

/// One of the three sources of a motion, read; none: the start state alone.
struct Source
{
	std::vector<PathFile> paths;
	std::vector<TrajectoryFile> trajectories;
	std::optional<CsvTable> states;
	std::string file;
};

Source readSource( const ViewOptions& options )
{
	Source source;
	for ( const std::string& file : options.paths )
	{
		source.paths.push_back( readPath( file ) );
		readsFile( "--path", file );
	}
	if ( !options.trajectory.empty() )
	{
		source.trajectories = readTrajectories( options.trajectory );
		readsFile( "--trajectory", options.trajectory );
	}
	else if ( !options.states.empty() )
	{
		source.states = readCsv( options.states );
		readsFile( "--states", options.states );
	}
	source.file = ( options.paths.empty() ? "" : options.paths.front() ) + options.trajectory + options.states;
	return source;
}

Workbench makeBench( const Source& source, const ViewOptions& options, const Input& input, Notices& notices )
{
	std::string group = options.common.group;
	Values start;
	std::vector<io::Notice> unused;
	for ( const PathFile& path : source.paths )
	{
		const std::string of_path = groupOf( path, options.common.group, input.robot );
		const Values its_start = startValues( path, input.robot, unused );
		if ( &path != &source.paths.front() && of_path != group )
		{
			throw io::Error( path.file, "group",
			    fmt::format( "is '{}', and that of {} is '{}'", of_path, source.file, group ),
			    "show paths of one group in a page" );
		}
		group = of_path;
		start = &path == &source.paths.front() ? its_start : start;
	}
	if ( !source.paths.empty() )
	{
		return Workbench( input, group, start, notices );
	}
	if ( !source.trajectories.empty() )
	{
		group = groupOf( source.trajectories.front(), group, input.robot );
		start = startValues( source.trajectories, input.robot, unused );
	}
	notices.add( "unused joints", unused );
	return Workbench( input, group, start, notices );
}

/// The rows of a table as states of the group. Joints outside of the group stand still on a page: they must not change.
std::vector<std::vector<double>> statesOf(
    const CsvTable& table, const std::string& file, const Input& input, Workbench& bench, Notices& notices )
{
	const StateColumns columns( table, "", bench, input.robot, notices );
	std::vector<std::vector<double>> states;
	for ( std::size_t row = 0; row < table.rows.size(); ++row )
	{
		const std::vector<double> full = columns.full( row, bench.problem().reference );
		if ( bench.use( full ) && row > 0 )
		{
			throw io::Error( file, fmt::format( "line {}", table.rows[row].line ),
			    "moves a joint outside of the group, and a page shows one group",
			    "leave out --group, or name a group with all joints that move" );
		}
		states.push_back( bench.groupState( full ) );
	}
	if ( states.empty() )
	{
		throw io::Error( file, "rows", "there are none", "give at least one state" );
	}
	return states;
}

/// The required clearance: of the options, else of the path.
double requiredOf( const Source& source, const ViewOptions& options )
{
	return options.common.min_d_given || source.paths.empty() ? options.common.min_d : source.paths.front().min_d;
}

ViewMotion motionOf(
    const Source& source, const ViewOptions& options, const Input& input, Workbench& bench, Notices& notices )
{
	const lw_check_flags flags = options.common.checkFlags();
	const io::Problem& problem = bench.problem();
	Progress progress( "measuring the motion" );
	const Measuring how = { problem, flags, requiredOf( source, options ), source.file, shownBy( progress ) };
	if ( !source.paths.empty() )
	{
		notices.add( "keys of the path", source.paths.front().notices );
		return motionOfPath( how, groupPoints( source.paths.front(), problem ) );
	}
	if ( !source.trajectories.empty() )
	{
		Drive drive( input.request ? input.request->start.values : Values() );
		TrajectorySettings settings;
		settings.edge.min_d = options.common.min_d;
		settings.edge.flags = flags;
		std::vector<Segment> segments;
		for ( const TrajectoryFile& file : source.trajectories ) // driven one after the other
		{
			drive.add( problem, input.robot, file, settings );
			notices.add( "fields of the trajectory", file.notices );
			notices.add( "first points", drive.notices() );
			segments.insert( segments.end(), drive.segments().begin(), drive.segments().end() );
		}
		for ( const std::string& text : drive.whole().problems )
		{
			notices.add( "problems of the trajectory", text );
		}
		return motionOfTrajectory( how, segments );
	}
	if ( source.states )
	{
		const std::vector<std::vector<double>> states = statesOf( *source.states, source.file, input, bench, notices );
		return motionOfStates( bench.problem(), states, {}, flags, source.file );
	}
	return motionOfStates( problem, { io::startState( problem ) }, {}, flags, options.common.robot );
}

/// The other paths, by their files.
std::vector<NamedMotion> othersOf(
    const Source& source, const ViewOptions& options, const io::Problem& problem, Notices& notices )
{
	std::vector<NamedMotion> out;
	for ( std::size_t i = 1; i < source.paths.size(); ++i )
	{
		const PathFile& path = source.paths[i];
		Progress progress( "measuring the motion" );
		notices.add( "keys of the path", path.notices );
		const Measuring how = {
		    problem, options.common.checkFlags(), requiredOf( source, options ), path.file, shownBy( progress ) };
		out.push_back( { path.file, motionOfPath( how, groupPoints( path, problem ) ) } );
	}
	return out;
}

} // namespace

int runView( const ViewOptions& options )
{
	Notices notices( options.common.verbose );
	requireView( "view" );
	const Source source = readSource( options );
	std::optional<OutputFile> out, png;
	if ( !options.out.empty() )
	{
		out.emplace( "--out", options.out );
	}
	if ( !options.picture.file.empty() )
	{
		png.emplace( "--png", options.picture.file );
	}
	const Input input = loadInput( options.common, notices );
	Workbench bench = makeBench( source, options, input, notices );
	(void)prepare( bench.checker() ); // a mesh that cannot be made ends the first state that needs it
	ViewMotion motion = motionOf( source, options, input, bench, notices );
	PageInput page = pageOf( input, bench.problem(), std::move( motion ), options.common.checkFlags() );
	page.min_d = requiredOf( source, options );
	page.triangles = options.triangles;
	page.live = !options.stored;
	page.source = source.file;
	page.more = othersOf( source, options, bench.problem(), notices );
	for ( NamedMotion& one : page.more )
	{
		setNothingApart( one.motion );
	}
	if ( !page.more.empty() )
	{
		setNothingApart( page.motion );
	}
	page.notes = notices.all();
	Progress progress( "making the page" );
	page.progress = shownBy( progress );
	const std::string html = pageHtml( { &page } );
	std::vector<OutputFile*> files;
	if ( out )
	{
		out->text = html;
		files.push_back( &*out );
	}
	if ( png )
	{
		png->text = pagePicture( html, options.picture );
		files.push_back( &*png );
	}
	commitTogether( files );
	if ( out )
	{
		tell( "leeway: {}: {:.1f} MB; open it in a browser\n", options.out, 1e-6 * static_cast<double>( html.size() ) );
	}
	return exit_yes;
}

} // namespace leeway::cli
