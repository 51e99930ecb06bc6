// SPDX-License-Identifier: BSD-3-Clause
#include "support/running_motion.hpp"

#include "support/race.hpp"

#include <algorithm>
#include <ctime>

double microseconds( const std::function<void()>& work )
{
	const double start = threadMicroseconds();
	work();
	return threadMicroseconds() - start;
}

OwnedClock freeMotion( const EdgeWorld& world, const lw_checker* checker, int pieces, SeededRng& rng )
{
	const leeway::Query query = leeway::makeQuery( checker );
	const lw_edge_def def = lw_edge_def_default();
	OwnedClock clock;
	clock.rest = world.home.empty() ? world.group( world.reference ) : world.home;
	OwnedTrack track;
	std::vector<double> at = clock.rest;
	for ( std::uint32_t i = 0; i < at.size(); ++i )
	{
		track.variables.push_back( i );
	}
	for ( int tries = 0; tries < 5000 && static_cast<int>( track.pieces.size() ) < pieces; ++tries )
	{
		std::vector<double> to = at;
		for ( std::size_t i = 0; i < to.size(); ++i )
		{
			const lw_variable_info info = lw_robot_variable( world.robot.get(), world.variables[i] );
			to[i] = std::clamp( to[i] + rng.uniform( -0.4, 0.4 ), info.lower, info.upper );
		}
		lw_edge_result r;
		leeway::require( lw_checker_edge( checker, query.get(), at.data(), to.data(), &def, &r ), "edge" );
		if ( r.verdict == LW_VERDICT_FREE )
		{
			const double start = 0.5 * static_cast<double>( track.pieces.size() );
			OwnedPiece piece = { start, start + 0.5, 1, at };
			piece.points.insert( piece.points.end(), to.begin(), to.end() );
			track.pieces.push_back( piece );
			at = to;
		}
	}
	clock.tracks.push_back( track );
	return clock;
}

leeway::GuardHandle makeGuard( const lw_guard_def& def )
{
	lw_guard* made = nullptr;
	leeway::require( lw_guard_create( &def, nullptr, nullptr, &made ), "lw_guard_create" );
	return leeway::GuardHandle( made );
}

leeway::Checker edited( const lw_checker* checker, const lw_scene* scene )
{
	lw_checker_edit_def edit = lw_checker_edit_def_default();
	edit.scene = scene;
	lw_checker* made = nullptr;
	leeway::require( lw_checker_edit( checker, &edit, nullptr, nullptr, &made ), "lw_checker_edit" );
	return leeway::Checker::adopt( made );
}
