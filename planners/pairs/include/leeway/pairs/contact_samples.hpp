// SPDX-License-Identifier: BSD-3-Clause
// Contacts and distances of link pairs in random states: evidence for pairs without a proof.
#pragma once

#include "leeway/motions/states.hpp"
#include "leeway/pairs/pair_table.hpp"

#include <cstdint>
#include <functional>
#include <random>
#include <vector>

namespace leeway::pairs
{

/// Settings of the measurement.
struct SampleOptions
{
	std::uint32_t states = 0;           ///< in which contact of all pairs without a proof is looked for
	std::uint64_t seed = 0;             ///< of the random states
	std::uint32_t never_after = 0;      ///< random states for each pair without a contact so far; 0: none
	motions::ProgressFunction progress; ///< may be empty; called by several threads, one at a time
};

/// The distances of a pair that is near in nearly all random states.
struct NearRange
{
	std::size_t row = 0;        ///< of the pair table
	double least = 0, most = 0; ///< metres, over `states` random states
	std::uint32_t states = 0;
};

/// Metres: below this in nearly all states a pair is near by design.
constexpr double near_distance = 0.005;

/// Random states, uniform between the joint limits, with their contacts. All cores work; results do not depend on their
/// number.
class ContactSamples
{
public:
	/// Measures. Enters into `table` the share of the states in contact, contacts that the table did not
	/// know, and the number of states without contact.
	/// @throws io::Error
	ContactSamples( const Robot& robot, PairTable& table, const SampleOptions& options );

	std::uint32_t states() const { return m_states; }
	const std::vector<NearRange>& near() const { return m_near; }

	/// Number of states in which no pair is in contact for which `checked` (by index of its row) is true.
	std::size_t freeStates( const std::function<bool( std::size_t )>& checked ) const;

	/// A pair in contact, and the cost of enabling it.
	struct Blocking
	{
		std::size_t row = 0;
		std::uint32_t states = 0; ///< in contact
		std::uint32_t alone = 0;  ///< in contact while no other checked pair is
	};
	/// The checked pairs that were in contact, those in contact most often first.
	std::vector<Blocking> blocking( const std::function<bool( std::size_t )>& checked ) const;

private:
	using Contacts = std::vector<std::uint32_t>; ///< rows of the table, ascending

	void countContacts( PairTable& table, const SampleOptions& options );
	void measureNear( const PairTable& table, const SampleOptions& options );
	void seekContacts( PairTable& table, const SampleOptions& options );

	Robot m_robot;
	std::uint64_t m_seed;
	std::uint32_t m_states;
	std::vector<Contacts> m_contacts; ///< [m_states]
	std::vector<NearRange> m_near;
};

} // namespace leeway::pairs
