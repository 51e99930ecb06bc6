// SPDX-License-Identifier: BSD-3-Clause
// Kernels of interval batches: every level against the scalar one bit for bit, frames against joints one by one in long
// double, and pairs held to stay apart against many moments of their window.
#include "kernel_levels.hpp"
#include "seeded_rng.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

namespace
{

using real = long double;
using Matrix = std::array<std::array<real, 3>, 3>;
using Vector = std::array<real, 3>;

Vector unit( SeededRng& rng )
{
	Vector v{ rng.uniform( -1, 1 ), rng.uniform( -1, 1 ), rng.uniform( -1, 1 ) };
	const real length = std::sqrt( v[0] * v[0] + v[1] * v[1] + v[2] * v[2] );
	return { v[0] / length, v[1] / length, v[2] / length };
}

Matrix turn( const Vector& a, real angle )
{
	const real c = std::cos( angle ), s = std::sin( angle ), k = 1 - c;
	return { { { c + a[0] * a[0] * k, a[0] * a[1] * k - a[2] * s, a[0] * a[2] * k + a[1] * s },
	    { a[1] * a[0] * k + a[2] * s, c + a[1] * a[1] * k, a[1] * a[2] * k - a[0] * s },
	    { a[2] * a[0] * k - a[1] * s, a[2] * a[1] * k + a[0] * s, c + a[2] * a[2] * k } } };
}

Matrix times( const Matrix& a, const Matrix& b )
{
	Matrix m{};
	for ( size_t i = 0; i < 3; ++i )
	{
		for ( size_t j = 0; j < 3; ++j )
		{
			m[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
		}
	}
	return m;
}

Vector times( const Matrix& a, const Vector& v )
{
	return { a[0][0] * v[0] + a[0][1] * v[1] + a[0][2] * v[2], a[1][0] * v[0] + a[1][1] * v[1] + a[1][2] * v[2],
	    a[2][0] * v[0] + a[2][1] * v[1] + a[2][2] * v[2] };
}

Vector plus( const Vector& a, const Vector& b, real s = 1 )
{
	return { a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2] };
}

/// A chain of joints, each with a constant transform above it; and the same in the form of interval batches.
struct Chain
{
	struct Joint
	{
		Matrix r;
		Vector t, axis;
		bool rotates;
		real start, speed;
	};
	std::vector<Joint> joints;

	explicit Chain( SeededRng& rng )
	{
		const int count = rng.integer( 1, 6 );
		for ( int i = 0; i < count; ++i )
		{
			joints.push_back( { turn( unit( rng ), rng.uniform( -3, 3 ) ),
			    { rng.uniform( -1, 1 ), rng.uniform( -1, 1 ), rng.uniform( -1, 1 ) }, unit( rng ),
			    rng.uniform( 0, 1 ) < 0.75, rng.uniform( -3, 3 ), rng.uniform( -2, 2 ) } );
		}
	}

	/// A point of the last frame at t.
	Vector at( const Vector& local, real t ) const
	{
		Vector p = local;
		for ( auto j = joints.rbegin(); j != joints.rend(); ++j )
		{
			const real value = j->start + t * j->speed;
			p = j->rotates ? times( turn( j->axis, value ), p ) : plus( p, j->axis, value );
			p = plus( times( j->r, p ), j->t );
		}
		return p;
	}

	/// Lanes at the middles of eight windows of [0, 1].
	lwi_batch_frame lanes( const lwi_kernels* kernels ) const
	{
		return follow<lwi_batch_frame>(
		    [&]( const lwi_batch_frame& above, const lwi_batch_joint& joint, const Values& v, lwi_batch_frame* out )
		    { kernels->batch_frame( &above, &joint, v.cosine, v.sine, v.value, v.speed, out ); } );
	}

	/// The same at rest, in float.
	lwi_lane_motion poses( const lwi_kernels* kernels ) const
	{
		return follow<lwi_lane_motion>(
		    [&]( const lwi_lane_motion& above, const lwi_batch_joint& joint, const Values& v, lwi_lane_motion* out )
		    { kernels->lane_frame( &above, &joint.lane, v.cosine, v.sine, v.value, out ); } );
	}

	/// Metres: how far poses() may be off at a point that is so far from the last frame: core/docs/states.md.
	double off( double beyond ) const
	{
		double length = beyond;
		for ( const Joint& j : joints )
		{
			const Vector& t = j.t;
			length += static_cast<double>( std::sqrt( t[0] * t[0] + t[1] * t[1] + t[2] * t[2] ) );
			length += j.rotates ? 0 : static_cast<double>( std::fabs( j.start ) + std::fabs( j.speed ) );
		}
		return 64 * 0x1p-24 * static_cast<double>( joints.size() + 2 ) * length;
	}

private:
	/// Of a joint in the lanes.
	struct Values
	{
		double cosine[LWI_WIDTH], sine[LWI_WIDTH], value[LWI_WIDTH], speed[LWI_WIDTH];
		explicit Values( const Joint& j )
		{
			for ( int l = 0; l < LWI_WIDTH; ++l )
			{
				speed[l] = static_cast<double>( j.speed );
				const double v = static_cast<double>( j.start + ( l + 0.5L ) / LWI_WIDTH * j.speed );
				cosine[l] = j.rotates ? std::cos( v ) : 1;
				sine[l] = j.rotates ? std::sin( v ) : 0;
				value[l] = j.rotates ? 0 : v;
			}
		}
	};

	/// From the world, which stands, to the last frame.
	template <typename Frame, typename Step> Frame follow( Step step ) const
	{
		Frame frame;
		std::memset( &frame, 0, sizeof( frame ) );
		for ( int l = 0; l < LWI_WIDTH; ++l )
		{
			frame.r[0][l] = frame.r[4][l] = frame.r[8][l] = 1;
		}
		for ( const Joint& j : joints )
		{
			Frame next;
			std::memset( &next, 0, sizeof( next ) );
			step( frame, batch_joint_of( j ), Values( j ), &next );
			frame = next;
		}
		return frame;
	}

	static lwi_batch_joint batch_joint_of( const Joint& j )
	{
		lwi_batch_joint out = {};
		const Vector& a = j.axis;
		const Matrix cross = { { { 0, -a[2], a[1] }, { a[2], 0, -a[0] }, { -a[1], a[0], 0 } } }, sine = times( j.r, cross );
		const Vector along = times( j.r, a );
		for ( size_t i = 0; i < 3; ++i )
		{
			out.offset[i] = static_cast<double>( j.t[i] );
			out.along[i] = static_cast<double>( along[i] );
			for ( size_t k = 0; k < 3; ++k )
			{
				out.still[3 * i + k] = static_cast<double>( along[i] * a[k] );
				out.cosine[3 * i + k] = static_cast<double>( j.r[i][k] - along[i] * a[k] );
				out.sine[3 * i + k] = static_cast<double>( sine[i][k] );
			}
		}
		out.rotates = j.rotates;
		const auto round = []( const double* from, size_t count, float* to )
		{ std::transform( from, from + count, to, []( double x ) { return static_cast<float>( x ); } ); };
		round( out.still, 9, out.lane.still );
		round( out.cosine, 9, out.lane.cosine );
		round( out.sine, 9, out.lane.sine );
		round( out.offset, 3, out.lane.offset );
		round( out.along, 3, out.lane.along );
		return out;
	}
};

lwi_batch_point random_point( SeededRng& rng, double scale )
{
	lwi_batch_point p;
	for ( int axis = 0; axis < 3; ++axis )
	{
		for ( int l = 0; l < LWI_WIDTH; ++l )
		{
			p.p[axis][l] = static_cast<float>( scale * rng.uniform( -1, 1 ) );
			p.displacement[axis][l] =
			    static_cast<float>( scale * rng.uniform( -1, 1 ) * std::pow( 10.0, rng.integer( -4, 0 ) ) );
		}
	}
	return p;
}

/// Distance of a lane to a box or to another point at the moment s in [-1, 1] of its window.
double distance_at( const lwi_batch_point& a, int l, double s, const float* min, const float* max, const lwi_batch_point* b )
{
	double square = 0;
	for ( int axis = 0; axis < 3; ++axis )
	{
		const double x = static_cast<double>( a.p[axis][l] ) + s * static_cast<double>( a.displacement[axis][l] );
		double d;
		if ( b != nullptr )
		{
			d = x - ( static_cast<double>( b->p[axis][l] ) + s * static_cast<double>( b->displacement[axis][l] ) );
		}
		else
		{
			d = std::max( { static_cast<double>( min[axis] ) - x, x - static_cast<double>( max[axis] ), 0.0 } );
		}
		square += d * d;
	}
	return std::sqrt( square );
}

/// A chain of poses, each behind a turn about z and a shift along z, and a last one.
struct PoseChain
{
	std::vector<lwi_pose_rows> before, tips;
	std::vector<double> cosines, sines, shifts;

	explicit PoseChain( SeededRng& rng )
	{
		const int count = rng.integer( 0, 9 );
		for ( int i = 0; i <= count; ++i )
		{
			const Matrix r = turn( unit( rng ), rng.uniform( -3, 3 ) );
			lwi_pose_rows rows;
			for ( size_t k = 0; k < 3; ++k )
			{
				std::transform( r[k].begin(), r[k].end(), rows.at[k], []( real x ) { return static_cast<double>( x ); } );
				rows.at[k][3] = rng.uniform( -1, 1 );
			}
			const double angle = rng.uniform( -3, 3 );
			before.push_back( rows );
			tips.push_back( rows );
			cosines.push_back( std::cos( angle ) );
			sines.push_back( std::sin( angle ) );
			shifts.push_back( rng.uniform( -1, 1 ) );
		}
		before.pop_back(); // the last pose is the tip
	}

	std::vector<lwi_pose_rows> tipsOf( const lwi_kernels* kernels ) const
	{
		std::vector<lwi_pose_rows> out = tips;
		kernels->chain_tips(
		    before.data(), cosines.data(), sines.data(), shifts.data(), static_cast<uint32_t>( before.size() ), out.data() );
		return out;
	}

	/// A point of the tip, in the frame of part i.
	Vector at( Vector p, size_t i ) const
	{
		p = moved( tips.back(), p );
		for ( size_t k = before.size(); k-- > i; )
		{
			const real c = cosines[k], s = sines[k];
			p = moved( before[k], { c * p[0] - s * p[1], s * p[0] + c * p[1], p[2] + shifts[k] } );
		}
		return p;
	}

	static Vector moved( const lwi_pose_rows& rows, const Vector& p )
	{
		Vector out;
		for ( size_t k = 0; k < 3; ++k )
		{
			out[k] = rows.at[k][0] * p[0] + rows.at[k][1] * p[1] + rows.at[k][2] * p[2] + rows.at[k][3];
		}
		return out;
	}
};

} // namespace

TEST( ChainKernels, ATipIsNotWhereItsChainPutsIt )
{
	SeededRng rng;
	for ( int round = 0; round < 2000; ++round )
	{
		const PoseChain chain( rng );
		const std::vector<lwi_pose_rows> tips = chain.tipsOf( &lwi_kernels_scalar );
		const Vector point = { rng.uniform( -1, 1 ), rng.uniform( -1, 1 ), rng.uniform( -1, 1 ) };
		for ( size_t i = 0; i < tips.size(); ++i )
		{
			const Vector exact = chain.at( point, i ), got = PoseChain::moved( tips[i], point );
			for ( size_t k = 0; k < 3; ++k )
			{
				ASSERT_NEAR( static_cast<double>( exact[k] ), static_cast<double>( got[k] ), 1e-13 ) << "round " << round;
			}
		}
		for ( const lwi_kernels* kernels : kernelLevels() )
		{
			const std::vector<lwi_pose_rows> other = chain.tipsOf( kernels );
			ASSERT_EQ( 0, std::memcmp( tips.data(), other.data(), tips.size() * sizeof( tips[0] ) ) )
			    << "level " << kernels->level << ", round " << round;
		}
	}
}

TEST( BatchKernels, LevelDiffersFromScalar )
{
	SeededRng rng;
	for ( int i = 0; i < 2000; ++i )
	{
		const Chain chain( rng );
		const double local[3] = { rng.uniform( -1, 1 ), rng.uniform( -1, 1 ), rng.uniform( -1, 1 ) },
		             origin[3] = { 1, -2, 0.5 };
		const float min[3] = { -1, -1, -1 }, max[3] = { 0, 0, 1 };
		const lwi_batch_point other = random_point( rng, 2 );
		struct Output
		{
			lwi_batch_frame frame;
			lwi_batch_point point;
			uint32_t box, pair;
		};
		std::vector<Output> outputs;
		for ( const lwi_kernels* table : kernelLevels() )
		{
			Output o;
			std::memset( &o, 0, sizeof( o ) );
			o.frame = chain.lanes( table );
			table->batch_point( &o.frame, local, origin, 0.0625, &o.point );
			o.box = table->batch_box( &o.point, min, max, 0.5f );
			o.pair = table->batch_pair( &o.point, &other, 1.0f );
			outputs.push_back( o );
			ASSERT_EQ( 0, std::memcmp( &outputs[0], &o, sizeof( o ) ) ) << "level " << table->level << ", input " << i;
		}
	}
}

TEST( BatchKernels, LevelOfStatesDiffersFromScalar )
{
	SeededRng rng;
	for ( int i = 0; i < 2000; ++i )
	{
		const Chain chain( rng ), beside( rng );
		const double t[3] = { rng.uniform( -1, 1 ), rng.uniform( -1, 1 ), rng.uniform( -1, 1 ) };
		const double r[3][3] = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 1 } };
		const float middle[3] = { 0.1f, 0.2f, -0.3f }, half[3] = { 0.3f, 0.2f, 0.1f };
		const lw_shape_type types[] = { LW_SHAPE_BOX, LW_SHAPE_CYLINDER, LW_SHAPE_CONE, LW_SHAPE_HALFSPACE, LW_SHAPE_PLANE };
		const lwi_primitive primitive = { types[rng.integer( 0, 4 )],
		    { static_cast<float>( rng.uniform( 0.1, 2 ) ), static_cast<float>( rng.uniform( 0.1, 2 ) ),
		        static_cast<float>( rng.uniform( 0.1, 2 ) ) } };
		lwi_box8 box;
		for ( int k = 0; k < LWI_WIDTH; ++k )
		{
			for ( int axis = 0; axis < 3; ++axis )
			{
				box.min[axis][k] = static_cast<float>( rng.uniform( -3, 2 ) );
				box.max[axis][k] = box.min[axis][k] + static_cast<float>( rng.uniform( 0, 1 ) );
			}
		}
		struct Output
		{
			lwi_batch_point point;
			lwi_lane_motion stopped, body, motion, between;
			std::uint64_t boxes;
			uint32_t slabs;
		};
		std::vector<Output> outputs;
		const std::uint64_t all = ~std::uint64_t{ 0 };
		for ( const lwi_kernels* table : kernelLevels() )
		{
			Output o;
			std::memset( &o, 0, sizeof( o ) );
			const lwi_lane_motion frame = chain.poses( table ), other_frame = beside.poses( table );
			const lwi_batch_frame moving = chain.lanes( table );
			table->lane_of_batch( &moving, t, &o.stopped );
			table->lane_point( &frame, t, t, &o.point );
			EXPECT_TRUE( std::all_of(
			    &o.point.displacement[0][0], &o.point.displacement[0][0] + 24, []( float d ) { return d == 0; } ) );
			table->lane_boxes( &o.point, &box, 1, 0.7f, &all, &o.boxes );
			table->lane_body( &frame, r, t, &o.body );
			table->lane_relative( &o.body, r, t, &o.motion );
			lwi_lane_motion other;
			table->lane_body( &other_frame, r, t, &other );
			table->lane_between( &o.body, &other, &o.between );
			o.slabs = table->lane_slabs( &o.motion, middle, half, &primitive, 0.2f );
			outputs.push_back( o );
			ASSERT_EQ( 0, std::memcmp( &outputs[0], &o, sizeof( o ) ) ) << "level " << table->level << ", input " << i;
		}
	}
}

TEST( BatchKernels, PointsAreElsewhereOrMoveOtherwise )
{
	SeededRng rng;
	const real half = 1.0L / 16;
	for ( int i = 0; i < 3000; ++i )
	{
		const Chain chain( rng ), beside( rng );
		const lwi_batch_frame frame = chain.lanes( &lwi_kernels_scalar );
		const lwi_lane_motion at_rest = chain.poses( &lwi_kernels_scalar ),
		                      other_frame = beside.poses( &lwi_kernels_scalar );
		const double local[3] = { rng.uniform( -1, 1 ), rng.uniform( -1, 1 ), rng.uniform( -1, 1 ) },
		             origin[3] = { 1, -2, 0.5 };
		const double r[3][3] = { { 0, -1, 0 }, { 1, 0, 0 }, { 0, 0, 1 } },
		             still[3][3] = { { 0, 0, 1 }, { 1, 0, 0 }, { 0, 1, 0 } };
		lwi_batch_point point, resting;
		lwi_lane_motion stopped, body, other_body, moved, between;
		lwi_kernels_scalar.batch_point( &frame, local, origin, static_cast<double>( half ), &point );
		lwi_kernels_scalar.lane_of_batch( &frame, origin, &stopped );
		lwi_kernels_scalar.lane_point( &at_rest, local, origin, &resting );
		lwi_kernels_scalar.lane_body( &at_rest, r, local, &body );
		lwi_kernels_scalar.lane_relative( &body, still, origin, &moved );
		lwi_kernels_scalar.lane_body( &other_frame, still, local, &other_body );
		lwi_kernels_scalar.lane_between( &body, &other_body, &between );
		const auto by = []( const lwi_lane_motion& m, size_t axis, int l, double x, double y, double z )
		{
			const size_t row = 3 * axis;
			return static_cast<double>( m.r[row][l] ) * x + static_cast<double>( m.r[row + 1][l] ) * y +
			       static_cast<double>( m.r[row + 2][l] ) * z + static_cast<double>( m.t[axis][l] );
		};
		const double off = chain.off( 2.5 ), off_of_both = off + beside.off( 2.5 );
		const Vector at{ local[0], local[1], local[2] }, in{ local[0] + 0.5L, local[1] + 0.25L, local[2] + 0.125L };
		for ( int l = 0; l < LWI_WIDTH; ++l )
		{
			const real t = ( l + 0.5L ) / LWI_WIDTH, h = 1e-5L;
			const Vector now = chain.at( at, t ), before = chain.at( at, t - h ), after = chain.at( at, t + h ),
			             other = chain.at( in, t ), from = beside.at( at, t );
			for ( size_t axis = 0; axis < 3; ++axis )
			{
				EXPECT_NEAR(
				    static_cast<double>( now[axis] ) - origin[axis], static_cast<double>( point.p[axis][l] ), 4e-6 );
				EXPECT_NEAR( static_cast<double>( half * ( after[axis] - before[axis] ) / ( 2 * h ) ),
				    static_cast<double>( point.displacement[axis][l] ), 4e-6 );
				EXPECT_NEAR( static_cast<double>( now[axis] ) - origin[axis],
				    by( stopped, axis, l, local[0], local[1], local[2] ), 4e-6 );
				EXPECT_NEAR(
				    static_cast<double>( now[axis] ) - origin[axis], static_cast<double>( resting.p[axis][l] ), off );
				const size_t world = ( axis + 1 ) % 3; // where this axis of the frame at rest points
				EXPECT_NEAR(
				    static_cast<double>( other[world] ) - origin[world], by( moved, axis, l, 0.25, -0.5, 0.125 ), off );
				Vector tip = at;
				tip[world] += 1;
				const Vector along = plus( beside.at( tip, t ), from, -1 ), way = plus( other, from, -1 );
				EXPECT_NEAR( static_cast<double>( along[0] * way[0] + along[1] * way[1] + along[2] * way[2] ),
				    by( between, axis, l, 0.25, -0.5, 0.125 ), off_of_both );
			}
		}
	}
}

TEST( BatchKernels, MeetingBodiesAreHeldToStayApart )
{
	SeededRng rng;
	size_t apart = 0, tight = 0;
	for ( int i = 0; i < 20000; ++i )
	{
		const double scale = rng.decade( -6, 6 );
		const lwi_batch_point a = random_point( rng, scale ), b = random_point( rng, scale );
		float min[3], max[3];
		for ( int axis = 0; axis < 3; ++axis )
		{
			const float x = static_cast<float>( scale * rng.uniform( -1, 1 ) ),
			            y = static_cast<float>( scale * rng.uniform( -1, 1 ) );
			min[axis] = std::min( x, y );
			max[axis] = std::max( x, y );
		}
		const float reach = static_cast<float>( scale * rng.uniform( 1e-6, 0.7 ) );
		for ( const bool box : { true, false } )
		{
			const uint32_t met =
			    box ? lwi_kernels_scalar.batch_box( &a, min, max, reach ) : lwi_kernels_scalar.batch_pair( &a, &b, reach );
			for ( int l = 0; l < LWI_WIDTH; ++l )
			{
				double least = INFINITY;
				for ( int k = -20; k <= 20; ++k )
				{
					least = std::min( least, distance_at( a, l, k / 20.0, min, max, box ? nullptr : &b ) );
				}
				if ( ( met >> l & 1 ) == 0 )
				{
					ASSERT_GE( least, static_cast<double>( reach ) - lwi_gap_slack( 8 * scale ) )
					    << "box " << box << ", input " << i;
					++apart;
					tight += least < 1.02 * static_cast<double>( reach ) ? 1u : 0u;
				}
			}
		}
	}
	EXPECT_GE( apart, 50000u );
	EXPECT_GE( tight, 500u ); // some come as near as they may
}

TEST( BatchKernels, NoNumberReadsAsApart )
{
	SeededRng rng;
	for ( const float bad : { NAN, INFINITY, 1e30f } )
	{
		lwi_batch_point a = random_point( rng, 1 ), b = random_point( rng, 1 );
		const float min[3] = { -9, -9, -9 }, max[3] = { -8, -8, -8 };
		for ( int axis = 0; axis < 3; ++axis )
		{
			std::fill( a.displacement[axis], a.displacement[axis] + LWI_WIDTH, bad );
		}
		for ( const lwi_kernels* table : kernelLevels() )
		{
			EXPECT_EQ( 0xffu, table->batch_box( &a, min, max, 1.0f ) ) << bad;
			EXPECT_EQ( 0xffu, table->batch_pair( &a, &b, 1.0f ) ) << bad;
		}
		std::fill( a.p[1], a.p[1] + LWI_WIDTH, NAN );
		EXPECT_EQ( 0xffu, lwi_kernels_scalar.batch_box( &a, min, max, 1.0f ) );
		EXPECT_EQ( 0xffu, lwi_kernels_scalar.batch_pair( &a, &b, 1.0f ) );
	}
	// bodies in the box, and unbounded boxes
	lwi_batch_point inside = random_point( rng, 1 );
	const float min[3] = { -INFINITY, -INFINITY, -INFINITY }, max[3] = { INFINITY, INFINITY, INFINITY };
	EXPECT_EQ( 0xffu, lwi_kernels_scalar.batch_box( &inside, min, max, 1e-6f ) );
}
