// SPDX-License-Identifier: BSD-3-Clause
// Random worlds for tests of near pairs, and the call with its buffers.
#pragma once

#include "random_world.hpp"

#include "leeway/near.h"

#include <gtest/gtest.h>

#include <map>

/// The rows of one call.
struct NearRows
{
	lw_status status = LW_OK;
	std::uint32_t total = 0;
	std::vector<lw_near_pair> rows;
	std::vector<double> derivatives; ///< [rows][variables]
	std::vector<double> links;
};

inline NearRows nearPairs( const lw_checker* checker, lw_query* query, const std::vector<double>& q, lw_near_def def,
    std::uint32_t capacity = 4096 )
{
	NearRows out;
	const std::uint32_t variables = lw_checker_variable_count( checker );
	out.rows.resize( capacity );
	out.derivatives.resize( std::size_t( capacity ) * variables );
	out.links.resize( lw_robot_link_count( lw_checker_robot( checker ) ) );
	def.derivatives = out.derivatives.data();
	def.link_clearance = out.links.data();
	out.status = lw_checker_near( checker, query, q.data(), &def, out.rows.data(), capacity, &out.total );
	out.rows.resize( std::min( capacity, out.total ) );
	out.derivatives.resize( out.rows.size() * variables );
	return out;
}

inline leeway::Query queryOf( const lw_checker* checker, bool warm_start = true )
{
	lw_query_def def = lw_query_def_default();
	def.warm_start = warm_start;
	lw_query* query = nullptr;
	EXPECT_EQ( LW_OK, lw_query_create( &def, nullptr, checker, nullptr, &query ) );
	return leeway::Query( query );
}

/// A random state of the group, with quaternions of any length.
inline std::vector<double> randomGroupState( const EdgeWorld& world, SeededRng& rng )
{
	return world.group( randomState( rng, world.robot.get() ) );
}

/// Names a row: its bodies.
using BodyPair = std::tuple<bool, std::uint32_t, std::uint32_t>;
inline BodyPair bodiesOf( const lw_near_pair& row )
{
	return { row.self, row.body_a, row.body_b };
}

/// A random world for each number, its query, and the same call for all states.
class NearTest : public testing::TestWithParam<int>
{
protected:
	explicit NearTest( std::uint64_t first_world )
	    : world( randomWorld( first_world + std::uint64_t( GetParam() ) ) ), query( queryOf( world.with_tables.get() ) )
	{
	}

	NearRows rows( const std::vector<double>& q ) { return nearPairs( world.with_tables.get(), query.get(), q, def ); }

	std::map<BodyPair, double> clearances( const std::vector<double>& q )
	{
		std::map<BodyPair, double> out;
		for ( const lw_near_pair& row : rows( q ).rows )
		{
			out[bodiesOf( row )] = row.clearance.upper;
		}
		return out;
	}

	SeededRng rng{ std::mt19937_64( std::uint64_t( GetParam() ) ) };
	EdgeWorld world;
	leeway::Query query;
	lw_near_def def = lw_near_def_default();
};
