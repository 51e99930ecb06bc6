// SPDX-License-Identifier: BSD-3-Clause
// Motions on one clock: proofs against states at steps of 1 cm, by leeway and by FCL; things that move against things that rest; and a
// hall of vehicles with arms: one beside the others, and all of them.
//
// Worlds are generated as world files, as users write them. Motions are straight, all at the same time, FREE by the
// proof: the only ones for which steps cannot stop early. A hash of all verdicts makes two versions of the engine comparable.
#include "peers/fcl_peer.hpp"
#include "programs/commands.hpp"
#include "support/configurations.hpp"
#include "support/provenance.hpp"
#include "support/race.hpp"
#include "support/temporary_folder.hpp"

#include "leeway/clock.h"
#include "leeway/io/world_model.hpp"
#include "leeway/prepare.hpp"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

namespace
{

namespace io = leeway::io;

constexpr double STEP = 0.01; ///< metres: no point of a robot moves farther between two sampled states

struct Settings
{
	std::string data = LEEWAY_DATA_DIR;
	std::string robot; ///< URDF[,SRDF]; empty: Panda of the data
	std::size_t motions = 200;
	double radians = 0.5, budget = 5;
	int repetitions = 5;
	std::uint64_t seed = 20260101;
	bool quick = false, no_fcl = false;
};

/// Motions of several parts at the same time, each straight: one row of values for each part and end.
struct ClockMotion
{
	std::vector<std::vector<double>> points; ///< [track] its two control points, one after the other
};

/// A world, its checker, and tracks of those parts that move.
class Hall
{
public:
	/// @param focus the part whose clearances count; empty: all
	Hall( const std::string& file, const Settings& settings, const std::string& focus = {} )
	    : m_world( io::loadWorld( file ) ), m_problem( build( settings, focus ) )
	{
		leeway::require( leeway::prepare( m_problem.checker.get(), 1 ), "meshes" );
		m_query = leeway::makeQuery( m_problem.checker.get() );
		for ( const io::WorldPart& part : m_world.parts )
		{
			std::vector<std::uint32_t> variables;
			for ( const std::string& name : part.variables )
			{
				const auto& names = m_problem.variable_names;
				const auto found = std::find( names.begin(), names.end(), name );
				variables.push_back( static_cast<std::uint32_t>( found - names.begin() ) );
			}
			m_variables.push_back( variables );
		}
		m_rest = io::startState( m_problem );
	}

	const io::WorldModel& world() const { return m_world; }
	const io::Problem& problem() const { return m_problem; }
	const std::vector<std::vector<std::uint32_t>>& variables() const { return m_variables; }
	const std::vector<double>& rest() const { return m_rest; }
	std::size_t size() const { return m_problem.variables.size(); }

	/// The state at one end of a motion.
	std::vector<double> end( const ClockMotion& motion, bool last ) const
	{
		std::vector<double> q = m_rest;
		for ( std::size_t t = 0; t < motion.points.size(); ++t )
		{
			const std::size_t n = m_variables[t].size();
			for ( std::size_t i = 0; i < n; ++i )
			{
				q[m_variables[t][i]] = motion.points[t][( last ? n : 0 ) + i];
			}
		}
		return q;
	}

	lw_timed_result prove( const ClockMotion& motion )
	{
		m_pieces.resize( motion.points.size() );
		m_tracks.assign( motion.points.size(), lw_track{} );
		for ( std::size_t t = 0; t < motion.points.size(); ++t )
		{
			m_pieces[t] = { 0, 1, 1, motion.points[t].data() };
			m_tracks[t].variables = m_variables[t].data();
			m_tracks[t].variable_count = static_cast<std::uint32_t>( m_variables[t].size() );
			m_tracks[t].pieces = &m_pieces[t];
			m_tracks[t].piece_count = 1;
		}
		const lw_clock clock = { m_tracks.data(), static_cast<std::uint32_t>( m_tracks.size() ), m_rest.data() };
		const lw_timed_def def = lw_timed_def_default();
		lw_timed_result result;
		leeway::require( lw_checker_timed( m_problem.checker.get(), m_query.get(), &clock, 0, 1, &def, &result ),
		    "a motion on the clock" );
		return result;
	}

	/// The same motion by states at steps. @param states how many were looked at
	bool sample( const ClockMotion& motion, std::uint32_t& states )
	{
		lw_edge_def def = lw_edge_def_default();
		def.method = LW_EDGE_STEPS;
		def.max_d = STEP;
		lw_edge_result result;
		const std::vector<double> a = end( motion, false ), b = end( motion, true );
		leeway::require( lw_checker_edge( m_problem.checker.get(), m_query.get(), a.data(), b.data(), &def, &result ),
		    "a sampled motion" );
		states = result.queries;
		return result.verdict == LW_VERDICT_FREE;
	}

	bool isFree( const std::vector<double>& q )
	{
		bool free = false;
		leeway::require(
		    lw_checker_is_free( m_problem.checker.get(), m_query.get(), q.data(), LW_CHECK_BOTH, 0, &free, nullptr ),
		    "a state" );
		return free;
	}

private:
	io::Problem build( const Settings& settings, const std::string& focus ) const
	{
		io::ProblemOptions options = io::worldProblem( m_world );
		options.find_reach = io::ReachOptions();
		options.find_reach->def.seconds = settings.budget;
		const auto owner = []( const std::string& link ) { return link.substr( 0, link.find( '/' ) ); };
		for ( std::size_t i = 0; !focus.empty() && i < m_world.robot.links.size(); ++i )
		{
			for ( std::size_t k = 0; k < i; ++k )
			{
				const std::string &a = m_world.robot.links[i].name, &b = m_world.robot.links[k].name;
				if ( owner( a ) != focus && owner( b ) != focus )
				{
					options.allowed.emplace_back( a, b );
				}
			}
		}
		return io::buildProblem( m_world.robot, options );
	}

	io::WorldModel m_world;
	io::Problem m_problem;
	leeway::Query m_query;
	std::vector<std::vector<std::uint32_t>> m_variables;
	std::vector<double> m_rest;
	std::vector<lw_timed_piece> m_pieces;
	std::vector<lw_track> m_tracks;
};

class ClockBench
{
public:
	ClockBench( const Settings& settings, Result& result )
	    : m_settings( settings ), m_result( result ), m_random( settings.seed )
	{
	}

	void run()
	{
		std::printf( "microseconds a motion, mean (median): proved; states at %g m by leeway and by FCL\n", STEP );
		for ( const int arms : { 2, 3, 4 } )
		{
			compareArms( arms );
		}
		std::printf( "\nan arm beside boxes: microseconds where they rest and where they move, and ratios\n" );
		for ( const int boxes : { 0, 1, 2, 4, 8 } )
		{
			compareBoxes( boxes );
		}
		std::printf( "\na hall of vehicles with arms, all of which move: microseconds a motion\n" );
		for ( const int vehicles : m_settings.quick ? std::vector<int>{ 2, 5 } : std::vector<int>{ 2, 5, 10, 20, 50 } )
		{
			measureHall( vehicles );
		}
	}

	bool agreed() const { return m_agreed; }

private:
	std::string write( const std::string& name, const std::string& text ) const
	{
		const std::string file = ( m_folder.path() / name ).string();
		std::ofstream( file ) << text;
		return file;
	}

	/// "robot: F, srdf: S" of the measured arm.
	std::string robotFields() const
	{
		std::string urdf = m_settings.robot, srdf;
		if ( urdf.empty() )
		{
			requireData( m_settings.data, "mbm" );
			urdf = m_settings.data + "/mbm/panda/panda.urdf";
			srdf = m_settings.data + "/mbm/panda/panda.srdf";
		}
		else if ( urdf.find( ',' ) != std::string::npos )
		{
			srdf = urdf.substr( urdf.find( ',' ) + 1 );
			urdf = urdf.substr( 0, urdf.find( ',' ) );
		}
		const auto absolute = []( const std::string& file ) { return std::filesystem::absolute( file ).string(); };
		return "robot: '" + absolute( urdf ) + ( srdf.empty() ? "'" : "', srdf: '" + absolute( srdf ) + "'" );
	}

	/// Arms in a circle, each turned to the middle.
	std::string arms( int count, double radius ) const
	{
		std::string text = "leeway_world: 1\nrobots:\n";
		for ( int i = 0; i < count; ++i )
		{
			const double angle = 2 * M_PI * i / count, half = 0.5 * ( angle + M_PI );
			char line[200];
			std::snprintf( line, sizeof line, "base: {position: [%.6f, %.6f, 0], orientation: [0, 0, %.9f, %.9f]}",
			    radius * std::cos( angle ), radius * std::sin( angle ), std::sin( half ), std::cos( half ) );
			text += "  - {name: r" + std::to_string( i ) + ", " + robotFields() + ", " + line + "}\n";
		}
		return text;
	}

	/// A motion of all robots, of `radians` each; objects move as their own pieces say.
	ClockMotion randomMotion( const Hall& hall )
	{
		ClockMotion motion;
		for ( std::size_t t = 0; t < hall.world().parts.size(); ++t )
		{
			const io::WorldPart& part = hall.world().parts[t];
			const std::size_t n = part.variables.size();
			std::vector<double> points( 2 * n );
			double length = 0;
			for ( std::size_t i = 0; i < n; ++i )
			{
				const lw_variable_info info =
				    lw_robot_variable( hall.problem().robot.get(), hall.problem().variables[hall.variables()[t][i]] );
				const lw_joint_type type = lw_robot_joint_type( hall.problem().robot.get(), info.joint );
				if ( type == LW_JOINT_FLOATING || type == LW_JOINT_PLANAR ) // of a base that stands
				{
					points[i] = part.state[i];
					continue;
				}
				const double low = std::max( info.lower, -M_PI ), high = std::min( info.upper, M_PI );
				points[i] = low + ( high - low ) * uniform( m_random );
				points[n + i] = 2 * uniform( m_random ) - 1;
				length += points[n + i] * points[n + i];
			}
			for ( std::size_t i = 0; i < n; ++i )
			{
				points[n + i] = points[i] + m_settings.radians * points[n + i] / std::sqrt( length );
			}
			if ( part.kind == io::WorldPart::Kind::object )
			{
				points = part.pieces.front().points; // straight from 0 to 1
			}
			motion.points.push_back( points );
		}
		return motion;
	}

	/// FREE motions of a hall. @param hash of all verdicts on the way
	std::vector<ClockMotion> freeMotions( Hall& hall, std::size_t count, Hash& hash )
	{
		std::vector<ClockMotion> motions;
		for ( std::size_t tries = 0; motions.size() < count && tries < 500 * count; ++tries )
		{
			const ClockMotion motion = randomMotion( hall );
			if ( hall.isFree( hall.end( motion, false ) ) )
			{
				const lw_timed_result r = hall.prove( motion );
				hash.add( static_cast<long long>( r.verdict ) );
				if ( r.verdict == LW_VERDICT_FREE )
				{
					motions.push_back( motion );
				}
			}
		}
		return motions;
	}

	static ConfigurationSet numbers( std::size_t count )
	{
		ConfigurationSet set{ "free", "numbers of motions", {} };
		for ( std::size_t i = 0; i < count; ++i )
		{
			set.states.push_back( { static_cast<double>( i ) } );
		}
		return set;
	}

	static std::size_t number( const double* q ) { return static_cast<std::size_t>( q[0] ); }

	void compareArms( int count )
	{
		Hall hall( write( "arms" + std::to_string( count ) + ".yaml", arms( count, 0.55 ) ), m_settings );
		Hash hash;
		const std::vector<ClockMotion> motions = freeMotions( hall, m_settings.motions, hash );
		std::uint32_t states = 0;
		std::vector<std::uint32_t> counts;
		for ( const ClockMotion& motion : motions )
		{
			const bool free = hall.sample( motion, states );
			m_agreed = m_agreed && free; // proved, so no state of it collides
			counts.push_back( states );
		}
		std::unique_ptr<FclPeer> fcl;
		if ( !m_settings.no_fcl )
		{
			fcl = std::make_unique<FclPeer>( hall.problem().checker.get(), nullptr, hall.problem().allowed );
		}
		std::vector<Contender> contenders = {
		    { "proved",
		        [&]( const double* q ) {
			        return Answer{ 0, double( hall.prove( motions[number( q )] ).verdict ) };
		        } },
		    { "steps", [&]( const double* q ) {
			     return Answer{ 0, double( hall.sample( motions[number( q )], states ) ) };
		     } } };
		if ( fcl )
		{
			contenders.push_back( { "fcl", [&]( const double* q )
			    {
				    const ClockMotion& motion = motions[number( q )];
				    return Answer{ 0, double( fcl->isFreeAtStates(
				                          hall.end( motion, false ), hall.end( motion, true ), counts[number( q )] ) ) };
			    } } );
		}
		const std::vector<Run> runs = race( contenders, numbers( motions.size() ), m_settings.repetitions );
		Json row = { { "set", "arms" }, { "robots", count }, { "variables", hall.size() }, { "motions", motions.size() } };
		std::vector<Summary> s;
		for ( std::size_t c = 0; c < runs.size(); ++c )
		{
			s.push_back( summarise( runs[c] ) );
			row[contenders[c].name] = toJson( s.back() );
		}
		s.resize( 3 );
		row["verdicts_hash"] = hash.text();
		std::printf(
		    "%d arms, %zu variables, %zu motions: proved %.1f (%.1f), steps %.1f (%.1f), FCL %.1f (%.1f); ratios of "
		    "medians %.2f, %.2f\n",
		    count, hall.size(), motions.size(), s[0].mean, s[0].median, s[1].mean, s[1].median, s[2].mean, s[2].median,
		    s[1].median / s[0].median, s[2].median / s[0].median );
		std::fflush( stdout );
		m_result.add( std::move( row ) );
	}

	/// A box near the arm. @param moves it shifts by up to 0.2 m
	static std::string box( int i, const double* where, bool moves )
	{
		char text[400];
		std::snprintf( text, sizeof text,
		    "  - {name: box%d, shapes: [{type: box, dimensions: [0.1, 0.1, 0.1]}], pose: {position: "
		    "[%.6f, %.6f, %.6f]}",
		    i, where[0], where[1], where[2] );
		std::string line = text;
		if ( moves )
		{
			std::snprintf( text, sizeof text, ", motion: [{start: 0, end: 1, position: [%.6f, %.6f, %.6f]}]",
			    where[0] + where[3], where[1] + where[4], where[2] + where[5] );
			line += text;
		}
		return line + "}\n";
	}

	void compareBoxes( int count )
	{
		std::string still = arms( 1, 0 ), moving = still;
		still += count > 0 ? "objects:\n" : "";
		moving += count > 0 ? "objects:\n" : "";
		for ( int i = 0; i < count; ++i )
		{
			const double angle = 2 * M_PI * uniform( m_random ), far = 0.5 + 0.4 * uniform( m_random );
			double where[6] = { far * std::cos( angle ), far * std::sin( angle ), 0.1 + 0.8 * uniform( m_random ) };
			for ( int k = 3; k < 6; ++k )
			{
				where[k] = 0.4 * uniform( m_random ) - 0.2;
			}
			still += box( i, where, false );
			moving += box( i, where, true );
		}
		Hall rest( write( "rest.yaml", still ), m_settings ), moves( write( "moving.yaml", moving ), m_settings );
		Hash hash;
		std::vector<ClockMotion> motions = freeMotions( moves, m_settings.motions, hash ), resting;
		for ( std::size_t i = 0; i < motions.size(); )
		{
			ClockMotion arm = motions[i];
			arm.points.resize( 1 );
			if ( rest.prove( arm ).verdict == LW_VERDICT_FREE ) // there, too
			{
				resting.push_back( arm );
				++i;
			}
			else
			{
				motions.erase( motions.begin() + static_cast<std::ptrdiff_t>( i ) );
			}
		}
		const std::vector<Contender> contenders = {
		    { "rest",
		        [&]( const double* q ) {
			        return Answer{ 0, double( rest.prove( resting[number( q )] ).verdict ) };
		        } },
		    { "moving", [&]( const double* q ) {
			     return Answer{ 0, double( moves.prove( motions[number( q )] ).verdict ) };
		     } } };
		const std::vector<Run> runs = race( contenders, numbers( motions.size() ), m_settings.repetitions );
		const Summary a = summarise( runs[0] ), b = summarise( runs[1] );
		m_result.add( { { "set", "boxes" }, { "boxes", count }, { "motions", motions.size() }, { "rest", toJson( a ) },
		    { "moving", toJson( b ) }, { "verdicts_hash", hash.text() } } );
		std::printf(
		    "%d boxes, %zu motions: rest %.1f (%.1f), moving %.1f (%.1f); ratio %.2f of means, %.2f of medians; 1 + k / 4 "
		    "= %.2f\n",
		    count, motions.size(), a.mean, a.median, b.mean, b.median, b.mean / a.mean, b.median / a.median,
		    1 + 0.25 * count );
		std::fflush( stdout );
	}

	/// A vehicle that drives and turns, with an arm of three joints.
	static std::string vehicle()
	{
		std::string text = "<robot name='vehicle'><link name='rail'/>";
		const auto link = [&text]( const char* name, double x, double y, double z, double up )
		{
			char line[300];
			std::snprintf( line, sizeof line,
			    "<link name='%s'><collision><origin xyz='0 0 %g'/><geometry><box size='%g %g %g'/></geometry></collision></link>",
			    name, up, x, y, z );
			text += line;
		};
		const auto joint = [&text]( const char* name, const char* type, const char* parent, const char* child,
		                       const char* axis, double up, double limit )
		{
			char line[400];
			std::snprintf( line, sizeof line,
			    "<joint name='%s' type='%s'><parent link='%s'/><child link='%s'/><origin xyz='0 0 %g'/><axis xyz='%s'/><limit "
			    "lower='%g' upper='%g' velocity='1' effort='1'/></joint>",
			    name, type, parent, child, up, axis, -limit, limit );
			text += line;
		};
		text += "<link name='slide'/>";
		link( "body", 0.7, 0.5, 0.3, 0.2 );
		link( "shoulder", 0.12, 0.12, 0.4, 0.2 );
		link( "upper", 0.1, 0.1, 0.4, 0.2 );
		link( "lower", 0.08, 0.08, 0.4, 0.2 );
		joint( "x", "prismatic", "rail", "slide", "1 0 0", 0, 3 );
		joint( "y", "prismatic", "slide", "turntable", "0 1 0", 0, 3 );
		text += "<link name='turntable'/>";
		joint( "turn", "revolute", "turntable", "body", "0 0 1", 0, 3.1 );
		joint( "j1", "revolute", "body", "shoulder", "0 0 1", 0.35, 3.1 );
		joint( "j2", "revolute", "shoulder", "upper", "0 1 0", 0.4, 2 );
		joint( "j3", "revolute", "upper", "lower", "0 1 0", 0.4, 2.5 );
		return text + "</robot>";
	}

	void measureHall( int count )
	{
		write( "vehicle.urdf", vehicle() );
		std::string text = "leeway_world: 1\nrobots:\n";
		const int side = static_cast<int>( std::ceil( std::sqrt( count ) ) );
		for ( int i = 0; i < count; ++i )
		{
			char line[200];
			std::snprintf( line, sizeof line, "  - {name: r%d, robot: vehicle.urdf, base: {position: [%d, %d, 0]}}\n", i,
			    3 * ( i % side ), 3 * ( i / side ) );
			text += line;
		}
		const std::string file = write( "hall" + std::to_string( count ) + ".yaml", text );
		Settings settings = m_settings;
		settings.budget = std::min( settings.budget, 2.0 );
		Hall all( file, settings ), one( file, settings, "r0" );
		std::vector<ClockMotion> motions;
		for ( std::size_t tries = 0; motions.size() < m_settings.motions / 4 && tries < 5000; ++tries )
		{
			ClockMotion motion = randomMotion( all );
			for ( std::size_t t = 0; t < motion.points.size(); ++t ) // near their own places, so that all find room
			{
				for ( std::size_t i = 0; i < 2; ++i )
				{
					const double from = 0.2 * motion.points[t][i], by = motion.points[t][6 + i] - motion.points[t][i];
					motion.points[t][i] = from;
					motion.points[t][6 + i] = from + by;
				}
			}
			if ( one.prove( motion ).verdict == LW_VERDICT_FREE )
			{
				motions.push_back( motion );
			}
		}
		const std::vector<Contender> contenders = {
		    { "one",
		        [&]( const double* q ) {
			        return Answer{ 0, double( one.prove( motions[number( q )] ).verdict ) };
		        } },
		    { "all", [&]( const double* q ) {
			     return Answer{ 0, double( all.prove( motions[number( q )] ).verdict ) };
		     } } };
		const std::vector<Run> runs = race( contenders, numbers( motions.size() ), std::min( m_settings.repetitions, 3 ) );
		const Summary a = summarise( runs[0] ), b = summarise( runs[1] );
		m_result.add( { { "set", "hall" }, { "robots", count }, { "variables", all.size() }, { "motions", motions.size() },
		    { "one", toJson( a ) }, { "all", toJson( b ) } } );
		std::printf( "%d vehicles, %zu variables, %zu motions: one beside the others %.1f (%.1f), all %.1f (%.1f)\n", count,
		    all.size(), motions.size(), a.mean, a.median, b.mean, b.median );
		std::fflush( stdout );
	}

	const Settings& m_settings;
	Result& m_result;
	std::mt19937_64 m_random;
	TemporaryFolder m_folder;
	bool m_agreed = true;
};

int run( const Settings& settings, Result& result )
{
	ClockBench bench( settings, result );
	bench.run();
	std::printf( "%s\n", bench.agreed() ? "no proved motion has a sampled collision" : "A PROVED MOTION COLLIDES" );
	return bench.agreed() ? 0 : 1;
}

} // namespace

void addClock( Bench& bench )
{
	const auto s = std::make_shared<Settings>();
	Command& command = bench.command( "clock", "motions of several robots on one clock: proofs against sampled states" );
	command.option( "--data", s->data, "folder with mbm, for Panda" );
	command.option( "--robot", s->robot, "URDF or URDF,SRDF of an arm instead of Panda" );
	command.option( "--motions", s->motions, "FREE motions of each row", { 4, 100000 } );
	command.option( "--radians", s->radians, "length of each robot's motion", POSITIVE );
	command.option( "--budget", s->budget, "seconds of proofs for pair tables", { 0 } );
	command.option( "--repetitions", s->repetitions, "passes over the motions", { 1, 1000 } );
	command.option( "--seed", s->seed, "of the random motions" );
	command.flag( "--no-fcl", s->no_fcl, "leave FCL out" );
	command.flag( "--quick", s->quick, "20 motions, one pass, small halls" );
	command.work(
	    [s]( Result& result )
	    {
		    if ( s->quick )
		    {
			    s->motions = std::min<std::size_t>( s->motions, 20 );
			    s->budget = std::min( s->budget, 0.5 );
			    s->repetitions = 1;
		    }
		    return run( *s, result );
	    } );
}
