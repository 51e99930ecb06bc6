// SPDX-License-Identifier: BSD-3-Clause
// kitchen_render: a robot, a scene and a planned path as binary glTF: animated, and as a still with ghosts of the motion.
#include "stage.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace
{

using namespace kitchen;

struct Options
{
	std::string robot, scene, colours, path, animation, still, light;
	int ghosts = 6;
};

constexpr double speed = 0.6; ///< radians (or metres) per second of the fastest joint in the animation
constexpr double ghost_opacity = 0.30;
constexpr double ghost_distance = 0.06; ///< metres: a link nearer to its goal than this has no ghost
constexpr double trail_radius = 0.006;  ///< metres

struct Path
{
	std::vector<std::pair<std::string, double>> start;
	std::vector<std::string> joints;
	std::vector<std::vector<double>> points;
};

Path readPath( const std::string& file )
{
	Path path;
	try
	{
		const YAML::Node root = YAML::LoadFile( file );
		path.joints = root["joint_names"].as<std::vector<std::string>>();
		for ( const YAML::Node& point : root["points"] )
			path.points.push_back( point["positions"].as<std::vector<double>>() );
		const YAML::Node state = root["start_state"]["joint_state"];
		const auto names = state["name"].as<std::vector<std::string>>();
		const auto values = state["position"].as<std::vector<double>>();
		for ( size_t i = 0; i < names.size() && i < values.size(); ++i )
			path.start.emplace_back( names[i], values[i] );
	}
	catch ( const YAML::Exception& error )
	{
		throw io::Error( file, "path", error.what(), "give a path as `leeway plan --out` writes it" );
	}
	for ( const auto& point : path.points )
		if ( point.size() != path.joints.size() )
			throw io::Error(
			    file, "points", "has a point of the wrong length", "give one position for every name in joint_names" );
	if ( path.points.empty() )
		throw io::Error( file, "points", "is empty", "plan first" );
	return path;
}

double distance( const lw_transform& a, const lw_transform& b )
{
	return std::hypot( b.t[0] - a.t[0], b.t[1] - a.t[1], b.t[2] - a.t[2] );
}

/// The links that are well away from where they end.
void addGhost( Stage& stage, const std::vector<lw_transform>& poses, const std::vector<lw_transform>& end )
{
	for ( const auto& [link, painted] : stage.links )
		if ( distance( poses[link], end[link] ) > ghost_distance )
		{
			const int node = stage.gltf.addNode( "ghost", -1, translation( poses[link] ), rotation( poses[link] ) );
			for ( Painted shape : painted )
			{
				shape.surface = "ghost";
				stage.add( "shape", node, shape, ghost_opacity );
			}
		}
}

/// States along the path at equal times, none of whose joints moves faster than `speed`.
struct Motion
{
	std::vector<double> times;
	std::vector<std::vector<lw_transform>> poses; ///< [time][link]
};

Motion sample( const io::Problem& problem, const Path& path )
{
	const lw_robot* robot = problem.robot.get();
	std::vector<std::vector<double>> states;
	for ( const std::vector<double>& point : path.points )
	{
		std::vector<double> state = problem.reference;
		for ( size_t i = 0; i < path.joints.size(); ++i )
			for ( uint32_t v = 0; v < state.size(); ++v )
				if ( io::variableName( robot, v ) == path.joints[i] )
					state[v] = point[i];
		states.push_back( state );
	}
	std::vector<double> arrival = { 0 };
	for ( size_t k = 0; k + 1 < states.size(); ++k )
	{
		double farthest = 0.01;
		for ( size_t v = 0; v < states[k].size(); ++v )
			farthest = std::max( farthest, std::fabs( states[k + 1][v] - states[k][v] ) );
		arrival.push_back( arrival.back() + farthest / speed );
	}
	Motion motion;
	const int frames = std::max( 2, static_cast<int>( std::ceil( arrival.back() * 30 ) ) );
	for ( int i = 0; i <= frames; ++i )
	{
		// slow at both ends
		const double s = static_cast<double>( i ) / frames, t = arrival.back() * ( 0.35 * s + 0.65 * s * s * ( 3 - 2 * s ) );
		size_t k = 0;
		while ( k + 2 < states.size() && t > arrival[k + 1] )
			++k;
		std::vector<double> state( states.front().size() );
		if ( states.size() == 1 )
			state = states.front();
		else
			lw_robot_interpolate( robot, states[k].data(), states[k + 1].data(),
			    std::clamp( ( t - arrival[k] ) / ( arrival[k + 1] - arrival[k] ), 0.0, 1.0 ), state.data() );
		motion.poses.emplace_back( lw_robot_link_count( robot ) );
		leeway::require( lw_robot_fk( robot, state.data(), motion.poses.back().data() ), "forward kinematics" );
		motion.times.push_back( i / 30.0 );
	}
	return motion;
}

/// Links that the motion moves.
std::set<uint32_t> movingLinks( const Motion& motion )
{
	std::set<uint32_t> moving;
	for ( const std::vector<lw_transform>& poses : motion.poses )
		for ( uint32_t link = 0; link < poses.size(); ++link )
			for ( int i = 0; i < 3; ++i )
			{
				bool moved = std::fabs( poses[link].t[i] - motion.poses.front()[link].t[i] ) > 1e-6;
				for ( int j = 0; j < 3; ++j )
					moved = moved || std::fabs( poses[link].r[i][j] - motion.poses.front()[link].r[i][j] ) > 1e-6;
				if ( moved )
					moving.insert( link );
			}
	return moving;
}

/// Beads along the ways of the tool centre points (links whose name ends in tcp).
void addTrails( Stage& stage, const Motion& motion, const std::set<uint32_t>& moving )
{
	lw_shape* made = nullptr;
	const double dimensions[3] = { trail_radius, 0, 0 };
	leeway::require( lw_shape_create_primitive( LW_SHAPE_SPHERE, dimensions, nullptr, nullptr, &made ), "sphere" );
	const leeway::Shape bead = leeway::Shape::adopt( made );
	const int mesh = stage.meshes.of( bead.get(), stage.colours.material( "trail" ) );
	for ( uint32_t link : moving )
	{
		const std::string name = lw_robot_link_name( stage.robot, link );
		if ( name.size() < 3 || name.compare( name.size() - 3, 3, "tcp" ) != 0 )
			continue;
		Gltf::Vec last = translation( motion.poses.front()[link] );
		for ( const std::vector<lw_transform>& poses : motion.poses )
		{
			const Gltf::Vec to = translation( poses[link] );
			const double way = std::hypot( to[0] - last[0], to[1] - last[1], to[2] - last[2] );
			const int steps = static_cast<int>( way / ( 0.8 * trail_radius ) );
			for ( int i = 1; i <= steps; ++i )
			{
				const double s = static_cast<double>( i ) / steps;
				stage.gltf.addNode( "trail", -1,
				    { last[0] + s * ( to[0] - last[0] ), last[1] + s * ( to[1] - last[1] ),
				        last[2] + s * ( to[2] - last[2] ) },
				    { 0, 0, 0, 1 }, mesh );
			}
			if ( steps > 0 )
				last = to;
		}
	}
}

/// Frames equally spaced by the way of the fastest moving tool or link, not by time.
std::vector<size_t> ghostFrames( const Motion& motion, const std::set<uint32_t>& moving, int ghosts )
{
	std::vector<double> way = { 0 };
	for ( size_t k = 1; k < motion.poses.size(); ++k )
	{
		double farthest = 0;
		for ( uint32_t link : moving )
		{
			farthest = std::max( farthest, distance( motion.poses[k - 1][link], motion.poses[k][link] ) );
		}
		way.push_back( way.back() + farthest );
	}
	std::vector<size_t> frames;
	for ( int i = 0; i < ghosts; ++i )
		frames.push_back(
		    static_cast<size_t>( std::lower_bound( way.begin(), way.end(), way.back() * i / ghosts ) - way.begin() ) );
	return frames;
}

void run( const Options& options )
{
	if ( !options.light.empty() )
		writeFile( options.light, lightImage() );
	if ( options.animation.empty() && options.still.empty() )
		return;
	const io::RobotModel robot = io::loadRobot( options.robot, "" );
	const io::SceneModel scene = io::loadScene( options.scene );
	const Path path = readPath( options.path );
	io::ProblemOptions problem_options;
	for ( const auto& [joint, value] : path.start )
		problem_options.overrides.values[joint] = value;
	const io::Problem problem = io::buildProblem( robot, problem_options );
	const Motion motion = sample( problem, path );
	const std::set<uint32_t> moving = movingLinks( motion );

	if ( !options.animation.empty() )
	{
		Stage stage( robot, problem.robot.get(), options.colours );
		stage.addScene( scene );
		for ( const auto& [link, painted] : stage.links )
		{
			std::vector<Gltf::Vec> moves;
			std::vector<Gltf::Quat> turns;
			for ( const std::vector<lw_transform>& poses : motion.poses )
			{
				moves.push_back( translation( poses[link] ) );
				turns.push_back( rotation( poses[link] ) );
			}
			if ( painted.empty() )
				continue;
			const int node = stage.gltf.addNode( lw_robot_link_name( stage.robot, link ), -1, moves.front(), turns.front() );
			for ( const Painted& shape : painted )
				stage.add( "shape", node, shape, 1 );
			if ( moving.count( link ) )
				stage.gltf.animate( node, motion.times, moves, turns );
		}
		writeFile( options.animation, stage.gltf.bytes() );
	}
	if ( !options.still.empty() )
	{
		Stage stage( robot, problem.robot.get(), options.colours );
		stage.addScene( scene );
		stage.colours.define( { "ghost", { 1.0, 0.55, 0.18, 1 }, 0.6, 0 } );
		stage.colours.define( { "trail", { 0.98, 0.36, 0.06, 1 }, 0.4, 0 } );
		stage.addRobot( motion.poses.back() );
		for ( size_t frame : ghostFrames( motion, moving, options.ghosts ) )
			addGhost( stage, motion.poses[frame], motion.poses.back() );
		addTrails( stage, motion, moving );
		writeFile( options.still, stage.gltf.bytes() );
	}
	fmt::print( "{}: {:.1f} s of motion, {} links move\n", options.path, motion.times.back(), moving.size() );
}

const char* usage =
    "usage: kitchen_render --robot R.urdf --scene S.yaml --path P.yaml [--colours C.yaml]\n"
    "                      [--animation OUT.glb] [--still OUT.glb] [--ghosts N] [--light OUT.hdr]\n"
    "Writes the motion as animated glTF, the goal with ghosts of the motion as still glTF, and a light for viewers.\n";

} // namespace

int main( int argc, char** argv )
{
	Options options;
	const std::map<std::string, std::string Options::*> texts = { { "--robot", &Options::robot },
	    { "--scene", &Options::scene }, { "--path", &Options::path }, { "--colours", &Options::colours },
	    { "--animation", &Options::animation }, { "--still", &Options::still }, { "--light", &Options::light } };
	for ( int i = 1; i < argc; ++i )
	{
		const std::string key = argv[i];
		if ( key == "--help" || key == "-h" )
		{
			fmt::print( "{}", usage );
			return 0;
		}
		const auto text = texts.find( key );
		const bool known = ( text != texts.end() || key == "--ghosts" ) && i + 1 < argc;
		if ( !known )
		{
			fmt::print( stderr, "kitchen_render: {}: unknown, or its value is missing\n{}", key, usage );
			return 2;
		}
		const std::string value = argv[++i];
		if ( text != texts.end() )
			options.*( text->second ) = value;
		else
			options.ghosts = std::clamp( std::atoi( value.c_str() ), 0, 100 );
	}
	const bool draws = !options.animation.empty() || !options.still.empty();
	if ( ( !draws && options.light.empty() ) ||
	     ( draws && ( options.robot.empty() || options.scene.empty() || options.path.empty() ) ) )
	{
		fmt::print( stderr, "{}", usage );
		return 2;
	}
	try
	{
		run( options );
	}
	catch ( const std::exception& error )
	{
		fmt::print( stderr, "kitchen_render: {}\n", error.what() );
		return 2;
	}
	return 0;
}
