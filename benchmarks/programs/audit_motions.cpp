// SPDX-License-Identifier: BSD-3-Clause
// Who calls a curve, a motion near an edge, or a rounded corner free that is not? The twin of audit-edges for motions that are no straight
// edges: random Bezier curves, tubes around edges and curves, and paths with roundings are proved, and attacked by states of
// them that a query without tables measures. README.md describes it.
#include "edge_auditor.hpp"
#include "leeway/motions/roundings.hpp"
#include "programs/commands.hpp"
#include "support/edge_worlds.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <thread>

namespace
{

using State = std::vector<double>;

struct Settings
{
	std::string data = LEEWAY_DATA_DIR, only, robot, scene;
	std::size_t motions = 2000;
	unsigned threads = 1, states = 200;
	double budget = 2, minutes = 1e9;
	std::uint64_t seed = 20260101;
};

constexpr double rounding = 1e-9; // metres, granted to the clearance of a state computed in another way

enum Kind
{
	CURVE,
	TUBE,
	ROUNDED,
	KINDS
};
constexpr std::array<const char*, KINDS> names = { "curves", "tubes", "rounded corners" };

struct Tally
{
	std::size_t motions = 0, free = 0, blocked = 0, undecided = 0, wrong = 0, states = 0;
	void add( const Tally& o )
	{
		motions += o.motions;
		free += o.free;
		blocked += o.blocked;
		undecided += o.undecided;
		wrong += o.wrong;
		states += o.states;
	}
};

State combined( const State& a, double s, const State& b, double t )
{
	State out = a;
	for ( std::size_t i = 0; i < a.size(); ++i )
	{
		out[i] = s * a[i] + t * b[i];
	}
	return out;
}

double lengthOf( const State& v )
{
	double sum = 0;
	for ( const double x : v )
	{
		sum += x * x;
	}
	return std::sqrt( sum );
}

/// By Bernstein polynomials, not by de Casteljau.
State bezier( const std::vector<State>& points, double t )
{
	const std::size_t n = points.size() - 1;
	State out( points[0].size(), 0.0 );
	double binomial = 1;
	for ( std::size_t i = 0; i <= n; ++i )
	{
		out = combined( out, 1, points[i], binomial * std::pow( t, double( i ) ) * std::pow( 1 - t, double( n - i ) ) );
		binomial *= static_cast<double>( n - i ) / static_cast<double>( i + 1 );
	}
	return out;
}

/// One thread in one world.
class Seat
{
public:
	Seat( const EdgeWorld& world, std::uint64_t seed, unsigned states )
	    : m_world( world ), m_random( seed ), m_states( states ), m_plain( leeway::makeQuery( world.checker.get() ) ),
	      m_tables( leeway::makeQuery( world.with_tables.get() ) ), m_attacker( leeway::makeQuery( world.checker.get() ) ),
	      m_spare( leeway::makeQuery( world.checker.get() ) )
	{
	}

	/// @return why a verdict is wrong; empty if it is not
	std::string judge( Kind kind, Tally& tally )
	{
		m_def = lw_edge_def_default();
		m_def.min_d = uniform( 0, 1 ) < 0.5 ? 0 : 1e-3;
		m_with_tables = uniform( 0, 1 ) < 0.5;
		m_wrong.clear();
		m_tolerance.assign( m_world.size(), 0.0 );
		if ( kind == TUBE || uniform( 0, 1 ) < 0.3 )
		{
			for ( std::size_t i = 0; i < m_world.size(); ++i )
			{
				m_tolerance[i] = m_world.isRotation( i ) ? 0 : decade( -4, kind == TUBE ? -1.3 : -2 );
			}
			m_def.tolerance = m_tolerance.data();
		}
		const double lengths[] = { 0.1, 0.5, 2 };
		const Motion motion =
		    m_world.randomMotion( uniform( 0, 1 ) < 0.7, lengths[m_random() % 3], m_random, m_spare.get() );
		++tally.motions;
		kind == ROUNDED ? judgePath( motion, tally )
		                : judgeCurve( motion, kind == TUBE ? 1 + m_random() % 2 : 2 + m_random() % 4, tally );
		tally.wrong += !m_wrong.empty();
		return m_wrong;
	}

private:
	double uniform( double low, double high ) { return std::uniform_real_distribution<double>( low, high )( m_random ); }
	double decade( double low, double high ) { return std::pow( 10, uniform( low, high ) ); }
	const lw_checker* checker() const { return m_with_tables ? m_world.with_tables.get() : m_world.checker.get(); }
	lw_query* query() { return m_with_tables ? m_tables.get() : m_plain.get(); }

	void count( lw_verdict verdict, Tally& tally )
	{
		tally.free += verdict == LW_VERDICT_FREE;
		tally.blocked += verdict == LW_VERDICT_BLOCKED;
		tally.undecided += verdict == LW_VERDICT_UNDECIDED;
	}

	void judgeCurve( const Motion& motion, std::size_t degree, Tally& tally )
	{
		const double length = lengthOf( combined( motion.to, 1, motion.from, -1 ) ), bend = decade( -2, 0 ) * length;
		std::vector<State> points;
		std::vector<double> flat;
		for ( std::size_t k = 0; k <= degree; ++k )
		{
			const double t = static_cast<double>( k ) / static_cast<double>( degree );
			points.push_back( combined( motion.from, 1 - t, motion.to, t ) );
			for ( std::size_t i = 0; i < m_world.size(); ++i )
			{
				points[k][i] = m_world.isRotation( i ) ? motion.from[i]
				               : k == 0 || k == degree ? points[k][i]
				                                       : points[k][i] + uniform( -bend, bend );
			}
			flat.insert( flat.end(), points[k].begin(), points[k].end() );
		}
		lw_edge_result result;
		leeway::require(
		    lw_checker_curve( checker(), query(), flat.data(), static_cast<std::uint32_t>( degree ), &m_def, &result ),
		    "a curve" );
		count( result.verdict, tally );
		if ( result.verdict == LW_VERDICT_BLOCKED && clearance( bezier( points, result.t ) ) > m_def.min_d + rounding )
		{
			m_wrong = "BLOCKED where it is free";
		}
		const double until = result.verdict == LW_VERDICT_FREE ? 1 : 0;
		for ( unsigned k = 0; until > 0 && k < m_states && m_wrong.empty(); ++k )
		{
			attack( bezier( points, ( k + uniform( 0, 1 ) ) / m_states ), result.lower_bound, k, tally );
		}
	}

	void judgePath( const Motion& motion, Tally& tally )
	{
		const Motion next =
		    m_world.randomMotion( false, lengthOf( combined( motion.to, 1, motion.from, -1 ) ), m_random, m_spare.get() );
		std::vector<State> path = {
		    motion.from, motion.to, combined( motion.to, 1, combined( next.to, 1, next.from, -1 ), 1 ) };
		for ( std::size_t i = 0; i < m_world.size(); ++i )
		{
			path[1][i] = m_world.isRotation( i ) ? path[0][i] : path[1][i];
			path[2][i] = m_world.isRotation( i ) ? path[0][i] : path[2][i];
		}
		const double radius = decade( -2.5, -0.5 );
		leeway::motions::RoundingProof proof;
		leeway::require( leeway::motions::proveRoundings( checker(), query(), path, radius, m_def, proof ), "a path" );
		count( proof.verdict, tally );
		if ( proof.verdict == LW_VERDICT_BLOCKED && clearance( proof.q ) > m_def.min_d + rounding )
		{
			m_wrong = "BLOCKED where it is free";
		}
		const State in = combined( path[1], 1, path[0], -1 ), out = combined( path[2], 1, path[1], -1 );
		const double length_in = lengthOf( in ), length_out = lengthOf( out );
		// of a corner that is not free the largest radius that was found to be
		const bool is_free = proof.verdict == LW_VERDICT_FREE;
		const double deepest = is_free ? radius : proof.on_edge ? 0 : proof.free_radius;
		const double bound = is_free ? proof.lower_bound : m_def.min_d;
		if ( !( deepest > 0 && length_in > 0 && length_out > 0 ) )
		{
			return;
		}
		const State y1 = combined( in, 1 / length_in, in, 0 ), y2 = combined( out, 1 / length_out, out, 0 );
		const double sine = 0.5 * lengthOf( combined( y2, 1, y1, -1 ) ), half = 0.5 * std::min( length_in, length_out );
		for ( unsigned k = 0; k < m_states && m_wrong.empty(); ++k )
		{
			// a parabola that passes the corner by the radius, or nearer
			const double cut = uniform( 0.3, 1 ) * ( 1 - 1e-9 ) * std::min( half, 2 * deepest / sine );
			const std::vector<State> corner = { combined( path[1], 1, y1, -cut ), path[1], combined( path[1], 1, y2, cut ) };
			attack( bezier( corner, uniform( 0, 1 ) ), bound, k, tally );
		}
	}

	double clearance( const State& q )
	{
		lw_state_result state;
		leeway::require(
		    lw_checker_state( m_world.checker.get(), m_attacker.get(), q.data(), LW_CHECK_BOTH, nullptr, false, &state ),
		    "a state" );
		return std::min( state.environment.upper, state.self.upper );
	}

	/// A state of the motion, or a corner of the tube around it.
	void attack( State q, double bound, unsigned k, Tally& tally )
	{
		for ( std::size_t i = 0; i < q.size() && k % 3 != 0; ++i )
		{
			q[i] += ( 1 - 1e-9 ) * m_tolerance[i] * ( m_random() % 2 == 0 ? 1 : -1 );
		}
		++tally.states;
		bool free = false;
		leeway::require( lw_checker_is_free(
		                     m_world.checker.get(), m_attacker.get(), q.data(), LW_CHECK_BOTH, m_def.min_d, &free, nullptr ),
		    "a state" );
		const bool exact = !free || k % 32 == 0;
		const double least = exact ? clearance( q ) : INFINITY;
		if ( !( least > m_def.min_d - rounding ) || least < bound - rounding )
		{
			// a second opinion that knows no checker
			EdgeAuditor auditor(
			    m_world.robot.get(), m_world.scene.get(), m_world.variables, m_world.reference.data(), m_world.allowed );
			const double truth = auditor.clearance( m_world.full( q ).data() );
			m_wrong = truth < std::max( m_def.min_d, bound ) - rounding
			              ? "FREE, but the clearance is " + std::to_string( truth )
			              : "";
		}
	}

	const EdgeWorld& m_world;
	std::mt19937_64 m_random;
	unsigned m_states;
	leeway::Query m_plain, m_tables, m_attacker, m_spare;
	lw_edge_def m_def = lw_edge_def_default();
	bool m_with_tables = false;
	State m_tolerance;
	std::string m_wrong;
};

class Audit
{
public:
	explicit Audit( const Settings& settings )
	    : m_settings( settings ), m_worlds( settings.data, reachDef( settings.budget ) )
	{
		const auto wanted = [&]( const std::string& set )
		{ return settings.robot.empty() && set.find( settings.only ) != std::string::npos; };
		for ( const char* group : { "right_arm", "torso_right_arm" } )
		{
			addSet( wanted( std::string( "armar3 " ) + group ), [&] { m_worlds.addArmar( group, { 1, 7 } ); } );
		}
		addSet( wanted( "fetch arm_with_torso" ), [&] { m_worlds.addMbm( "fetch", "arm_with_torso", { 1 } ); } );
		addSet( wanted( "panda panda_arm" ), [&] { m_worlds.addMbm( "panda", "panda_arm", { 1 } ); } );
		addSet( wanted( "random robots" ),
		    [&] { m_worlds.addRandom( settings.seed, std::max<std::size_t>( 20, settings.motions / 2000 ) ); } );
		if ( !settings.robot.empty() )
		{
			const std::size_t first = settings.robot.find( ',' ), second = settings.robot.find( ',', first + 1 );
			if ( second == std::string::npos )
			{
				throw std::runtime_error( "--robot " + settings.robot + ": give URDF,SRDF,GROUP; GROUP may be empty" );
			}
			const std::string name = settings.robot.substr( 0, first ), group = settings.robot.substr( second + 1 );
			Json source = { { "set", name.substr( name.rfind( '/' ) + 1 ) }, { "name", name }, { "robot", name },
			    { "srdf", settings.robot.substr( first + 1, second - first - 1 ) } };
			if ( !group.empty() )
			{
				source["group"] = group;
			}
			if ( !settings.scene.empty() )
			{
				source["scene"] = settings.scene;
			}
			m_sets.clear();
			addSet( true, [&] { m_worlds.add( source ); } );
		}
		if ( m_sets.empty() )
		{
			throw std::runtime_error( "--only " + settings.only + ": no set of worlds has that in its name" );
		}
	}

	int run( Result& result )
	{
		const auto start = std::chrono::steady_clock::now();
		const auto seconds = [&]
		{ return std::chrono::duration<double>( std::chrono::steady_clock::now() - start ).count(); };
		std::vector<std::thread> threads;
		for ( unsigned i = 0; i < m_settings.threads; ++i )
		{
			threads.emplace_back( [this, &seconds] { work( seconds ); } );
		}
		for ( std::thread& thread : threads )
		{
			thread.join();
		}
		if ( !m_error.empty() )
		{
			throw std::runtime_error( m_error );
		}
		return report( seconds(), result );
	}

private:
	static lw_reach_def reachDef( double seconds )
	{
		lw_reach_def def = lw_reach_def_default();
		def.seconds = seconds;
		return def;
	}

	template <typename Add> void addSet( bool wanted, const Add& add )
	{
		const std::size_t before = m_worlds.size();
		if ( !wanted )
		{
			return;
		}
		add();
		m_sets.emplace_back();
		for ( std::size_t i = before; i < m_worlds.size(); ++i )
		{
			m_sets.back().push_back( i );
		}
	}

	/// Some motions in a row in one world, so that queries remember earlier ones.
	template <typename Seconds> void work( const Seconds& seconds )
	{
		constexpr std::size_t row = 100;
		try
		{
			for ( std::size_t first;
			      ( first = m_next.fetch_add( row ) ) < m_settings.motions && seconds() < 60 * m_settings.minutes; )
			{
				const std::vector<std::size_t>& set = m_sets[first / row % m_sets.size()];
				const EdgeWorld& world = m_worlds.world( set[first / row / m_sets.size() % set.size()] );
				Seat seat( world, m_settings.seed + first, m_settings.states );
				std::array<Tally, KINDS> tallies;
				for ( std::size_t i = first; i < std::min( first + row, m_settings.motions ); ++i )
				{
					const auto kind = static_cast<Kind>( i % KINDS );
					const std::string wrong = seat.judge( kind, tallies[kind] );
					if ( !wrong.empty() )
					{
						const std::lock_guard<std::mutex> lock( m_mutex );
						std::printf( "WRONG: %s, %s, row %zu, motion %zu: %s\n", world.name.c_str(), names[kind], first, i,
						    wrong.c_str() );
					}
				}
				const std::lock_guard<std::mutex> lock( m_mutex );
				for ( std::size_t kind = 0; kind < KINDS; ++kind )
				{
					m_tallies[world.set][kind].add( tallies[kind] );
				}
			}
		}
		catch ( const std::exception& error )
		{
			const std::lock_guard<std::mutex> lock( m_mutex );
			m_error = error.what();
		}
	}

	int report( double seconds, Result& result )
	{
		std::printf( "%-28s %-16s %8s %8s %8s %9s %6s %10s\n", "", "", "motions", "free", "blocked", "undecided", "wrong",
		    "attacked" );
		std::size_t wrong = 0, motions = 0;
		for ( const auto& [set, tallies] : m_tallies )
		{
			for ( std::size_t kind = 0; kind < KINDS; ++kind )
			{
				const Tally& t = tallies[kind];
				std::printf( "%-28s %-16s %8zu %8zu %8zu %9zu %6zu %10zu\n", set.c_str(), names[kind], t.motions, t.free,
				    t.blocked, t.undecided, t.wrong, t.states );
				result.add( { { "set", set }, { "kind", names[kind] }, { "motions", t.motions }, { "free", t.free },
				    { "blocked", t.blocked }, { "undecided", t.undecided }, { "wrong", t.wrong }, { "states", t.states } } );
				wrong += t.wrong;
				motions += t.motions;
			}
		}
		std::printf( "%zu motions, %zu wrong, %.0f s\n", motions, wrong, seconds );
		result["motions"] = motions;
		result["wrong"] = wrong;
		return wrong > 0 ? 1 : 0;
	}

	const Settings& m_settings;
	EdgeWorlds m_worlds;
	std::vector<std::vector<std::size_t>> m_sets;
	std::atomic<std::size_t> m_next{ 0 };
	std::mutex m_mutex; ///< of all below
	std::map<std::string, std::array<Tally, KINDS>> m_tallies;
	std::string m_error;
};

} // namespace

void addAuditMotions( Bench& bench )
{
	const auto s = std::make_shared<Settings>();
	Command& command =
	    bench.command( "audit-motions", "who calls a curve, a motion near an edge, or a rounded corner free that is not?" );
	command.option( "--data", s->data, "folder of robots and scenes" );
	command.option( "--only", s->only, "only sets of worlds with this in their name, such as 'panda' or 'random'" );
	command.option( "--robot", s->robot, "URDF,SRDF,GROUP: this robot instead; no GROUP is all joints" );
	command.inputFile( "--scene", s->scene, "with --robot: planning scene" );
	command.option( "--count", s->motions, "how many motions to judge" );
	command.option( "--states", s->states, "of each free one that are attacked", { 1 } );
	command.option( "--minutes", s->minutes, "after which no more are judged", POSITIVE );
	command.option( "--budget", s->budget, "seconds for pair proofs, per robot" );
	command.option( "--threads", s->threads, "that judge", { 1, 64 } );
	command.option( "--seed", s->seed, "of the motions" );
	command.work(
	    [s]( Result& result )
	    {
		    requireData( s->data, "mbm" );
		    return Audit( *s ).run( result );
	    } );
}
