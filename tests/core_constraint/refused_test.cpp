// SPDX-License-Identifier: BSD-3-Clause
// Regions and timings that cannot be meant are refused by name; nothing is kept after an error.
#include "region_bench.hpp"

#include <cstring>
#include <functional>
#include <string>

namespace
{

RobotPtr rail()
{
	RobotModel model;
	model.link( "world" );
	addJoint( model, "rail", LW_JOINT_PRISMATIC, 0, 0 );
	addJoint( model, "free", LW_JOINT_FLOATING, 1, 0 );
	return model.create();
}

lw_region_def good()
{
	lw_region_def def = lw_region_def_default();
	def.link = 2;
	def.upper[0] = 1;
	return def;
}

OwnedClock still()
{
	OwnedClock clock = onePiece( 8, 0, { 0, 0, 0, 0, 0, 0, 0, 1 } );
	clock.rest[7] = 1;
	return clock;
}

} // namespace

TEST( RegionRefused, EachMistakeIsNamed )
{
	const RobotPtr robot = rail();
	const RegionBench bench( robot.get() );
	const struct
	{
		const char* words;
		std::function<void( lw_region_def& )> spoil;
	} cases[] = {
	    { "links 4294967295 and 3", []( lw_region_def& d ) { d.link = 3; } },
	    { "links 7 and 2", []( lw_region_def& d ) { d.base_link = 7; } },
	    { "no finite pose", []( lw_region_def& d ) { d.start.t[1] = NAN; } },
	    { "no finite pose", []( lw_region_def& d ) { d.link_from_b.r[0][0] = 2; } },
	    { "no finite pose", []( lw_region_def& d ) { d.base_from_a.r[0][0] = INFINITY; } },
	    { "not finite", []( lw_region_def& d ) { d.shift.x = INFINITY; } },
	    { "not finite", []( lw_region_def& d ) { d.arc.y = NAN; } },
	    { "no length",
	        []( lw_region_def& d ) {
		        d.axis = { 0, 0, 0 };
	        } },
	    { "position error y", []( lw_region_def& d ) { d.lower[1] = d.upper[1] = 0; } },
	    { "position error z", []( lw_region_def& d ) { d.lower[2] = 1, d.upper[2] = -1; } },
	    { "position error x", []( lw_region_def& d ) { d.upper[0] = NAN; } },
	    { "angle: a limit of 0", []( lw_region_def& d ) { d.angle = 0; } },
	    { "angle", []( lw_region_def& d ) { d.angle = NAN; } },
	    { "tilt: a limit of -1", []( lw_region_def& d ) { d.tilt = -1; } },
	    { "turn y", []( lw_region_def& d ) { d.turns[1] = 0; } },
	    { "kind of angles", []( lw_region_def& d ) { d.turns_are = static_cast<lw_turns>( 2 ); } },
	    { "limits nothing", []( lw_region_def& d ) { d.upper[0] = INFINITY; } },
	};
	for ( const auto& wrong : cases )
	{
		lw_region_def def = good();
		wrong.spoil( def );
		lw_diag diag = {};
		lw_region* region = nullptr;
		EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_region_create( bench.clock.checker.get(), &def, nullptr, &diag, &region ) )
		    << wrong.words;
		EXPECT_EQ( nullptr, region );
		EXPECT_NE( std::string::npos, std::string( diag.message ).find( wrong.words ) ) << diag.message;
	}
	lw_region_def def = good();
	def.cookie = 0;
	lw_region* region = nullptr;
	EXPECT_EQ( LW_ERROR_INVALID_DEF, lw_region_create( bench.clock.checker.get(), &def, nullptr, nullptr, &region ) );
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_region_create( nullptr, &def, nullptr, nullptr, nullptr ) );
}

TEST( RegionRefused, LinesAndArcsWithoutAWay )
{
	lw_region_def def = lw_region_def_default(), before = def;
	lw_transform from = lw_transform_identity(), to = from;
	to.t[0] = 1;
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_region_arc( &def, &from, { 0.5, 0, 0 }, &to ) ); // on one line
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_region_arc( &def, &from, { 0.5, 0.5, 0 }, &from ) );
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_region_arc( &def, &from, { 1, 0, 0 }, &to ) );
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_region_arc( &def, &from, { 0.5, NAN, 0 }, &to ) );
	to.t[0] = NAN;
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_region_line( &def, &from, &to ) );
	EXPECT_EQ( 0, std::memcmp( &def, &before, sizeof( def ) ) );
}

TEST( RegionRefused, ClocksAndTimingsThatBlurTheReference )
{
	const RobotPtr robot = rail();
	const RegionBench bench( robot.get() );
	const RegionPtr region = bench.region( good() );
	lw_region_result r;
	const auto ask = [&]( OwnedClock clock, const OwnedTrack& timing, double start, double end )
	{
		OwnedTrack copy = timing;
		const lw_clock view = clock.view();
		const lw_track fraction = copy.view();
		const lw_status status = lw_region_timed( region.get(), &view, &fraction, start, end, &r );
		EXPECT_EQ( status == LW_OK, r.verdict != LW_VERDICT_UNKNOWN );
		return status;
	};
	const OwnedTrack timing = fractionOf( 1, { 0, 1 } );
	EXPECT_EQ( LW_OK, ask( still(), timing, 0, 1 ) );
	EXPECT_EQ( LW_VERDICT_FREE, r.verdict );
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, ask( still(), timing, 1, 0 ) );
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, ask( still(), timing, 0, INFINITY ) );
	OwnedTrack spoiled = timing;
	spoiled.lag = 0.1;
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, ask( still(), spoiled, 0, 1 ) );
	spoiled = timing;
	spoiled.tolerance = { 0 };
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, ask( still(), spoiled, 0, 1 ) );
	spoiled = timing;
	spoiled.pieces[0].points[1] = NAN;
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, ask( still(), spoiled, 0, 1 ) );
	spoiled = timing;
	spoiled.pieces[0].end = 0;
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, ask( still(), spoiled, 0, 1 ) );
	spoiled = timing;
	spoiled.pieces.push_back( { 0.5, 2, 1, { 1, 1 } } );
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, ask( still(), spoiled, 0, 1 ) );
	OwnedClock zero = still();
	zero.tracks[0].pieces[0].points[7] = 0; // a quaternion of no length
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, ask( zero, timing, 0, 1 ) );
	OwnedClock spread = still();
	spread.tracks[0].spread_speed = 1;
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, ask( spread, timing, 0, 1 ) );
	lw_region_errors e;
	const double q[8] = { 0, 0, 0, 0, 0, 0, 0, 0 };
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_region_state( region.get(), q, 0, &e ) );
	const double good_q[8] = { 0, 0, 0, 0, 0, 0, 0, 2 };
	EXPECT_EQ( LW_OK, lw_region_state( region.get(), good_q, 0, &e ) );
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_region_state( region.get(), good_q, NAN, &e ) );
}
