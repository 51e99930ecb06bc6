// SPDX-License-Identifier: BSD-3-Clause
// The parts of the experiment `paper`: the figures of Steinbach, Kuffner, Asfour, Dillmann 2006, section VI, measured here.
#pragma once

#include "report/experiment.hpp"
#include "leeway/io/model.hpp"

#include <string>

/// "12.3 %", "4.1 microseconds": printf for sentences. @param format one conversion of a double
std::string say( const char* format, double value );

/// Figure 9a: trees of two cubes by three fits, over separation; figure 4: volume of their levels. Needs no data; with it
/// also the trees of the robot's links and of the kitchen's objects.
void addPaperShapes( const ExperimentSettings& settings, Progress& progress, Outcome& out );

/// ARMAR-III in the cluttered kitchen with motion hulls and pair tables, parked before the dishwasher (reach problem 5).
leeway::io::Problem loadPaperKitchen( const ExperimentSettings& settings, const std::string& group );

/// States of figures 9b and 10.
struct PaperStates
{
	std::vector<std::vector<double>> reach;  ///< along a reach under the wall cupboard, evenly in joint space
	std::vector<std::vector<double>> random; ///< near furniture
};

/// Figures 9b (max_d), 10a (min_d and alpha, robot against kitchen) and 10b (alpha, robot against itself).
void addPaperRobot( const ExperimentSettings& settings, Progress& progress, Outcome& out );
