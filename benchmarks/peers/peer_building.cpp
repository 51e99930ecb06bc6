// SPDX-License-Identifier: BSD-3-Clause
// Comparison D and E: building trees of a robot and a scene, and the same surfaces with more and more triangles.
#include "peers/peer_workloads.hpp"

#include "support/tree_cost.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <unordered_map>

namespace
{

namespace io = leeway::io;

io::Problem problemOf( const Models& models, int levels )
{
	io::RobotModel robot = io::loadRobot( models.robot, models.srdf );
	io::SceneModel scene;
	io::Request request;
	io::ProblemOptions options;
	options.group = models.group;
	if ( !models.scene.empty() )
	{
		scene = io::loadScene( models.scene );
		options.scene = &scene;
	}
	if ( !models.request.empty() )
	{
		request = io::loadRequest( models.request );
		options.request = &request;
	}
	std::unordered_map<const lw_shape*, leeway::Shape> known;
	// The shape with 4^levels as many triangles; shared by those that share it
	const auto refine = [&]( leeway::Shape& shape )
	{
		const lw_shape_info info = lw_shape_get_info( shape.get() );
		if ( levels == 0 || info.type != LW_SHAPE_MESH )
		{
			return;
		}
		leeway::Shape& entry = known[shape.get()];
		if ( !entry )
		{
			Mesh mesh;
			const double* vertices = lw_shape_vertices( shape.get() );
			const std::uint32_t* triangles = lw_shape_triangles( shape.get() );
			mesh.vertices.assign( vertices, vertices + 3 * std::size_t{ info.vertex_count } );
			mesh.triangles.assign( triangles, triangles + 3 * std::size_t{ info.triangle_count } );
			for ( int level = 0; level < levels; ++level )
			{
				mesh = refined( mesh );
			}
			entry = shapeOf( mesh );
		}
		shape = entry;
	};
	for ( io::LinkModel& link : robot.links )
	{
		for ( io::PlacedShape& placed : link.collision )
		{
			refine( placed.shape );
		}
	}
	for ( io::SceneObject& object : scene.objects )
	{
		for ( io::PlacedShape& placed : object.shapes )
		{
			refine( placed.shape );
		}
	}
	return io::buildProblem( robot, options );
}

std::vector<std::vector<double>> randomStates( const io::Problem& problem, std::uint64_t seed, std::size_t count )
{
	std::mt19937_64 random( seed );
	std::vector<std::vector<double>> states( count );
	for ( std::vector<double>& state : states )
	{
		for ( const std::uint32_t variable : problem.variables )
		{
			const lw_variable_info info = lw_robot_variable( problem.robot.get(), variable );
			const double low = std::isfinite( info.lower ) ? info.lower : -M_PI,
			             high = std::isfinite( info.upper ) ? info.upper : M_PI;
			state.push_back( low + static_cast<double>( random() >> 11 ) * 0x1p-53 * ( high - low ) );
		}
	}
	return states;
}

/// Exact distances and contacts with the environment, of leeway and some peers.
class Growth
{
public:
	Growth( const PeersSettings& settings, const io::Problem& problem, const std::vector<std::vector<double>>& states,
	    const std::vector<const PeerLibrary*>& peers )
	    : m_settings( settings ), m_problem( problem ), m_states( states ),
	      m_query( leeway::makeQuery( problem.checker.get() ) )
	{
		for ( const PeerLibrary* peer : peers )
		{
			m_names.push_back( peer->name );
			m_peers.push_back( std::make_unique<PairPeer>( problem.checker.get(), peer->make() ) );
		}
	}

	void run( const std::string& workload, PeerReport& out )
	{
		std::vector<double> truth;
		for ( const Question& question : { Question{ "exact" }, Question{ "boolean", 0, true, 0 } } )
		{
			Trial trial( question, asked( question ),
			    [this]( std::size_t i, double bound )
			    {
				    m_peers[0]->pose( m_states[i].data() );
				    return bruteForce( m_brute, m_peers[0]->placedPairs( false ), bound );
			    } );
			trial.run( m_states.size(), m_settings.repetitions, truth );
			truth = trial.truth();
			trial.report( out, workload + ", " + question.name, where( truth, []( double ) { return true; } ) );
		}
	}

private:
	std::vector<Asked> asked( const Question& question ) const
	{
		std::vector<Asked> all = { { { "leeway", [this, question]( const double* n )
		    {
			    const lw_range range = question.verdict ? lw_range_threshold( 0 ) : lw_range_exact();
			    lw_state_result result;
			    leeway::require( lw_checker_state( m_problem.checker.get(), m_query.get(), m_states[numberOf( n )].data(),
			                         LW_CHECK_ENVIRONMENT, &range, question.verdict, &result ),
			        "a state" );
			    return question.verdict ? single( result.verdict == LW_VERDICT_FREE ? 0 : 1 )
			                            : Answer{ result.environment.lower, result.environment.upper };
		    } } } };
		for ( std::size_t p = 0; p < m_peers.size(); ++p )
		{
			if ( question.verdict && !m_peers[p]->engine().isForContacts() )
			{
				continue;
			}
			all.push_back( { { m_names[p], [this, question, peer = m_peers[p].get()]( const double* n )
			    {
				    peer->pose( m_states[numberOf( n )].data() );
				    return single( question.verdict ? peer->environmentCollides() : peer->environmentDistance( INFINITE ) );
			    } } } );
			all.back().shape_error = m_peers[p]->largestShapeError();
			all.back().has_solids = m_peers[p]->engine().hasSolids();
		}
		return all;
	}

	const PeersSettings& m_settings;
	const io::Problem& m_problem;
	const std::vector<std::vector<double>>& m_states;
	leeway::Query m_query;
	std::vector<std::string> m_names;
	std::vector<std::unique_ptr<PairPeer>> m_peers;
	BruteDistance m_brute;
};

} // namespace

void runBuild( const PeersSettings& settings, const Models& models, const std::vector<PeerLibrary>& peers, PeerReport& out )
{
	const io::Problem problem = problemOf( models, 0 );
	const std::vector<const lw_shape*> meshes = distinctMeshes( problem );
	std::vector<PeerRow> rows( 1 );
	std::vector<std::vector<double>> times( 1 );
	rows[0].library = "leeway";
	for ( const PeerLibrary& peer : peers )
	{
		if ( !peer.managers )
		{
			rows.emplace_back();
			rows.back().library = peer.name;
			times.emplace_back();
		}
	}
	for ( int pass = 0; pass < std::max( 3, settings.repetitions ); ++pass )
	{
		const TreeCost cost = measureTrees( meshes, lw_tree_def_default(), 1 );
		times[0].push_back( 1e6 * cost.seconds );
		rows[0].bytes_per_triangle = cost.bytes_per_triangle;
		std::size_t r = 0;
		for ( const PeerLibrary& peer : peers )
		{
			if ( peer.managers )
			{
				continue;
			}
			const std::unique_ptr<PeerEngine> engine = peer.make();
			for ( const lw_shape* shape : meshes )
			{
				const lw_shape_info info = lw_shape_get_info( shape );
				engine->add( shape, { LW_SHAPE_MESH, { 0, 0, 0 }, lw_shape_vertices( shape ), info.vertex_count,
				                        lw_shape_triangles( shape ), info.triangle_count } );
			}
			times[++r].push_back( 1e6 * engine->buildSeconds() );
			rows[r].bytes_per_triangle = static_cast<double>( engine->bytes() ) / static_cast<double>( cost.triangles );
		}
		for ( PeerRow& row : rows )
		{
			row.workload = "D building " + std::to_string( cost.triangles ) + " distinct triangles of " + models.name;
			row.count = meshes.size();
		}
	}
	for ( std::size_t r = 0; r < rows.size(); ++r )
	{
		rows[r].time = summarise( times[r] );
	}
	out.add( rows );
}

void runGrowth( const PeersSettings& settings, const Models& models, const std::vector<PeerLibrary>& peers, PeerReport& out )
{
	std::vector<const PeerLibrary*> taking_part;
	for ( const PeerLibrary& peer : peers )
	{
		if ( !peer.managers )
		{
			taking_part.push_back( &peer );
		}
	}
	std::vector<std::vector<double>> states;
	for ( int level = 0; level <= 3; ++level )
	{
		const io::Problem problem = problemOf( models, level );
		if ( states.empty() )
		{
			states = randomStates( problem, settings.seed, settings.quick ? 40 : 100 );
		}
		const std::string workload = "E " + models.name + ", " + std::to_string( 1 << ( 2 * level ) ) + " x the triangles";
		if ( level < 3 )
		{
			Growth( settings, problem, states, taking_part ).run( workload, out );
			continue;
		}
		// Gigabytes each: one at a time
		for ( const PeerLibrary* peer : taking_part )
		{
			Growth( settings, problem, states, { peer } ).run( workload + ", beside " + peer->name, out );
			if ( settings.quick )
			{
				break;
			}
		}
	}
}
