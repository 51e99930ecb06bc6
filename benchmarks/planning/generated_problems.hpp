// SPDX-License-Identifier: BSD-3-Clause
// Robots that nobody prepared, in scenes made by seed: a table with objects, a shelf, a cage, random boxes.
//
// A robot is a URDF and the joints of an arm, without an SRDF: pairs of links that are in contact in more than half of some random
// states are disabled, as are neighbours. Scenes are as large as the arm reaches. Start and goal are random free states at
// least 5 mm from the scene.
#pragma once

#include "support/edge_worlds.hpp"

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

struct ZooRobot
{
	std::string name;
	std::string urdf;  ///< below the folder of the robots
	std::string group; ///< joints joined by "+"
};

/// Eight arms of the package example-robot-data.
const std::vector<ZooRobot>& zooRobots();

/// @param zoo folder that .ci/install.sh zoo filled @return the folder of example-robot-data's robots
/// @throws NoData if it is not there
std::string robotsOfZoo( const std::string& zoo );

/// Adds `count` problems of each kind of scene; their sets are named "table_ur5". Equal seeds give equal problems.
/// @param folder the SRDF, scenes and requests are written there: leeway plan reads them
void addGeneratedProblems( EdgeWorlds& worlds, const ZooRobot& robot, const std::string& robots, int count,
    std::uint64_t seed, const std::string& folder );

/// Worlds by the name of their robot.
using Subjects = std::vector<std::pair<std::string, std::function<void( EdgeWorlds& )>>>;

/// Robots that nothing was tuned on: those of the zoo in generated scenes, and random ones.
/// @param zoo empty: none of it @param prefix of the names of its robots @param folder as for addGeneratedProblems()
void addUntuned( Subjects& subjects, const std::string& zoo, const std::string& prefix, std::size_t random_robots,
    std::uint64_t seed, const std::string& folder );
