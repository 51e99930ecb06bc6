// SPDX-License-Identifier: BSD-3-Clause
// States of ARMAR-III in the cluttered kitchen, near furniture, as a planner checks them.
#pragma once

#include "leeway/io/model.hpp"

#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <vector>

struct ConfigurationSet
{
	std::string name, description;
	std::vector<std::vector<double>> states; ///< of the checker's group
};

/// In [0, 1). std::uniform_real_distribution may differ between standard libraries; this does not.
inline double uniform( std::mt19937_64& random )
{
	return static_cast<double>( random() >> 11 ) * 0x1p-53;
}

/// Uniform within the limits; within a whole turn for wrapping variables; other variables keep their reference value.
std::vector<double> uniformState( const leeway::io::Problem& problem, std::mt19937_64& random );

/// Robot, scene and group of the comparison, from the data folder. Group: platform, torso and both arms.
/// @param detail metres, leeway::io::LoadOptions::detail @param budget seconds for proofs of pairs; 0: no tables at all
leeway::io::Problem loadKitchen( const std::string& data, const lw_tree_def& tree, double detail = 0, double budget = 0 );

/// Files that the models and states come from.
std::vector<std::string> kitchenFiles( const std::string& data );

/// @param count states per set, at most; the ground truth has 400 near rows
/// @throws std::exception if the data is not there
std::vector<ConfigurationSet> makeConfigurations(
    const leeway::io::Problem& problem, const std::string& data, std::uint64_t seed, std::size_t count );

/// 20 random places where the robot, its arms hanging, has `room` metres to 20 cm: values by variable.
std::vector<std::map<std::string, double>> placesNearFurniture(
    const leeway::io::Problem& problem, std::uint64_t seed, double room );
