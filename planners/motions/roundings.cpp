// SPDX-License-Identifier: BSD-3-Clause
// Roundings of corners: see roundings.hpp. The roundings of a corner fill two triangles of joint space. A triangle is within a
// tube around a straight edge, half its height away from its base; where that tube is not free, the triangle is cut in two.
// Derivation: core/docs/motions.md.
#include "leeway/motions/roundings.hpp"
#include "motions/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <deque>

namespace leeway::motions
{
namespace
{

using State = std::vector<double>;
using Triangle = std::array<State, 3>;

constexpr std::size_t most_questions = 4096; // per corner; each is the proof of an edge
constexpr double smallest_height = 1e-3;     // of the radius: lower triangles are not cut; close_windows bounds their proofs
constexpr int radius_bisections = 6;
constexpr double outward = 1 + 0x1p-40, rounding = 0x1p-44; // of tolerances, far above a dozen roundings

double dot( const State& a, const State& b )
{
	double sum = 0;
	for ( std::size_t j = 0; j < a.size(); ++j )
	{
		sum += a[j] * b[j];
	}
	return sum;
}

/// a + t ( b - a )
State between( const State& a, const State& b, double t )
{
	State out = a;
	for ( std::size_t j = 0; j < a.size(); ++j )
	{
		out[j] += t * ( b[j] - a[j] );
	}
	return out;
}

/// a + t v
State along( State a, const State& v, double t )
{
	for ( std::size_t j = 0; j < a.size(); ++j )
	{
		a[j] += t * v[j];
	}
	return a;
}

State difference( const State& a, const State& b )
{
	return along( a, b, -1 );
}

double length( const State& v )
{
	return std::sqrt( dot( v, v ) );
}

class Prover
{
public:
	Prover( const lw_checker* checker, lw_query* query, const lw_edge_def& def, RoundingProof& out )
	    : m_checker( checker ), m_query( query ), m_def( def ), m_out( out ),
	      m_tolerance( lw_checker_variable_count( checker ) )
	{
	}

	/// The straight edge itself, with the given tolerance.
	lw_status proveEdge( const State& a, const State& b )
	{
		lw_edge_result result;
		const lw_status status = ask( a, b, m_def, result );
		note( status, result, between( a, b, result.t ) );
		return status;
	}

	/// All states of two triangles that have one size.
	lw_status proveTriangles( const std::array<Triangle, 2>& triangles, double radius )
	{
		std::deque<Triangle> open( triangles.begin(), triangles.end() );
		m_size = 0;
		for ( const Triangle& triangle : triangles )
		{
			for ( const State& corner : triangle )
			{
				m_size = std::max( m_size, length( corner ) );
			}
		}
		for ( std::size_t asked = 0; !open.empty(); ++asked )
		{
			const bool last = asked >= most_questions;
			const lw_status status =
			    proveTriangle( sorted( std::move( open.front() ) ), smallest_height * radius, last, open );
			open.pop_front();
			if ( status != LW_OK || m_out.verdict != LW_VERDICT_FREE )
			{
				return status;
			}
		}
		return LW_OK;
	}

private:
	/// The longest side becomes that of the first two corners.
	static Triangle sorted( Triangle t )
	{
		const double sides[3] = {
		    length( difference( t[1], t[2] ) ), length( difference( t[0], t[2] ) ), length( difference( t[0], t[1] ) ) };
		const std::size_t longest = static_cast<std::size_t>( std::max_element( sides, sides + 3 ) - sides );
		std::swap( t[longest], t[2] );
		return t;
	}

	/// Height of a sorted triangle, and where on the base it stands, 0 to 1.
	static State height( const Triangle& t, double* foot )
	{
		const State base = difference( t[1], t[0] );
		const double square = dot( base, base );
		*foot = square > 0 ? std::clamp( dot( difference( t[2], t[0] ), base ) / square, 0.0, 1.0 ) : 0;
		return difference( t[2], between( t[0], t[1], *foot ) );
	}

	/// Proves a sorted triangle, ends the proof, or adds both halves to `open`.
	lw_status proveTriangle( const Triangle& t, double smallest, bool last, std::deque<Triangle>& open )
	{
		double foot, largest = 0;
		const State h = height( t, &foot );
		for ( std::size_t j = 0; j < h.size(); ++j )
		{
			const bool moves = h[j] != 0 || t[0][j] != t[1][j];
			m_tolerance[j] = ( m_def.tolerance != nullptr ? m_def.tolerance[j] : 0 ) +
			                 ( moves ? 0.5 * std::abs( h[j] ) * outward + rounding * m_size : 0 );
			largest = std::max( largest, std::abs( h[j] ) );
		}
		last = last || largest <= smallest;
		lw_edge_def def = m_def;
		def.tolerance = m_tolerance.data();
		def.close_windows = last ? def.close_windows : 0;
		lw_edge_result result;
		const State from = along( t[0], h, 0.5 ), to = along( t[1], h, 0.5 );
		lw_status status = ask( from, to, def, result );
		if ( status != LW_OK || result.verdict == LW_VERDICT_FREE )
		{
			m_out.lower_bound = std::min( m_out.lower_bound, result.lower_bound );
			return status;
		}
		// half way up the triangle has the middle half of the edge
		const bool inside = result.t >= 0.5 * foot && result.t <= 0.5 * ( 1 + foot );
		const State q = between( from, to, result.t );
		if ( result.verdict == LW_VERDICT_BLOCKED && inside )
		{
			note( status, result, q );
			return status;
		}
		status = lookAt( between( between( t[0], t[1], 0.5 ), t[2], 1.0 / 3 ) );
		if ( status == LW_OK && m_out.verdict == LW_VERDICT_FREE && last )
		{
			result.verdict = LW_VERDICT_UNDECIDED; // a collision beside the triangle is none of a rounding
			note( status, result, q );
			return status;
		}
		const State middle = between( t[0], t[1], 0.5 );
		open.push_back( { t[0], t[2], middle } );
		open.push_back( { t[1], t[2], middle } );
		return status;
	}

	lw_status ask( const State& from, const State& to, const lw_edge_def& def, lw_edge_result& result )
	{
		m_points = from;
		m_points.insert( m_points.end(), to.begin(), to.end() );
		const lw_status status = lw_checker_curve( m_checker, m_query, m_points.data(), 1, &def, &result );
		m_out.queries += result.queries;
		return status;
	}

	/// A collision at q ends the proof.
	lw_status lookAt( const State& q )
	{
		bool free = false;
		lw_state_reason reason;
		const lw_status status =
		    lw_checker_is_free( m_checker, m_query, q.data(), m_def.flags, m_def.min_d, &free, &reason );
		++m_out.queries;
		if ( reason.verdict == LW_VERDICT_BLOCKED )
		{
			m_out.verdict = LW_VERDICT_BLOCKED;
			m_out.q = q;
			m_out.self = reason.self;
			m_out.pair = reason.pair;
		}
		return status;
	}

	void note( lw_status status, const lw_edge_result& result, const State& q )
	{
		m_out.verdict = status == LW_OK ? result.verdict : LW_VERDICT_UNKNOWN;
		if ( m_out.verdict == LW_VERDICT_FREE )
		{
			m_out.lower_bound = std::min( m_out.lower_bound, result.lower_bound );
			return;
		}
		m_out.q = q;
		m_out.self = result.self;
		m_out.pair = result.pair;
	}

	const lw_checker* m_checker;
	lw_query* m_query;
	const lw_edge_def& m_def;
	RoundingProof& m_out;
	State m_tolerance, m_points;
	double m_size = 0; ///< of coordinates, whose rounding tolerances include
};

/// The two triangles on both sides of a corner's bisector that its roundings fill.
std::array<Triangle, 2> trianglesOf( const State& before, const State& corner, const State& behind, double radius )
{
	State in = difference( corner, before ), out = difference( behind, corner );
	const double length_in = length( in ), length_out = length( out );
	in = between( State( in.size(), 0.0 ), in, 1 / length_in );
	out = between( State( out.size(), 0.0 ), out, 1 / length_out );
	const State inward = difference( out, in );                // 2 sin( angle / 2 ) long
	const double cosine = 0.5 * length( along( in, out, 1 ) ); // of angle / 2
	const double cut = std::min( { 0.5 * length_in, 0.5 * length_out, 4 * radius / length( inward ) } );
	const State a = along( corner, in, -cut ), b = along( corner, out, cut );
	// l tan( angle / 4 ) = |inward| l / ( 4 cos^2( angle / 4 ) )
	const State m = along( corner, inward, std::min( radius / length( inward ), cut / ( 2 * ( 1 + cosine ) ) ) );
	return { Triangle{ corner, a, m }, Triangle{ corner, m, b } };
}

/// The largest radius below `radius` that is proved for one corner.
lw_status bisect( const lw_checker* checker, lw_query* query, const std::array<const State*, 3>& corner, double radius,
    const lw_edge_def& def, RoundingProof& out )
{
	double low = 0, high = radius;
	for ( int i = 0; i < radius_bisections; ++i )
	{
		const double middle = 0.5 * ( low + high );
		RoundingProof found;
		found.verdict = LW_VERDICT_FREE;
		Prover prover( checker, query, def, found );
		const lw_status status = prover.proveTriangles( trianglesOf( *corner[0], *corner[1], *corner[2], middle ), middle );
		out.queries += found.queries;
		if ( status != LW_OK )
		{
			return status;
		}
		( found.verdict == LW_VERDICT_FREE ? low : high ) = middle;
	}
	out.free_radius = low;
	return LW_OK;
}

/// Without points that repeat the one before; and where each was.
std::vector<std::size_t> distinct( const std::vector<State>& points )
{
	std::vector<std::size_t> kept;
	for ( std::size_t i = 0; i < points.size(); ++i )
	{
		if ( kept.empty() || points[i] != points[kept.back()] )
		{
			kept.push_back( i );
		}
	}
	return kept;
}

} // namespace

lw_status proveRoundings( const lw_checker* checker, lw_query* query, const std::vector<State>& points, double radius,
    const lw_edge_def& def, RoundingProof& out )
{
	out = RoundingProof();
	if ( checker == nullptr || query == nullptr || points.empty() || !( radius > 0 && radius < HUGE_VAL ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	out.verdict = LW_VERDICT_FREE;
	out.lower_bound = HUGE_VAL;
	const std::vector<std::size_t> kept = distinct( points );
	out.corners = kept.size() > 2 ? kept.size() - 2 : 0;
	Prover prover( checker, query, def, out );
	lw_status status = LW_OK;
	// All edges come before all roundings: the verdict on a path that collides names one of its edges
	for ( std::size_t i = kept.size() > 1 ? 1 : 0; i < kept.size() && status == LW_OK && out.verdict == LW_VERDICT_FREE;
	      ++i )
	{
		status = prover.proveEdge( points[kept[i > 0 ? i - 1 : 0]], points[kept[i]] );
		out.corner = kept[i];
		out.on_edge = out.verdict != LW_VERDICT_FREE;
	}
	for ( std::size_t i = 1; i + 1 < kept.size() && status == LW_OK && out.verdict == LW_VERDICT_FREE; ++i )
	{
		const std::array<const State*, 3> corner = { &points[kept[i - 1]], &points[kept[i]], &points[kept[i + 1]] };
		out.corner = kept[i];
		status = prover.proveTriangles( trianglesOf( *corner[0], *corner[1], *corner[2], radius ), radius );
		if ( status == LW_OK && out.verdict != LW_VERDICT_FREE )
		{
			status = bisect( checker, query, corner, radius, def, out );
		}
	}
	if ( status != LW_OK || out.verdict != LW_VERDICT_FREE )
	{
		out.verdict = status == LW_OK ? out.verdict : LW_VERDICT_UNKNOWN;
		out.lower_bound = 0;
	}
	return status;
}

// ---- with names -----------------------------------------------------------------------------------------------------

RoundingAudit auditRoundings( const io::Problem& problem, const std::vector<std::vector<double>>& points, double radius,
    const lw_edge_def& def, const std::string& file )
{
	for ( const std::uint32_t variable : problem.variables )
	{
		if ( lw_robot_joint_type( problem.robot.get(), lw_robot_variable( problem.robot.get(), variable ).joint ) ==
		     LW_JOINT_FLOATING )
		{
			throw io::Error( file, "roundings", "the group has a floating joint, whose turns have no straight edges",
			    "leave the roundings out (--corner-blend), or choose a group without it" );
		}
	}
	RoundingAudit audit;
	audit.radius = radius;
	audit.min_d = def.min_d;
	audit.names = problem.variable_names;
	const auto start = std::chrono::steady_clock::now();
	const lw_checker* checker = problem.checker.get();
	const Query query = makeQuery( checker );
	require( proveRoundings( checker, query.get(), unwrapped( problem, points ), radius, def, audit.proof ),
	    "proof of roundings" );
	audit.seconds = std::chrono::duration<double>( std::chrono::steady_clock::now() - start ).count();
	const RoundingProof& proof = audit.proof;
	lw_clearance pair = proof.pair;
	if ( proof.verdict == LW_VERDICT_BLOCKED ) // a proof looks no closer at a contact than it has to
	{
		const lw_state_result state =
		    measure( checker, query.get(), proof.q, def.flags, nullptr, file, "the state of the violation" );
		pair = proof.self ? state.self : state.environment;
	}
	audit.pair = proof.self ? nameSelf( checker, pair ) : nameEnvironment( checker, pair );
	return audit;
}

std::string describe( const RoundingAudit& audit )
{
	const RoundingProof& proof = audit.proof;
	std::string out = fmt::format( "roundings   {} by up to {:g}: ", counted( proof.corners, "corner" ), audit.radius );
	const std::string work = fmt::format( "{} states in {:.4f} s", proof.queries, audit.seconds );
	if ( audit.valid() )
	{
		return out + fmt::format( "FREE, clearance at least {:.6g} m, proved for all of them; --min-d {:g} m; {}\n",
		                 proof.lower_bound, audit.min_d, work );
	}
	out += fmt::format( "{} {} points[{}], {} - {}, {} clearance {:.6g} m{}; {}\n",
	    proof.verdict == LW_VERDICT_BLOCKED ? "BLOCKED" : "UNDECIDED", proof.on_edge ? "on the edge to" : "at", proof.corner,
	    audit.pair.first, audit.pair.second, proof.self ? "self" : "environment", audit.pair.least(),
	    audit.pair.marginText(), work );
	for ( std::size_t k = 0; k < proof.q.size(); ++k )
	{
		out += fmt::format( "{}{} {:.6g}", k == 0 ? "state       " : ", ", audit.names[k], proof.q[k] );
	}
	out += "\n";
	return proof.on_edge ? out
	                     : out + fmt::format( "            roundings of this corner by up to {:.4g} are proved free\n",
	                                 proof.free_radius );
}

} // namespace leeway::motions
