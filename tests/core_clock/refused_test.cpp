// SPDX-License-Identifier: BSD-3-Clause
// Clocks that cannot be meant: each is refused with the track and the remedy, by lw_clock_check() and by the proof.
#include "clock_world.hpp"
#include "simple_shapes.hpp"

#include <functional>
#include <gtest/gtest.h>
#include <string>

namespace
{

struct Rails
{
	RobotPtr robot;

	Rails()
	{
		RobotModel model;
		model.link( "world" );
		addJoint( model, "a", LW_JOINT_PRISMATIC, 0, 0 );
		addJoint( model, "b", LW_JOINT_REVOLUTE, 0, 1 );
		model.body( 1, primitive( LW_SHAPE_SPHERE, 0.1 ), lw_transform_identity() );
		robot = model.create();
	}
};

OwnedClock good()
{
	OwnedClock clock;
	clock.rest = { 0, 0 };
	OwnedTrack a, b;
	a.variables = { 0 };
	a.pieces = { { 0, 1, 1, { 0, 1 } }, { 1, 2, 1, { 1, 0 } } };
	b.variables = { 1 };
	b.pieces = { { 0, 1, 0, { 0.5 } } };
	clock.tracks = { a, b };
	return clock;
}

} // namespace

TEST( ClockRefused, EachMistakeIsNamed )
{
	const Rails rails;
	const ClockBench bench( rails.robot.get(), nullptr, false );
	const struct
	{
		const char* words;
		std::function<void( OwnedClock& )> spoil;
	} cases[] = {
	    { "backwards", []( OwnedClock& c ) { c.tracks[0].pieces[1].start = 0.5; } },
	    { "before it ends", []( OwnedClock& c ) { c.tracks[0].pieces[1].end = 1; } },
	    { "jump", []( OwnedClock& c ) { c.tracks[0].pieces[1].points[0] = 1.1; } },
	    { "not finite", []( OwnedClock& c ) { c.tracks[0].pieces[1].points[1] = NAN; } },
	    { "degree 8",
	        []( OwnedClock& c )
	        {
		        c.tracks[0].pieces[1].degree = 8;
		        c.tracks[0].pieces[1].points.assign( 9, 1.0 );
	        } },
	    { "both move variable 0", []( OwnedClock& c ) { c.tracks[1].variables = { 0 }; } },
	    { "the group has 2", []( OwnedClock& c ) { c.tracks[1].variables = { 2 }; } },
	    { "lag", []( OwnedClock& c ) { c.tracks[1].lag = -1; } },
	    { "spread", []( OwnedClock& c ) { c.tracks[1].spread_speed = INFINITY; } },
	    { "joint that shifts", []( OwnedClock& c ) { c.tracks[1].spread_speed = 1; } },
	    { "tolerance", []( OwnedClock& c ) { c.tracks[0].tolerance = { -1e-3 }; } },
	    { "no pieces", []( OwnedClock& c ) { c.tracks[0].pieces.clear(); } },
	    { "rest", []( OwnedClock& c ) { c.rest[1] = NAN; } },
	};
	for ( const auto& c : cases )
	{
		OwnedClock clock = good();
		c.spoil( clock );
		const lw_clock view = clock.view();
		lw_diag diag = {};
		EXPECT_EQ( lw_clock_check( bench.checker.get(), &view, &diag ), LW_ERROR_INVALID_ARGUMENT ) << c.words;
		EXPECT_NE( std::string( diag.message ).find( c.words ), std::string::npos ) << diag.message;
		const lw_timed_def def = lw_timed_def_default();
		lw_timed_result r;
		EXPECT_EQ(
		    lw_checker_timed( bench.checker.get(), bench.query.get(), &view, 0, 2, &def, &r ), LW_ERROR_INVALID_ARGUMENT )
		    << c.words;
		EXPECT_EQ( r.verdict, LW_VERDICT_UNKNOWN );
	}
}

TEST( ClockRefused, IntervalsAndSettings )
{
	const Rails rails;
	const ClockBench bench( rails.robot.get(), nullptr, false );
	OwnedClock clock = good();
	const lw_clock view = clock.view();
	const auto ask = [&]( double start, double end, const lw_timed_def& def )
	{
		lw_timed_result r;
		const lw_status status = lw_checker_timed( bench.checker.get(), bench.query.get(), &view, start, end, &def, &r );
		EXPECT_EQ( r.verdict == LW_VERDICT_UNKNOWN, status != LW_OK );
		return status;
	};
	const double e = 1;
	lw_timed_def def = lw_timed_def_default();
	EXPECT_EQ( ask( 0, 2, def ), LW_OK );
	EXPECT_EQ( ask( 1, 1, def ), LW_OK );
	EXPECT_EQ( ask( -10, 10, def ), LW_OK );
	EXPECT_EQ( ask( 2, 1, def ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( ask( 0, INFINITY, def ), LW_ERROR_INVALID_ARGUMENT );
	EXPECT_EQ( ask( NAN, 1, def ), LW_ERROR_INVALID_ARGUMENT );
	def.edge.tolerance = &e;
	EXPECT_EQ( ask( 0, 2, def ), LW_ERROR_INVALID_ARGUMENT );
	def = lw_timed_def_default();
	def.edge.method = LW_EDGE_STEPS;
	EXPECT_EQ( ask( 0, 2, def ), LW_ERROR_INVALID_ARGUMENT );
	def = lw_timed_def_default();
	def.contact_resolution = -1;
	EXPECT_EQ( ask( 0, 2, def ), LW_ERROR_INVALID_ARGUMENT );
	def = lw_timed_def_default();
	def.cookie = 0;
	EXPECT_EQ( ask( 0, 2, def ), LW_ERROR_INVALID_DEF );
}
