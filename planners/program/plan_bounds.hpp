// SPDX-License-Identifier: BSD-3-Clause
// Bounds of a planner's space that suit the ends of a request.
#pragma once

#include "program/output.hpp"

#include <ompl/base/spaces/RealVectorStateSpace.h>

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace leeway::cli
{

// Limits of a joint that are so far away mean that there are none, and states drawn between them have nothing to do with the ends.
constexpr double far_limits = 1000, room_beyond_ends = 10;

// Bounds that are far from both ends come nearer. A joint that is told to go from a to b need not go further than ten radians or metres beyond.
inline void narrow(
    ::ompl::base::StateSpace& space, const ::ompl::base::State& start, const ::ompl::base::State& goal, Notices& notices )
{
	if ( space.isCompound() )
	{
		auto& compound = *space.as<::ompl::base::CompoundStateSpace>();
		for ( unsigned int i = 0; i < compound.getSubspaceCount(); ++i )
		{
			narrow( *compound.getSubspace( i ), *start.as<::ompl::base::CompoundState>()->components[i],
			    *goal.as<::ompl::base::CompoundState>()->components[i], notices );
		}
	}
	else if ( space.getType() == ::ompl::base::STATE_SPACE_REAL_VECTOR )
	{
		auto& vector = *space.as<::ompl::base::RealVectorStateSpace>();
		::ompl::base::RealVectorBounds bounds = vector.getBounds();
		for ( unsigned int i = 0; i < vector.getDimension(); ++i )
		{
			const double a = start.as<::ompl::base::RealVectorStateSpace::StateType>()->values[i];
			const double b = goal.as<::ompl::base::RealVectorStateSpace::StateType>()->values[i];
			if ( bounds.high[i] - bounds.low[i] > far_limits )
			{
				const std::string name = vector.getDimensionName( i );
				notices.add( "joint limits",
				    fmt::format( "joint {}: limits are {:g} to {:g}: planning keeps within {:g} of start and goal",
				        name.empty() ? vector.getName() : name, bounds.low[i], bounds.high[i], room_beyond_ends ) );
				bounds.low[i] = std::max( bounds.low[i], std::min( a, b ) - room_beyond_ends );
				bounds.high[i] = std::min( bounds.high[i], std::max( a, b ) + room_beyond_ends );
			}
		}
		vector.setBounds( bounds );
	}
}

// Makes room in the bounds for a state that lies beyond them by a rounding (see limit_tolerance): planners take only ends
// inside the bounds, and moving the end would answer another question.
inline void widen( ::ompl::base::StateSpace& space, const ::ompl::base::State& state )
{
	if ( space.isCompound() )
	{
		auto& compound = *space.as<::ompl::base::CompoundStateSpace>();
		for ( unsigned int i = 0; i < compound.getSubspaceCount(); ++i )
		{
			widen( *compound.getSubspace( i ), *state.as<::ompl::base::CompoundState>()->components[i] );
		}
	}
	else if ( space.getType() == ::ompl::base::STATE_SPACE_REAL_VECTOR )
	{
		auto& vector = *space.as<::ompl::base::RealVectorStateSpace>();
		::ompl::base::RealVectorBounds bounds = vector.getBounds();
		for ( unsigned int i = 0; i < vector.getDimension(); ++i )
		{
			const double value = state.as<::ompl::base::RealVectorStateSpace::StateType>()->values[i];
			bounds.low[i] = std::min( bounds.low[i], value );
			bounds.high[i] = std::max( bounds.high[i], value );
		}
		vector.setBounds( bounds );
	}
}

} // namespace leeway::cli
