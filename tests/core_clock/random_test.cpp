// SPDX-License-Identifier: BSD-3-Clause
// Random cells of one to four robots and a thing of unknown motion: FREE on the clock is attacked by lags, deviations and spreads.
#include "clock_world.hpp"
#include "random_world.hpp"
#include "sanitized.hpp"
#include "one_obstacle.hpp"

#include <gtest/gtest.h>

namespace
{

struct Cell
{
	RobotPtr robot;
	leeway::Scene scene;
	std::vector<std::vector<std::uint32_t>> parts; ///< variables of each
	std::vector<bool> floats; ///< its first three joints shift along x, y and z: a spread can be acted out
};

Cell randomCell( SeededRng& rng )
{
	Cell cell;
	RobotModel model;
	model.link( "world" );
	const int count = rng.integer( 1, 4 );
	for ( int p = 0; p < count; ++p )
	{
		const std::string name = "r" + std::to_string( p );
		model.joint( name, LW_JOINT_FIXED, 0 ).parent_from_joint = randomTransform( rng, 0.8 );
		cell.floats.push_back( rng.integer( 0, 2 ) == 0 );
		const int joints = cell.floats.back() ? 4 : rng.integer( 1, 3 );
		for ( int k = 0; k < joints; ++k )
		{
			static const lw_joint_type types[] = {
			    LW_JOINT_REVOLUTE, LW_JOINT_REVOLUTE, LW_JOINT_CONTINUOUS, LW_JOINT_PRISMATIC, LW_JOINT_PLANAR };
			const bool shift = cell.floats.back() && k < 3;
			lw_joint_def& joint = model.joint( name + "_" + std::to_string( k ),
			    shift ? LW_JOINT_PRISMATIC : types[rng.integer( 0, cell.floats.back() ? 2 : 4 )],
			    static_cast<std::uint32_t>( model.linkNames.size() - 1 ) );
			for ( int a = 0; a < 3; ++a )
			{
				joint.axis[a] = shift ? ( a == k ? 1 : 0 ) : rng.uniform( -1, 1 );
			}
			if ( !shift )
			{
				joint.parent_from_joint = randomTransform( rng, 0.2 );
			}
			if ( !cell.floats.back() || k == joints - 1 )
			{
				lw_shape* shape =
				    rng.integer( 0, 1 ) ? randomMesh( rng, 6, 0.12, nullptr ) : randomPrimitive( rng, 0.12, nullptr );
				model.body( static_cast<std::uint32_t>( model.linkNames.size() - 1 ), shape, randomTransform( rng, 0.1 ) );
			}
		}
	}
	for ( std::uint32_t j = 0; j < model.joints.size(); ++j ) // neighbours may touch
	{
		model.allowed.push_back( { model.joints[j].parent, model.joints[j].child } );
	}
	cell.robot = model.create();
	cell.parts.resize( static_cast<std::size_t>( count ) );
	std::uint32_t variable = 0;
	int part = -1;
	for ( std::size_t j = 0; j < model.joints.size(); ++j )
	{
		part += model.joints[j].type == LW_JOINT_FIXED;
		const std::uint32_t own = model.joints[j].type == LW_JOINT_FIXED    ? 0
		                          : model.joints[j].type == LW_JOINT_PLANAR ? 3
		                                                                    : 1;
		for ( std::uint32_t v = 0; v < own; ++v )
		{
			cell.parts[static_cast<std::size_t>( part )].push_back( variable++ );
		}
	}
	const ShapePtr soup( randomMesh( rng, 30, 0.3, nullptr ) );
	lw_transform place = randomTransform( rng, 1 );
	place.t[2] += rng.integer( 0, 1 ) * 50; // half of the robots have only each other
	cell.scene = oneObstacle( soup.get(), place );
	return cell;
}

OwnedTrack randomTrack( const std::vector<std::uint32_t>& variables, double step, SeededRng& rng )
{
	OwnedTrack track;
	track.variables = variables;
	const std::size_t n = variables.size();
	std::vector<double> at( n );
	for ( double& v : at )
	{
		v = rng.uniform( -1, 1 );
	}
	double time = rng.uniform( -1, 1 );
	const int count = rng.integer( 1, 4 );
	for ( int i = 0; i < count; ++i )
	{
		OwnedPiece piece = { time, time + rng.uniform( 0.1, 1.5 ), static_cast<unsigned>( rng.integer( 0, 5 ) ), at };
		for ( unsigned k = 0; k < piece.degree; ++k )
		{
			for ( double& v : at )
			{
				v += step * rng.uniform( -1, 1 );
			}
			piece.points.insert( piece.points.end(), at.begin(), at.end() );
		}
		time = piece.end + ( rng.integer( 0, 1 ) ? 0 : rng.uniform( 0, 0.5 ) );
		track.pieces.push_back( piece );
	}
	return track;
}

/// All that a clock allows to happen at a time: one moment of it.
class Enemy
{
public:
	Enemy( const Cell& cell, const OwnedClock& clock, SeededRng& rng )
	    : m_clock( clock ), m_rng( rng ), m_reference( clock.rest.size(), 0.0 ),
	      m_auditor( cell.robot.get(), cell.scene.get(), allOf( clock.rest.size() ), m_reference.data() )
	{
	}

	/// The least clearance found between two times.
	double attack( double start, double end )
	{
		Moment best = random( start, end );
		double least = clearance( best );
		for ( int i = 0; i < 60; ++i )
		{
			const Moment other = random( start, end );
			const double found = clearance( other );
			best = found < least ? other : best;
			least = std::min( least, found );
		}
		for ( double size = 0.5; size > 1e-4; size *= 0.8 )
		{
			Moment other = near( best, size, start, end );
			const double found = clearance( other );
			best = found < least ? other : best;
			least = std::min( least, found );
		}
		where = best.time;
		return least;
	}

	/// Of the tracks themselves.
	double nominal( double time )
	{
		return clearance( { time, std::vector<double>( 4 * m_clock.tracks.size() + m_clock.rest.size(), 0.0 ) } );
	}

	double where = 0;

private:
	struct Moment
	{
		double time;
		std::vector<double> shares; ///< of -1 to 1: four for each track (lag, three of the spread), one for each variable
	};

	static std::vector<std::uint32_t> allOf( std::size_t count )
	{
		std::vector<std::uint32_t> all;
		for ( std::uint32_t i = 0; i < count; ++i )
		{
			all.push_back( i );
		}
		return all;
	}

	double share() { return m_rng.integer( 0, 1 ) ? m_rng.uniform( -1, 1 ) : m_rng.integer( 0, 1 ) * 2 - 1; }

	Moment random( double start, double end )
	{
		Moment moment = { m_rng.uniform( start, end ), {} };
		moment.shares.resize( 4 * m_clock.tracks.size() + m_clock.rest.size() );
		for ( double& s : moment.shares )
		{
			s = share();
		}
		return moment;
	}

	Moment near( Moment moment, double size, double start, double end )
	{
		moment.time = std::clamp( moment.time + 0.1 * size * ( end - start ) * m_rng.uniform( -1, 1 ), start, end );
		for ( double& s : moment.shares )
		{
			s = std::clamp( s + size * m_rng.uniform( -1, 1 ), -1.0, 1.0 );
		}
		return moment;
	}

	double clearance( const Moment& moment )
	{
		std::vector<double> q = m_clock.rest;
		const double inward = 1 - 1e-9;
		for ( std::size_t t = 0; t < m_clock.tracks.size(); ++t )
		{
			const OwnedTrack& track = m_clock.tracks[t];
			const double* shares = &moment.shares[4 * t];
			const double length =
			    std::max( 1.0, std::sqrt( shares[1] * shares[1] + shares[2] * shares[2] + shares[3] * shares[3] ) );
			for ( std::size_t i = 0; i < track.variables.size(); ++i )
			{
				const double off = track.tolerance.empty() ? 0 : track.tolerance[i];
				q[track.variables[i]] = track.at( i, moment.time + inward * shares[0] * track.lag ) +
				                        inward * off * moment.shares[4 * m_clock.tracks.size() + track.variables[i]];
				if ( track.spread_speed > 0 && i < 3 )
				{
					q[track.variables[i]] += inward * track.spread( moment.time ) * shares[1 + i] / length;
				}
			}
		}
		return m_auditor.clearance( q.data() );
	}

	const OwnedClock& m_clock;
	SeededRng& m_rng;
	std::vector<double> m_reference;
	EdgeAuditor m_auditor;
};

struct Tally
{
	int free = 0, blocked = 0, undecided = 0, by_spread = 0;
};

void judge( const Cell& cell, const ClockBench& bench, SeededRng& rng, Tally& tally )
{
	OwnedClock clock;
	clock.rest.assign( lw_robot_variable_count( cell.robot.get() ), 0.0 );
	for ( double& v : clock.rest )
	{
		v = rng.uniform( -1, 1 );
	}
	const double step = rng.decade( -2, -0.3 );
	for ( std::size_t p = 0; p < cell.parts.size(); ++p )
	{
		if ( rng.integer( 0, 5 ) > 0 ) // else it rests
		{
			clock.tracks.push_back( randomTrack( cell.parts[p], step, rng ) );
			OwnedTrack& track = clock.tracks.back();
			track.lag = rng.integer( 0, 1 ) ? rng.decade( -3, -1 ) : 0;
			for ( std::size_t i = 0; i < track.variables.size() && rng.integer( 0, 2 ) == 0; ++i )
			{
				track.tolerance.resize( track.variables.size(), 0.0 );
				track.tolerance[i] = rng.decade( -4, -2 );
			}
			track.spread_speed = cell.floats[p] && rng.integer( 0, 1 ) ? rng.decade( -2, 0 ) : 0;
			track.spread_start = rng.uniform( -1, 1 );
		}
	}
	const double start = rng.uniform( -1.5, 2 ), end = start + rng.decade( -1, 0.6 );
	lw_timed_def def = lw_timed_def_default();
	def.edge.min_d = rng.integer( 0, 1 ) ? 0 : 1e-3;
	def.edge.want_proved_until = rng.integer( 0, 1 );
	def.contact_resolution = rng.integer( 0, 1 ) ? 1e-3 : 0;
	// wider and wider; the last proof is attacked: it leaves the least room
	OwnedClock proved;
	double bound = 0;
	for ( int i = 0; i < 12; ++i )
	{
		const lw_timed_result r = bench.ask( clock, start, end, def );
		tally.free += r.verdict == LW_VERDICT_FREE;
		tally.blocked += r.verdict == LW_VERDICT_BLOCKED;
		tally.undecided += r.verdict == LW_VERDICT_UNDECIDED;
		tally.by_spread += r.by_spread;
		if ( r.verdict != LW_VERDICT_FREE )
		{
			Enemy enemy( cell, clock, rng );
			const double here = enemy.nominal( r.time );
			if ( r.verdict == LW_VERDICT_BLOCKED && !r.by_spread )
			{
				EXPECT_LE( here, def.edge.min_d + 1e-9 );
			}
			double spread = 0;
			for ( const OwnedTrack& track : clock.tracks )
			{
				spread += track.spread( r.time );
			}
			EXPECT_TRUE( !r.by_spread || here <= def.edge.min_d + spread + 1e-9 );
			if ( r.proved_until > start )
			{
				EXPECT_GT( enemy.attack( start, r.proved_until ), def.edge.min_d - 1e-9 )
				    << "proved until " << r.proved_until << ", too near at " << enemy.where;
			}
			break;
		}
		proved = clock;
		bound = r.lower_bound;
		for ( OwnedTrack& track : clock.tracks )
		{
			track.lag *= 1.7;
			track.spread_speed *= 1.7;
			for ( double& e : track.tolerance )
			{
				e *= 1.7;
			}
		}
	}
	if ( !proved.rest.empty() )
	{
		Enemy enemy( cell, proved, rng );
		EXPECT_GE( enemy.attack( start, end ), bound - 1e-9 ) << "FREE is wrong at " << enemy.where;
	}
}

} // namespace

TEST( ClockCells, FreeSurvivesLagsDeviationsAndSpreads )
{
	SeededRng rng;
	Tally tally;
	for ( int i = 0; i < unlessSanitized( 150, 10 ); ++i )
	{
		const Cell cell = randomCell( rng );
		const ClockBench bench( cell.robot.get(), cell.scene.get(), i % 2 == 0 );
		for ( int k = 0; k < 8; ++k )
		{
			judge( cell, bench, rng, tally );
		}
	}
	std::printf(
	    "%d free, %d blocked (%d by spread), %d undecided\n", tally.free, tally.blocked, tally.by_spread, tally.undecided );
	EXPECT_GT( tally.free, 20 );
	EXPECT_GT( tally.blocked, unlessSanitized( 20, 1 ) );
	EXPECT_GT( tally.by_spread, unlessSanitized( 5, -1 ) );
}
