// SPDX-License-Identifier: BSD-3-Clause
// Points of a path pushed away from near obstacles and links. Papers: Quinlan and Khatib, Elastic bands (ICRA 1993); Zucker et al., CHOMP (IJRR 2013),
// for steps that resolve several obstacles at once.
#include "leeway/planners/clearance.hpp"

#include "leeway/near.h"
#include "leeway/planners/smooth.hpp"
#include "leeway/planners/unwrap.hpp"

#include "margin_prover.hpp"
#include "validator.hpp"

#include <chrono>
#include <cstdio>
#include <string>

namespace leeway::planners
{

namespace
{

constexpr unsigned first_pieces = 12; // of the path, before the first push
constexpr std::size_t most_points = 48;
constexpr double approach = 0.1;        // share of the length beside each end that keeps the clearance that it has
constexpr std::uint32_t most_rows = 16; // near pairs of a state that push it
constexpr double near_alpha = 0.8;      // their directions count, and proofs come after: exact distances take twice the time
constexpr unsigned sweeps = 2;          // pushes of each point in a round
constexpr double overshoot = 1.15;      // of the goal: between two points the clearance is lower than at them
constexpr double pull = 0.5;            // share of the way to the middle of the neighbours
constexpr double longest_push = 0.35;   // of the mean length of edges
constexpr double still = 0.02;          // of the same: a point that moved by less waits for its neighbours
constexpr double damping = 0.02;        // of the rows' mean square
constexpr double weakest_row = 1e-3;    // metres per radian or metre: pairs that joints change less are not pushed
constexpr double push_share = 0.75, drop_share = 0.9; // of the time: until then points are pushed, and states dropped

class Raiser
{
public:
	Raiser( const lw_checker* checker, lw_query* query, const ClearanceSettings& settings, const Stop& stop, Path& path,
	    ClearanceReport& report )
	    : m_checker( checker ), m_query( query ), m_settings( settings ), m_space( Space::ofLimits( checker ) ),
	      m_prover( checker, query, settings.edge, m_space, settings.edge.min_d + settings.goal, report.work ),
	      m_push_end( shortened( stop, push_share ) ), m_drop_end( shortened( stop, drop_share ) ), m_path( path ),
	      m_report( report ), m_goal( settings.edge.min_d + settings.goal ), m_rows( most_rows * m_space.size() ),
	      m_step( m_space.size() ), m_trial( m_space.size() )
	{
		const lw_clearance fixed = lw_checker_get_info( checker ).static_environment;
		m_cap = { m_goal, m_goal };
		if ( fixed.kind != LW_CLEARANCE_UNKNOWN && fixed.lower < m_goal ) // no state has more
		{
			m_cap[0] = std::max( fixed.lower, 0.0 );
		}
	}

	lw_status run()
	{
		m_report.goal = m_goal;
		m_report.length_before = m_report.length_after = length( m_checker, m_path );
		if ( m_path.count() < 2 || !( m_report.length_before > 0 ) )
		{
			m_report.notice = "the path has no motion";
			return LW_OK;
		}
		makeBand();
		if ( !measureBefore() )
		{
			return status();
		}
		improve();
		if ( m_best_score > m_first_score )
		{
			dropPoints();
			take();
		}
		else if ( m_report.notice.empty() && status() == LW_OK )
		{
			m_report.notice = isReached() ? "the path keeps the clearance already" : "no push gained clearance in the time";
		}
		noteEnds();
		return status();
	}

private:
	Stop shortened( Stop stop, double share ) const
	{
		stop.seconds = std::min( stop.seconds, share * m_settings.seconds );
		return stop;
	}

	lw_status status() const { return m_status != LW_OK ? m_status : m_prover.status(); }
	bool isOver( Deadline& deadline ) { return deadline.over() || status() != LW_OK; }
	ClearanceChange& change( unsigned kind ) { return kind == 0 ? m_report.environment : m_report.self; }
	bool isAsked( unsigned kind ) const { return ( m_settings.edge.flags & flag_of[kind] ) != 0; }

	/// A path is no farther away than its ends.
	void noteEnds()
	{
		const double ends = std::min( m_report.environment.ends, m_report.self.ends );
		if ( status() == LW_OK && ends < m_goal )
		{
			char text[120];
			std::snprintf( text, sizeof text,
			    "%sthe start or the goal has a clearance of %.4g m: no path between them has more",
			    m_report.notice.empty() ? "" : "; ", ends );
			m_report.notice += text;
		}
	}

	/// The path's states, and points where its middle begins and ends.
	void makeBand()
	{
		const double length = m_report.length_before, near = 0.25 * length / first_pieces;
		const double marks[] = { approach * length, ( 1 - approach ) * length };
		std::vector<double> between( m_space.size() );
		double passed = 0;
		m_band.add( m_path[0], m_space.size() );
		for ( std::size_t i = 0; i + 1 < m_path.count(); ++i )
		{
			const double edge = m_space.distance( m_path[i], m_path[i + 1] );
			for ( const double mark : marks )
			{
				if ( mark > passed + near && mark < passed + edge - near )
				{
					m_space.between( m_path[i], m_path[i + 1], ( mark - passed ) / edge, between.data() );
					m_band.add( between.data(), m_space.size() );
				}
			}
			m_band.add( m_path[i + 1], m_space.size() );
			passed += edge;
		}
		findMiddle( marks );
	}

	/// Points between those of the band, which keep the proofs of its edges.
	void dividePieces()
	{
		const double piece = m_report.length_before / first_pieces;
		std::vector<double> between( m_space.size() );
		for ( std::size_t i = 0; i < m_band.edges.size(); ++i )
		{
			const double edge = m_space.distance( m_band.points[i].q.data(), m_band.points[i + 1].q.data() );
			for ( double parts = std::max( 1.0, std::ceil( edge / piece ) ); parts > 1; --parts, ++i )
			{
				m_space.between( m_band.points[i].q.data(), m_band.points[i + 1].q.data(), 1 / parts, between.data() );
				m_band.insert( i, between );
			}
		}
		m_spacing = m_band.length( m_space ) / static_cast<double>( m_band.edges.size() );
		m_low[0] = m_low[1] = {}; // edges have other numbers now
	}

	void findMiddle( const double marks[2] )
	{
		double passed = 0, off[2] = { HUGE_VAL, HUGE_VAL };
		for ( std::size_t i = 0; i < m_band.points.size(); ++i )
		{
			for ( unsigned side = 0; side < 2; ++side )
			{
				if ( std::fabs( passed - marks[side] ) < off[side] )
				{
					off[side] = std::fabs( passed - marks[side] );
					( side == 0 ? m_band.first : m_band.last ) = i;
				}
			}
			passed +=
			    i < m_band.edges.size() ? m_space.distance( m_band.points[i].q.data(), m_band.points[i + 1].q.data() ) : 0;
		}
	}

	/// @return false if nothing is to be done, or can be
	bool measureBefore()
	{
		const std::size_t end = m_band.points.size() - 1;
		bool proved = true; // that the path is free, by a margin of each kind
		for ( unsigned k = 0; k < kinds; ++k )
		{
			if ( isAsked( k ) )
			{
				ClearanceChange& c = change( k );
				c.middle_before = atLeastFree(
				    m_prover.enclose( m_band, k, m_band.first, m_band.last, m_cap[k], m_cap[k], 0, &m_low[k] ) );
				const ClearanceRange whole =
				    m_prover.enclose( m_band, k, 0, end, m_cap[k], std::min( c.middle_before.upper, m_cap[k] ), 0, nullptr );
				proved = proved && whole.lower > 0;
				c.before = atLeastFree( whole );
				c.middle_before.lower =
				    std::max( c.middle_before.lower, c.before.lower ); // the middle is a part of the whole
				c.after = c.before;
				c.middle_after = c.middle_before;
				c.ends = std::min( m_band.points.front().upper[k], m_band.points.back().upper[k] );
				m_first_score += score( k, c.middle_before );
			}
		}
		if ( status() == LW_OK && !proved )
		{
			m_status = areFree( m_checker, m_query, m_settings.edge, m_path, proved, &m_report.work );
		}
		if ( status() != LW_OK || !proved )
		{
			m_report.environment = m_report.self = {};
			m_report.notice = "the path is not proved free";
			return false;
		}
		m_best_score = m_first_score;
		dividePieces();
		m_best = m_band;
		return status() == LW_OK && !isReached();
	}

	/// A path whose margin is within the slack still is free.
	ClearanceRange atLeastFree( ClearanceRange range ) const
	{
		return { std::max( range.lower, m_settings.edge.min_d ), range.upper };
	}

	double score( unsigned kind, const ClearanceRange& middle ) const
	{
		return m_cap[kind] > 0 ? std::min( middle.lower / m_cap[kind], 1.0 ) : 1;
	}

	bool isReached()
	{
		bool all = true;
		for ( unsigned k = 0; k < kinds; ++k )
		{
			all = all && ( !isAsked( k ) || change( k ).middle_after.lower >= m_cap[k] );
		}
		return all;
	}

	void improve()
	{
		m_target = m_goal;
		for ( unsigned round = 0; round < m_settings.rounds && !isOver( m_push_end ) && !isReached(); ++round )
		{
			for ( unsigned s = 0; s < sweeps && !isOver( m_push_end ); ++s )
			{
				sweep();
			}
			judge();
			refine();
			if ( m_band.length( m_space ) > longest() )
			{
				shorten();
			}
		}
	}

	double longest() const { return ( 1 + m_settings.longer ) * m_report.length_before; }

	/// The band becomes the best one if all of its margins allow it.
	void judge()
	{
		if ( isOver( m_push_end ) || m_band.length( m_space ) > longest() )
		{
			return;
		}
		double sum = 0;
		ClearanceRange middle[kinds];
		for ( unsigned k = 0; k < kinds; ++k )
		{
			if ( isAsked( k ) )
			{
				m_low[k] = {};
				middle[k] = m_prover.enclose(
				    m_band, k, m_band.first, m_band.last, m_cap[k], m_cap[k], change( k ).middle_before.lower, &m_low[k] );
				const double floor = change( k ).middle_before.lower;
				middle[k] = floor <= m_settings.edge.min_d ? atLeastFree( middle[k] ) : middle[k];
				if ( middle[k].lower < floor || !keepsRest( k, middle[k] ) )
				{
					return;
				}
				sum += score( k, middle[k] );
			}
		}
		if ( !( sum > m_best_score * ( 1 + 1e-3 ) ) || status() != LW_OK )
		{
			return;
		}
		m_best = m_band;
		m_best_score = sum;
		for ( unsigned k = 0; k < kinds; ++k )
		{
			change( k ).middle_after = isAsked( k ) ? middle[k] : ClearanceRange();
		}
	}

	/// Beside the ends the band keeps the least clearance that the path had, and more if that is proved at once. Where no margin is proved, its
	/// edges are free as the caller asks.
	bool keepsRest( unsigned kind, const ClearanceRange& middle )
	{
		for ( std::size_t i = 0; i < m_band.edges.size(); ++i )
		{
			const bool outside = i < m_band.first || i >= m_band.last;
			const double least = std::max( outside ? change( kind ).before.lower : middle.lower, m_settings.edge.min_d );
			if ( !( outside && isEdgeKeptAtMost( i, kind, middle.upper, least ) ) && !isEdgeKept( i, kind, least ) )
			{
				m_low[kind] = { i, m_prover.failedAt() };
				return false;
			}
		}
		return true;
	}

	/// A few margins from the measured clearance down.
	bool isEdgeKeptAtMost( std::size_t i, unsigned kind, double upper, double least )
	{
		for ( Band::Point* point : { &m_band.points[i], &m_band.points[i + 1] } )
		{
			m_prover.measure( *point );
			upper = std::min( upper, point->upper[kind] );
		}
		for ( unsigned tries = 0; tries < 3; ++tries )
		{
			const double margin = MarginProver::marginBelow( upper, m_cap[kind], least );
			if ( margin < std::max( least, m_prover.lowest() ) )
			{
				return false;
			}
			if ( isEdgeKept( i, kind, margin ) )
			{
				return true;
			}
			upper = std::min( m_prover.failedClearance(), 0.9 * upper );
		}
		return false;
	}

	bool isEdgeKept( std::size_t i, unsigned kind, double margin )
	{
		Band::Edge& edge = m_band.edges[i];
		if ( edge.proved[kind] > 0 && edge.proved[kind] >= margin )
		{
			return true;
		}
		double proved = 0;
		if ( !m_prover.isFree( m_band.points[i].q.data(), m_band.points[i + 1].q.data(), kind, margin, HUGE_VAL, &proved ) )
		{
			return false;
		}
		edge.proved[kind] = std::max( proved, margin );
		return true;
	}

	bool touches( const std::vector<double>& q )
	{
		const std::array<double, kinds> upper = m_prover.clearances( q.data() );
		return !( std::min( upper[0], upper[1] ) > 0 );
	}

	/// A point more at the place that limits the clearance, unless a point is there.
	void refine()
	{
		for ( unsigned k = 0; k < kinds; ++k )
		{
			const LowPlace low = m_low[k];
			if ( low.t > 0.15 && low.t < 0.85 && m_band.points.size() < most_points && low.edge < m_band.edges.size() )
			{
				std::vector<double> q( m_space.size() );
				const double *a = m_band.points[low.edge].q.data(), *b = m_band.points[low.edge + 1].q.data();
				m_space.between( a, b, low.t, q.data() );
				for ( double t = low.t / 2; t > 0.02 && touches( q );
				      t /= 2 ) // only a state without contact knows a way out
				{
					m_space.between( a, b, t, q.data() );
				}
				m_band.insert( low.edge, q );
				m_low[1 - k] = {}; // its number may be another now
			}
		}
	}

	/// A band that is too long goes back towards the best one, which has its points but for those that came since.
	void shorten()
	{
		m_target = std::max( 0.7 * m_target, m_settings.edge.min_d );
		m_band = m_best;
		for ( Band::Point& point : m_band.points )
		{
			point.still = false;
		}
	}

	/// Pushes all points but the ends, the even ones first.
	void sweep()
	{
		const std::size_t end = m_band.points.size() - 1;
		std::vector<double> from_start( end + 1, 0.0 );
		for ( std::size_t i = 1; i <= end; ++i )
		{
			from_start[i] = from_start[i - 1] + m_space.distance( m_band.points[i - 1].q.data(), m_band.points[i].q.data() );
		}
		for ( const std::size_t begin : { 1u, 2u } )
		{
			for ( std::size_t i = begin; i < end && !isOver( m_push_end ); i += 2 )
			{
				if ( !( m_band.points[i].still && m_band.points[i - 1].still && m_band.points[i + 1].still ) )
				{
					push( i, from_start[i], from_start[end] - from_start[i] );
				}
			}
		}
		m_band.points.front().still = m_band.points.back().still = true;
	}

	/// Near an end the wanted clearance rises from that of the end.
	double wanted( unsigned kind, double from_start, double from_end ) const
	{
		const double room = approach * m_report.length_before, goal = std::min( m_target, m_cap[kind] );
		double least = goal;
		for ( const auto& [point, away] :
		    { std::pair{ &m_band.points.front(), from_start }, { &m_band.points.back(), from_end } } )
		{
			const double own = point->upper[kind];
			least = std::min( least, own + std::max( goal - own, 0.0 ) * std::min( away / room, 1.0 ) );
		}
		return overshoot * least;
	}

	void push( std::size_t i, double from_start, double from_end )
	{
		Band::Point& point = m_band.points[i];
		const double* before = m_band.points[i - 1].q.data();
		const double* after = m_band.points[i + 1].q.data();
		for ( std::size_t v = 0; v < m_space.size(); ++v )
		{
			const double back = m_space.difference( v, point.q[v], before[v] ),
			             on = m_space.difference( v, point.q[v], after[v] );
			m_step[v] = pull * 0.5 * ( back + on );
		}
		const double limit = longest_push * m_spacing;
		clip( m_step, limit );
		const std::array<double, kinds> want = { wanted( 0, from_start, from_end ), wanted( 1, from_start, from_end ) };
		if ( !resolve( point.q, want ) ) // it touches: halfway back
		{
			m_space.between( point.q.data(), point.good.data(), 0.5, m_trial.data() );
			m_band.move( i, m_trial );
			point.still = false;
			return;
		}
		point.good = point.q;
		clip( m_step, limit );
		for ( std::size_t v = 0; v < m_space.size(); ++v )
		{
			m_trial[v] = point.q[v] + m_step[v];
		}
		m_space.normalise( m_trial.data() );
		const double moved = m_space.distance( point.q.data(), m_trial.data() );
		point.still = moved < still * m_spacing;
		if ( moved > 0.1 * still * m_spacing )
		{
			m_band.move( i, m_trial );
		}
	}

	static void clip( std::vector<double>& step, double most )
	{
		double square = 0;
		for ( const double x : step )
		{
			square += x * x;
		}
		const double scale = square > most * most ? most / std::sqrt( square ) : 1;
		for ( double& x : step )
		{
			x *= scale;
		}
	}

	/// Adds the motion that the near pairs need to the step: step += G^T ( G G^T + eps )^-1 ( want - clearance - G step ), over the pairs that it leaves
	/// nearer than wanted.
	/// @return false if the state touches
	bool resolve( const std::vector<double>& q, const std::array<double, kinds>& want )
	{
		lw_near_def def = lw_near_def_default();
		def.flags = m_settings.edge.flags;
		def.distance = 1.3 * std::max( want[0], want[1] );
		def.alpha = near_alpha;
		def.derivatives = m_rows.data();
		if ( !( def.distance > 0 ) )
		{
			return true;
		}
		lw_near_pair pairs[most_rows];
		std::uint32_t count = 0;
		const lw_status status = lw_checker_near( m_checker, m_query, q.data(), &def, pairs, most_rows, &count );
		m_status = m_status == LW_OK ? status : m_status;
		++m_report.work.states;
		const std::size_t size = m_space.size();
		std::vector<const double*> rows;
		std::vector<double> needs;
		double mean = 0;
		for ( std::uint32_t r = 0; m_status == LW_OK && r < std::min( count, most_rows ); ++r )
		{
			if ( pairs[r].direction == LW_DIRECTION_NONE )
			{
				return false;
			}
			const double* row = m_rows.data() + r * size;
			const double square = dot( row, row ),
			             need = want[pairs[r].self] - pairs[r].clearance.upper - dot( row, m_step.data() );
			if ( need > 0 && square > weakest_row * weakest_row && need < std::sqrt( square ) * m_spacing )
			{
				rows.push_back( row );
				needs.push_back( need );
				mean += square;
			}
		}
		if ( rows.empty() )
		{
			return true;
		}
		solve( rows, needs, damping * mean / static_cast<double>( rows.size() ) );
		for ( std::size_t r = 0; r < rows.size(); ++r )
		{
			for ( std::size_t v = 0; v < size; ++v )
			{
				m_step[v] += needs[r] * rows[r][v];
			}
		}
		return true;
	}

	double dot( const double* a, const double* b ) const
	{
		double sum = 0;
		for ( std::size_t v = 0; v < m_space.size(); ++v )
		{
			sum += a[v] * b[v];
		}
		return sum;
	}

	/// x = ( G G^T + eps )^-1 x, by Cholesky: eps makes it positive definite.
	void solve( const std::vector<const double*>& rows, std::vector<double>& x, double eps ) const
	{
		const std::size_t n = rows.size();
		std::vector<double> l( n * n );
		for ( std::size_t i = 0; i < n; ++i )
		{
			for ( std::size_t j = 0; j <= i; ++j )
			{
				double sum = dot( rows[i], rows[j] ) + ( i == j ? eps : 0 );
				for ( std::size_t k = 0; k < j; ++k )
				{
					sum -= l[i * n + k] * l[j * n + k];
				}
				l[i * n + j] = i == j ? std::sqrt( sum ) : sum / l[j * n + j];
			}
			for ( std::size_t k = 0; k < i; ++k )
			{
				x[i] -= l[i * n + k] * x[k];
			}
			x[i] /= l[i * n + i];
		}
		for ( std::size_t i = n; i-- > 0; )
		{
			for ( std::size_t k = i + 1; k < n; ++k )
			{
				x[i] -= l[k * n + i] * x[k];
			}
			x[i] /= l[i * n + i];
		}
	}

	/// Joins neighbours of points that the reached margins do not need.
	void dropPoints()
	{
		Band& band = m_best;
		for ( std::size_t i = 1; i + 1 < band.points.size() && !isOver( m_drop_end ); )
		{
			const bool middle = i >= band.first && i <= band.last; // one of its edges is of the middle, or it bounds it
			Band::Edge joined;
			bool free = i != band.first && i != band.last &&
			            m_space.partCount( band.points[i - 1].q.data(), band.points[i + 1].q.data() ) == 1;
			for ( unsigned k = 0; k < kinds && free; ++k )
			{
				const double margin = middle
				                          ? change( k ).middle_after.lower
				                          : std::min( { m_cap[k], band.edges[i - 1].proved[k], band.edges[i].proved[k] } );
				free = !isAsked( k ) || m_prover.isFree( band.points[i - 1].q.data(), band.points[i + 1].q.data(), k,
				                            std::max( margin, m_settings.edge.min_d ), HUGE_VAL, &joined.proved[k] );
			}
			free ? band.drop( i, joined ) : void( ++i );
		}
	}

	/// The best band becomes the path if its edges are FREE as anybody would ask for them.
	void take()
	{
		Path path{ m_path.dimension, {} };
		for ( const Band::Point& point : m_best.points )
		{
			path.values.insert( path.values.end(), point.q.begin(), point.q.end() );
		}
		lw_query_reset( m_query );
		bool free = false;
		m_status = areFree( m_checker, m_query, m_settings.edge, path, free, &m_report.work );
		const double length = m_best.length( m_space );
		if ( status() != LW_OK || !free || length > longest() )
		{
			forget( "the better path is not proved at the path's own settings" );
			return;
		}
		for ( unsigned k = 0; k < kinds; ++k )
		{
			if ( isAsked( k ) )
			{
				change( k ).after = wholeOf( k );
			}
		}
		m_path = path;
		m_report.changed = true;
		m_report.length_after = length;
	}

	/// The least clearance of the best band: that of its middle and of the parts beside it.
	ClearanceRange wholeOf( unsigned kind )
	{
		const ClearanceChange& c = change( kind );
		ClearanceRange whole = c.middle_after;
		for ( std::size_t i = 0; i < m_best.edges.size(); ++i )
		{
			if ( i < m_best.first || i >= m_best.last )
			{
				for ( const std::size_t point : { i, i + 1 } )
				{
					m_prover.measure( m_best.points[point] );
					whole.upper = std::min( whole.upper, m_best.points[point].upper[kind] );
				}
				whole.lower = std::min( whole.lower, m_best.edges[i].proved[kind] );
			}
		}
		whole.lower = std::max( whole.lower, c.before.lower ); // keepsRest()
		return atLeastFree( whole );
	}

	void forget( const char* notice )
	{
		m_report.notice = notice;
		for ( unsigned k = 0; k < kinds; ++k )
		{
			change( k ).after = change( k ).before;
			change( k ).middle_after = change( k ).middle_before;
		}
	}

	const lw_checker* m_checker;
	lw_query* m_query;
	const ClearanceSettings& m_settings;
	Space m_space;
	MarginProver m_prover;
	Deadline m_push_end, m_drop_end;
	Path& m_path;
	ClearanceReport& m_report;
	const double m_goal;
	std::array<double, kinds> m_cap{}; ///< metres, of each kind: larger clearances gain nothing
	double m_target = 0, m_spacing = 1, m_first_score = 0, m_best_score = 0;
	Band m_band, m_best;
	LowPlace m_low[kinds];
	std::vector<double> m_rows, m_step, m_trial;
	lw_status m_status = LW_OK;
};

} // namespace

lw_status raiseClearance( const lw_checker* checker, lw_query* query, const ClearanceSettings& settings, const Stop& stop,
    Path& path, ClearanceReport* report )
{
	const auto need = []( bool condition, const char* sentence )
	{
		if ( !condition )
		{
			throw InputError( std::string( "leeway::planners: raiseClearance: " ) + sentence );
		}
	};
	need( path.dimension > 0 && path.dimension == lw_checker_variable_count( checker ) && path.count() > 0 &&
	          path.values.size() % path.dimension == 0,
	    "the path's dimension is not the checker's; give states of its group" );
	need( std::all_of( path.values.begin(), path.values.end(), []( double value ) { return std::isfinite( value ); } ),
	    "the path has a value that is not finite" );
	need( settings.goal > 0 && std::isfinite( settings.goal ), "goal must be finite and above 0" );
	need( settings.longer >= 0, "longer must be at least 0" );
	need( settings.seconds > 0, "seconds must be above 0" );
	Settings edges;
	edges.edge = settings.edge;
	requireUsable( edges );
	ClearanceReport unused;
	ClearanceReport& to = report != nullptr ? *report : unused;
	to = {};
	const auto begin = std::chrono::steady_clock::now();
	lw_query_reset( query );
	const lw_status status = Raiser( checker, query, settings, stop, path, to ).run();
	to.seconds = std::chrono::duration<double>( std::chrono::steady_clock::now() - begin ).count();
	return status;
}

} // namespace leeway::planners
