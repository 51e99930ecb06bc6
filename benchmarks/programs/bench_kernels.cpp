// SPDX-License-Identifier: BSD-3-Clause
// The innermost loops by Google Benchmark: float filters at every SIMD level, the exact triangle distance, and whole queries
// of two finely meshed spheres facing each other (the weak spot of sphere trees).
#include "leeway/leeway.h"

#include "distance/tri_tri.h"
#include "simd/kernels.h"

#include <benchmark/benchmark.h>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

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

void exactTriangles( benchmark::State& state )
{
	constexpr std::size_t COUNT = 1024;
	const std::vector<lw_vec3> a = randomTriangles( COUNT );
	std::size_t i = 0;
	for ( auto _ : state )
	{
		lwi_tri_result result = lwi_tri_tri( &a[3 * i], &a[3 * ( COUNT - 1 - i )] );
		benchmark::DoNotOptimize( result );
		i = ( i + 1 ) % COUNT;
	}
}
BENCHMARK( exactTriangles );

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
		const std::uint32_t lanes = kernel == 0 ? kernels.sphere_gap( nodes[i].x, spheres[i], INFINITY, gap )
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

void filter( benchmark::State& state, int kernel, int level )
{
	const lwi_kernels* kernels = lwi_kernels_get( static_cast<lw_simd>( level ) );
	const auto input = std::make_unique<KernelInput>();
	for ( auto _ : state )
	{
		benchmark::DoNotOptimize( input->run( *kernels, kernel ) );
	}
	// Each run is eight tests
	state.SetItemsProcessed( 8 * static_cast<std::int64_t>( state.iterations() ) );
}

/// A sphere of 0.5 m, 2 n n triangles.
lw_shape* meshedSphere( uint32_t n )
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
	return lw_shape_create_mesh( &def, nullptr, nullptr, &shape ) == LW_OK ? shape : nullptr;
}

/// Two spheres of 5000 triangles at a gap that shrinks and grows by a tenth.
void facingSpheres( benchmark::State& state, int level, double gap )
{
	lw_shape* sphere = meshedSphere( 50 );
	lw_query_def def = lw_query_def_default();
	def.simd = static_cast<lw_simd>( level );
	lw_query* query = nullptr;
	if ( sphere == nullptr || lw_query_create( &def, nullptr, nullptr, nullptr, &query ) != LW_OK )
	{
		state.SkipWithError( "out of memory" );
		return;
	}
	const lw_transform a = lw_transform_identity();
	lw_transform b = lw_transform_identity();
	int i = 0;
	for ( auto _ : state )
	{
		b.t[0] = 1 + gap * ( 1 + 0.1 * std::sin( 0.1 * i++ ) );
		lw_clearance clearance;
		if ( lw_shape_distance( sphere, &a, sphere, &b, nullptr, query, &clearance ) != LW_OK )
		{
			state.SkipWithError( "query failed" );
			break;
		}
		benchmark::DoNotOptimize( clearance );
	}
	lw_query_destroy( query );
	lw_shape_release( sphere );
}

void registerAll()
{
	static const char* const kernels[] = { "sphereGap", "leafGap", "triangleGap" };
	for ( int level = LW_SIMD_SCALAR; level <= lw_simd_available(); ++level )
	{
		for ( int kernel = 0; kernel < 3 && lw_simd_supported( static_cast<lw_simd>( level ) ); ++kernel )
		{
			const std::string name = std::string( kernels[kernel] ) + "/" + LEVELS[level];
			benchmark::RegisterBenchmark( name.c_str(), filter, kernel, level );
		}
		for ( double gap : { 0.5, 0.05, 0.005 } )
		{
			const std::string name =
			    "facingSpheres/" + std::to_string( static_cast<int>( gap * 1000 ) ) + "mm/" + LEVELS[level];
			benchmark::RegisterBenchmark( name.c_str(), facingSpheres, level, gap );
		}
	}
}

} // namespace

int main( int argc, char** argv )
{
	registerAll();
	benchmark::Initialize( &argc, argv );
	if ( benchmark::ReportUnrecognizedArguments( argc, argv ) )
	{
		return 2;
	}
	benchmark::RunSpecifiedBenchmarks();
	return 0;
}
