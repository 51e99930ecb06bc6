// SPDX-License-Identifier: BSD-3-Clause
// A checker of all variables of a robot, and regions on it.
#pragma once

#include "clock_world.hpp"
#include "leeway/constraint.h"

using RegionPtr = leeway::RegionHandle;

inline lw_vec3 randomVector( SeededRng& rng, double size )
{
	return { rng.uniform( -size, size ), rng.uniform( -size, size ), rng.uniform( -size, size ) };
}

struct RegionBench
{
	ClockBench clock;

	explicit RegionBench( const lw_robot* robot ) : clock( robot, nullptr, false ) {}

	RegionPtr region( const lw_region_def& def ) const
	{
		lw_region* made = nullptr;
		lw_diag diag = {};
		EXPECT_EQ( LW_OK, lw_region_create( clock.checker.get(), &def, nullptr, &diag, &made ) ) << diag.message;
		return RegionPtr( made );
	}

	/// @param timing without pieces: none
	lw_region_result ask( const lw_region_def& def, OwnedClock& tracks, OwnedTrack timing, double start, double end ) const
	{
		const RegionPtr made = region( def );
		const lw_clock view = tracks.view();
		lw_diag diag = {};
		EXPECT_EQ( LW_OK, lw_clock_check( clock.checker.get(), &view, &diag ) ) << diag.message;
		timing.variables = { 0 };
		const lw_track fraction = timing.view();
		lw_region_result result;
		EXPECT_EQ(
		    LW_OK, lw_region_timed( made.get(), &view, timing.pieces.empty() ? nullptr : &fraction, start, end, &result ) );
		return result;
	}
};

/// A track of all variables of a robot, with one piece.
inline OwnedClock onePiece( std::uint32_t variables, unsigned degree, std::vector<double> points )
{
	OwnedClock clock;
	clock.rest.assign( variables, 0 );
	OwnedTrack track;
	for ( std::uint32_t i = 0; i < variables; ++i )
	{
		track.variables.push_back( i );
	}
	track.pieces = { { 0, 1, degree, std::move( points ) } };
	clock.tracks = { track };
	return clock;
}

inline OwnedTrack fractionOf( unsigned degree, std::vector<double> points )
{
	OwnedTrack track;
	track.variables = { 0 };
	track.pieces = { { 0, 1, degree, std::move( points ) } };
	return track;
}
