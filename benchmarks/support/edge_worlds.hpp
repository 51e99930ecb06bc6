// SPDX-License-Identifier: BSD-3-Clause
// The worlds in which edges are judged: robots and scenes of the data folder, of files, and random ones. Each is made from a
// source, a few names in JSON, so that recorded edges can be judged again (README.md describes the file).
#pragma once

#include "edge_world.hpp"

#include "leeway/io/model.hpp"

#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

using Json = nlohmann::ordered_json;

struct EdgeWorldEntry
{
	EdgeWorld world;
	Json source;
	std::vector<double> start, goal; ///< of the request, if it is for this group; otherwise empty
};

class EdgeWorlds
{
public:
	/// @param data folder of robots and scenes; relative file names start there
	/// @param reach how motion hulls and pair tables of robots from files are made; the robot is filled in
	EdgeWorlds( const std::string& data, const lw_reach_def& reach ) : m_data( data ), m_reach_def( reach ) {}

	/// ARMAR-III in the cluttered kitchen, where reach problems park it, other joints as they have them. A group that holds
	/// "platform" is one world, and edges start near those places. @param group SRDF groups joined by "+"
	/// @param problems numbers from 1 to 12; none = all
	void addArmar( const std::string& group, const std::vector<int>& problems = {} );
	/// ARMAR-III's reach problems, each with its own group.
	void addArmarProblems();
	/// Scenes of MotionBenchMaker: of each of the robot's problem sets with `only` in its name those of these numbers that are there.
	void addMbm(
	    const std::string& robot, const std::string& group, const std::vector<int>& numbers, const std::string& only = "" );
	/// Robots of the folder mbm with problems, by name, and the group that their first request names.
	/// @throws std::runtime_error for problems without a request
	std::vector<std::pair<std::string, std::string>> mbmRobots() const;
	void addRandom( std::uint64_t seed, std::size_t count );
	/// From its source; a world that is there already is not made again. @return its index
	/// @throws leeway::io::Error, std::runtime_error
	std::size_t add( const Json& source );

	std::size_t size() const { return m_entries.size(); }
	const EdgeWorldEntry& entry( std::size_t i ) const { return *m_entries[i]; }
	const EdgeWorld& world( std::size_t i ) const { return m_entries[i]->world; }

private:
	std::string path( const Json& name ) const;
	leeway::io::RobotModel& robot( const Json& source );
	const leeway::io::SceneModel& scene( const std::string& file );
	void makeFromFiles( EdgeWorldEntry& entry );
	void anchor( EdgeWorldEntry& entry, const std::vector<std::string>& names ) const;

	std::string m_data;
	lw_reach_def m_reach_def;
	std::map<std::string, leeway::io::RobotModel> m_robots;
	std::map<std::string, leeway::io::SceneModel> m_scenes;
	std::map<std::string, leeway::Reach> m_reaches;
	std::vector<std::unique_ptr<EdgeWorldEntry>> m_entries;
};
