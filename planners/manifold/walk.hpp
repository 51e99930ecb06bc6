// SPDX-License-Identifier: BSD-3-Clause
// Motions that keep constraints, piece by piece: straight where that is proved, else cubics along the manifold.
#pragma once

#include "leeway/manifold/manifold.hpp"

#include <Eigen/Core>

#include <cmath>
#include <cstdint>
#include <vector>

namespace leeway::manifold
{

using State = Eigen::VectorXd;

/// A motion: a Bezier curve of the group's variables, of degree 1 or 3. Angles go on without wrapping.
struct Piece
{
	unsigned degree = 1;
	/// To keep the constraints and clearances. Else it is a chord, in whose place Walker::prove() finds a motion.
	bool proved = false;
	std::vector<double> points; ///< [degree + 1][variables]

	std::size_t variables() const { return points.size() / ( degree + 1 ); }
	Eigen::Map<const State> control( std::size_t i ) const
	{
		return { points.data() + i * variables(), static_cast<Eigen::Index>( variables() ) };
	}
	State first() const { return control( 0 ); }
	State last() const { return control( degree ); }
	State at( double t ) const;
	/// Control points of the part between two parameters.
	Piece part( double from, double to ) const;
	/// Length, from a chain of points on it; found once.
	double length() const;
	void reverse();
	void shift( const State& by );

private:
	mutable double m_length = -1; ///< below 0: not known
};

Piece straightPiece( const State& a, const State& b );
/// @param from, to derivatives at the ends
Piece cubicPiece( const State& a, const State& from, const State& b, const State& to );

double lengthOf( const std::vector<Piece>& pieces );

/// Work of a Walker.
struct WalkCounts
{
	std::uint64_t proofs = 0, proved = 0;  ///< of pieces
	std::uint64_t bent = 0;                ///< of these proved, cubics
	std::uint64_t states = 0, queries = 0; ///< tested; by proofs of clearances
	std::uint64_t projections = 0;
};

constexpr double least_step = 0.01; ///< radians or metres, in joint space

/// How far a walk goes, and when it gives up.
struct Reach
{
	double most = HUGE_VAL;    ///< length of the way
	double least = least_step; ///< steps that fail are halved down to this
	bool whole = false;        ///< ends as soon as the end is farther away than the rest of `most`
	bool proofs_wait = false;  ///< chords that seem clear stand for motions; Walker::prove() comes later
};

class Walker
{
public:
	/// All have to outlive it.
	Walker( Manifold& manifold, const io::Problem& problem, const lw_edge_def& edge, lw_query* query );

	/// Goes from a towards b. Angles that wrap go the shorter way.
	/// @param a keeps the constraints, and so does b if it is to be reached
	/// @param out pieces, appended; the first begins at a
	/// @return true: the last piece ends at b, up to whole turns of angles that wrap
	bool walk( const State& a, const State& b, const Reach& reach, std::vector<Piece>& out );
	/// Proved pieces in place of chords. @return false: there are none for one of them, and `way` is as before
	bool prove( std::vector<Piece>& way );
	/// Proves constraints and clearances of a motion.
	bool isProved( const Piece& piece ) { return isKept( piece ) && isClear( piece ); }
	/// Only clearances.
	bool isClear( const Piece& piece );
	bool isFree( const State& q );
	/// b, with wrapping angles in the turns that are nearest to a.
	State nearestTurns( const State& a, const State& b ) const;
	/// [variables]: 2 pi of angles that wrap, else 0.
	const State& turns() const { return m_turns; }
	const WalkCounts& counts() const { return m_counts; }

private:
	/// Where a walk is.
	struct Front
	{
		State at;
		double length; ///< of the next step
		double left;   ///< of the way
		bool stuck;    ///< halves of the last step would be too short
	};

	bool isKept( const Piece& piece );
	bool isWithin( const Piece& piece ) const;
	bool take( Piece& piece, std::vector<Piece>& out );
	void addChord( const State& a, const State& b, std::vector<Piece>& out );
	std::size_t look( std::size_t count, std::size_t end );
	void forgetChords();
	bool takeChord( const Piece& chord, std::vector<Piece>& out );
	bool leadsAlong( const State& a, const State& b );
	bool join( const State& a, const State& b, int halvings, std::vector<Piece>& out );
	bool advance( Front& front, const State& to, const Reach& reach, std::vector<Piece>& out );
	static void goBack( Front& front, double least, std::size_t from, std::vector<Piece>& out );
	bool step( const State& q, const State& to, double length, State& next );

	Manifold& m_manifold;
	const io::Problem& m_problem;
	const lw_edge_def& m_edge;
	lw_query* m_query;
	State m_turns, m_lower, m_upper;
	// states of chords that wait for a look
	std::vector<double> m_states;      ///< [count][variables]
	std::vector<std::size_t> m_chords; ///< [count] their places in the way
	std::vector<lw_verdict> m_seen;
	std::vector<lw_check_flags> m_open;
	WalkCounts m_counts;
};

} // namespace leeway::manifold
