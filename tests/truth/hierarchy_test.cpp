// SPDX-License-Identifier: BSD-3-Clause
// The shared robots in scenes, asked with motion hulls and pair tables and without: no answer may differ. leeway-bench self does
// the same with more states and finer hulls.
#include "leeway/io/model.hpp"
#include "seeded_rng.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace
{

constexpr int STATES = 10000;

struct Case
{
	const char *name, *urdf, *srdf, *scene, *group;
};

const Case CASES[] = {
    { "armar3", "/armar3/armar3.urdf", "/armar3/armar3.srdf", "/kit_kitchen/scene_cluttered.yaml",
        "platform_torso_both_arms" },
    { "armar3_arm", "/armar3/armar3.urdf", "/armar3/armar3.srdf", "/kit_kitchen/scene_cluttered.yaml", "right_arm" },
    { "fetch", "/mbm/fetch/fetch.urdf", "/mbm/fetch/fetch.srdf", "/mbm/fetch/problems/table_pick_fetch/scene0001.yaml",
        "arm_with_torso" },
    { "panda", "/mbm/panda/panda.urdf", "/mbm/panda/panda.srdf", "/mbm/panda/problems/cage_panda/scene0001.yaml",
        "panda_arm" },
};

/// Hulls a few centimetres too large and a second of proofs: enough for tables to matter.
leeway::io::ReachOptions coarseReach()
{
	leeway::io::ReachOptions options;
	options.def.hull_error = 0.15;
	options.def.samples = 300;
	options.def.seconds = 1;
	return options;
}

std::vector<double> randomState( SeededRng& rng, const leeway::io::Problem& problem, double excess )
{
	std::vector<double> q;
	for ( uint32_t variable : problem.variables )
	{
		const lw_variable_info info = lw_robot_variable( problem.robot.get(), variable );
		const double low = std::isfinite( info.lower ) ? info.lower : -1,
		             high = std::isfinite( info.upper ) ? info.upper : 1;
		q.push_back( rng.uniform( low - excess, high + excess ) );
	}
	return q;
}

/// True if the two say the same: class, upper end to the bit, lower end to rounding. Any violation may be found first.
bool same( const lw_clearance& a, const lw_clearance& b )
{
	return a.kind == b.kind &&
	       ( a.kind == LW_CLEARANCE_VIOLATION ||
	           ( a.upper == b.upper && ( a.lower == b.lower || std::abs( a.lower - b.lower ) <= 1e-12 ) ) );
}

} // namespace

class HierarchyTruth : public ::testing::TestWithParam<Case>
{
};

TEST_P( HierarchyTruth, ChangesAnAnswer )
{
	SeededRng rng;
	const std::string data = LEEWAY_DATA_DIR;
	const Case& c = GetParam();
	const leeway::io::RobotModel robot = leeway::io::loadRobot( data + c.urdf, data + c.srdf );
	const leeway::io::SceneModel scene = leeway::io::loadScene( data + c.scene );
	leeway::io::ProblemOptions options;
	options.group = c.group;
	options.scene = &scene;
	options.find_reach = coarseReach();
	const leeway::io::Problem problem = leeway::io::buildProblem( robot, options );
	ASSERT_TRUE( lw_checker_get_info( problem.checker.get() ).hierarchy );
	lw_query_def def = lw_query_def_default();
	leeway::Query by_nodes = leeway::makeQuery( problem.checker.get(), def );
	def.motion_hulls = def.pair_tables = false;
	leeway::Query without_reach = leeway::makeQuery( problem.checker.get(), def );
	const lw_range ranges[] = { { 0, 5e-324, 0 }, { 0, 0.05, 0 }, { 0, std::numeric_limits<double>::infinity(), 0 } };
	int free = 0, blocked = 0;
	for ( int i = 0; i < STATES && !HasFailure(); ++i )
	{
		const std::vector<double> q = randomState( rng, problem, i % 10 == 9 ? 0.3 : 0 );
		const lw_range& range = ranges[i % 3];
		lw_state_result want, got;
		ASSERT_EQ( LW_OK,
		    lw_checker_state( problem.checker.get(), without_reach.get(), q.data(), LW_CHECK_BOTH, &range, false, &want ) );
		ASSERT_EQ(
		    LW_OK, lw_checker_state( problem.checker.get(), by_nodes.get(), q.data(), LW_CHECK_BOTH, &range, false, &got ) );
		EXPECT_EQ( want.verdict, got.verdict ) << "state " << i;
		EXPECT_TRUE( same( want.environment, got.environment ) )
		    << "state " << i << ": " << want.environment.upper << ' ' << got.environment.upper;
		EXPECT_TRUE( same( want.self, got.self ) ) << "state " << i << ": " << want.self.upper << ' ' << got.self.upper;
		++( want.verdict == LW_VERDICT_FREE ? free : blocked );
	}
	EXPECT_GT( std::min( free, blocked ), STATES / 100 );
}

INSTANTIATE_TEST_SUITE_P( Shared, HierarchyTruth, ::testing::ValuesIn( CASES ),
    []( const auto& which ) { return std::string( which.param.name ); } );
