// SPDX-License-Identifier: BSD-3-Clause
// The search for windows of one pair: a word for each step, in the order in which a checker reads them.
#pragma once

#include "certify/window.hpp"

#include <string>

namespace leeway::certify
{

/// Words of a proof; values are those of the file.
enum class Word : std::uint8_t
{
	halve_time = 0,
	spheres = 1,
	plane8 = 2,  ///< a direction of three numbers of 8 bits
	plane16 = 3, ///< 16
	plane32 = 4, ///< 32
	halve_a = 5,
	halve_b = 6
};

/// Why a pair cannot be proved.
struct Failure
{
	std::string why;
	double time; ///< on the piece
};

class Search
{
public:
	Search( const Motion& motion, lw_query* query, std::vector<const lw_shape*> core_bodies,
	    std::vector<const lw_shape*> core_obstacles )
	    : m_motion( motion ), m_query( query ), m_bodies( std::move( core_bodies ) ),
	      m_obstacles( std::move( core_obstacles ) )
	{
	}
	/// Appends the proof of a pair over a whole piece, beginning at `window`. @throws Failure
	void prove( const Model& model, const Pair& pair, Window& window, std::string& out );
	/// Tests that were written.
	std::size_t windows() const { return m_windows; }

private:
	struct Task;
	void step( const Task& task, Part a, Part b, Window& window, Vec hint, double distance );
	bool write( const Task& task, const Part& a, const Part& b, const Window& window, const Vec& direction );
	double measured( const Task& task, const Window& window ) const;

	const Motion& m_motion;
	lw_query* m_query;
	std::vector<const lw_shape*> m_bodies, m_obstacles;
	std::size_t m_windows = 0;
};

} // namespace leeway::certify
