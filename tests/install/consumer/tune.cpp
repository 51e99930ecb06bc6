// SPDX-License-Identifier: BSD-3-Clause
// leeway::tune from an installed package: work is counted, and the grid goes as far as its target.
#include <leeway/tune/tune.hpp>

int main()
{
	leeway::tune::Target target;
	target.kind = leeway::tune::Target::CONSERVATISM;
	target.value = 0.5;
	lw_query_stats none = {};
	return leeway::tune::largestConservatism( target ) == 0.5 && leeway::tune::unitWork( none, 0, 0 ) == 0 ? 0 : 1;
}
