// SPDX-License-Identifier: BSD-3-Clause
// Enclosing spheres of real robots: no point of a mesh is outside, however densely it is looked at.
#include "leeway/io/spheres.hpp"

#include "seeded_rng.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace
{

namespace io = leeway::io;

const io::LinkModel& linkOf( const io::RobotModel& model, const std::string& name )
{
	for ( const io::LinkModel& link : model.links )
	{
		if ( link.name == name )
		{
			return link;
		}
	}
	throw std::runtime_error( name );
}

double gap( const io::LinkSpheres& link, const lw_vec3& p )
{
	double best = INFINITY;
	for ( std::size_t i = 0; i < link.count(); ++i )
	{
		const double* s = link.spheres.data() + 4 * i;
		best = std::min( best, std::hypot( p.x - s[0], p.y - s[1], p.z - s[2] ) - s[3] );
	}
	return best;
}

void expectEnclosed( const std::string& urdf, double excess, int samples_per_link )
{
	SeededRng rng;
	const io::RobotModel model = io::loadRobot( std::string( LEEWAY_DATA_DIR ) + urdf, "" );
	io::SpherizeOptions options;
	options.excess = excess;
	const std::vector<io::LinkSpheres> links = io::spherize( model, options );
	std::size_t with_geometry = 0, count = 0;
	for ( const io::LinkModel& link : model.links )
	{
		with_geometry += link.collision.empty() ? 0 : 1;
	}
	EXPECT_EQ( links.size(), with_geometry );
	for ( const io::LinkSpheres& link : links )
	{
		EXPECT_TRUE( link.report.encloses );
		EXPECT_LE( link.report.excess, excess ) << link.link;
		count += link.count();
		for ( const io::PlacedShape& placed : linkOf( model, link.link ).collision )
		{
			const double* vertices = lw_shape_vertices( placed.shape.get() );
			const uint32_t* triangles = lw_shape_triangles( placed.shape.get() );
			const uint32_t n = lw_shape_get_info( placed.shape.get() ).triangle_count;
			for ( int i = 0; n > 0 && i < samples_per_link; ++i )
			{
				const uint32_t* t = triangles + 3 * static_cast<std::size_t>( rng.integer( 0, static_cast<int>( n ) - 1 ) );
				double u = rng.uniform( 0, 1 ), v = rng.uniform( 0, 1 );
				// one in four on an edge, one in sixteen in a corner
				u = i % 4 == 0 ? 0 : u;
				v = i % 16 == 0 ? 0 : v;
				u = u + v > 1 ? 1 - u : u;
				v = u + v > 1 ? 1 - v : v;
				double p[3];
				for ( int k = 0; k < 3; ++k )
				{
					const double a = vertices[3 * t[0] + k];
					p[k] = a + u * ( vertices[3 * t[1] + k] - a ) + v * ( vertices[3 * t[2] + k] - a );
				}
				EXPECT_LE( gap( link, lw_transform_point( &placed.pose, { p[0], p[1], p[2] } ) ), 1e-12 ) << link.link;
			}
		}
	}
	std::printf( "%s: %zu spheres for %g mm\n", urdf.c_str(), count, 1000 * excess );
}

TEST( SpheresData, TimeEndsWithoutSpheresOfSomeLink )
{
	const io::RobotModel model = io::loadRobot( std::string( LEEWAY_DATA_DIR ) + "/mbm/panda/panda.urdf", "" );
	io::SpherizeOptions options;
	options.seconds = 1e-6;
	for ( double excess : { 0.005, 0.0 } )
	{
		options.excess = excess;
		options.sphere_count = excess > 0 ? 0 : 200;
		for ( const io::LinkSpheres& link : io::spherize( model, options ) )
		{
			EXPECT_TRUE( link.report.encloses ) << link.link;
			EXPECT_GE( link.count(), 1u );
			EXPECT_FALSE( link.met_target );
			EXPECT_GT( link.report.excess, 0.005 );
		}
	}
}

TEST( SpheresData, ThreadsOrTimeNotUsedUpChangeSpheres )
{
	const io::RobotModel model = io::loadRobot( std::string( LEEWAY_DATA_DIR ) + "/mbm/panda/panda.urdf", "" );
	io::SpherizeOptions options;
	options.excess = 0.04;
	options.threads = 1;
	const std::vector<io::LinkSpheres> one = io::spherize( model, options );
	options.threads = 3;
	options.seconds = 1e4;
	const std::vector<io::LinkSpheres> three = io::spherize( model, options );
	ASSERT_EQ( one.size(), three.size() );
	for ( std::size_t i = 0; i < one.size(); ++i )
	{
		EXPECT_EQ( one[i].link, three[i].link );
		EXPECT_EQ( one[i].spheres, three[i].spheres ) << one[i].link;
		EXPECT_TRUE( three[i].met_target );
	}
}

TEST( SpheresData, PandaSticksOut )
{
	expectEnclosed( "/mbm/panda/panda.urdf", 0.02, 4000 );
}
TEST( SpheresData, FetchSticksOut )
{
	expectEnclosed( "/mbm/fetch/fetch.urdf", 0.02, 4000 );
}
TEST( SpheresData, ArmarSticksOut )
{
	expectEnclosed( "/armar3/armar3.urdf", 0.06, 1000 );
}

} // namespace
