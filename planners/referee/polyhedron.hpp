// SPDX-License-Identifier: BSD-3-Clause
// A convex polyhedron of joint space: inner states, random states, the way to its boundary, boxes around it.
#pragma once

#include <cstddef>
#include <optional>
#include <random>
#include <vector>

namespace leeway::referee
{

using State = std::vector<double>;

/// Least and greatest value of each variable; may be infinite.
struct Box
{
	State lower, upper;
};

class Polyhedron
{
public:
	explicit Polyhedron( std::size_t variables ) : m_variables( variables ) {}

	/// States with a x <= b; the row is scaled to unit length. A row of zeros that holds says nothing.
	/// @return false: no state has it
	bool add( State a, double b );
	/// A state with all rows at or below 0, by some room if it has an inside. Relaxation of Agmon and Motzkin, Schoenberg, 1954.
	std::optional<State> inside() const;
	bool contains( const State& x, double room = 0 ) const;
	/// How far a state may go along a direction, at least 0.
	double reach( const State& x, const State& direction ) const;
	/// Takes the part away from a direction that leads out of faces on which the state lies.
	void alongFaces( const State& x, State& direction ) const;
	/// The next of a sequence of random states: uniform on a random line through the last, or at one of its ends.
	void step( State& x, std::mt19937_64& random, double at_ends ) const;
	/// Makes a box smaller that contains no fewer states of the polyhedron. @return false: it contains none
	bool tighten( Box& box ) const;

private:
	struct Row
	{
		State a;
		double b;
	};
	double excess( const Row& row, const State& x ) const;
	std::size_t m_variables;
	std::vector<Row> m_rows;
};

} // namespace leeway::referee
