// SPDX-License-Identifier: BSD-3-Clause
// Evidence that a problem has no path: the first joints of an arm, with the links that they alone move.
//
// A path of the whole arm is a path of its first two or three joints with all later links taken away. If the states of a grid of
// these joints do not join start and goal, there is none, unless it goes between two states of the grid.
#pragma once

#include "support/edge_worlds.hpp"

#include <string>

/// @return empty if grids of two and three joints join the ends; else the joints and the step of the grid that does not, in degrees:
/// "disconnected on a grid: shoulder_pan_joint, shoulder_lift_joint, 0.9 degrees"
/// @param share of 2 million states for two joints, and 30 million for three
std::string disconnectedPrefix( const EdgeWorldEntry& entry, double share = 1 );
