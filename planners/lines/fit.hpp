// SPDX-License-Identifier: BSD-3-Clause
// One attempt at one run: states on its references, then cubics between them that are proved.
#pragma once

#include "leeway/motions/path_constraints.hpp"
#include "lines/follower.hpp"

namespace leeway::lines
{

struct Knot
{
	std::uint32_t place = 0;
	std::size_t leg = 0; ///< that leads to it
	State q, rate;       ///< rate: for each unit of u
};

/// A proved cubic.
struct Piece
{
	std::size_t leg = 0;
	std::uint32_t from = 0, to = 0;             ///< places
	std::vector<double> points;                 ///< [4][variables]
	double position_error = 0, angle_error = 0; ///< proved
};

class Fit
{
public:
	/// @throws io::Error as motions::BoundConstraints
	Fit( Follower& follower, const io::Problem& problem, const Task& task, const Settings& settings, lw_query* query );

	/// Follows a run from q, which is on it, and moves q to its end. @param out pieces appended
	/// @return false: stop() says why
	bool run( const Run& run, const Wish& wish, State& q, std::vector<Piece>& out );
	const Stop& stop() const { return m_stop; }
	/// Is the state proved free? @return false: stop() says why
	bool isFree( const Leg& leg, std::uint32_t place, const State& q );
	std::uint64_t windows() const { return m_windows; }
	std::uint64_t states() const { return m_states; }

private:
	bool follow( const Run& run, const Wish& wish, const State& q );
	bool step( const Run& run, std::size_t number, const Wish& wish, std::uint32_t to );
	void takeRates( const Run& run );
	bool prove( const Leg& leg, const Knot& a, const Knot& b, std::vector<Piece>& out );
	bool isNear( const Leg& leg, Piece& piece );
	bool isWithin( const Leg& leg, lw_region* region, const Course& course, Piece& piece );
	bool isClear( const Leg& leg, const Piece& piece );
	bool isKept( const Leg& leg, const Piece& piece );
	bool fail( const Leg& leg, Obstacle obstacle, std::uint32_t place, const State& q, std::size_t variable );

	Follower& m_follower;
	const io::Problem& m_problem;
	const Settings& m_settings;
	lw_query* m_query;
	const motions::BoundConstraints m_constraints;
	std::vector<Knot> m_knots;
	std::vector<std::uint32_t> m_variables;
	std::vector<double> m_rest;
	Stop m_stop;
	std::uint64_t m_windows = 0, m_states = 0;
};

} // namespace leeway::lines
