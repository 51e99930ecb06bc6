// SPDX-License-Identifier: BSD-3-Clause
// Costs of counted work.
//
// Times differ from run to run, counts do not: a setting is chosen by counts, weighed with the time of each on one machine.
// Another machine is faster or slower, mostly by one factor, which is measured (measuredRate()).
//
// The weights are a least-squares fit of relative errors, none negative, to 1,288 settings: ARMAR-III in the cluttered
// kitchen (reaches 02, 05 and 09), Fetch and Panda in scenes of MotionBenchMaker, with and without motion hulls. The
// settings of one scene are off by 13 % (rms, on a busy machine), no scene by more than 8 % in the mean. Hierarchy tests and
// centres moved into another frame got a weight of nothing: they come along with poses and node tests.
#include "leeway/tune/tune.hpp"

namespace leeway::tune
{

double unitWork( const lw_query_stats& s, std::size_t states, std::size_t motions )
{
	return 0.05 * double( s.queries ) + 0.145 * double( s.node_tests ) + 0.1 * double( s.leaf_tests ) +
	       0.026 * double( s.triangle_tests ) + 0.47 * double( s.exact_tests ) + 0.035 * double( s.links_posed ) +
	       0.8 * double( states ) + 3.8 * double( motions );
}

} // namespace leeway::tune
