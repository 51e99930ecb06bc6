// SPDX-License-Identifier: BSD-3-Clause
// Cells by seed: see cells.hpp. World files are written, as users write them; ends are random free states whose tip is in a box.
#include "planning/cells.hpp"

#include "leeway/prepare.hpp"
#include "support/command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace io = leeway::io;
namespace motions = leeway::motions;

namespace
{

constexpr int MOST_TRIES = 200'000; ///< states for one end
constexpr int MOST_CELLS = 20;      ///< worlds of one seed
constexpr int MOST_MOTIONS = 200;   ///< of the other arm
constexpr double LIMIT = 2.8;       ///< radians, of the generated arm

class Random
{
public:
	explicit Random( std::uint64_t seed ) : m_engine( seed ) {}
	double in( double low, double high ) { return low + ( high - low ) * static_cast<double>( m_engine() >> 11 ) * 0x1p-53; }
	double side() { return in( 0, 1 ) < 0.5 ? -1 : 1; }

private:
	std::mt19937_64 m_engine;
};

/// Six joints, links of cylinders and boxes, 1.1 m long.
std::string generatedArm()
{
	struct Part
	{
		const char* axis;
		double up, length, radius, speed;
	};
	const Part parts[] = { { "0 0 1", 0.1, 0.3, 0.08, 2 }, { "0 1 0", 0.3, 0.4, 0.06, 2 },
	    { "0 1 0", 0.4, 0.15, 0.055, 2.5 }, { "0 0 1", 0.15, 0.2, 0.05, 3 }, { "0 1 0", 0.2, 0.1, 0.045, 3 },
	    { "0 0 1", 0.1, 0.12, 0.04, 3.5 } };
	std::string text =
	    "<robot name='six'>\n<link name='base'><collision><origin xyz='0 0 0.04'/><geometry><box size='0.25 0.25 "
	    "0.08'/></geometry></collision></link>\n";
	std::string parent = "base";
	for ( int i = 0; i < 6; ++i )
	{
		const Part& part = parts[i];
		const std::string child = fmt::format( "link{}", i + 1 );
		text += fmt::format(
		    "<link name='{}'><collision><origin xyz='0 0 {:g}'/><geometry><cylinder radius='{:g}' length='{:g}'/></geometry>"
		    "</collision></link>\n",
		    child, 0.5 * part.length, part.radius, part.length - 0.02 );
		text += fmt::format(
		    "<joint name='j{}' type='revolute'><parent link='{}'/><child link='{}'/><origin xyz='0 0 {:g}'/><axis xyz='{}'/>"
		    "<limit lower='{:g}' upper='{:g}' velocity='{:g}' effort='1'/></joint>\n",
		    i + 1, parent, child, part.up, part.axis, -LIMIT, LIMIT, part.speed );
		parent = child;
	}
	return text + "</robot>\n";
}

/// "  - {name: belt, shapes: ..., pose: ..." without the end.
std::string box( const std::string& name, double x, double y, double z, double sx, double sy, double sz )
{
	return fmt::format( "  - {{name: {}, shapes: [{{type: box, dimensions: [{:.4f}, {:.4f}, {:.4f}]}}], "
	                    "pose: {{position: [{:.4f}, {:.4f}, {:.4f}]}}",
	    name, sx, sy, sz, x, y, z );
}

std::string piece( double start, double end, double x, double y, double z )
{
	return fmt::format( "{{start: {:.4f}, end: {:.4f}, position: [{:.4f}, {:.4f}, {:.4f}]}}", start, end, x, y, z );
}

/// Where a tip has to be: metres, in the frame of the arm's base.
struct Region
{
	double low[3], high[3];
};

/// The text of a world, and where the ends are.
struct Draft
{
	std::string text;
	Region start{}, goal{}, other{}; ///< other: of the second arm
	bool second_arm = false;
};

std::string robotLine( const CellArm& arm, const std::string& name, double x, bool turned )
{
	const auto absolute = []( const std::string& file ) { return std::filesystem::absolute( file ).string(); };
	std::string line = "  - {name: " + name + ", robot: '" + absolute( arm.urdf ) + "'";
	line += arm.srdf.empty() ? "" : ", srdf: '" + absolute( arm.srdf ) + "'";
	line += fmt::format(
	    ", base: {{position: [{:.4f}, 0, 0], orientation: [0, 0, {}, {}]}}, state: {{", x, turned ? 1 : 0, turned ? 0 : 1 );
	for ( std::size_t i = 0; i < arm.joints.size(); ++i )
	{
		line += ( i > 0 ? ", " : "" ) + arm.joints[i] + fmt::format( ": {:g}", arm.stand[i] );
	}
	return line + "}}\n";
}

Draft conveyor( const CellArm& arm, Random& random )
{
	Draft out;
	const double x = arm.forward + random.in( 0.5, 0.65 ), z = arm.up - random.in( 0.2, 0.4 ), side = random.side();
	const double speed = random.in( 0.35, 0.7 );
	out.text = "objects:\n" + box( "belt", x, 0, z - 0.03, 0.4, 2.6, 0.06 ) + "}\n";
	double behind = random.in( 0.7, 1.0 );
	for ( int i = 0, count = 3 + static_cast<int>( random.in( 0, 3 ) ); i < count; ++i )
	{
		const double sx = random.in( 0.12, 0.25 ), sy = random.in( 0.1, 0.2 ), sz = random.in( 0.12, 0.25 );
		const double at = x + random.in( -0.05, 0.05 ), up = z + 0.5 * sz + 0.002;
		out.text += box( fmt::format( "box{}", i ), at, -side * behind, up, sx, sy, sz ) + ", motion: [" +
		            piece( 0, ( behind + 1.2 ) / speed, at, side * 1.2, up ) + "]}\n";
		behind += random.in( 0.35, 0.7 );
	}
	out.start = { { x - 0.25, -0.5, z + 0.3 }, { x + 0.1, 0.5, z + 0.8 } };
	out.goal = { { x - 0.12, -0.3, z + 0.03 }, { x + 0.12, 0.3, z + 0.18 } };
	return out;
}

Draft arms( const CellArm& arm, Random& random )
{
	Draft out;
	const double apart = 2 * arm.forward + random.in( 1.0, 1.2 ), z = arm.up - random.in( 0.25, 0.4 ), half = 0.5 * apart;
	out.second_arm = true;
	out.text =
	    robotLine( arm, "other", apart, true ) + "objects:\n" + box( "table", half, 0, z - 0.03, 0.4, 1.2, 0.06 ) + "}\n";
	out.start = { { half - 0.3, -0.6, z + 0.02 }, { half + 0.1, -0.05, z + 0.5 } };
	out.goal = { { half - 0.2, 0.05, z + 0.02 }, { half + 0.1, 0.6, z + 0.35 } };
	out.other = { { half - 0.15, -0.5, z + 0.02 }, { half + 0.25, 0.5, z + 0.4 } };
	return out;
}

Draft vehicle( const CellArm& arm, Random& random )
{
	Draft out;
	const double x = arm.forward + random.in( 0.6, 0.75 ), z = arm.up - random.in( 0.0, 0.2 ), side = random.side();
	const double begin = random.in( 0, 1.5 ), speed = random.in( 0.6, 1.2 ), stop = random.in( -0.3, 0.3 );
	const double there = begin + ( 1.8 + side * stop ) / speed, on = there + random.in( 0.5, 2.5 );
	out.text = "objects:\n" + box( "agv", x, -side * 1.8, z - 0.25, 0.5, 0.7, 0.5 ) + ", motion: [" +
	           piece( begin, there, x, stop, z - 0.25 ) + ", " +
	           piece( on, on + ( 1.8 - side * stop ) / speed, x, side * 1.8, z - 0.25 ) + "]}\n";
	out.start = { { x - 0.3, -0.6, z - 0.3 }, { x + 0.2, -0.1, z + 0.5 } };
	out.goal = { { x - 0.25, -0.1, z - 0.4 }, { x + 0.1, 0.5, z + 0.05 } };
	return out;
}

Draft gate( const CellArm& arm, Random& random )
{
	Draft out;
	const double from = arm.forward + random.in( 0.2, 0.3 ), z = arm.up, open = random.in( 1.5, 4 ),
	             seconds = random.in( 0.5, 2 );
	const double low = z - random.in( 0.4, 0.5 ), high = z + random.in( 0.25, 0.45 );
	out.text = "objects:\n" + box( "sill", from + 0.6, 0, low - 0.5, 1.2, 0.04, 1 ) + "}\n" +
	           box( "lintel", from + 0.6, 0, high + 0.5, 1.2, 0.04, 1 ) + "}\n" +
	           box( "gate", from + 0.6, 0, 0.5 * ( low + high ), 1.2, 0.03, high - low ) + ", motion: [" +
	           piece( open, open + seconds, from + 0.6, 0, 0.5 * ( low + high ) + high - low ) + "]}\n";
	const double side = random.side(), near = 0.2, far = 0.7;
	out.start = { { from + 0.1, side > 0 ? -far : near, z - 0.3 }, { from + 0.5, side > 0 ? -near : far, z + 0.3 } };
	out.goal = { { from + 0.1, side > 0 ? near : -far, z - 0.3 }, { from + 0.5, side > 0 ? far : -near, z + 0.3 } };
	return out;
}

Draft draftOf( const std::string& kind, const CellArm& arm, Random& random )
{
	Draft draft = kind == "conveyor" ? conveyor( arm, random )
	              : kind == "arms"   ? arms( arm, random )
	              : kind == "agv"    ? vehicle( arm, random )
	                                 : gate( arm, random );
	draft.text = "leeway_world: 1\nrobots:\n" + robotLine( arm, "arm", 0, false ) + draft.text;
	for ( int i = 0, count = 3 + static_cast<int>( random.in( 0, 4 ) ); i < count;
	      ++i ) // what hangs there, above all that moves
	{
		const double size[] = { random.in( 0.04, 0.15 ), random.in( 0.04, 0.15 ), random.in( 0.1, 0.4 ) };
		draft.text += box( fmt::format( "lamp{}", i ), arm.forward + random.in( 0.25, 0.8 ), random.in( -0.6, 0.6 ),
		                  arm.up + 0.1 + 0.5 * size[2] + random.in( 0, 0.3 ), size[0], size[1], size[2] ) +
		              "}\n";
	}
	return draft;
}

/// States of one arm of a cell, all else at a time.
class Ends
{
public:
	Ends( const Cell& cell, const CellArm& arm, const std::string& part, Random& random )
	    : m_cell( cell ), m_random( random ), m_query( leeway::makeQuery( cell.problem->checker.get() ) )
	{
		const lw_robot* robot = cell.problem->robot.get();
		m_tip = lw_robot_find_link( robot, ( part + "/" + arm.tip ).c_str() );
		for ( const std::string& joint : arm.joints )
		{
			const auto& names = cell.problem->variable_names;
			const auto found = std::find( names.begin(), names.end(), part + "/" + joint );
			if ( found == names.end() || m_tip == LW_INVALID_INDEX )
			{
				throw std::runtime_error( "cells: " + arm.urdf + " has no joint " + joint + ", or no link " + arm.tip );
			}
			m_variables.push_back( static_cast<std::uint32_t>( found - names.begin() ) );
		}
	}

	const std::vector<std::uint32_t>& variables() const { return m_variables; }

	bool isFree( const std::vector<double>& q ) const
	{
		bool free = false;
		leeway::require( lw_checker_is_free(
		                     m_cell.problem->checker.get(), m_query.get(), q.data(), LW_CHECK_BOTH, 0.005, &free, nullptr ),
		    "a state" );
		return free;
	}

	/// A free state with the tip in the region. @param around the state of all else @return false if none was found
	bool draw( const Region& region, std::vector<double>& around )
	{
		const lw_robot* robot = m_cell.problem->robot.get();
		std::vector<double> full( lw_robot_variable_count( robot ) );
		std::vector<lw_transform> poses( lw_robot_link_count( robot ) );
		for ( int i = 0; i < MOST_TRIES; ++i )
		{
			for ( const std::uint32_t v : m_variables )
			{
				const lw_variable_info info = lw_robot_variable( robot, m_cell.problem->variables[v] );
				around[v] = m_random.in( std::max( info.lower, -M_PI ), std::min( info.upper, M_PI ) );
			}
			lw_checker_full_state( m_cell.problem->checker.get(), around.data(), full.data() );
			leeway::require( lw_robot_fk( robot, full.data(), poses.data() ), "forward kinematics" );
			bool inside = true;
			for ( int k = 0; k < 3; ++k )
			{
				inside = inside && poses[m_tip].t[k] >= region.low[k] && poses[m_tip].t[k] <= region.high[k];
			}
			if ( inside && isFree( around ) )
			{
				return true;
			}
		}
		return false;
	}

private:
	const Cell& m_cell;
	Random& m_random;
	leeway::Query m_query;
	std::uint32_t m_tip;
	std::vector<std::uint32_t> m_variables;
};

std::vector<double> partOf( const std::vector<double>& state, const std::vector<std::uint32_t>& variables )
{
	std::vector<double> out;
	for ( const std::uint32_t v : variables )
	{
		out.push_back( state[v] );
	}
	return out;
}

/// Those variables of a robot alone that are named.
leeway::planners::TimedRobot narrowed( const leeway::planners::TimedRobot& all, const std::vector<std::uint32_t>& variables )
{
	leeway::planners::TimedRobot out;
	out.name = all.name;
	out.variables = variables;
	for ( const std::uint32_t v : variables )
	{
		const auto i =
		    static_cast<std::size_t>( std::find( all.variables.begin(), all.variables.end(), v ) - all.variables.begin() );
		out.velocity.push_back( all.velocity.at( i ) );
		out.start.push_back( all.start.at( i ) );
	}
	return out;
}

void driveRobot( const Cell& cell, const leeway::planners::TimedRobot& robot, const std::vector<double>& times,
    const std::vector<std::vector<double>>& points )
{
	std::vector<std::vector<double>> whole;
	for ( const std::vector<double>& point : points )
	{
		whole.push_back( motions::wholePoint( *cell.world, *cell.schedule, robot, point.data() ) );
	}
	cell.schedule->add( robot.name, times, whole );
}

/// The other arm goes to some places over the table, at three fifths of its velocities, while the first one stands at its start.
bool driveOther( Cell& cell, const CellArm& arm, const Region& region, const std::vector<double>& start, Random& random )
{
	Ends ends( cell, arm, "other", random );
	const leeway::planners::TimedRobot other =
	    narrowed( motions::timedRobot( *cell.world, *cell.schedule, "other", {}, 0 ), ends.variables() );
	for ( int tries = 0; tries < MOST_MOTIONS; ++tries )
	{
		std::vector<double> state = start;
		std::vector<double> at = partOf( state, ends.variables() );
		std::vector<double> times = { 0, random.in( 0.1, 1 ) };
		std::vector<std::vector<double>> points = { at, at };
		for ( int i = 0; i < 3 && ends.draw( region, state ); ++i )
		{
			const std::vector<double> next = partOf( state, ends.variables() );
			double seconds = 0;
			for ( std::size_t k = 0; k < next.size(); ++k )
			{
				seconds = std::max( seconds, std::abs( next[k] - at[k] ) / ( 0.6 * other.velocity[k] ) );
			}
			if ( times.back() + seconds > cell.deadline - 3 )
			{
				break;
			}
			times.push_back( times.back() + seconds );
			points.push_back( next );
			at = next;
		}
		driveRobot( cell, other, times, points );
		if ( points.size() > 2 && cell.audit().valid() )
		{
			return true;
		}
	}
	return false;
}

/// One try of a cell. @return false if its ends were not found
bool tryCell( const Draft& draft, const CellArm& arm, double proof_seconds, Random& random, Cell& cell )
{
	io::ProblemOptions options = io::worldProblem( *cell.world );
	options.find_reach = io::ReachOptions();
	options.find_reach->def.seconds = proof_seconds;
	cell.problem = std::make_unique<io::Problem>( io::buildProblem( cell.world->robot, options ) );
	leeway::require( leeway::prepare( cell.problem->checker.get(), 1 ), "meshes" );
	cell.schedule = std::make_unique<motions::Schedule>( *cell.world, *cell.problem );
	Ends ends( cell, arm, "arm", random );
	std::vector<double> state = cell.schedule->state( 0 );
	if ( !ends.draw( draft.start, state ) )
	{
		return false;
	}
	cell.robot = narrowed( motions::timedRobot( *cell.world, *cell.schedule, "arm", {}, 0 ), ends.variables() );
	cell.robot.start = partOf( state, ends.variables() );
	cell.drive( { 0 }, { cell.robot.start } );
	if ( draft.second_arm && !driveOther( cell, arm, draft.other, state, random ) )
	{
		return false;
	}
	std::vector<double> end = cell.schedule->state( cell.schedule->duration() );
	if ( !ends.draw( draft.goal, end ) )
	{
		return false;
	}
	cell.robot.goals = { partOf( end, ends.variables() ) };
	return true;
}

} // namespace

void Cell::drive( const std::vector<double>& times, const std::vector<std::vector<double>>& points ) const
{
	driveRobot( *this, robot, times, points );
}

motions::ScheduleAudit Cell::audit() const
{
	motions::ScheduleSettings settings;
	settings.to = schedule->duration();
	return motions::auditSchedule( *schedule, settings );
}

std::vector<std::string> cellKinds()
{
	return { "conveyor", "arms", "agv", "gate" };
}

std::vector<CellArm> cellArms( const std::string& data, const std::string& folder, bool generated )
{
	std::vector<CellArm> arms;
	if ( !generated )
	{
		requireData( data, "mbm" );
		CellArm panda = { "panda", data + "/mbm/panda/panda.urdf", data + "/mbm/panda/panda.srdf", "panda_hand", {},
		    { 0, -0.785, 0, -2.356, 0, 1.571, 0.785 }, 0, 0.33 };
		for ( int i = 1; i <= 7; ++i )
		{
			panda.joints.push_back( fmt::format( "panda_joint{}", i ) );
		}
		arms.push_back( panda );
		arms.push_back( { "fetch", data + "/mbm/fetch/fetch.urdf", data + "/mbm/fetch/fetch.srdf", "wrist_roll_link",
		    { "shoulder_pan_joint", "shoulder_lift_joint", "upperarm_roll_joint", "elbow_flex_joint", "forearm_roll_joint",
		        "wrist_flex_joint", "wrist_roll_joint" },
		    { 1.32, 1.4, -0.2, 1.72, 0, 1.66, 0 }, 0.15, 0.75 } );
	}
	CellArm six = { "six axes", folder + "/six.urdf", "", "link6", {}, { 0, -0.5, 2, 0, 1, 0 }, 0, 0.4 };
	std::ofstream( six.urdf ) << generatedArm();
	for ( int i = 1; i <= 6; ++i )
	{
		six.joints.push_back( fmt::format( "j{}", i ) );
	}
	arms.push_back( six );
	return arms;
}

Cell makeCell(
    const std::string& kind, const CellArm& arm, std::uint64_t seed, const std::string& folder, double proof_seconds )
{
	Random random( seed * 1000 + static_cast<std::uint64_t>( kind.size() ) );
	for ( int i = 0; i < MOST_CELLS; ++i )
	{
		Cell cell;
		cell.kind = kind;
		cell.arm = arm.name;
		cell.seed = seed;
		const std::string file = folder + "/" + kind + std::to_string( seed ) + ".yaml";
		const Draft draft = draftOf( kind, arm, random );
		std::ofstream( file ) << draft.text;
		cell.world = std::make_unique<io::WorldModel>( io::loadWorld( file ) );
		if ( tryCell( draft, arm, proof_seconds, random, cell ) )
		{
			return cell;
		}
	}
	throw std::runtime_error( "cells: " + kind + " " + std::to_string( seed ) + ": no ends were found for " + arm.name );
}
