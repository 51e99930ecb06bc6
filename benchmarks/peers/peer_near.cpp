// SPDX-License-Identifier: BSD-3-Clause
// Comparison F: all pairs of bodies nearer than a distance, along motions that a controller asks about each millisecond.
//
// leeway answers cold (each state with a query that was reset), warm, with derivatives by the joints, and with ties. Peers give distances
// only. Each pair's distance is held against leeway's; brute force decides where they differ by more than AGREEMENT.
#include "peers/peer_workloads.hpp"

#include "support/provenance.hpp"

#include "leeway/near.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace
{

constexpr std::size_t STEPS = 50;       ///< states of a motion
constexpr double LENGTH = STEPS * 1e-3; ///< radians: a norm of the joint speeds of 1 rad/s, asked at 1 kHz
constexpr double TIE = 1e-6;            ///< metres

struct Way
{
	const char* name;
	bool cold, derivatives;
	double tie_width;
};
const Way WAYS[] = { { "leeway", false, false, 0 }, { "leeway cold", true, false, 0 }, { "leeway deriv.", false, true, 0 },
    { "leeway ties", false, true, TIE } };

using NearMap = std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<double, double>>; ///< interval of each near pair

class NearSubject
{
public:
	NearSubject( const PeersSettings& settings, const EdgeWorlds& worlds, std::size_t first,
	    const std::vector<PeerLibrary>& peers, std::mt19937_64& random )
	    : m_settings( settings ), m_peers( peers )
	{
		const std::size_t motions = std::max<std::size_t>( 1, settings.states / STEPS ), count = worlds.size() - first;
		for ( std::size_t k = 0; k < motions; ++k )
		{
			const EdgeWorld& world = worlds.world( first + k * count / motions % count );
			addMotion( world, random );
		}
	}

	void run( const std::string& name, PeerReport& out )
	{
		const std::vector<Contender> contenders = contendersOf();
		ConfigurationSet set;
		for ( std::size_t i = 0; i < m_states.size(); ++i )
		{
			set.states.push_back( { static_cast<double>( i ) } );
		}
		const std::vector<Run> runs = race( contenders, set, m_settings.repetitions, STEPS );
		std::vector<PeerRow> rows;
		for ( std::size_t c = 0; c < contenders.size(); ++c )
		{
			PeerRow row;
			char text[160];
			std::snprintf( text, sizeof text, "F %s pairs within %g mm, 1 kHz", name.c_str(), 1e3 * m_settings.distance );
			row.workload = text;
			row.library = contenders[c].name;
			row.count = m_states.size();
			row.time = summarise( runs[c] );
			rows.push_back( row );
		}
		judge( rows );
		out.add( rows );
	}

private:
	struct Place
	{
		const lw_checker* checker;
		std::vector<leeway::Query> queries; ///< of each way
		std::vector<std::unique_ptr<PairPeer>> peers;
		std::vector<double> derivatives;
	};
	struct State
	{
		Place* place;
		std::vector<double> q;
	};

	void addMotion( const EdgeWorld& world, std::mt19937_64& random )
	{
		auto place = std::make_unique<Place>();
		place->checker = world.with_tables.get();
		for ( std::size_t w = 0; w < std::size( WAYS ); ++w )
		{
			place->queries.push_back( leeway::makeQuery( place->checker ) );
		}
		for ( const PeerLibrary& peer : m_peers )
		{
			place->peers.push_back(
			    std::make_unique<PairPeer>( world.checker.get(), peer.shared->another(), world.allowed, peer.managers ) );
		}
		const Motion motion = world.randomMotion( true, LENGTH, random, place->queries[0].get() );
		for ( std::size_t i = 0; i < STEPS; ++i )
		{
			m_states.push_back( { place.get(), world.at( motion, static_cast<double>( i ) / STEPS ) } );
		}
		m_places.push_back( std::move( place ) );
	}

	/// @param rows large enough from a state to the next one
	std::uint32_t askLeeway( std::size_t way, const State& state, std::vector<lw_near_pair>& rows ) const
	{
		Place& place = *state.place;
		lw_query* const query = place.queries[way].get();
		if ( WAYS[way].cold )
		{
			lw_query_reset( query );
		}
		lw_near_def def = lw_near_def_default();
		def.flags = LW_CHECK_BOTH;
		def.distance = m_settings.distance;
		def.tie_width = WAYS[way].tie_width;
		for ( ;; )
		{
			if ( WAYS[way].derivatives )
			{
				place.derivatives.resize( rows.size() * state.q.size() );
				def.derivatives = place.derivatives.data();
			}
			std::uint32_t count = 0;
			leeway::require( lw_checker_near( place.checker, query, state.q.data(), &def, rows.data(),
			                     static_cast<std::uint32_t>( rows.size() ), &count ),
			    "a state" );
			if ( count <= rows.size() )
			{
				return count;
			}
			rows.resize( count );
		}
	}

	std::vector<Contender> contendersOf()
	{
		std::vector<Contender> out;
		for ( std::size_t w = 0; w < std::size( WAYS ); ++w )
		{
			out.push_back( { WAYS[w].name, [this, w, rows = std::vector<lw_near_pair>( 256 )]( const double* n ) mutable
			    { return single( askLeeway( w, m_states[numberOf( n )], rows ) ); } } );
		}
		for ( std::size_t p = 0; p < m_peers.size(); ++p )
		{
			out.push_back( { m_peers[p].name, [this, p]( const double* n )
			    {
				    const State& state = m_states[numberOf( n )];
				    state.place->peers[p]->pose( state.q.data() );
				    return single( static_cast<double>( state.place->peers[p]->nearPairs( m_settings.distance ).size() ) );
			    } } );
		}
		return out;
	}

	NearMap answer( std::size_t contender, const State& state )
	{
		NearMap out;
		if ( contender < std::size( WAYS ) )
		{
			m_rows.resize( std::max<std::size_t>( m_rows.size(), 256 ) );
			const std::uint32_t count = askLeeway( contender, state, m_rows );
			for ( std::uint32_t i = 0; i < count; ++i )
			{
				const lw_near_pair& row = m_rows[i];
				const std::uint32_t b = row.self ? row.body_b : state.place->peers[0]->obstacle( row.body_b );
				// margins are none here: the clearance is the distance
				out[std::minmax( row.body_a, b )] = {
				    std::max( 0.0, row.clearance.lower ), std::max( 0.0, row.clearance.upper ) };
			}
			return out;
		}
		PairPeer& peer = *state.place->peers[contender - std::size( WAYS )];
		peer.pose( state.q.data() );
		for ( const NearBodies& pair : peer.nearPairs( m_settings.distance ) )
		{
			out[std::minmax( pair.a, pair.b )] = { pair.distance, pair.distance };
		}
		return out;
	}

	/// Fills in answers' hash, pairs, differences to leeway's, and those that brute force contradicts.
	void judge( std::vector<PeerRow>& rows )
	{
		std::vector<NearMap> known;
		for ( const State& state : m_states )
		{
			known.push_back( answer( 1, state ) );
		}
		for ( std::size_t c = 0; c < rows.size(); ++c )
		{
			Hash hash;
			std::size_t pairs = 0;
			for ( std::size_t i = 0; i < m_states.size(); ++i )
			{
				const NearMap mine = answer( c, m_states[i] );
				pairs += mine.size();
				for ( const auto& [bodies, interval] : mine )
				{
					hash.add( bodies.first );
					hash.add( bodies.second );
					hash.add( std::llround( interval.second * 1e9 ) );
				}
				compare( i, mine, known[i], rows[c] );
			}
			rows[c].answers_hash = hash.text();
			rows[c].pairs = static_cast<double>( pairs ) / static_cast<double>( m_states.size() );
		}
	}

	/// A pair that is missing is at the distance asked for, or farther.
	void compare( std::size_t number, const NearMap& mine, const NearMap& leeway, PeerRow& row )
	{
		NearMap all = mine;
		all.insert( leeway.begin(), leeway.end() );
		for ( const auto& entry : all )
		{
			const auto of = [&]( const NearMap& map )
			{
				const auto found = map.find( entry.first );
				return found == map.end() ? std::pair{ m_settings.distance, m_settings.distance } : found->second;
			};
			const auto [lower, upper] = of( mine );
			const double other = of( leeway ).second;
			const double difference = std::max( std::abs( upper - other ), upper - lower );
			row.largest_difference = std::max( row.largest_difference, difference );
			if ( difference > AGREEMENT )
			{
				examine( number, entry.first, { lower, upper }, other, row );
			}
		}
	}

	void examine( std::size_t number, std::pair<std::uint32_t, std::uint32_t> bodies, std::pair<double, double> said,
	    double leeway, PeerRow& row )
	{
		PairPeer& peer = *m_states[number].place->peers[0];
		peer.pose( m_states[number].q.data() );
		const Truth truth =
		    bruteForce( m_brute, { peer.placedPair( bodies.first, bodies.second ) }, m_settings.distance + 10 * AGREEMENT );
		const double most = std::min( truth.upper, m_settings.distance ),
		             least = std::min( truth.lower, m_settings.distance );
		if ( said.first > most + AGREEMENT || said.second < least - AGREEMENT || said.second > most + AGREEMENT )
		{
			++row.disagreements;
			row.examined.push_back( { number, said.second, leeway, truth.lower, truth.upper, truth.kinds } );
		}
	}

	const PeersSettings& m_settings;
	const std::vector<PeerLibrary>& m_peers;
	std::vector<std::unique_ptr<Place>> m_places;
	std::vector<State> m_states;
	std::vector<lw_near_pair> m_rows;
	BruteDistance m_brute;
};

} // namespace

void runNear( const PeersSettings& settings, const std::vector<Subject>& subjects, const std::vector<PeerLibrary>& peers,
    PeerReport& out )
{
	lw_reach_def reach = lw_reach_def_default();
	reach.seconds = settings.budget;
	EdgeWorlds worlds( settings.data, reach );
	std::mt19937_64 random( settings.seed );
	for ( const Subject& subject : subjects )
	{
		const std::size_t first = worlds.size();
		subject.add( worlds );
		NearSubject( settings, worlds, first, peers, random ).run( subject.name, out );
	}
}
