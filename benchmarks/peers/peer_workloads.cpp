// SPDX-License-Identifier: BSD-3-Clause
// Robots and scenes of the comparison (peers.hpp), and the questions about them.
#include "peers/peer_workloads.hpp"

#include "support/configurations.hpp"
#include "support/temporary_folder.hpp"

#ifdef LEEWAY_WITH_KITCHEN
#include "writer.hpp"
#endif

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

namespace
{

namespace fs = std::filesystem;

/// ARMAR-III's torso and right arm, its base as in the twelve reach problems and at 20 random places near furniture: not so
/// near that the links that stand still bound all distances before the first question.
Subject armar( const PeersSettings& settings )
{
	return { "armar3", [&settings]( EdgeWorlds& worlds )
	    {
		    worlds.addArmar( "torso_right_arm" );
		    int number = 0;
		    const leeway::io::Problem problem = loadKitchen( settings.data, lw_tree_def_default() );
		    for ( const auto& place : placesNearFurniture( problem, settings.seed, 0.05 ) )
		    {
			    worlds.add( { { "set", "armar3" }, { "name", "armar3/" + std::to_string( number++ ) },
			        { "robot", "armar3/armar3.urdf" }, { "srdf", "armar3/armar3.srdf" },
			        { "scene", "kit_kitchen/scene_cluttered.yaml" }, { "group", "torso_right_arm" }, { "start", place } } );
		    }
	    } };
}

/// The humanoid of examples/kitchen, parked as in its requests: those for one of its groups.
Subject demoKitchen( const fs::path& folder )
{
	return { "demo kitchen", [folder]( EdgeWorlds& worlds )
	    {
		    std::vector<std::string> files;
		    for ( const auto& entry : fs::directory_iterator( folder / "reach" ) )
		    {
			    files.push_back( entry.path().string() );
		    }
		    std::sort( files.begin(), files.end() );
		    for ( const std::string& file : files )
		    {
			    const std::string group = leeway::io::loadRequest( file ).group;
			    if ( group == "torso_right_arm" )
			    {
				    worlds.add( { { "set", "demo kitchen" }, { "name", "demo kitchen/" + fs::path( file ).stem().string() },
				        { "robot", ( folder / "robot.urdf" ).string() }, { "srdf", ( folder / "robot.srdf" ).string() },
				        { "scene", ( folder / "scene.yaml" ).string() }, { "request", file }, { "group", group } } );
			    }
		    }
	    } };
}

Subject mbm( const char* robot, const char* group, bool quick )
{
	return { robot, [=]( EdgeWorlds& worlds ) {
		        worlds.addMbm( robot, group, quick ? std::vector<int>{ 1 } : std::vector<int>{ 1, 13 } );
	        } };
}

Models ownModels( const PeersSettings& settings )
{
	return { fs::path( settings.robot ).stem().string(), settings.robot, settings.srdf, settings.scene, settings.request,
	    settings.group };
}

Subject ownSubject( const PeersSettings& settings )
{
	return { ownModels( settings ).name, [&settings]( EdgeWorlds& worlds )
	    {
		    Json source = { { "set", "own" }, { "name", "own" }, { "robot", settings.robot } };
		    const std::pair<const char*, const std::string*> parts[] = { { "srdf", &settings.srdf },
		        { "scene", &settings.scene }, { "request", &settings.request }, { "group", &settings.group } };
		    for ( const auto& [key, value] : parts )
		    {
			    if ( !value->empty() )
			    {
				    source[key] = *value;
			    }
		    }
		    worlds.add( source );
	    } };
}

} // namespace

void runPeerWorkloads( const PeersSettings& settings, const std::vector<PeerLibrary>& peers, PeerReport& report )
{
	const auto wanted = [&]( char letter )
	{ return settings.only.empty() || settings.only.find( letter ) != std::string::npos; };
	const bool own = !settings.robot.empty();
	if ( wanted( 'A' ) && !own )
	{
		runMeshes( settings, peers, report );
	}
	if ( wanted( 'B' ) || wanted( 'C' ) || wanted( 'F' ) )
	{
		std::vector<Subject> subjects;
		std::unique_ptr<TemporaryFolder> kitchen;
		if ( own )
		{
			subjects = { ownSubject( settings ) };
		}
		else
		{
			subjects = { armar( settings ), mbm( "fetch", "arm_with_torso", settings.quick ),
			    mbm( "panda", "panda_arm", settings.quick ) };
#ifdef LEEWAY_WITH_KITCHEN
			kitchen = std::make_unique<TemporaryFolder>();
			kitchen::writeDemo( kitchen::makeDemo(), ( kitchen->path() / "kitchen" ).string() );
			subjects.push_back( demoKitchen( kitchen->path() / "kitchen" ) );
#endif
		}
		if ( wanted( 'B' ) || wanted( 'C' ) )
		{
			runRobots( settings, subjects, wanted( 'B' ), wanted( 'C' ), peers, report );
		}
		if ( wanted( 'F' ) )
		{
			runNear( settings, subjects, peers, report );
		}
	}
	if ( wanted( 'G' ) && !own )
	{
		runConvex( settings, peers, report );
		runCrowds( settings, peers, report );
	}
	const Models models =
	    own ? ownModels( settings )
	        : Models{ "armar3 and its kitchen", settings.data + "/armar3/armar3.urdf", settings.data + "/armar3/armar3.srdf",
	              settings.data + "/kit_kitchen/scene_cluttered.yaml", settings.data + "/armar3/reach/01.yaml",
	              "torso_right_arm" };
	if ( wanted( 'D' ) )
	{
		runBuild( settings, models, peers, report );
	}
	if ( wanted( 'E' ) )
	{
		runGrowth( settings, models, peers, report );
	}
}
