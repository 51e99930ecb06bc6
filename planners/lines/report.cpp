// SPDX-License-Identifier: BSD-3-Clause
// Results of lines in words.
#include "leeway/lines/lines.hpp"

#include <fmt/format.h>

#include <cmath>

namespace leeway::lines
{
namespace
{

std::string pairOf( const Stop& stop )
{
	const std::string pair = fmt::format( "{} and {}", stop.pair.first, stop.pair.second );
	return stop.pair.first.empty() ? std::string( "a pair that is not known" ) : pair;
}

std::string reasonOf( const Stop& stop )
{
	switch ( stop.obstacle )
	{
	case Obstacle::UNREACHABLE:
		return "no state has this pose";
	case Obstacle::JOINT_LIMIT:
		return fmt::format( "joint {} is at its limit", stop.joint );
	case Obstacle::SINGULARITY:
		return fmt::format( "joint {} would have to jump: a singularity, or the end of the arm's reach", stop.joint );
	case Obstacle::COLLISION:
		return fmt::format( "{} come too near, {:.4g} m", pairOf( stop ), stop.pair.least() );
	case Obstacle::UNDECIDED:
		return stop.pair.first.empty() ? std::string( "the tolerance is too small for a proof" )
		                               : fmt::format( "{}: their clearance, {:.4g} m, is too near to --min-d for a proof",
		                                     pairOf( stop ), stop.pair.least() );
	case Obstacle::CONSTRAINT:
		return stop.constraint;
	case Obstacle::NONE:
		break;
	}
	return "no way was tried";
}

} // namespace

std::string describe( const io::Problem& problem, const Result& result )
{
	std::string text;
	if ( result.solved )
	{
		const Part& last = result.parts.back();
		text = fmt::format( "line: {} part(s), {} cubics, {:.3f} s, at attempt {}\n", last.part + 1, result.segments.size(),
		    last.begin + last.seconds, result.attempts );
		text += fmt::format( "proved at all times: each coordinate within {:.4f} mm, the angle within {:.4f} degrees\n",
		    1000 * result.position_error, result.angle_error * 180 / M_PI );
		return text;
	}
	const Stop& stop = result.stop;
	text = fmt::format(
	    "no line: of {} attempt(s) the best ends in part {} at {:.1f} % of its way, at ({:.4g}, {:.4g}, {:.4g}): {}\n",
	    result.attempts, stop.part + 1, 100 * stop.fraction, stop.position.x, stop.position.y, stop.position.z,
	    reasonOf( stop ) );
	for ( std::size_t i = 0; i < stop.q.size(); ++i )
	{
		text += fmt::format( "{}{}={:.6g}", i == 0 ? "state there: " : ",", problem.variable_names[i], stop.q[i] );
	}
	return text + ( stop.q.empty() ? "" : "\n" );
}

} // namespace leeway::lines
