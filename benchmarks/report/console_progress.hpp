// SPDX-License-Identifier: BSD-3-Clause
// How far a run of several experiments is, and how long it will take still: one line on stderr.
#pragma once

#include "report/experiment.hpp"

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

/// Time left of several pieces of work one after the other. Reads no clock: the caller passes the time.
class TimeLeft
{
public:
	/// @param expected seconds of each piece, roughly: how they compare counts, and the sum only until something is known
	explicit TimeLeft( std::vector<double> expected ) : m_expected( std::move( expected ) ) {}
	/// Piece i begins at `now` seconds; those before it are done.
	void begin( std::size_t i, double now );
	/// Seconds left when `share` of the piece at hand is done. A piece that takes twice as long as expected makes those
	/// after it expected to do so too.
	double left( double share, double now ) const;
	/// Share of everything that is done, by the same reckoning.
	double done( double share, double now ) const;

private:
	double rest() const;                           ///< expected seconds of the pieces after the one at hand
	double pace( double share, double now ) const; ///< seconds taken over seconds expected, so far

	std::vector<double> m_expected;
	std::size_t m_piece = 0;
	double m_first = 0, m_began = 0;
};

/// "45 s", "3 min 20 s".
std::string sayDuration( double seconds );

/// On a terminal one line that is written over; elsewhere a line every ten seconds.
class ConsoleProgress : public Progress
{
public:
	explicit ConsoleProgress( std::vector<double> expected );
	~ConsoleProgress() override;
	void begin( std::size_t i, const std::string& name );
	void at( double share, const std::string& what ) override;

private:
	double now() const;
	void clear() const;

	TimeLeft m_time;
	std::chrono::steady_clock::time_point m_start = std::chrono::steady_clock::now();
	std::string m_name;
	bool m_terminal;
	double m_said = 0; ///< when the last line was written
};
