// SPDX-License-Identifier: BSD-3-Clause
// A robot that has a pair of links of every class, and an SRDF with right and wrong claims about it.
#pragma once

#include "cli_fixture.hpp"

#include <nlohmann/json.hpp>

/// Boxes on a base. The intended class of each pair:
///   left - right     slides far apart: never, by hulls
///   gear_a - gear_b  opposite ends of a circle, driven by one joint: never, but their hulls overlap
///   jaw_a - jaw_b    slides that meet if both are out: check
///   pot - lid        overlap at zero, free with the lid up
///   nut - bolt       overlap in every state
///   base - flag      rigid, neighbours; base - pin rigid, with flag in between
class Pairs : public Cli
{
protected:
	void SetUp() override;
	/// leeway pairs --robot many.urdf --budget 1 --samples 200 + more
	Outcome pairs( const std::vector<std::string>& more ) const;
	/// The entry of "pairs" or "findings" for two links; null if there is none.
	static nlohmann::json entry( const nlohmann::json& list, const std::string& a, const std::string& b );
	nlohmann::json json( const std::string& name ) const { return nlohmann::json::parse( readFile( path( name ) ) ); }
};
