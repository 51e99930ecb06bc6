// SPDX-License-Identifier: BSD-3-Clause
// The way of a task as references: lines and arcs, with rounded corners between those at which the frame does not rest.
//
// A run goes from rest to rest. Its parameter u goes from 0 to 1 over its time, whatever that will be. Places are whole numbers of
// 1 / most_places of u, so that their times can be whole nanoseconds.
#pragma once

#include "ik/rotation.hpp"
#include "leeway/handles.hpp"
#include "leeway/lines/lines.hpp"

#include <vector>

namespace leeway::lines
{

/// @throws io::Error about a task, always
[[noreturn]] void wrong( const std::string& element, const std::string& problem, const std::string& remedy );
double length( const lw_vec3& v );

constexpr std::uint32_t most_places = 1 << 16;

/// Place as u.
inline double parameter( std::uint32_t place )
{
	return static_cast<double>( place ) / most_places;
}

/// A fraction that goes from 0 to 1 over places: a cubic.
struct Course
{
	std::uint32_t from = 0, to = most_places;
	double first = 0, last = 0; ///< its speed at both ends, for each unit of these places

	double width() const { return parameter( to - from ); }
	double at( std::uint32_t place ) const;
	double flow( std::uint32_t place ) const; ///< for each unit of u
	double mostFlow() const;
	/// Control points of the part between two places.
	void points( std::uint32_t begin, std::uint32_t end, double out[4] ) const;
};

/// A line or an arc. Behind and before a rounded corner the axes turn at a pace of their own, which the line does not share.
struct Leg
{
	lw_region_def def = lw_region_def_default();
	RegionHandle region;
	Course course;
	bool turns_apart = false; ///< `turning` is the reference of the axes, `def` that of the place alone
	lw_region_def turning = lw_region_def_default();
	RegionHandle turning_region;
	Course turning_course;
	double length = 0;                 ///< metres, of the tip's way
	double run_from = 0, run_to = 1;   ///< shares of the run's length; of a turn in place, of its angle
	std::uint32_t states = 0;          ///< intervals between the first states
	std::size_t part = 0;              ///< of the task's way
	double part_from = 0, part_to = 1; ///< shares of that part's length

	std::uint32_t place( std::uint32_t state ) const
	{
		return course.from + static_cast<std::uint32_t>( std::uint64_t( course.to - course.from ) * state / states );
	}
	/// The reference at a place.
	ik::Pose pose( std::uint32_t place ) const;
	/// Its motion, for a change of both fractions.
	struct Motion
	{
		ik::Vector3d linear, angular;
	};
	Motion motion( std::uint32_t place, double fraction, double turn ) const;
	Motion flow( std::uint32_t place ) const { return motion( place, course.flow( place ), turningOf().flow( place ) ); }
	const Course& turningOf() const { return turns_apart ? turning_course : course; }
	/// The share of the run's length at a place, and its speed for each unit of u.
	double share( std::uint32_t place ) const { return run_from + ( run_to - run_from ) * course.at( place ); }
	double shareFlow( std::uint32_t place ) const { return ( run_to - run_from ) * course.flow( place ); }
};

/// Legs from rest to rest.
struct Run
{
	std::vector<Leg> legs;
	double length = 0; ///< metres; of a turn in place radians
};

/// @param start where the frame is before the first waypoint, or the first waypoint
/// @throws io::Error (a waypoint or arc that is none, a radius that does not fit)
std::vector<Run> runsOf( const io::Problem& problem, const Task& task, const lw_transform& start );

} // namespace leeway::lines
