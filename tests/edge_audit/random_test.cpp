// SPDX-License-Identifier: BSD-3-Clause
// Edges of random robots among random obstacles: a FREE that a dense look refutes, a BLOCKED that nobody can reproduce.
#include "audit_fixture.hpp"
#include "random_world.hpp"

#include <gtest/gtest.h>

namespace
{

RandomWorldOptions worldOptions()
{
	RandomWorldOptions options;
#ifndef LEEWAY_HULLS
	options.tables = 0;
#endif
	return options;
}

} // namespace

TEST( EdgeAudit, VerdictsOnRandomRobotsSurviveADenseLook )
{
	SeededRng rng;
	AuditTally tally;
	for ( int i = 0; i < edgesUnlessSanitized( 100, 10 ); ++i )
	{
		const EdgeWorld world = randomWorld( rng.engine()(), worldOptions() );
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
