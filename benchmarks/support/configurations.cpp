// SPDX-License-Identifier: BSD-3-Clause
// States of ARMAR-III in the cluttered kitchen: see configurations.hpp.
#include "support/configurations.hpp"

#include "groundtruth.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <random>
#include <set>

namespace
{

const char* const GROUP = "platform_torso_both_arms";

/// Index of each of the group's variables in a state.
std::map<std::string, std::size_t> entries( const leeway::io::Problem& problem )
{
	std::map<std::string, std::size_t> index;
	for ( std::size_t i = 0; i < problem.variable_names.size(); ++i )
	{
		index[problem.variable_names[i]] = i;
	}
	return index;
}

/// Torso and right arm uniform in their limits; the base and the left arm stay.
void randomiseTorsoAndRightArm( const leeway::io::Problem& problem, std::mt19937_64& random, std::vector<double>& state )
{
	static const char* const joints[] = { "Hip_Pitch_joint", "Hip_Roll_joint", "Hip_Yaw_joint", "Shoulder_1_R_joint",
	    "Shoulder_2_R_joint", "Upperarm_R_joint", "Elbow_R_joint", "Underarm_R_joint", "Wrist_1_R_joint",
	    "Wrist_2_R_joint" };
	const std::map<std::string, std::size_t> index = entries( problem );
	for ( const char* joint : joints )
	{
		const std::size_t i = index.at( joint );
		const lw_variable_info info = lw_robot_variable( problem.robot.get(), problem.variables[i] );
		state[i] = info.lower + uniform( random ) * ( info.upper - info.lower );
	}
}

ConfigurationSet nearRows( const leeway::io::Problem& problem, const std::string& data, std::size_t count )
{
	ConfigurationSet set{ "near", "rows of the ground truth within 5 mm of contact or less than 1 mrad inside of it", {} };
	const std::map<std::string, std::size_t> index = entries( problem );
	std::vector<std::vector<double>> states;
	for ( const std::filesystem::path& file : groundtruth::findTables( std::filesystem::path( data ) / "armar3" ) )
	{
		const groundtruth::Table table = groundtruth::readTable( file, data );
		for ( const groundtruth::Row& row : table.rows )
		{
			if ( row.kind == "uniform" )
			{
				continue;
			}
			// A base that is not in the table's group has a column nevertheless
			std::vector<double> state( problem.variables.size(), 0.0 );
			for ( std::size_t i = 0; i < table.joints.size(); ++i )
			{
				state.at( index.at( table.joints[i] ) ) = row.q[i];
			}
			states.push_back( state );
		}
	}
	// Every n-th, so that a short run sees all kinds
	const std::size_t stride = std::max<std::size_t>( 1, states.size() / std::max<std::size_t>( 1, count ) );
	for ( std::size_t i = 0; i < states.size() && set.states.size() < count; i += stride )
	{
		set.states.push_back( states[i] );
	}
	return set;
}

ConfigurationSet reachStarts(
    const leeway::io::Problem& problem, const std::string& data, std::mt19937_64& random, std::size_t count )
{
	ConfigurationSet set{ "reach", "start bases of the 12 reach problems, torso and right arm uniform", {} };
	const std::map<std::string, std::size_t> index = entries( problem );
	std::vector<std::vector<double>> starts;
	std::set<std::filesystem::path> files;
	for ( const auto& entry : std::filesystem::directory_iterator( std::filesystem::path( data ) / "armar3" / "reach" ) )
	{
		files.insert( entry.path() );
	}
	for ( const std::filesystem::path& file : files )
	{
		std::vector<double> state( problem.variables.size(), 0.0 );
		for ( const auto& [name, value] : leeway::io::loadRequest( file.string() ).start.values )
		{
			const auto found = index.find( name );
			if ( found != index.end() )
			{
				state[found->second] = value;
			}
		}
		starts.push_back( state );
	}
	for ( std::size_t i = 0; i < count; ++i )
	{
		std::vector<double> state = starts.at( i % starts.size() );
		randomiseTorsoAndRightArm( problem, random, state );
		set.states.push_back( state );
	}
	return set;
}

// A base is near furniture if the robot with its arms hanging has `room` to 20 cm there.
std::vector<std::vector<double>> basesNearFurniture(
    const leeway::io::Problem& problem, std::mt19937_64& random, double room )
{
	constexpr std::size_t BASES = 20;
	const std::map<std::string, std::size_t> index = entries( problem );
	leeway::Query query = leeway::makeQuery( problem.checker.get() );
	const lw_range range = { room, 0.2, 0.0 };
	std::vector<std::vector<double>> bases;
	while ( bases.size() < BASES )
	{
		std::vector<double> state( problem.variables.size(), 0.0 );
		for ( const char* joint : { "X_Platform_joint", "Y_Platform_joint", "Yaw_Platform_joint" } )
		{
			const std::size_t i = index.at( joint );
			const lw_variable_info info = lw_robot_variable( problem.robot.get(), problem.variables[i] );
			state[i] = info.lower + uniform( random ) * ( info.upper - info.lower );
		}
		lw_state_result result;
		leeway::require( lw_checker_state( problem.checker.get(), query.get(), state.data(), LW_CHECK_ENVIRONMENT, &range,
		                     false, &result ),
		    "a base" );
		if ( result.environment.kind == LW_CLEARANCE_NEAR )
		{
			bases.push_back( state );
		}
	}
	return bases;
}

ConfigurationSet furnitureBases( const leeway::io::Problem& problem, std::mt19937_64& random, std::size_t count )
{
	ConfigurationSet set{ "furniture", "20 random bases with 1 to 20 cm of room, torso and right arm uniform", {} };
	const std::vector<std::vector<double>> bases = basesNearFurniture( problem, random, 0.01 );
	for ( std::size_t i = 0; i < count; ++i )
	{
		std::vector<double> state = bases[i % bases.size()];
		randomiseTorsoAndRightArm( problem, random, state );
		set.states.push_back( state );
	}
	return set;
}

} // namespace

std::vector<double> uniformState( const leeway::io::Problem& problem, std::mt19937_64& random )
{
	std::vector<double> state;
	for ( const std::uint32_t variable : problem.variables )
	{
		const lw_variable_info info = lw_robot_variable( problem.robot.get(), variable );
		const bool limited = std::isfinite( info.lower ) && std::isfinite( info.upper );
		const double share = uniform( random );
		state.push_back( info.wraps ? ( 2 * share - 1 ) * M_PI
		                 : limited  ? info.lower + share * ( info.upper - info.lower )
		                            : problem.reference[variable] );
	}
	return state;
}

leeway::io::Problem loadKitchen( const std::string& data, const lw_tree_def& tree, double detail, double budget )
{
	leeway::io::LoadOptions load;
	load.tree = tree;
	load.detail = detail;
	const leeway::io::RobotModel robot =
	    leeway::io::loadRobot( data + "/armar3/armar3.urdf", data + "/armar3/armar3.srdf", load );
	const leeway::io::SceneModel scene = leeway::io::loadScene( data + "/kit_kitchen/scene_cluttered.yaml", load );
	leeway::io::ProblemOptions options;
	options.group = GROUP;
	options.scene = &scene;
	if ( budget > 0 )
	{
		options.find_reach = leeway::io::ReachOptions();
		options.find_reach->def.seconds = budget;
	}
	return leeway::io::buildProblem( robot, options );
}

std::vector<std::string> kitchenFiles( const std::string& data )
{
	std::set<std::string> files;
	for ( const char* folder : { "/armar3/meshes/full", "/armar3/groundtruth", "/armar3/reach", "/kit_kitchen/meshes" } )
	{
		for ( const auto& entry : std::filesystem::directory_iterator( data + folder ) )
		{
			files.insert( entry.path().string() );
		}
	}
	for ( const char* file : { "/armar3/armar3.urdf", "/armar3/armar3.srdf", "/kit_kitchen/scene_cluttered.yaml" } )
	{
		files.insert( data + file );
	}
	return { files.begin(), files.end() };
}

std::vector<ConfigurationSet> makeConfigurations(
    const leeway::io::Problem& problem, const std::string& data, std::uint64_t seed, std::size_t count )
{
	std::mt19937_64 random( seed );
	std::vector<ConfigurationSet> sets;
	sets.push_back( nearRows( problem, data, count ) );
	sets.push_back( reachStarts( problem, data, random, count ) );
	sets.push_back( furnitureBases( problem, random, count ) );
	return sets;
}

std::vector<std::map<std::string, double>> placesNearFurniture(
    const leeway::io::Problem& problem, std::uint64_t seed, double room )
{
	std::mt19937_64 random( seed );
	std::vector<std::map<std::string, double>> places;
	for ( const std::vector<double>& base : basesNearFurniture( problem, random, room ) )
	{
		std::map<std::string, double> place;
		for ( std::size_t i = 0; i < base.size(); ++i )
		{
			place[problem.variable_names[i]] = base[i];
		}
		places.push_back( place );
	}
	return places;
}
