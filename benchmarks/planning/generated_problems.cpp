// SPDX-License-Identifier: BSD-3-Clause
// Problems of robots that nobody prepared: see generated_problems.hpp.
#include "planning/generated_problems.hpp"

#include "edge_auditor.hpp"
#include "support/command.hpp"
#include "support/provenance.hpp"

#include <cmath>
#include <filesystem>
#include <random>
#include <algorithm>
#include <sstream>
#include <stdexcept>

namespace fs = std::filesystem;
namespace io = leeway::io;

namespace
{

constexpr double ROOM = 0.005; // metres around start and goal

/// "a1b+a2b+a3b"
std::string joined( const std::string& prefix, int first, int last, const std::string& suffix = "" )
{
	std::string out;
	for ( int i = first; i <= last; ++i )
	{
		out += ( i > first ? "+" : "" ) + prefix + std::to_string( i ) + suffix;
	}
	return out;
}

/// "left_a+left_b" of "a+b"
std::string sided( const std::string& prefix, const std::string& group )
{
	std::string out = prefix;
	for ( const char c : group )
	{
		out += c == '+' ? "+" + prefix : std::string( 1, c );
	}
	return out;
}

/// Numbers in one range of one seed.
class Random
{
public:
	explicit Random( std::uint64_t seed ) : m_engine( seed ) {}
	double in( double low, double high ) { return low + EdgeWorld::uniform( m_engine ) * ( high - low ); }
	std::mt19937_64& engine() { return m_engine; }

private:
	std::mt19937_64 m_engine;
};

/// The space of an arm: where its first joint is, and how far its links get from there.
struct Reach
{
	double centre[3] = {}, radius = 0;
};

/// Boxes and cylinders in MoveIt's form.
class SceneText
{
public:
	SceneText() { m_text << "name: generated\nworld:\n  collision_objects:\n"; }

	void box( double x, double y, double z, double yaw, double sx, double sy, double sz )
	{
		add( "box", std::to_string( sx ) + ", " + std::to_string( sy ) + ", " + std::to_string( sz ), x, y, z, yaw );
	}
	void cylinder( double x, double y, double z, double radius, double height )
	{
		add( "cylinder", std::to_string( height ) + ", " + std::to_string( radius ), x, y, z, 0 );
	}
	std::string text() const { return m_text.str(); }

private:
	void add( const char* type, const std::string& dimensions, double x, double y, double z, double yaw )
	{
		m_text << "    - id: object" << m_count++ << "\n      primitives: [{type: " << type << ", dimensions: ["
		       << dimensions << "]}]\n      primitive_poses: [{position: [" << x << ", " << y << ", " << z
		       << "], orientation: [0, 0, " << std::sin( yaw / 2 ) << ", " << std::cos( yaw / 2 ) << "]}]\n";
	}

	std::ostringstream m_text;
	int m_count = 0;
};

/// A frame on the floor in front of the arm: x away from it.
struct Front
{
	double x, y, yaw;
	void at( double forward, double sideways, double& ox, double& oy ) const
	{
		ox = x + forward * std::cos( yaw ) - sideways * std::sin( yaw );
		oy = y + forward * std::sin( yaw ) + sideways * std::cos( yaw );
	}
};

void addTable( SceneText& scene, const Reach& reach, Random& random )
{
	const double r = reach.radius, top = reach.centre[2] - random.in( 0.1, 0.3 ) * r;
	const Front front = { reach.centre[0], reach.centre[1], random.in( -M_PI, M_PI ) };
	double x = 0, y = 0;
	front.at( 0.65 * r, 0, x, y );
	scene.box( x, y, top - 0.02 * r, front.yaw, 0.7 * r, 1.4 * r, 0.04 * r );
	for ( int i = 0; i < 8; ++i )
	{
		const double height = random.in( 0.1, 0.35 ) * r, width = random.in( 0.04, 0.12 ) * r;
		front.at( random.in( 0.4, 0.9 ) * r, random.in( -0.6, 0.6 ) * r, x, y );
		if ( i % 2 == 0 )
		{
			scene.cylinder( x, y, top + height / 2 + 0.002, width / 2, height );
		}
		else
		{
			scene.box( x, y, top + height / 2 + 0.002, random.in( -M_PI, M_PI ), width, 1.5 * width, height );
		}
	}
}

void addShelf( SceneText& scene, const Reach& reach, Random& random )
{
	const double r = reach.radius, bottom = reach.centre[2] - random.in( 0.3, 0.5 ) * r, height = random.in( 0.9, 1.2 ) * r;
	const Front front = { reach.centre[0], reach.centre[1], random.in( -M_PI, M_PI ) };
	const double depth = 0.35 * r, middle = random.in( 0.6, 0.75 ) * r, wide = random.in( 0.8, 1.2 ) * r, thick = 0.03 * r;
	double x = 0, y = 0;
	for ( int board = 0; board < 4; ++board )
	{
		front.at( middle, 0, x, y );
		scene.box( x, y, bottom + height * board / 3, front.yaw, depth, wide, thick );
	}
	for ( int wall = -1; wall <= 1; ++wall )
	{
		front.at( middle, wall * wide / 2, x, y );
		scene.box( x, y, bottom + height / 2, front.yaw, depth, thick, height );
	}
	front.at( middle + depth / 2, 0, x, y );
	scene.box( x, y, bottom + height / 2, front.yaw, thick, wide, height );
}

void addCage( SceneText& scene, const Reach& reach, Random& random )
{
	const double r = reach.radius, around = random.in( 0.55, 0.7 ) * r, low = reach.centre[2] - 0.6 * r,
	             high = reach.centre[2] + 0.7 * r;
	constexpr int BARS = 10;
	const double first = random.in( 0, 2 * M_PI / BARS );
	for ( int i = 0; i < BARS; ++i )
	{
		const double angle = first + 2 * M_PI * i / BARS;
		scene.cylinder( reach.centre[0] + around * std::cos( angle ), reach.centre[1] + around * std::sin( angle ),
		    ( low + high ) / 2, 0.015 * r, high - low );
	}
	for ( int i = 0; i < 2; ++i )
	{
		const double offset = random.in( -0.3, 0.3 ) * r;
		scene.box( reach.centre[0] + ( i == 0 ? offset : 0 ), reach.centre[1] + ( i == 1 ? offset : 0 ), high, 0,
		    i == 0 ? 0.04 * r : 2 * around, i == 1 ? 0.04 * r : 2 * around, 0.04 * r );
	}
}

void addBoxes( SceneText& scene, const Reach& reach, Random& random )
{
	const double r = reach.radius;
	for ( int i = 0; i < 14; ++i )
	{
		const double angle = random.in( -M_PI, M_PI ), out = random.in( 0.35, 1 ) * r;
		scene.box( reach.centre[0] + out * std::cos( angle ), reach.centre[1] + out * std::sin( angle ),
		    reach.centre[2] + random.in( -0.6, 0.8 ) * r, random.in( -M_PI, M_PI ), random.in( 0.05, 0.25 ) * r,
		    random.in( 0.05, 0.25 ) * r, random.in( 0.05, 0.25 ) * r );
	}
}

struct Kind
{
	const char* name;
	void ( *add )( SceneText&, const Reach&, Random& );
};

constexpr Kind KINDS[] = { { "table", addTable }, { "shelf", addShelf }, { "cage", addCage }, { "boxes", addBoxes } };

/// Poses of all links at a state of the group.
std::vector<lw_transform> posesAt( const EdgeWorld& world, const std::vector<double>& q )
{
	std::vector<lw_transform> poses( lw_robot_link_count( world.robot.get() ) );
	leeway::require( lw_robot_fk( world.robot.get(), world.full( q ).data(), poses.data() ), "kinematics" );
	return poses;
}

Reach reachOf( const EdgeWorld& world, Random& random )
{
	Reach reach;
	const std::uint32_t link = lw_robot_joint_child( world.robot.get(), world.info( 0 ).joint );
	std::copy_n( posesAt( world, world.group( world.reference ) )[link].t, 3, reach.centre );
	std::vector<double> distances;
	for ( int i = 0; i < 200; ++i )
	{
		double most = 0;
		for ( const lw_transform& pose : posesAt( world, world.randomState( random.engine() ) ) )
		{
			most = std::max(
			    most, std::hypot( pose.t[0] - reach.centre[0], pose.t[1] - reach.centre[1], pose.t[2] - reach.centre[2] ) );
		}
		distances.push_back( most );
	}
	std::nth_element( distances.begin(), distances.begin() + 100, distances.end() );
	reach.radius = distances[100];
	return reach;
}

/// Those that a robot without an SRDF does not check, and links in contact in more than half of some random states.
std::vector<io::DisabledPair> pairsOf( const io::RobotModel& model, const EdgeWorld& world, Random& random )
{
	EdgeAuditor auditor( world.robot.get(), nullptr, world.variables, world.reference.data() );
	const std::uint32_t links = lw_robot_link_count( world.robot.get() );
	std::vector<std::vector<double>> states( 15 );
	for ( std::vector<double>& state : states )
	{
		state = world.full( world.randomState( random.engine() ) );
	}
	std::vector<io::DisabledPair> pairs = model.disabled;
	for ( std::uint32_t a = 0; a < links; ++a )
	{
		for ( std::uint32_t b = a + 1; b < links; ++b )
		{
			int contacts = 0;
			for ( const std::vector<double>& state : states )
			{
				contacts += auditor.clearance( state.data(), true, a, b ) <= 0;
			}
			if ( 2 * contacts > static_cast<int>( states.size() ) )
			{
				pairs.push_back(
				    { lw_robot_link_name( world.robot.get(), a ), lw_robot_link_name( world.robot.get(), b ), "User" } );
			}
		}
	}
	return pairs;
}

/// With the group "arm".
std::string srdfText( const io::RobotModel& model, const std::vector<io::DisabledPair>& pairs, const std::string& joints )
{
	std::string text = io::writeSrdf( model, pairs ).text, group = "  <group name=\"arm\">\n";
	std::stringstream parts( joints );
	for ( std::string joint; std::getline( parts, joint, '+' ); )
	{
		group += "    <joint name=\"" + joint + "\"/>\n";
	}
	return text.insert( text.rfind( "</robot>" ), group + "  </group>\n" );
}

std::string requestText(
    const EdgeWorld& world, const std::string& group, const std::vector<double>& start, const std::vector<double>& goal )
{
	Json joint_state, constraints = Json::array();
	for ( std::size_t i = 0; i < world.size(); ++i )
	{
		const char* name = lw_robot_joint_name( world.robot.get(), world.info( i ).joint );
		joint_state["name"].push_back( name );
		joint_state["position"].push_back( start[i] );
		constraints.push_back( { { "joint_name", name }, { "position", goal[i] } } );
	}
	const Json request = { { "group_name", group }, { "start_state", { { "joint_state", joint_state } } },
	    { "goal_constraints", Json::array( { { { "joint_constraints", constraints } } } ) } };
	return request.dump( 1 ); // JSON is YAML
}

/// A free state with some room to the scene, or none after many attempts. Links of one robot may be built closer than that.
bool freeState( const EdgeWorld& world, lw_query* query, Random& random, std::vector<double>& out )
{
	for ( int attempt = 0; attempt < 2000; ++attempt )
	{
		out = world.randomState( random.engine() );
		if ( !world.isFree( out, query ) )
		{
			continue;
		}
		bool free = false;
		leeway::require(
		    lw_checker_is_free( world.checker.get(), query, out.data(), LW_CHECK_ENVIRONMENT, ROOM, &free, nullptr ),
		    "a state" );
		if ( free )
		{
			return true;
		}
	}
	return false;
}

std::uint64_t seedOf( std::uint64_t seed, const std::string& robot, const std::string& kind, int number )
{
	Hash hash;
	hash.add( static_cast<std::int64_t>( seed ) );
	hash.add( robot.data(), robot.size() );
	hash.add( kind.data(), kind.size() );
	hash.add( number );
	return std::stoull( hash.text(), nullptr, 16 );
}

} // namespace

const std::vector<ZooRobot>& zooRobots()
{
	const std::string ur = "shoulder_pan_joint+shoulder_lift_joint+elbow_joint+wrist_1_joint+wrist_2_joint+wrist_3_joint";
	const std::string baxter = "s0+s1+e0+e1+w0+w1+w2";
	static const std::vector<ZooRobot> robots = {
	    { "ur5", "ur_description/urdf/ur5_robot.urdf", ur },
	    { "ur10", "ur_description/urdf/ur10_robot.urdf", ur },
	    { "kinova", "kinova_description/robots/kinova.urdf", joined( "j2s6s200_joint_", 1, 6 ) },
	    { "xarm7", "xarm_description/urdf/xarm7.urdf", joined( "joint", 1, 7 ) },
	    { "z1", "z1_description/urdf/z1.urdf", joined( "joint", 1, 6 ) },
	    { "tiago", "tiago_description/robots/tiago_no_hand.urdf", "torso_lift_joint+" + joined( "arm_", 1, 7, "_joint" ) },
	    { "talos", "talos_data/robots/talos_reduced.urdf",
	        "torso_1_joint+torso_2_joint+" + joined( "arm_left_", 1, 7, "_joint" ) },
	    { "baxter", "baxter_description/urdf/baxter.urdf", sided( "left_", baxter ) + "+" + sided( "right_", baxter ) },
	};
	return robots;
}

std::string robotsOfZoo( const std::string& zoo )
{
	const fs::path folder = fs::path( zoo ) / "example-robot-data/cmeel.prefix/share/example-robot-data/robots";
	if ( !fs::exists( folder ) )
	{
		throw NoData( folder.string() + " is not there; .ci/install.sh zoo fetches the robots, --zoo names their folder" );
	}
	return folder.string();
}

namespace
{

/// Tries scenes of one kind until one leaves room for two states. @return the source of its world
Json generate(
    EdgeWorlds& drafts, const Reach& reach, const Kind& kind, Json source, const std::string& base, std::uint64_t seed )
{
	for ( std::uint64_t attempt = 0; attempt < 20; ++attempt )
	{
		Random random( seed + attempt );
		SceneText scene;
		kind.add( scene, reach, random );
		const std::string file = base + "-" + std::to_string( attempt );
		writeFile( file + "-scene.yaml", scene.text() );
		source["scene"] = file + "-scene.yaml";
		const EdgeWorld& world = drafts.world( drafts.add( source ) );
		const leeway::Query query = leeway::makeQuery( world.checker.get() );
		std::vector<double> start, goal;
		if ( freeState( world, query.get(), random, start ) && freeState( world, query.get(), random, goal ) )
		{
			writeFile( file + "-request.yaml", requestText( world, source.at( "group" ).get<std::string>(), start, goal ) );
			source["request"] = file + "-request.yaml";
			return source;
		}
	}
	throw std::runtime_error( base + ": no scene leaves room for two free states" );
}

} // namespace

void addGeneratedProblems( EdgeWorlds& worlds, const ZooRobot& robot, const std::string& robots, int count,
    std::uint64_t seed, const std::string& folder )
{
	// the robot alone: its reach, and the pairs that it always has in contact
	lw_reach_def none = lw_reach_def_default();
	none.seconds = 0;
	EdgeWorlds drafts( robots, none );
	const std::string base = ( fs::path( folder ) / robot.name ).string();
	Json source = { { "set", robot.name }, { "name", robot.name + " arm/bare/0" },
	    { "robot", ( fs::path( robots ) / robot.urdf ).string() }, { "group", robot.group } };
	const EdgeWorld& bare = drafts.world( drafts.add( source ) );
	Random random( seedOf( seed, robot.name, "bare", 0 ) );
	const Reach reach = reachOf( bare, random );
	const io::RobotModel model = io::loadRobot( source.at( "robot" ).get<std::string>(), "" );
	writeFile( base + ".srdf", srdfText( model, pairsOf( model, bare, random ), robot.group ) );
	source["srdf"] = base + ".srdf";
	source["group"] = "arm";
	for ( const Kind& kind : KINDS )
	{
		for ( int number = 1; number <= count; ++number )
		{
			const std::string name = std::string( kind.name ) + "_" + robot.name,
			                  file = base + "-" + kind.name + std::to_string( number );
			source["name"] = robot.name + " arm/" + name + "/" + std::to_string( number );
			worlds.add( generate( drafts, reach, kind, source, file, seedOf( seed, robot.name, kind.name, number ) ) );
		}
	}
}

void addUntuned( Subjects& subjects, const std::string& zoo, const std::string& prefix, std::size_t random_robots,
    std::uint64_t seed, const std::string& folder )
{
	if ( !zoo.empty() )
	{
		const std::string robots = robotsOfZoo( zoo );
		for ( const ZooRobot& robot : zooRobots() )
		{
			subjects.emplace_back( prefix + robot.name, [&robot, robots, seed, folder]( EdgeWorlds& worlds )
			    { addGeneratedProblems( worlds, robot, robots, 1, seed, folder ); } );
		}
	}
	for ( std::size_t i = 0; i < random_robots; ++i )
	{
		subjects.emplace_back(
		    "random " + std::to_string( i + 1 ), [own = seed + i]( EdgeWorlds& worlds ) { worlds.addRandom( own, 1 ); } );
	}
}
