// SPDX-License-Identifier: BSD-3-Clause
// All that `leeway pairs` finds about the pairs of links of a robot, in one call.
#pragma once

#include "leeway/pairs/new_srdf.hpp"

#include <optional>

namespace leeway::pairs
{

struct Settings
{
	io::ReachOptions reach; ///< motion hulls and pair tables; def.samples and def.seed are those of `samples`
	SampleOptions samples;
	bool new_srdf = false; ///< make an SRDF with newly computed pairs
};

/// Pairs, evidence of random states, and the new SRDF. It points into itself: it is moved, not copied.
struct Analysis
{
	Robot robot; ///< without attached objects
	io::LoadedReach reach;
	PairTable table;
	ContactSamples samples;
	std::optional<NewSrdf> srdf;

	/// Analyses a robot without a scene, on all cores. Equal settings give equal results while all proofs end within their time.
	/// @throws io::Error, also if this build makes no motion hulls (qhull); CoreError
	/// Cost: settings.reach.def.seconds of proofs at most, and the states of settings.samples.
	Analysis( const io::RobotModel& model, const Settings& settings );
	Analysis( Analysis&& ) = default;
	/// The new SRDF, or null.
	const NewSrdf* newSrdf() const { return srdf ? &*srdf : nullptr; }
};

} // namespace leeway::pairs
