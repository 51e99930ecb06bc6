// SPDX-License-Identifier: BSD-3-Clause
// Robots and things that move in one cell, for tests: tracks that own their arrays, evaluated by Bernstein polynomials.
#pragma once

#include "edge_auditor.hpp"
#include "leeway/clock.h"
#include "leeway/handles.hpp"
#include "random_robot.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

/// A polynomial of time that owns its control points.
struct OwnedPiece
{
	double start, end;
	unsigned degree;
	std::vector<double> points; ///< [degree + 1][variables]
};

/// A track that owns its arrays.
struct OwnedTrack
{
	std::vector<std::uint32_t> variables;
	std::vector<OwnedPiece> pieces;
	std::vector<double> tolerance; ///< empty or one each
	double lag = 0, spread_speed = 0, spread_start = 0;
	std::vector<lw_timed_piece> views;

	lw_track view()
	{
		views.clear();
		for ( const OwnedPiece& piece : pieces )
		{
			views.push_back( { piece.start, piece.end, piece.degree, piece.points.data() } );
		}
		lw_track track = {};
		track.variables = variables.data();
		track.variable_count = static_cast<std::uint32_t>( variables.size() );
		track.pieces = views.data();
		track.piece_count = static_cast<std::uint32_t>( views.size() );
		track.lag = lag;
		track.tolerance = tolerance.empty() ? nullptr : tolerance.data();
		track.spread_speed = spread_speed;
		track.spread_start = spread_start;
		return track;
	}

	/// Value of a variable at a time, at rest before, between and after the pieces.
	double at( std::size_t variable, double time ) const
	{
		const OwnedPiece* last = nullptr;
		for ( const OwnedPiece& piece : pieces )
		{
			last = piece.start <= time ? &piece : last;
		}
		if ( last == nullptr )
		{
			return pieces.front().points[variable];
		}
		const double u = std::min( 1.0, ( time - last->start ) / ( last->end - last->start ) );
		double value = 0;
		for ( unsigned i = 0; i <= last->degree; ++i )
		{
			double weight = std::pow( u, i ) * std::pow( 1 - u, last->degree - i );
			for ( unsigned k = 0; k < i; ++k )
			{
				weight *= static_cast<double>( last->degree - k ) / ( k + 1 );
			}
			value += weight * last->points[i * variables.size() + variable];
		}
		return value;
	}

	double spread( double time ) const { return spread_speed * std::max( 0.0, time - spread_start ); }
};

/// All tracks, as the core takes them.
struct OwnedClock
{
	std::vector<OwnedTrack> tracks;
	std::vector<double> rest; ///< of all variables of the group
	std::vector<lw_track> views;

	lw_clock view()
	{
		views.clear();
		for ( OwnedTrack& track : tracks )
		{
			views.push_back( track.view() );
		}
		lw_clock clock = {};
		clock.tracks = views.data();
		clock.track_count = static_cast<std::uint32_t>( views.size() );
		clock.rest = rest.data();
		return clock;
	}
};

/// A checker of all variables of a robot, and a query.
struct ClockBench
{
	leeway::Checker checker;
	leeway::Query query;

	ClockBench( const lw_robot* robot, const lw_scene* scene, bool tables )
	{
		lw_diag diag = {};
		leeway::Reach reach;
		if ( tables )
		{
			lw_reach_def def = lw_reach_def_default();
			def.robot = robot;
			def.seconds = 0.1;
			lw_reach* made = nullptr;
			leeway::require( lw_reach_create( &def, nullptr, &diag, &made ), diag );
			reach = leeway::Reach::adopt( made );
		}
		lw_checker_def def = lw_checker_def_default();
		def.robot = robot;
		def.scene = scene;
		def.reach = reach.get();
		lw_checker* made = nullptr;
		leeway::require( lw_checker_create( &def, nullptr, &diag, &made ), diag );
		checker = leeway::Checker::adopt( made );
		query = leeway::makeQuery( checker.get() );
	}

	lw_timed_result ask( OwnedClock& clock, double start, double end, const lw_timed_def& def ) const
	{
		const lw_clock view = clock.view();
		lw_diag diag = {};
		EXPECT_EQ( LW_OK, lw_clock_check( checker.get(), &view, &diag ) ) << diag.message;
		lw_timed_result result;
		EXPECT_EQ( LW_OK, lw_checker_timed( checker.get(), query.get(), &view, start, end, &def, &result ) );
		return result;
	}
};

/// A joint with one axis of the frame, wide limits.
inline void addJoint( RobotModel& model, const char* name, lw_joint_type type, std::uint32_t parent, int axis )
{
	lw_joint_def& joint = model.joint( name, type, parent );
	for ( int k = 0; k < 3; ++k )
	{
		joint.axis[k] = k == axis ? 1 : 0;
	}
	joint.lower = -20;
	joint.upper = 20;
}
