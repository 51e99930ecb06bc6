// SPDX-License-Identifier: BSD-3-Clause
// All motions of a world on one clock: see schedule.hpp.
#include "leeway/motions/schedule.hpp"

#include "leeway/handles.hpp"
#include "leeway/motions/trajectory.hpp"
#include "motions/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>

namespace leeway::motions
{
namespace
{

/// A part that rests at some values.
io::TimedPiece restAt( const std::vector<double>& values )
{
	return { 0, 1, 0, values };
}

/// The last values of a motion.
std::vector<double> lastOf( const io::TimedPiece& piece, std::size_t count )
{
	return { piece.points.end() - static_cast<std::ptrdiff_t>( count ), piece.points.end() };
}

/// Variables of the part that the columns of a trajectory move.
std::vector<std::size_t> ownVariables( const io::WorldPart& part, const TrajectoryFile& file )
{
	std::vector<std::size_t> own;
	for ( const std::string& name : file.joint_names )
	{
		auto found = std::find( part.variables.begin(), part.variables.end(), part.name + "/" + name );
		found = found != part.variables.end() ? found : std::find( part.variables.begin(), part.variables.end(), name );
		if ( found == part.variables.end() )
		{
			std::vector<std::string> known;
			for ( const std::string& variable : part.variables )
			{
				known.push_back( variable.substr( part.name.size() + 1 ) );
			}
			throw io::Error( file.file, file.at( "joint_names" ),
			    fmt::format( "robot {} has no joint '{}'", part.name, name ), useOneOf( name, known ) );
		}
		own.push_back( static_cast<std::size_t>( found - part.variables.begin() ) );
	}
	return own;
}

/// A segment of some variables as a piece of all of them, in which the others rest.
io::TimedPiece pieceOf(
    const Segment& segment, const std::vector<std::size_t>& own, double shift, const std::vector<double>& resting )
{
	io::TimedPiece piece{ segment.begin + shift, segment.begin + segment.seconds + shift, segment.degree, {} };
	for ( unsigned k = 0; k <= segment.degree; ++k )
	{
		std::vector<double> row = resting;
		for ( std::size_t i = 0; i < own.size(); ++i )
		{
			row[own[i]] = segment.points[k * own.size() + i];
		}
		piece.points.insert( piece.points.end(), row.begin(), row.end() );
	}
	return piece;
}

/// Does the part move, or may it?
bool isActive( const io::WorldPart& part )
{
	const auto above_zero = []( double value ) { return value > 0; };
	return !part.pieces.empty() || !part.motion_file.empty() || part.spread_speed > 0 ||
	       std::any_of( part.tolerance.begin(), part.tolerance.end(), above_zero );
}

/// Where joints stand that a trajectory does not move, where the file and the world disagree.
void noteStart( const io::WorldPart& part, const TrajectoryFile& file, std::vector<io::Notice>& notices )
{
	for ( const auto& [name, value] : file.start_state )
	{
		const auto found = std::find( part.variables.begin(), part.variables.end(), part.name + "/" + name );
		const bool moved = std::find( file.joint_names.begin(), file.joint_names.end(), name ) != file.joint_names.end();
		if ( found == part.variables.end() || moved )
		{
			continue;
		}
		const double stands = part.state[static_cast<std::size_t>( found - part.variables.begin() )];
		if ( std::fabs( stands - value ) > limit_tolerance )
		{
			notices.push_back( { file.file, file.at( "start state" ),
			    fmt::format( "joint {} is at {} there, and robot {} has it at {}", name, value, part.name, stands ) } );
		}
	}
}

/// Tolerances of a goal, for joints of which the world says none.
void takeTolerances( const TrajectoryFile& file, io::WorldPart& part )
{
	for ( const auto& [name, value] : file.path_tolerance )
	{
		const auto found = std::find( part.variables.begin(), part.variables.end(), part.name + "/" + name );
		const auto i = static_cast<std::size_t>( found - part.variables.begin() );
		if ( found == part.variables.end() || part.tolerance[i] > 0 )
		{
			continue;
		}
		if ( !( value > 0 ) )
		{
			throw io::Error( file.file, "path_tolerance of " + name, "is no number that the controller keeps to",
			    fmt::format( "give the tolerance of robot {} in the world file", part.name ) );
		}
		part.tolerance[i] = value;
	}
}

} // namespace

Schedule::Track Schedule::makeTrack( const io::WorldPart& part ) const
{
	Track track;
	track.part = part;
	track.source = m_file;
	const std::vector<std::string>& names = m_problem.variable_names;
	for ( const std::string& variable : part.variables )
	{
		const auto found = std::find( names.begin(), names.end(), variable );
		if ( found == names.end() )
		{
			throw io::Error( m_file, part.element,
			    fmt::format( "variable {} is not in group '{}', and the part moves", variable, m_problem.group ),
			    "use a group with all that moves, or all joints" );
		}
		track.variables.push_back( static_cast<std::uint32_t>( found - names.begin() ) );
	}
	return track;
}

void Schedule::readMotion( Track& track )
{
	io::WorldPart& part = track.part;
	track.source = part.motion_file;
	std::vector<double> standing = part.state;
	double begin = part.motion_start;
	const std::vector<TrajectoryFile> files = readTrajectories( part.motion_file );
	for ( const TrajectoryFile& file : files )
	{
		const std::vector<std::size_t> own = ownVariables( part, file );
		std::vector<std::size_t> columns;
		for ( std::size_t i = 0; i < own.size(); ++i )
		{
			columns.push_back( i );
		}
		m_notices.insert( m_notices.end(), file.notices.begin(), file.notices.end() );
		noteStart( part, file, m_notices );
		takeTolerances( file, part );
		const std::size_t before = track.piece_names.size();
		for ( const Segment& segment : segmentsOf( file, columns, Interpolation::automatic, begin ) )
		{
			io::TimedPiece piece = pieceOf( segment, own, file.points.front().time, standing );
			piece.end = file.points.size() > 1 ? piece.end : piece.start + 1;
			piece.degree = file.points.size() > 1 ? piece.degree : 0;
			part.pieces.push_back( std::move( piece ) );
			track.piece_names.push_back( file.at( fmt::format( "points[{}]", track.piece_names.size() - before ) ) );
		}
		if ( file.points.size() == 1 && files.size() > 1 )
		{
			throw io::Error(
			    file.file, file.at( "points" ), "has one point, and is one of several trajectories", "remove it" );
		}
		standing = lastOf( part.pieces.back(), part.variables.size() );
		begin += file.points.back().time;
	}
}

Schedule::Schedule( const io::WorldModel& world, const io::Problem& problem )
    : m_file( world.file ), m_problem( problem ), m_rest( io::startState( problem ) )
{
	for ( const io::WorldPart& part : world.parts )
	{
		const bool in_group = std::all_of( part.variables.begin(), part.variables.end(),
		    [&]( const std::string& name )
		    {
			    return std::find( problem.variable_names.begin(), problem.variable_names.end(), name ) !=
			           problem.variable_names.end();
		    } );
		if ( part.variables.empty() || ( !in_group && !isActive( part ) ) )
		{
			continue;
		}
		m_tracks.push_back( makeTrack( part ) );
		if ( !part.motion_file.empty() )
		{
			readMotion( m_tracks.back() );
		}
	}
	clock( duration() );
	check();
}

std::size_t Schedule::trackOf( const std::string& part ) const
{
	const auto found =
	    std::find_if( m_tracks.begin(), m_tracks.end(), [&]( const Track& track ) { return track.part.name == part; } );
	if ( found == m_tracks.end() )
	{
		throw io::Error(
		    m_file, "motion of " + part, "the group has no such part", "use a group with all that moves, or all joints" );
	}
	return static_cast<std::size_t>( found - m_tracks.begin() );
}

const std::vector<std::uint32_t>& Schedule::variables( const std::string& part ) const
{
	return m_tracks[trackOf( part )].variables;
}

void Schedule::add(
    const std::string& part, const std::vector<double>& times, const std::vector<std::vector<double>>& points )
{
	Track& track = m_tracks[trackOf( part )];
	const std::string element = "motion of " + part;
	const std::size_t count = track.part.variables.size();
	const bool sized = std::all_of(
	    points.begin(), points.end(), [&]( const std::vector<double>& point ) { return point.size() == count; } );
	if ( times.empty() || times.size() != points.size() || !sized )
	{
		throw io::Error( m_file, element,
		    fmt::format( "has {} times and {} points of {} variables", times.size(), points.size(), count ),
		    "give a time and all variables for each point" );
	}
	Track changed = track;
	changed.source = m_file;
	changed.part.pieces.clear();
	changed.part.period = 0;
	changed.piece_names.clear();
	for ( std::size_t i = 0; i + 1 < times.size(); ++i )
	{
		io::TimedPiece piece{ times[i], times[i + 1], 1, points[i] };
		piece.points.insert( piece.points.end(), points[i + 1].begin(), points[i + 1].end() );
		changed.part.pieces.push_back( std::move( piece ) );
		changed.piece_names.push_back( fmt::format( "edge {}", i ) );
	}
	if ( times.size() == 1 )
	{
		changed.part.pieces.push_back( restAt( points[0] ) );
	}
	std::swap( track, changed );
	try
	{
		clock( std::max( m_until, duration() ) );
		check();
	}
	catch ( const io::Error& )
	{
		std::swap( track, changed );
		clock( m_until );
		throw;
	}
}

double Schedule::duration() const
{
	double end = 0;
	for ( const Track& track : m_tracks )
	{
		const bool moves = !track.part.pieces.empty() && track.part.pieces.back().degree > 0;
		end = std::max( end, moves ? track.part.pieces.back().end : 0 );
	}
	return end;
}

/// The pieces of a track until a time at least, and for the lag behind it.
void Schedule::repeat( Track& track, double until ) const
{
	const io::WorldPart& part = track.part;
	const std::size_t count = part.variables.size();
	track.pieces = part.pieces;
	if ( part.pieces.empty() )
	{
		track.pieces.push_back( restAt( part.state ) );
	}
	const double begin = track.pieces.front().start;
	const double rounds = part.period > 0 ? std::ceil( ( until + part.lag - begin ) / part.period ) : 1;
	if ( rounds * static_cast<double>( part.pieces.size() ) > static_cast<double>( most_pieces ) )
	{
		throw io::Error( m_file, part.element,
		    fmt::format( "repeats {} times until {} s: more than {} pieces", rounds, until, most_pieces ),
		    "ask about a shorter time" );
	}
	for ( double round = 1; round < rounds; ++round )
	{
		for ( io::TimedPiece piece : part.pieces )
		{
			piece.start += round * part.period;
			piece.end += round * part.period;
			for ( std::size_t i = 0; i < piece.points.size(); ++i )
			{
				piece.points[i] += round * part.advance[i % count];
			}
			piece.start = std::max( piece.start, track.pieces.back().end ); // rounding
			track.pieces.push_back( std::move( piece ) );
		}
	}
	track.rows.clear();
	for ( const io::TimedPiece& piece : track.pieces )
	{
		track.rows.push_back( { piece.start, piece.end, piece.degree, piece.points.data() } );
	}
}

const lw_clock& Schedule::clock( double until )
{
	m_until = until;
	m_rows.clear();
	for ( Track& track : m_tracks )
	{
		repeat( track, until );
		const io::WorldPart& part = track.part;
		m_rows.push_back( { track.variables.data(), static_cast<std::uint32_t>( track.variables.size() ), track.rows.data(),
		    static_cast<std::uint32_t>( track.rows.size() ), part.lag, part.tolerance.data(), part.spread_speed,
		    part.spread_start } );
	}
	m_clock = { m_rows.data(), static_cast<std::uint32_t>( m_rows.size() ), m_rest.data() };
	return m_clock;
}

lw_clock Schedule::clockWithout( const std::vector<std::string>& parts, double until )
{
	clock( until );
	m_some_rows.clear();
	for ( std::size_t t = 0; t < m_tracks.size(); ++t )
	{
		if ( std::find( parts.begin(), parts.end(), m_tracks[t].part.name ) == parts.end() )
		{
			m_some_rows.push_back( m_rows[t] );
		}
	}
	return { m_some_rows.data(), static_cast<std::uint32_t>( m_some_rows.size() ), m_rest.data() };
}

std::vector<double> velocityLimits( const io::WorldModel& world, const io::WorldPart& part, const JointLimits& limits )
{
	std::vector<double> out;
	for ( std::size_t i = 0; i < part.variables.size(); ++i )
	{
		const std::string& variable = part.variables[i];
		double velocity = 0;
		bool may_stand = !part.planned.empty() && part.planned[i] == 0;
		for ( const io::JointModel& joint : world.robot.joints )
		{
			const std::vector<std::string> names = io::variableNames( joint );
			if ( std::find( names.begin(), names.end(), variable ) != names.end() )
			{
				velocity = joint.velocity;
				may_stand = may_stand || joint.type == LW_JOINT_PLANAR || joint.type == LW_JOINT_FLOATING;
			}
		}
		for ( const std::string& name : { variable.substr( part.name.size() + 1 ), variable } )
		{
			const auto found = limits.velocity.find( name );
			velocity = found != limits.velocity.end() && !std::isnan( found->second ) ? found->second : velocity;
		}
		if ( !( velocity > 0 ) && !may_stand )
		{
			throw io::Error( world.file, part.element + ": joint " + variable,
			    "has no velocity limit, and a plan in time needs one", "give joint limits with max_velocity" );
		}
		out.push_back( velocity );
	}
	return out;
}

/// @throws io::Error naming the part and the piece
void Schedule::check() const
{
	lw_diag diag{};
	diag.index = LW_INVALID_INDEX;
	if ( lw_clock_check( m_problem.checker.get(), &m_clock, &diag ) == LW_OK )
	{
		return;
	}
	// The core says "track 1: piece 3 begins ...": the track and the piece are named here
	const std::string text = diag.message;
	std::string element, problem = text;
	std::string file = m_file;
	if ( diag.index < m_tracks.size() )
	{
		const Track& track = m_tracks[diag.index];
		file = track.source;
		element = track.part.element;
		const std::string prefix = fmt::format( "track {}: ", diag.index );
		problem = text.compare( 0, prefix.size(), prefix ) == 0 ? text.substr( prefix.size() ) : text;
		const std::string word = "piece ";
		std::size_t piece = track.piece_names.size();
		if ( problem.compare( 0, word.size(), word ) == 0 )
		{
			std::from_chars( problem.data() + word.size(), problem.data() + problem.size(), piece );
		}
		element += piece < track.piece_names.size() ? ": " + track.piece_names[piece] : "";
	}
	throw io::Error( file, element, problem, "correct the motion" );
}

std::vector<double> Schedule::state( double time )
{
	const lw_clock& at = clock( std::max( m_until, time ) );
	std::vector<double> q( m_rest.size() );
	require( lw_clock_state( m_problem.checker.get(), &at, time, q.data() ), "lw_clock_state" );
	return q;
}

ScheduleAudit auditSchedule( Schedule& schedule, const ScheduleSettings& settings )
{
	const io::Problem& problem = schedule.problem();
	lw_timed_def def = lw_timed_def_default();
	def.edge = settings.edge;
	def.contact_resolution = settings.contact_resolution;
	const Query query = makeQuery( problem.checker.get() );
	const lw_clock& clock = schedule.clock( settings.to );
	lw_timed_result result;
	const auto start = std::chrono::steady_clock::now();
	require( lw_checker_timed( problem.checker.get(), query.get(), &clock, settings.from, settings.to, &def, &result ),
	    "proof of the schedule" );
	ScheduleAudit audit;
	audit.seconds = std::chrono::duration<double>( std::chrono::steady_clock::now() - start ).count();
	audit.from = settings.from;
	audit.to = settings.to;
	audit.min_d = settings.edge.min_d;
	audit.verdict = result.verdict;
	audit.time = result.time;
	audit.proved_until = result.proved_until;
	audit.by_spread = result.by_spread;
	audit.self = result.self;
	audit.pieces = result.pieces;
	audit.states = result.queries;
	audit.names = problem.variable_names;
	audit.q = schedule.state( result.time );
	if ( result.verdict == LW_VERDICT_FREE )
	{
		audit.lower_bound = result.lower_bound;
		return audit;
	}
	lw_clearance pair = result.pair;
	if ( result.verdict == LW_VERDICT_BLOCKED && !result.by_spread ) // a proof looks no closer at a contact than it has to
	{
		const lw_state_result state = measure(
		    problem.checker.get(), query.get(), audit.q, settings.edge.flags, nullptr, "", "the state of the contact" );
		pair = audit.self ? state.self : state.environment;
	}
	audit.pair = audit.self ? nameSelf( problem.checker.get(), pair ) : nameEnvironment( problem.checker.get(), pair );
	return audit;
}

std::string describe( const ScheduleAudit& audit )
{
	std::string out = fmt::format( "schedule    {:g} to {:g} s\n", audit.from, audit.to );
	out += fmt::format(
	    "proof       {:.6f} s, {}, {} states\n", audit.seconds, counted( audit.pieces, "piece" ), audit.states );
	if ( audit.valid() )
	{
		out += fmt::format(
		    "clearance   at least {:.6g} m at all times, proved; --min-d {:g} m\n", audit.lower_bound, audit.min_d );
		return out + "valid\n";
	}
	out += fmt::format( "{}  {:.6f} s: {} - {}, {} clearance {:.6g} m{}{}\n",
	    audit.verdict == LW_VERDICT_BLOCKED ? "BLOCKED   " : "UNDECIDED ", audit.time, audit.pair.first, audit.pair.second,
	    audit.self ? "self" : "environment", audit.pair.least(), audit.pair.marginText(),
	    audit.by_spread ? ", which the unknown motion may close" : "" );
	for ( std::size_t k = 0; k < audit.q.size(); ++k )
	{
		out += fmt::format( "{}{} {:.6g}", k == 0 ? "state       " : ", ", audit.names[k], audit.q[k] );
	}
	out += audit.q.empty() ? "" : "\n";
	if ( audit.proved_until > audit.from )
	{
		out += fmt::format( "proved      {:g} to {:.6f} s\n", audit.from, audit.proved_until );
	}
	return out + "not valid\n";
}

} // namespace leeway::motions
