// SPDX-License-Identifier: BSD-3-Clause
// Prints digests of answers over random robots, scenes and shapes, a line for each part. Two levels of kernels, or two kinds of
// machine, that print the same lines gave the same bits (compare.cmake, ../arm64/run.sh). The first line of each world digests
// its inputs: a difference there is one of the random numbers, not of an answer.
#include "leeway/handles.hpp"
#include "random_robot.hpp"

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace
{

/// Numbers of answers, collected and digested. NaN has many bit patterns, of which machines choose different ones.
class Digest
{
public:
	void add( double value )
	{
		const double one = std::isnan( value ) ? static_cast<double>( NAN ) : value;
		m_digest = lw_digest_bytes( m_digest, &one, sizeof( one ) );
	}
	void add( const lw_clearance& c )
	{
		for ( double value :
		    { c.lower, c.upper, static_cast<double>( c.kind ), static_cast<double>( c.a ), static_cast<double>( c.b ) } )
		{
			add( value );
		}
		if ( std::isfinite( c.upper ) )
		{
			for ( const lw_vec3& p : { c.point_a, c.point_b } )
			{
				add( p.x );
				add( p.y );
				add( p.z );
			}
		}
	}
	void add( const lw_query_stats& s )
	{
		for ( std::uint64_t count :
		    { s.queries, s.node_tests, s.leaf_tests, s.triangle_tests, s.exact_tests, s.robot_tests } )
		{
			add( static_cast<double>( count ) );
		}
	}
	void add( const void* bytes, std::size_t size ) { m_digest = lw_digest_bytes( m_digest, bytes, size ); }
	void add( lw_digest digest ) { add( &digest, sizeof( digest ) ); }
	void print( int world, const char* part ) const
	{
		std::printf( "world %d %-12s %016" PRIx64 "%016" PRIx64 "\n", world, part, m_digest.word[0], m_digest.word[1] );
	}

private:
	lw_digest m_digest = {};
};

/// Bytes of a blob of one shape or of a reach: trees, boxes, hulls, tables.
std::string blobOf( const lw_shape* shape, const lw_reach* reach )
{
	lw_blob_def def = lw_blob_def_default();
	def.shapes = &shape;
	def.shape_count = shape != nullptr ? 1 : 0;
	def.reach = reach;
	void* bytes = nullptr;
	std::size_t size = 0;
	leeway::require( lw_blob_write( &def, nullptr, nullptr, &bytes, &size ), "blob" );
	const std::string blob( static_cast<const char*>( bytes ), size );
	lw_blob_free( nullptr, bytes, size );
	return blob;
}

/// All that a reach proves; its blob has the time that it took, too.
void addReach( Digest& digest, const lw_reach* reach )
{
	const std::uint32_t links = lw_robot_link_count( lw_reach_robot( reach ) );
	for ( std::uint32_t i = 0; i < links; ++i )
	{
		const lw_reach_node node = lw_reach_get_node( reach, i );
		for ( const lw_sphere& s : { node.r, node.m, node.mr } )
		{
			digest.add( &s, sizeof( s ) );
		}
		digest.add( lw_reach_hull_points( reach, i ), node.hull_point_count * 3 * sizeof( double ) );
		digest.add( node.dilation );
		for ( std::uint32_t k = 0; k < links; ++k )
		{
			const lw_reach_pair pair = lw_reach_get_pair( reach, i, k );
			for ( double value :
			    { static_cast<double>( pair.kind ), static_cast<double>( pair.proof ), pair.separation, pair.closest } )
			{
				digest.add( value );
			}
		}
	}
}

struct World
{
	RobotModel model;
	RobotPtr robot;
	leeway::Scene scene;
	leeway::Reach reach;
	leeway::Checker checker;
	std::vector<ShapePtr> shapes; ///< of the scene
};

leeway::Scene makeScene( SeededRng& rng, World& world )
{
	std::vector<std::string> names( 12 );
	std::vector<const char*> pointers;
	std::vector<lw_scene_shape_def> defs;
	for ( std::uint32_t i = 0; i < names.size(); ++i )
	{
		world.shapes.emplace_back(
		    i % 3 != 0 ? randomMesh( rng, 20, 0.15, nullptr ) : randomPrimitive( rng, 0.2, nullptr ) );
		names[i] = "object" + std::to_string( i );
		pointers.push_back( names[i].c_str() );
		defs.push_back( { world.shapes.back().get(), i, randomTransform( rng, 2 ) } );
	}
	lw_scene_def def = lw_scene_def_default();
	def.object_names = pointers.data();
	def.object_count = static_cast<std::uint32_t>( pointers.size() );
	def.shapes = defs.data();
	def.shape_count = static_cast<std::uint32_t>( defs.size() );
	lw_scene* scene = nullptr;
	lw_diag diag = {};
	leeway::require( lw_scene_create( &def, nullptr, &diag, &scene ), diag );
	return leeway::Scene::adopt( scene );
}

/// The reach of a robot, by default made here. Motion hulls are those that the machine's qhull proposes: Debian's build for
/// 64-bit ARM fuses multiplications and additions, and drops other points of nearly flat faces. They are proved on each
/// machine, but not equal. So that answers can be compared, `folder` has the reaches that another machine wrote.
leeway::Reach makeReach( const lw_robot* robot, int number, const char* folder, bool write )
{
	const std::string path = std::string( folder != nullptr ? folder : "" ) + "/reach" + std::to_string( number ) + ".blob";
	lw_reach* reach = nullptr;
	lw_diag diag = {};
	if ( folder != nullptr && !write )
	{
		std::ifstream file( path, std::ios::binary );
		const std::string blob{ std::istreambuf_iterator<char>( file ), {} };
		leeway::require( lw_blob_read_reach( blob.data(), blob.size(), {}, robot, nullptr, &diag, &reach ), diag );
		return leeway::Reach::adopt( reach );
	}
	lw_reach_def def = lw_reach_def_default();
	def.robot = robot;
	def.samples = 200;
	def.seconds = 0; // no proofs by the clock: the same steps everywhere
	leeway::require( lw_reach_create( &def, nullptr, &diag, &reach ), diag );
	if ( write )
	{
		std::ofstream( path, std::ios::binary ) << blobOf( nullptr, reach );
	}
	return leeway::Reach::adopt( reach );
}

World makeWorld( SeededRng& rng, int number, const char* folder, bool write )
{
	World world;
	RandomRobotOptions options;
	options.floating = number % 3 == 0;
	options.triangles = 20;
	world.model = randomRobot( rng, options );
	world.robot = world.model.create();
	world.scene = makeScene( rng, world );
	lw_diag diag = {};
#ifdef LEEWAY_HULLS
	if ( !options.floating ) // the hulls of joints without limits need limits of the caller
	{
		world.reach = makeReach( world.robot.get(), number, folder, write );
	}
#else
	(void)folder, (void)write;
#endif
	lw_checker_def def = lw_checker_def_default();
	def.robot = world.robot.get();
	def.scene = world.scene.get();
	def.reach = world.reach.get();
	lw_checker* checker = nullptr;
	leeway::require( lw_checker_create( &def, nullptr, &diag, &checker ), diag );
	world.checker = leeway::Checker::adopt( checker );
	return world;
}

void printInputs( const World& world, int number )
{
	Digest inputs, trees, reach;
	inputs.add( lw_robot_digest( world.robot.get() ) );
	for ( const std::vector<ShapePtr>* list : { &world.shapes, &world.model.shapes } )
	{
		for ( const ShapePtr& shape : *list )
		{
			inputs.add( lw_shape_digest( shape.get() ) );
			const std::string tree = blobOf( shape.get(), nullptr );
			trees.add( tree.data(), tree.size() );
		}
	}
	inputs.print( number, "inputs" );
	trees.print( number, "trees" );
	if ( world.reach )
	{
		addReach( reach, world.reach.get() );
		reach.print( number, "reach" );
	}
}

void printDistances( SeededRng& rng, const World& world, int number )
{
	Digest digest;
	const leeway::Query query = leeway::makeQuery( nullptr, lw_query_def_default() );
	for ( const ShapePtr& a : world.model.shapes )
	{
		for ( const ShapePtr& b : world.shapes )
		{
			const lw_transform at = randomTransform( rng, 0.3 ), other = randomTransform( rng, 0.3 );
			lw_clearance clearance;
			leeway::require(
			    lw_shape_distance( a.get(), &at, b.get(), &other, nullptr, query.get(), &clearance ), "distance" );
			digest.add( clearance );
		}
	}
	digest.add( lw_query_get_stats( query.get() ) );
	digest.print( number, "distances" );
}

void printStatesAndEdges( SeededRng& rng, const World& world, int number )
{
	Digest states, edges, counts;
	const leeway::Query query = leeway::makeQuery( world.checker.get(), lw_query_def_default() );
	State last = randomState( rng, world.robot.get() );
	for ( int i = 0; i < 60; ++i )
	{
		State q = randomState( rng, world.robot.get() );
		const lw_range near = { 0, 0.2, 0.1 };
		lw_state_result state;
		leeway::require( lw_checker_state( world.checker.get(), query.get(), q.data(), LW_CHECK_BOTH,
		                     i % 2 ? &near : nullptr, false, &state ),
		    "state" );
		states.add( static_cast<double>( state.verdict ) );
		states.add( state.environment );
		states.add( state.self );
		lw_edge_def def = lw_edge_def_default();
		def.flags = i % 2 ? LW_CHECK_ENVIRONMENT : LW_CHECK_BOTH;
		def.want_proved_until = true;
		for ( std::size_t k = 0; k < q.size(); ++k ) // shorter, so that some are free
		{
			q[k] = last[k] + 0.2 * ( q[k] - last[k] );
		}
		lw_edge_result edge;
		leeway::require( lw_checker_edge( world.checker.get(), query.get(), last.data(), q.data(), &def, &edge ), "edge" );
		for ( double value : { static_cast<double>( edge.verdict ), edge.t, edge.proved_until, edge.lower_bound,
		          static_cast<double>( edge.queries ) } )
		{
			edges.add( value );
		}
		edges.add( edge.pair );
		last = randomState( rng, world.robot.get() );
	}
	counts.add( lw_query_get_stats( query.get() ) );
	states.print( number, "states" );
	edges.print( number, "edges" );
	counts.print( number, "work" );
}

} // namespace

// print_answers [COUNT [write FOLDER | read FOLDER]]: the reaches are written to FOLDER, or are those that it has
int main( int argc, char** argv )
{
	const int worlds = argc > 1 ? std::atoi( argv[1] ) : 12;
	const char* folder = argc > 3 ? argv[3] : nullptr;
	for ( int number = 0; number < worlds; ++number )
	{
		SeededRng rng( 100 + static_cast<std::uint64_t>( number ) );
		const World world = makeWorld( rng, number, folder, argc > 3 && argv[2] == std::string( "write" ) );
		printInputs( world, number );
		printDistances( rng, world, number );
		printStatesAndEdges( rng, world, number );
	}
	return 0;
}
