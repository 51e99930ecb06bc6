// SPDX-License-Identifier: BSD-3-Clause
// The SRDF that `leeway pairs` writes, and whether one can plan with it.
#pragma once

#include "leeway/pairs/contact_samples.hpp"

#include <string>
#include <vector>

namespace leeway::pairs
{

/// An SRDF with newly computed pairs, and its differences to the old one.
struct NewSrdf
{
	io::WrittenSrdf document;
	std::vector<const PairRow*> enabled_again;  ///< disabled before by a computed reason, and no more; most contacts first
	std::vector<const PairRow*> free_elsewhere; ///< disabled for their contact, and free in some states
	std::vector<bool> disabled;                 ///< by row of the pair table: in the new file
};

NewSrdf newSrdf( PairTable& table, const io::RobotModel& model );

/// Human-readable differences; all of them if `verbose`.
std::string describe( const NewSrdf& srdf, const std::string& file, bool verbose );

/// Pairs that are near in nearly all states, with the range of their distances.
std::string describeNear( const PairTable& table, const ContactSamples& samples, const NewSrdf* srdf );
/// Share of the random states that are free with the robot's SRDF and with the new one; pairs that block the others.
std::string describeUse( PairTable& table, const ContactSamples& samples, const io::RobotModel& model, const NewSrdf* srdf );

/// "12.3 %": never up to 100 by rounding.
std::string percent( double share );
/// "in contact in 12.3 % of 2000 random states", or a remark on the contact.
std::string contactText( const PairRow& row );
std::string pairText( const PairRow& row );

} // namespace leeway::pairs
