// SPDX-License-Identifier: BSD-3-Clause
// The widest tube that an edge is proved for, attacked from the inside.
#pragma once

#include "audit_fixture.hpp"

class TubeBench
{
public:
	TubeBench( const EdgeWorld& world, SeededRng& rng ) : m_world( world ), m_bench( world ), m_rng( rng )
	{
		for ( const std::uint32_t variable : world.variables )
		{
			const lw_variable_info info = lw_robot_variable( world.robot.get(), variable );
			const bool floating = lw_robot_joint_type( world.robot.get(), info.joint ) == LW_JOINT_FLOATING;
			m_quaternion.push_back( floating && info.component >= 3 );
		}
	}

	/// All motions between states in the tube, and single states of it that an enemy looks for.
	void judge( bool near )
	{
		const double lengths[] = { 0, 0.1, 0.5, 2, 4, 8 }; // long ones bend enough for interval batches
		const double length = lengths[m_rng.integer( 0, 5 )];
		Motion motion = m_world.randomMotion( near, length, m_rng.engine(), m_bench.audit.get() );
		std::vector<double> tolerance;
		for ( const bool quaternion : m_quaternion )
		{
			tolerance.push_back( quaternion || m_rng.integer( 0, 4 ) == 0 ? 0 : m_rng.decade( -3, -1 ) );
		}
		for ( const bool with_tables : { false, true } )
		{
			widen( motion, tolerance, with_tables );
		}
	}

	int free = 0, blocked = 0, undecided = 0;
	double nearest = INFINITY; ///< clearance of an attack less the bound that was proved

private:
	/// Attacks the widest tube of this shape that is still proved: a proof that forgets a part of it goes too far.
	void widen( const Motion& motion, std::vector<double> tolerance, bool with_tables )
	{
		lw_edge_def def = lw_edge_def_default();
		def.min_d = m_rng.integer( 0, 1 ) ? 0 : 1e-3;
		std::vector<double> proved;
		double lower_bound = 0, factor = 2;
		for ( int i = 0; i < 12; ++i )
		{
			def.tolerance = tolerance.data();
			lw_edge_result result;
			ASSERT_EQ( lw_checker_edge( with_tables ? m_world.with_tables.get() : m_world.checker.get(),
			               with_tables ? m_bench.tables.get() : m_bench.plain.get(), motion.from.data(), motion.to.data(),
			               &def, &result ),
			    LW_OK );
			blocked += result.verdict == LW_VERDICT_BLOCKED;
			undecided += result.verdict == LW_VERDICT_UNDECIDED;
			const bool is_free = result.verdict == LW_VERDICT_FREE;
			if ( is_free )
			{
				proved = tolerance;
				lower_bound = result.lower_bound;
			}
			if ( result.verdict == LW_VERDICT_BLOCKED || ( is_free && proved[0] > 4 ) )
			{
				break;
			}
			factor = i > 4 ? std::sqrt( factor ) : factor;
			for ( double& t : tolerance )
			{
				t *= is_free ? factor : 1 / factor;
			}
		}
		if ( !proved.empty() )
		{
			++free;
			attack( motion, proved, def.min_d, lower_bound );
		}
	}

	std::vector<double> moved( std::vector<double> q, const std::vector<double>& tolerance, double inward )
	{
		for ( std::size_t i = 0; i < q.size(); ++i )
		{
			q[i] +=
			    inward * tolerance[i] * ( m_rng.integer( 0, 1 ) ? m_rng.uniform( -1, 1 ) : m_rng.integer( 0, 1 ) * 2 - 1 );
		}
		return q;
	}

	void attack( const Motion& motion, const std::vector<double>& tolerance, double min_d, double lower_bound )
	{
		const double inward = 1 - 1e-9; // interpolation rounds
		const std::vector<double> from = m_world.full( motion.from ), to = m_world.full( motion.to );
		const EdgeAuditor::Look edge = m_bench.auditor.look( from.data(), to.data(), min_d );
		EXPECT_FALSE( edge.contact );
		for ( int i = 0; i < ( goesTheSameWay( motion, tolerance ) ? 3 : 0 ); ++i )
		{
			const std::vector<double> a = m_world.full( moved( motion.from, tolerance, inward ) );
			const std::vector<double> b = m_world.full( moved( motion.to, tolerance, inward ) );
			const EdgeAuditor::Look look = m_bench.auditor.look( a.data(), b.data(), min_d );
			EXPECT_FALSE( look.contact ) << m_world.name << ": a motion in the tube is in contact at " << look.t;
			EXPECT_GE( look.least, lower_bound - 1e-9 ) << m_world.name;
			nearest = std::min( nearest, look.least - lower_bound );
		}
		for ( int i = 0; i < 4; ++i )
		{
			enemy( from, to, i == 0 ? edge.t : m_rng.uniform( 0, 1 ), tolerance, min_d, lower_bound );
		}
	}

	/// False if an edge between moved ends may go round the other way.
	bool goesTheSameWay( const Motion& motion, const std::vector<double>& tolerance ) const
	{
		bool same = true;
		for ( std::size_t i = 0; i < tolerance.size(); ++i )
		{
			const bool wraps = lw_robot_variable( m_world.robot.get(), m_world.variables[i] ).wraps;
			const double way = std::abs( std::remainder( motion.to[i] - motion.from[i], 2 * M_PI ) );
			same = same && !( wraps && way + 2 * tolerance[i] > 3.1 );
		}
		return same;
	}

	/// The nearest state to contact that single joints find in turn.
	void enemy( const std::vector<double>& from, const std::vector<double>& to, double t,
	    const std::vector<double>& tolerance, double min_d, double lower_bound )
	{
		std::vector<double> q( from.size() );
		lw_robot_interpolate( m_world.robot.get(), from.data(), to.data(), t, q.data() );
		double least = m_bench.auditor.clearance( q.data() );
		for ( std::size_t i = 0; i < tolerance.size(); ++i )
		{
			const std::uint32_t variable = m_world.variables[i];
			const double middle = q[variable];
			double best = middle;
			for ( const double by : { -tolerance[i], tolerance[i] } )
			{
				q[variable] = middle + ( 1 - 1e-9 ) * by;
				const double clearance = m_bench.auditor.clearance( q.data() );
				best = clearance < least ? q[variable] : best;
				least = std::min( least, clearance );
			}
			q[variable] = best;
		}
		EXPECT_GT( least, min_d ) << m_world.name << ": a state of the tube at " << t << " is too near";
		EXPECT_GE( least, lower_bound - 1e-9 ) << m_world.name;
		nearest = std::min( nearest, least - lower_bound );
	}

	const EdgeWorld& m_world;
	AuditBench m_bench;
	SeededRng& m_rng;
	std::vector<bool> m_quaternion;
};
