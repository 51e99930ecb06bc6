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
	/// Appends the proof of a pair over a whole piece, beginning at `window`.
	/// @param hint a direction that separated them on the piece before, zero: none; on return one of this piece @throws Failure
	void prove( const Pair& pair, double min_d, Window& window, Vec& hint, std::string& out );
	/// Tests that were written, by spheres and by directions.
	std::size_t spheres = 0, directions = 0;

private:
	struct Task;
	void step( const Task& task, const Side& a, const Side& b, Window& window, Vec hint, double distance );
	void halveTime( const Task& task, const Side& a, const Side& b, Window& window, const Vec& direction );
	bool halvePart( const Task& task, const Side& a, const Side& b, Window& window, const Vec& direction, double distance );
	bool write( const Task& task, const Side& a, const Side& b, const Vec& direction, bool boxes );
	bool separate( const Task& task, const Side& a, const Side& b, bool boxes, bool hinted, Vec& direction, double& apart );
	double measured( const Task& task, const Window& window ) const;
	Side sideOf( const Task& task, const Side& old, std::size_t range, const Window& window ) const;

	const Motion& m_motion;
	lw_query* m_query;
	std::vector<const lw_shape*> m_bodies, m_obstacles;
};

} // namespace leeway::certify
