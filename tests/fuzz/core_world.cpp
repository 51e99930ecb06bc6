// SPDX-License-Identifier: BSD-3-Clause
// Objects of the core for the structured fuzzer.
#include "core_world.hpp"
#include "shape/shape.h"

#include <array>
#include <cstring>

namespace fuzz
{

namespace
{

constexpr std::size_t most_objects = 8; ///< of each kind
// Values of enumerations stay within the bits of their largest one: others are undefined in C++ before any call is made.
const char* const names[] = { "a", "b", "c", "d", "e", "f", "", "a" };

} // namespace

double CoreWorld::real()
{
	static const double odd[] = {
	    0.0, -0.0, 1.0, -1.0, NAN, INFINITY, -INFINITY, 1e9, -1e9, 1.0001e9, 1e-9, 5e-324, 1e300, -1e300, 1e38, 1e-40 };
	if ( m_bytes.oneIn( m_tame ? 24 : 4 ) )
	{
		return odd[m_bytes.below( m_tame ? 7 : 16 )];
	}
	if ( m_tame || !m_bytes.oneIn( 8 ) )
	{
		return m_bytes.between( -3, 3 );
	}
	std::uint64_t bits = 0;
	for ( int i = 0; i < 8; ++i )
	{
		bits = bits << 8 | m_bytes.next();
	}
	double value;
	std::memcpy( &value, &bits, sizeof value );
	return value;
}

lw_transform CoreWorld::pose()
{
	lw_transform result = lw_transform_identity();
	const double position[3] = { real(), real(), real() };
	if ( m_bytes.oneIn( 3 ) )
	{
		std::memcpy( result.t, position, sizeof position );
		return result;
	}
	const double rotation[4] = { real(), real(), real(), real() };
	const lw_status status = m_bytes.oneIn( 2 ) ? lw_transform_from_quaternion( position, rotation, &result )
	                                            : lw_transform_from_rpy( position, rotation, &result );
	bool far = false; // is left to those who take the pose
	for ( double t : position )
	{
		far = far || std::fabs( t ) > LW_MAX_TRANSLATION;
	}
	expect( status != LW_OK || far || lw_transform_is_valid( &result ), "a transform that was made is one" );
	if ( m_bytes.oneIn( 32 ) )
	{
		result.r[m_bytes.below( 3 )][m_bytes.below( 3 )] = real();
	}
	return result;
}

template <typename T> void CoreWorld::keep( std::vector<T*>& all, void ( *release )( T* ), lw_status status, T* made )
{
	expect( ( status == LW_OK ) == ( made != nullptr ), "there is an object if and only if the status is LW_OK" );
	if ( made == nullptr )
	{
		return;
	}
	if ( all.size() >= most_objects )
	{
		release( all.front() );
		all.erase( all.begin() );
	}
	all.push_back( made );
}

CoreWorld::~CoreWorld()
{
	for ( lw_query* query : m_queries )
	{
		lw_query_destroy( query );
	}
	for ( lw_shape* shape : m_shapes ) // objects hold references to the objects that they need, so that any order will do
	{
		lw_shape_release( shape );
	}
	for ( lw_robot* robot : m_robots )
	{
		lw_robot_release( robot );
	}
	for ( lw_scene* scene : m_scenes )
	{
		lw_scene_release( scene );
	}
	for ( lw_checker* checker : m_checkers )
	{
		lw_checker_release( checker );
	}
	for ( lw_reach* reach : m_reaches )
	{
		lw_reach_release( reach );
	}
}

void CoreWorld::releaseSomething()
{
	const auto drop = [this]( auto& all, auto release )
	{
		if ( !all.empty() )
		{
			const std::size_t index = m_bytes.below( static_cast<std::uint32_t>( all.size() ) );
			release( all[index] );
			all.erase( all.begin() + static_cast<std::ptrdiff_t>( index ) );
		}
	};
	switch ( m_bytes.below( 6 ) )
	{
	case 0:
		return drop( m_shapes, lw_shape_release );
	case 1:
		return drop( m_scenes, lw_scene_release );
	case 2:
		return drop( m_robots, lw_robot_release );
	case 3:
		return drop( m_checkers, lw_checker_release );
	case 4:
		return drop( m_queries, lw_query_destroy );
	default:
		return drop( m_reaches, lw_reach_release );
	}
}

// ---- shapes -----------------------------------------------------------------------------------------------------------

lw_tree_def CoreWorld::tree()
{
	lw_tree_def def = lw_tree_def_default();
	if ( m_bytes.oneIn( 4 ) )
	{
		def.fit = static_cast<lw_sphere_fit>( m_bytes.below( 4 ) );
		def.leaf_size = m_bytes.below( 10 );
	}
	if ( m_bytes.oneIn( 16 ) && m_tame )
	{
		def.tile_radius = m_bytes.between( -0.1, 1 );
		def.tile_radius =
		    def.tile_radius > 0 ? def.tile_radius + 0.2 : def.tile_radius; // tiles are many where they are small
	}
	return def;
}

void CoreWorld::addPrimitive()
{
	const double dimensions[3] = { real(), real(), real() };
	const lw_shape_type type = static_cast<lw_shape_type>( m_bytes.below( 13 ) );
	lw_shape* shape = nullptr;
	lw_diag diag;
	const lw_status status =
	    lw_shape_create_primitive( type, m_bytes.oneIn( 32 ) ? nullptr : dimensions, memory(), &diag, &shape );
	keep( m_shapes, lw_shape_release, status, shape );
}

void CoreWorld::addMesh()
{
	const std::uint32_t vertex_count = m_bytes.below( 24 ), triangle_count = m_bytes.below( 32 );
	std::vector<double> vertices( 3 * vertex_count + 1 );
	std::vector<std::uint32_t> indices( 3 * triangle_count + 1 );
	for ( double& value : vertices )
	{
		value = real();
	}
	for ( std::uint32_t& index : indices )
	{
		index = m_bytes.below( vertex_count + ( m_bytes.oneIn( 64 ) ? 2 : 0 ) + ( vertex_count == 0 ? 1 : 0 ) );
	}
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = vertices.data();
	def.vertex_count = vertex_count;
	def.indices = indices.data();
	def.triangle_count = triangle_count;
	def.weld_tolerance = m_bytes.oneIn( 4 ) ? real() : 0.0;
	def.solid = m_bytes.oneIn( 4 );
	def.tree = tree();
	def.scale[0] = m_bytes.oneIn( 8 ) ? real() : 1.0;
	def.cookie ^= m_bytes.oneIn( 64 ) ? 1u : 0u;
	lw_shape* shape = nullptr;
	lw_diag diag;
	const lw_status status = lw_shape_create_mesh( &def, memory(), &diag, &shape );
	keep( m_shapes, lw_shape_release, status, shape );
	expect( shape == nullptr || allocator()->left >= 0 || lwi_shape_validate( shape, &diag ) == LW_OK,
	    "a mesh that was made has a valid tree" );
}

void CoreWorld::addSet()
{
	const std::uint32_t count = m_bytes.below( 24 ), kind = m_bytes.below( 3 );
	std::vector<double> numbers( 6 * count + 1 );
	for ( std::uint32_t i = 0; i < 6 * count; ++i )
	{
		numbers[i] = kind == 2 && i % 6 >= 3 ? numbers[i - 3] + std::fabs( real() ) : real();
		numbers[i] = kind == 1 && i % 4 == 3 && !m_bytes.oneIn( 32 ) ? std::fabs( numbers[i] ) : numbers[i];
	}
	const lw_tree_def def = tree();
	lw_shape* shape = nullptr;
	lw_diag diag;
	const lw_status status = kind == 0   ? lw_shape_create_points( numbers.data(), count, m_bytes.oneIn( 4 ) ? real() : 0.1,
	                                           &def, memory(), &diag, &shape )
	                         : kind == 1 ? lw_shape_create_spheres( numbers.data(), count, &def, memory(), &diag, &shape )
	                                     : lw_shape_create_boxes( numbers.data(), count, &def, memory(), &diag, &shape );
	keep( m_shapes, lw_shape_release, status, shape );
}

void CoreWorld::addDeferred()
{
	struct Maker
	{
		lw_shape* shape;
		bool fails;
	};
	lw_shape* inner = pick( m_shapes );
	if ( inner == nullptr )
	{
		return;
	}
	const lw_shape_info info = lw_shape_get_info( inner );
	auto* maker = new Maker{ lw_shape_retain( inner ), m_bytes.oneIn( 8 ) };
	lw_deferred_def def = lw_deferred_def_default();
	for ( int axis = 0; axis < 3; ++axis )
	{
		def.box_min[axis] = m_bytes.oneIn( 16 ) ? real() : info.box_min[axis];
		def.box_max[axis] = m_bytes.oneIn( 16 ) ? real() : info.box_max[axis];
	}
	def.triangle_count = info.triangle_count;
	def.make = []( void* user, lw_diag*, lw_shape** out )
	{
		const Maker* from = static_cast<const Maker*>( user );
		*out = from->fails ? nullptr : lw_shape_retain( from->shape );
		return from->fails ? LW_ERROR_UNSUPPORTED : LW_OK;
	};
	const auto release = []( void* user )
	{
		Maker* from = static_cast<Maker*>( user );
		lw_shape_release( from->shape );
		delete from;
	};
	def.release = release;
	def.user = maker;
	lw_shape* shape = nullptr;
	lw_diag diag;
	const lw_status status = lw_shape_create_deferred( &def, memory(), &diag, &shape );
	if ( status != LW_OK )
	{
		release( maker );
	}
	keep( m_shapes, lw_shape_release, status, shape );
	if ( shape != nullptr && m_bytes.oneIn( 3 ) )
	{
		(void)lw_shape_complete( shape, &diag );
	}
}

void CoreWorld::addDetail()
{
	const lw_tree_def def = tree();
	lw_shape* shape = nullptr;
	lw_diag diag;
	// Of a size that makes sense: the proof of a tolerance of nothing subdivides as far as numbers go
	const double tolerance = m_tame ? m_bytes.between( -0.01, 1 ) : real();
	const lw_status status = lw_shape_create_detail( pick( m_shapes ), tolerance, &def, memory(), &diag, &shape );
	keep( m_shapes, lw_shape_release, status, shape );
}

// ---- scenes -----------------------------------------------------------------------------------------------------------

void CoreWorld::addScene()
{
	const std::uint32_t objects = m_bytes.below( 7 ), count = m_bytes.below( 9 );
	std::vector<lw_scene_shape_def> shapes;
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		const std::uint32_t object = objects > 0 && !m_bytes.oneIn( 64 ) ? m_bytes.below( objects ) : m_bytes.next();
		shapes.push_back( { pick( m_shapes ), object, pose() } );
	}
	lw_scene_def def = lw_scene_def_default();
	def.object_names = names;
	def.object_count = objects;
	def.shapes = shapes.data();
	def.shape_count = count;
	lw_scene* scene = nullptr;
	lw_diag diag;
	const lw_status status = lw_scene_create( &def, memory(), &diag, &scene );
	keep( m_scenes, lw_scene_release, status, scene );
}

void CoreWorld::editScene()
{
	const lw_scene* from = pick( m_scenes );
	constexpr std::uint32_t most = 3;
	std::array<std::array<const lw_shape*, most>, most> shapes;
	std::array<std::array<lw_transform, most>, most> poses;
	std::array<lw_scene_change, most> changes;
	const std::uint32_t count = m_bytes.below( most + 1 );
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		lw_scene_change& change = changes[i];
		change.type = static_cast<lw_scene_change_type>( m_bytes.below( 4 ) );
		change.object = m_bytes.oneIn( 64 ) ? nullptr : names[m_bytes.below( 8 )];
		change.shapes = shapes[i].data();
		change.world_from_shape = poses[i].data();
		change.shape_count = m_bytes.below( most + 1 );
		for ( std::uint32_t k = 0; k < most; ++k )
		{
			shapes[i][k] = pick( m_shapes );
			poses[i][k] = pose();
		}
	}
	lw_scene* scene = nullptr;
	lw_diag diag;
	const lw_status status = lw_scene_edit( from, changes.data(), count, memory(), &diag, &scene );
	keep( m_scenes, lw_scene_release, status, scene );
}

// ---- robots -----------------------------------------------------------------------------------------------------------

void CoreWorld::addRobot()
{
	const std::uint32_t links = m_bytes.below( 7 ), bodies = m_bytes.below( 6 );
	std::vector<lw_joint_def> joints( links > 0 ? links - 1 : 0, lw_joint_def_default() );
	for ( std::uint32_t i = 0; i < joints.size(); ++i )
	{
		lw_joint_def& joint = joints[i];
		joint.name = m_bytes.oneIn( 32 ) ? names[m_bytes.below( 8 )] : names[i];
		joint.type = static_cast<lw_joint_type>( m_bytes.oneIn( 32 ) ? m_bytes.below( 8 ) : 1 + m_bytes.below( 6 ) );
		joint.parent = m_bytes.oneIn( 32 ) ? m_bytes.next() : m_bytes.below( i + 1 );
		joint.child = m_bytes.oneIn( 32 ) ? m_bytes.below( links ) : i + 1;
		joint.parent_from_joint = pose();
		joint.axis[0] = real();
		joint.axis[1] = real();
		joint.lower = m_bytes.oneIn( 8 ) ? real() : -1;
		joint.upper = m_bytes.oneIn( 8 ) ? real() : 2;
		joint.position_lower[0] = m_bytes.oneIn( 4 ) ? real() : joint.position_lower[0];
		joint.position_upper[0] = m_bytes.oneIn( 4 ) ? real() : joint.position_upper[0];
		if ( m_bytes.oneIn( 8 ) )
		{
			joint.mimic = m_bytes.below( links );
			joint.mimic_multiplier = real();
			joint.mimic_offset = real();
		}
	}
	std::vector<lw_body_def> body_defs;
	for ( std::uint32_t i = 0; i < bodies; ++i )
	{
		body_defs.push_back( { pick( m_shapes ),
		    m_bytes.below( links + ( m_bytes.oneIn( 32 ) ? 2 : 0 ) + ( links == 0 ? 1 : 0 ) ), pose() } );
	}
	const lw_link_pair allowed[2] = { { m_bytes.below( 8 ), m_bytes.below( 8 ) }, { 0, 1 } };
	lw_robot_def def = lw_robot_def_default();
	def.name = "r";
	def.link_names = names;
	def.link_count = links;
	def.joints = joints.data();
	def.joint_count = static_cast<std::uint32_t>( joints.size() );
	def.bodies = body_defs.data();
	def.body_count = bodies;
	def.allowed_pairs = allowed;
	def.allowed_pair_count = m_bytes.oneIn( 4 ) ? m_bytes.below( 3 ) : 0;
	def.world_from_root = pose();
	lw_robot* robot = nullptr;
	lw_diag diag;
	const lw_status status = lw_robot_create( &def, memory(), &diag, &robot );
	keep( m_robots, lw_robot_release, status, robot );
}

void CoreWorld::changeAttached()
{
	const lw_robot* from = pick( m_robots );
	lw_robot* robot = nullptr;
	lw_diag diag;
	if ( m_bytes.oneIn( 3 ) )
	{
		const lw_status status =
		    lw_robot_detach( from, m_bytes.oneIn( 4 ) ? names[m_bytes.below( 8 )] : "held", memory(), &diag, &robot );
		return keep( m_robots, lw_robot_release, status, robot );
	}
	const lw_shape* shapes[2] = { pick( m_shapes ), pick( m_shapes ) };
	const lw_transform poses[2] = { pose(), pose() };
	const std::uint32_t touch[2] = { m_bytes.below( 8 ), m_bytes.below( 8 ) };
	lw_attachment_def def = lw_attachment_def_default();
	def.name = m_bytes.oneIn( 8 ) ? names[m_bytes.below( 8 )] : "held";
	def.link = m_bytes.below( 8 );
	def.shapes = shapes;
	def.link_from_shape = poses;
	def.shape_count = m_bytes.below( 3 );
	def.touch_links = touch;
	def.touch_link_count = m_bytes.below( 3 );
	const lw_status status = lw_robot_attach( from, &def, memory(), &diag, &robot );
	keep( m_robots, lw_robot_release, status, robot );
}

void CoreWorld::lookAtRobot()
{
	const lw_robot* robot = pick( m_robots );
	if ( robot == nullptr )
	{
		return;
	}
	const std::uint32_t index = m_bytes.oneIn( 8 ) ? LW_INVALID_INDEX : m_bytes.below( 12 ), other = m_bytes.below( 12 );
	(void)lw_robot_link_name( robot, index % lw_robot_link_count( robot ) );
	(void)lw_robot_pair_allowed( robot, index, other );
	(void)lw_robot_is_attached( robot, index );
	(void)lw_robot_find_link( robot, names[other % 8] );
	std::vector<double> q( lw_robot_variable_count( robot ) ), qb( q.size() ), between( q.size() );
	lw_robot_default_state( robot, q.data() );
	std::vector<lw_transform> poses( lw_robot_link_count( robot ) );
	expect( lw_robot_fk( robot, q.data(), poses.data() ) == LW_OK, "the default state has poses" );
	for ( double& value : qb )
	{
		value = real();
	}
	lw_robot_interpolate( robot, q.data(), qb.data(), m_bytes.between( 0, 1 ), between.data() );
	const lw_status status = lw_robot_fk( robot, qb.data(), poses.data() );
	for ( double value : qb )
	{
		expect( std::isfinite( value ) || status != LW_OK, "a state with a value that is not finite has no poses" );
	}
}

// ---- checkers ---------------------------------------------------------------------------------------------------------

void CoreWorld::makeMargins( const lw_robot* robot, const lw_scene* scene, lw_margins& margins )
{
	m_link_margins.resize( robot != nullptr ? lw_robot_link_count( robot ) : 8 );
	m_object_margins.resize( scene != nullptr ? lw_scene_object_count( scene ) : 8 );
	for ( std::vector<double>* all : { &m_link_margins, &m_object_margins } )
	{
		for ( double& value : *all )
		{
			value = m_bytes.oneIn( 32 ) ? real() : m_bytes.between( 0, 0.2 );
		}
	}
	margins.environment = m_bytes.oneIn( 16 ) ? real() : m_bytes.between( 0, 0.2 );
	margins.self = m_bytes.oneIn( 2 ) ? 0.0 : 0.01;
	margins.link_environment = m_bytes.oneIn( 2 ) ? m_link_margins.data() : nullptr;
	margins.link_self = m_bytes.oneIn( 2 ) ? m_link_margins.data() : nullptr;
	margins.object = m_bytes.oneIn( 2 ) && scene != nullptr ? m_object_margins.data() : nullptr;
}

void CoreWorld::addChecker()
{
	lw_checker_def def = lw_checker_def_default();
	def.robot = pick( m_robots );
	def.scene = m_bytes.oneIn( 4 ) ? nullptr : pick( m_scenes );
	def.reach = m_bytes.oneIn( 2 ) ? nullptr : pick( m_reaches );
	def.previous = m_bytes.oneIn( 2 ) ? nullptr : pick( m_checkers );
	std::vector<std::uint32_t> variables( m_bytes.below( 5 ) );
	for ( std::uint32_t& variable : variables )
	{
		variable = m_bytes.below( 12 );
	}
	std::vector<double> reference( def.robot != nullptr ? lw_robot_variable_count( def.robot ) : 0 );
	for ( double& value : reference )
	{
		value = real();
	}
	const bool group = m_bytes.oneIn( 4 );
	def.variables = group ? variables.data() : nullptr;
	def.variable_count = group ? static_cast<std::uint32_t>( variables.size() ) : 0;
	def.reference = m_bytes.oneIn( 4 ) ? reference.data() : nullptr;
	const lw_link_object_pair allowed[2] = { { m_bytes.below( 8 ), m_bytes.below( 8 ) }, { 0, 0 } };
	def.allowed = allowed;
	def.allowed_count = m_bytes.oneIn( 4 ) ? m_bytes.below( 3 ) : 0;
	def.max_d = m_bytes.oneIn( 4 ) ? real() : INFINITY;
	if ( m_bytes.oneIn( 3 ) )
	{
		makeMargins( def.robot, def.scene, def.margins );
	}
	lw_checker* checker = nullptr;
	lw_diag diag;
	const lw_status status = lw_checker_create( &def, memory(), &diag, &checker );
	keep( m_checkers, lw_checker_release, status, checker );
}

void CoreWorld::editChecker()
{
	const lw_checker* from = pick( m_checkers );
	lw_checker_edit_def def = lw_checker_edit_def_default();
	def.scene = m_bytes.oneIn( 3 ) ? nullptr : pick( m_scenes );
	def.robot = m_bytes.oneIn( 2 ) ? nullptr : pick( m_robots );
	const lw_link_object_pair allowed[2] = { { m_bytes.below( 8 ), m_bytes.below( 8 ) }, { 0, 0 } };
	def.allowed = allowed;
	def.allowed_count = m_bytes.oneIn( 4 ) ? m_bytes.below( 3 ) : 0;
	def.replace_allowed = m_bytes.oneIn( 2 );
	lw_margins margins{};
	if ( m_bytes.oneIn( 4 ) )
	{
		makeMargins( def.robot, def.scene, margins );
		// arrays are as long as the objects that hold from now on: those of the checker where nothing else is given
		const bool known = def.robot != nullptr && def.scene != nullptr;
		margins.link_environment = known ? margins.link_environment : nullptr;
		margins.link_self = known ? margins.link_self : nullptr;
		margins.object = known ? margins.object : nullptr;
		def.margins = &margins;
	}
	def.max_d = m_bytes.oneIn( 4 ) ? real() : def.max_d;
	lw_checker* checker = nullptr;
	lw_diag diag;
	const lw_status status = lw_checker_edit( from, &def, memory(), &diag, &checker );
	keep( m_checkers, lw_checker_release, status, checker );
}

void CoreWorld::addQuery()
{
	lw_query_def def = lw_query_def_default();
	def.simd = static_cast<lw_simd>( m_bytes.below( 4 ) );
	def.transform_caching = m_bytes.oneIn( 2 );
	def.warm_start = m_bytes.oneIn( 2 );
	def.motion_hulls = def.pair_tables = m_bytes.oneIn( 2 );
	def.spare_shapes = m_bytes.below( 3 );
	def.spare_bodies = m_bytes.below( 3 );
	lw_query* query = nullptr;
	const lw_status status = lw_query_create( &def, pick( m_scenes ), pick( m_checkers ), memory(), &query );
	keep( m_queries, lw_query_destroy, status, query );
}

void CoreWorld::addReach()
{
	if ( !m_tame ) // hulls are sampled along chains of any length: offline work, of seconds
	{
		return;
	}
	lw_reach_def def = lw_reach_def_default();
	def.robot = pick( m_robots );
	def.hull_error = m_bytes.oneIn( 16 ) ? real() : 0.5;
	def.hull_error = def.hull_error > 0 ? std::fmax( def.hull_error, 0.2 ) : def.hull_error;
	def.limit_margin = m_bytes.oneIn( 16 ) ? real() : 1e-6;
	def.seconds = 0;
	def.hulls_only = m_bytes.oneIn( 2 );
	def.samples = m_bytes.below( 8 );
	int steps = 0;
	def.progress = []( void* user, const char*, double ) { return ++*static_cast<int*>( user ) < 50; };
	def.progress_user = &steps;
	lw_reach* reach = nullptr;
	lw_diag diag;
	const lw_reach* before = m_bytes.oneIn( 2 ) ? nullptr : pick( m_reaches );
	if ( before != nullptr && m_bytes.oneIn( 2 ) )
	{
		def.robot = lw_reach_robot( before ); // the only one that it takes
	}
	// qhull takes its memory where it wants: the leak sanitizer finds its leaks
	const lw_status status = before != nullptr ? lw_reach_continue( before, &def, memory(), &diag, &reach )
	                                           : lw_reach_create( &def, memory(), &diag, &reach );
	keep( m_reaches, lw_reach_release, status, reach );
}

void CoreWorld::saveAndRead()
{
	const lw_shape* shape = pick( m_shapes );
	const lw_reach* reach = m_bytes.oneIn( 2 ) ? nullptr : pick( m_reaches );
	lw_blob_def def = lw_blob_def_default();
	def.shapes = &shape;
	def.shape_count = m_bytes.below( 2 );
	def.reach = reach;
	void* bytes = nullptr;
	std::size_t size = 0;
	lw_diag diag;
	const lw_status status = lw_blob_write( &def, memory(), &diag, &bytes, &size );
	expect( ( status == LW_OK ) == ( bytes != nullptr ), "there is a blob if and only if the status is LW_OK" );
	if ( bytes == nullptr )
	{
		return;
	}
	lw_shape* read = nullptr;
	const lw_status again = lw_blob_read_shapes( bytes, size, def.key, memory(), &diag, &read, def.shape_count );
	expect( again == LW_OK || again == LW_ERROR_OUT_OF_MEMORY, "what was written can be read" );
	if ( read != nullptr )
	{
		expect( allocator()->left >= 0 || lw_digest_equal( lw_shape_digest( read ), lw_shape_digest( shape ) ),
		    "a shape is read as it was written" );
		lw_shape_release( read );
	}
	lw_blob_free( memory(), bytes, size );
}

} // namespace fuzz
