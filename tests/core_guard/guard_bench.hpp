// SPDX-License-Identifier: BSD-3-Clause
// A guard, its motion, and its answers.
#pragma once

#include "clock_world.hpp"
#include "leeway/guard.h"

#include <memory>

using GuardPtr = leeway::GuardHandle;

inline lw_guard_def guardOf( const lw_checker* checker, double end )
{
	lw_guard_def def = lw_guard_def_default();
	def.checker = checker;
	def.end = end;
	def.spare_shapes = 40;
	return def;
}

/// A checker of another scene. @param scene null: an empty one
inline leeway::Checker inScene( const lw_checker* from, const lw_scene* scene )
{
	lw_diag diag = {};
	leeway::Scene empty;
	if ( scene == nullptr )
	{
		const lw_scene_def def = lw_scene_def_default();
		lw_scene* made = nullptr;
		leeway::require( lw_scene_create( &def, nullptr, &diag, &made ), diag );
		empty = leeway::Scene::adopt( made );
	}
	lw_checker_edit_def edit = lw_checker_edit_def_default();
	edit.scene = scene != nullptr ? scene : empty.get();
	lw_checker* made = nullptr;
	leeway::require( lw_checker_edit( from, &edit, nullptr, &diag, &made ), diag );
	return leeway::Checker::adopt( made );
}

inline GuardPtr makeGuard( lw_guard_def def, OwnedClock& clock, const lw_allocator* allocator = nullptr )
{
	const lw_clock view = clock.view();
	def.clock = &view;
	lw_guard* guard = nullptr;
	lw_diag diag = {};
	EXPECT_EQ( LW_OK, lw_guard_create( &def, allocator, &diag, &guard ) ) << diag.message;
	return GuardPtr( guard );
}

inline lw_guard_answer ask( lw_guard* guard, double now, double budget = INFINITY )
{
	lw_guard_answer answer;
	EXPECT_EQ( LW_OK, lw_guard_ask( guard, now, budget, &answer ) );
	return answer;
}
