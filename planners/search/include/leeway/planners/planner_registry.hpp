// SPDX-License-Identifier: BSD-3-Clause
// OMPL's geometric planners by name.
#pragma once

#include <ompl/base/Planner.h>

#include <string>
#include <vector>

namespace leeway::planners
{

struct PlannerEntry
{
	const char* name;
	const char* kind; ///< "tree", "roadmap", "optimising", "threads" ...
	::ompl::base::PlannerPtr ( *make )( const ::ompl::base::SpaceInformationPtr& );
	const char* threads = nullptr; ///< OMPL's parameter for the number of threads; null: it plans with one
};

constexpr unsigned most_threads = 64; ///< that OMPL's planners declare

/// All of them, by name.
const std::vector<PlannerEntry>& registry();

/// @param name upper and lower case do not matter
/// @throws io::Error that lists the names
const PlannerEntry& findPlanner( const std::string& name );

/// Is the planner able to use this many threads? 0 = its own choice.
/// @throws io::Error that lists those that can
void requireThreads( const PlannerEntry& planner, unsigned threads );

/// Sets parameters that the planner declares, each given as NAME=VALUE.
/// @throws io::Error that names the mistake and lists the planner's parameters with their values and ranges
void setParameters( ::ompl::base::Planner& planner, const std::vector<std::string>& assignments );

/// Planners such as KPIECE1 and PDST look at states through a projection. Spaces made of several parts have no default one,
/// and that of the smallest spaces does not work; this gives them a linear projection to the plane, the same for every run.
void ensureProjection( const ::ompl::base::StateSpacePtr& space );

} // namespace leeway::planners
