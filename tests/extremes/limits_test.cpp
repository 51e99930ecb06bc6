// SPDX-License-Identifier: BSD-3-Clause
// Inputs accepted and refused at the ends of the range, poses that were composed a million times, and threads.
#include "extreme_judge.hpp"
#include "shapes.hpp"

#include <gtest/gtest.h>
#include <thread>

using namespace extremes;

namespace
{
const double inf = std::numeric_limits<double>::infinity();

/// A sheet of some triangles, large enough for several leaves.
exact::Body sheet( double size, double height )
{
	exact::Body body;
	for ( int i = 0; i < 64; ++i )
	{
		double x = size * ( i % 8 ) / 8, y = size * ( i / 8 ) / 8, d = size / 8;
		body.items.push_back( { { { x, y, height }, { x + d, y, height }, { x, y + d, height } }, 0 } );
	}
	return body;
}

lw_status create( double coordinate, std::unique_ptr<lw_shape, ReleaseShape>* out = nullptr )
{
	const double vertices[9] = { coordinate, 0, 0, 0, 1, 0, 0, 0, 1 };
	const std::uint32_t indices[3] = { 0, 1, 2 };
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = vertices;
	def.vertex_count = 3;
	def.indices = indices;
	def.triangle_count = 1;
	lw_shape* shape = nullptr;
	lw_status status = lw_shape_create_mesh( &def, nullptr, nullptr, &shape );
	std::unique_ptr<lw_shape, ReleaseShape> owner( shape );
	if ( out != nullptr )
	{
		*out = std::move( owner );
	}
	return status;
}

} // namespace

TEST( ExtremeLimits, Sizes )
{
	EXPECT_EQ( LW_OK, create( 1e9 ) );
	EXPECT_EQ( LW_ERROR_BAD_GEOMETRY, create( std::nextafter( 1e9, inf ) ) );
	EXPECT_EQ( LW_ERROR_BAD_GEOMETRY, create( -1e10 ) );
	EXPECT_EQ( LW_ERROR_BAD_GEOMETRY, create( inf ) );
	EXPECT_EQ( LW_OK, create( std::numeric_limits<double>::denorm_min() ) );
	for ( double size : { 1e-100, 1e-9, 1e9 } )
	{
		lw_shape* shape = nullptr;
		const double cube[3] = { size, size, size };
		EXPECT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_BOX, cube, nullptr, nullptr, &shape ) ) << size;
		lw_shape_release( shape );
	}
	lw_shape* shape = nullptr;
	for ( double size : { 0.0, 9e-101, 1.1e9, inf } )
	{
		const double cube[3] = { 1, 1, size };
		EXPECT_EQ( LW_ERROR_BAD_GEOMETRY, lw_shape_create_primitive( LW_SHAPE_BOX, cube, nullptr, nullptr, &shape ) );
	}
}

TEST( ExtremeLimits, FarPosesOverflowFloats )
{
	Random random( 5 );
	exact::Body body = sheet( 1, 0 );
	std::unique_ptr<lw_shape, ReleaseShape> shape = makeShape( random, body );
	QueryPtr query = makeQuery();
	lw_transform here = lw_transform_identity(), there = here;
	for ( double far : { 1e6, 1e9, 1e12, 1e15 } )
	{
		there.t[0] = there.t[1] = far;
		lw_clearance out;
		ASSERT_EQ( LW_OK, lw_shape_distance( shape.get(), &here, shape.get(), &there, nullptr, query.get(), &out ) ) << far;
		EXPECT_LE( out.lower, std::sqrt( 2.0 ) * far );
		EXPECT_NEAR( out.upper, std::sqrt( 2.0 ) * far, 2 + 0x1p-45 * far );
	}
	for ( double far : { 1.1e15, 1e20, 1e100, 1e300, inf } )
	{
		there.t[0] = far;
		lw_clearance out;
		EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT,
		    lw_shape_distance( shape.get(), &here, shape.get(), &there, nullptr, query.get(), &out ) )
		    << far;
		EXPECT_EQ( 0, out.lower ) << "an error reads as free space";
		EXPECT_FALSE( lw_transform_is_valid( &there ) );
	}
}

TEST( ExtremeLimits, RangeWithoutWidth )
{
	Random random( 6 );
	std::unique_ptr<lw_shape, ReleaseShape> shape = makeShape( random, sheet( 1, 0 ) );
	QueryPtr query = makeQuery();
	lw_transform here = lw_transform_identity(), there = here;
	there.t[2] = 0.5;
	lw_clearance out;
	for ( lw_range range : { lw_range{ 0.5, 0.5, 0 }, lw_range{ 0, 0, 0 }, lw_range{ 0, 1, 1 }, lw_range{ inf, inf, 0 } } )
	{
		EXPECT_EQ( LW_ERROR_INVALID_ARGUMENT,
		    lw_shape_distance( shape.get(), &here, shape.get(), &there, &range, query.get(), &out ) );
	}
	lw_range touching = { 0.5, std::nextafter( 0.5, inf ), 1 - 0x1p-53 };
	EXPECT_EQ( LW_OK, lw_shape_distance( shape.get(), &here, shape.get(), &there, &touching, query.get(), &out ) );
	EXPECT_EQ( LW_CLEARANCE_VIOLATION, out.kind );
	lw_range huge = { 0, 1e308, 0.5 };
	EXPECT_EQ( LW_OK, lw_shape_distance( shape.get(), &here, shape.get(), &there, &huge, query.get(), &out ) );
	EXPECT_EQ( LW_CLEARANCE_NEAR, out.kind );
}

TEST( ExtremePoses, AMillionCompositions )
{
	Random random( 7 );
	lw_transform pose = lw_transform_identity(), step = lw_transform_identity();
	const double xyzw[4] = { 0.1, 0.2, -0.3, 0.9 }, none[3] = { 0, 0, 0 };
	lw_transform_from_quaternion( none, xyzw, &step );
	for ( int i = 0; i < 1000000; ++i )
	{
		pose = lw_transform_multiply( &pose, &step );
	}
	ASSERT_TRUE( lw_transform_is_valid( &pose ) );
	QueryPtr query = makeQuery();
	Findings findings;
	for ( std::uint64_t i = 0; i < 2000; ++i )
	{
		ShapePair p = randomShapes( random, static_cast<Arrangement>( i % coinciding ) );
		lw_transform turned = lw_transform_multiply( &pose, &p.world_from_a ),
		             more = lw_transform_multiply( &pose, &p.world_from_b );
		// nearly rotations, up to the tolerance
		double off = i % 2 == 0 ? 0 : 2e-7 * random.unit();
		for ( int k = 0; k < 9; ++k )
		{
			turned.r[k / 3][k % 3] *= 1 + off * random.unit();
			more.r[k / 3][k % 3] += off * random.unit();
		}
		p.world_from_a = turned;
		p.world_from_b = more;
		if ( p.a.shape != nullptr && p.b.shape != nullptr && lw_transform_is_valid( &turned ) &&
		     lw_transform_is_valid( &more ) )
		{
			ShapeJudge( p, i, query.get(), findings ).answers( random );
		}
	}
	EXPECT_GT( findings.placements, 1000u );
	EXPECT_EQ( findings.broken, 0u );
	for ( const std::string& text : findings.examples )
	{
		ADD_FAILURE() << text;
	}
}

TEST( ExtremeThreads, AnswersDependOnTheirNumber )
{
	struct Case
	{
		ShapePair pair;
		lw_range range;
	};
	Random random( 8 );
	std::vector<Case> cases;
	while ( cases.size() < 600 )
	{
		ShapePair pair = randomShapes( random, static_cast<Arrangement>( cases.size() % arrangement_count ) );
		if ( pair.a.shape != nullptr && pair.b.shape != nullptr )
		{
			cases.push_back(
			    { std::move( pair ), { 0, random.below( 2 ) == 0 ? inf : 1.0, random.below( 2 ) == 0 ? 0 : 0.3 } } );
		}
	}
	const auto answer = [&]( std::size_t first, std::size_t step, std::vector<lw_clearance>& out )
	{
		QueryPtr query = makeQuery();
		for ( std::size_t i = first; i < cases.size(); i += step )
		{
			const ShapePair& p = cases[i].pair;
			lw_query_reset( query.get() );
			lw_shape_distance(
			    p.a.shape.get(), &p.world_from_a, p.b.shape.get(), &p.world_from_b, &cases[i].range, query.get(), &out[i] );
		}
	};
	std::vector<lw_clearance> alone( cases.size() );
	answer( 0, 1, alone );
	for ( std::size_t count : { 1, 2, 4 } )
	{
		std::vector<lw_clearance> got( cases.size() );
		std::vector<std::thread> threads;
		for ( std::size_t i = 0; i < count; ++i )
		{
			threads.emplace_back( [&, i] { answer( i, count, got ); } );
		}
		for ( std::thread& thread : threads )
		{
			thread.join();
		}
		for ( std::size_t i = 0; i < cases.size(); ++i )
		{
			ASSERT_TRUE( sameBits( alone[i], got[i] ) ) << count << " threads, case " << i;
		}
	}
}
