// SPDX-License-Identifier: BSD-3-Clause
// Owners of the objects that checkers are made of and asked with, for tests of the core.
#pragma once

#include "leeway/checker.h"

#include <gtest/gtest.h>
#include <memory>

template <typename T, void ( *release )( T* )> struct Releaser
{
	void operator()( T* object ) const { release( object ); }
};
using ReachPtr = std::unique_ptr<lw_reach, Releaser<lw_reach, lw_reach_release>>;
using ScenePtr = std::unique_ptr<lw_scene, Releaser<lw_scene, lw_scene_release>>;
using CheckerPtr = std::unique_ptr<lw_checker, Releaser<lw_checker, lw_checker_release>>;
using QueryPtr = std::unique_ptr<lw_query, Releaser<lw_query, lw_query_destroy>>;

inline QueryPtr makeQuery( const lw_checker* checker, const lw_query_def& def )
{
	lw_query* query = nullptr;
	EXPECT_EQ( LW_OK, lw_query_create( &def, nullptr, checker, nullptr, &query ) );
	return QueryPtr( query );
}

inline QueryPtr makeQuery( const lw_checker* checker, bool warm_start = true )
{
	lw_query_def def = lw_query_def_default();
	def.warm_start = warm_start;
	return makeQuery( checker, def );
}

/// A query that uses nothing that a reach proves.
inline QueryPtr makeQueryWithoutReach( const lw_checker* checker, bool warm_start = true )
{
	lw_query_def def = lw_query_def_default();
	def.motion_hulls = def.pair_tables = false;
	def.warm_start = warm_start;
	return makeQuery( checker, def );
}
