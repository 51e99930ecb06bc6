// SPDX-License-Identifier: BSD-3-Clause
// Memory runs out at the first allocation, at the second, ...: for everything of the core that creates, edits, reads or
// writes. Each time there is a status, no object, nothing is left over, and earlier objects are unchanged. Questions
// take no memory.
#include "checker_handles.hpp"
#include "counting_allocator.hpp"
#include "random_robot.hpp"

#include "leeway/leeway.h"
#include "shape/shape.h"

#include <functional>

namespace
{

using DonePtr = std::function<void()>;

/// Calls `create` with fewer allocations than it wants, one more each time, until it is content.
/// @param create with an allocator; puts a function into `release` if it made something
/// @return how many allocations it took
int failEach( const char* name, const std::function<lw_status( const lw_allocator*, lw_diag*, DonePtr& release )>& create )
{
	for ( int allowed = 0; allowed < 20000; ++allowed )
	{
		CountingAllocator memory;
		memory.left = allowed;
		const lw_allocator allocator = memory.get();
		lw_diag diag{};
		DonePtr release;
		const lw_status status = create( &allocator, &diag, release );
		EXPECT_EQ( status == LW_OK, static_cast<bool>( release ) ) << name << " with " << allowed;
		if ( release )
		{
			memory.left = 1 << 30;
			release();
		}
		EXPECT_EQ( memory.live, 0 ) << name << " with " << allowed;
		EXPECT_EQ( memory.bytes, 0u ) << name << " with " << allowed << ": freed with another size than allocated";
		if ( status == LW_OK )
		{
			EXPECT_GT( allowed, 0 ) << name << " allocates nothing by the allocator it is given";
			return allowed;
		}
		EXPECT_EQ( status, LW_ERROR_OUT_OF_MEMORY ) << name << " with " << allowed << ": " << diag.message;
		if ( status != LW_ERROR_OUT_OF_MEMORY )
		{
			return allowed;
		}
	}
	ADD_FAILURE() << name << " is never content";
	return 0;
}

template <typename T, typename F>
std::function<lw_status( const lw_allocator*, lw_diag*, DonePtr& )> making( F call, void ( *free )( T* ) )
{
	return [call, free]( const lw_allocator* allocator, lw_diag* diag, DonePtr& release )
	{
		T* made = reinterpret_cast<T*>( std::uintptr_t( 8 ) ); // must be overwritten, whatever happens
		const lw_status status = call( allocator, diag, &made );
		EXPECT_TRUE( ( status == LW_OK ) == ( made != nullptr ) );
		if ( made != nullptr )
		{
			release = [made, free] { free( made ); };
		}
		return status;
	};
}

/// A small world of everything, by malloc.
struct World
{
	SeededRng rng;
	RobotModel model;
	RobotPtr robot, holding;
	ShapePtr mesh, ball, cell;
	ScenePtr scene;
	CheckerPtr checker;
	std::vector<double> numbers;
	std::vector<std::uint32_t> indices;

	World()
	{
		RandomRobotOptions options;
		options.joints = 4;
		options.size = 0.1;
		options.triangles = 12;
		options.floating = false;
		model = randomRobot( rng, options );
		robot = model.create();
		mesh.reset( randomMesh( rng, 40, 0.2, nullptr ) );
		ball.reset( randomPrimitive( rng, 0.2, nullptr ) );
		cell.reset( randomMesh( rng, 3, 0.2, nullptr ) );
		for ( int i = 0; i < 60; ++i )
		{
			numbers.push_back( rng.uniform( 0, 1 ) );
			indices.push_back( static_cast<std::uint32_t>( rng.integer( 0, 19 ) ) );
		}
		scene.reset( makeScene( nullptr, nullptr ) );
		holding.reset( attach( nullptr, nullptr ) );
		checker.reset( makeChecker( nullptr, nullptr, nullptr ) );
	}

	lw_scene_def sceneDef()
	{
		static const char* const names[] = { "a", "b" };
		placed = { { mesh.get(), 0, randomTransform( rng, 2 ) }, { ball.get(), 0, randomTransform( rng, 2 ) },
		    { cell.get(), 1, randomTransform( rng, 2 ) } };
		lw_scene_def def = lw_scene_def_default();
		def.object_names = names;
		def.object_count = 2;
		def.shapes = placed.data();
		def.shape_count = 3;
		return def;
	}
	lw_scene* makeScene( const lw_allocator* allocator, lw_diag* diag )
	{
		const lw_scene_def def = sceneDef();
		lw_scene* made = nullptr;
		(void)lw_scene_create( &def, allocator, diag, &made );
		return made;
	}
	lw_status attach( const lw_allocator* allocator, lw_diag* diag, lw_robot** out )
	{
		const lw_shape* shapes[] = { cell.get() };
		const lw_transform pose = lw_transform_identity();
		const std::uint32_t touch[] = { 0 };
		lw_attachment_def def = lw_attachment_def_default();
		def.name = "held";
		def.link = 1;
		def.shapes = shapes;
		def.link_from_shape = &pose;
		def.shape_count = 1;
		def.touch_links = touch;
		def.touch_link_count = 1;
		return lw_robot_attach( robot.get(), &def, allocator, diag, out );
	}
	lw_robot* attach( const lw_allocator* allocator, lw_diag* diag )
	{
		lw_robot* made = nullptr;
		(void)attach( allocator, diag, &made );
		return made;
	}
	lw_checker_def checkerDef( const lw_reach* reach )
	{
		lw_checker_def def = lw_checker_def_default();
		def.robot = robot.get();
		def.scene = scene.get();
		def.reach = reach;
		def.margins.environment = 0.01;
		def.margins.self = 0.005;
		return def;
	}
	lw_checker* makeChecker( const lw_allocator* allocator, lw_diag* diag, const lw_reach* reach )
	{
		const lw_checker_def def = checkerDef( reach );
		lw_checker* made = nullptr;
		(void)lw_checker_create( &def, allocator, diag, &made );
		return made;
	}

	std::vector<lw_scene_shape_def> placed;
};

using Allocator = const lw_allocator*;

} // namespace

TEST( Faults, ShapesWithoutMemory )
{
	World w;
	for ( bool solid : { false, true } )
	{
		for ( double tile : { 0.0, 0.3 } )
		{
			lw_mesh_def def = lw_mesh_def_default();
			def.vertices = w.numbers.data();
			def.vertex_count = 20;
			def.indices = w.indices.data();
			def.triangle_count = 20;
			def.weld_tolerance = tile > 0 ? 1e-3 : 0;
			def.tree.tile_radius = tile;
			const double corners[] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1 };
			const std::uint32_t faces[] = { 0, 1, 2, 0, 1, 3, 0, 2, 3, 1, 2, 3 };
			if ( solid )
			{
				def.solid = true;
				def.tree.tile_radius = 0;
				def.vertices = corners;
				def.vertex_count = def.triangle_count = 4;
				def.indices = faces;
			}
			failEach( "mesh", making<lw_shape>( [&]( Allocator a, lw_diag* d, lw_shape** out )
			                      { return lw_shape_create_mesh( &def, a, d, out ); },
			                      lw_shape_release ) );
		}
	}
	const lw_tree_def tree = lw_tree_def_default();
	failEach( "points", making<lw_shape>( [&]( Allocator a, lw_diag* d, lw_shape** out )
	                        { return lw_shape_create_points( w.numbers.data(), 20, 0.1, &tree, a, d, out ); },
	                        lw_shape_release ) );
	failEach( "spheres", making<lw_shape>( [&]( Allocator a, lw_diag* d, lw_shape** out )
	                         { return lw_shape_create_spheres( w.numbers.data(), 15, &tree, a, d, out ); },
	                         lw_shape_release ) );
	std::vector<double> boxes = w.numbers;
	for ( std::size_t i = 0; i < boxes.size(); ++i )
	{
		boxes[i] += i % 6 >= 3 ? 1 : 0;
	}
	failEach( "boxes", making<lw_shape>( [&]( Allocator a, lw_diag* d, lw_shape** out )
	                       { return lw_shape_create_boxes( boxes.data(), 10, &tree, a, d, out ); },
	                       lw_shape_release ) );
	const double sizes[3] = { 1, 1, 1 };
	for ( int type = LW_SHAPE_BOX; type <= LW_SHAPE_PLANE; ++type )
	{
		if ( type == LW_SHAPE_SPHERES || type == LW_SHAPE_BOXES )
		{
			continue;
		}
		failEach(
		    "primitive", making<lw_shape>( [&]( Allocator a, lw_diag* d, lw_shape** out )
		                     { return lw_shape_create_primitive( static_cast<lw_shape_type>( type ), sizes, a, d, out ); },
		                     lw_shape_release ) );
	}
	failEach( "detail", making<lw_shape>( [&]( Allocator a, lw_diag* d, lw_shape** out )
	                        { return lw_shape_create_detail( w.mesh.get(), 0.5, &tree, a, d, out ); },
	                        lw_shape_release ) );
	lw_deferred_def deferred = lw_deferred_def_default();
	deferred.box_max[0] = deferred.box_max[1] = deferred.box_max[2] = 1;
	deferred.make = []( void*, lw_diag*, lw_shape** out ) { return *out = nullptr, LW_ERROR_OUT_OF_MEMORY; };
	failEach( "deferred", making<lw_shape>( [&]( Allocator a, lw_diag* d, lw_shape** out )
	                          { return lw_shape_create_deferred( &deferred, a, d, out ); },
	                          lw_shape_release ) );
}

TEST( Faults, ValidationWithoutMemory )
{
	CountingAllocator memory;
	const lw_allocator allocator = memory.get();
	World w;
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = w.numbers.data();
	def.vertex_count = 20;
	def.indices = w.indices.data();
	def.triangle_count = 20;
	lw_shape* shape = nullptr;
	ASSERT_EQ( LW_OK, lw_shape_create_mesh( &def, &allocator, nullptr, &shape ) );
	memory.left = 0;
	EXPECT_EQ( LW_ERROR_OUT_OF_MEMORY, lwi_shape_validate( shape, nullptr ) );
	memory.left = 100;
	EXPECT_EQ( LW_OK, lwi_shape_validate( shape, nullptr ) );
	lw_shape_release( shape );
	EXPECT_EQ( memory.live, 0 );
}

TEST( Faults, ScenesAndRobotsWithoutMemory )
{
	World w;
	const lw_scene_def scene_def = w.sceneDef();
	failEach( "scene", making<lw_scene>( [&]( Allocator a, lw_diag* d, lw_scene** out )
	                       { return lw_scene_create( &scene_def, a, d, out ); },
	                       lw_scene_release ) );
	const lw_shape* shapes[] = { w.ball.get(), w.mesh.get() };
	const lw_transform poses[] = { lw_transform_identity(), lw_transform_identity() };
	const lw_scene_change changes[] = { { LW_SCENE_ADD, "new", shapes, poses, 2 }, { LW_SCENE_MOVE, "a", nullptr, poses, 2 },
	    { LW_SCENE_REMOVE, "b", nullptr, nullptr, 0 } };
	failEach( "scene edit", making<lw_scene>( [&]( Allocator a, lw_diag* d, lw_scene** out )
	                            { return lw_scene_edit( w.scene.get(), changes, 3, a, d, out ); },
	                            lw_scene_release ) );
	failEach( "robot", making<lw_robot>(
	                       [&]( Allocator a, lw_diag* d, lw_robot** out )
	                       {
		                       *out = nullptr;
		                       return w.model.create( out, d, a );
	                       },
	                       lw_robot_release ) );
	failEach( "attach", making<lw_robot>( [&]( Allocator a, lw_diag* d, lw_robot** out ) { return w.attach( a, d, out ); },
	                        lw_robot_release ) );
	ASSERT_NE( nullptr, w.holding );
	EXPECT_TRUE( lw_robot_is_attached( w.holding.get(), lw_robot_find_link( w.holding.get(), "held" ) ) );
}

TEST( Faults, CheckersAndQueriesWithoutMemory )
{
	World w;
	ASSERT_NE( nullptr, w.checker );
	const lw_checker_def def = w.checkerDef( nullptr );
	failEach( "checker", making<lw_checker>( [&]( Allocator a, lw_diag* d, lw_checker** out )
	                         { return lw_checker_create( &def, a, d, out ); },
	                         lw_checker_release ) );
	lw_checker_def again = def;
	again.previous = w.checker.get();
	failEach( "checker from another", making<lw_checker>( [&]( Allocator a, lw_diag* d, lw_checker** out )
	                                      { return lw_checker_create( &again, a, d, out ); },
	                                      lw_checker_release ) );
	ScenePtr other( w.makeScene( nullptr, nullptr ) );
	lw_checker_edit_def edit = lw_checker_edit_def_default();
	edit.scene = other.get();
	failEach( "checker edit", making<lw_checker>( [&]( Allocator a, lw_diag* d, lw_checker** out )
	                              { return lw_checker_edit( w.checker.get(), &edit, a, d, out ); },
	                              lw_checker_release ) );
	edit.robot = w.holding.get();
	failEach( "checker edit of the robot", making<lw_checker>( [&]( Allocator a, lw_diag* d, lw_checker** out )
	                                           { return lw_checker_edit( w.checker.get(), &edit, a, d, out ); },
	                                           lw_checker_release ) );
	const lw_query_def query_def = lw_query_def_default();
	failEach( "query", making<lw_query>( [&]( Allocator a, lw_diag*, lw_query** out )
	                       { return lw_query_create( &query_def, nullptr, w.checker.get(), a, out ); },
	                       lw_query_destroy ) );
}

TEST( Faults, ReachesWithoutMemory )
{
	World w;
	lw_reach_def def = lw_reach_def_default();
	def.robot = w.robot.get();
	def.hull_error = 0.5;
	def.samples = 10;
	def.seconds = 0;
	lw_reach* made = nullptr;
	const lw_status status = lw_reach_create( &def, nullptr, nullptr, &made );
	if ( status == LW_ERROR_UNSUPPORTED )
	{
		GTEST_SKIP() << "a build without qhull";
	}
	ASSERT_EQ( LW_OK, status );
	const ReachPtr reach( made );
	failEach( "reach",
	    making<lw_reach>( [&]( Allocator a, lw_diag* d, lw_reach** out ) { return lw_reach_create( &def, a, d, out ); },
	        lw_reach_release ) );
	const lw_checker_def checker_def = w.checkerDef( reach.get() );
	failEach( "checker with a reach", making<lw_checker>( [&]( Allocator a, lw_diag* d, lw_checker** out )
	                                      { return lw_checker_create( &checker_def, a, d, out ); },
	                                      lw_checker_release ) );
}

TEST( Faults, BlobsWithoutMemory )
{
	World w;
	const lw_shape* shapes[] = { w.mesh.get(), w.ball.get() };
	lw_blob_def def = lw_blob_def_default();
	def.shapes = shapes;
	def.shape_count = 2;
	void* bytes = nullptr;
	std::size_t size = 0;
	failEach( "blob",
	    [&]( Allocator a, lw_diag* d, DonePtr& release )
	    {
		    const lw_status status = lw_blob_write( &def, a, d, &bytes, &size );
		    if ( bytes != nullptr )
		    {
			    release = [a, bytes, size] { lw_blob_free( a, bytes, size ); };
		    }
		    return status;
	    } );
	ASSERT_EQ( LW_OK, lw_blob_write( &def, nullptr, nullptr, &bytes, &size ) );
	failEach( "shapes of a blob",
	    [&]( Allocator a, lw_diag* d, DonePtr& release )
	    {
		    lw_shape* read[2];
		    const lw_status status = lw_blob_read_shapes( bytes, size, def.key, a, d, read, 2 );
		    if ( status == LW_OK )
		    {
			    release = [read0 = read[0], read1 = read[1]]
			    {
				    lw_shape_release( read0 );
				    lw_shape_release( read1 );
			    };
		    }
		    return status;
	    } );
	lw_blob_free( nullptr, bytes, size );
}

TEST( Faults, SpheresWithoutMemory )
{
	World w;
	const double sizes[3] = { 0.3, 0.2, 0.2 };
	lw_shape* box = nullptr;
	ASSERT_EQ( LW_OK, lw_shape_create_primitive( LW_SHAPE_BOX, sizes, nullptr, nullptr, &box ) );
	const ShapePtr owner( box );
	const lw_shape* shapes[] = { box };
	lw_spheres_def def = lw_spheres_def_default();
	def.body.shapes = shapes;
	def.body.shape_count = 1;
	def.excess = 0.1;
	failEach( "spheres around a body", making<lw_spheres>( [&]( Allocator a, lw_diag* d, lw_spheres** out )
	                                       { return lw_spheres_create( &def, a, d, out ); },
	                                       lw_spheres_destroy ) );
	const double sphere[4] = { 0, 0, 0, 1 };
	failEach( "spheres judged",
	    [&]( Allocator a, lw_diag* d, DonePtr& release )
	    {
		    lw_spheres_report report;
		    const lw_status status = lw_spheres_check( &def.body, sphere, 1, a, d, &report );
		    if ( status == LW_OK )
		    {
			    EXPECT_TRUE( report.encloses );
			    release = [] {};
		    }
		    return status;
	    } );
}

/// Everything comes from one allocator; after the last object is made it has nothing to give any more, and nobody asks.
TEST( Faults, QuestionsTakeNoMemory )
{
	CountingAllocator memory;
	const lw_allocator allocator = memory.get();
	{
		World w;
		RobotPtr robot;
		{
			lw_robot* made = nullptr;
			ASSERT_EQ( LW_OK, w.model.create( &made, nullptr, &allocator ) );
			robot.reset( made );
		}
		const ScenePtr scene( w.makeScene( &allocator, nullptr ) );
		lw_checker_def def = w.checkerDef( nullptr );
		def.robot = robot.get();
		def.scene = scene.get();
		lw_checker* checker = nullptr;
		ASSERT_EQ( LW_OK, lw_checker_create( &def, &allocator, nullptr, &checker ) );
		const CheckerPtr checker_owner( checker );
		const lw_query_def query_def = lw_query_def_default();
		lw_query* query = nullptr;
		ASSERT_EQ( LW_OK, lw_query_create( &query_def, nullptr, checker, &allocator, &query ) );
		const QueryPtr query_owner( query );
		memory.left = 0;
		const int live = memory.live;
		State a( lw_checker_variable_count( checker ) ), b = a;
		for ( int i = 0; i < 50; ++i )
		{
			a = randomState( w.rng, robot.get() );
			b = randomState( w.rng, robot.get() );
			lw_state_result state;
			EXPECT_EQ( LW_OK, lw_checker_state( checker, query, a.data(), LW_CHECK_BOTH, nullptr, false, &state ) );
			lw_edge_def edge_def = lw_edge_def_default();
			edge_def.slack = 0.05;
			lw_edge_result edge;
			EXPECT_EQ( LW_OK, lw_checker_edge( checker, query, a.data(), b.data(), &edge_def, &edge ) );
			lw_clearance c;
			const lw_transform here = lw_transform_identity();
			EXPECT_EQ( LW_OK, lw_shape_distance( w.cell.get(), &here, w.cell.get(), &here, nullptr, query, &c ) );
		}
		EXPECT_EQ( memory.live, live );
		EXPECT_EQ( memory.left, 0 ) << "somebody asked";
		memory.left = 1 << 30;
	}
	EXPECT_EQ( memory.live, 0 );
}

/// For valgrind: a little of everything, so that it ends soon.
TEST( Smoke, BuildAskSaveRead )
{
	World w;
	ASSERT_NE( nullptr, w.checker );
	const QueryPtr query = makeQuery( w.checker.get() );
	int verdicts[4] = {};
	for ( int i = 0; i < 10; ++i )
	{
		const State a = randomState( w.rng, w.robot.get() ), b = randomState( w.rng, w.robot.get() );
		lw_state_result state;
		ASSERT_EQ(
		    LW_OK, lw_checker_state( w.checker.get(), query.get(), a.data(), LW_CHECK_BOTH, nullptr, false, &state ) );
		lw_edge_def def = lw_edge_def_default();
		def.slack = 0.05;
		lw_edge_result edge;
		ASSERT_EQ( LW_OK, lw_checker_edge( w.checker.get(), query.get(), a.data(), b.data(), &def, &edge ) );
		++verdicts[edge.verdict];
	}
	EXPECT_EQ( verdicts[LW_VERDICT_UNKNOWN], 0 );
	const lw_shape* shapes[] = { w.mesh.get() };
	lw_blob_def def = lw_blob_def_default();
	def.shapes = shapes;
	def.shape_count = 1;
	void* bytes = nullptr;
	std::size_t size = 0;
	ASSERT_EQ( LW_OK, lw_blob_write( &def, nullptr, nullptr, &bytes, &size ) );
	// Bytes that nobody wrote would show here: they are compared one by one
	unsigned sum = 0;
	for ( std::size_t i = 0; i < size; ++i )
	{
		sum += static_cast<const unsigned char*>( bytes )[i] > 127 ? 1u : 0u;
	}
	EXPECT_LT( sum, size );
	lw_shape* read = nullptr;
	EXPECT_EQ( LW_OK, lw_blob_read_shapes( bytes, size, def.key, nullptr, nullptr, &read, 1 ) );
	EXPECT_TRUE( lw_digest_equal( lw_shape_digest( read ), lw_shape_digest( w.mesh.get() ) ) );
	lw_shape_release( read );
	lw_blob_free( nullptr, bytes, size );
}
