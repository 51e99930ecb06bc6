// SPDX-License-Identifier: BSD-3-Clause
// kitchen_reaches: finds goals for the reach tasks and writes reach_goals.cpp. Run it by hand after a change of the model.
//
// Damped least squares (Levenberg 1944, Marquardt 1963) from seeded random poses, kept within the joint limits; of the
// solutions that are clear of everything, the one that best combines clearance with a relaxed pose wins.
#include "model.hpp"

#include "leeway/handles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <stdexcept>

namespace
{

using namespace kitchen;
using leeway::require;

constexpr double wanted_clearance = 0.008;  ///< metres, at start and goal
constexpr double position_tolerance = 0.02; ///< metres, of the hand
constexpr int restarts = 400;

lw_transform transform( const Pose& pose )
{
	lw_transform out;
	for ( int i = 0; i < 3; ++i )
		for ( int j = 0; j < 3; ++j )
			out.r[i][j] = pose.r[i][j];
	out.t[0] = pose.t.x;
	out.t[1] = pose.t.y;
	out.t[2] = pose.t.z;
	return out;
}

leeway::Shape meshShape( const Mesh& mesh )
{
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = &mesh.vertices.front().x;
	def.vertex_count = static_cast<uint32_t>( mesh.vertices.size() );
	def.indices = mesh.triangles.front().data();
	def.triangle_count = static_cast<uint32_t>( mesh.triangles.size() );
	lw_diag diag = {};
	lw_shape* shape = nullptr;
	require( lw_shape_create_mesh( &def, nullptr, &diag, &shape ), diag );
	return leeway::Shape::adopt( shape );
}

leeway::Robot buildRobot( const Robot& model )
{
	std::vector<const char*> names;
	std::vector<leeway::Shape> shapes;
	std::vector<lw_body_def> bodies;
	std::map<std::string, uint32_t> index;
	for ( const Link& link : model.links )
	{
		index[link.name] = static_cast<uint32_t>( names.size() );
		names.push_back( link.name.c_str() );
		for ( const Part& part : link.parts )
		{
			shapes.push_back( meshShape( part.mesh ) );
			bodies.push_back( { shapes.back().get(), index[link.name], lw_transform_identity() } );
		}
	}
	const std::map<std::string, lw_joint_type> types = { { "fixed", LW_JOINT_FIXED }, { "revolute", LW_JOINT_REVOLUTE },
	    { "continuous", LW_JOINT_CONTINUOUS }, { "prismatic", LW_JOINT_PRISMATIC } };
	std::vector<lw_joint_def> joints;
	for ( const Joint& joint : model.joints )
	{
		lw_joint_def def = lw_joint_def_default();
		def.name = joint.name.c_str();
		def.type = types.at( joint.type );
		def.parent = index.at( joint.parent );
		def.child = index.at( joint.child );
		def.parent_from_joint =
		    transform( at( joint.xyz.x, joint.xyz.y, joint.xyz.z, joint.rpy.x, joint.rpy.y, joint.rpy.z ) );
		if ( joint.type != "fixed" )
		{
			def.axis[0] = joint.axis.x;
			def.axis[1] = joint.axis.y;
			def.axis[2] = joint.axis.z;
		}
		def.lower = joint.lower;
		def.upper = joint.upper;
		joints.push_back( def );
	}
	std::vector<lw_link_pair> allowed;
	for ( const auto& pair : model.allowed )
		allowed.push_back( { index.at( pair[0] ), index.at( pair[1] ) } );
	lw_robot_def def = lw_robot_def_default();
	def.name = "kitchen_humanoid";
	def.link_names = names.data();
	def.link_count = static_cast<uint32_t>( names.size() );
	def.joints = joints.data();
	def.joint_count = static_cast<uint32_t>( joints.size() );
	def.bodies = bodies.data();
	def.body_count = static_cast<uint32_t>( bodies.size() );
	def.allowed_pairs = allowed.data();
	def.allowed_pair_count = static_cast<uint32_t>( allowed.size() );
	lw_diag diag = {};
	lw_robot* robot = nullptr;
	require( lw_robot_create( &def, nullptr, &diag, &robot ), diag );
	return leeway::Robot::adopt( robot );
}

leeway::Scene buildScene( const Room& room )
{
	std::vector<leeway::Shape> meshes, primitives;
	for ( const Part& part : room.parts )
		meshes.push_back( meshShape( part.mesh ) );
	std::vector<const char*> names;
	std::vector<lw_scene_shape_def> shapes;
	for ( const Object& object : room.objects )
	{
		for ( const Placed& placed : object.shapes )
		{
			const lw_shape* shape = placed.part >= 0 ? meshes[static_cast<size_t>( placed.part )].get() : nullptr;
			if ( !shape )
			{
				const bool is_box = placed.type == "box";
				const double cylinder[3] = { placed.dimensions[1], placed.dimensions[0], 0 };
				lw_diag diag = {};
				lw_shape* primitive = nullptr;
				require( lw_shape_create_primitive( is_box ? LW_SHAPE_BOX : LW_SHAPE_CYLINDER,
				             is_box ? placed.dimensions.data() : cylinder, nullptr, &diag, &primitive ),
				    diag );
				primitives.push_back( leeway::Shape::adopt( primitive ) );
				shape = primitive;
			}
			shapes.push_back( { shape, static_cast<uint32_t>( names.size() ), transform( placed.pose ) } );
		}
		names.push_back( object.id.c_str() );
	}
	lw_scene_def def = lw_scene_def_default();
	def.object_names = names.data();
	def.object_count = static_cast<uint32_t>( names.size() );
	def.shapes = shapes.data();
	def.shape_count = static_cast<uint32_t>( shapes.size() );
	lw_diag diag = {};
	lw_scene* scene = nullptr;
	require( lw_scene_create( &def, nullptr, &diag, &scene ), diag );
	return leeway::Scene::adopt( scene );
}

/// One reach task made ready: its checker, limits, residuals.
class Search
{
public:
	Search( const lw_robot* robot, const lw_scene* scene, const Robot& model, const Reach& task )
	    : m_robot( robot ), m_task( task )
	{
		std::map<std::string, double> values = tuckedPose();
		for ( const auto& [joint, value] : task.start )
			values[joint] = value;
		m_reference.assign( lw_robot_variable_count( robot ), 0 );
		for ( const auto& [joint, value] : values )
			m_reference[variableOf( joint )] = value;
		for ( const std::string& joint : model.group( task.group ).joints )
		{
			m_variables.push_back( variableOf( joint ) );
			const lw_variable_info info = lw_robot_variable( robot, m_variables.back() );
			m_lower.push_back( info.lower );
			m_upper.push_back( info.upper );
			start.push_back( m_reference[m_variables.back()] );
			const bool torso = joint.rfind( "torso_", 0 ) == 0;
			m_stiffness.push_back( torso ? 0.5 : 0.15 );
		}
		lw_checker_def def = lw_checker_def_default();
		def.robot = robot;
		def.scene = scene;
		def.variables = m_variables.data();
		def.variable_count = static_cast<uint32_t>( m_variables.size() );
		def.reference = m_reference.data();
		const lw_link_object_pair wheels = { lw_robot_find_link( robot, "base" ), lw_scene_find_object( scene, "floor" ) };
		def.allowed = &wheels;
		def.allowed_count = 1;
		lw_diag diag = {};
		lw_checker* created = nullptr;
		require( lw_checker_create( &def, nullptr, &diag, &created ), diag );
		checker = leeway::Checker::adopt( created );
		query = leeway::makeQuery( created );
		m_poses.resize( lw_robot_link_count( robot ) );
	}

	/// Clearance of a state: of everything.
	double clearance( const std::vector<double>& q, std::string* where = nullptr )
	{
		const lw_range range = lw_range_exact();
		lw_state_result result;
		if ( lw_checker_state( checker.get(), query.get(), q.data(), LW_CHECK_BOTH, &range, false, &result ) != LW_OK )
			return 0;
		const bool self = result.self.lower < result.environment.lower;
		const lw_clearance& least = self ? result.self : result.environment;
		if ( where && least.a != LW_INVALID_INDEX && least.b != LW_INVALID_INDEX )
			*where = fmt::format( "{} - {}", lw_robot_link_name( m_robot, least.a ),
			    self ? lw_robot_link_name( m_robot, least.b )
			         : lw_scene_object_name( lw_checker_scene( checker.get() ), least.b ) );
		return least.lower;
	}

	/// Weighted differences from the task; `position` is the largest position error of a hand.
	std::vector<double> residuals( const std::vector<double>& q, double* position = nullptr )
	{
		std::vector<double> full( m_reference ), out;
		for ( size_t i = 0; i < q.size(); ++i )
			full[m_variables[i]] = q[i];
		lw_robot_fk( m_robot, full.data(), m_poses.data() );
		double worst = 0;
		for ( const HandTarget& hand : m_task.hands )
		{
			const lw_transform& tcp = m_poses[lw_robot_find_link( m_robot, ( hand.side + "_tcp" ).c_str() )];
			const Vec3 off = Vec3{ tcp.t[0], tcp.t[1], tcp.t[2] } - hand.tcp;
			worst = std::max( worst, length( off ) );
			auto push = [&out]( Vec3 v, double weight ) {
				out.insert( out.end(), { weight * v.x, weight * v.y, weight * v.z } );
			};
			push( off, 50 );
			auto column = [&tcp]( int c, double sign ) { return sign * Vec3{ tcp.r[0][c], tcp.r[1][c], tcp.r[2][c] }; };
			push( column( 2, -1 ) - normalised( hand.fingers ), 2 );
			if ( length( hand.palm ) > 0 )
				push( column( 1, hand.side == "left" ? -1 : 1 ) - normalised( hand.palm ), 1 );
		}
		for ( size_t i = 0; i < q.size(); ++i ) // a relaxed pose
			out.push_back( m_stiffness[i] * ( q[i] - start[i] ) );
		if ( position )
			*position = worst;
		return out;
	}

	void solve( std::vector<double>& q )
	{
		const size_t n = q.size();
		double damping = 1;
		std::vector<double> r = residuals( q );
		for ( int iteration = 0; iteration < 60; ++iteration )
		{
			const size_t m = r.size();
			std::vector<double> jacobian( m * n ), a( n * n ), b( n );
			for ( size_t i = 0; i < n; ++i )
			{
				std::vector<double> moved = q;
				moved[i] += 1e-6;
				const std::vector<double> rm = residuals( moved );
				for ( size_t k = 0; k < m; ++k )
					jacobian[k * n + i] = ( rm[k] - r[k] ) / 1e-6;
			}
			for ( size_t i = 0; i < n; ++i )
				for ( size_t k = 0; k < m; ++k )
				{
					b[i] -= jacobian[k * n + i] * r[k];
					for ( size_t j = 0; j < n; ++j )
						a[i * n + j] += jacobian[k * n + i] * jacobian[k * n + j];
				}
			for ( size_t i = 0; i < n; ++i )
				a[i * n + i] += damping;
			gauss( a, b );
			std::vector<double> next = q;
			for ( size_t i = 0; i < n; ++i )
				next[i] = std::clamp( q[i] + b[i], m_lower[i] + 0.02, m_upper[i] - 0.02 );
			const std::vector<double> rn = residuals( next );
			if ( squared( rn ) < squared( r ) )
			{
				q = next;
				r = rn;
				damping = std::max( 1e-4, 0.3 * damping );
			}
			else
				damping = std::min( 1e6, 4 * damping );
		}
	}

	/// Best goal found; empty if none. @param score the lower the better
	std::vector<double> find( double* found_clearance, double* nearest )
	{
		*nearest = INFINITY;
		std::mt19937_64 random( 20060815 );
		// 53 bits to [0, 1): the standard's distributions differ between libraries
		auto uniform = [&random]( double low, double high )
		{ return low + ( high - low ) * static_cast<double>( random() >> 11 ) / 9007199254740992.0; };
		std::vector<double> best;
		double best_score = INFINITY;
		for ( int i = 0; i < restarts; ++i )
		{
			std::vector<double> q;
			for ( size_t k = 0; k < start.size(); ++k )
				q.push_back( uniform( std::max( m_lower[k], start[k] - 1.2 ), std::min( m_upper[k], start[k] + 1.2 ) ) );
			solve( q );
			for ( double& value : q )
				value = std::round( value * 1e4 ) / 1e4;
			double position = 0;
			const std::vector<double> r = residuals( q, &position );
			*nearest = std::min( *nearest, position );
			if ( position > position_tolerance )
				continue;
			const double gap = clearance( q );
			if ( gap < wanted_clearance )
				continue;
			const double score = squared( r ) - 30 * std::min( gap, 0.025 );
			if ( score < best_score )
			{
				best_score = score;
				best = q;
				*found_clearance = gap;
			}
		}
		return best;
	}

	/// Least clearance at a hundred states of the straight line.
	double straightLine( const std::vector<double>& goal )
	{
		double least = INFINITY;
		for ( int i = 0; i <= 100 && least > 0; ++i )
		{
			std::vector<double> q;
			for ( size_t k = 0; k < goal.size(); ++k )
				q.push_back( start[k] + 0.01 * i * ( goal[k] - start[k] ) );
			least = std::min( least, clearance( q ) );
		}
		return least;
	}

	std::vector<double> start;
	leeway::Checker checker;
	leeway::Query query;

private:
	uint32_t variableOf( const std::string& joint ) const
	{
		const uint32_t index = lw_robot_find_joint( m_robot, joint.c_str() );
		if ( index == LW_INVALID_INDEX )
			throw std::runtime_error( "no joint " + joint );
		return lw_robot_joint_variable( m_robot, index );
	}

	static double squared( const std::vector<double>& v )
	{
		double sum = 0;
		for ( double x : v )
			sum += x * x;
		return sum;
	}

	/// Solves the symmetric positive definite a x = b in place.
	static void gauss( std::vector<double>& a, std::vector<double>& b )
	{
		const size_t n = b.size();
		for ( size_t i = 0; i < n; ++i )
			for ( size_t k = i + 1; k < n; ++k )
			{
				const double f = a[k * n + i] / a[i * n + i];
				for ( size_t j = i; j < n; ++j )
					a[k * n + j] -= f * a[i * n + j];
				b[k] -= f * b[i];
			}
		for ( size_t i = n; i-- > 0; )
		{
			for ( size_t j = i + 1; j < n; ++j )
				b[i] -= a[i * n + j] * b[j];
			b[i] /= a[i * n + i];
		}
	}

	const lw_robot* m_robot;
	const Reach& m_task;
	std::vector<uint32_t> m_variables;
	std::vector<double> m_reference, m_lower, m_upper, m_stiffness;
	std::vector<lw_transform> m_poses;
};

int run( const std::string& file )
{
	const Robot model = makeRobot();
	const leeway::Robot robot = buildRobot( model );
	const leeway::Scene scene = buildScene( makeRoom() );
	std::string rows;
	int missing = 0;
	for ( const Reach& task : reachTasks() )
	{
		Search search( robot.get(), scene.get(), model, task );
		std::string where;
		const double at_start = search.clearance( search.start, &where );
		double at_goal = 0, nearest = 0;
		const std::vector<double> goal = search.find( &at_goal, &nearest );
		fmt::print( "{}: start {:.1f} mm ({}), ", task.name, 1e3 * at_start, where );
		if ( goal.empty() || at_start < wanted_clearance )
		{
			fmt::print( "{}, hand within {:.0f} mm\n", goal.empty() ? "no goal found" : "start too close", 1e3 * nearest );
			++missing;
			continue;
		}
		search.clearance( goal, &where );
		fmt::print(
		    "goal {:.1f} mm ({}), straight line {:.1f} mm\n", 1e3 * at_goal, where, 1e3 * search.straightLine( goal ) );
		std::fflush( stdout );
		std::string values;
		for ( double value : goal )
			values += ( values.empty() ? "" : ", " ) + fmt::format( "{:.4f}", value );
		rows += fmt::format( "\t\t{{ \"{}\", {{ {} }} }},\n", task.name, values );
	}
	std::FILE* out = std::fopen( file.c_str(), "w" );
	if ( !out )
		throw std::runtime_error( file + ": cannot be written" );
	fmt::print( out,
	    "// SPDX-License-Identifier: BSD-3-Clause\n"
	    "// Written by kitchen_reaches: goals of the reach tasks, in the order of the group's joints.\n"
	    "#include \"model.hpp\"\n\nnamespace kitchen\n{{\n\n"
	    "std::vector<double> storedGoal( const std::string& reach )\n{{\n"
	    "\tstatic const std::map<std::string, std::vector<double>> goals = {{\n{}\t}};\n"
	    "\tconst auto it = goals.find( reach );\n\treturn it == goals.end() ? std::vector<double>() : it->second;\n}}\n\n}} "
	    "// namespace kitchen\n",
	    rows );
	std::fclose( out );
	return missing ? 1 : 0;
}

} // namespace

int main( int argc, char** argv )
{
	if ( argc != 2 )
	{
		fmt::print( stderr, "usage: kitchen_reaches reach_goals.cpp\n" );
		return 2;
	}
	try
	{
		return run( argv[1] );
	}
	catch ( const std::exception& error )
	{
		fmt::print( stderr, "kitchen_reaches: {}\n", error.what() );
		return 2;
	}
}
