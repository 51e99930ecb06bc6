// SPDX-License-Identifier: BSD-3-Clause
// A robot, a scene and a group in which edges are judged, and random edges of it.
#pragma once

#include "leeway/handles.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

/// An edge of a world: two states of its group.
struct Motion
{
	std::vector<double> from, to;
};

/// Margins that own their arrays.
struct EdgeMargins
{
	double environment = 0, self = 0;
	std::vector<double> links, self_links, objects; ///< empty, or one each
	std::vector<lw_pair_margin> pairs, self_pairs;  ///< each pair once, self pairs with their lower link first

	lw_margins def() const
	{
		lw_margins out = {};
		out.environment = environment;
		out.self = self;
		out.link_environment = links.empty() ? nullptr : links.data();
		out.link_self = self_links.empty() ? nullptr : self_links.data();
		out.object = objects.empty() ? nullptr : objects.data();
		out.environment_pairs = pairs.data();
		out.environment_pair_count = static_cast<std::uint32_t>( pairs.size() );
		out.self_pairs = self_pairs.data();
		out.self_pair_count = static_cast<std::uint32_t>( self_pairs.size() );
		return out;
	}

	double of( bool is_self, std::uint32_t link, std::uint32_t other ) const
	{
		const std::uint32_t a = is_self ? std::min( link, other ) : link, b = is_self ? std::max( link, other ) : other;
		for ( const lw_pair_margin& pair : is_self ? self_pairs : pairs )
		{
			if ( pair.a == a && pair.b == b )
			{
				return pair.margin;
			}
		}
		const auto part = []( const std::vector<double>& values, std::uint32_t i )
		{ return values.empty() ? 0 : values[i]; };
		return is_self ? self + part( self_links, a ) + part( self_links, b )
		               : environment + part( links, a ) + part( objects, b );
	}
};

struct EdgeWorld
{
	std::string set;  ///< worlds of one set are counted together
	std::string name; ///< unique
	leeway::Robot robot;
	leeway::Scene scene;         ///< may be empty
	leeway::Checker checker;     ///< without motion hulls and pair tables
	leeway::Checker with_tables; ///< with them
	std::vector<std::uint32_t> variables;
	std::vector<double> reference; ///< full state; joints outside the group stand there
	std::vector<lw_link_object_pair> allowed;
	EdgeMargins margins;
	/// Group states near which an edge starts, NAN = anywhere in the limits; empty = all anywhere.
	std::vector<std::vector<double>> anchors;
	double anchor_spread = 0.3;
	/// A free state. If given, edges start between it and a random state, mostly near it: in a narrow world few random
	/// states are free.
	std::vector<double> home;

	std::size_t size() const { return variables.size(); }

	std::vector<double> full( const std::vector<double>& q ) const
	{
		std::vector<double> out( lw_robot_variable_count( robot.get() ) );
		lw_checker_full_state( checker.get(), q.data(), out.data() );
		return out;
	}

	/// The state at t of a motion, as lw_robot_interpolate() defines it.
	std::vector<double> at( const Motion& motion, double t ) const
	{
		std::vector<double> a = full( motion.from );
		const std::vector<double> b = full( motion.to );
		lw_robot_interpolate( robot.get(), a.data(), b.data(), t, a.data() );
		return group( a );
	}

	/// Entries of the group of a full state.
	std::vector<double> group( const std::vector<double>& state ) const
	{
		std::vector<double> q;
		for ( const std::uint32_t variable : variables )
		{
			q.push_back( state[variable] );
		}
		return q;
	}

	lw_variable_info info( std::size_t i ) const { return lw_robot_variable( robot.get(), variables[i] ); }
	bool isRotation( std::size_t i ) const
	{
		return info( i ).component >= 3 && lw_robot_joint_type( robot.get(), info( i ).joint ) == LW_JOINT_FLOATING;
	}

	/// Parts into which OMPL's DiscreteMotionValidator cuts an edge in the space that leeway::ompl::makeStateSpace() makes:
	/// one RealVector if all variables are bounded numbers; otherwise the most that any of its parts asks for.
	unsigned segmentCount( const Motion& motion, double fraction ) const
	{
		double squared = 0, extent = 0, most = 0;
		bool plain = true;
		for ( std::size_t i = 0; i < size(); )
		{
			const lw_variable_info v = info( i );
			const lw_joint_type type = lw_robot_joint_type( robot.get(), v.joint );
			plain = plain && !v.wraps && type != LW_JOINT_PLANAR && type != LW_JOINT_FLOATING;
			const std::size_t numbers = type == LW_JOINT_FLOATING ? 3 : type == LW_JOINT_PLANAR && !v.wraps ? 2 : 1;
			double part = 0, part_extent = 0;
			for ( std::size_t k = i; k < i + numbers; ++k )
			{
				const double d = motion.to[k] - motion.from[k];
				const double difference = v.wraps ? std::abs( std::remainder( d, 2 * M_PI ) ) : std::abs( d );
				const double range = v.wraps ? M_PI : span( k ).second - span( k ).first;
				part += difference * difference;
				part_extent += range * range;
			}
			most = std::max( most, part_extent > 0 ? std::ceil( std::sqrt( part / part_extent ) / fraction ) : 0 );
			squared += part;
			extent += part_extent;
			i += numbers;
			if ( type == LW_JOINT_FLOATING )
			{
				double dot = 0;
				for ( std::size_t k = i; k < i + 4; ++k )
				{
					dot += motion.from[k] * motion.to[k];
				}
				most =
				    std::max( most, std::ceil( std::acos( std::min( 1.0, std::abs( dot ) ) ) / ( 0.5 * M_PI * fraction ) ) );
				i += 4;
			}
		}
		return static_cast<unsigned>( plain && extent > 0 ? std::ceil( std::sqrt( squared / extent ) / fraction ) : most );
	}

	/// From a random free state (near: within 50 mm of the environment, if such states can be found) in a random direction
	/// to a free state within the limits. Shorter where the limits leave no room for that length.
	Motion randomMotion( bool near, double length, std::mt19937_64& random, lw_query* query ) const
	{
		for ( int round = 0; round < 1000; ++round )
		{
			Motion motion;
			motion.from = randomStart( near, random, query );
			length *= round < 50 ? 1 : 0.7;
			for ( int attempt = 0; attempt < 20; ++attempt )
			{
				if ( stepFrom( motion.from, length, random, motion.to ) && isFree( motion.to, query ) )
				{
					return motion;
				}
			}
		}
		throw std::runtime_error( name + ": found no free edge" );
	}

	/// Is this state free, by leeway's checker?
	bool isFree( const std::vector<double>& q, lw_query* query ) const
	{
		bool free = false;
		leeway::require( lw_checker_is_free( checker.get(), query, q.data(), LW_CHECK_BOTH, 0, &free, nullptr ), "a state" );
		return free;
	}

	std::vector<double> randomState( std::mt19937_64& random ) const
	{
		std::vector<double> q( size() );
		for ( std::size_t i = 0; i < size(); ++i )
		{
			const auto [low, high] = span( i );
			q[i] = isRotation( i ) ? std::normal_distribution<double>()( random ) : low + uniform( random ) * ( high - low );
		}
		normalise( q );
		if ( !anchors.empty() )
		{
			const std::vector<double>& anchor = anchors[random() % anchors.size()];
			for ( std::size_t i = 0; i < size(); ++i )
			{
				if ( !std::isnan( anchor[i] ) )
				{
					const auto [low, high] = span( i );
					q[i] = std::min( high, std::max( low, anchor[i] + ( 2 * uniform( random ) - 1 ) * anchor_spread ) );
				}
			}
		}
		if ( !home.empty() )
		{
			q = at( { home, q }, std::pow( 10.0, -2 * uniform( random ) ) );
		}
		return q;
	}

	static double uniform( std::mt19937_64& random ) { return static_cast<double>( random() >> 11 ) * 0x1p-53; }

private:
	/// Limits, and 10 m where there are none; within 1 m for random states of such variables.
	std::pair<double, double> span( std::size_t i ) const
	{
		const lw_variable_info v = info( i );
		const double open = home.empty() ? 10 : 1;
		return { std::isfinite( v.lower ) ? v.lower : -open, std::isfinite( v.upper ) ? v.upper : open };
	}

	void normalise( std::vector<double>& q ) const
	{
		for ( std::size_t i = 0; i + 3 < size(); ++i )
		{
			if ( isRotation( i ) )
			{
				const double norm =
				    std::sqrt( q[i] * q[i] + q[i + 1] * q[i + 1] + q[i + 2] * q[i + 2] + q[i + 3] * q[i + 3] );
				for ( std::size_t k = i; k < i + 4; ++k )
				{
					q[k] /= norm;
				}
				i += 3;
			}
		}
	}

	std::vector<double> randomStart( bool near, std::mt19937_64& random, lw_query* query ) const
	{
		std::vector<double> any;
		for ( int attempt = 0; attempt < 100000; ++attempt )
		{
			const std::vector<double> q = randomState( random );
			const lw_range range = { 0, 0.05, 0 };
			lw_state_result result;
			leeway::require(
			    lw_checker_state( checker.get(), query, q.data(), LW_CHECK_BOTH, &range, false, &result ), "a state" );
			if ( result.verdict != LW_VERDICT_FREE )
			{
				continue;
			}
			any = q;
			if ( !near || result.environment.kind == LW_CLEARANCE_NEAR || attempt > 500 )
			{
				return any;
			}
		}
		throw std::runtime_error( name + ": found no free state" );
	}

	/// @return false if the end is outside of the limits
	bool stepFrom( const std::vector<double>& from, double length, std::mt19937_64& random, std::vector<double>& to ) const
	{
		std::normal_distribution<double> normal;
		std::vector<double> direction( size() );
		double squared = 0;
		for ( std::size_t i = 0; i < size(); ++i )
		{
			direction[i] = info( i ).lower < info( i ).upper || isRotation( i ) ? normal( random ) : 0;
			squared += direction[i] * direction[i];
		}
		to = from;
		for ( std::size_t i = 0; i < size(); ++i )
		{
			to[i] += direction[i] * length / std::sqrt( std::max( squared, 1e-300 ) ) * ( isRotation( i ) ? 0.5 : 1 );
			const lw_variable_info v = info( i );
			if ( v.wraps )
			{
				to[i] = std::remainder( to[i], 2 * M_PI );
			}
			else if ( !isRotation( i ) && !( to[i] >= v.lower && to[i] <= v.upper ) )
			{
				return false;
			}
		}
		normalise( to );
		return true;
	}
};
