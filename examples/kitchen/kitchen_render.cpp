// SPDX-License-Identifier: BSD-3-Clause
// kitchen_render: a robot, a scene and a planned path as binary glTF: animated, and as a still with ghosts of the motion.
#include "gltf.hpp"

#include "leeway/io/model.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

namespace
{

using namespace kitchen;
namespace io = leeway::io;

struct Options
{
	std::string robot, scene, colours, path, animation, still, light;
	int ghosts = 6;
};

constexpr double crease = 0.7; ///< radians: edges sharper than this are drawn sharp
constexpr double speed = 0.6;  ///< radians (or metres) per second of the fastest joint in the animation
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

/// Surfaces by mesh file and by primitive, from the table that kitchen_demo writes; a plain grey for what it does not name.
class Colours
{
public:
	Colours( const std::string& file, Gltf& gltf ) : m_gltf( gltf )
	{
		m_surfaces["plain"] = { "plain", { 0.75, 0.75, 0.77, 1 }, 0.5, 0 };
		m_surfaces["ghost"] = { "ghost", { 1.0, 0.55, 0.18, 1 }, 0.6, 0 };
		if ( file.empty() )
			return;
		try
		{
			const YAML::Node root = YAML::LoadFile( file );
			for ( const auto& entry : root["materials"] )
			{
				const auto v = entry.second.as<std::vector<double>>();
				const std::string name = entry.first.as<std::string>();
				m_surfaces[name] = { name, { v.at( 0 ), v.at( 1 ), v.at( 2 ), v.at( 3 ) }, v.at( 4 ), v.at( 5 ) };
			}
			for ( const auto& entry : root["meshes"] )
				m_meshes[entry.first.as<std::string>()] = entry.second.as<std::string>();
			for ( const auto& entry : root["primitives"] )
				m_primitives[entry.first.as<std::string>()] = entry.second.as<std::vector<std::string>>();
		}
		catch ( const std::exception& error )
		{
			throw io::Error( file, "colours", error.what(), "give the colours.yaml that kitchen_demo writes" );
		}
	}

	std::string ofMesh( const std::string& file ) const
	{
		for ( const auto& [name, surface] : m_meshes )
			if ( file.size() > name.size() &&
			     file.compare( file.size() - name.size() - 1, std::string::npos, "/" + name ) == 0 )
				return surface;
		return "plain";
	}

	std::string ofPrimitive( const std::string& owner, size_t index ) const
	{
		const auto it = m_primitives.find( owner );
		return it != m_primitives.end() && index < it->second.size() ? it->second[index] : "plain";
	}

	/// glTF material of a surface, made at first use; with an opacity below 1 its ghost.
	int material( const std::string& name, double opacity = 1 )
	{
		const std::string key = opacity < 1 ? name + " ghost" : name;
		const auto it = m_materials.find( key );
		if ( it != m_materials.end() )
			return it->second;
		const auto known = m_surfaces.find( name );
		Surface surface = known == m_surfaces.end() ? m_surfaces.at( "plain" ) : known->second;
		surface.name = key;
		surface.colour[3] *= opacity;
		return m_materials[key] = m_gltf.addMaterial( surface );
	}

	int trail() { return m_gltf.addMaterial( { "trail", { 0.98, 0.36, 0.06, 1 }, 0.4, 0 } ); }

private:
	Gltf& m_gltf;
	std::map<std::string, Surface> m_surfaces;
	std::map<std::string, std::string> m_meshes;
	std::map<std::string, std::vector<std::string>> m_primitives;
	std::map<std::string, int> m_materials;
};

/// Primitives are solids without triangles: here they get some.
void tessellate( const lw_shape_info& info, std::vector<double>& vertices, std::vector<uint32_t>& triangles )
{
	const double* d = info.dimensions;
	auto ring = [&]( double radius, double z, int n )
	{
		for ( int i = 0; i < n; ++i )
			vertices.insert(
			    vertices.end(), { radius * std::cos( 2 * M_PI * i / n ), radius * std::sin( 2 * M_PI * i / n ), z } );
	};
	const uint32_t n = 48;
	std::vector<std::pair<double, double>> profile; // radius, z
	if ( info.type == LW_SHAPE_BOX )
	{
		for ( int i = 0; i < 8; ++i )
			vertices.insert( vertices.end(),
			    { ( i & 1 ? 0.5 : -0.5 ) * d[0], ( i & 2 ? 0.5 : -0.5 ) * d[1], ( i & 4 ? 0.5 : -0.5 ) * d[2] } );
		triangles = {
		    0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5 };
		return;
	}
	if ( info.type == LW_SHAPE_CYLINDER )
		profile = { { 0, -0.5 * d[1] }, { d[0], -0.5 * d[1] }, { d[0], 0.5 * d[1] }, { 0, 0.5 * d[1] } };
	else if ( info.type == LW_SHAPE_CONE )
		profile = { { 0, -0.5 * d[1] }, { d[0], -0.5 * d[1] }, { 0, 0.5 * d[1] } };
	else // sphere and capsule: two domes
		for ( int i = 0; i <= 24; ++i )
		{
			const double a = M_PI * ( i / 24.0 - 0.5 ), h = info.type == LW_SHAPE_CAPSULE ? 0.5 * d[1] : 0;
			if ( i == 12 && h > 0 )
				profile.emplace_back( d[0], -h );
			profile.emplace_back( d[0] * std::cos( a ), d[0] * std::sin( a ) + ( i < 12 ? -h : h ) );
		}
	for ( const auto& [radius, z] : profile )
		ring( radius, z, static_cast<int>( n ) );
	for ( uint32_t k = 0; k + 1 < profile.size(); ++k )
		for ( uint32_t i = 0; i < n; ++i )
		{
			const uint32_t a = k * n + i, b = k * n + ( i + 1 ) % n;
			triangles.insert( triangles.end(), { a, b, b + n, a, b + n, a + n } );
		}
}

/// glTF meshes of shapes: vertex data once per shape, one mesh per shape and material.
class Meshes
{
public:
	explicit Meshes( Gltf& gltf ) : m_gltf( gltf ) {}

	int of( const lw_shape* shape, int material, bool translucent = false )
	{
		auto geometry = m_geometry.find( shape );
		if ( geometry == m_geometry.end() )
		{
			const lw_shape_info info = lw_shape_get_info( shape );
			std::vector<double> vertices;
			std::vector<uint32_t> triangles;
			ShadedMesh mesh;
			if ( info.type == LW_SHAPE_MESH )
				mesh = shade( lw_shape_vertices( shape ), info.vertex_count, lw_shape_triangles( shape ),
				    info.triangle_count, crease );
			else
			{
				tessellate( info, vertices, triangles );
				mesh = shade( vertices.data(), vertices.size() / 3, triangles.data(), triangles.size() / 3, crease );
			}
			geometry = m_geometry.emplace( shape, m_gltf.addGeometry( mesh ) ).first;
		}
		const auto key = std::make_pair( shape, material );
		const auto mesh = m_meshes.find( key );
		return mesh != m_meshes.end() ? mesh->second
		                              : m_meshes[key] = translucent ? m_gltf.addTranslucentMesh( geometry->second, material )
		                                                            : m_gltf.addMesh( geometry->second, material );
	}

private:
	Gltf& m_gltf;
	std::map<const lw_shape*, int> m_geometry;
	std::map<std::pair<const lw_shape*, int>, int> m_meshes;
};

Gltf::Vec translation( const lw_transform& t )
{
	return { t.t[0], t.t[1], t.t[2] };
}

Gltf::Quat rotation( const lw_transform& t )
{
	Gltf::Quat q;
	lw_transform_to_quaternion( &t, q.data() );
	return q;
}

double distance( const lw_transform& a, const lw_transform& b )
{
	return std::hypot( b.t[0] - a.t[0], b.t[1] - a.t[1], b.t[2] - a.t[2] );
}

/// One owner's shapes with the surface of each.
struct Painted
{
	const io::PlacedShape* shape;
	std::string surface;
};

/// @param report in the order of the shapes of each owner
std::map<std::string, std::vector<std::string>> surfaces( const io::LoadReport& report, const Colours& colours )
{
	std::map<std::string, std::vector<std::string>> result;
	std::map<std::string, size_t> primitives;
	for ( const io::LoadedShape& shape : report.shapes )
		result[shape.owner].push_back( shape.file.empty() ? colours.ofPrimitive( shape.owner, primitives[shape.owner]++ )
		                                                  : colours.ofMesh( shape.file ) );
	return result;
}

/// A world to draw: everything that both pictures share.
class Stage
{
public:
	Stage( const io::RobotModel& robot_model, const io::SceneModel& scene_model, const io::Problem& problem,
	    const std::string& colour_file )
	    : robot( problem.robot.get() ), colours( colour_file, gltf ), meshes( gltf )
	{
		const auto robot_surfaces = surfaces( robot_model.report, colours );
		for ( const io::LinkModel& link : robot_model.links )
		{
			std::vector<Painted>& painted = links[lw_robot_find_link( robot, link.name.c_str() )];
			for ( size_t i = 0; i < link.collision.size(); ++i )
				painted.push_back( { &link.collision[i], robot_surfaces.at( link.name ).at( i ) } );
		}
		const auto scene_surfaces = surfaces( scene_model.report, colours );
		const int root = gltf.addNode( "scene", -1, { 0, 0, 0 }, { 0, 0, 0, 1 } );
		for ( const io::SceneObject& object : scene_model.objects )
			for ( size_t i = 0; i < object.shapes.size(); ++i )
				add( object.name, root, { &object.shapes[i], scene_surfaces.at( object.name ).at( i ) }, 1 );
	}

	void add( const std::string& name, int parent, const Painted& painted, double opacity )
	{
		const int mesh = meshes.of( painted.shape->shape.get(), colours.material( painted.surface, opacity ), opacity < 1 );
		gltf.addNode( name, parent, translation( painted.shape->pose ), rotation( painted.shape->pose ), mesh );
	}

	void addRobot( const std::vector<lw_transform>& poses )
	{
		for ( const auto& [link, painted] : links )
		{
			const int node =
			    gltf.addNode( lw_robot_link_name( robot, link ), -1, translation( poses[link] ), rotation( poses[link] ) );
			for ( const Painted& shape : painted )
				add( "shape", node, shape, 1 );
		}
	}

	/// The links that are well away from where they end.
	void addGhost( const std::vector<lw_transform>& poses, const std::vector<lw_transform>& end )
	{
		for ( const auto& [link, painted] : links )
			if ( distance( poses[link], end[link] ) > ghost_distance )
			{
				const int node = gltf.addNode( "ghost", -1, translation( poses[link] ), rotation( poses[link] ) );
				for ( Painted shape : painted )
				{
					shape.surface = "ghost";
					add( "shape", node, shape, ghost_opacity );
				}
			}
	}

	const lw_robot* robot;
	Gltf gltf;
	Colours colours;
	Meshes meshes;
	std::map<uint32_t, std::vector<Painted>> links;
};

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
	const int mesh = stage.meshes.of( bead.get(), stage.colours.trail() );
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

void writeFile( const std::string& file, const std::string& bytes )
{
	std::ofstream out( file, std::ios::binary );
	out.write( bytes.data(), static_cast<std::streamsize>( bytes.size() ) );
	out.close();
	if ( !out )
		throw io::Error( file, "file", "cannot be written", "check the folder and its free space" );
}

/// A softly lit room as a light source: Radiance RGBE, latitude by longitude, bright above and from the window side.
std::string lightImage()
{
	const int width = 256, height = 128;
	std::string bytes = fmt::format( "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", height, width );
	auto put = [&bytes]( double r, double g, double b )
	{
		int exponent = 0;
		const double scale = std::frexp( std::max( { r, g, b, 1e-9 } ), &exponent ) * 256 / std::max( { r, g, b, 1e-9 } );
		for ( double v : { r, g, b } )
			bytes += static_cast<char>( static_cast<unsigned char>( v * scale ) );
		bytes += static_cast<char>( static_cast<unsigned char>( exponent + 128 ) );
	};
	for ( int y = 0; y < height; ++y )
		for ( int x = 0; x < width; ++x )
		{
			const double up = std::cos( M_PI * ( y + 0.5 ) / height ), around = 2 * M_PI * ( x + 0.5 ) / width;
			auto lamp = [&]( double at_up, double at_around, double size, double power )
			{
				const double across =
				    std::remainder( around - at_around, 2 * M_PI ) * std::sqrt( std::max( 0.05, 1 - up * up ) );
				return power * std::exp( -( across * across + ( up - at_up ) * ( up - at_up ) ) / ( size * size ) );
			};
			const double sky = 0.36 + 0.40 * std::max( 0.0, up ), ground = up < 0 ? 0.26 * up : 0;
			const double key = lamp( 0.65, 0.9, 0.45, 4.2 ), fill = lamp( 0.35, 3.6, 0.7, 0.9 );
			put( sky + ground * 0.8 + key * 1.00 + fill * 0.85, sky + ground * 0.9 + key * 0.95 + fill * 0.93,
			    sky + ground + key * 0.86 + fill * 1.05 );
		}
	return bytes;
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
		Stage stage( robot, scene, problem, options.colours );
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
		Stage stage( robot, scene, problem, options.colours );
		stage.addRobot( motion.poses.back() );
		for ( size_t frame : ghostFrames( motion, moving, options.ghosts ) )
			stage.addGhost( motion.poses[frame], motion.poses.back() );
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
