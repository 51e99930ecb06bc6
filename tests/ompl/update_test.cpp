// SPDX-License-Identifier: BSD-3-Clause
// An engine whose world changes while planners ask.
#include "world.hpp"

#include <atomic>
#include <gtest/gtest.h>
#include <thread>

namespace
{

/// The checker with more obstacles, of these names.
leeway::Checker withObstacles(
    const leeway::Checker& checker, const std::vector<std::pair<std::string, lw_transform>>& added )
{
	const leeway::Shape box = makeBox( 0.1, 0.1, 0.3 );
	std::vector<lw_scene_change> changes;
	const lw_shape* shape = box.get();
	for ( const auto& [name, pose] : added )
	{
		changes.push_back( { LW_SCENE_ADD, name.c_str(), &shape, &pose, 1 } );
	}
	lw_scene* scene = nullptr;
	lw_diag diag = {};
	leeway::require( lw_scene_edit( lw_checker_scene( checker.get() ), changes.data(),
	                     static_cast<std::uint32_t>( changes.size() ), nullptr, &diag, &scene ),
	    diag );
	const leeway::Scene owner = leeway::Scene::adopt( scene );
	lw_checker_edit_def def = lw_checker_edit_def_default();
	def.scene = scene;
	lw_checker* next = nullptr;
	leeway::require( lw_checker_edit( checker.get(), &def, nullptr, &diag, &next ), diag );
	return leeway::Checker::adopt( next );
}

class Updates : public ::testing::Test
{
protected:
	Updates() : base( gantryWorld() ), space( leeway::ompl::makeStateSpace( base ) )
	{
		::ompl::msg::setLogLevel( ::ompl::msg::LOG_ERROR );
		si = std::make_shared<ob::SpaceInformation>( space );
		engine = leeway::ompl::install( si, base, {} );
		si->setup();
		left = state( -0.8, -0.8 );
		right = state( -0.3, -0.8 );
	}
	~Updates() override
	{
		for ( ob::State* s : states )
		{
			space->freeState( s );
		}
	}
	ob::State* state( double x, double y )
	{
		ob::State* s = space->allocState();
		const double q[] = { x, y };
		engine->adapter().fromVector( q, s );
		states.push_back( s );
		return s;
	}

	leeway::Checker base;
	ob::StateSpacePtr space;
	ob::SpaceInformationPtr si;
	std::shared_ptr<leeway::ompl::Engine> engine;
	ob::State *left = nullptr, *right = nullptr;
	std::vector<ob::State*> states;
};

TEST_F( Updates, QuestionAfterAnUpdateGetsAnAnswerOfBefore )
{
	EXPECT_TRUE( si->isValid( left ) && si->checkMotion( left, right ) );
	engine->update( withObstacles( base, { { "new", at( -0.55, -0.8, 0 ) } } ) );
	EXPECT_TRUE( si->isValid( left ) && si->isValid( right ) );
	EXPECT_FALSE( si->checkMotion( left, right ) );
	engine->update( base );
	EXPECT_TRUE( si->checkMotion( left, right ) );
	EXPECT_EQ( engine->checker().get(), base.get() );
	// more than the queries of the pool have room for
	std::vector<std::pair<std::string, lw_transform>> many;
	for ( int i = 0; i < 100; ++i )
	{
		many.emplace_back( "new " + std::to_string( i ), at( 0.9, -0.9 + 0.001 * i, 3 ) );
	}
	many.emplace_back( "last", at( -0.8, -0.8, 0 ) );
	engine->update( withObstacles( base, many ) );
	EXPECT_FALSE( si->isValid( left ) );
	EXPECT_TRUE( si->isValid( right ) );
}

TEST_F( Updates, CheckerOfAnotherGroup )
{
	EXPECT_THROW( engine->update( armWorld() ), std::invalid_argument );
	EXPECT_THROW( engine->update( leeway::Checker() ), std::invalid_argument );
	EXPECT_TRUE( si->isValid( left ) );
}

TEST_F( Updates, ThreadsThatAskMeetAHalfMadeWorld )
{
	// an obstacle that is here or there: a motion by both places is always blocked, and one far from both is free
	const leeway::Checker here = withObstacles( base, { { "new", at( -0.65, -0.8, 0 ) } } );
	const leeway::Checker there = withObstacles( base, { { "x", at( 0.9, 0.9, 2 ) }, { "new", at( -0.45, -0.8, 0 ) } } );
	engine->update( here );
	std::atomic<bool> stop{ false };
	std::atomic<int> wrong{ 0 }, asked{ 0 };
	std::vector<std::thread> threads;
	for ( int i = 0; i < 4; ++i )
	{
		threads.emplace_back(
		    [&]
		    {
			    while ( !stop )
			    {
				    wrong += si->checkMotion( left, right );
				    wrong += !si->isValid( left );
				    ++asked;
			    }
		    } );
	}
	ob::State* at_here = state( -0.65, -0.8 );
	ob::State* at_there = state( -0.45, -0.8 );
	for ( int i = 0; i < 500; ++i )
	{
		const bool now_here = i % 2 == 0;
		engine->update( now_here ? here : there );
		EXPECT_EQ( si->isValid( at_here ), !now_here );
		EXPECT_EQ( si->isValid( at_there ), now_here );
	}
	while ( asked < 100 )
	{
		std::this_thread::yield();
	}
	stop = true;
	for ( std::thread& thread : threads )
	{
		thread.join();
	}
	EXPECT_EQ( wrong, 0 );
	EXPECT_LE( engine->queryCount(), 6u );
}

} // namespace
