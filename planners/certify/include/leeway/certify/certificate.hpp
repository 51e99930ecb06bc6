// SPDX-License-Identifier: BSD-3-Clause
// Certificates of free motions: files by which anyone can check a proof without this library. planners/certify/FORMAT.md
//
// The writer makes windows of its own; it takes from the engine only shapes, poses, pairs, margins and measured distances. It tests each
// window with the checkers' arithmetic before it writes it.
#pragma once

#include "leeway/io/model.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace leeway::certify
{

/// A Bezier curve of the group's variables; degree 1: a straight edge.
struct Piece
{
	unsigned degree = 1;
	std::vector<double> points; ///< [degree + 1][group variables]; angles are plain numbers, they do not wrap
};

struct Settings
{
	double min_d = 0;                 ///< metres, >= 0
	std::vector<double> tolerance;    ///< [group variables], radians and metres; empty: none
	std::vector<std::string> sources; ///< files whose SHA-256 is stored: robot, SRDF, scene, path
	lw_check_flags flags = LW_CHECK_BOTH;
	double seconds = 60; ///< after which it gives up
};

struct Certificate
{
	std::string bytes;
	std::size_t pairs = 0;      ///< that must be proved along the whole motion
	std::size_t windows = 0;    ///< that prove them
	std::size_t proof_size = 0; ///< bytes of these
	double seconds = 0;
};

/// Straight edges from point to point, the shorter way for variables that wrap.
std::vector<Piece> piecesOf( const io::Problem& problem, const std::vector<std::vector<double>>& points );

/// @param robot of the problem: origins, axes, reasons of allowed pairs
/// @param pieces each begins where the one before ends
/// @param file of the motion, for errors
/// @throws io::Error: a pair that is not farther apart than min_d, or so near that the windows become too small; a motion that the
/// format cannot hold: a moving quaternion, pieces that are not joined; a solid mesh whose hull is not separate; no end within `seconds`
Certificate certify( const io::Problem& problem, const io::RobotModel& robot, const std::vector<Piece>& pieces,
    const Settings& settings, const std::string& file );

/// One line for people.
std::string describe( const Certificate& certificate, const std::string& file );

} // namespace leeway::certify
