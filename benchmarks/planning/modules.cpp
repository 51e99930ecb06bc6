// SPDX-License-Identifier: BSD-3-Clause
// Ways to plan by modules of other libraries: see planner_module.hpp.
#include "planning/ways.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <dlfcn.h>
#include <filesystem>
#include <set>
#include <stdexcept>

namespace fs = std::filesystem;

namespace
{

/// Parts of an edge in which no variable that wraps turns by this much, so that the shorter way is the module's way.
constexpr double MOST_TURN = 3;

PlannerProblem problemOf( const EdgeWorldEntry& entry, const std::string& set )
{
	const EdgeWorld& world = entry.world;
	PlannerProblem problem;
	problem.robot = world.name.substr( 0, world.name.find( ' ' ) );
	problem.set = set;
	problem.start = entry.start;
	problem.goal = entry.goal;
	for ( std::size_t i = 0; i < world.size(); ++i )
	{
		problem.joints.push_back( lw_robot_joint_name( world.robot.get(), world.info( i ).joint ) );
	}
	const std::uint32_t count = world.scene ? lw_scene_shape_count( world.scene.get() ) : 0;
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		const lw_scene_shape_def placed = lw_scene_shape( world.scene.get(), i );
		const lw_shape_info info = lw_shape_get_info( placed.shape );
		PlannerObstacle obstacle = {
		    lw_scene_object_name( world.scene.get(), placed.object ), info.type, {}, placed.world_from_shape };
		std::copy_n( info.dimensions, 3, obstacle.dimensions );
		problem.obstacles.push_back( obstacle );
	}
	return problem;
}

class ModuleWay : public Way
{
public:
	ModuleWay( const WayKind& kind, const EdgeWorldEntry& entry, const std::string& set )
	    : m_module( kind.module ), m_world( entry.world ), m_problem( problemOf( entry, set ) )
	{
		m_refusal = m_module->take( m_problem );
	}

	bool usable() const override { return m_refusal.empty(); }

	Planned run( double, std::uint64_t ) override
	{
		const PlannerAnswer answer = m_module->plan();
		Planned out;
		out.solved = answer.solved;
		out.plan_us = answer.plan_us;
		out.simplify_us = answer.simplify_us;
		out.first = statesOf( answer.first );
		out.path = statesOf( answer.path );
		return out;
	}

private:
	States statesOf( const std::vector<double>& values ) const
	{
		const std::size_t n = m_world.size();
		States out;
		for ( std::size_t at = 0; at + n <= values.size(); at += n )
		{
			const std::vector<double> state(
			    values.begin() + static_cast<std::ptrdiff_t>( at ), values.begin() + static_cast<std::ptrdiff_t>( at + n ) );
			if ( !out.empty() )
			{
				addBetween( out, state );
			}
			out.push_back( state );
		}
		return out;
	}

	void addBetween( States& out, const std::vector<double>& to ) const
	{
		const std::vector<double> from = out.back();
		double most = 0;
		for ( std::size_t i = 0; i < to.size(); ++i )
		{
			most = m_world.info( i ).wraps ? std::max( most, std::abs( to[i] - from[i] ) ) : most;
		}
		const int parts = static_cast<int>( std::ceil( most / MOST_TURN ) );
		for ( int part = 1; part < parts; ++part )
		{
			std::vector<double> state = from;
			for ( std::size_t i = 0; i < to.size(); ++i )
			{
				state[i] += ( to[i] - from[i] ) * part / parts;
			}
			out.push_back( state );
		}
	}

	std::shared_ptr<PlannerModule> m_module;
	const EdgeWorld& m_world;
	PlannerProblem m_problem;
	std::string m_refusal;
};

#ifdef __SANITIZE_ADDRESS__ // which refuses RTLD_DEEPBIND
constexpr int MODULE_FLAGS = RTLD_NOW | RTLD_LOCAL;
#else
constexpr int MODULE_FLAGS = RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND;
#endif

WayKind loadModule( const std::string& file )
{
	// Its own versions of libraries that this program has too stay its own. It stays loaded: its planner lives as long as we do.
	void* module = dlopen( file.c_str(), MODULE_FLAGS );
	void* symbol = module != nullptr ? dlsym( module, "leeway_planner_module" ) : nullptr;
	if ( symbol == nullptr )
	{
		const char* problem = dlerror();
		throw std::runtime_error( file + ": " + ( problem != nullptr ? problem : "exports no leeway_planner_module" ) +
		                          "; name a file, or a planner whose module is beside leeway-bench" );
	}
	WayKind kind;
	kind.module = std::shared_ptr<PlannerModule>( reinterpret_cast<PlannerModule* (*)()>( symbol )() );
	kind.motions = Motions::FOREIGN;
	kind.name = kind.module->name();
	kind.planner = kind.name;
	return kind;
}

} // namespace

std::unique_ptr<Way> makeModuleWay( const WayKind& kind, const EdgeWorldEntry& entry, const std::string& set )
{
	return std::make_unique<ModuleWay>( kind, entry, set );
}

std::vector<WayKind> moduleWays( const std::vector<std::string>& files )
{
	std::vector<WayKind> ways;
	std::set<fs::path> beside;
	for ( const auto& entry : fs::directory_iterator( fs::read_symlink( "/proc/self/exe" ).parent_path() ) )
	{
		if ( entry.path().filename().string().rfind( "leeway_planner_", 0 ) == 0 && entry.path().extension() == ".so" )
		{
			beside.insert( entry.path() );
		}
	}
	for ( const fs::path& file : beside )
	{
		try
		{
			ways.push_back( loadModule( file ) );
		}
		catch ( const std::runtime_error& error ) // libraries that the module was built with may be gone
		{
			std::fprintf( stderr, "leeway-bench planning: without %s\n", error.what() );
		}
	}
	for ( const std::string& file : files )
	{
		const auto is_named = [&]( const WayKind& way ) { return way.name == file; };
		if ( std::none_of( ways.begin(), ways.end(), is_named ) )
		{
			ways.push_back( loadModule( file ) );
		}
	}
	return ways;
}
