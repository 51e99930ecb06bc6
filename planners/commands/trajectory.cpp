// SPDX-License-Identifier: BSD-3-Clause
// leeway audit --trajectory, --steps: timed trajectories, proved as a controller drives them, in a world that changes in between.
#include "leeway/handles.hpp"
#include "setup/motion_files.hpp"
#include "setup/stage.hpp"
#include "setup/trajectory.hpp"
#include "text/names.hpp"
#include "view/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace leeway::cli
{
namespace
{

constexpr double profile_step = 0.01;          // seconds
constexpr std::size_t most_samples = 1u << 17; // of a profile
constexpr double gap_tolerance = 1e-3;         // radians or metres between the end of a trajectory and the start of the next

Interpolation interpolationOf( const std::string& name )
{
	return name == "linear"    ? Interpolation::linear
	       : name == "cubic"   ? Interpolation::cubic
	       : name == "quintic" ? Interpolation::quintic
	                           : Interpolation::automatic;
}

/// Clearances over time, exact, at steps of 10 ms and at the end.
std::string profileOf(
    const Workbench& bench, const std::vector<Segment>& segments, lw_check_flags flags, const std::string& file )
{
	const double begin = segments.front().begin, duration = segments.back().begin + segments.back().seconds - begin;
	const std::size_t steps = std::min( most_samples, static_cast<std::size_t>( std::ceil( duration / profile_step ) ) );
	std::string out;
	for ( std::size_t i = 0; i <= steps; ++i )
	{
		const double time = begin + ( steps == 0 ? 0 : duration * static_cast<double>( i ) / static_cast<double>( steps ) );
		const lw_state_result state = measure( bench, stateAt( segments, time ), flags, nullptr, file, "the trajectory" );
		const auto cell = [&]( lw_check_flags flag, const lw_clearance& clearance )
		{ return ( flags & flag ) != 0 ? fmt::format( "{}", nameSelf( bench.checker(), clearance ).least() ) : ""; };
		out += fmt::format(
		    "{},{},{}\n", time, cell( LW_CHECK_ENVIRONMENT, state.environment ), cell( LW_CHECK_SELF, state.self ) );
	}
	return out;
}

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

const TrajectoryFile& firstOf( const std::vector<Act>& acts )
{
	return std::find_if( acts.begin(), acts.end(), []( const Act& act ) { return !act.files.empty(); } )->files.front();
}

/// Where all joints stand at the beginning: as the first start state or first point says that has them.
Values startValues( const std::vector<Act>& acts, const io::RobotModel& robot, Notices& notices )
{
	Values values;
	const std::vector<std::string> known = variableNames( robot );
	const auto is_known = [&]( const std::string& name )
	{ return std::find( known.begin(), known.end(), name ) != known.end(); };
	for ( const Act& act : acts )
	{
		for ( const TrajectoryFile& file : act.files )
		{
			for ( const auto& [name, value] : file.start_state )
			{
				if ( is_known( name ) )
				{
					values.emplace( name, value );
					continue;
				}
				notices.add( "unused joints",
				    fmt::format( "{}: trajectory_start: joint '{}': the robot cannot move it; it is ignored", file.file, name ) );
			}
			for ( std::size_t i = 0; i < file.joint_names.size(); ++i )
			{
				if ( is_known( file.joint_names[i] ) )
				{
					values.emplace( file.joint_names[i], file.points.front().positions[i] );
				}
			}
		}
	}
	return values;
}

/// The options for joints of this group, and for all joints. Those of other groups' joints are for other steps.
std::vector<std::string> tolerancesFor( const AuditOptions& options, const Workbench& bench )
{
	const std::vector<std::string>& names = bench.problem().variable_names;
	std::vector<std::string> out;
	for ( const std::string& text : options.tolerance )
	{
		const std::string name = text.substr( 0, text.rfind( '=' ) );
		const bool other = !options.steps.empty() && text.find( '=' ) != std::string::npos &&
		                   std::find( names.begin(), names.end(), name ) == names.end() &&
		                   bench.variable( name ) != LW_INVALID_INDEX;
		if ( !other )
		{
			out.push_back( text );
		}
	}
	return out;
}

/// Joints that the motion does not move stand where the file says, inside of their limits or not.
void noteLimits( const Workbench& bench, const std::string& file, Notices& notices )
{
	for ( const std::string& violation : limitViolations( bench, bench.problem().reference ) )
	{
		notices.add( "joint limits", fmt::format( "{}: start state: {}", file, violation ) );
	}
}

class Driver
{
public:
	Driver( const AuditOptions& options, const Input& input, Stage& stage, Notices& notices, TrajectorySettings settings )
	    : m_options( options ), m_input( input ), m_stage( stage ), m_notices( notices ), m_settings( std::move( settings ) )
	{
	}

	void drive( const TrajectoryFile& file )
	{
		const std::string group = groupOf( file, m_options.common.group, m_input.robot );
		const Workbench& bench = m_stage.use( group );
		m_notices.add( "fields of the trajectory", file.notices );
		m_settings.tolerance = tolerances( bench, file.file, file.path_tolerance, tolerancesFor( m_options, bench ) );
		const double begin = whole.duration;
		const std::vector<Segment> approaches = approachesOf( bench, file, begin );
		std::vector<Segment> segments = segmentsOf(
		    bench, file, m_settings.interpolation, approaches.empty() ? begin : begin + approaches.back().seconds );
		std::vector<std::string> problems = differences( bench, file, segments.front() );
		if ( !approaches.empty() )
		{
			segments.insert( segments.begin(), approaches.back() );
		}
		TrajectoryAudit audit = auditTrajectory( bench, m_input.robot, file.file, segments, m_settings, approaches );
		audit.problems.insert( audit.problems.end(), problems.begin(), problems.end() );
		if ( !m_options.profile.empty() )
		{
			profile += profileOf( bench, segments, m_settings.edge.flags, file.file );
		}
		append( whole, audit );
		keep( segments, group );
		m_stage.moved( stateAt( segments, whole.duration ) );
		told += fmt::format( "step        {:.4f} to {:.4f} s, {}: {}, {}\n", begin, whole.duration,
		    group.empty() ? "all joints" : group, file.file, verdictName( audit.violation.verdict ) );
		Json step = toJson( audit );
		step["file"] = file.file;
		step["group"] = group;
		step["begin"] = begin;
		steps.push_back( step );
	}

	TrajectoryAudit whole;
	std::string profile = "time,environment,self\n", told;
	Json steps = Json::array();
	std::vector<Segment> all; ///< of a page
	std::string shown_group;

private:
	static const char* verdictName( lw_verdict verdict )
	{
		return verdict == LW_VERDICT_FREE ? "FREE" : verdict == LW_VERDICT_BLOCKED ? "BLOCKED" : "UNDECIDED";
	}

	/// For a page, which has one group.
	void keep( const std::vector<Segment>& segments, const std::string& group )
	{
		if ( !m_options.view.empty() && !all.empty() && group != shown_group )
		{
			throw io::Error( "command line", "--view",
			    fmt::format( "the trajectories are of the groups '{}' and '{}', and a page has one", shown_group, group ),
			    "name a group with all joints by --group, or leave it out" );
		}
		shown_group = group;
		all.insert( all.end(), segments.begin(), segments.end() );
	}

	struct Place
	{
		double value;
		const char* of;
	};

	/// Where a joint of the group stands before a trajectory, by all that is known of it; empty: nothing is.
	std::vector<Place> placesOf( const TrajectoryFile& file, const std::string& name ) const
	{
		std::vector<Place> out;
		const double left = m_stage.at( name ); // NaN: never moved
		const auto own = std::find_if( file.start_state.begin(), file.start_state.end(),
		    [&]( const std::pair<std::string, double>& entry ) { return entry.first == name; } );
		if ( !std::isnan( left ) )
		{
			out.push_back( { left, "the end of the one before" } );
		}
		if ( own != file.start_state.end() )
		{
			out.push_back( { own->second, "its start state" } );
		}
		if ( std::isnan( left ) && m_input.request && m_input.request->start.values.count( name ) != 0 )
		{
			out.push_back( { m_input.request->start.values.at( name ), "the request's start" } );
		}
		return out;
	}

	/// The ways to a first point that comes later than the start; empty if it does not, or if the start is not known.
	std::vector<Segment> approachesOf( const Workbench& bench, const TrajectoryFile& file, double begin ) const
	{
		const TrajectoryPoint& first = file.points.front();
		if ( !( first.time > 0 ) )
		{
			return {};
		}
		TrajectoryPoint start = first; // with as many velocities and accelerations as it
		start.time = 0;
		std::fill( start.accelerations.begin(), start.accelerations.end(), 0.0 );
		std::vector<std::string> unknown;
		for ( std::size_t i = 0; i < file.joint_names.size(); ++i )
		{
			const std::string& name = file.joint_names[i];
			const std::vector<Place> places = placesOf( file, name );
			if ( places.empty() )
			{
				unknown.push_back( name );
				continue;
			}
			start.positions[i] = places.front().value;
			if ( !start.velocities.empty() )
			{
				const auto velocity = file.start_velocity.find( name );
				start.velocities[i] = velocity == file.start_velocity.end() ? 0 : velocity->second;
			}
		}
		const std::string element = file.at( "points[0].time_from_start" );
		if ( unknown.size() == file.joint_names.size() )
		{
			m_notices.add( "first points",
			    fmt::format(
			        "{}: {}: the first point comes after {:g} s; the motion from the robot's state to it is not known and "
			        "not proved",
			        file.file, element, first.time ) );
			return {};
		}
		if ( !unknown.empty() )
		{
			throw io::Error( file.file, element,
			    fmt::format( "the first point comes after {:g} s, and the start of {} is not known", first.time, listed( unknown ) ),
			    "name all joints of the trajectory in trajectory_start" );
		}
		return approachesTo( bench, file, start, m_settings.interpolation, begin );
	}

	/// Joints that stand elsewhere than a first point at time 0, to which the controller jumps, or in two places at once.
	std::vector<std::string> differences( const Workbench& bench, const TrajectoryFile& file, const Segment& first ) const
	{
		const std::vector<std::string>& names = bench.problem().variable_names;
		const std::string what = file.element.empty() ? file.file : file.element;
		std::vector<std::string> out;
		for ( std::uint32_t i = 0; i < bench.variableNames().size(); ++i )
		{
			const std::string& name = bench.variableNames()[i];
			std::vector<Place> places = placesOf( file, name );
			const auto found = std::find( names.begin(), names.end(), name );
			if ( found == names.end() )
			{
				places.insert( places.begin(), { bench.problem().reference[i], "the proof" } );
			}
			else if ( file.points.front().time == 0 )
			{
				places.insert( places.begin(), { first.points[static_cast<std::size_t>( found - names.begin() )], "its first point" } );
			}
			for ( std::size_t k = 1; k < places.size(); ++k )
			{
				if ( !( std::abs( places[k].value - places[0].value ) <= gap_tolerance ) )
				{
					out.push_back( fmt::format( "{}: joint {} is at {:.6g} in {} and at {:.6g} in {}", what, name,
					    places[0].value, places[0].of, places[k].value, places[k].of ) );
				}
			}
		}
		return out;
	}

	const AuditOptions& m_options;
	const Input& m_input;
	Stage& m_stage;
	Notices& m_notices;
	TrajectorySettings m_settings;
};

} // namespace

int runTrajectoryAudit( const AuditOptions& options )
{
	Notices notices( options.common.verbose );
	const std::vector<Act> acts = readActs( options );
	TrajectorySettings settings;
	if ( !options.joint_limits.empty() )
	{
		settings.limits = readJointLimits( options.joint_limits );
		readsFile( "--joint-limits", options.joint_limits );
		notices.add( "joint limits of the file", settings.limits.notices );
	}
	OutputFile report( "--report", options.report ), profile_file( "--profile", options.profile );
	ViewFile view( options.view );
	const Input input = loadInput( options.common, notices );
	noteUnknownLimits( settings.limits, options.joint_limits, input.robot, notices );
	settings.edge.min_d = options.common.min_d;
	settings.edge.flags = options.common.checkFlags();
	settings.interpolation = interpolationOf( options.interpolation );
	const std::string group = groupOf( firstOf( acts ), options.common.group, input.robot );
	Stage stage( input, notices, startValues( acts, input.robot, notices ) );
	noteLimits( stage.use( group ), firstOf( acts ).file, notices );
	Driver driver( options, input, stage, notices, settings );
	for ( const Act& act : acts )
	{
		if ( act.files.empty() )
		{
			stage.change( act.step, options.steps );
		}
		for ( const TrajectoryFile& file : act.files )
		{
			driver.drive( file );
		}
	}
	std::vector<OutputFile*> out;
	if ( !options.report.empty() )
	{
		Json json;
		json[options.steps.empty() ? "trajectory" : "steps_file"] =
		    options.steps.empty() ? options.trajectory : options.steps;
		json["robot"] = input.robot.name;
		json["group"] = group;
		json["audit"] = toJson( driver.whole );
		if ( !options.steps.empty() )
		{
			json["steps"] = driver.steps;
		}
		report.text = jsonText( json );
		out.push_back( &report );
	}
	if ( !options.profile.empty() )
	{
		profile_file.text = driver.profile;
		out.push_back( &profile_file );
	}
	if ( view.isWanted() )
	{
		const Workbench& bench = stage.use( driver.shown_group );
		PageInput page = { input, bench, motionOfTrajectory( bench, driver.all, settings.edge.flags, options.trajectory ),
		    settings.edge.flags };
		page.min_d = settings.edge.min_d;
		page.source = options.trajectory;
		page.notes = driver.whole.problems;
		view.write( page, out );
	}
	commitTogether( out );
	printOut( ( options.steps.empty() ? "" : driver.told ) + describe( driver.whole ) );
	return driver.whole.valid() ? exit_yes : exit_no;
}

} // namespace leeway::cli
