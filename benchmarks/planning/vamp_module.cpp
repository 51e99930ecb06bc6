// SPDX-License-Identifier: BSD-3-Clause
// VAMP's RRT-Connect and its simplification as a module of leeway-bench planning, compiled against VAMP's headers (vamp.cmake).
//
// Settings, scenes and random numbers are those of VAMP's Python package: configure_robot_and_planner_with_kwargs() and
// problem_dict_to_vamp() in src/vamp/__init__.py, the numbers of src/vamp/constants.py, its Halton sequence. How finely a motion
// is sampled stands in the header of each robot.
#include "planning/planner_module.hpp"

#include <array> // VAMP's headers want some before them
#include <vector>

#include <vamp/collision/factory.hh>
#include <vamp/planning/rrtc.hh>
#include <vamp/planning/simplify.hh>
#include <vamp/planning/validate.hh>
#include <vamp/random/halton.hh>
#include <vamp/robots/baxter.hh>
#include <vamp/robots/fetch.hh>
#include <vamp/robots/panda.hh>
#include <vamp/robots/ur5.hh>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <map>
#include <memory>
#include <stdexcept>

namespace
{

namespace shapes = vamp::collision::factory;

constexpr std::size_t RAKE = vamp::FloatVectorWidth;
using Environment = vamp::collision::Environment<float>;
using VectorEnvironment = vamp::collision::Environment<vamp::FloatVector<RAKE>>;

/// constants.py: DEFAULT_ITERATIONS
constexpr std::size_t MOST_SAMPLES = 1000000;

double threadMicroseconds()
{
	timespec now;
	clock_gettime( CLOCK_THREAD_CPUTIME_ID, &now );
	return 1e6 * static_cast<double>( now.tv_sec ) + 1e-3 * static_cast<double>( now.tv_nsec );
}

/// VAMP's own time leaves the allocation of its memory out, but is by the clock on the wall: the smaller one.
double microseconds( std::size_t own_nanoseconds, double start )
{
	return std::min( 1e-3 * static_cast<double>( own_nanoseconds ), threadMicroseconds() - start );
}

[[noreturn]] void refuse( const PlannerProblem& problem, const std::string& reason )
{
	throw std::runtime_error(
	    "VAMP: " + problem.robot + ", " + problem.set + ": " + reason + "; --row leeway leaves VAMP out" );
}

/// Rotations about the fixed axes x, y, z, in this order, as VAMP's problems have them.
std::array<float, 3> anglesOf( const lw_transform& pose )
{
	const auto& r = pose.r;
	const double flat = std::hypot( r[0][0], r[1][0] );
	const bool upright = flat <= 1e-12; // x points up or down: only one angle about z and x is left
	const double x = upright ? std::atan2( -r[1][2], r[1][1] ) : std::atan2( r[2][1], r[2][2] );
	const double z = upright ? 0 : std::atan2( r[1][0], r[0][0] );
	return { static_cast<float>( x ), static_cast<float>( std::atan2( -r[2][0], flat ) ), static_cast<float>( z ) };
}

void addCuboid(
    Environment& out, const std::array<float, 3>& at, const std::array<float, 3>& angles, const std::array<float, 3>& half )
{
	const auto cuboid = shapes::cuboid::array( at, angles, half );
	( cuboid.axis_3_z == 1 ? out.z_aligned_cuboids : out.cuboids ).emplace_back( cuboid );
}

/// A capsule, which is longer than the cylinder by its caps; a cuboid in the sets "box", whose cylinder is grasped from above.
void addCylinder( Environment& out, const std::array<float, 3>& at, const std::array<float, 3>& angles, float radius,
    float length, bool as_cuboid )
{
	if ( as_cuboid )
	{
		addCuboid( out, at, angles, { radius, radius, length / 2 } );
		return;
	}
	const auto capsule = shapes::cylinder::center::array( at, angles, radius, length );
	( capsule.xv == 0 && capsule.yv == 0 ? out.z_aligned_capsules : out.capsules ).emplace_back( capsule );
}

/// @return false if VAMP's scenes have no such shape
bool addObstacle( Environment& out, const PlannerObstacle& obstacle, bool cylinders_as_cuboids )
{
	const double* t = obstacle.pose.t;
	const std::array<float, 3> at = { static_cast<float>( t[0] ), static_cast<float>( t[1] ), static_cast<float>( t[2] ) };
	const std::array<float, 3> angles = anglesOf( obstacle.pose );
	const auto dimension = [&]( int i ) { return static_cast<float>( obstacle.dimensions[i] ); };
	switch ( obstacle.type )
	{
	case LW_SHAPE_BOX:
		addCuboid( out, at, angles, { dimension( 0 ) / 2, dimension( 1 ) / 2, dimension( 2 ) / 2 } );
		return true;
	case LW_SHAPE_SPHERE:
		out.spheres.emplace_back( shapes::sphere::array( at, dimension( 0 ) ) );
		return true;
	case LW_SHAPE_CYLINDER:
		addCylinder( out, at, angles, dimension( 0 ), dimension( 1 ), cylinders_as_cuboids );
		return true;
	default:
		return false;
	}
}

Environment environmentOf( const PlannerProblem& problem )
{
	Environment out;
	for ( const PlannerObstacle& obstacle : problem.obstacles )
	{
		if ( !addObstacle( out, obstacle, problem.set.rfind( "box_", 0 ) == 0 ) )
		{
			refuse(
			    problem, "object '" + obstacle.name + "' is no box, sphere or cylinder, and VAMP's scenes have no others" );
		}
	}
	out.sort();
	return out;
}

/// Places of the model's joints in a state of the problem.
template <typename Names> std::vector<std::size_t> orderOf( const PlannerProblem& problem, const Names& model )
{
	std::vector<std::size_t> order;
	for ( const auto& name : model )
	{
		const auto found = std::find( problem.joints.begin(), problem.joints.end(), name );
		if ( found == problem.joints.end() )
		{
			refuse( problem, "joint '" + std::string( name ) + "' of VAMP's model is not in the problem's group" );
		}
		order.push_back( static_cast<std::size_t>( found - problem.joints.begin() ) );
	}
	for ( const std::string& joint : problem.joints )
	{
		if ( std::find( model.begin(), model.end(), joint ) == model.end() )
		{
			refuse( problem, "joint '" + joint + "' is not in VAMP's model" );
		}
	}
	return order;
}

class RobotPlanner
{
public:
	virtual ~RobotPlanner() = default;
	virtual std::string take( const PlannerProblem& problem ) = 0;
	virtual PlannerAnswer plan() = 0;
};

template <typename Robot> class PlannerOf : public RobotPlanner
{
public:
	explicit PlannerOf( float range )
	{
		m_settings.range = range;
		m_settings.max_iterations = m_settings.max_samples = MOST_SAMPLES;
	}

	std::string take( const PlannerProblem& problem ) override
	{
		m_order = orderOf( problem, Robot::joint_names );
		m_environment = std::make_unique<VectorEnvironment>( environmentOf( problem ) );
		m_random = std::make_shared<vamp::rng::Halton<Robot>>();
		m_start = configurationOf( problem.start );
		m_goal = configurationOf( problem.goal );
		return !valid( m_start ) ? "start in collision" : !valid( m_goal ) ? "goal in collision" : "";
	}

	PlannerAnswer plan() override
	{
		PlannerAnswer out;
		const double start = threadMicroseconds();
		const auto planned = vamp::planning::RRTC<Robot, RAKE, Robot::resolution>::solve(
		    m_start, m_goal, *m_environment, m_settings, m_random );
		out.plan_us = microseconds( planned.nanoseconds, start );
		out.solved = planned.path.size() > 0;
		if ( out.solved )
		{
			const double planned_at = threadMicroseconds();
			const auto simple =
			    vamp::planning::simplify<Robot, RAKE, Robot::resolution>( planned.path, *m_environment, {}, m_random );
			out.simplify_us = microseconds( simple.nanoseconds, planned_at );
			out.first = statesOf( planned.path );
			out.path = statesOf( simple.path );
		}
		return out;
	}

private:
	using Configuration = typename Robot::Configuration;

	Configuration configurationOf( const std::vector<double>& state ) const
	{
		typename Robot::ConfigurationArray values;
		for ( std::size_t i = 0; i < Robot::dimension; ++i )
		{
			values[i] = static_cast<float>( state[m_order[i]] );
		}
		return Configuration( values );
	}

	std::vector<double> statesOf( const vamp::planning::Path<Robot>& path ) const
	{
		std::vector<double> out;
		for ( const Configuration& configuration : path )
		{
			const auto values = configuration.to_array();
			const std::size_t base = out.size();
			out.resize( base + Robot::dimension );
			for ( std::size_t i = 0; i < Robot::dimension; ++i )
			{
				out[base + m_order[i]] = static_cast<double>( values[i] );
			}
		}
		return out;
	}

	bool valid( const Configuration& configuration ) const
	{
		return vamp::planning::validate_motion<Robot, RAKE, 1>( configuration, configuration, *m_environment );
	}

	vamp::planning::RRTCSettings m_settings;
	std::vector<std::size_t> m_order;
	std::unique_ptr<VectorEnvironment> m_environment;
	std::shared_ptr<vamp::rng::Halton<Robot>> m_random;
	Configuration m_start, m_goal;
};

class VampModule : public PlannerModule
{
public:
	VampModule()
	{
		// constants.py: ROBOT_RRT_RANGES
		m_planners["panda"] = std::make_unique<PlannerOf<vamp::robots::Panda>>( 1.0f );
		m_planners["fetch"] = std::make_unique<PlannerOf<vamp::robots::Fetch>>( 1.0f );
		m_planners["ur5"] = std::make_unique<PlannerOf<vamp::robots::UR5>>( 1.5f );
		m_planners["baxter"] = std::make_unique<PlannerOf<vamp::robots::Baxter>>( 0.5f );
	}

	std::string name() const override { return "VAMP"; }

	std::string description() const override
	{
		return "VAMP " LEEWAY_VAMP_VERSION
		       ", RRTC (range 1.0 for Panda and Fetch, 1.5 for UR5, 0.5 for Baxter, dynamic domain, "
		       "balance, 10^6 samples, Halton) and its default simplification; " LEEWAY_VAMP_FLAGS;
	}

	std::string take( const PlannerProblem& problem ) override
	{
		const auto found = m_planners.find( problem.robot );
		m_current = found != m_planners.end() ? found->second.get() : nullptr;
		return m_current != nullptr ? m_current->take( problem ) : "VAMP has no robot " + problem.robot;
	}

	PlannerAnswer plan() override { return m_current->plan(); }

private:
	std::map<std::string, std::unique_ptr<RobotPlanner>> m_planners; ///< by the names of VAMP's resources
	RobotPlanner* m_current = nullptr;
};

} // namespace

extern "C" PlannerModule* leeway_planner_module()
{
	return new VampModule;
}
