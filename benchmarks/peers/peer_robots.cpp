// SPDX-License-Identifier: BSD-3-Clause
// Comparison B and C: states and edges of robots, every library over the same pairs.
#include "peers/peer_workloads.hpp"

#include "peers/edge_judges.hpp"
#include "peers/fcl_peer.hpp"

#include <algorithm>
#include <cmath>

namespace
{

constexpr double MARGIN = 0.01, NEAR = 0.05, RESOLUTION = 0.01;

const Question QUESTIONS[] = { { "exact" }, { "alpha 0.05", 0.05 }, { "alpha 0.3", 0.3 },
    { "margin 10 mm", 0, true, MARGIN }, { "boolean", 0, true, 0 } };

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
				place.peers.push_back( std::make_unique<PairPeer>(
				    place.world->checker.get(), peer.shared->another(), place.world->allowed, peer.managers ) );
			}
			m_places.push_back( std::move( place ) );
		}
	}

	void runStates( std::mt19937_64& random )
	{
		m_states.clear();
		for ( std::size_t i = 0; i < m_settings.states; ++i )
		{
			Place* place = placeOf( i );
			m_states.push_back( { place, place->world->randomState( random ) } );
		}
		askStates( { { "free", []( double d ) { return d > 0; } }, { "colliding", []( double d ) { return d <= 0; } } } );
		m_states.clear();
		for ( std::size_t i = 0; i < m_settings.states; ++i )
		{
			State state{ placeOf( i ), {} };
			for ( int attempt = 0; attempt < 1000; ++attempt )
			{
				state.q = state.place->world->randomState( random );
				if ( isNear( state ) )
				{
					m_states.push_back( state );
					break;
				}
			}
		}
		askStates( { { "near", []( double ) { return true; } } } );
	}

	void runEdges( std::mt19937_64& random )
	{
		for ( const double length : m_settings.lengths )
		{
			for ( const bool near : { true, false } )
			{
				m_edges.clear();
				for ( std::size_t i = 0; i < m_settings.states; ++i )
				{
					Place* place = placeOf( i );
					m_edges.push_back(
					    { place, place->world->randomMotion( near, length, random, place->judges->spare() ) } );
				}
				askEdges( near ? "near" : "anywhere", length );
			}
		}
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
	struct Kind
	{
		std::string name;
		std::function<bool( double )> holds; ///< of the exact distance
	};

	/// A robot that stands somewhere asks many questions there: a block is about one place.
	Place* placeOf( std::size_t i )
	{
		const std::size_t blocks = ( m_settings.states + BLOCK - 1 ) / BLOCK;
		return &m_places[i / BLOCK * m_places.size() / blocks % m_places.size()];
	}

	/// Free, and within 50 mm of the environment.
	static bool isNear( const State& state )
	{
		const lw_range range = { 0, NEAR, 0 };
		lw_state_result result;
		leeway::require( lw_checker_state( state.place->world->with_tables.get(), state.place->query.get(), state.q.data(),
		                     LW_CHECK_BOTH, &range, false, &result ),
		    "a state" );
		return result.verdict == LW_VERDICT_FREE && result.environment.kind == LW_CLEARANCE_NEAR;
	}

	void askStates( const std::vector<Kind>& kinds )
	{
		m_truths.clear();
		for ( const bool self : { false, true } )
		{
			std::vector<double> truth;
			for ( const Question& question : QUESTIONS )
			{
				Trial trial( question, askedOfStates( question, self ),
				    [this, self]( std::size_t i, double bound ) { return truthOf( i, self, bound ); } );
				trial.run( m_states.size(), m_settings.repetitions, truth );
				truth = trial.truth();
				for ( const Kind& kind : kinds )
				{
					const std::string workload =
					    "B " + m_name + ( self ? " self " : " environment " ) + question.name + ", " + kind.name;
					trial.report( m_out, workload, where( truth, kind.holds ) );
				}
			}
		}
	}

	Truth bruteForceOf( const State& state, bool self, double bound )
	{
		PairPeer& peer = *state.place->peers[0];
		peer.pose( state.q.data() );
		return bruteForce( m_brute, peer.placedPairs( self ), bound );
	}

	/// Of a state of the set; other questions about it have other bounds.
	Truth truthOf( std::size_t number, bool self, double bound )
	{
		const auto [known, is_new] = m_truths.try_emplace( { number, self } );
		auto& [truth, up_to] = known->second;
		if ( is_new || ( truth.upper >= up_to && up_to < bound ) )
		{
			truth = bruteForceOf( m_states[number], self, bound );
			up_to = bound;
		}
		return truth;
	}

	/// leeway first, then the peers; `ask_peer` gets the number of the peer.
	template <typename AskPeer>
	std::vector<Asked> askedOf(
	    const std::function<Answer( const double* )>& leeway, bool self, bool contacts, const AskPeer& ask_peer ) const
	{
		std::vector<Asked> asked = { { { "leeway", leeway } } };
		for ( std::size_t p = 0; p < m_peers.size(); ++p )
		{
			const PeerEngine& engine = *m_peers[p].shared;
			if ( ( self && m_peers[p].managers ) || ( contacts && !engine.isForContacts() ) )
			{
				continue; // it would do nothing of its own there
			}
			Asked peer{ { m_peers[p].name, [ask_peer, p]( const double* n ) { return ask_peer( p, n ); } } };
			for ( const Place& place : m_places )
			{
				peer.shape_error = std::max( peer.shape_error, place.peers[p]->largestShapeError() );
			}
			peer.has_solids = engine.hasSolids();
			asked.push_back( std::move( peer ) );
		}
		return asked;
	}

	std::vector<Asked> askedOfStates( const Question& question, bool self ) const
	{
		return askedOf( [this, question, self]( const double* n )
		    { return askLeeway( m_states[numberOf( n )], question, self ); },
		    self, question.verdict && question.margin <= 0,
		    [this, question, self]( std::size_t p, const double* n )
		    {
			    const State& state = m_states[numberOf( n )];
			    return askPeer( *state.place->peers[p], state, question, self );
		    } );
	}

	static Answer askLeeway( const State& state, const Question& question, bool self )
	{
		const lw_range range =
		    question.verdict ? lw_range_threshold( question.margin ) : lw_range{ 0, INFINITE, question.alpha };
		lw_state_result result;
		leeway::require( lw_checker_state( state.place->world->with_tables.get(), state.place->query.get(), state.q.data(),
		                     self ? LW_CHECK_SELF : LW_CHECK_ENVIRONMENT, &range, question.verdict, &result ),
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

	/// Answers are 1 for "not free". Sampling may miss a collision; only its word that there is one can contradict a proof.
	void askEdges( const char* set, double length )
	{
		std::map<std::pair<std::size_t, std::size_t>, std::vector<double>> found; // edge and peer: a state in collision
		const std::vector<Asked> asked = askedOf(
		    [this]( const double* n )
		    {
			    const Edge& edge = m_edges[numberOf( n )];
			    const lw_edge_def def = lw_edge_def_default();
			    lw_edge_result result;
			    return single(
			        edge.place->judges->byCertificate( edge.motion, !m_settings.no_tables, def, result ) ? 0 : 1 );
		    },
		    false, true,
		    [this, &found]( std::size_t p, const double* n )
		    {
			    const Edge& edge = m_edges[numberOf( n )];
			    std::vector<double> state;
			    const bool free = edge.place->judges->byPeer( *edge.place->peers[p], edge.motion, RESOLUTION, &state );
			    if ( !free )
			    {
				    found[{ numberOf( n ), p }] = state;
			    }
			    return single( free ? 0 : 1 );
		    } );
		// The truth of an edge: 0 if one of the states that a library found in collision is, 1 if not
		Trial trial( { "free", 0, true, 0 }, asked,
		    [this, &found]( std::size_t edge, double )
		    {
			    Truth truth;
			    truth.lower = truth.upper = 1;
			    for ( auto at = found.lower_bound( { edge, 0 } ); at != found.end() && at->first.first == edge; ++at )
			    {
				    const State state{ m_edges[edge].place, at->second };
				    for ( const bool self : { false, true } )
				    {
					    const Truth there = bruteForceOf( state, self, 1 );
					    truth = there.upper < truth.upper ? there : truth;
				    }
			    }
			    return truth;
		    } );
		const std::vector<double> free_to_all( m_edges.size(), 1.0 );
		trial.run( m_edges.size(), m_settings.repetitions, free_to_all );
		char text[160];
		std::snprintf( text, sizeof text, "C %s edges of %g rad, sampled at 1 %% by peers%s, %s", m_name.c_str(), length,
		    m_settings.no_tables ? ", no tables" : "", set );
		std::vector<double> verdicts;
		for ( std::size_t i = 0; i < m_edges.size(); ++i )
		{
			verdicts.push_back( trial.answer( 0, i ).upper );
		}
		trial.report( m_out, std::string( text ) + ", free", where( verdicts, []( double v ) { return v <= 0; } ) );
		trial.report( m_out, std::string( text ) + ", others", where( verdicts, []( double v ) { return v > 0; } ), false );
	}

	const PeersSettings& m_settings;
	const std::string m_name;
	const std::vector<PeerLibrary>& m_peers;
	PeerReport& m_out;
	const std::shared_ptr<FclModels> m_models = std::make_shared<FclModels>();
	std::vector<Place> m_places;
	std::vector<State> m_states;
	std::vector<Edge> m_edges;
	BruteDistance m_brute;
	std::map<std::pair<std::size_t, bool>, std::pair<Truth, double>> m_truths; ///< each with the bound of its question
};

} // namespace

void runRobots( const PeersSettings& settings, const std::vector<Subject>& subjects, bool states, bool edges,
    const std::vector<PeerLibrary>& peers, PeerReport& out )
{
	lw_reach_def reach = lw_reach_def_default();
	reach.seconds = settings.budget;
	EdgeWorlds worlds( settings.data, reach );
	std::mt19937_64 random( settings.seed );
	for ( const Subject& subject : subjects )
	{
		const std::size_t first = worlds.size();
		subject.add( worlds );
		RobotSubject robot( settings, subject.name, worlds, first, peers, out );
		if ( states )
		{
			robot.runStates( random );
		}
		if ( edges )
		{
			robot.runEdges( random );
		}
	}
}
