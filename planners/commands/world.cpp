// SPDX-License-Identifier: BSD-3-Clause
// leeway world: several robots and moving objects on one clock.
#include "leeway/near.h"
#include "motions/csv.hpp"
#include "motions/names.hpp"
#include "motions/report.hpp"
#include "commands/certificate_file.hpp"
#include "commands/page_file.hpp"
#include "commands/world_cell.hpp"

#include "leeway/prepare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

namespace leeway::cli
{
namespace
{

/// Motions of the command line, PART=FILE, in the place of those of the world file.
void takeMotions( const std::vector<std::string>& motions, io::WorldModel& world )
{
	std::vector<std::string> robots;
	for ( const io::WorldPart& part : world.parts )
	{
		if ( part.kind == io::WorldPart::Kind::robot )
		{
			robots.push_back( part.name );
		}
	}
	for ( const std::string& text : motions )
	{
		const std::size_t equals = text.find( '=' );
		const std::string name = text.substr( 0, equals );
		if ( equals == std::string::npos || std::find( robots.begin(), robots.end(), name ) == robots.end() )
		{
			throw io::Error( "command line", "--motion " + text, fmt::format( "'{}' is no robot of the world", name ),
			    "write ROBOT=FILE; " + useOneOf( name, robots ) );
		}
		for ( io::WorldPart& part : world.parts )
		{
			if ( part.name == name )
			{
				part.motion_file = text.substr( equals + 1 );
				part.motion_start = 0;
				readsFile( "--motion", part.motion_file );
			}
		}
	}
}

Input inputOf( const WorldOptions& options, Notices& notices, const std::set<std::string>& focus )
{
	Input input = loadInput( options.common, notices );
	takeMotions( options.motions, *input.world );
	for ( std::size_t i = 0; !focus.empty() && i < input.robot.links.size(); ++i )
	{
		for ( std::size_t k = 0; k < i; ++k )
		{
			const std::string &a = input.robot.links[i].name, &b = input.robot.links[k].name;
			if ( focus.count( ownerOf( a ) ) + focus.count( ownerOf( b ) ) == 0 )
			{
				input.allowed.emplace_back( a, b );
			}
		}
		for ( std::size_t k = 0; input.scene && k < input.scene->objects.size(); ++k )
		{
			if ( focus.count( ownerOf( input.robot.links[i].name ) ) == 0 )
			{
				input.allowed.emplace_back( input.robot.links[i].name, input.scene->objects[k].name );
			}
		}
	}
	return input;
}

} // namespace

std::string ownerOf( const std::string& link )
{
	return link.substr( 0, link.find( '/' ) );
}

Cell::Cell( const WorldOptions& options, Notices& notices, const std::set<std::string>& focus )
    : m_input( inputOf( options, notices, focus ) ), m_bench( m_input, "", m_input.world->state().values, notices ),
      m_schedule( world(), m_bench.problem() )
{
	notices.add( "motions", m_schedule.notices() );
}

namespace
{

/// Seconds: the first contact is known to this.
constexpr double contact_resolution = 1e-3;

// ---- check -----------------------------------------------------------------------------------------------------------

struct Nearest
{
	std::string first, second; ///< owners
	Named pair;
};

/// The nearest pair of each two owners, nearest first.
std::vector<Nearest> nearestPairs(
    const Workbench& bench, const std::vector<double>& q, lw_check_flags flags, const std::string& file )
{
	lw_near_def def = lw_near_def_default();
	def.flags = flags;
	def.distance = HUGE_VAL;
	std::vector<lw_near_pair> rows( 256 );
	std::uint32_t count = 0;
	for ( bool fits = false; !fits; )
	{
		const lw_status status = lw_checker_near(
		    bench.checker(), bench.query(), q.data(), &def, rows.data(), static_cast<std::uint32_t>( rows.size() ), &count );
		if ( status != LW_OK )
		{
			throw io::Error( file, "state", std::string( "near pairs: " ) + lw_status_name( status ), "correct the state" );
		}
		fits = count <= rows.size();
		rows.resize( fits ? rows.size() : count );
	}
	std::vector<Nearest> out;
	std::set<std::pair<std::string, std::string>> seen;
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		const lw_near_pair& row = rows[i];
		Nearest nearest;
		nearest.pair =
		    row.self ? nameSelf( bench.checker(), row.clearance ) : nameEnvironment( bench.checker(), row.clearance );
		nearest.first = ownerOf( nearest.pair.first );
		nearest.second = row.self ? ownerOf( nearest.pair.second ) : "scene";
		if ( row.self && nearest.second < nearest.first )
		{
			std::swap( nearest.first, nearest.second );
			std::swap( nearest.pair.first, nearest.pair.second );
			std::swap( nearest.pair.point_a, nearest.pair.point_b );
		}
		if ( seen.insert( { nearest.first, nearest.second } ).second )
		{
			out.push_back( std::move( nearest ) );
		}
	}
	return out;
}

int runWorldCheck( const WorldOptions& options )
{
	Notices notices( options.common.verbose );
	OutputFile json_file( "--json", options.json );
	Cell cell( options, notices );
	Schedule& schedule = cell.schedule();
	const std::vector<double> q = schedule.state( options.time );
	const std::vector<Nearest> nearest = nearestPairs( cell.bench(), q, options.common.checkFlags(), options.common.cell );
	const bool free = nearest.empty() || nearest.front().pair.lower > options.common.min_d;
	std::string text = fmt::format( "time        {:g} s\n", options.time );
	Json pairs = Json::array();
	for ( const Nearest& one : nearest )
	{
		text += fmt::format( "{:<28}{:.6g} m{}: {} - {}\n", one.first + " - " + one.second, one.pair.least(),
		    one.pair.marginText(), one.pair.first, one.pair.second );
		Json row = jsonClearance( one.pair );
		row["between"] = { one.first, one.second };
		pairs.push_back( row );
	}
	text += free ? "free\n" : "not free\n";
	if ( !options.json.empty() )
	{
		Json json;
		json["world"] = options.common.cell;
		json["time"] = options.time;
		json["min_d"] = options.common.min_d;
		json["free"] = free;
		json["pairs"] = pairs;
		for ( std::size_t i = 0; i < q.size(); ++i )
		{
			json["state"][cell.bench().problem().variable_names[i]] = q[i];
		}
		json["notices"] = notices.all();
		json_file.text = jsonText( json );
		json_file.commit();
	}
	printOut( text );
	return free ? exit_yes : exit_no;
}

// ---- audit -----------------------------------------------------------------------------------------------------------

ScheduleSettings settingsOf( const WorldOptions& options )
{
	ScheduleSettings settings;
	settings.edge.min_d = options.common.min_d;
	settings.edge.slack = options.slack;
	settings.edge.flags = options.common.checkFlags();
	settings.contact_resolution = options.first_contact ? contact_resolution : 0;
	return settings;
}

/// @return false: a certificate is wanted, and there is none
bool writeCertificate( const WorldOptions& options, Cell& cell, const ScheduleSettings& settings,
    CertificateFile& certificate, std::vector<OutputFile*>& files )
{
	if ( options.certificate.empty() )
	{
		return true;
	}
	double lag = 0;
	std::vector<std::string> sources{ options.common.cell };
	for ( const io::WorldPart& part : cell.world().parts )
	{
		lag = std::max( lag, part.lag );
		if ( !part.motion_file.empty() )
		{
			sources.push_back( part.motion_file );
		}
	}
	const io::Problem& problem = cell.bench().problem();
	const certify::Schedule schedule =
	    certify::scheduleOf( problem, cell.schedule().clock( settings.to + lag ), settings.from, settings.to );
	certify::Settings claim = claimOf( settings.edge.min_d, settings.edge.flags, sources );
	claim.tolerance = schedule.tolerance;
	claim.tracks = schedule.tracks;
	claim.begin = schedule.begin;
	return certificate.write( problem, cell.input(), schedule.pieces, claim, options.common.cell, files );
}

int runWorldAudit( const WorldOptions& options )
{
	Notices notices( options.common.verbose );
	OutputFile json_file( "--json", options.json );
	CertificateFile certificate( options.certificate );
	Cell cell( options, notices );
	Schedule& schedule = cell.schedule();
	ScheduleSettings settings = settingsOf( options );
	settings.from = options.from;
	settings.to = options.to_given ? options.to : std::max( schedule.duration(), options.from );
	if ( !( settings.from <= settings.to ) )
	{
		throw io::Error( "command line", "--to",
		    fmt::format( "{:g} s is before the start, {:g} s", settings.to, settings.from ),
		    "give a later time, or --from" );
	}
	const ScheduleAudit audit = auditSchedule( schedule, settings );
	std::vector<OutputFile*> files;
	if ( !options.json.empty() )
	{
		Json json;
		json["world"] = options.common.cell;
		json["audit"] = toJson( audit );
		json["notices"] = notices.all();
		json_file.text = jsonText( json );
		files.push_back( &json_file );
	}
	const bool is_certified = !audit.valid() || writeCertificate( options, cell, settings, certificate, files );
	commitTogether( files );
	printOut( describe( audit ) + certificate.told() );
	return audit.valid() && is_certified ? exit_yes : exit_no;
}

// ---- edge ------------------------------------------------------------------------------------------------------------

/// Columns of a table of timed motions.
struct EdgeColumns
{
	std::size_t start = 0, end = 0;
	std::map<std::uint32_t, std::pair<std::size_t, std::size_t>> ends; ///< of group variables: columns from: and to:
};

EdgeColumns edgeColumns( const CsvTable& table, const std::vector<std::string>& names )
{
	const auto columnOf = [&]( const std::string& title )
	{
		const auto found = std::find( table.header.begin(), table.header.end(), title );
		if ( found == table.header.end() )
		{
			throw io::Error( table.file, "header", fmt::format( "there is no column '{}'", title ),
			    "give start, end, and from:JOINT and to:JOINT of each joint that moves" );
		}
		return static_cast<std::size_t>( found - table.header.begin() );
	};
	EdgeColumns out;
	out.start = columnOf( "start" );
	out.end = columnOf( "end" );
	for ( const std::string& title : table.header )
	{
		if ( title == "start" || title == "end" )
		{
			continue;
		}
		const std::size_t colon = title.find( ':' );
		const std::string name = colon != std::string::npos ? title.substr( colon + 1 ) : "";
		const auto variable = std::find( names.begin(), names.end(), name );
		if ( ( title.rfind( "from:", 0 ) != 0 && title.rfind( "to:", 0 ) != 0 ) || variable == names.end() )
		{
			throw io::Error( table.file, fmt::format( "column '{}'", title ), "names no joint of the world",
			    "write from:JOINT and to:JOINT; " + useOneOf( name, names ) );
		}
		out.ends[static_cast<std::uint32_t>( variable - names.begin() )] = {
		    columnOf( "from:" + name ), columnOf( "to:" + name ) };
	}
	if ( out.ends.empty() )
	{
		throw io::Error( table.file, "header", "names no joint", "give from:JOINT and to:JOINT columns" );
	}
	return out;
}

/// Replaces the motions of the parts whose joints have columns by those of a row. Their other joints stand where the cell's motions have them.
void drive( Cell& cell, const CsvTable& table, std::size_t row, const EdgeColumns& columns, double start, double end,
    Schedule& driven )
{
	const std::vector<double> standing = cell.schedule().state( start );
	for ( const io::WorldPart& part : cell.world().parts )
	{
		std::vector<double> from, to;
		bool moves = false;
		for ( std::size_t i = 0; i < part.variables.size(); ++i )
		{
			const std::uint32_t v = driven.variables( part.name )[i];
			const auto ends = columns.ends.find( v );
			moves = moves || ends != columns.ends.end();
			from.push_back( ends != columns.ends.end() ? table.value( row, ends->second.first ) : standing[v] );
			to.push_back( ends != columns.ends.end() ? table.value( row, ends->second.second ) : standing[v] );
		}
		if ( moves )
		{
			driven.add( part.name, { start, end }, { from, to } );
		}
	}
}

int runWorldEdge( const WorldOptions& options )
{
	Notices notices( options.common.verbose );
	const CsvTable table = readCsv( options.edges );
	readsFile( "--edges", options.edges );
	OutputFile out( "--out", options.out );
	Cell cell( options, notices );
	const io::Problem& problem = cell.bench().problem();
	const EdgeColumns columns = edgeColumns( table, problem.variable_names );
	ScheduleSettings settings = settingsOf( options );
	settings.edge.want_proved_until = true;
	out.text = "index,verdict,time,proved_until,clearance,pair,by_unknown_motion,states\n";
	Schedule driven( cell.world(), problem ); // the motions of the named parts are those of a row, the same parts in each
	std::size_t free = 0;
	Progress progress( "proving motions", table.rows.size() );
	for ( std::size_t row = 0; row < table.rows.size(); ++row )
	{
		settings.from = table.value( row, columns.start );
		settings.to = table.value( row, columns.end );
		if ( !( settings.from < settings.to ) )
		{
			throw io::Error( table.file, fmt::format( "line {}", table.rows[row].line ),
			    fmt::format( "begins at {:g} s and ends at {:g} s", settings.from, settings.to ),
			    "give an end after the start" );
		}
		drive( cell, table, row, columns, settings.from, settings.to, driven );
		const ScheduleAudit audit = auditSchedule( driven, settings );
		fmt::format_to( std::back_inserter( out.text ), "{},{},{},{},{},{},{},{}\n", row, lw_verdict_name( audit.verdict ),
		    audit.time, audit.proved_until, audit.valid() ? audit.lower_bound : audit.pair.least(),
		    audit.pair.first.empty() ? "" : csvCell( audit.pair.first + ":" + audit.pair.second ), audit.by_spread ? 1 : 0,
		    audit.states );
		free += audit.valid() ? 1 : 0;
		progress.step( row + 1 );
	}
	out.commit();
	tell( "leeway: {}: {} FREE\n", counted( table.rows.size(), "motion" ), free );
	return free == table.rows.size() ? exit_yes : exit_no;
}

// ---- view ------------------------------------------------------------------------------------------------------------

/// Seconds: the page draws motions as straight between states this far apart, and at the ends of pieces.
constexpr double picture_step = 0.02;

/// The schedule as a page plays it.
std::vector<Segment> drawnSegments( Schedule& schedule, double from, double to )
{
	std::vector<Segment> out;
	const auto steps = static_cast<std::size_t>( std::ceil( std::max( 1.0, ( to - from ) / picture_step ) ) );
	std::vector<double> last = schedule.state( from );
	for ( std::size_t i = 1; i <= steps; ++i )
	{
		const auto at = [&]( std::size_t k )
		{ return from + ( to - from ) * static_cast<double>( k ) / static_cast<double>( steps ); };
		const std::vector<double> next = schedule.state( at( i ) );
		Segment segment{ at( i - 1 ), at( i ) - at( i - 1 ), 1, last };
		segment.points.insert( segment.points.end(), next.begin(), next.end() );
		out.push_back( segment );
		last = next;
	}
	return out;
}

int runWorldView( const WorldOptions& options )
{
	Notices notices( options.common.verbose );
	ViewFile view( options.out );
	Cell cell( options, notices );
	(void)prepare( cell.bench().checker() );
	const io::Problem& problem = cell.bench().problem();
	Schedule& schedule = cell.schedule();
	const double from = options.from;
	const double to = options.to_given ? options.to : std::max( schedule.duration(), from + picture_step );
	ScheduleSettings settings = settingsOf( options );
	settings.from = from;
	settings.to = to;
	settings.contact_resolution = contact_resolution;
	const ScheduleAudit audit = auditSchedule( schedule, settings );
	Progress progress( "measuring the motions" );
	const lw_check_flags flags = options.common.checkFlags();
	const Measuring how = { problem, flags, options.common.min_d, options.common.cell, shownBy( progress ) };
	PageInput page = pageOf( cell.input(), problem, motionOfTrajectory( how, drawnSegments( schedule, from, to ) ), flags );
	page.min_d = options.common.min_d;
	page.source = options.common.cell;
	page.notes = notices.all();
	page.notes.push_back(
	    fmt::format( "Motions are drawn straight between states {:g} s apart. The proof is about the motions themselves:",
	        picture_step ) );
	page.notes.push_back( describe( audit ) );
	std::vector<OutputFile*> files;
	view.write( std::move( page ), files );
	commitTogether( files );
	printOut( describe( audit ) );
	return exit_yes;
}

} // namespace

int runWorld( const WorldOptions& options )
{
	return options.question == "check"  ? runWorldCheck( options )
	       : options.question == "edge" ? runWorldEdge( options )
	       : options.question == "plan" ? runWorldPlan( options )
	       : options.question == "view" ? runWorldView( options )
	                                    : runWorldAudit( options );
}

} // namespace leeway::cli
