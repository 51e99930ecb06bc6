// SPDX-License-Identifier: BSD-3-Clause
// A cubic whose ends are on the reference and go along it leaves it by the fourth power of its length: few are needed, and each is proved.
#include "lines/fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace leeway::lines
{
namespace
{

constexpr double longest_jump = 0.2; // radians or metres: of a joint, from where its speed would take it
constexpr std::uint32_t finest = 1024, contact_finest = 64; // of a leg's intervals between states

std::vector<double> toVector( const State& q )
{
	return { q.data(), q.data() + q.size() };
}

} // namespace

Fit::Fit( Follower& follower, const io::Problem& problem, const Task& task, const Settings& settings, lw_query* query )
    : m_follower( follower ), m_problem( problem ), m_settings( settings ), m_query( query ),
      m_constraints( problem, task.path ), m_rest( follower.variables(), 0.0 )
{
	for ( std::uint32_t i = 0; i < follower.variables(); ++i )
	{
		m_variables.push_back( i );
	}
}

bool Fit::fail( const Leg& leg, Obstacle obstacle, std::uint32_t place, const State& q, std::size_t variable )
{
	m_stop = {};
	m_stop.obstacle = obstacle;
	m_stop.part = leg.part;
	m_stop.fraction = leg.part_from + ( leg.part_to - leg.part_from ) * leg.course.at( place );
	const ik::Vector3d there = leg.pose( place ).t;
	m_stop.position = { there.x(), there.y(), there.z() };
	m_stop.q = toVector( q );
	m_stop.joint = variable < m_problem.variable_names.size() ? m_problem.variable_names[variable] : std::string();
	return false;
}

bool Fit::isFree( const Leg& leg, std::uint32_t place, const State& q )
{
	bool free = false;
	lw_state_reason reason;
	require( lw_checker_is_free(
	             m_problem.checker.get(), m_query, q.data(), m_settings.edge.flags, m_settings.edge.min_d, &free, &reason ),
	    "clearance of a state on the line" );
	++m_states;
	if ( !free )
	{
		fail( leg, reason.verdict == LW_VERDICT_BLOCKED ? Obstacle::COLLISION : Obstacle::UNDECIDED, place, q, SIZE_MAX );
		m_stop.self = reason.self;
		m_stop.pair = reason.self ? motions::nameSelf( m_problem.checker.get(), reason.pair )
		                          : motions::nameEnvironment( m_problem.checker.get(), reason.pair );
	}
	return free;
}

/// From the last state to a place, over others in between if joints move fast.
bool Fit::step( const Run& run, std::size_t number, const Wish& wish, std::uint32_t to )
{
	const Leg& leg = run.legs[number];
	const std::uint32_t all = leg.course.to - leg.course.from;
	const std::uint32_t least_step = std::max( all / finest, 1u ), contact_step = std::max( all / contact_finest, 1u );
	while ( m_knots.back().place < to )
	{
		const Knot& last = m_knots.back();
		std::uint32_t next = to;
		for ( ;; )
		{
			const double from = leg.course.at( last.place ), way = leg.course.at( next ) - from;
			const double turn = leg.turningOf().at( next ) - leg.turningOf().at( last.place );
			const State drift = ( leg.run_to - leg.run_from ) * way * m_follower.drift( last.q, wish, from );
			const State rate = m_follower.rate( leg.pose( last.place ), leg.motion( last.place, way, turn ), last.q, drift );
			const Follower::Blame fastest = m_follower.blame();
			const State there = ( last.q + rate ).cwiseMax( m_follower.lower() ).cwiseMin( m_follower.upper() );
			State q = there;
			const bool on_it = m_follower.correct( leg.pose( next ), q );
			if ( on_it && ( q - there ).cwiseAbs().maxCoeff() < longest_jump )
			{
				const bool free = isFree( leg, next, q );
				if ( free )
				{
					m_knots.push_back( { next, number, q, {} } );
					break;
				}
				if ( next - last.place <= contact_step )
				{
					return false;
				}
				next = last.place + ( next - last.place ) / 2; // where does it begin?
				continue;
			}
			if ( next - last.place <= least_step )
			{
				const Follower::Blame blame = on_it ? fastest : m_follower.blame();
				return fail( leg, blame.obstacle, last.place, last.q, blame.variable );
			}
			next = last.place + ( next - last.place ) / 2;
		}
	}
	return true;
}

/// Speeds at all states: the differences of their neighbours, and the needs of the reference.
void Fit::takeRates( const Run& run )
{
	const auto share = [&]( const Knot& knot ) { return run.legs[knot.leg].share( knot.place ); };
	for ( std::size_t i = 0; i < m_knots.size(); ++i )
	{
		Knot& knot = m_knots[i];
		const Knot &before = m_knots[i > 0 ? i - 1 : 0], &after = m_knots[std::min( i + 1, m_knots.size() - 1 )];
		const Leg& leg = run.legs[knot.leg];
		const double left = share( knot ) - share( before ), right = share( after ) - share( knot );
		// For each unit of the run's length: the slope of the parabola through three states. At rest there is none
		State slope = State::Zero( knot.q.size() );
		if ( left > 0 && right > 0 )
		{
			slope = ( right / left * ( knot.q - before.q ) + left / right * ( after.q - knot.q ) ) / ( left + right );
		}
		knot.rate =
		    m_follower.rate( leg.pose( knot.place ), leg.flow( knot.place ), knot.q, leg.shareFlow( knot.place ) * slope );
	}
}

bool Fit::follow( const Run& run, const Wish& wish, const State& q )
{
	m_knots.assign( 1, { 0, 0, q, {} } );
	for ( std::size_t number = 0; number < run.legs.size(); ++number )
	{
		const Leg& leg = run.legs[number];
		for ( std::uint32_t state = 1; state <= leg.states; ++state )
		{
			if ( !step( run, number, wish, leg.place( state ) ) )
			{
				return false;
			}
		}
	}
	takeRates( run );
	return true;
}

bool Fit::isNear( const Leg& leg, Piece& piece )
{
	return isWithin( leg, leg.region.get(), leg.course, piece ) &&
	       ( !leg.turns_apart || isWithin( leg, leg.turning_region.get(), leg.turning_course, piece ) );
}

/// The errors from one of a leg's references.
bool Fit::isWithin( const Leg& leg, lw_region* region, const Course& course, Piece& piece )
{
	const auto count = static_cast<std::uint32_t>( m_variables.size() );
	const std::uint32_t one = 0;
	double fractions[4];
	course.points( piece.from, piece.to, fractions );
	const lw_timed_piece moves = { parameter( piece.from ), parameter( piece.to ), 3, piece.points.data() };
	const lw_timed_piece goes = { moves.start, moves.end, 3, fractions };
	lw_track track = {}, timing = {};
	track.variables = m_variables.data();
	track.variable_count = count;
	track.pieces = &moves;
	track.piece_count = 1;
	timing.variables = &one;
	timing.variable_count = 1;
	timing.pieces = &goes;
	timing.piece_count = 1;
	const lw_clock clock = { &track, 1, m_rest.data() };
	lw_region_result r;
	require( lw_region_timed( region, &clock, &timing, moves.start, moves.end, &r ), "deviation from a line" );
	m_windows += r.windows;
	for ( int i = 0; i < 3 && region == leg.region.get(); ++i )
	{
		piece.position_error = std::max( { piece.position_error, r.upper[i], -r.lower[i] } );
	}
	if ( !leg.turns_apart || region == leg.turning_region.get() )
	{
		piece.angle_error =
		    r.upper[leg.def.tilt < INFINITY || leg.turning.tilt < INFINITY ? LW_REGION_TILT : LW_REGION_ANGLE];
	}
	return r.verdict == LW_VERDICT_FREE;
}

bool Fit::isClear( const Leg& leg, const Piece& piece )
{
	lw_edge_result r;
	require( lw_checker_curve( m_problem.checker.get(), m_query, piece.points.data(), 3, &m_settings.edge, &r ),
	    "clearance along a line" );
	m_states += r.queries;
	if ( r.verdict == LW_VERDICT_FREE )
	{
		return true;
	}
	const auto place = piece.from + static_cast<std::uint32_t>( std::lround( r.t * ( piece.to - piece.from ) ) );
	const std::vector<double> there = motions::stateAt( { { 0, 1, 3, piece.points } }, r.t );
	const State q = Eigen::Map<const State>( there.data(), static_cast<Eigen::Index>( there.size() ) );
	fail( leg, r.verdict == LW_VERDICT_BLOCKED ? Obstacle::COLLISION : Obstacle::UNDECIDED, place, q, SIZE_MAX );
	m_stop.self = r.self;
	m_stop.pair = r.self ? motions::nameSelf( m_problem.checker.get(), r.pair )
	                     : motions::nameEnvironment( m_problem.checker.get(), r.pair );
	return false;
}

/// The constraints along the path.
bool Fit::isKept( const Leg& leg, const Piece& piece )
{
	const motions::Segment segment = { 0, 1, 3, piece.points };
	if ( m_constraints.areKept( segment ) )
	{
		return true;
	}
	double time = 0;
	std::string text;
	for ( const motions::ConstraintProof& proof : m_constraints.prove( { segment }, {} ) )
	{
		if ( text.empty() && proof.verdict != LW_VERDICT_FREE )
		{
			time = std::clamp( proof.time, 0.0, 1.0 );
			text = fmt::format( "{}: {} is {} by {:.3g}", proof.element, proof.error,
			    proof.verdict == LW_VERDICT_BLOCKED ? "beyond its limit" : "too near to its limit for a proof, beyond",
			    proof.excess );
		}
	}
	const std::vector<double> there = motions::stateAt( { segment }, time );
	const auto place = piece.from + static_cast<std::uint32_t>( std::lround( time * ( piece.to - piece.from ) ) );
	const State q = Eigen::Map<const State>( there.data(), static_cast<Eigen::Index>( there.size() ) );
	fail( leg, Obstacle::CONSTRAINT, place, q, SIZE_MAX );
	m_stop.constraint = text;
	return false;
}

/// The cubic between two states, or two of its halves, from the left.
bool Fit::prove( const Leg& leg, const Knot& a, const Knot& b, std::vector<Piece>& out )
{
	const double width = parameter( b.place - a.place );
	const State inner[2] = { a.q + width / 3 * a.rate, b.q - width / 3 * b.rate };
	Piece piece;
	piece.leg = b.leg;
	piece.from = a.place;
	piece.to = b.place;
	for ( const State* p : { &a.q, &inner[0], &inner[1], &b.q } )
	{
		piece.points.insert( piece.points.end(), p->data(), p->data() + p->size() );
	}
	Eigen::Index beyond = -1;
	for ( Eigen::Index i = 0; i < a.q.size(); ++i )
	{
		const bool out_of_limits = std::min( inner[0][i], inner[1][i] ) < m_follower.lower()[i] ||
		                           std::max( inner[0][i], inner[1][i] ) > m_follower.upper()[i];
		beyond = out_of_limits ? i : beyond;
	}
	if ( beyond < 0 && isNear( leg, piece ) )
	{
		out.push_back( piece );
		return isClear( leg, piece ) && isKept( leg, piece );
	}
	if ( b.place - a.place < 2 )
	{
		return fail( leg, beyond < 0 ? Obstacle::UNDECIDED : Obstacle::JOINT_LIMIT, a.place, a.q,
		    beyond < 0 ? SIZE_MAX : static_cast<std::size_t>( beyond ) );
	}
	Knot middle;
	middle.place = a.place + ( b.place - a.place ) / 2;
	middle.q = 0.125 * ( a.q + b.q ) + 0.375 * ( inner[0] + inner[1] );
	middle.q = middle.q.cwiseMax( m_follower.lower() ).cwiseMin( m_follower.upper() );
	middle.leg = b.leg;
	const State hint = 0.75 / width * ( b.q - a.q + inner[1] - inner[0] );
	if ( !m_follower.correct( leg.pose( middle.place ), middle.q ) )
	{
		const Follower::Blame blame = m_follower.blame();
		return fail( leg, blame.obstacle, a.place, a.q, blame.variable );
	}
	middle.rate = m_follower.rate( leg.pose( middle.place ), leg.flow( middle.place ), middle.q, hint );
	return prove( leg, a, middle, out ) && prove( leg, middle, b, out );
}

bool Fit::run( const Run& run, const Wish& wish, State& q, std::vector<Piece>& out )
{
	if ( !follow( run, wish, q ) )
	{
		return false;
	}
	const std::vector<Knot> knots = m_knots;
	for ( std::size_t i = 1; i < knots.size(); ++i )
	{
		if ( !prove( run.legs[knots[i].leg], knots[i - 1], knots[i], out ) )
		{
			return false;
		}
	}
	q = knots.back().q;
	return true;
}

} // namespace leeway::lines
