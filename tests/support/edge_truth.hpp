// SPDX-License-Identifier: BSD-3-Clause
// The truth about one edge, found by an auditor, and whether a verdict on it holds.
#pragma once

#include "edge_auditor.hpp"
#include "edge_world.hpp"

#include <cstdio>
#include <optional>
#include <string>

/// Looks at the whole edge at most once, and only if a verdict asks for it.
class EdgeTruth
{
public:
	/// Rounding that is granted to poses and distances where a claim is compared with a distance, metres.
	static constexpr double rounding = 1e-10;

	EdgeTruth( const EdgeWorld& world, EdgeAuditor& auditor, const Motion& motion, double min_d )
	    : m_world( world ), m_auditor( auditor ), m_from( world.full( motion.from ) ), m_to( world.full( motion.to ) ),
	      m_min_d( min_d )
	{
	}

	const EdgeAuditor::Look& whole()
	{
		if ( !m_whole )
		{
			m_whole = look( 1 );
		}
		return *m_whole;
	}

	/// Is some state of the edge at min_d or closer? A reproduced BLOCKED verdict answers as well as a look at the whole
	/// edge.
	bool isBlocked() { return m_reproduced || whole().contact; }
	std::uint64_t distances() const { return m_distances; }

	/// Why this verdict is wrong; empty if nothing speaks against it.
	std::string refute( const lw_edge_def& def, const lw_edge_result& r )
	{
		char text[200] = "";
		switch ( r.verdict )
		{
		case LW_VERDICT_FREE:
			if ( whole().contact )
			{
				std::snprintf( text, sizeof text, "FREE, but the distance is %.9g m at t = %.17g (%s)", whole().least,
				    whole().t, names( whole() ).c_str() );
			}
			else if ( whole().least < r.lower_bound - rounding )
			{
				std::snprintf( text, sizeof text, "FREE with at least %.9g m, but it is %.9g m at t = %.17g", r.lower_bound,
				    whole().least, whole().t );
			}
			break;
		case LW_VERDICT_BLOCKED:
		case LW_VERDICT_UNDECIDED:
			refuteFailure( def, r, text, sizeof text );
			break;
		default:
			std::snprintf( text, sizeof text, "no verdict" );
		}
		return text;
	}

private:
	EdgeAuditor::Look look( double end )
	{
		const EdgeAuditor::Look found = m_auditor.look( m_from.data(), m_to.data(), m_min_d, end );
		m_distances += found.distances;
		return found;
	}

	std::string names( const EdgeAuditor::Look& at ) const
	{
		if ( at.link == LW_INVALID_INDEX )
		{
			return "bodies that never move";
		}
		return std::string( lw_robot_link_name( m_world.robot.get(), at.link ) ) + " - " +
		       ( at.self ? lw_robot_link_name( m_world.robot.get(), at.other )
		                 : lw_scene_object_name( m_world.scene.get(), at.other ) );
	}

	void refuteFailure( const lw_edge_def& def, const lw_edge_result& r, char* text, std::size_t size )
	{
		std::vector<double> state( m_from.size() );
		lw_robot_interpolate( m_world.robot.get(), m_from.data(), m_to.data(), r.t, state.data() );
		const double d = m_auditor.clearance( state.data(), r.self, r.pair.a, r.pair.b );
		const bool blocked = r.verdict == LW_VERDICT_BLOCKED;
		const double most = blocked ? m_min_d : ( m_min_d + def.slack ) / ( 1 - def.alpha );
		if ( !( d <= most + rounding ) )
		{
			std::snprintf( text, size, "%s at t = %.17g, but the distance of the pair is %.9g m",
			    lw_verdict_name( r.verdict ), r.t, d );
			return;
		}
		m_reproduced = m_reproduced || ( blocked && d <= m_min_d );
		if ( !blocked && m_auditor.clearance( state.data() ) < m_min_d - rounding )
		{
			std::snprintf( text, size, "UNDECIDED at t = %.17g, where the distance of another pair is %.9g m", r.t,
			    m_auditor.clearance( state.data() ) );
			return;
		}
		if ( r.proved_until > 0 )
		{
			const EdgeAuditor::Look part = look( r.proved_until );
			if ( part.contact )
			{
				std::snprintf( text, size, "proved until %.17g, but the distance is %.9g m at t = %.17g", r.proved_until,
				    part.least, part.t );
			}
		}
	}

	const EdgeWorld& m_world;
	EdgeAuditor& m_auditor;
	const std::vector<double> m_from, m_to;
	const double m_min_d;
	std::optional<EdgeAuditor::Look> m_whole;
	bool m_reproduced = false;
	std::uint64_t m_distances = 0;
};
