// SPDX-License-Identifier: BSD-3-Clause
// Faults of frames and of memory: each has its answer, and none loses an obstacle in silence.
#include "cloud_bench.hpp"
#include "counting_allocator.hpp"

#include <limits>

namespace
{

constexpr double NOT_A_NUMBER = std::numeric_limits<double>::quiet_NaN();

/// A camera that sees a wall behind all voxels: it clears all in front of it.
struct Wall : DepthFrame
{
	explicit Wall( double stamp, const Point& eye = { -0.5, 0, 0 } )
	    : DepthFrame( stamp, lookAt( eye, { 5, 0, 0 } ), 320, 240, 250 )
	{
		fill( 2 );
	}
};

const Point OBSTACLE = { 0.525, 0.025, 0.025 };

lw_status insertStatus( lw_cloud* cloud, const lw_cloud_frame& frame )
{
	lw_diag diag = {};
	const lw_status status = lw_cloud_insert( cloud, &frame, &diag, nullptr );
	EXPECT_TRUE( status == LW_OK || diag.message[0] != '\0' );
	return status;
}

} // namespace

TEST( CloudFaults, ALateFrameIsTaken )
{
	const CloudPtr cloud = makeCloud( cloudOf( 0.05, 2 ) );
	hit( cloud.get(), 10, { OBSTACLE } );
	for ( const double stamp : { 10.0, 9.999, -5.0 } )
	{
		const Wall frame( stamp );
		EXPECT_EQ( LW_ERROR_STALE, insertStatus( cloud.get(), frame.frame ) );
	}
	EXPECT_EQ( stateAt( cloud.get(), OBSTACLE ), LW_VOXEL_OCCUPIED );
	const lw_cloud_info info = lw_cloud_get_info( cloud.get() );
	EXPECT_EQ( info.late, 3u );
	EXPECT_EQ( info.frames, 1u );
	EXPECT_EQ( info.last_stamp, 10 );
	Wall other( 9.5 );
	other.frame.sensor = 7;
	EXPECT_EQ( LW_OK, insertStatus( cloud.get(), other.frame ) ) << "each sensor has its own order";
	EXPECT_EQ( stateAt( cloud.get(), OBSTACLE ), LW_VOXEL_OCCUPIED ) << "the ray is older than the hit";
}

TEST( CloudFaults, AnEmptyFrameClears )
{
	const CloudPtr cloud = makeCloud( cloudOf( 0.05, 2 ) );
	hit( cloud.get(), 1, { OBSTACLE } );
	PointFrame none( 2, {} );
	EXPECT_EQ( insert( cloud.get(), none.frame ).cleared, 0u );
	lw_cloud_frame nothing = lw_cloud_frame_default();
	nothing.stamp = 3;
	EXPECT_EQ( insert( cloud.get(), nothing ).cleared, 0u );
	double stamp = 4;
	for ( const double depth :
	    { 0.0, -1.0, NOT_A_NUMBER, static_cast<double>( INFINITY ), -static_cast<double>( INFINITY ) } )
	{
		Wall blind( stamp );
		blind.fill( depth );
		const lw_cloud_report report = insert( cloud.get(), blind.frame );
		EXPECT_EQ( report.not_measured, 320u * 240 ) << depth;
		EXPECT_EQ( report.cleared, 0u ) << depth;
		stamp += 1;
	}
	EXPECT_EQ( stateAt( cloud.get(), OBSTACLE ), LW_VOXEL_OCCUPIED );
}

/// A few bad pixels: their own rays say nothing, and nothing near them is cleared.
TEST( CloudFaults, APixelThatIsNotMeasuredClears )
{
	for ( const float bad : { 0.0f, std::numeric_limits<float>::quiet_NaN(), -1.0f } )
	{
		const CloudPtr cloud = makeCloud( cloudOf( 0.05, 2 ) );
		hit( cloud.get(), 1, { OBSTACLE } );
		Wall frame( 2 );
		frame.at( 160, 120 ) = bad;
		const lw_cloud_report report = insert( cloud.get(), frame.frame );
		EXPECT_EQ( report.cleared, 0u );
		EXPECT_EQ( report.not_measured, 1u );
		Wall good( 3 );
		EXPECT_EQ( insert( cloud.get(), good.frame ).cleared, 1u );
	}
}

TEST( CloudFaults, PointsThatAreNotNumbersAreInserted )
{
	const CloudPtr cloud = makeCloud( cloudOf( 0.05, 2 ) );
	const PointFrame frame(
	    1, { OBSTACLE, { NOT_A_NUMBER, 0, 0 }, { 0, INFINITY, 0 }, { 0, 0, NOT_A_NUMBER }, { 1e300, 0, 0 } } );
	const lw_cloud_report report = insert( cloud.get(), frame.frame );
	EXPECT_EQ( report.inserted, 1u );
	EXPECT_EQ( report.not_measured, 3u );
	EXPECT_EQ( report.out_of_range + report.outside, 1u );
}

TEST( CloudFaults, ARangeIsIgnored )
{
	const CloudPtr cloud = makeCloud( cloudOf( 0.05, 2 ) );
	PointFrame frame( 1, { { 0.11, 0, 0 }, { 0.51, 0, 0 }, { 1.51, 0, 0 } } );
	frame.frame.near = 0.3;
	frame.frame.far = 1;
	const lw_cloud_report report = insert( cloud.get(), frame.frame );
	EXPECT_EQ( report.inserted, 1u );
	EXPECT_EQ( report.out_of_range, 2u );
	EXPECT_EQ( stateAt( cloud.get(), { 0.51, 0, 0 } ), LW_VOXEL_OCCUPIED );
}

TEST( CloudFaults, ACameraThatJumpedIsTrusted )
{
	lw_cloud_def def = cloudOf( 0.05, 2 );
	def.jump_distance = 0.2;
	def.jump_angle = 0.5;
	const CloudPtr cloud = makeCloud( def );
	const Wall first( 1, { -0.5, 0, 0 } );
	insert( cloud.get(), first.frame );
	const PointFrame turned( 2, { OBSTACLE }, { -0.5, 0, 0 } );
	insert( cloud.get(), turned.frame, LW_ERROR_STALE );
	EXPECT_EQ( lw_cloud_get_info( cloud.get() ).jumped, 1u );
	lw_cloud_allow_jump( cloud.get(), 0 );
	hit( cloud.get(), 3, { OBSTACLE }, { -0.5, 0, 0 } );
	const Wall elsewhere( 4, { -0.5, 0.3, 0 } );
	EXPECT_EQ( LW_ERROR_STALE, insertStatus( cloud.get(), elsewhere.frame ) );
	EXPECT_EQ( LW_ERROR_STALE, insertStatus( cloud.get(), elsewhere.frame ) ) << "a second frame from there is no better";
	EXPECT_EQ( stateAt( cloud.get(), OBSTACLE ), LW_VOXEL_OCCUPIED );
	lw_cloud_frame back = lw_cloud_frame_default();
	back.stamp = 5;
	back.world_from_sensor.t[0] = -0.5;
	EXPECT_EQ( LW_OK, insertStatus( cloud.get(), back ) ) << "a sensor that is back is taken";
	lw_cloud_allow_jump( cloud.get(), 0 );
	const Wall later( 6, { -0.5, 0.3, 0 } );
	EXPECT_EQ( insert( cloud.get(), later.frame ).cleared, 1u );
}

TEST( CloudFaults, AJumpIsMeasuredWrongly )
{
	lw_cloud_def def = cloudOf( 0.05, 2 );
	def.jump_angle = 0.3;
	const CloudPtr cloud = makeCloud( def );
	lw_cloud_frame frame = lw_cloud_frame_default();
	const double zero[3] = { 0, 0, 0 };
	double stamp = 0;
	for ( const double turn : { 0.29, 0.31, 3.1415926 } )
	{
		const double rpy[3] = { 0, 0, turn };
		lw_cloud_allow_jump( cloud.get(), 0 );
		frame.world_from_sensor = lw_transform_identity();
		frame.stamp = ++stamp;
		EXPECT_EQ( LW_OK, insertStatus( cloud.get(), frame ) );
		EXPECT_EQ( LW_OK, lw_transform_from_rpy( zero, rpy, &frame.world_from_sensor ) );
		frame.stamp = ++stamp;
		EXPECT_EQ( turn < 0.3 ? LW_OK : LW_ERROR_STALE, insertStatus( cloud.get(), frame ) ) << turn;
	}
}

TEST( CloudFaults, AnImpossibleFrameChangesSomething )
{
	const CloudPtr cloud = makeCloud( cloudOf( 0.05, 2 ) );
	hit( cloud.get(), 1, { OBSTACLE } );
	const Wall good( 2 );
	const PointFrame points( 2, { OBSTACLE } );
	std::vector<lw_cloud_frame> bad( 12, good.frame );
	bad[0].world_from_sensor.r[0][0] = 2;
	bad[1].world_from_sensor.t[1] = NOT_A_NUMBER;
	bad[2].stamp = NOT_A_NUMBER;
	bad[3].sensor = LW_CLOUD_SENSORS;
	bad[4].near = 3;
	bad[4].far = 2;
	bad[5].depth.fx = 0;
	bad[6].depth.row_step = 10;
	bad[7].points = points.frame.points;
	bad[8].trust_far = true; // with no limit
	bad[9] = points.frame;
	bad[9].points.offset[2] = 17;
	bad[10].depth.scale = NOT_A_NUMBER;
	bad[11].near = -1;
	for ( std::size_t i = 0; i < bad.size(); ++i )
	{
		EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, insertStatus( cloud.get(), bad[i] ) ) << i;
	}
	EXPECT_EQ( LW_ERROR_INVALID_DEF, insertStatus( cloud.get(), lw_cloud_frame{} ) );
	EXPECT_EQ( lw_cloud_get_info( cloud.get() ).frames, 1u );
	EXPECT_EQ( stateAt( cloud.get(), OBSTACLE ), LW_VOXEL_OCCUPIED );
	EXPECT_EQ( LW_OK, insertStatus( cloud.get(), good.frame ) ) << "the stamp was not used up";
}

TEST( CloudFaults, AnImpossibleDefIsTaken )
{
	std::vector<lw_cloud_def> bad( 9, lw_cloud_def_default() );
	bad[0].resolution = 0;
	bad[1].box_max[1] = bad[1].box_min[1];
	bad[2].box_min[0] = -INFINITY;
	bad[3].resolution = 1e-4;
	bad[3].box_max[0] = bad[3].box_max[1] = bad[3].box_max[2] = 2000;
	bad[4].shadow = -1;
	bad[5].sensor_error = NOT_A_NUMBER;
	bad[6].jump_distance = NOT_A_NUMBER;
	bad[7].most_blocks = 0;
	bad[8].clear_margin = -0.1;
	for ( const lw_cloud_def& def : bad )
	{
		lw_cloud* cloud = nullptr;
		lw_diag diag = {};
		EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_cloud_create( &def, nullptr, &diag, &cloud ) );
		EXPECT_EQ( cloud, nullptr );
		EXPECT_NE( diag.message[0], '\0' );
	}
}

/// A cloud that has lost points says so: to the frame, in its counts, and to those who want a scene.
TEST( CloudFaults, AFullCloudForgetsInSilence )
{
	lw_cloud_def def = cloudOf( 0.05, 2 );
	def.most_blocks = 2;
	const CloudPtr cloud = makeCloud( def );
	hit( cloud.get(), 1, { { 0.5, 0.02, 0.02 }, { -0.5, 0.02, 0.02 } } );
	PointFrame frame( 2, { { 0.5, 1.02, 0.02 }, { 0.52, 0.06, 0.02 } } );
	frame.frame.clears = false;
	const lw_cloud_report report = insert( cloud.get(), frame.frame, LW_ERROR_OUT_OF_MEMORY );
	EXPECT_EQ( report.lost, 1u );
	EXPECT_EQ( report.inserted, 1u );
	EXPECT_FALSE( lw_cloud_get_info( cloud.get() ).complete );
	lw_scene* scene = nullptr;
	EXPECT_EQ( LW_ERROR_STALE, lw_cloud_scene( cloud.get(), nullptr, "cloud", nullptr, &scene ) );
	EXPECT_EQ( scene, nullptr );
	const double low[3] = { -2, -2, -2 }, high[3] = { 2, 2, 2 };
	EXPECT_EQ( LW_OK, lw_cloud_set_box( cloud.get(), low, high, LW_VOXEL_FREE, nullptr ) );
	EXPECT_FALSE( lw_cloud_get_info( cloud.get() ).complete ) << "there is room again, but the point is still lost";
	lw_cloud_clear( cloud.get() );
	EXPECT_EQ( LW_OK, lw_cloud_scene( cloud.get(), nullptr, "cloud", nullptr, &scene ) );
	lw_scene_release( scene );
}

/// Without room for the free parts of a block it stays unseen, which is blocked.
TEST( CloudFaults, AFullCloudUncoversTooMuch )
{
	lw_cloud_def def = cloudOf( 0.05, 1 );
	def.unseen_blocked = true;
	def.most_blocks = 1;
	const CloudPtr cloud = makeCloud( def );
	Wall frame( 1 );
	const lw_cloud_report report = insert( cloud.get(), frame.frame );
	EXPECT_EQ( report.lost, 0u );
	EXPECT_EQ( lw_cloud_voxels( cloud.get(), LW_VOXEL_FREE, nullptr, 0 ), report.uncovered );
	EXPECT_TRUE( lw_cloud_get_info( cloud.get() ).complete );
}

/// Each allocation fails once: nothing leaks, and a point is inserted or reported.
TEST( CloudFaults, MemoryIsLeakedOrPointsAreLostInSilence )
{
	bool done = false;
	for ( std::size_t fail_at = 1; !done; ++fail_at )
	{
		FailingAllocator failing;
		failing.fail_at = fail_at;
		lw_cloud_def def = cloudOf( 0.05, 1 );
		def.unseen_blocked = fail_at % 2 == 0;
		lw_cloud* made = nullptr;
		const lw_status created = lw_cloud_create( &def, &failing.allocator, nullptr, &made );
		EXPECT_TRUE( created == LW_OK || created == LW_ERROR_OUT_OF_MEMORY );
		const CloudPtr cloud( made );
		if ( created == LW_OK )
		{
			const PointFrame frame( 1, { { 0.5, 0.02, 0.02 }, { -0.5, 0.02, 0.02 }, { 0.5, 0.52, 0.02 } } );
			lw_cloud_report report = {};
			const lw_status inserted = lw_cloud_insert( cloud.get(), &frame.frame, nullptr, &report );
			const bool taken = inserted == LW_OK || report.lost > 0;
			EXPECT_TRUE( inserted == LW_OK || inserted == LW_ERROR_OUT_OF_MEMORY );
			EXPECT_EQ( report.inserted + report.lost, taken ? 3u : 0u );
			EXPECT_EQ( lw_cloud_get_info( cloud.get() ).complete, report.lost == 0 );
			lw_scene* scene = nullptr;
			const lw_status scened = lw_cloud_scene( cloud.get(), nullptr, "cloud", nullptr, &scene );
			EXPECT_EQ( scened == LW_OK, scene != nullptr );
			done = inserted == LW_OK && scened == LW_OK && failing.calls < fail_at;
			lw_scene_release( scene );
		}
	}
}
