// SPDX-License-Identifier: BSD-3-Clause
// What is known of every pair of links, and what that says about an SRDF.
#pragma once

#include "setup.hpp"

#include <string>
#include <utility>
#include <vector>

namespace leeway::cli
{

/// What is to be said about an SRDF's word on a pair.
enum class Opinion
{
	NOTHING,
	CONFIRMED,        ///< disabled, and proved to stay apart
	NOT_PROVED,       ///< disabled; neither a proof nor a state in contact was found
	FINDING,          ///< disabled, not adjacent; a state in contact was found
	ADJACENT_CONTACT, ///< the same of an adjacent pair: usually meant
	ALWAYS,           ///< disabled; in contact in every state looked at
	COULD_BE_DISABLED ///< enabled, and proved to stay apart
};
const char* opinionName( Opinion opinion );

/// One pair of links with geometry; names in alphabetical order.
struct PairRow
{
	std::uint32_t link_a = 0, link_b = 0;
	std::string first, second;
	lw_reach_pair pair{};
	bool disabled = false; ///< by the SRDF
	std::string reason;    ///< of the SRDF
	Opinion opinion = Opinion::NOTHING;
	bool always = false; ///< in contact in every state looked at
};

/// Values by variable name.
using NamedValues = std::vector<std::pair<std::string, double>>;

/// All pairs of links with geometry of a robot.
class PairTable
{
public:
	PairTable( const io::RobotModel& model, Robot robot, Reach reach );

	const std::vector<PairRow>& rows() const { return m_rows; }
	std::size_t count( lw_pair_class kind ) const;
	std::size_t count( Opinion opinion ) const;
	std::size_t linksWithGeometry() const { return m_geometry_count; }

	/// The state in contact that was found: values of the variables that move the two against each other.
	NamedValues evidence( const PairRow& row ) const;
	/// The same state, whole.
	std::vector<double> evidenceState( const PairRow& row ) const;

	/// True if the two are in contact at the robot's default state: no clearance above 0 can be proved there.
	bool touchAtDefault( const PairRow& row ) const;

private:
	std::vector<std::uint32_t> variablesBetween( std::uint32_t link_a, std::uint32_t link_b ) const;
	std::vector<std::uint32_t> pathToRoot( std::uint32_t link ) const;

	Robot m_robot;
	Reach m_reach;
	std::vector<bool> m_geometry; ///< by link
	std::size_t m_geometry_count = 0;
	std::vector<PairRow> m_rows;
	std::vector<lw_transform> m_default; ///< world_from_link at the default state
	Query m_query;
};

} // namespace leeway::cli
