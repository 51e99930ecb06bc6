// SPDX-License-Identifier: BSD-3-Clause
// leeway spherize: enclosing spheres of the links, for programs that know only spheres.
#include "motions/json.hpp"
#include "commands/page_file.hpp"

#include "leeway/io/spheres.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>

namespace leeway::cli
{
namespace
{

namespace fs = std::filesystem;

/// The folder, created if missing; a failed run removes the folders that it created.
class OutputFolder
{
public:
	explicit OutputFolder( const std::string& folder )
	{
		std::error_code error;
		for ( fs::path path = fs::absolute( folder, error ); !path.empty() && !fs::exists( path, error );
		      path = path.parent_path() )
		{
			if ( path.has_filename() ) // not of "a/b/", where a/b comes next
			{
				m_made.push_back( path );
			}
		}
		fs::create_directories( folder, error );
		if ( error || !fs::is_directory( folder ) )
		{
			remove();
			throw io::Error(
			    folder, "--out", error ? error.message() : "is not a folder", "name a folder that can be written" );
		}
	}
	~OutputFolder() { remove(); }
	OutputFolder( const OutputFolder& ) = delete;
	OutputFolder& operator=( const OutputFolder& ) = delete;
	void keep() { m_made.clear(); }

private:
	void remove()
	{
		std::error_code ignored; // of one that somebody else has put something into
		for ( const fs::path& path : m_made )
		{
			fs::remove( path, ignored );
		}
		m_made.clear();
	}
	std::vector<fs::path> m_made; // innermost first
};

std::string linkTable( const std::vector<io::LinkSpheres>& links )
{
	std::size_t width = 4;
	for ( const io::LinkSpheres& link : links )
	{
		width = std::max( width, link.link.size() );
	}
	std::string text = fmt::format( "  {:<{}} {:>8} {:>12} {:>12} {:>7} {:>6} {:>9}\n", "link", width, "spheres",
	    "excess mm", "attained mm", "closed", "open", "ms" );
	for ( const io::LinkSpheres& link : links )
	{
		fmt::format_to( std::back_inserter( text ), "  {:<{}} {:>8} {:>12.3f} {:>12.3f} {:>7} {:>6} {:>9.1f}\n", link.link,
		    width, link.count(), 1000 * link.report.excess, 1000 * link.report.excess_attained, link.report.shells,
		    link.report.open_shells, link.milliseconds );
	}
	return text;
}

/// Links whose inside does not count, with a remedy.
void tellOpenShells( const std::vector<io::LinkSpheres>& links, const std::string& robot, Notices& notices )
{
	for ( const io::LinkSpheres& link : links )
	{
		if ( link.report.open_shells > 0 && link.report.widest_open_hole > 0 )
		{
			notices.add( "open shells",
			    fmt::format( "{}: link {}: {} of its surfaces have holes, up to {:.1f} mm wide: their inside counts "
			                 "as outside, which takes more spheres; --close-holes takes them for closed",
			        robot, link.link, link.report.open_shells, 1000 * link.report.widest_open_hole ) );
		}
	}
}

/// Links for which the time was too short.
void tellUnfinished( const std::vector<io::LinkSpheres>& links, const SpherizeOptions& options, Notices& notices )
{
	for ( const io::LinkSpheres& link : links )
	{
		if ( !link.met_target && options.excess > 0 )
		{
			notices.add( "spheres that are too large",
			    fmt::format(
			        "{}: link {}: its {} spheres enclose it but reach {:.3f} mm beyond it instead of {:g}: the search "
			        "ended before better ones were found; give more --time than {:g} s, or a larger --excess",
			        options.common.robot, link.link, link.count(), 1000 * link.report.excess, options.excess,
			        options.time ) );
		}
	}
	if ( options.excess == 0 && !links.empty() && !links.front().met_target )
	{
		notices.add( "spheres that are too large",
		    fmt::format(
		        "{}: --spheres: the search for a smaller excess ended after --time {:g} s; give more, or fewer spheres",
		        options.common.robot, options.time ) );
	}
}

Json toJson( const std::vector<io::LinkSpheres>& links, const io::RobotModel& robot )
{
	Json json = { { "robot", robot.name }, { "links", Json::array() } };
	for ( const io::LinkSpheres& link : links )
	{
		json["links"].push_back( { { "link", link.link }, { "spheres", link.count() }, { "excess", link.report.excess },
		    { "excess_attained", link.report.excess_attained }, { "met_target", link.met_target },
		    { "encloses", link.report.encloses }, { "shells", link.report.shells },
		    { "open_shells", link.report.open_shells }, { "holes_closed", link.report.holes },
		    { "widest_hole_closed", link.report.widest_hole }, { "widest_open_hole", link.report.widest_open_hole },
		    { "milliseconds", link.milliseconds } } );
	}
	return json;
}

} // namespace

int runSpherize( const SpherizeOptions& options )
{
	Notices notices( options.common.verbose );
	OutputFolder folder( options.out );
	ViewFile view( options.view );
	CommonOptions common = options.common;
	common.all_pairs = common.srdf.empty();
	const Input input = loadInput( common, notices );
	const std::string stem = ( fs::path( options.out ) / fs::path( options.common.robot ).stem() ).string() + "_spheres";
	OutputFile urdf( "--out", stem + ".urdf" ), srdf( "--out", stem + ".srdf" ), yaml( "--out", stem + ".yml" ),
	    report( "--out", stem + ".json" );
	io::SpherizeOptions how;
	how.excess = options.excess / 1000;
	how.sphere_count = options.spheres;
	how.close_holes = options.close_holes / 1000;
	how.seconds = options.time;
	const double start = now();
	std::vector<io::LinkSpheres> links;
	{
		Progress progress( fmt::format( "spheres (at most {:g} s)", options.time ) );
		how.progress = [&progress]( const std::string& link, double share ) { progress.stage( link, share ); };
		links = io::spherize( input.robot, how );
		how.progress = nullptr; // progress ends here
	}
	const double seconds = now() - start;
	tellOpenShells( links, input.robot.urdf_file, notices );
	tellUnfinished( links, options, notices );

	std::size_t count = 0;
	double excess = 0;
	for ( const io::LinkSpheres& link : links )
	{
		count += link.count();
		excess = std::max( excess, link.report.excess );
	}
	urdf.text = io::writeSpheresUrdf( input.robot, links );
	srdf.text = io::writeSpheresSrdf( input.robot, links );
	yaml.text = io::writeSpheresYaml( input.robot, links );
	Json json = toJson( links, input.robot );
	json["spheres"] = count;
	json["excess"] = excess;
	json["close_holes"] = how.close_holes;
	json["seconds"] = seconds;
	json["notices"] = notices.all();
	report.text = jsonText( json );
	std::string text = fmt::format( "robot {} ({})\n", input.robot.name, input.robot.urdf_file );
	text += linkTable( links );
	text += fmt::format( "{} spheres around {} links, proved to enclose them and to reach at most {:.3f} mm beyond; "
	                     "{:.2f} s\n",
	    count, links.size(), 1000 * excess, seconds );
	std::vector<OutputFile*> files = { &urdf, &srdf, &yaml, &report };
	if ( view.isWanted() )
	{
		const Workbench bench( input, "", {}, notices );
		PageInput page = pageOf( input, bench.problem(),
		    motionOfStates(
		        bench.problem(), { io::startState( bench.problem() ) }, {}, LW_CHECK_BOTH, options.common.robot ),
		    LW_CHECK_BOTH );
		page.spheres = links;
		page.notes = notices.all();
		view.write( page, files );
	}
	commitTogether( files );
	folder.keep();
	for ( const OutputFile* file : files )
	{
		text += fmt::format( "written: {}\n", file->path() );
	}
	printOut( text );
	return exit_yes;
}

} // namespace leeway::cli
