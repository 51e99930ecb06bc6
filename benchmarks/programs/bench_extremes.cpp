// SPDX-License-Identifier: BSD-3-Clause
// The long form of tests/extremes: as many pairs of triangles and distance queries at the extremes as wanted, each against
// an oracle of 64 and 113 bits. Case i of a seed is the same whatever came before it, so a run goes on where another one
// ended (--first).
#include "support/bench_program.hpp"
#include "extreme_judge.hpp"
#include "support/provenance.hpp"

#include <atomic>
#include <chrono>
#include <csignal>
#include <mutex>
#include <thread>

namespace
{
using namespace extremes;

struct Settings
{
	std::uint64_t pairs = 10000000, queries = 1000000, solids = 1000000, first = 0, seed = 1;
	unsigned threads = 1;
	int least = -30;
	std::string json;
};

std::atomic<bool> stopped{ false };

void stop( int )
{
	stopped = true;
}

std::uint64_t seedOf( const Settings& settings, std::uint64_t index, std::uint64_t kind )
{
	Random random( settings.seed * 2 + kind );
	return random.bits() + index * 0x632be59bd9b4e019ull;
}

/// Cases are handed out in blocks of this many.
constexpr std::uint64_t block = 4096;

/// Data that all threads share.
struct Run
{
	const Settings& settings;
	std::mutex mutex;
	Findings all;
	std::atomic<std::uint64_t> pair_blocks{ 0 };
	/// Of the two generators of shapes: larger sets; primitives and solids.
	struct Shapes
	{
		ShapePair ( *generate )( Random&, Arrangement, int );
		std::uint64_t kind, wanted;
		std::atomic<std::uint64_t> blocks{ 0 }, queries{ 0 };
	} sets{ randomShapes, 1, settings.queries },
	    solids{ randomSolids, 1ull << 62, settings.solids }; // not the stream of another seed

	explicit Run( const Settings& asked ) : settings( asked ) {}
};

bool triangleBlock( Run& run, Findings& findings )
{
	std::uint64_t begin = run.pair_blocks++ * block, end = std::min( begin + block, run.settings.pairs );
	for ( std::uint64_t i = begin; i < end; ++i )
	{
		std::uint64_t index = run.settings.first + i;
		Random random( seedOf( run.settings, index, 0 ) );
		Family family = static_cast<Family>( index % family_count );
		judgeTriangles( randomPair( random, family ), family_names[family], index, findings );
	}
	return begin < run.settings.pairs;
}

bool shapeBlock( Run& run, Run::Shapes& shapes, lw_query* query, Findings& findings )
{
	if ( shapes.queries >= shapes.wanted )
	{
		return false;
	}
	std::uint64_t begin = shapes.blocks++ * 64, before = findings.queries;
	for ( std::uint64_t i = begin; i < begin + 64; ++i )
	{
		std::uint64_t index = run.settings.first + i;
		Random random( seedOf( run.settings, index, shapes.kind ) );
		judgeShapes( random, static_cast<Arrangement>( index % arrangement_count ), index, query, findings,
		    run.settings.least, shapes.generate );
	}
	shapes.queries += findings.queries - before;
	return true;
}

void work( Run& run )
{
	lw_query_def def = lw_query_def_default();
	lw_query* query = nullptr;
	if ( lw_query_create( &def, nullptr, nullptr, nullptr, &query ) != LW_OK )
	{
		stopped = true;
		return;
	}
	bool more = true;
	while ( more && !stopped )
	{
		// a worst case known already spares the work on milder ones
		Findings mine;
		{
			const std::lock_guard<std::mutex> lock( run.mutex );
			std::copy( std::begin( run.all.worst ), std::end( run.all.worst ), mine.worst );
		}
		bool pairs = triangleBlock( run, mine );
		bool sets = shapeBlock( run, run.sets, query, mine ), solids = shapeBlock( run, run.solids, query, mine );
		more = pairs || sets || solids;
		const std::lock_guard<std::mutex> lock( run.mutex );
		run.all.merge( mine );
	}
	lw_query_destroy( query );
}

void report( const Findings& f, double seconds )
{
	std::printf(
	    "%llu pairs of triangles (%llu by a certificate, %llu in 64 bits, %llu in 113), %llu queries about %llu placements of shapes\n",
	    (unsigned long long)f.pairs, (unsigned long long)f.efforts[0], (unsigned long long)f.efforts[1],
	    (unsigned long long)f.efforts[2], (unsigned long long)f.queries, (unsigned long long)f.placements );
	std::printf( "near %llu, far %llu, violations %llu, undecided %llu; shapes refused %llu; %.0f s\n",
	    (unsigned long long)f.kinds[LW_CLEARANCE_NEAR], (unsigned long long)f.kinds[LW_CLEARANCE_FAR],
	    (unsigned long long)f.kinds[LW_CLEARANCE_VIOLATION], (unsigned long long)f.kinds[LW_CLEARANCE_UNDECIDED],
	    (unsigned long long)f.refused, seconds );
	for ( int i = 0; i < stage_count; ++i )
	{
		std::printf( "%-22s worst / promised %.4f\n", stage_names[i], f.worst[i] );
	}
	std::printf( "broken promises: %llu\n", (unsigned long long)f.broken );
	for ( const std::string& text : f.examples )
	{
		std::printf( "  %s\n", text.c_str() );
	}
}

void write( const Run& run, double seconds, const nlohmann::ordered_json& origin )
{
	const Settings& settings = run.settings;
	const Findings& f = run.all;
	nlohmann::ordered_json out;
	out["program"] = "bench_extremes";
	out["seed"] = settings.seed;
	out["first"] = settings.first;
	out["least_octave"] = settings.least;
	out["threads"] = settings.threads;
	out["seconds"] = seconds;
	out["triangle_pairs"] = f.pairs;
	out["settled_by"] = { { "certificate", f.efforts[0] }, { "64 bits", f.efforts[1] }, { "113 bits", f.efforts[2] } };
	out["queries"] = f.queries;
	out["of_solids"] = run.solids.queries.load();
	out["placements"] = f.placements;
	out["shapes_refused"] = f.refused;
	out["answers"] = { { "near", f.kinds[LW_CLEARANCE_NEAR] }, { "far", f.kinds[LW_CLEARANCE_FAR] },
		{ "violation", f.kinds[LW_CLEARANCE_VIOLATION] }, { "undecided", f.kinds[LW_CLEARANCE_UNDECIDED] } };
	for ( int i = 0; i < stage_count; ++i )
	{
		out["worst_over_promised"][stage_names[i]] = f.worst[i];
	}
	out["broken_promises"] = f.broken;
	out["examples"] = f.examples;
	out["provenance"] = origin;
	writeResult( settings.json, out );
}

int runAll( const Settings& settings )
{
	const nlohmann::ordered_json origin = provenance(); // of the sources as they are now, not when the run ends
	Run run( settings );
	const auto start = std::chrono::steady_clock::now();
	const auto elapsed = [&] { return std::chrono::duration<double>( std::chrono::steady_clock::now() - start ).count(); };
	std::atomic<unsigned> left{ settings.threads };
	std::vector<std::thread> threads;
	for ( unsigned i = 0; i < settings.threads; ++i )
	{
		threads.emplace_back(
			[&]
			{
				work( run );
				--left;
			} );
	}
	for ( int tick = 0; left > 0; ++tick )
	{
		std::this_thread::sleep_for( std::chrono::milliseconds( 100 ) );
		if ( tick % 50 == 49 )
		{
			const std::lock_guard<std::mutex> lock( run.mutex );
			std::fprintf( stderr, "\r%llu pairs, %llu queries, %llu broken, %.0f s ", (unsigned long long)run.all.pairs,
				(unsigned long long)run.all.queries, (unsigned long long)run.all.broken, elapsed() );
		}
	}
	for ( std::thread& thread : threads )
	{
		thread.join();
	}
	std::fprintf( stderr, "\n" );
	report( run.all, elapsed() );
	if ( !settings.json.empty() )
	{
		write( run, elapsed(), origin );
	}
	return run.all.broken == 0 ? 0 : 1;
}

} // namespace

int main( int argc, char** argv )
{
	Settings settings;
	BenchProgram program( "bench_extremes", "leeway at the extremes against an oracle of 64 and 113 bits." );
	program.option( "--pairs", settings.pairs, "pairs of triangles" );
	program.option( "--queries", settings.queries, "distance queries of meshes and sets, some 25 for each two shapes" );
	program.option( "--solids", settings.solids, "the same of primitives, solid meshes, half-spaces and planes" );
	program.option( "--first", settings.first, "number of the first case: where an earlier run of this seed ended" );
	program.option( "--seed", settings.seed, "of all cases" );
	program.option( "--threads", settings.threads, "that ask", { 1, 256 } );
	program.option( "--least", settings.least, "the least size of shapes, as a power of two of metres", { -1060, 20 } );
	program.option( "--json", settings.json, "write counts, ratios and provenance to this file" );
	return program.run( argc, argv,
		[&]
		{
			std::signal( SIGINT, stop );
			std::signal( SIGTERM, stop );
			return runAll( settings );
		} );
}
