// SPDX-License-Identifier: BSD-3-Clause
// Ground truth tables: states of a robot in a scene with exact distances by another engine. See README.md of the data.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace groundtruth
{

struct Row
{
	std::string kind;      ///< uniform, near_free, near_colliding
	std::vector<double> q; ///< as Table::joints
	double d_env = 0, d_self = 0, d_self_moving = 0;
	std::string env_link, env_object, self_link1, self_link2, self_moving_link1, self_moving_link2;
	bool in_collision_env = false, in_collision_self = false;
};

struct Table
{
	std::string name; ///< file name without "groundtruth_" and ending
	std::string urdf, srdf, scene, group;
	std::vector<std::string> joints; ///< all others are 0
	std::vector<Row> rows;
};

inline std::vector<std::string> splitLine( const std::string& line )
{
	std::vector<std::string> fields;
	std::size_t begin = 0;
	while ( true )
	{
		std::size_t end = line.find( ',', begin );
		fields.push_back( line.substr( begin, end - begin ) );
		if ( end == std::string::npos )
		{
			break;
		}
		begin = end + 1;
	}
	if ( !fields.back().empty() && fields.back().back() == '\r' )
	{
		fields.back().pop_back();
	}
	return fields;
}

/// Every table below the data folder, sorted by path. Empty if the folder does not exist.
inline std::vector<std::filesystem::path> findTables( const std::filesystem::path& data )
{
	std::vector<std::filesystem::path> tables;
	std::error_code error;
	for ( const auto& entry : std::filesystem::recursive_directory_iterator( data, error ) )
	{
		const std::filesystem::path& path = entry.path();
		if ( path.extension() == ".csv" && path.parent_path().filename() == "groundtruth" )
		{
			tables.push_back( path );
		}
	}
	std::sort( tables.begin(), tables.end() );
	return tables;
}

/// The robot, scene and group of a table, which its name gives: groundtruth_<robot>_<scene>.csv.
inline void findModels( const std::filesystem::path& file, const std::filesystem::path& data, Table& table )
{
	std::filesystem::path robot_folder = file.parent_path().parent_path();
	std::string robot = robot_folder.filename().string();
	table.name = file.stem().string().substr( std::string( "groundtruth_" ).size() );
	table.urdf = ( robot_folder / ( robot + ".urdf" ) ).string();
	table.srdf = ( robot_folder / ( robot + ".srdf" ) ).string();
	if ( robot == "armar3" )
	{
		bool parked = table.name.find( "parked" ) != std::string::npos;
		table.group = parked ? "torso_both_arms" : "platform_torso_both_arms";
		table.scene = ( data / "kit_kitchen" / "scene_cluttered.yaml" ).string();
		return;
	}
	// <robot>_<set>_scene<number>
	std::size_t set = robot.size() + 1, scene = table.name.rfind( '_' );
	table.group = robot == "panda" ? "panda_arm" : "arm_with_torso";
	table.scene =
	    ( robot_folder / "problems" / table.name.substr( set, scene - set ) / ( table.name.substr( scene + 1 ) + ".yaml" ) )
	        .string();
}

/// @throws std::runtime_error if the file is not such a table
inline Table readTable( const std::filesystem::path& file, const std::filesystem::path& data )
{
	static const char* const columns[] = { "d_env", "env_link", "env_object", "d_self", "self_link1", "self_link2",
	    "d_self_moving", "self_moving_link1", "self_moving_link2", "in_collision_env", "in_collision_self" };
	Table table;
	findModels( file, data, table );
	std::ifstream in( file );
	std::string line;
	std::getline( in, line );
	std::vector<std::string> header = splitLine( line );
	auto values = std::find( header.begin(), header.end(), columns[0] );
	if ( header[0] != "kind" || !std::equal( std::begin( columns ), std::end( columns ), values, header.end() ) )
	{
		throw std::runtime_error( file.string() + ": not the columns of a ground truth table" );
	}
	const std::size_t first = static_cast<std::size_t>( values - header.begin() );
	table.joints.assign( header.begin() + 1, values );
	while ( std::getline( in, line ) )
	{
		std::vector<std::string> field = splitLine( line );
		if ( field.size() != header.size() )
		{
			throw std::runtime_error( file.string() + ": row " + std::to_string( table.rows.size() ) + " is cut off" );
		}
		Row row;
		row.kind = field[0];
		for ( std::size_t i = 1; i < first; ++i )
		{
			row.q.push_back( std::stod( field[i] ) );
		}
		const std::string* f = &field[first];
		row.d_env = std::stod( f[0] );
		row.env_link = f[1];
		row.env_object = f[2];
		row.d_self = std::stod( f[3] );
		row.self_link1 = f[4];
		row.self_link2 = f[5];
		row.d_self_moving = std::stod( f[6] );
		row.self_moving_link1 = f[7];
		row.self_moving_link2 = f[8];
		row.in_collision_env = f[9] == "1";
		row.in_collision_self = f[10] == "1";
		table.rows.push_back( row );
	}
	return table;
}

} // namespace groundtruth
