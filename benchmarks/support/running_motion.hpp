// SPDX-License-Identifier: BSD-3-Clause
// A motion that runs, its guard, and time on the processor: what benchmarks of guards and of clouds share.
#pragma once

#include "support/edge_worlds.hpp"

#include "leeway/guard.h"

#include "owned_clock.hpp"
#include "seeded_rng.hpp"

#include <functional>

/// Of this thread on the processor: other programs on the machine would decide about the slowest hundredth.
double microseconds( const std::function<void()>& work );

/// At most so many straight pieces of half a second that are free, one after the other, each joint by up to 0.4.
/// @param checker of the world's robot and group, in any scene
OwnedClock freeMotion( const EdgeWorld& world, const lw_checker* checker, int pieces, SeededRng& rng );

/// @throws leeway::CoreError
leeway::GuardHandle makeGuard( const lw_guard_def& def );

/// The checker in another scene; nullptr: in none. @throws leeway::CoreError
leeway::Checker edited( const lw_checker* checker, const lw_scene* scene );
