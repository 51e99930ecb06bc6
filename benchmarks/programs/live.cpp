// SPDX-License-Identifier: BSD-3-Clause
// A live cloud: frames of a simulated depth camera into voxels, scenes and checkers of them; octomap and a k-d tree on the same frames.
//
// Panda in a room of 4 x 4 x 2.4 m with a scene of MotionBenchMaker; a ball flies about. The camera looks round, so that the whole room is resident, and then
// follows the robot. Processor time of the thread; rows of several threads, wall clock: clouds of their own take the same frames. When that is over, nanoflann builds its k-d tree of the points of each frame, and octomap inserts the same
// points at the same resolution by insertPointCloud(): as it is, and discretized with inner nodes updated once. The first frame grows octomap's tree and is not
// counted. octomap leaves millions of small free pieces of memory that whoever allocates next has to join: 0.9 s for a k-d tree of 11 ms. So the peers come last, each
// after malloc_trim(). A guard proves a motion of three seconds anew after each frame. States and edges are checked in the cloud's scene and beside one point set of all its voxels.
// Exit status 1 if a point of a frame is in no occupied voxel, or an answer of the two scenes differs.
#include "leeway/parallel.hpp"
#include "programs/commands.hpp"
#include "support/depth_camera.hpp"
#include "support/edge_worlds.hpp"
#include "support/provenance.hpp"
#include "support/race.hpp"
#include "support/running_motion.hpp"

#include <chrono>
#include <cstdio>
#include <functional>
#include <map>
#include <nanoflann.hpp>
#include <octomap/octomap.h>

#if defined( __GLIBC__ )
#include <malloc.h>
#endif

namespace
{

struct Settings
{
	std::string data = LEEWAY_DATA_DIR;
	int frames = 150, peer_frames = 4, states = 400;
	unsigned threads = std::max( 1u, std::thread::hardware_concurrency() );
	double resolution = 0.01, noise = 0.001;
	std::uint64_t seed = 20260101;
	bool quick = false;
};

struct CloudReleaser
{
	void operator()( lw_cloud* cloud ) const { lw_cloud_destroy( cloud ); }
};

/// Something that the camera sees.
struct Seen
{
	TriangleList triangles;
	lw_transform pose;
	std::uint32_t link; ///< of the robot; LW_INVALID_INDEX: it stands
};

lw_transform cameraAt( const std::array<double, 3>& eye, double yaw, double pitch )
{
	const double cp = std::cos( pitch ), sp = std::sin( pitch ), cy = std::cos( yaw ), sy = std::sin( yaw );
	return { { { sy, -cy * sp, cy * cp }, { -cy, -sy * sp, sy * cp }, { 0, -cp, -sp } }, { eye[0], eye[1], eye[2] } };
}

lw_shape* boxShape( double x, double y, double z )
{
	const double size[3] = { x, y, z };
	lw_shape* shape = nullptr;
	leeway::require( lw_shape_create_primitive( LW_SHAPE_BOX, size, nullptr, nullptr, &shape ), "box" );
	return shape;
}

class Room
{
public:
	Room( const EdgeWorld& world, const Settings& settings )
	    : m_world( world ), m_settings( settings ), m_rng( std::mt19937_64( settings.seed ) ), m_camera( 366, 274, 300 )
	{
		for ( std::uint32_t i = 0; i < lw_scene_shape_count( world.scene.get() ); ++i )
		{
			const lw_scene_shape_def def = lw_scene_shape( world.scene.get(), i );
			m_seen.push_back( { trianglesOf( def.shape ), def.world_from_shape, LW_INVALID_INDEX } );
		}
		for ( std::uint32_t i = 0; i < lw_robot_body_count( world.robot.get() ); ++i )
		{
			const lw_body_def body = lw_robot_body( world.robot.get(), i );
			m_seen.push_back( { trianglesOf( body.shape ), body.link_from_shape, body.link } );
		}
		const double walls[6][6] = { { -2, 0, 0.7, 0.02, 4, 2.4 }, { 2, 0, 0.7, 0.02, 4, 2.4 }, { 0, -2, 0.7, 4, 0.02, 2.4 },
		    { 0, 2, 0.7, 4, 0.02, 2.4 }, { 0, 0, -0.5, 4, 4, 0.02 }, { 0, 0, 1.9, 4, 4, 0.02 } };
		for ( const double* w : walls )
		{
			const leeway::Shape shape = leeway::Shape::adopt( boxShape( w[3], w[4], w[5] ) );
			lw_transform pose = lw_transform_identity();
			std::copy( w, w + 3, pose.t );
			m_seen.push_back( { trianglesOf( shape.get() ), pose, LW_INVALID_INDEX } );
		}
		const double radius[3] = { 0.1, 0, 0 };
		lw_shape* ball = nullptr;
		leeway::require( lw_shape_create_primitive( LW_SHAPE_SPHERE, radius, nullptr, nullptr, &ball ), "ball" );
		m_ball = trianglesOf( ball );
		lw_shape_release( ball );
	}

	/// A frame at a time; the robot is in the state `full`.
	std::vector<float> look( double time, const lw_transform& camera, const std::vector<double>& full )
	{
		std::vector<lw_transform> links( lw_robot_link_count( m_world.robot.get() ) );
		leeway::require( lw_robot_fk( m_world.robot.get(), full.data(), links.data() ), "lw_robot_fk" );
		m_camera.begin();
		for ( const Seen& seen : m_seen )
		{
			const lw_transform pose =
			    seen.link == LW_INVALID_INDEX ? seen.pose : lw_transform_multiply( &links[seen.link], &seen.pose );
			m_camera.draw( seen.triangles, pose, camera );
		}
		lw_transform ball = lw_transform_identity();
		ball.t[0] = 0.9;
		ball.t[1] = 0.9 * std::sin( 1.3 * time );
		ball.t[2] = 0.5 + 0.4 * std::cos( time );
		m_camera.draw( m_ball, ball, camera );
		std::vector<float> depths = m_camera.image();
		for ( float& z : depths )
		{
			z += z > 0 ? static_cast<float>( m_settings.noise * z * m_rng.normal() ) : 0.0f;
		}
		return depths;
	}
	const DepthCamera& camera() const { return m_camera; }
	SeededRng& rng() { return m_rng; }

private:
	const EdgeWorld& m_world;
	const Settings& m_settings;
	SeededRng m_rng;
	DepthCamera m_camera;
	std::vector<Seen> m_seen;
	TriangleList m_ball;
};

/// The points of an image, world.
std::vector<float> pointsOf( const std::vector<float>& depths, const lw_cloud_depth& lens, const lw_transform& camera )
{
	std::vector<float> points;
	for ( std::uint32_t i = 0; i < depths.size(); ++i )
	{
		const double z = static_cast<double>( depths[i] );
		const lw_vec3 p = lw_transform_point(
		    &camera, { ( i % lens.width - lens.cx ) / lens.fx * z, ( i / lens.width - lens.cy ) / lens.fy * z, z } );
		if ( z > 0 )
		{
			points.insert(
			    points.end(), { static_cast<float>( p.x ), static_cast<float>( p.y ), static_cast<float>( p.z ) } );
		}
	}
	return points;
}

/// nanoflann's view of points.
struct PointList
{
	const std::vector<float>& numbers;
	std::size_t kdtree_get_point_count() const { return numbers.size() / 3; }
	float kdtree_get_pt( std::size_t i, std::size_t axis ) const { return numbers[3 * i + axis]; }
	template <typename Box> bool kdtree_get_bbox( Box& ) const { return false; }
};
using KdTree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, PointList>, PointList, 3>;

struct Times
{
	std::map<std::string, std::vector<double>> of;
	Hash hash;
	std::size_t missing = 0, differing = 0;
	std::vector<double> rebuilt, rebuilt_blocked; ///< shapes that a scene made anew
};

using CloudPtr = std::unique_ptr<lw_cloud, CloudReleaser>;

/// @param threads null: the caller's alone
CloudPtr makeCloud( const Settings& settings, bool blocked, unsigned* threads = nullptr )
{
	lw_cloud_def def = lw_cloud_def_default();
	if ( threads != nullptr )
	{
		def.parallel = leeway::runTasks;
		def.parallel_user = threads;
	}
	def.resolution = settings.resolution;
	def.unseen_blocked = blocked;
	def.clear_margin = 0.02;
	def.shadow = 0.03;
	def.most_blocks = 1u << 20;
	const double low[3] = { -2.1, -2.1, -0.6 }, high[3] = { 2.1, 2.1, 2 };
	std::copy( low, low + 3, def.box_min );
	std::copy( high, high + 3, def.box_max );
	lw_cloud* cloud = nullptr;
	lw_diag diag = {};
	leeway::require( lw_cloud_create( &def, nullptr, &diag, &cloud ), diag );
	return CloudPtr( cloud );
}

void insert( lw_cloud* cloud, const lw_cloud_frame& frame, lw_cloud_report* report )
{
	lw_diag diag = {};
	leeway::require( lw_cloud_insert( cloud, &frame, &diag, report ), diag );
}

/// A frame for the peers: its points in the world, and the place of the camera.
struct PeerFrame
{
	std::vector<float> points;
	octomap::point3d origin;
};

/// Gives back the free pieces of the peer before, so that the next one does not pay for them.
void tidyMemory()
{
#if defined( __GLIBC__ )
	malloc_trim( 0 );
#endif
}

void askNanoflann( const std::vector<PeerFrame>& frames, Times& times )
{
	for ( const PeerFrame& frame : frames )
	{
		const PointList list{ frame.points };
		times.of["nanoflann k-d tree"].push_back( microseconds( [&] { KdTree tree( 3, list ); } ) );
	}
}

/// All frames into one map, at octomap's usual way or at its fastest.
void askOctomap( const std::vector<PeerFrame>& frames, double resolution, bool fastest, Times& times )
{
	octomap::OcTree tree( resolution );
	bool is_grown = false;
	for ( const PeerFrame& frame : frames )
	{
		octomap::Pointcloud cloud;
		for ( std::size_t i = 0; i < frame.points.size(); i += 3 )
		{
			cloud.push_back( frame.points[i], frame.points[i + 1], frame.points[i + 2] );
		}
		tidyMemory();
		const double took = microseconds(
		    [&]
		    {
			    tree.insertPointCloud( cloud, frame.origin, -1, fastest, fastest );
			    if ( fastest )
			    {
				    tree.updateInnerOccupancy();
			    }
		    } );
		if ( is_grown || frames.size() == 1 )
		{
			times.of[fastest ? "octomap, discretized and lazy" : "octomap insertPointCloud"].push_back( took );
		}
		is_grown = true;
	}
}

/// The voxels as one point set.
leeway::Scene oneSetOf( const lw_cloud* cloud )
{
	std::vector<double> centers( 3 * lw_cloud_voxels( cloud, LW_VOXEL_OCCUPIED, nullptr, 0 ) );
	lw_cloud_voxels( cloud, LW_VOXEL_OCCUPIED, centers.data(), centers.size() / 3 );
	lw_shape* shape = nullptr;
	const double radius = 0.5 * std::sqrt( 3.0 ) * lw_cloud_get_info( cloud ).resolution;
	leeway::require( lw_shape_create_points( centers.data(), static_cast<std::uint32_t>( centers.size() / 3 ), radius,
	                     nullptr, nullptr, nullptr, &shape ),
	    "lw_shape_create_points" );
	const leeway::Shape owner = leeway::Shape::adopt( shape );
	const char* name = "cloud";
	const lw_scene_shape_def placed = { shape, 0, lw_transform_identity() };
	lw_scene_def def = lw_scene_def_default();
	def.object_names = &name;
	def.object_count = 1;
	def.shapes = &placed;
	def.shape_count = 1;
	lw_scene* scene = nullptr;
	leeway::require( lw_scene_create( &def, nullptr, nullptr, &scene ), "lw_scene_create" );
	return leeway::Scene::adopt( scene );
}

/// The same states and edges of both checkers, taking turns.
void askStates( const EdgeWorld& world, const leeway::Checker& chunks, const leeway::Checker& one, int states,
    SeededRng& rng, Times& times )
{
	const leeway::Query queries[2] = { leeway::makeQuery( chunks.get() ), leeway::makeQuery( one.get() ) };
	const lw_checker* checkers[2] = { chunks.get(), one.get() };
	const char* names[2] = { "of the cloud", "of one point set" };
	const std::uint32_t count = lw_checker_variable_count( chunks.get() );
	std::vector<double> last;
	for ( int i = 0; i < states; ++i )
	{
		std::vector<double> q( count );
		for ( std::uint32_t k = 0; k < count; ++k )
		{
			const lw_variable_info info = lw_robot_variable( world.robot.get(), world.variables[k] );
			q[k] = rng.uniform( info.lower, info.upper );
		}
		double uppers[2];
		for ( const int k : { i % 2, 1 - i % 2 } )
		{
			lw_state_result exact;
			times.of[std::string( "clearance " ) + names[k]].push_back( microseconds(
			    [&]
			    {
				    leeway::require( lw_checker_state( checkers[k], queries[k].get(), q.data(), LW_CHECK_ENVIRONMENT,
				                         nullptr, false, &exact ),
				        "lw_checker_state" );
			    } ) );
			uppers[k] = exact.environment.upper;
			if ( !last.empty() )
			{
				const lw_edge_def def = lw_edge_def_default();
				lw_edge_result edge;
				times.of[std::string( "edge " ) + names[k]].push_back( microseconds(
				    [&] {
					    leeway::require(
					        lw_checker_edge( checkers[k], queries[k].get(), last.data(), q.data(), &def, &edge ), "edge" );
				    } ) );
			}
		}
		times.differing += std::abs( uppers[0] - uppers[1] ) > 1e-6 ? 1 : 0;
		times.hash.add( static_cast<std::int64_t>( std::lround( 1e6 * uppers[0] ) ) );
		last = q;
	}
}

int report( const Times& times, const lw_cloud_info& info, Result& result )
{
	std::printf( "%llu voxels, %u blocks, %u shapes, %.0f MB; %zu points without a voxel, %zu answers that differ\n",
	    static_cast<unsigned long long>( info.occupied ), info.blocks, info.shapes, static_cast<double>( info.bytes ) / 1e6,
	    times.missing, times.differing );
	std::printf( "  shapes made anew for a scene: median %.0f; %.0f if unseen is blocked\n",
	    summarise( times.rebuilt ).median, summarise( times.rebuilt_blocked ).median );
	const double base = summarise( times.of.at( "insert a depth image" ) ).median;
	for ( const auto& [what, values] : times.of )
	{
		std::vector<double> sorted = values;
		std::sort( sorted.begin(), sorted.end() );
		const double p99 = sorted[sorted.size() - 1 - sorted.size() / 100];
		const Summary s = summarise( values );
		std::printf(
		    "  %-44s us: median %10.1f, 99 %% %10.1f, ratio %8.2f\n", what.c_str(), s.median, p99, s.median / base );
		Json row = { { "what", what }, { "p99_us", rounded( p99 ) }, { "ratio", rounded( s.median / base ) },
		    { "voxels", info.occupied }, { "shapes", info.shapes }, { "rebuilt", summarise( times.rebuilt ).median },
		    { "answers_hash", times.hash.text() } };
		row.update( toJson( s ) );
		result.add( std::move( row ) );
	}
	return times.missing == 0 && times.differing == 0 ? 0 : 1;
}

/// The clouds that take the frames, and the checker that follows.
struct Run
{
	Run( const EdgeWorld& of, const Settings& s )
	    : settings( s ), world( of ), room( of, s ), cloud( makeCloud( s, false ) ), as_points( makeCloud( s, false ) ),
	      blocked( makeCloud( s, true ) ), threads( s.threads ), threaded( makeCloud( s, false, &threads ) ),
	      threaded_blocked( makeCloud( s, true, &threads ) ), checker( edited( of.with_tables.get(), nullptr ) ),
	      full( of.reference )
	{
	}
	const Settings& settings;
	const EdgeWorld& world;
	Room room;
	CloudPtr cloud, as_points, blocked;
	unsigned threads;
	CloudPtr threaded, threaded_blocked;
	std::vector<PeerFrame> for_peers;
	leeway::Checker checker;
	std::vector<double> full;
	Times times;
	OwnedClock motion; ///< that runs while frames come in
	leeway::GuardHandle guard;
	std::uint64_t worlds = 0; ///< that the guard was given
	std::size_t guarded = 0;  ///< answers FREE
};

void note( Times& times, bool measured, const std::string& what, double value )
{
	if ( measured )
	{
		times.of[what].push_back( value );
	}
}

leeway::Scene sceneOf( lw_cloud* cloud )
{
	lw_scene* scene = nullptr;
	leeway::require( lw_cloud_scene( cloud, nullptr, "cloud", nullptr, &scene ), "lw_cloud_scene" );
	return leeway::Scene::adopt( scene );
}

/// A motion of three seconds in the cloud as it is, and its guard.
void beginMotion( Run& run )
{
	run.motion = freeMotion( run.world, run.checker.get(), 6, run.room.rng() );
	if ( run.motion.tracks[0].pieces.empty() )
	{
		throw std::runtime_error( "live: no free motion in the cloud: give another --seed" );
	}
	const lw_clock clock = run.motion.view();
	lw_guard_def def = lw_guard_def_default();
	def.checker = run.checker.get();
	def.clock = &clock;
	def.end = run.motion.tracks[0].pieces.back().end;
	def.window = def.end;
	def.spare_shapes = 1000;
	run.guard = makeGuard( def );
	lw_guard_answer answer;
	leeway::require( lw_guard_ask( run.guard.get(), 0, INFINITY, &answer ), "lw_guard_ask" );
}

/// Is the whole motion still free, in the cloud with the last frame?
void askGuard( Run& run )
{
	note( run.times, true, "publish a frame to a guard",
	    microseconds(
	        [&] {
		        leeway::require( lw_guard_publish( run.guard.get(), run.checker.get(), ++run.worlds, nullptr ), "publish" );
	        } ) );
	lw_guard_answer answer;
	note( run.times, true, "answer of the guard",
	    microseconds( [&] { leeway::require( lw_guard_ask( run.guard.get(), 0, INFINITY, &answer ), "lw_guard_ask" ); } ) );
	run.guarded += answer.verdict == LW_VERDICT_FREE ? 1 : 0;
}

/// The same frame as a depth image and as points.
void takeFrame( Run& run, const lw_cloud_frame& frame, const std::vector<float>& points, bool measured )
{
	Times& times = run.times;
	lw_cloud_report counts = {}, point_counts = {};
	note( times, measured, "insert a depth image", microseconds( [&] { insert( run.cloud.get(), frame, &counts ); } ) );
	leeway::Scene scene;
	note( times, measured, "scene", microseconds( [&] { scene = sceneOf( run.cloud.get() ); } ) );
	if ( measured )
	{
		times.rebuilt.push_back( lw_cloud_get_info( run.cloud.get() ).rebuilt );
	}
	leeway::Checker next;
	note( times, measured, "edit of the checker", microseconds( [&] { next = edited( run.checker.get(), scene.get() ); } ) );
	run.checker = next;
	if ( measured )
	{
		if ( run.guard == nullptr )
		{
			beginMotion( run );
		}
		askGuard( run );
	}
	lw_cloud_frame listed = frame;
	listed.depth.data = nullptr;
	listed.points = {
	    points.data(), static_cast<std::uint32_t>( points.size() / 3 ), 1, 12, 0, { 0, 4, 8 }, false, false, true };
	note( times, measured, "insert points", microseconds( [&] { insert( run.as_points.get(), listed, &point_counts ); } ) );
	const std::size_t pixels = static_cast<std::size_t>( frame.depth.width ) * frame.depth.height;
	times.missing += counts.inserted + counts.own + counts.outside + counts.not_measured != pixels ? 1 : 0;
	for ( std::size_t i = 0; i < points.size() && point_counts.own + point_counts.outside == 0; i += 3 )
	{
		const lw_vec3 p = { points[i], points[i + 1], points[i + 2] };
		times.missing += lw_cloud_state( run.as_points.get(), p ) != LW_VOXEL_OCCUPIED;
	}
	for ( const std::uint32_t count : { counts.added, counts.cleared, point_counts.cleared } )
	{
		times.hash.add( count );
	}
}

/// The same frame into a cloud of several threads.
void takeThreaded( Run& run, const lw_cloud_frame& frame, bool blocked, bool measured )
{
	lw_cloud* cloud = ( blocked ? run.threaded_blocked : run.threaded ).get();
	const std::string how = ( blocked ? ", unseen is blocked, " : ", " ) + std::to_string( run.threads ) + " threads";
	const auto wall = []( const std::function<void()>& work )
	{
		const auto begin = std::chrono::steady_clock::now();
		work();
		return std::chrono::duration<double, std::micro>( std::chrono::steady_clock::now() - begin ).count();
	};
	note( run.times, measured, ( blocked ? "insert" : "insert a depth image" ) + how,
	    wall( [&] { insert( cloud, frame, nullptr ); } ) );
	note( run.times, measured, "scene" + how, wall( [&] { sceneOf( cloud ); } ) );
}

/// Frame number k: first the camera looks all around and up and down, then it follows the robot.
void drive( Run& run, int k, int warm, int settled )
{
	const double time = k / 30.0;
	const lw_transform camera =
	    k < warm ? cameraAt( { -0.9 + 1.8 * ( k % 2 ), 0.9 - 1.8 * ( k / 2 % 2 ), 0.9 }, 2.4 * k, -0.7 + 0.35 * ( k % 5 ) )
	             : cameraAt( { -1.2, 0.3 * std::sin( time ), 0.9 }, 0.4 * std::sin( 0.7 * time ), 0.3 );
	const EdgeWorld& world = run.world;
	for ( std::uint32_t i = 0; i < world.variables.size(); ++i )
	{
		run.full[world.variables[i]] = world.reference[world.variables[i]] + 0.3 * std::sin( time + i );
	}
	const std::vector<float> depths = run.room.look( time, camera, run.full );
	lw_cloud_frame frame = lw_cloud_frame_default();
	frame.stamp = 1 + time;
	frame.world_from_sensor = camera;
	frame.far = 8;
	frame.depth = run.room.camera().layout();
	frame.depth.data = depths.data();
	frame.robot = world.robot.get();
	frame.state = run.full.data();
	const std::vector<float> points = pointsOf( depths, frame.depth, camera );
	takeFrame( run, frame, points, k >= warm );
	if ( run.threads > 1 )
	{
		takeThreaded( run, frame, false, k >= warm );
	}
	if ( k < warm )
	{
		return;
	}
	if ( k < warm + ( run.settings.quick ? 1 : run.settings.peer_frames ) )
	{
		run.for_peers.push_back( { points,
		    { static_cast<float>( camera.t[0] ), static_cast<float>( camera.t[1] ), static_cast<float>( camera.t[2] ) } } );
	}
	// a camera that begins in an unseen room, measured when it has looked about for a second
	note( run.times, k >= settled, "insert, unseen is blocked",
	    microseconds( [&] { insert( run.blocked.get(), frame, nullptr ); } ) );
	note( run.times, k >= settled, "scene, unseen is blocked", microseconds( [&] { sceneOf( run.blocked.get() ); } ) );
	run.times.rebuilt_blocked.push_back( lw_cloud_get_info( run.blocked.get() ).rebuilt );
	if ( run.threads > 1 )
	{
		takeThreaded( run, frame, true, k >= settled );
	}
}

int run( const Settings& s, Result& result )
{
	lw_reach_def reach = lw_reach_def_default();
	reach.seconds = 2;
	EdgeWorlds worlds( s.data, reach );
	worlds.addMbm( "panda", "panda_arm", { 1 }, "bookshelf_small" );
	Run all( worlds.world( 0 ), s );
	const int warm = s.quick ? 6 : 60, frames = s.quick ? 6 : s.frames;
	for ( int k = 0; k < warm + frames; ++k )
	{
		drive( all, k, warm, warm + ( s.quick ? 3 : 30 ) );
	}
	const leeway::Checker one = edited( all.checker.get(), oneSetOf( all.cloud.get() ).get() );
	askStates( all.world, all.checker, one, s.quick ? 40 : s.states, all.room.rng(), all.times );
	tidyMemory();
	askNanoflann( all.for_peers, all.times );
	askOctomap( all.for_peers, s.resolution, false, all.times );
	askOctomap( all.for_peers, s.resolution, true, all.times );
	std::printf( "the guard proved %zu of %llu frames free\n", all.guarded, static_cast<unsigned long long>( all.worlds ) );
	return report( all.times, lw_cloud_get_info( all.cloud.get() ), result );
}

} // namespace

void addLive( Bench& bench )
{
	const auto s = std::make_shared<Settings>();
	Command& command =
	    bench.command( "live", "frames of a depth camera into a live cloud; octomap and a k-d tree of the same frames" );
	command.option( "--data", s->data, "folder with mbm" );
	command.option( "--frames", s->frames, "that are measured", { 1, 1000000 } );
	command.option( "--peer-frames", s->peer_frames, "of these for octomap, which is slow, and nanoflann", { 0, 1000000 } );
	command.option( "--states", s->states, "states and edges", { 1, 1000000 } );
	command.option( "--threads", s->threads, "of clouds that have some, beside those of one", { 1u, 1024u } );
	command.option( "--resolution", s->resolution, "edge of a voxel, metres", { 1e-3, 1.0 } );
	command.option( "--noise", s->noise, "of depths, standard deviation at 1 m, metres", { 0.0, 1.0 } );
	command.option( "--seed", s->seed, "of noise and states" );
	command.flag( "--quick", s->quick, "few frames and states: for agreement, not for figures" );
	command.work(
	    [s]( Result& result )
	    {
		    requireData( s->data, "mbm" );
		    return run( *s, result );
	    } );
}
