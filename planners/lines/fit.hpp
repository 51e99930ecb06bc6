// SPDX-License-Identifier: BSD-3-Clause
// One attempt at one part of the way: states on the reference, then cubics between them that are proved.
//
// The part's parameter u goes from 0 to 1 over its time, whatever that will be; the fraction is fractionAt( u ). Places are whole numbers of
// 1 / most_places of u, so that their times can be whole nanoseconds.
#pragma once

#include "lines/follower.hpp"

namespace leeway::lines
{

constexpr std::uint32_t most_places = 1 << 13;

/// A part of the way, for all attempts.
struct Leg
{
	lw_region_def def;
	RegionHandle region;
	double length = 0;                      ///< metres, of the tip's way
	std::uint32_t first_step = most_places; ///< places between the first states
};

struct Knot
{
	std::uint32_t place = 0;
	State q, rate; ///< rate: for each unit of u
};

/// A proved cubic.
struct Piece
{
	std::uint32_t from = 0, to = 0;             ///< places
	std::vector<double> points;                 ///< [4][variables]
	double position_error = 0, angle_error = 0; ///< proved
};

class Fit
{
public:
	Fit( Follower& follower, const io::Problem& problem, const Settings& settings, lw_query* query );

	/// Follows a leg from q, which is on it, and moves q to its end. @param out pieces appended
	/// @return false: stop() says why, without its part
	bool run( const Leg& leg, const Wish& wish, State& q, std::vector<Piece>& out );
	const Stop& stop() const { return m_stop; }
	/// Is the state proved free? @return false: stop() says why
	bool isFree( const Leg& leg, double fraction, const State& q );
	std::uint64_t windows() const { return m_windows; }
	std::uint64_t states() const { return m_states; }

private:
	bool follow( const Leg& leg, const Wish& wish, const State& q );
	bool step( const Leg& leg, const Wish& wish, std::uint32_t to );
	void takeRates( const Leg& leg );
	bool prove( const Leg& leg, const Knot& a, const Knot& b, std::vector<Piece>& out );
	bool isNear( const Leg& leg, Piece& piece );
	bool isClear( const Leg& leg, const Piece& piece );
	bool fail( const Leg& leg, Obstacle obstacle, double fraction, const State& q, std::size_t variable );

	Follower& m_follower;
	const io::Problem& m_problem;
	const Settings& m_settings;
	lw_query* m_query;
	std::vector<Knot> m_knots;
	std::vector<std::uint32_t> m_variables;
	std::vector<double> m_rest;
	Stop m_stop;
	std::uint64_t m_windows = 0, m_states = 0;
};

/// Control points of the fraction between two places.
void fractionPoints( std::uint32_t from, std::uint32_t to, double out[4] );

} // namespace leeway::lines
