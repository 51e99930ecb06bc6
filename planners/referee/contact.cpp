// SPDX-License-Identifier: BSD-3-Clause
#include "referee/contact.hpp"

#include "leeway/depth.h"
#include "leeway/near.h"

#include <algorithm>
#include <cmath>

namespace leeway::referee
{

std::optional<Contact> deepestContact(
    const io::Problem& problem, lw_query* query, const std::vector<double>& q, lw_check_flags flags )
{
	Contact contact;
	contact.slope.resize( q.size() );
	lw_near_def def = lw_near_def_default();
	def.flags = flags;
	def.distance = 1e-9;
	def.depth_steps = lw_depth_def_default().steps;
	def.derivatives = contact.slope.data();
	lw_near_pair pair;
	std::uint32_t count = 0;
	require( lw_checker_near( problem.checker.get(), query, q.data(), &def, &pair, 1, &count ), "the deepest contact" );
	if ( count == 0 )
	{
		return std::nullopt;
	}
	contact.depth = { std::max( 0.0, -pair.clearance.upper ),
	    std::isfinite( pair.clearance.lower ) ? std::max( 0.0, -pair.clearance.lower ) : 0.0 };
	contact.self = pair.self;
	contact.pair = pair.self ? motions::nameSelf( problem.checker.get(), pair.clearance )
	                         : motions::nameEnvironment( problem.checker.get(), pair.clearance );
	return contact;
}

} // namespace leeway::referee
