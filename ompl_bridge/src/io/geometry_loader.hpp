// SPDX-License-Identifier: BSD-3-Clause
// Shapes that are neither mesh nor primitive: point clouds, octomaps, height maps, planes, sets of balls.
#pragma once

#include "io_internal.hpp"

namespace leeway::io::detail
{

/// Builds core shapes from the files and numbers that scenes bring; one line of the load report for each.
class GeometryLoader
{
public:
	using Place = ShapeLoader::Place;

	GeometryLoader( const LoadOptions& options, LoadReport& report ) : m_options( options ), m_report( report ) {}

	/// @param radius metres, >= 0, of the ball around each point
	Shape pointCloud( const Place& place, const std::string& uri, double radius );

private:
	std::string find( const Place& place, const char* kind, const std::string& uri ) const;
	void notice( const Place& place, const std::string& text );
	/// Takes over `shape`, or says why there is none.
	Shape adopt( const Place& place, const std::string& source, const std::string& file, const Stopwatch& watch,
	    lw_status status, const lw_diag& diag, lw_shape* shape );

	const LoadOptions& m_options;
	LoadReport& m_report;
};

} // namespace leeway::io::detail
