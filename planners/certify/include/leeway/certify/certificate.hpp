// SPDX-License-Identifier: BSD-3-Clause
// Certificates of free motions: files by which anyone can check a proof without this library. planners/certify/FORMAT.md
//
// The writer makes windows of its own; it takes from the engine only shapes, poses, pairs, margins and measured distances. It tests each
// window with the checkers' arithmetic before it writes it.
#pragma once

#include "leeway/clock.h"
#include "leeway/io/model.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace leeway::certify
{

/// A Bezier curve of the group's variables; degree 1: a straight edge.
struct Piece
{
	unsigned degree = 1;
	std::vector<double> points; ///< [degree + 1][group variables]; angles are plain numbers, they do not wrap
	double seconds = 0;         ///< its duration, >= 0
};

/// Variables that one controller moves beside others: lw_track.
struct Track
{
	std::vector<std::uint32_t> variables; ///< of the group
	double lag = 0;                       ///< seconds, >= 0
	double spread = 0;                    ///< metres per second, >= 0: of all bodies below its joints that shift
	double since = 0;                     ///< seconds on the clock: no spread before
};

struct Settings
{
	double min_d = 0;                 ///< metres, >= 0
	std::vector<double> tolerance;    ///< [group variables], radians and metres; empty: none
	std::vector<std::string> sources; ///< files whose SHA-256 is stored: robot, SRDF, scene, path
	lw_check_flags flags = LW_CHECK_BOTH;
	double seconds = 60;       ///< after which it gives up
	std::vector<Track> tracks; ///< of a schedule; empty: one controller moves all, and its lag takes no clearance off
	double begin = 0;          ///< seconds on the clock, of the first piece
};

struct Certificate
{
	std::string bytes;
	std::size_t pairs = 0;      ///< that must be proved along the whole motion
	std::size_t spheres = 0;    ///< windows of pairs that are proved by spheres,
	std::size_t directions = 0; ///< and by directions
	std::size_t proof_size = 0; ///< bytes of these
	double seconds = 0;
	std::size_t windows() const { return spheres + directions; }
};

/// Straight edges from point to point, the shorter way for variables that wrap.
std::vector<Piece> piecesOf( const io::Problem& problem, const std::vector<std::vector<double>>& points );

/// A schedule of robots and objects: pieces from `from` to `to`, and as long as the largest lag before and after. Each ends where a piece of a track does.
struct Schedule
{
	std::vector<Piece> pieces;
	std::vector<Track> tracks;
	std::vector<double> tolerance; ///< [group variables]: of the tracks, and the rounding of cut pieces
	double begin = 0;
};

/// @param clock as lw_clock_check() accepts it @throws CoreError (LW_ERROR_INVALID_ARGUMENT: it does not)
Schedule scheduleOf( const io::Problem& problem, const lw_clock& clock, double from, double to );

/// Writes certificates of one robot in one scene, one after the other. Their common part is made once.
class Writer
{
public:
	/// @param problem, robot outlive this; `robot` is that of the problem: origins, axes, reasons of allowed pairs
	Writer( const io::Problem& problem, const io::RobotModel& robot );
	~Writer();
	Writer( const Writer& ) = delete;
	Writer& operator=( const Writer& ) = delete;
	/// @param pieces each begins where the one before ends
	/// @param file of the motion, for errors
	/// @throws io::Error: a pair that is not farther apart than min_d, or so near that the windows become too small; a motion that the
	/// format cannot hold: a moving quaternion, pieces that are not joined; a solid mesh whose hull is not separate; no end within `seconds`
	Certificate write( const std::vector<Piece>& pieces, const Settings& settings, const std::string& file );

private:
	struct State;
	std::unique_ptr<State> m_state;
};

/// The only certificate of a problem. @throws as Writer::write()
Certificate certify( const io::Problem& problem, const io::RobotModel& robot, const std::vector<Piece>& pieces,
    const Settings& settings, const std::string& file );

/// One line for people.
std::string describe( const Certificate& certificate, const std::string& file );

} // namespace leeway::certify
