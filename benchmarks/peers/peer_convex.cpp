// SPDX-License-Identifier: BSD-3-Clause
// Comparison G: pairs of convex bodies, their distance or, where they overlap, their penetration depth.
//
// leeway answers with certified intervals. A peer that has signed distances is asked at a tolerance of 1e-9 and at one of 1e-6; rows tell how often
// its answer is outside of leeway's interval by more than OUTSIDE, and by how much. benchmarks/zoo/depth_coal.py tries who is wrong then.
#include "peers/convex_body.hpp"
#include "peers/peer_workloads.hpp"

#include "support/provenance.hpp"

#include "leeway/depth.h"

#include <algorithm>
#include <cmath>

namespace
{

constexpr std::size_t GROUP = 20; ///< pairs are asked in groups: one takes as long as reading the clock
constexpr double OUTSIDE = 1e-8;  ///< metres: rounding, and the tolerance of bodies of half a metre

lw_transform randomPose( std::mt19937_64& random )
{
	double q[4], norm = 0;
	do
	{
		norm = 0;
		for ( double& x : q )
		{
			x = uniform( random, -1, 1 );
			norm += x * x;
		}
	} while ( norm > 1 || norm < 0.01 );
	for ( double& x : q )
	{
		x /= std::sqrt( norm );
	}
	const double position[3] = { uniform( random, -0.6, 0.6 ), uniform( random, -0.6, 0.6 ), uniform( random, -0.6, 0.6 ) };
	lw_transform out;
	leeway::require( lw_transform_from_quaternion( position, q, &out ), "a pose" );
	return out;
}

/// Pairs of two kinds, all apart or all overlapping.
class ConvexPairs
{
public:
	ConvexPairs( const std::string& kind_a, const std::string& kind_b, bool overlap, const PeersSettings& settings,
	    const std::vector<PeerLibrary>& peers, std::mt19937_64& random )
	    : m_overlap( overlap )
	{
		const lw_query_def def = lw_query_def_default();
		lw_query* query = nullptr;
		leeway::require( lw_query_create( &def, nullptr, nullptr, nullptr, &query ), "a query" );
		m_query.reset( query );
		for ( const PeerLibrary& peer : peers )
		{
			if ( !peer.managers )
			{
				m_engines.push_back( peer.make() );
			}
		}
		m_pairs.reserve( std::max<std::size_t>( 1, settings.states / GROUP ) * GROUP );
		while ( m_pairs.size() < m_pairs.capacity() )
		{
			Pair pair{ convexBody( kind_a, 1, random ), convexBody( kind_b, 1, random ), randomPose( random ),
			    randomPose( random ) };
			if ( overlaps( pair ) == overlap )
			{
				m_pairs.push_back( std::move( pair ) );
			}
		}
		for ( const auto& engine : m_engines )
		{
			for ( Pair& pair : m_pairs )
			{
				engine->place( engine->add( &pair.a, pair.a.geometry ), pair.pose_a );
				engine->place( engine->add( &pair.b, pair.b.geometry ), pair.pose_b );
			}
		}
	}

	void run( const std::string& workload, const PeersSettings& settings, PeerReport& out )
	{
		std::vector<Way> ways = { { "leeway", [this]( std::size_t i ) { return ask( m_pairs[i], 0 ); } } };
		if ( m_overlap )
		{
			ways.push_back( { "leeway 1e-6", [this]( std::size_t i ) { return ask( m_pairs[i], 1e-6 ); } } );
		}
		for ( const auto& engine : m_engines )
		{
			for ( const double tolerance : { 1e-9, 1e-6 } )
			{
				if ( !std::isnan( engine->signedDistance( 0, 1, tolerance ) ) )
				{
					ways.push_back( { engine->name() + ( tolerance < 1e-8 ? " 1e-9" : " 1e-6" ),
					    [e = engine.get(), tolerance]( std::size_t i )
					    { return single( e->signedDistance( 2 * i, 2 * i + 1, tolerance ) ); } } );
				}
			}
		}
		std::vector<Contender> contenders;
		for ( const Way& way : ways )
		{
			contenders.push_back( { way.name, [&way]( const double* n )
			    {
				    double sum = 0;
				    for ( std::size_t i = 0; i < GROUP; ++i )
				    {
					    sum += way.ask( GROUP * numberOf( n ) + i ).upper;
				    }
				    return single( sum );
			    } } );
		}
		ConfigurationSet set;
		for ( std::size_t i = 0; i < m_pairs.size() / GROUP; ++i )
		{
			set.states.push_back( { static_cast<double>( i ) } );
		}
		std::vector<Run> runs = race( contenders, set, settings.repetitions, 1 );
		std::vector<PeerRow> rows;
		for ( std::size_t c = 0; c < ways.size(); ++c )
		{
			for ( std::size_t i = 0; i < set.states.size(); ++i )
			{
				runs[c].microseconds[i] /= GROUP;
				for ( double& time : runs[c].passes[i] )
				{
					time /= GROUP;
				}
			}
			rows.push_back( judge( ways[c], ways[0] ) );
			rows.back().workload = workload;
			rows.back().time = summarise( runs[c] );
		}
		out.add( rows );
	}

private:
	struct Pair
	{
		ConvexBody a, b;
		lw_transform pose_a, pose_b;
	};

	/// Somebody's signed interval of a pair.
	struct Way
	{
		std::string name;
		std::function<Answer( std::size_t )> ask;
	};

	bool overlaps( const Pair& pair )
	{
		lw_depth depth;
		leeway::require( lw_shape_depth( pair.a.shape.get(), &pair.pose_a, pair.b.shape.get(), &pair.pose_b, nullptr,
		                     m_query.get(), &depth ),
		    "a depth" );
		return depth.kind == LW_DEPTH_OVERLAP;
	}

	/// The signed interval. @param width metres: of a depth's interval that will do
	Answer ask( const Pair& pair, double width )
	{
		if ( m_overlap )
		{
			lw_depth_def def = lw_depth_def_default();
			def.width = width;
			lw_depth depth;
			leeway::require( lw_shape_depth( pair.a.shape.get(), &pair.pose_a, pair.b.shape.get(), &pair.pose_b, &def,
			                     m_query.get(), &depth ),
			    "a depth" );
			return { -depth.upper, -depth.lower };
		}
		lw_clearance clearance;
		leeway::require( lw_shape_distance( pair.a.shape.get(), &pair.pose_a, pair.b.shape.get(), &pair.pose_b, nullptr,
		                     m_query.get(), &clearance ),
		    "a distance" );
		return { clearance.lower, clearance.upper };
	}

	PeerRow judge( const Way& way, const Way& leeway ) const
	{
		PeerRow row;
		row.library = way.name;
		row.count = m_pairs.size();
		row.outside = 0;
		Hash hash;
		for ( std::size_t i = 0; i < m_pairs.size(); ++i )
		{
			const Answer said = way.ask( i ), certified = leeway.ask( i );
			// an answer that is no number is as far outside as can be
			const double off = std::isfinite( said.upper )
			                       ? std::max( { 0.0, certified.lower - said.upper, said.lower - certified.upper } )
			                       : INFINITY;
			hash.add( off < INFINITY ? std::llround( said.upper * 1e9 ) : 0 );
			row.outside += off > OUTSIDE ? 1.0 / static_cast<double>( row.count ) : 0;
			row.largest_difference = std::max( row.largest_difference, off );
		}
		row.answers_hash = hash.text();
		return row;
	}

	bool m_overlap;
	leeway::Query m_query;
	std::vector<std::unique_ptr<PeerEngine>> m_engines;
	std::vector<Pair> m_pairs;
};

} // namespace

void runConvex( const PeersSettings& settings, const std::vector<PeerLibrary>& peers, PeerReport& out )
{
	std::mt19937_64 random( settings.seed );
	for ( const auto& [a, b] : std::vector<std::pair<std::string, std::string>>{ { "sphere", "sphere" },
	          { "sphere", "capsule" }, { "capsule", "capsule" }, { "sphere", "box" }, { "sphere", "cylinder" },
	          { "capsule", "box" }, { "box", "box" }, { "box", "cylinder" }, { "cylinder", "cylinder" },
	          { "capsule", "cone" }, { "box", "hull" }, { "hull", "hull" } } )
	{
		for ( const bool overlap : { false, true } )
		{
			ConvexPairs( a, b, overlap, settings, peers, random )
			    .run( "G " + a + ", " + b + ( overlap ? ": depth" : ": distance" ), settings, out );
		}
	}
}
