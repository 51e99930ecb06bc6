// SPDX-License-Identifier: BSD-3-Clause
// A cloud of a million points against the octomap of the same cloud in FCL: building, and clearance of an arm among them.
//
// Panda in a scene of MotionBenchMaker whose surfaces are sampled. leeway gets all points, each a ball of half a cell; FCL
// the octree of their cells, as fcl::OcTree and as boxes in its managers. leeway on the boxes of the octree is the same
// geometry as FCL's: their distances must agree. A ball's point is in a cell, which bounds the cloud's distances by those of
// the cells. Exit status 1 if an answer is outside of that.
#include "peers/fcl_peer.hpp"
#include "programs/commands.hpp"
#include "support/provenance.hpp"
#include "support/race.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/octree/octree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>
#include <limits>
#include <octomap/octomap.h>

namespace
{

namespace io = leeway::io;
using Point = std::array<double, 3>;

constexpr double INFINITE = std::numeric_limits<double>::infinity(), PI = 3.14159265358979323846;
constexpr double MARGIN = 0.01;
constexpr double AGREEMENT = 1e-6; ///< metres, leeway and FCL on the same boxes

struct Settings
{
	std::string data = LEEWAY_DATA_DIR, set = "bookshelf_small_panda";
	int problem = 1, repetitions = 3;
	std::size_t points = 1000000, states = 200;
	double cell = 0.01;
	bool quick = false;
	std::uint64_t seed = 20260101;
};

// --- a cloud of the scene's surfaces ---------------------------------------------------------------------------------

/// A piece of a surface: a parallelogram or triangle (corner, two edges), or the side or a cap of a cylinder.
struct Patch
{
	enum Kind
	{
		PARALLELOGRAM,
		TRIANGLE,
		SIDE,
		CAP
	} kind;
	lw_transform pose;
	double corner[3], u[3], v[3]; ///< a cylinder: radius in u[0], height in u[2]; a cap: radius in u[0], its z in corner[2]
	double area;
};

double crossLength( const double u[3], const double v[3] )
{
	return std::hypot( u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0] );
}

void addBox( const double* d, const lw_transform& pose, std::vector<Patch>& patches )
{
	for ( int axis = 0; axis < 3; ++axis )
	{
		const int next = ( axis + 1 ) % 3, last = ( axis + 2 ) % 3;
		for ( const double side : { -0.5, 0.5 } )
		{
			Patch patch{ Patch::PARALLELOGRAM, pose, {}, {}, {}, d[next] * d[last] };
			patch.corner[axis] = side * d[axis];
			patch.corner[next] = -0.5 * d[next];
			patch.corner[last] = -0.5 * d[last];
			patch.u[next] = d[next];
			patch.v[last] = d[last];
			patches.push_back( patch );
		}
	}
}

void addMesh( const lw_shape* shape, const lw_transform& pose, std::vector<Patch>& patches )
{
	const double* v = lw_shape_vertices( shape );
	const std::uint32_t* t = lw_shape_triangles( shape );
	for ( std::uint32_t i = 0; i < lw_shape_get_info( shape ).triangle_count; ++i, t += 3 )
	{
		Patch patch{ Patch::TRIANGLE, pose, {}, {}, {}, 0 };
		for ( int k = 0; k < 3; ++k )
		{
			patch.corner[k] = v[3 * t[0] + k];
			patch.u[k] = v[3 * t[1] + k] - patch.corner[k];
			patch.v[k] = v[3 * t[2] + k] - patch.corner[k];
		}
		patch.area = 0.5 * crossLength( patch.u, patch.v );
		patches.push_back( patch );
	}
}

std::vector<Patch> patchesOf( const lw_scene* scene )
{
	std::vector<Patch> patches;
	for ( std::uint32_t i = 0; i < lw_scene_shape_count( scene ); ++i )
	{
		const lw_scene_shape_def def = lw_scene_shape( scene, i );
		const lw_shape_info info = lw_shape_get_info( def.shape );
		const double* d = info.dimensions;
		switch ( info.type )
		{
		case LW_SHAPE_BOX:
			addBox( d, def.world_from_shape, patches );
			break;
		case LW_SHAPE_CYLINDER:
			patches.push_back( { Patch::SIDE, def.world_from_shape, {}, { d[0], 0, d[1] }, {}, 2 * PI * d[0] * d[1] } );
			for ( const double side : { -0.5, 0.5 } )
			{
				patches.push_back(
				    { Patch::CAP, def.world_from_shape, { 0, 0, side * d[1] }, { d[0], 0, 0 }, {}, PI * d[0] * d[0] } );
			}
			break;
		case LW_SHAPE_MESH:
			addMesh( def.shape, def.world_from_shape, patches );
			break;
		default:
			throw std::runtime_error(
			    "the scene has shapes whose surfaces are not sampled here: take one of boxes, cylinders, meshes" );
		}
	}
	return patches;
}

Point pointOn( const Patch& patch, std::mt19937_64& random )
{
	double a = uniform( random ), b = uniform( random ), local[3];
	if ( patch.kind == Patch::SIDE || patch.kind == Patch::CAP )
	{
		const double radius = patch.kind == Patch::SIDE ? patch.u[0] : patch.u[0] * std::sqrt( b );
		local[0] = radius * std::cos( 2 * PI * a );
		local[1] = radius * std::sin( 2 * PI * a );
		local[2] = patch.kind == Patch::SIDE ? ( b - 0.5 ) * patch.u[2] : patch.corner[2];
	}
	else
	{
		if ( patch.kind == Patch::TRIANGLE && a + b > 1 )
		{
			a = 1 - a;
			b = 1 - b;
		}
		for ( int k = 0; k < 3; ++k )
		{
			local[k] = patch.corner[k] + a * patch.u[k] + b * patch.v[k];
		}
	}
	Point point;
	for ( std::size_t k = 0; k < 3; ++k )
	{
		const double* row = patch.pose.r[k];
		point[k] = row[0] * local[0] + row[1] * local[1] + row[2] * local[2] + patch.pose.t[k];
	}
	return point;
}

/// Points on all surfaces, by area, in random order: a scan from all sides.
std::vector<Point> sampleSurfaces( const lw_scene* scene, std::size_t count, std::mt19937_64& random )
{
	const std::vector<Patch> patches = patchesOf( scene );
	std::vector<double> sums;
	for ( const Patch& patch : patches )
	{
		sums.push_back( ( sums.empty() ? 0 : sums.back() ) + patch.area );
	}
	std::vector<Point> points;
	while ( points.size() < count )
	{
		const double at = uniform( random ) * sums.back();
		const auto found = std::upper_bound( sums.begin(), sums.end() - 1, at );
		points.push_back( pointOn( patches[static_cast<std::size_t>( found - sums.begin() )], random ) );
	}
	return points;
}

// --- the contenders' worlds ------------------------------------------------------------------------------------------

/// The same robot in a scene that is one shape.
io::Problem problemWith( const io::RobotModel& robot, const leeway::Shape& shape, const io::Request& request )
{
	io::SceneModel scene;
	scene.objects.push_back( { "cloud", "", { { shape, lw_transform_identity() } } } );
	io::ProblemOptions options;
	options.group = request.group;
	options.scene = &scene;
	options.request = &request;
	return io::buildProblem( robot, options );
}

class Leeway
{
public:
	Leeway( const io::RobotModel& robot, const leeway::Shape& shape, const io::Request& request )
	    : m_problem( problemWith( robot, shape, request ) ), m_query( leeway::makeQuery( m_problem.checker.get() ) )
	{
	}

	const io::Problem& problem() const { return m_problem; }

	Answer distance( const double* q )
	{
		const lw_clearance c = ask( q, lw_range_exact(), false ).environment;
		return { c.lower, c.upper };
	}

	Answer violates( const double* q, double min_d )
	{
		bool free = false;
		leeway::require(
		    lw_checker_is_free( m_problem.checker.get(), m_query.get(), q, LW_CHECK_ENVIRONMENT, min_d, &free, nullptr ),
		    "a state" );
		return { free ? 0.0 : 1.0, free ? 0.0 : 1.0 };
	}

private:
	lw_state_result ask( const double* q, const lw_range& range, bool stop_at_first )
	{
		lw_state_result result;
		leeway::require( lw_checker_state( m_problem.checker.get(), m_query.get(), q, LW_CHECK_ENVIRONMENT, &range,
		                     stop_at_first, &result ),
		    "a state" );
		return result;
	}

	io::Problem m_problem;
	leeway::Query m_query;
};

/// The cells as boxes in FCL's managers, which find the nearest ones by their own tree, with a running bound.
class FclManagers
{
public:
	FclManagers( FclPeer& peer, const std::vector<double>& boxes ) : m_peer( peer )
	{
		std::map<double, std::shared_ptr<fcl::Boxd>> sizes;
		for ( std::size_t i = 0; i < boxes.size(); i += 6 )
		{
			const double size = boxes[i + 3] - boxes[i], key = std::round( size * 1e6 );
			std::shared_ptr<fcl::Boxd>& box = sizes[key];
			box = box ? box : std::make_shared<fcl::Boxd>( size, size, size );
			fcl::Transform3d pose = fcl::Transform3d::Identity();
			pose.translation() = 0.5 * ( fcl::Vector3d( &boxes[i] ) + fcl::Vector3d( &boxes[i + 3] ) );
			m_objects.push_back( std::make_unique<fcl::CollisionObjectd>( box, pose ) );
			m_cells.registerObject( m_objects.back().get() );
		}
		m_cells.setup();
		for ( const std::uint32_t number : m_peer.movingBodies() )
		{
			m_objects.push_back( std::make_unique<fcl::CollisionObjectd>( body( number ).model, body( number ).pose ) );
			m_moving.push_back( m_objects.back().get() );
			m_links.registerObject( m_moving.back() );
		}
		m_links.setup();
	}

	void pose( const double* q )
	{
		m_peer.pose( q );
		for ( std::size_t i = 0; i < m_moving.size(); ++i )
		{
			m_moving[i]->setTransform( body( m_peer.movingBodies()[i] ).pose );
			m_moving[i]->computeAABB();
		}
		m_links.update();
	}

	double distance( double bound )
	{
		double best = bound;
		m_links.distance( &m_cells, &best,
		    []( fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* data, double& nearest )
		    {
			    double& least = *static_cast<double*>( data );
			    fcl::DistanceResultd result;
			    result.min_distance = least;
			    fcl::distance( a, b, fcl::DistanceRequestd( false, false ), result );
			    least = std::min( least, std::max( 0.0, result.min_distance ) );
			    nearest = least;
			    return least <= 0;
		    } );
		return best;
	}

	bool collides()
	{
		bool found = false;
		m_links.collide( &m_cells, &found,
		    []( fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* data )
		    {
			    fcl::CollisionResultd result;
			    bool& yes = *static_cast<bool*>( data );
			    yes = fcl::collide( a, b, fcl::CollisionRequestd( 1, false ), result ) > 0;
			    return yes;
		    } );
		return found;
	}

private:
	const FclEngine::Body& body( std::uint32_t number ) const
	{
		return static_cast<const FclEngine&>( m_peer.engine() ).body( number );
	}

	FclPeer& m_peer;
	std::vector<std::unique_ptr<fcl::CollisionObjectd>> m_objects;
	std::vector<fcl::CollisionObjectd*> m_moving;
	fcl::DynamicAABBTreeCollisionManagerd m_cells, m_links;
};

// --- the comparison --------------------------------------------------------------------------------------------------

/// Processor time of this thread: one thread builds everything here, and other programs on the machine do not count.
template <typename Work> double seconds( const Work& work )
{
	const double start = threadMicroseconds();
	work();
	return 1e-6 * ( threadMicroseconds() - start );
}

std::shared_ptr<octomap::OcTree> makeOctree( const std::vector<Point>& points, double cell )
{
	const auto tree = std::make_shared<octomap::OcTree>( cell );
	for ( const Point& p : points )
	{
		tree->updateNode( p[0], p[1], p[2], true, true );
	}
	tree->updateInnerOccupancy();
	tree->prune();
	return tree;
}

std::vector<double> boxesOf( const octomap::OcTree& tree )
{
	std::vector<double> boxes;
	for ( auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf )
	{
		if ( tree.isNodeOccupied( *leaf ) )
		{
			const double half = 0.5 * leaf.getSize(), center[3] = { leaf.getX(), leaf.getY(), leaf.getZ() };
			for ( const double sign : { -1.0, 1.0 } )
			{
				for ( const double c : center )
				{
					boxes.push_back( c + sign * half );
				}
			}
		}
	}
	return boxes;
}

/// Half of them anywhere within the limits, half near the start or the goal of the problem.
ConfigurationSet makeStates(
    const io::Problem& problem, const io::Request& request, std::size_t count, std::mt19937_64& random )
{
	ConfigurationSet set{ "states", "half uniform, half within 0.5 rad of start or goal", {} };
	const std::vector<double> ends[2] = { io::startState( problem ), io::goalState( problem, request ) };
	for ( std::size_t i = 0; i < count; ++i )
	{
		std::vector<double> state = ends[i / 2 % 2];
		for ( std::size_t k = 0; k < state.size(); ++k )
		{
			const lw_variable_info info = lw_robot_variable( problem.robot.get(), problem.variables[k] );
			const double share = uniform( random );
			state[k] = i % 2 == 0 ? info.lower + share * ( info.upper - info.lower )
			                      : std::clamp( state[k] + share - 0.5, info.lower, info.upper );
		}
		set.states.push_back( state );
	}
	return set;
}

class Cloud
{
public:
	Cloud( const Settings& settings, Result& result ) : m_settings( settings ), m_result( result )
	{
		const std::string folder = settings.data + "/mbm/panda";
		char digits[16];
		std::snprintf( digits, sizeof digits, "%04d.yaml", settings.problem );
		const std::string scene_file = folder + "/problems/" + settings.set + "/scene" + digits;
		const std::string request_file = folder + "/problems/" + settings.set + "/request" + digits;
		const io::RobotModel robot = io::loadRobot( folder + "/panda.urdf", folder + "/panda.srdf" );
		const io::SceneModel scene = io::loadScene( scene_file );
		const io::Request request = io::loadRequest( request_file );
		io::ProblemOptions options;
		options.group = request.group;
		options.scene = &scene;
		options.request = &request;
		const io::Problem original = io::buildProblem( robot, options );
		std::mt19937_64 random( settings.seed );
		m_set = makeStates( original, request, settings.states, random );
		const std::vector<Point> points = sampleSurfaces( original.scene.get(), settings.points, random );
		build( robot, request, points );
	}

	int run()
	{
		std::printf( "\nmicroseconds per state\n%-12s %-10s %5s | %-22s %8s %8s %8s | %s\n", "query", "states", "n",
		    "library", "median", "mean", "p95", "mean / leeway cloud" );
		m_exact = race( distanceContenders(), m_set, m_settings.repetitions );
		report( "exact", m_exact, distanceContenders(), "" );
		for ( const double margin : { MARGIN, 0.0 } )
		{
			const std::vector<Contender> contenders = booleanContenders( margin );
			report( margin > 0 ? "margin 10 mm" : "boolean", race( contenders, m_set, m_settings.repetitions ), contenders,
			    margin > 0 ? "margin" : "boolean" );
		}
		m_result["disagreements"] = m_disagreements;
		m_result["largest_difference_m"] = m_largest;
		std::printf( "\nlargest difference %.3g m: %zu disagreements\n", m_largest, m_disagreements );
		return m_disagreements == 0 ? 0 : 1;
	}

private:
	void build( const io::RobotModel& robot, const io::Request& request, const std::vector<Point>& points )
	{
		lw_diag diag{};
		const double radius = 0.5 * m_settings.cell;
		const double cloud_seconds = seconds(
		    [&]
		    {
			    lw_shape* shape = nullptr;
			    leeway::require( lw_shape_create_points( points[0].data(), static_cast<std::uint32_t>( points.size() ),
			                         radius, nullptr, nullptr, &diag, &shape ),
			        diag );
			    m_cloud_shape = leeway::Shape::adopt( shape );
		    } );
		std::shared_ptr<octomap::OcTree> octree;
		const double octree_seconds = seconds( [&] { octree = makeOctree( points, m_settings.cell ); } );
		const std::vector<double> boxes = boxesOf( *octree );
		const double boxes_seconds = seconds(
		    [&]
		    {
			    lw_shape* shape = nullptr;
			    leeway::require( lw_shape_create_boxes( boxes.data(), static_cast<std::uint32_t>( boxes.size() / 6 ),
			                         nullptr, nullptr, &diag, &shape ),
			        diag );
			    m_boxes_shape = leeway::Shape::adopt( shape );
		    } );
		m_cloud = std::make_unique<Leeway>( robot, m_cloud_shape, request );
		m_boxes = std::make_unique<Leeway>( robot, m_boxes_shape, request );
		const auto models = std::make_shared<FclModels>();
		const auto fcl_octree = std::make_shared<fcl::OcTreed>( std::shared_ptr<const octomap::OcTree>( octree ) );
		fcl_octree->computeLocalAABB();
		models->entries[m_boxes_shape.get()] = fcl_octree;
		m_fcl = std::make_unique<FclPeer>( m_boxes->problem().checker.get(), models );
		m_managers = std::make_unique<FclManagers>( *m_fcl, boxes );

		const auto bytes = []( const leeway::Shape& shape ) { return lw_shape_get_info( shape.get() ).bytes; };
		std::printf( "%zu points of radius %g m: built in %.3f s, %zu bytes each\n", points.size(), radius, cloud_seconds,
		    bytes( m_cloud_shape ) / points.size() );
		std::printf( "octomap of cells of %g m: %zu boxes, built in %.3f s, %zu bytes; leeway's tree over the boxes %.3f s, "
		             "%zu bytes\n",
		    m_settings.cell, boxes.size() / 6, octree_seconds, octree->memoryUsage(), boxes_seconds,
		    bytes( m_boxes_shape ) );
		m_result["build"] = { { "points", points.size() }, { "radius_m", radius }, { "cloud_cpu_seconds", cloud_seconds },
		    { "cloud_bytes", bytes( m_cloud_shape ) }, { "octomap_boxes", boxes.size() / 6 },
		    { "octomap_cpu_seconds", octree_seconds }, { "octomap_bytes", octree->memoryUsage() },
		    { "boxes_cpu_seconds", boxes_seconds }, { "boxes_bytes", bytes( m_boxes_shape ) } };
	}

	static Answer single( double value ) { return { value, value }; }

	std::vector<Contender> distanceContenders()
	{
		return { { "leeway cloud", [this]( const double* q ) { return m_cloud->distance( q ); } },
		    { "leeway boxes", [this]( const double* q ) { return m_boxes->distance( q ); } },
		    { "FCL OcTree",
		        [this]( const double* q )
		        {
			        m_fcl->pose( q );
			        return single( m_fcl->environmentDistance( INFINITE ) );
		        } },
		    { "FCL managers", [this]( const double* q )
		        {
			        m_managers->pose( q );
			        return single( m_managers->distance( m_fcl->staticDistance() ) );
		        } } };
	}

	std::vector<Contender> booleanContenders( double margin )
	{
		return { { "leeway cloud", [this, margin]( const double* q ) { return m_cloud->violates( q, margin ); } },
		    { "leeway boxes", [this, margin]( const double* q ) { return m_boxes->violates( q, margin ); } },
		    { "FCL OcTree",
		        [this, margin]( const double* q )
		        {
			        m_fcl->pose( q );
			        return single(
			            margin > 0 ? m_fcl->environmentDistance( margin ) < margin : m_fcl->environmentCollides() );
		        } },
		    { "FCL managers", [this, margin]( const double* q )
		        {
			        m_managers->pose( q );
			        const bool resting = m_fcl->staticDistance() <= margin;
			        return single(
			            resting || ( margin > 0 ? m_managers->distance( margin ) < margin : m_managers->collides() ) );
		        } } };
	}

	/// Distance of an answer from the interval that the exact answers allow; 0 if it is right.
	double excess( const char* question, std::size_t contender, const Answer& got, std::size_t state ) const
	{
		const double boxes = m_exact[1].answers[state].upper, cloud = m_exact[0].answers[state].upper;
		if ( *question != 0 )
		{
			const double threshold = *question == 'm' ? MARGIN : 0, truth = contender == 0 ? cloud : boxes;
			const bool yes = got.upper > 0;
			return yes == ( truth <= threshold ) ? 0 : std::abs( truth - threshold );
		}
		if ( contender > 0 )
		{
			return std::max( { 0.0, got.lower - boxes, boxes - got.upper } );
		}
		const double radius = 0.5 * m_settings.cell, diagonal = std::sqrt( 3.0 ) * m_settings.cell;
		return std::max(
		    { 0.0, got.upper - std::max( 0.0, boxes + diagonal - radius ), std::max( 0.0, boxes - radius ) - got.upper } );
	}

	void report(
	    const char* name, const std::vector<Run>& runs, const std::vector<Contender>& contenders, const char* question )
	{
		for ( const char* kind : { "free", "colliding" } )
		{
			std::vector<std::size_t> members;
			for ( std::size_t i = 0; i < m_set.states.size(); ++i )
			{
				if ( ( m_exact[1].answers[i].upper > 0 ) == ( *kind == 'f' ) )
				{
					members.push_back( i );
				}
			}
			double reference = 0;
			for ( std::size_t c = 0; c < contenders.size() && !members.empty(); ++c )
			{
				Hash hash;
				std::size_t disagreements = 0;
				for ( const std::size_t i : members )
				{
					const Answer& answer = runs[c].answers[i];
					hash.add( std::llround( answer.upper * 1e9 ) );
					const double by = excess( question, c, answer, i );
					disagreements += by > AGREEMENT;
					m_largest = std::max( m_largest, by );
				}
				const Summary s = summarise( runs[c], members );
				reference = c == 0 ? s.mean : reference;
				m_disagreements += disagreements;
				std::printf( "%-12s %-10s %5zu | %-22s %8.1f %8.1f %8.1f | %6.2f%s\n", name, kind, members.size(),
				    contenders[c].name.c_str(), s.median, s.mean, s.p95, s.mean / reference,
				    disagreements > 0 ? "  DISAGREES" : "" );
				Json row = { { "workload", std::string( "cloud " ) + name + ", " + kind }, { "library", contenders[c].name },
				    { "states", members.size() } };
				row.update( toJson( s ) );
				row["answers_hash"] = hash.text();
				row["disagreements"] = disagreements;
				m_result.add( std::move( row ) );
			}
		}
		std::fflush( stdout );
	}

	const Settings& m_settings;
	Result& m_result;
	ConfigurationSet m_set;
	leeway::Shape m_cloud_shape, m_boxes_shape;
	std::unique_ptr<Leeway> m_cloud, m_boxes;
	std::unique_ptr<FclPeer> m_fcl;
	std::unique_ptr<FclManagers> m_managers;
	std::vector<Run> m_exact;
	std::size_t m_disagreements = 0;
	double m_largest = 0;
};

} // namespace

void addCloud( Bench& bench )
{
	const auto s = std::make_shared<Settings>();
	Command& command = bench.command( "cloud", "a million points in leeway, their octomap in FCL" );
	command.option( "--data", s->data, "folder with mbm" );
	command.option( "--set", s->set, "of Panda's problems" );
	command.option( "--problem", s->problem, "its number" );
	command.option( "--points", s->points, "of the cloud", { 1, 100000000 } );
	command.option(
	    "--cell", s->cell, "edge of the octomap's cells, metres; points get half of it as radius", { 1e-4, 1.0 } );
	command.option( "--states", s->states, "states", { 1, 100000 } );
	command.option( "--repetitions", s->repetitions, "passes over the states", { 1, 1000 } );
	command.option( "--seed", s->seed, "of points and states" );
	command.flag( "--quick", s->quick, "100,000 points, 40 states, one pass: for agreement, not for figures" );
	command.work(
	    [s]( Result& result )
	    {
		    if ( s->quick )
		    {
			    s->points = std::min<std::size_t>( s->points, 100000 );
			    s->states = std::min<std::size_t>( s->states, 40 );
			    s->repetitions = 1;
		    }
		    requireData( s->data, "mbm" );
		    return Cloud( *s, result ).run();
	    } );
}
