// SPDX-License-Identifier: BSD-3-Clause
// Edges of random robots among random obstacles: a FREE that a dense look refutes, a BLOCKED that nobody can reproduce.
#include "audit_fixture.hpp"
#include "random_world.hpp"

#include <gtest/gtest.h>

namespace
{

RandomWorldOptions worldOptions( bool margins )
{
	RandomWorldOptions options;
	options.margins = margins;
#ifndef LEEWAY_HULLS
	options.tables = 0;
#endif
	return options;
}

void auditWorlds( int count, bool margins )
{
	SeededRng rng;
	AuditTally tally;
	for ( int i = 0; i < count; ++i )
	{
		const EdgeWorld world = randomWorld( rng.engine()(), worldOptions( margins ) );
		AuditBench bench( world );
		for ( int k = 0; k < 10; ++k )
		{
			Motion motion;
			const double lengths[] = { 0.1, 0.5, 2 };
			if ( k < 7 )
			{
				motion = world.randomMotion( k % 2 == 0, lengths[k % 3], rng.engine(), bench.audit.get() );
			}
			else // anything, also where it ends in contact
			{
				motion = { world.randomState( rng.engine() ), world.randomState( rng.engine() ) };
			}
			bench.judge( motion, rng, tally );
		}
	}
	tally.expectVariety();
}

} // namespace

TEST( EdgeAudit, VerdictsOnRandomRobotsSurviveADenseLook )
{
	auditWorlds( unlessSanitized( 100, 12 ), false );
}

// The same with margins of links, objects and pairs, which the auditor takes off by itself.
TEST( EdgeAudit, VerdictsWithMarginsSurviveADenseLook )
{
	auditWorlds( unlessSanitized( 60, 8 ), true );
}

// An edge that was given up for one pair was UNDECIDED at states in which another pair was in contact.
TEST( EdgeAudit, UndecidedEdgesNameAStateWithoutContact )
{
	SeededRng rng;
	int undecided = 0;
	for ( int i = 0; i < unlessSanitized( 80, 10 ); ++i )
	{
		const EdgeWorld world = randomWorld( rng.engine()(), worldOptions( false ) );
		AuditBench bench( world );
		lw_edge_def def = lw_edge_def_default();
		def.slack = 0.1;
		def.close_windows = 0;
		def.want_proved_until = i % 2 == 0;
		for ( int k = 0; k < 10; ++k )
		{
			const Motion motion = { world.randomState( rng.engine() ), world.randomState( rng.engine() ) };
			const lw_edge_result r = bench.ask( motion, def );
			EdgeTruth truth( world, bench.auditor, motion, def.min_d );
			EXPECT_EQ( r.verdict == LW_VERDICT_UNDECIDED ? truth.refute( def, r ) : "", "" ) << world.name;
			undecided += r.verdict == LW_VERDICT_UNDECIDED;
		}
	}
	std::printf( "%d undecided\n", undecided );
	EXPECT_GT( undecided, unlessSanitized( 50, 1 ) );
}

// The run from the start once took 1,600 times the states of the verdict.
TEST( EdgeAudit, RunsCostAsMuchAsTheirVerdict )
{
	SeededRng rng;
	unsigned partial = 0, states = 0, limit = 0;
	for ( int i = 0; i < unlessSanitized( 150, 30 ); ++i )
	{
		const EdgeWorld world = randomWorld( rng.engine()(), worldOptions( false ) );
		AuditBench bench( world );
		for ( int k = 0; k < 10; ++k )
		{
			const Motion motion = { world.randomState( rng.engine() ), world.randomState( rng.engine() ) };
			lw_edge_def def = lw_edge_def_default();
			const lw_edge_result verdict = bench.ask( motion, def );
			def.want_proved_until = true;
			const lw_edge_result run = bench.ask( motion, def );
			EXPECT_LE( run.queries, verdict.queries + std::max( verdict.queries, 32u ) + 1 ) << world.name;
			states += run.verdict == LW_VERDICT_FREE ? 0 : run.queries;
			limit += run.verdict == LW_VERDICT_FREE ? 0 : verdict.queries + std::max( verdict.queries, 8u );
			EXPECT_TRUE( verdict.verdict != LW_VERDICT_BLOCKED || run.verdict == LW_VERDICT_BLOCKED ) << world.name;
			partial += run.verdict != LW_VERDICT_FREE && run.proved_until > 0;
		}
	}
	std::printf( "%u runs, %u states, at most %u\n", partial, states, limit );
	EXPECT_LE( states, limit );
	EXPECT_GT( partial, unlessSanitized( 200u, 20u ) );
}

// Earlier questions leave planes and nearest pairs in the query. They may decide whether a proof is found before it is given up,
// but nothing else: no edge farther from everything than the slack is ever UNDECIDED, and no edge that collides is FREE.
TEST( EdgeAudit, EarlierQuestionsChangeVerdictsWithinTheSlackOnly )
{
	SeededRng rng;
	int within = 0, beyond = 0, changed = 0;
	for ( int i = 0; i < unlessSanitized( 40, 8 ); ++i )
	{
		const EdgeWorld world = randomWorld( rng.engine()(), worldOptions( false ) );
		AuditBench bench( world );
		lw_edge_def def = lw_edge_def_default();
		def.slack = 0.02;
		def.close_windows = 4; // so few that pairs within the slack are mostly given up
		std::vector<Motion> motions;
		std::vector<lw_edge_result> first;
		for ( int k = 0; k < 12; ++k )
		{
			motions.push_back( world.randomMotion( k % 2 == 0, k % 3 == 0 ? 2 : 0.3, rng.engine(), bench.audit.get() ) );
			first.push_back( bench.ask( motions.back(), def ) );
		}
		for ( int k = 0; k < 60; ++k )
		{
			const std::size_t which = static_cast<std::size_t>( rng.integer( 0, 11 ) );
			lw_edge_result again;
			ASSERT_EQ( LW_OK, lw_checker_edge( world.checker.get(), bench.plain.get(), motions[which].from.data(),
			                      motions[which].to.data(), &def, &again ) );
			EdgeTruth truth( world, bench.auditor, motions[which], def.min_d );
			EXPECT_EQ( truth.refute( def, again ), "" ) << world.name;
			const bool near = truth.whole().least <= ( def.min_d + def.slack ) / ( 1 - def.alpha ) + EdgeTruth::rounding;
			EXPECT_TRUE( near || again.verdict == LW_VERDICT_FREE ) << world.name << ": least " << truth.whole().least;
			EXPECT_TRUE( near || first[which].verdict == LW_VERDICT_FREE ) << world.name;
			within += near;
			beyond += !near;
			changed += again.verdict != first[which].verdict;
		}
	}
	std::printf( "%d within the slack, %d beyond, %d verdicts changed\n", within, beyond, changed );
	EXPECT_GT( within, 20 );
	EXPECT_GT( beyond, 20 );
}

// An auditor that steps over contacts would agree with every certificate. A ball at the end of an arm sweeps past the tip of
// a needle: contact is 0.25 mm of its way of 2 m, or misses it by a nanometre.
TEST( EdgeAudit, TheAuditorFindsAContactOfAQuarterMillimetre )
{
	SeededRng rng;
	const double ball = 0.1, way = 0.25e-3;
	for ( int i = 0; i < 40; ++i )
	{
		const bool touches = i % 2 == 0;
		RobotModel model;
		model.link( "base" );
		lw_joint_def& joint = model.joint( "arm", LW_JOINT_REVOLUTE, 0 );
		joint.axis[0] = joint.axis[1] = 0;
		joint.axis[2] = 1;
		lw_transform at_end = lw_transform_identity();
		at_end.t[0] = 1;
		const double radius[3] = { ball, 0, 0 };
		lw_shape* sphere = nullptr;
		ASSERT_EQ( lw_shape_create_primitive( LW_SHAPE_SPHERE, radius, nullptr, nullptr, &sphere ), LW_OK );
		model.body( 1, sphere, at_end );
		const RobotPtr robot = model.create();

		// the needle ends below the ball's lowest point, so much higher that the ball is over it for `way`
		const double overlap = touches ? way * way / ( 8 * ball ) : -1e-9;
		const double angle = rng.uniform( -0.9, 0.9 );
		const double tip[3] = { std::cos( angle ), std::sin( angle ), -ball + overlap };
		const double corners[9] = {
		    tip[0], tip[1], tip[2], tip[0] + 1e-3, tip[1], tip[2] - 0.5, tip[0], tip[1] + 1e-3, tip[2] - 0.5 };
		const std::uint32_t indices[3] = { 0, 1, 2 };
		lw_mesh_def mesh = lw_mesh_def_default();
		mesh.vertices = corners;
		mesh.vertex_count = 3;
		mesh.indices = indices;
		mesh.triangle_count = 1;
		lw_shape* needle = nullptr;
		ASSERT_EQ( lw_shape_create_mesh( &mesh, nullptr, nullptr, &needle ), LW_OK );
		const ShapePtr keep( needle );
		const char* name = "needle";
		const lw_scene_shape_def shape = { needle, 0, lw_transform_identity() };
		lw_scene_def def = lw_scene_def_default();
		def.object_names = &name;
		def.object_count = 1;
		def.shapes = &shape;
		def.shape_count = 1;
		lw_scene* made = nullptr;
		ASSERT_EQ( lw_scene_create( &def, nullptr, nullptr, &made ), LW_OK );
		const leeway::Scene scene = leeway::Scene::adopt( made );

		const double from = -1, to = 1;
		EdgeAuditor auditor( robot.get(), scene.get(), { 0 }, &from );
		const EdgeAuditor::Look look = auditor.look( &from, &to );
		EXPECT_EQ( look.contact, touches ) << "needle at " << angle << ", least distance " << look.least << " at " << look.t;
		EXPECT_NEAR( from + ( to - from ) * look.t, angle, touches ? way : 1e-3 );
		EXPECT_EQ( auditor.look( &from, &to, 0, ( angle + 0.99 ) / 2 ).contact, false )
		    << "this part ends before the needle";
	}
}
