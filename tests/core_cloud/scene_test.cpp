// SPDX-License-Identifier: BSD-3-Clause
// Scenes of clouds: they contain every point, are no larger than stated, and share unchanged shapes.
#include "cloud_bench.hpp"
#include "one_obstacle.hpp"
#include "simple_shapes.hpp"

#include "checker/checker.h"
#include "checker/reuse.h"
#include "shape/shape.h"

#include <algorithm>
#include <map>

namespace
{

/// Distance of a point to all shapes of a scene.
double distanceTo( const lw_scene* scene, const Point& p, lw_query* query, const lw_shape* point )
{
	double nearest = INFINITY;
	const lw_transform pose = at( p[0], p[1], p[2] );
	for ( std::uint32_t i = 0; i < lw_scene_shape_count( scene ); ++i )
	{
		const lw_scene_shape_def def = lw_scene_shape( scene, i );
		lw_clearance d;
		EXPECT_EQ( LW_OK, lw_shape_distance( point, &pose, def.shape, &def.world_from_shape, nullptr, query, &d ) );
		nearest = std::min( nearest, d.upper );
	}
	return nearest;
}

leeway::Shape onePoint()
{
	const double zero[3] = { 0, 0, 0 };
	lw_shape* shape = nullptr;
	EXPECT_EQ( LW_OK, lw_shape_create_points( zero, 1, 0, nullptr, nullptr, nullptr, &shape ) );
	return leeway::Shape::adopt( shape );
}

/// Points on a few planes and balls, as sensors see them.
std::vector<Point> surface( SeededRng& rng, int count, double half )
{
	const Point normal = randomPoint( rng, 1 ), middle = randomPoint( rng, half );
	std::vector<Point> points;
	for ( int i = 0; i < count; ++i )
	{
		Point p = randomPoint( rng, half );
		double along = 0, length = 0;
		for ( std::size_t k = 0; k < 3; ++k )
		{
			along += ( p[k] - middle[k] ) * normal[k];
			length += normal[k] * normal[k];
		}
		for ( std::size_t k = 0; k < 3 && i % 10 != 0; ++k )
		{
			p[k] -= along / length * normal[k];
		}
		const bool inside = std::all_of( p.begin(), p.end(), [&]( double x ) { return std::abs( x ) < half; } );
		points.push_back( inside ? p : middle );
	}
	return points;
}

std::set<Point> centersOf( const lw_scene* scene )
{
	std::set<Point> centers;
	for ( std::uint32_t i = 0; i < lw_scene_shape_count( scene ); ++i )
	{
		const lw_shape* shape = lw_scene_shape( scene, i ).shape;
		const lw_shape_info info = lw_shape_get_info( shape );
		for ( std::uint32_t k = 0; info.type == LW_SHAPE_POINTS && k < info.vertex_count; ++k )
		{
			const double* v = lw_shape_vertices( shape ) + 3 * k;
			centers.insert( { v[0], v[1], v[2] } );
		}
	}
	return centers;
}

} // namespace

/// The claim: distance to the object <= distance to the points <= distance to the object + excess.
TEST( CloudScenes, ClearancesAreOutsideOfTheirInterval )
{
	SeededRng rng( 20261207 );
	const leeway::Query query = leeway::makeQuery( nullptr );
	const leeway::Shape point = onePoint();
	for ( int round = 0; round < 12; ++round )
	{
		lw_cloud_def def = cloudOf( rng.uniform( 0.005, 0.05 ), 1 );
		def.sensor_error = round % 2 == 0 ? 0 : rng.uniform( 0, 0.03 );
		const CloudPtr cloud = makeCloud( def );
		const std::vector<Point> points = surface( rng, 2000, 0.9 );
		hit( cloud.get(), 1, points );
		const leeway::Scene scene = sceneOf( cloud.get() );
		const lw_cloud_info info = lw_cloud_get_info( cloud.get() );
		EXPECT_NEAR( info.excess, std::sqrt( 3.0 ) * def.resolution + 2 * def.sensor_error, 1e-9 );
		for ( std::uint32_t i = 0; i < lw_scene_shape_count( scene.get() ); ++i )
		{
			lw_diag diag = {};
			EXPECT_EQ( LW_OK, lwi_shape_validate( lw_scene_shape( scene.get(), i ).shape, &diag ) ) << diag.message;
		}
		double largest = 0;
		for ( int i = 0; i < 300; ++i )
		{
			const Point q = randomPoint( rng, 1.2 );
			double truth = INFINITY;
			for ( const Point& p : points )
			{
				truth = std::min( truth, std::hypot( p[0] - q[0], p[1] - q[1], p[2] - q[2] ) );
			}
			const double d = distanceTo( scene.get(), q, query.get(), point.get() );
			ASSERT_LE( d, std::max( 0.0, truth - def.sensor_error ) + 1e-12 );
			ASSERT_LE( truth - def.sensor_error, d + info.excess );
			largest = std::max( largest, d );
		}
		EXPECT_GT( largest, 0.1 );
	}
}

/// The tree made of Morton codes is as good as any: sizes from one voxel to a full chunk.
TEST( CloudScenes, ATreeIsNotValid )
{
	SeededRng rng( 20261208 );
	for ( const int count : { 1, 2, 7, 8, 9, 17, 65, 300, 3000, 40000 } )
	{
		const CloudPtr cloud = makeCloud( cloudOf( 0.1, 3.2 ) );
		std::vector<Point> points;
		const double half = count < 10 ? 0.3 : 3.2;
		for ( int i = 0; i < count; ++i )
		{
			points.push_back( randomPoint( rng, half ) );
		}
		hit( cloud.get(), 1, points );
		const double full[2][3] = { { 0, 0, 0 }, { 3.2, 3.2, 3.2 } };
		if ( count == 3000 )
		{
			ASSERT_EQ( LW_OK, lw_cloud_set_box( cloud.get(), full[0], full[1], LW_VOXEL_OCCUPIED, nullptr ) );
		}
		const leeway::Scene scene = sceneOf( cloud.get() );
		std::uint64_t balls = 0;
		for ( std::uint32_t i = 0; i < lw_scene_shape_count( scene.get() ); ++i )
		{
			const lw_shape* shape = lw_scene_shape( scene.get(), i ).shape;
			lw_diag diag = {};
			ASSERT_EQ( LW_OK, lwi_shape_validate( shape, &diag ) ) << count << ": " << diag.message;
			balls += lw_shape_get_info( shape ).vertex_count;
		}
		EXPECT_EQ( balls, lw_cloud_get_info( cloud.get() ).occupied );
	}
}

/// Unseen voxels are in boxes, free ones are not, and nothing is beyond the box of the cloud.
TEST( CloudScenes, AnUnseenVoxelIsFree )
{
	SeededRng rng( 20261209 );
	lw_cloud_def def = cloudOf( 0.1, 2.05 );
	def.unseen_blocked = true;
	const CloudPtr cloud = makeCloud( def );
	const leeway::Query query = leeway::makeQuery( nullptr );
	const leeway::Shape point = onePoint();
	for ( int round = 1; round <= 8; ++round )
	{
		if ( round > 1 )
		{
			DepthFrame frame( round, lookAt( randomPoint( rng, 1.5 ), randomPoint( rng, 0.5 ) ), 80, 60, 50 );
			frame.fill( rng.uniform( 0.5, 4 ) );
			insert( cloud.get(), frame.frame );
		}
		const leeway::Scene scene = sceneOf( cloud.get() );
		const lw_cloud_info info = lw_cloud_get_info( cloud.get() );
		for ( int i = 0; i < 300; ++i )
		{
			Point q;
			for ( std::size_t k = 0; k < 3; ++k )
			{
				q[k] = 0.1 * ( rng.integer( -23, 22 ) + 0.5 );
			}
			const bool inside =
			    std::all_of( q.begin(), q.end(), [&]( double x ) { return std::abs( x ) < info.box_max[0]; } );
			const lw_cloud_voxel state = stateAt( cloud.get(), q );
			const double d = distanceTo( scene.get(), q, query.get(), point.get() );
			if ( state == LW_VOXEL_FREE )
			{
				// balls of neighbours reach over the side of their voxels, not to the middle of this one
				ASSERT_GT( d, 0.01 );
			}
			else
			{
				ASSERT_EQ( d > 0, !inside );
			}
		}
	}
}

/// Boxes of unseen voxels have these voxels, each once, whatever was seen before and wherever the cloud ends; and their trees are valid.
TEST( CloudScenes, AnUnseenVoxelIsInTwoBoxes )
{
	SeededRng rng( 20261213 );
	for ( int round = 0; round < 40; ++round )
	{
		lw_cloud_def def = cloudOf( 0.1, 1 );
		for ( int k = 0; k < 3; ++k )
		{
			def.box_min[k] = -rng.uniform( 0.1, 4 );
			def.box_max[k] = rng.uniform( 0.1, 4 );
		}
		def.unseen_blocked = true;
		const CloudPtr cloud = makeCloud( def );
		const lw_cloud_info info = lw_cloud_get_info( cloud.get() );
		for ( int i = rng.integer( 0, 30 ); i > 0; --i )
		{
			double low[3], high[3];
			for ( int k = 0; k < 3; ++k )
			{
				low[k] = rng.uniform( info.box_min[k], info.box_max[k] );
				high[k] = low[k] + rng.uniform( 0, round % 2 == 0 ? 3 : 0.3 );
			}
			const lw_cloud_voxel state = rng.integer( 0, 3 ) == 0 ? LW_VOXEL_UNSEEN : LW_VOXEL_FREE;
			ASSERT_EQ( LW_OK, lw_cloud_set_box( cloud.get(), low, high, state, nullptr ) );
		}
		double expected = -static_cast<double>( lw_cloud_voxels( cloud.get(), LW_VOXEL_FREE, nullptr, 0 ) ), found = 0,
		       all = 1;
		for ( int k = 0; k < 3; ++k )
		{
			all *= std::round( ( info.box_max[k] - info.box_min[k] ) / 0.1 );
		}
		expected += all;
		const leeway::Scene scene = sceneOf( cloud.get() );
		for ( std::uint32_t i = 0; i < lw_scene_shape_count( scene.get() ); ++i )
		{
			const lw_shape* shape = lw_scene_shape( scene.get(), i ).shape;
			lw_diag diag = {};
			ASSERT_EQ( LW_OK, lwi_shape_validate( shape, &diag ) ) << diag.message;
			for ( std::uint32_t box = 0; box < lw_shape_get_info( shape ).vertex_count / 2; ++box )
			{
				const double* corner = lw_shape_vertices( shape ) + 6 * static_cast<std::size_t>( box );
				double voxels = 1;
				for ( int k = 0; k < 3; ++k )
				{
					voxels *= std::round( ( corner[3 + k] - corner[k] ) / 0.1 );
					ASSERT_GE( corner[k], info.box_min[k] );
					ASSERT_LE( corner[3 + k], info.box_max[k] );
				}
				found += voxels;
			}
		}
		EXPECT_EQ( found, expected ) << round;
	}
}

/// After any history the balls are those of a cloud that is filled at once.
TEST( CloudScenes, HistoryChangesAScene )
{
	SeededRng rng( 20261210 );
	for ( const bool blocked : { false, true } )
	{
		lw_cloud_def def = cloudOf( 0.03, 1.5 );
		def.unseen_blocked = blocked;
		const CloudPtr cloud = makeCloud( def );
		for ( int k = 1; k <= 30; ++k )
		{
			DepthFrame frame( k, lookAt( randomPoint( rng, 0.5 ), randomPoint( rng, 1.5 ) ), 64, 48, 60 );
			for ( float& z : frame.depths )
			{
				z = static_cast<float>( rng.uniform( 1, 1.1 ) );
			}
			insert( cloud.get(), frame.frame );
			if ( k % 7 == 0 )
			{
				lw_cloud_forget_before( cloud.get(), k - 3 );
			}
			const leeway::Scene scene = sceneOf( cloud.get() );
			std::set<Point> expected;
			const std::uint64_t count = lw_cloud_voxels( cloud.get(), LW_VOXEL_OCCUPIED, nullptr, 0 );
			std::vector<double> centers( 3 * count );
			lw_cloud_voxels( cloud.get(), LW_VOXEL_OCCUPIED, centers.data(), count );
			for ( std::uint64_t i = 0; i < count; ++i )
			{
				expected.insert( { centers[3 * i], centers[3 * i + 1], centers[3 * i + 2] } );
			}
			ASSERT_EQ( centersOf( scene.get() ), expected ) << k;
		}
	}
}

/// One voxel changes one shape; all others are the same, and the checker knows them again, whatever came and went before them.
TEST( CloudScenes, AnUnchangedShapeIsMadeAnew )
{
	SeededRng rng( 20261211 );
	const CloudPtr cloud = makeCloud( cloudOf( 0.02, 2 ) );
	hit( cloud.get(), 1, surface( rng, 4000, 2 ) );
	leeway::Scene before = sceneOf( cloud.get() );
	ASSERT_GT( lw_scene_shape_count( before.get() ), 30u );
	for ( int k = 2; k < 40; ++k )
	{
		const Point p = randomPoint( rng, 1.9 );
		if ( k % 3 == 0 )
		{
			const double low[3] = { p[0] - 0.4, p[1] - 0.4, p[2] - 0.4 }, high[3] = { p[0] + 0.4, p[1] + 0.4, p[2] + 0.4 };
			ASSERT_EQ( LW_OK, lw_cloud_set_box( cloud.get(), low, high, LW_VOXEL_FREE, nullptr ) );
		}
		else
		{
			hit( cloud.get(), k, { p } );
		}
		const leeway::Scene after = sceneOf( cloud.get() );
		std::set<const lw_shape*> old;
		for ( std::uint32_t i = 0; i < lw_scene_shape_count( before.get() ); ++i )
		{
			old.insert( lw_scene_shape( before.get(), i ).shape );
		}
		const std::uint32_t count = lw_scene_shape_count( after.get() );
		std::vector<std::uint32_t> source( count );
		lwi_match_scenes( before.get(), after.get(), source.data() );
		std::uint32_t kept = 0, known = 0;
		for ( std::uint32_t i = 0; i < count; ++i )
		{
			kept += old.count( lw_scene_shape( after.get(), i ).shape );
			known += source[i] != LW_INVALID_INDEX;
			ASSERT_TRUE( source[i] == LW_INVALID_INDEX ||
			             lw_scene_shape( before.get(), source[i] ).shape == lw_scene_shape( after.get(), i ).shape );
		}
		ASSERT_EQ( known, kept );
		ASSERT_EQ( count - kept, lw_cloud_get_info( cloud.get() ).rebuilt );
		ASSERT_LE( count - kept, k % 3 == 0 ? 27u : 1u );
		before = after;
	}
}

TEST( CloudScenes, ObjectsOfTheBaseAreLost )
{
	const CloudPtr cloud = makeCloud( cloudOf( 0.02, 2 ) );
	hit( cloud.get(), 1, { { 0.5, 0.5, 0.5 } } );
	lw_shape* block = primitive( LW_SHAPE_BOX, 0.2, 0.2, 0.2 );
	const leeway::Scene base = oneObstacle( block, at( 1, 0, 0 ) );
	lw_shape_release( block );
	const leeway::Scene scene = sceneOf( cloud.get(), base.get() );
	ASSERT_EQ( lw_scene_object_count( scene.get() ), 2u );
	EXPECT_STREQ( lw_scene_object_name( scene.get(), 0 ), "obstacle" );
	EXPECT_STREQ( lw_scene_object_name( scene.get(), 1 ), "cloud" );
	EXPECT_EQ( lw_scene_shape( scene.get(), 0 ).shape, lw_scene_shape( base.get(), 0 ).shape );
	EXPECT_EQ( lw_scene_shape( scene.get(), 0 ).world_from_shape.t[0], 1 );
	lw_scene* none = nullptr;
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_cloud_scene( cloud.get(), scene.get(), "cloud", nullptr, &none ) );
	EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT, lw_cloud_scene( cloud.get(), nullptr, nullptr, nullptr, &none ) );
	lw_cloud_clear( cloud.get() );
	EXPECT_EQ( lw_scene_shape_count( sceneOf( cloud.get() ).get() ), 0u );
	EXPECT_EQ( lw_scene_shape_count( scene.get() ), 2u ) << "scenes outlive what was in the cloud";
}
