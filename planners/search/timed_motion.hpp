// SPDX-License-Identifier: BSD-3-Clause
// Motions of the planned variables beside tracks that are known, asked and counted.
#pragma once

#include "leeway/planners/timed_planner.hpp"

#include <string>
#include <vector>

namespace leeway::planners
{

/// @throws InputError with the sentence, unless the condition holds: NaN is refused
void needOfSettings( bool condition, const std::string& sentence );

/// Seconds: a track rests from then on, its controller's lag included.
double endOf( const lw_track& track );

class TimedMotion
{
public:
	/// @param settings must outlive it @throws InputError
	TimedMotion( Checker checker, const TimedSettings& settings, const lw_clock& others, Statistics& statistics );

	/// @param query of this search; its warm starts are dropped
	void begin( lw_query* query );

	/// b - a of one variable, the shorter way if it wraps.
	double difference( std::size_t i, double a, double b ) const;
	/// Seconds from one state to another at full speed.
	double least( const double* a, const double* b ) const;
	/// Does a variable go round without end? Continuous joints for which the settings have no bounds.
	bool wraps( std::size_t i ) const { return m_wraps[i] != 0; }
	/// Bounds of the settings, or of the joints; half a turn to both sides of those that wrap. @throws InputError
	void findBounds( std::vector<double>& lower, std::vector<double>& upper ) const;
	/// Seconds: all given tracks rest from then on.
	double othersEnd() const;

	/// A state at a time, on the tracks themselves.
	bool isStateFree( const double* q, double time );
	/// A straight motion, the shorter way, also if all of it is late or early by the lag: so motions one after the other are proved
	/// together, too.
	bool isFree( const double* a, double from, const double* b, double to );
	bool isRestFree( const double* q, double from, double to );
	/// All motions of a path and the rest behind it, with the lag as it is.
	bool isPathFree( const TimedPath& path, double from, double to );

	/// "a and b", of the last motion that was not free.
	std::string lastPair() const;
	/// An error of the checker; after it no answer is "free".
	lw_status status() const { return m_status; }

private:
	lw_variable_info infoOf( std::size_t i ) const;
	/// The planned variables of one controller, and their track.
	struct Controlled
	{
		std::size_t first, count;
		std::vector<double> points;
		std::vector<lw_timed_piece> pieces;
	};

	void addControllers();
	/// Replaces the planned motion. @param states [times] all variables of each; a single state rests
	void setPlanned( const std::vector<double>& times, const double* states );
	bool isMomentFree( double time );
	bool seemsFree( double from, double to );
	bool prove( double from, double to );
	/// A motion that may be late or early as a whole.
	bool proveShifted( double from, double to );

	Checker m_checker;
	const TimedSettings& m_settings;
	Statistics& m_statistics;
	lw_query* m_query = nullptr;
	std::vector<lw_track> m_tracks; ///< those that are given, then that which is planned
	std::vector<double> m_rest, m_state, m_points, m_times;
	std::vector<unsigned char> m_wraps; ///< [variables]
	std::vector<Controlled> m_controlled;
	lw_clock m_clock{};
	lw_timed_result m_last{};
	lw_status m_status = LW_OK;
};

} // namespace leeway::planners
