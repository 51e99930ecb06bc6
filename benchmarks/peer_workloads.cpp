// SPDX-License-Identifier: BSD-3-Clause
// The work of the comparison (peers.hpp): A two meshes, B states of robots, C edges, D building, E growth.
//
// leeway's exact distances are what answers are judged by; where all peers contradict one of them it is leeway that is
// charged. Everybody's forward kinematics and poses are in the times.
#include "peers.hpp"

#include "edge_judges.hpp"
#include "edge_worlds.hpp"
#include "fcl_peer.hpp"
#include "provenance.hpp"
#include "tree_cost.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>

namespace
{

namespace io = leeway::io;

constexpr double INFINITE = std::numeric_limits<double>::infinity();
constexpr double AGREEMENT = 1e-6; ///< metres
constexpr double MARGIN = 0.01;

double uniform( std::mt19937_64& random )
{
	return static_cast<double>( random() >> 11 ) * 0x1p-53;
}

Answer single( double value )
{
	return { value, value };
}

// --- judging ---------------------------------------------------------------------------------------------------------

struct Question
{
	std::string name;
	double alpha = 0;     ///< of a distance
	bool verdict = false; ///< is the distance at or below `margin`?
	double margin = 0;
	double relativeError() const { return alpha / ( 1 - alpha ); } ///< found <= (1 + this) true, as peers have it
};

const Question QUESTIONS[] = { { "exact" }, { "alpha 0.05", 0.05 }, { "alpha 0.3", 0.3 },
    { "margin 10 mm", 0, true, MARGIN }, { "boolean", 0, true, 0 } };

/// By how far an answer is wrong, in metres; infinite for a contact that was not seen.
double wrongBy( const Question& question, bool interval, const Answer& got, double truth )
{
	if ( question.verdict )
	{
		const bool yes = truth <= question.margin;
		return ( got.upper > 0 ) == yes             ? 0
		       : truth == 0 && question.margin == 0 ? INFINITE
		                                            : std::abs( truth - question.margin );
	}
	const double most = interval ? got.lower : got.upper / ( 1 + question.relativeError() );
	return std::max( { 0.0, truth - got.upper, most - truth } );
}

/// Rows of some of the things that were asked about.
void report( PeerReport& out, const std::string& workload, const Question& question,
    const std::vector<Contender>& contenders, const std::vector<Run>& runs, const std::vector<double>& truth,
    const std::vector<std::size_t>& members )
{
	if ( members.empty() )
	{
		return;
	}
	std::vector<PeerRow> rows;
	std::map<std::size_t, std::size_t> contradicted; // how many peers contradict the truth there
	for ( std::size_t c = contenders.size(); c-- > 0; )
	{
		PeerRow row;
		row.workload = workload;
		row.library = contenders[c].name;
		row.count = members.size();
		std::vector<double> times;
		Hash hash;
		for ( const std::size_t i : members )
		{
			const Answer& answer = runs[c].answers[i];
			times.push_back( runs[c].microseconds[i] );
			hash.add( std::isfinite( answer.upper ) ? std::llround( answer.upper * 1e9 ) : -1 );
			const double by = wrongBy( question, c == 0, answer, truth[i] );
			contradicted[i] += c > 0 && by > AGREEMENT;
			if ( by > AGREEMENT || ( c == 0 && contenders.size() > 1 && contradicted[i] == contenders.size() - 1 ) )
			{
				if ( row.disagreements++ == 0 )
				{
					char text[96];
					std::snprintf( text, sizeof text, "number %zu: %.9g, not %.9g", i, answer.upper, truth[i] );
					row.first_disagreement = text;
				}
				row.largest_difference =
				    std::isfinite( by ) ? std::max( row.largest_difference, by ) : row.largest_difference;
			}
		}
		row.time = summarise( times );
		row.answers_hash = hash.text();
		rows.insert( rows.begin(), row );
	}
	out.add( rows );
}

std::vector<double> distances( const Run& run )
{
	std::vector<double> out;
	for ( const Answer& answer : run.answers )
	{
		out.push_back( answer.upper );
	}
	return out;
}

/// The things are asked about by their number.
ConfigurationSet numbers( std::size_t count )
{
	ConfigurationSet set;
	for ( std::size_t i = 0; i < count; ++i )
	{
		set.states.push_back( { static_cast<double>( i ) } );
	}
	return set;
}

std::size_t numberOf( const double* state )
{
	return static_cast<std::size_t>( *state );
}

std::vector<std::size_t> where( const std::vector<double>& truth, const std::function<bool( double )>& holds )
{
	std::vector<std::size_t> members;
	for ( std::size_t i = 0; i < truth.size(); ++i )
	{
		if ( holds( truth[i] ) )
		{
			members.push_back( i );
		}
	}
	return members;
}

// --- A: two meshes over a sweep of separations -----------------------------------------------------------------------

struct Mesh
{
	std::vector<double> vertices;
	std::vector<std::uint32_t> triangles;
};

leeway::Shape shapeOf( const Mesh& mesh )
{
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = mesh.vertices.data();
	def.vertex_count = static_cast<std::uint32_t>( mesh.vertices.size() / 3 );
	def.indices = mesh.triangles.data();
	def.triangle_count = static_cast<std::uint32_t>( mesh.triangles.size() / 3 );
	lw_shape* shape = nullptr;
	lw_diag diag{};
	leeway::require( lw_shape_create_mesh( &def, nullptr, &diag, &shape ), diag );
	return leeway::Shape::adopt( shape );
}

/// A closed surface over a grid of directions, radius by direction. 2 columns (rows - 1) triangles.
template <typename Radius> Mesh roundMesh( std::uint32_t columns, std::uint32_t rows, const Radius& radius )
{
	Mesh mesh;
	for ( std::uint32_t row = 0; row <= rows; ++row )
	{
		for ( std::uint32_t column = 0; column < columns; ++column )
		{
			const double along = M_PI * row / rows, around = 2 * M_PI * column / columns;
			const double n[3] = {
			    std::sin( along ) * std::cos( around ), std::sin( along ) * std::sin( around ), std::cos( along ) };
			for ( const double x : n )
			{
				mesh.vertices.push_back( radius( n ) * x );
			}
		}
	}
	for ( std::uint32_t row = 0; row < rows; ++row )
	{
		for ( std::uint32_t column = 0; column < columns; ++column )
		{
			const std::uint32_t next = ( column + 1 ) % columns, here = row * columns, below = here + columns;
			mesh.triangles.insert( mesh.triangles.end(), { here + column, below + column, here + next } );
			mesh.triangles.insert( mesh.triangles.end(), { here + next, below + column, below + next } );
		}
	}
	return mesh;
}

/// Each triangle cut into four at the middles of its edges: the same surface.
Mesh refined( const Mesh& mesh )
{
	Mesh out;
	out.vertices = mesh.vertices;
	std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
	const auto middle = [&]( std::uint32_t a, std::uint32_t b )
	{
		const auto [found, is_new] =
		    middles.try_emplace( std::minmax( a, b ), static_cast<std::uint32_t>( out.vertices.size() / 3 ) );
		for ( std::size_t k = 0; k < 3 && is_new; ++k )
		{
			out.vertices.push_back( 0.5 * ( out.vertices[3 * a + k] + out.vertices[3 * b + k] ) );
		}
		return found->second;
	};
	for ( std::size_t i = 0; i < mesh.triangles.size(); i += 3 )
	{
		const std::uint32_t a = mesh.triangles[i], b = mesh.triangles[i + 1], c = mesh.triangles[i + 2];
		const std::uint32_t ab = middle( a, b ), bc = middle( b, c ), ca = middle( c, a );
		out.triangles.insert( out.triangles.end(), { a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca } );
	}
	return out;
}

Mesh cube()
{
	Mesh mesh;
	for ( int corner = 0; corner < 8; ++corner )
	{
		mesh.vertices.insert(
		    mesh.vertices.end(), { corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5 } );
	}
	mesh.triangles = {
	    0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };
	return mesh;
}

lw_transform randomTurn( std::mt19937_64& random )
{
	double q[4], norm = 0;
	const double zero[3] = { 0, 0, 0 };
	for ( double& x : q )
	{
		x = std::sqrt( -2 * std::log( 1 - uniform( random ) ) ) * std::cos( 2 * M_PI * uniform( random ) );
		norm += x * x;
	}
	for ( double& x : q )
	{
		x /= std::sqrt( norm );
	}
	lw_transform turn;
	leeway::require( lw_transform_from_quaternion( zero, q, &turn ), "a turn" );
	return turn;
}

/// One mesh against itself, at pairs of poses.
class MeshPair
{
public:
	MeshPair( const Mesh& mesh, const std::vector<PeerLibrary>& peers ) : m_shape( shapeOf( mesh ) )
	{
		const lw_query_def def = lw_query_def_default();
		lw_query* query = nullptr;
		leeway::require( lw_query_create( &def, nullptr, nullptr, nullptr, &query ), "a query" );
		m_query.reset( query );
		PeerGeometry geometry{ LW_SHAPE_MESH, { 0, 0, 0 } };
		geometry.vertices = mesh.vertices.data();
		geometry.vertex_count = static_cast<std::uint32_t>( mesh.vertices.size() / 3 );
		geometry.triangles = mesh.triangles.data();
		geometry.triangle_count = static_cast<std::uint32_t>( mesh.triangles.size() / 3 );
		for ( const PeerLibrary& peer : peers )
		{
			m_engines.push_back( peer.make() );
			m_engines.back()->add( m_shape.get(), geometry );
			m_engines.back()->add( m_shape.get(), geometry );
		}
	}

	/// Turned at random, then moved along the line between their nearest points until that is `gap` long: no other pair of
	/// points comes nearer than that, by the triangle inequality.
	void addRandom( double gap, std::mt19937_64& random )
	{
		lw_transform a = randomTurn( random ), b = randomTurn( random );
		b.t[0] = 4;
		const lw_clearance c = measure( a, b );
		const double share = ( c.upper - gap ) / c.upper;
		b.t[0] += share * ( c.point_a.x - c.point_b.x );
		b.t[1] += share * ( c.point_a.y - c.point_b.y );
		b.t[2] += share * ( c.point_a.z - c.point_b.z );
		m_poses.emplace_back( a, b );
	}

	/// Unit cubes face to face, shifted sideways: all of two large surfaces is about as near, the worst case of all trees.
	void addFacing( double gap, std::mt19937_64& random )
	{
		lw_transform b = lw_transform_identity();
		b.t[0] = 1 + gap;
		b.t[1] = 0.4 * uniform( random ) - 0.2;
		b.t[2] = 0.4 * uniform( random ) - 0.2;
		m_poses.emplace_back( lw_transform_identity(), b );
	}

	void run( const std::string& workload, int repetitions, PeerReport& out )
	{
		std::vector<Contender> contenders;
		contenders.push_back( { "leeway", [this]( const double* state )
		    {
			    const auto& [a, b] = m_poses[numberOf( state )];
			    const lw_clearance c = measure( a, b );
			    return Answer{ c.lower, c.upper };
		    } } );
		for ( const auto& engine : m_engines )
		{
			contenders.push_back( { engine->name(), [this, e = engine.get()]( const double* state )
			    {
				    const auto& [a, b] = m_poses[numberOf( state )];
				    e->place( 0, a );
				    e->place( 1, b );
				    return single( e->distance( 0, 1, INFINITE, 0 ) );
			    } } );
		}
		const std::vector<Run> runs = race( contenders, numbers( m_poses.size() ), repetitions );
		const std::vector<double> truth = distances( runs[0] );
		report( out, workload, QUESTIONS[0], contenders, runs, truth, where( truth, []( double ) { return true; } ) );
		m_poses.clear();
	}

private:
	lw_clearance measure( const lw_transform& a, const lw_transform& b )
	{
		lw_clearance c;
		leeway::require(
		    lw_shape_distance( m_shape.get(), &a, m_shape.get(), &b, nullptr, m_query.get(), &c ), "a distance" );
		return c;
	}

	leeway::Shape m_shape;
	leeway::Query m_query;
	std::vector<std::unique_ptr<PeerEngine>> m_engines;
	std::vector<std::pair<lw_transform, lw_transform>> m_poses;
};

void runMeshes( const PeersSettings& settings, const std::vector<PeerLibrary>& peers, PeerReport& out )
{
	std::mt19937_64 random( settings.seed );
	const auto bumpy = []( const double n[3] )
	{
		return 0.5 + 0.06 * std::sin( 7 * n[0] + 2 ) * std::sin( 6 * n[1] ) +
		       0.04 * std::sin( 11 * n[2] ) * std::cos( 9 * n[0] );
	};
	const std::pair<const char*, Mesh> meshes[] = {
	    { "two cubes", cube() }, { "two organic meshes", roundMesh( 142, 71, bumpy ) } };
	for ( const auto& [name, mesh] : meshes )
	{
		MeshPair pair( mesh, peers );
		for ( const double gap : { 0.001, 0.01, 0.1, 1.0 } )
		{
			for ( int i = 0; i < ( settings.quick ? 10 : 40 ); ++i )
			{
				pair.addRandom( gap, random );
			}
			char text[96];
			std::snprintf( text, sizeof text, "A %s of %zu triangles, %g m apart", name, mesh.triangles.size() / 3, gap );
			pair.run( text, settings.repetitions, out );
		}
	}
	Mesh fine = cube();
	for ( int level = 0; level < 5; ++level )
	{
		fine = refined( fine );
	}
	MeshPair cubes( fine, peers );
	for ( const double gap : { 0.01, 0.1, 1.0 } )
	{
		for ( int i = 0; i < ( settings.quick ? 5 : 20 ); ++i )
		{
			cubes.addFacing( gap, random );
		}
		char text[96];
		std::snprintf(
		    text, sizeof text, "A two parallel cubes of %zu triangles, %g m apart", fine.triangles.size() / 3, gap );
		cubes.run( text, settings.repetitions, out );
	}
}

// --- B and C: robots -------------------------------------------------------------------------------------------------

/// One robot and group in all its scenes, every library over the same pairs.
class RobotSubject
{
public:
	RobotSubject( const PeersSettings& settings, const std::string& name, const EdgeWorlds& worlds, std::size_t first,
	    const std::vector<PeerLibrary>& peers, PeerReport& out )
	    : m_settings( settings ), m_name( name ), m_peers( peers ), m_out( out )
	{
		for ( std::size_t i = first; i < worlds.size(); ++i )
		{
			Place place;
			place.world = &worlds.world( i );
			place.judges = std::make_unique<EdgeJudges>( *place.world, m_models );
			place.query = leeway::makeQuery( place.world->with_tables.get() );
			for ( const PeerLibrary& peer : peers )
			{
				place.peers.push_back(
				    std::make_unique<PairPeer>( place.world->checker.get(), peer.shared->another(), place.world->allowed ) );
			}
			m_places.push_back( std::move( place ) );
		}
	}

	void runStates( std::mt19937_64& random )
	{
		m_states.clear();
		for ( std::size_t i = 0; i < m_settings.states; ++i )
		{
			Place* place = &m_places[i % m_places.size()];
			m_states.push_back( { place, place->world->randomState( random ) } );
		}
		for ( const bool self : { false, true } )
		{
			std::vector<double> truth;
			for ( const Question& question : QUESTIONS )
			{
				const std::vector<Contender> contenders = stateContenders( question, self );
				const std::vector<Run> runs = race( contenders, numbers( m_states.size() ), m_settings.repetitions );
				truth = truth.empty() ? distances( runs[0] ) : truth;
				const std::string workload = "B " + m_name + ( self ? " self " : " environment " ) + question.name;
				const auto add = [&]( const char* kind, const std::function<bool( double )>& holds )
				{ report( m_out, workload + ", " + kind, question, contenders, runs, truth, where( truth, holds ) ); };
				add( "free", []( double d ) { return d > 0; } );
				if ( !self )
				{
					add( "free and below 50 mm", []( double d ) { return d > 0 && d < 0.05; } );
				}
				add( "colliding", []( double d ) { return d <= 0; } );
			}
		}
	}

	void runEdges( double length, std::mt19937_64& random )
	{
		m_edges.clear();
		for ( std::size_t i = 0; i < m_settings.states / 2; ++i )
		{
			Place* place = &m_places[i % m_places.size()];
			m_edges.push_back( { place, place->world->randomMotion( i % 2 == 0, length, random, place->judges->spare() ) } );
		}
		const std::vector<Contender> contenders = edgeContenders();
		const std::vector<Run> runs = race( contenders, numbers( m_edges.size() ), m_settings.repetitions );
		// Sampling may miss a collision; only its word that there is one contradicts a proof
		std::vector<double> truth;
		for ( std::size_t i = 0; i < m_edges.size(); ++i )
		{
			truth.push_back( runs[0].answers[i].upper > 0 ? 1 : 0 );
		}
		Question free{ "proved", 0, true, 0 };
		char text[96];
		std::snprintf( text, sizeof text, "C %s edges of %g rad, sampled at 1 %% by peers, ", m_name.c_str(), length );
		report( m_out, std::string( text ) + "free", free, contenders, inverted( runs ), truth,
		    where( truth, []( double d ) { return d > 0; } ) );
		const std::vector<double> blocked( truth.size(), 0.0 );
		std::vector<Run> times_only = runs;
		for ( Run& run : times_only )
		{
			std::fill( run.answers.begin(), run.answers.end(), single( 1 ) );
		}
		report( m_out, std::string( text ) + "others", free, contenders, times_only, blocked,
		    where( truth, []( double d ) { return d <= 0; } ) );
	}

private:
	struct Place
	{
		const EdgeWorld* world;
		std::unique_ptr<EdgeJudges> judges;
		leeway::Query query;
		std::vector<std::unique_ptr<PairPeer>> peers;
	};
	struct State
	{
		Place* place;
		std::vector<double> q;
	};
	struct Edge
	{
		Place* place;
		Motion motion;
	};

	/// From "is it free?" to "is there a contact?", as verdicts are judged.
	static std::vector<Run> inverted( std::vector<Run> runs )
	{
		for ( Run& run : runs )
		{
			for ( Answer& answer : run.answers )
			{
				answer = single( answer.upper > 0 ? 0 : 1 );
			}
		}
		return runs;
	}

	static Answer askLeeway( const State& state, const Question& question, bool self )
	{
		const lw_range range = question.verdict ? lw_range{ question.margin, std::nextafter( question.margin, INFINITE ), 0 }
		                                        : lw_range{ 0, INFINITE, question.alpha };
		lw_state_result result;
		leeway::require( lw_checker_state( state.place->world->with_tables.get(), state.place->query.get(), state.q.data(),
		                     self ? LW_WHAT_SELF : LW_WHAT_ENVIRONMENT, &range, question.verdict, &result ),
		    "a state" );
		const lw_clearance& c = self ? result.self : result.environment;
		return question.verdict ? single( result.verdict == LW_VERDICT_FREE ? 0 : 1 ) : Answer{ c.lower, c.upper };
	}

	static Answer askPeer( PairPeer& peer, const State& state, const Question& question, bool self )
	{
		peer.pose( state.q.data() );
		if ( !question.verdict )
		{
			return single( self ? peer.selfDistance( INFINITE, question.relativeError() )
			                    : peer.environmentDistance( INFINITE, question.relativeError() ) );
		}
		if ( question.margin > 0 )
		{
			return single( self ? peer.selfWithin( question.margin ) : peer.environmentWithin( question.margin ) );
		}
		return single( self ? peer.selfCollides() : peer.environmentCollides() );
	}

	std::vector<Contender> stateContenders( const Question& question, bool self ) const
	{
		std::vector<Contender> contenders;
		contenders.push_back( { "leeway",
		    [this, question, self]( const double* n ) { return askLeeway( m_states[numberOf( n )], question, self ); } } );
		for ( std::size_t p = 0; p < m_peers.size(); ++p )
		{
			contenders.push_back( { m_peers[p].name, [this, question, self, p]( const double* n )
			    {
				    const State& state = m_states[numberOf( n )];
				    return askPeer( *state.place->peers[p], state, question, self );
			    } } );
		}
		return contenders;
	}

	std::vector<Contender> edgeContenders() const
	{
		std::vector<Contender> contenders;
		contenders.push_back( { "leeway", [this]( const double* n )
		    {
			    const Edge& edge = m_edges[numberOf( n )];
			    const lw_edge_def def = lw_edge_def_default();
			    lw_edge_result result;
			    return single( edge.place->judges->byCertificate( edge.motion, true, def, result ) );
		    } } );
		for ( std::size_t p = 0; p < m_peers.size(); ++p )
		{
			contenders.push_back( { m_peers[p].name, [this, p]( const double* n )
			    {
				    const Edge& edge = m_edges[numberOf( n )];
				    return single( edge.place->judges->byPeer( *edge.place->peers[p], edge.motion, 0.01 ) );
			    } } );
		}
		return contenders;
	}

	const PeersSettings& m_settings;
	const std::string m_name;
	const std::vector<PeerLibrary>& m_peers;
	PeerReport& m_out;
	const std::shared_ptr<FclModels> m_models = std::make_shared<FclModels>();
	std::vector<Place> m_places;
	std::vector<State> m_states;
	std::vector<Edge> m_edges;
};

// --- D: building -----------------------------------------------------------------------------------------------------

void runBuild( const PeersSettings& settings, const std::vector<PeerLibrary>& peers, PeerReport& out )
{
	const io::Problem problem = loadKitchen( settings.data, lw_tree_def_default() );
	const std::vector<const lw_shape*> meshes = distinctMeshes( problem );
	const TreeCost cost = measureTrees( meshes, lw_tree_def_default(), settings.repetitions );
	const auto row = [&]( const std::string& library, double seconds, double bytes )
	{
		PeerRow made;
		char text[96];
		std::snprintf( text, sizeof text, "D building the %zu distinct triangles of robot and kitchen", cost.triangles );
		made.workload = text;
		made.library = library;
		made.count = meshes.size();
		made.time.mean = made.time.median = made.time.p95 = 1e6 * seconds;
		made.bytes_per_triangle = bytes / static_cast<double>( cost.triangles );
		return made;
	};
	std::vector<PeerRow> rows = { row( "leeway", cost.seconds, static_cast<double>( cost.bytes ) ) };
	for ( const PeerLibrary& peer : peers )
	{
		double seconds = INFINITE;
		std::size_t bytes = 0;
		for ( int pass = 0; pass < settings.repetitions; ++pass )
		{
			const std::unique_ptr<PeerEngine> engine = peer.make();
			for ( const lw_shape* shape : meshes )
			{
				const lw_shape_info info = lw_shape_get_info( shape );
				engine->add( shape, { LW_SHAPE_MESH, { 0, 0, 0 }, lw_shape_vertices( shape ), info.vertex_count,
				                        lw_shape_triangles( shape ), info.triangle_count } );
			}
			seconds = std::min( seconds, engine->buildSeconds() );
			bytes = engine->bytes();
		}
		rows.push_back( row( peer.name, seconds, static_cast<double>( bytes ) ) );
	}
	out.add( rows );
}

// --- E: growth -------------------------------------------------------------------------------------------------------

/// The shape with 4^levels as many triangles; shared by those that share it.
leeway::Shape refinedShape( const leeway::Shape& shape, int levels, std::map<const lw_shape*, leeway::Shape>& known )
{
	leeway::Shape& entry = known[shape.get()];
	const lw_shape_info info = lw_shape_get_info( shape.get() );
	if ( !entry && ( levels == 0 || info.type != LW_SHAPE_MESH ) )
	{
		entry = shape;
	}
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
	return entry;
}

void runGrowth( const PeersSettings& settings, const std::vector<PeerLibrary>& peers, PeerReport& out )
{
	std::mt19937_64 random( settings.seed );
	std::vector<std::vector<double>> states;
	for ( int level = 0; level <= ( settings.quick ? 2 : 3 ); ++level )
	{
		io::RobotModel robot = io::loadRobot( settings.data + "/armar3/armar3.urdf", settings.data + "/armar3/armar3.srdf" );
		io::SceneModel scene = io::loadScene( settings.data + "/kit_kitchen/scene_cluttered.yaml" );
		const io::Request request = io::loadRequest( settings.data + "/armar3/reach/01.yaml" );
		std::map<const lw_shape*, leeway::Shape> known;
		for ( io::LinkModel& link : robot.links )
		{
			for ( io::PlacedShape& placed : link.collision )
			{
				placed.shape = refinedShape( placed.shape, level, known );
			}
		}
		for ( io::SceneObject& object : scene.objects )
		{
			for ( io::PlacedShape& placed : object.shapes )
			{
				placed.shape = refinedShape( placed.shape, level, known );
			}
		}
		io::ProblemOptions options;
		options.group = "torso_right_arm";
		options.scene = &scene;
		options.request = &request;
		const io::Problem problem = io::buildProblem( robot, options );
		while ( states.size() < ( settings.quick ? 20 : 100 ) )
		{
			states.emplace_back();
			for ( const std::uint32_t variable : problem.variables )
			{
				const lw_variable_info info = lw_robot_variable( problem.robot.get(), variable );
				states.back().push_back( info.lower + uniform( random ) * ( info.upper - info.lower ) );
			}
		}
		const leeway::Query query = leeway::makeQuery( problem.checker.get() );
		std::vector<Contender> contenders;
		contenders.push_back( { "leeway", [&]( const double* n )
		    {
			    lw_state_result result;
			    leeway::require( lw_checker_state( problem.checker.get(), query.get(), states[numberOf( n )].data(),
			                         LW_WHAT_ENVIRONMENT, nullptr, false, &result ),
			        "a state" );
			    return Answer{ result.environment.lower, result.environment.upper };
		    } } );
		std::vector<std::unique_ptr<PairPeer>> pairs;
		for ( const PeerLibrary& peer : peers )
		{
			pairs.push_back( std::make_unique<PairPeer>( problem.checker.get(), peer.make() ) );
			contenders.push_back( { peer.name, [&states, pair = pairs.back().get()]( const double* n )
			    {
				    pair->pose( states[numberOf( n )].data() );
				    return single( pair->environmentDistance( INFINITE ) );
			    } } );
		}
		const std::vector<Run> runs = race( contenders, numbers( states.size() ), settings.repetitions );
		const std::vector<double> truth = distances( runs[0] );
		char text[96];
		std::snprintf( text, sizeof text, "E armar3 in the kitchen, exact, %d x the triangles", 1 << ( 2 * level ) );
		report( out, text, QUESTIONS[0], contenders, runs, truth, where( truth, []( double ) { return true; } ) );
	}
}

} // namespace

void runPeerWorkloads( const PeersSettings& settings, std::vector<PeerLibrary>& peers, PeerReport& report )
{
	const auto wanted = [&]( char letter )
	{ return settings.only.empty() || settings.only.find( letter ) != std::string::npos; };
	if ( wanted( 'A' ) )
	{
		runMeshes( settings, peers, report );
	}
	lw_reach_def reach = lw_reach_def_default();
	reach.seconds = settings.budget;
	EdgeWorlds worlds( settings.data, reach );
	const std::vector<int> scenes = settings.quick ? std::vector<int>{ 1 } : std::vector<int>{ 1, 13 };
	const std::pair<const char*, std::function<void()>> subjects[] = {
	    { "armar3 torso_right_arm", [&] { worlds.addArmar( "torso_right_arm" ); } },
	    { "fetch arm_with_torso", [&] { worlds.addMbm( "fetch", "arm_with_torso", scenes ); } },
	    { "panda panda_arm", [&] { worlds.addMbm( "panda", "panda_arm", scenes ); } },
	};
	std::mt19937_64 random( settings.seed );
	for ( const auto& [name, add] : subjects )
	{
		if ( !wanted( 'B' ) && !wanted( 'C' ) )
		{
			break;
		}
		const std::size_t first = worlds.size();
		add();
		RobotSubject subject( settings, name, worlds, first, peers, report );
		if ( wanted( 'B' ) )
		{
			subject.runStates( random );
		}
		if ( wanted( 'C' ) )
		{
			subject.runEdges( 0.5, random );
		}
	}
	if ( wanted( 'D' ) )
	{
		runBuild( settings, peers, report );
	}
	if ( wanted( 'E' ) )
	{
		runGrowth( settings, peers, report );
	}
}
