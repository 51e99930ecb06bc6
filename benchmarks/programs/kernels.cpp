// SPDX-License-Identifier: BSD-3-Clause
// The innermost loops: float filters at every SIMD level, the exact triangle distance, and whole queries of two finely meshed
// spheres facing each other (the weak spot of sphere trees).
//
// Each loop runs in rounds of a millisecond or more; the loops take turns round by round, and a time is the median of the rounds.
#include "distance/tri_tri.h"
#include "programs/commands.hpp"
#include "simd/kernels.h"
#include "support/race.hpp"

#include "leeway/handles.hpp"
#include "leeway/leeway.h"

#include <cmath>
#include <cstdio>

namespace
{

const char* const LEVELS[] = { "", "scalar", "SSE2", "AVX2", "NEON" };

/// Triangles of a few centimetres, a few centimetres apart: typical of the pairs that reach the leaves.
std::vector<lw_vec3> randomTriangles( std::size_t count )
{
	std::mt19937_64 random( 20260101 );
	const auto uniform = [&random] { return static_cast<double>( random() >> 11 ) * 0x1p-53 * 0.1; };
	std::vector<lw_vec3> vertices( 3 * count );
	for ( lw_vec3& v : vertices )
	{
		v = { uniform(), uniform(), uniform() };
	}
	return vertices;
}

/// A loop to measure: so many calls of it, whose results end in `sink`, or the compiler would leave them out.
struct Loop
{
	std::string name;
	std::function<double( std::size_t calls )> run;
};

volatile double sink;

Loop exactTriangles()
{
	constexpr std::size_t COUNT = 1024;
	return { "exactTriangles", [a = randomTriangles( COUNT )]( std::size_t calls )
	    {
		    double sum = 0;
		    for ( std::size_t i = 0; i < calls; ++i )
		    {
			    const std::size_t k = i % COUNT;
			    sum += lwi_tri_tri( &a[3 * k], &a[3 * ( COUNT - 1 - k )] ).distance;
		    }
		    return sum;
	    } };
}

/// Random input of the kernels: enough that nothing is predicted, few enough to stay in the first cache.
struct alignas( 64 ) KernelInput // the kernels load whole registers
{
	static constexpr int COUNT = 64;
	lwi_node nodes[COUNT] = {};
	lwi_leaf leaves[COUNT] = {};
	float spheres[COUNT][4];

	KernelInput()
	{
		for ( int i = 0; i < COUNT; ++i )
		{
			for ( int lane = 0; lane < LWI_WIDTH; ++lane )
			{
				nodes[i].x[lane] = nextNumber();
				nodes[i].y[lane] = nextNumber();
				nodes[i].z[lane] = nextNumber();
				nodes[i].r[lane] = 0.1f * nextNumber();
				for ( int k = 0; k < 9; ++k )
				{
					leaves[i].v[k / 3][k % 3][lane] = nextNumber();
				}
			}
			for ( float& value : spheres[i] )
			{
				value = nextNumber();
			}
		}
	}

	/// One call for eight lanes. @param kernel 0 sphere against spheres, 1 sphere against triangles, 2 triangles against
	/// triangles
	/// @return one of the gaps, or 0
	float run( const lwi_kernels& kernels, int kernel )
	{
		const std::uint32_t i = m_next;
		m_next = ( i + 1 ) % COUNT;
		float gap[LWI_WIDTH], direction[3][LWI_WIDTH];
		const std::uint32_t lanes = kernel == 0   ? kernels.sphere_gap( nodes[i].x, spheres[i], INFINITY, gap )
		                            : kernel == 1 ? kernels.leaf_gap( &leaves[i], spheres[i], INFINITY, gap, direction )
		                                          : kernels.triangle_gap( leaves[i].v, leaves[m_next].v, INFINITY, gap );
		return lanes != 0 ? gap[0] : 0;
	}

private:
	std::uint32_t m_state = 1, m_next = 0;

	/// In [0, 0.1): a linear congruence is random enough to feed a kernel.
	float nextNumber()
	{
		m_state = m_state * 1664525u + 1013904223u;
		return static_cast<float>( m_state >> 8 ) * ( 0.1f / 16777216.0f );
	}
};

/// A call is eight tests.
Loop filter( const std::string& name, int kernel, int level )
{
	const lwi_kernels* kernels = lwi_kernels_get( static_cast<lw_simd>( level ) );
	return { name, [kernels, kernel, input = std::make_shared<KernelInput>()]( std::size_t calls )
	    {
		    double sum = 0;
		    for ( std::size_t i = 0; i < calls; ++i )
		    {
			    sum += static_cast<double>( input->run( *kernels, kernel ) );
		    }
		    return sum;
	    } };
}

/// A sphere of 0.5 m, 2 n n triangles.
leeway::Shape meshedSphere( uint32_t n )
{
	constexpr double PI = 3.14159265358979323846;
	std::vector<double> vertices;
	std::vector<uint32_t> indices;
	for ( uint32_t i = 0; i <= n; ++i )
	{
		for ( uint32_t j = 0; j <= n; ++j )
		{
			const double theta = PI * i / n, phi = 2 * PI * j / n;
			vertices.insert( vertices.end(), { 0.5 * std::sin( theta ) * std::cos( phi ),
			                                     0.5 * std::sin( theta ) * std::sin( phi ), 0.5 * std::cos( theta ) } );
		}
	}
	for ( uint32_t i = 0; i < n; ++i )
	{
		for ( uint32_t j = 0; j < n; ++j )
		{
			const uint32_t k = i * ( n + 1 ) + j;
			indices.insert( indices.end(), { k, k + 1, k + n + 2, k, k + n + 2, k + n + 1 } );
		}
	}
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = vertices.data();
	def.vertex_count = static_cast<uint32_t>( vertices.size() / 3 );
	def.indices = indices.data();
	def.triangle_count = static_cast<uint32_t>( indices.size() / 3 );
	lw_shape* shape = nullptr;
	leeway::require( lw_shape_create_mesh( &def, nullptr, nullptr, &shape ), "a sphere" );
	return leeway::Shape::adopt( shape );
}

/// Two spheres of 5000 triangles at a gap that shrinks and grows by a tenth.
Loop facingSpheres( const std::string& name, int level, double gap )
{
	lw_query_def def = lw_query_def_default();
	def.simd = static_cast<lw_simd>( level );
	lw_query* made = nullptr;
	leeway::require( lw_query_create( &def, nullptr, nullptr, nullptr, &made ), "a query" );
	const auto query = std::make_shared<leeway::Query>( made );
	return { name, [sphere = meshedSphere( 50 ), query, gap]( std::size_t calls )
	    {
		    const lw_transform a = lw_transform_identity();
		    lw_transform b = lw_transform_identity();
		    double sum = 0;
		    for ( std::size_t i = 0; i < calls; ++i )
		    {
			    b.t[0] = 1 + gap * ( 1 + 0.1 * std::sin( 0.1 * static_cast<double>( i ) ) );
			    lw_clearance clearance;
			    leeway::require( lw_shape_distance( sphere.get(), &a, sphere.get(), &b, nullptr, query->get(), &clearance ),
			        "a distance" );
			    sum += clearance.upper;
		    }
		    return sum;
	    } };
}

std::vector<Loop> allLoops()
{
	static const char* const kernels[] = { "sphereGap", "leafGap", "triangleGap" };
	std::vector<Loop> loops = { exactTriangles() };
	for ( int level = LW_SIMD_SCALAR; level <= lw_simd_available(); ++level )
	{
		if ( !lw_simd_supported( static_cast<lw_simd>( level ) ) )
		{
			continue;
		}
		for ( int kernel = 0; kernel < 3; ++kernel )
		{
			loops.push_back( filter( std::string( kernels[kernel] ) + "/" + LEVELS[level], kernel, level ) );
		}
		for ( const char* gap : { "0.5", "0.05", "0.005" } )
		{
			loops.push_back(
			    facingSpheres( std::string( "facingSpheres/" ) + gap + " m/" + LEVELS[level], level, std::stod( gap ) ) );
		}
	}
	return loops;
}

/// Microseconds of so many calls.
double timeOf( const Loop& loop, std::size_t calls )
{
	const double start = threadMicroseconds();
	sink = loop.run( calls );
	return threadMicroseconds() - start;
}

int run( const std::string& only, int rounds, Result& result )
{
	std::vector<Loop> loops;
	std::vector<std::size_t> calls;
	for ( Loop& loop : allLoops() )
	{
		if ( loop.name.find( only ) != std::string::npos )
		{
			std::size_t count = 1;
			while ( timeOf( loop, count ) < 1000 )
			{
				count *= 2;
			}
			loops.push_back( std::move( loop ) );
			calls.push_back( count );
		}
	}
	std::vector<std::vector<double>> times( loops.size() );
	for ( int round = 0; round < rounds; ++round )
	{
		for ( std::size_t i = 0; i < loops.size(); ++i )
		{
			times[i].push_back( timeOf( loops[i], calls[i] ) / static_cast<double>( calls[i] ) );
		}
	}
	std::printf( "nanoseconds a call: median and quartiles of %d rounds; filters test eight pairs a call\n", rounds );
	for ( std::size_t i = 0; i < loops.size(); ++i )
	{
		Summary s = summarise( times[i] );
		std::sort( times[i].begin(), times[i].end() );
		s.mean = s.median; // a round may be interrupted
		s.lower = quantile( times[i], 0.25 );
		s.upper = quantile( times[i], 0.75 );
		std::printf( "%-28s %10.1f %10.1f %10.1f\n", loops[i].name.c_str(), 1e3 * s.median, 1e3 * s.lower, 1e3 * s.upper );
		Json row = { { "loop", loops[i].name } };
		row.update( toJson( s ) );
		result.add( std::move( row ) );
	}
	if ( loops.empty() )
	{
		throw std::runtime_error( "--only " + only + ": no loop has that in its name" );
	}
	return 0;
}

struct Settings
{
	std::string only;
	int rounds = 101;
};

} // namespace

void addKernels( Bench& bench )
{
	const auto s = std::make_shared<Settings>();
	Command& command = bench.command( "kernels", "the innermost loops by themselves, at each SIMD level" );
	command.option( "--only", s->only, "loops with this in their name, such as leafGap or AVX2" );
	command.option( "--rounds", s->rounds, "of each loop", { 1, 100000 } );
	command.work( [s]( Result& result ) { return run( s->only, s->rounds, result ); } );
}
