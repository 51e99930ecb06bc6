// SPDX-License-Identifier: BSD-3-Clause
// Results about every pair of links, and findings about an SRDF.
#pragma once

#include "leeway/pairs/link_distances.hpp"
#include "leeway/io/model.hpp"

#include <string>
#include <utility>
#include <vector>

namespace leeway::pairs
{

/// Share of the random states that are "nearly all", as MoveIt's Setup Assistant takes it for its reason Always.
constexpr double nearly_all = 0.95;
/// Metres: to know whether two links touch, nothing beyond this needs a distance.
constexpr double contact_range = 1e-6;

/// Finding about the SRDF's entry of a pair.
enum class Opinion
{
	NOTHING,
	CONFIRMED,        ///< disabled, and proved to stay apart
	NOT_PROVED,       ///< disabled; neither a proof nor a state in contact was found
	NEVER_SEEN,       ///< the same, after as many states as --never-after asks for: evidence, no proof
	FINDING,          ///< disabled, not adjacent; a state in contact was found
	ADJACENT_CONTACT, ///< the same of an adjacent pair: usually meant
	ALWAYS,           ///< disabled; in contact in every measured state
	BY_DESIGN,        ///< disabled; in contact in most random states, see PairTable::touchByDesign()
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
	bool always = false;                    ///< in contact in every measured state
	std::uint32_t contacts = 0, states = 0; ///< random states in contact, of those looked at
	std::uint64_t never_seen = 0; ///< with --never-after: random states without contact; 0 = not asked, or contact was found
	std::vector<double> contact_state; ///< a random state in contact, where the reach knows none

	/// Share of the random states in contact.
	double contactShare() const { return states > 0 ? static_cast<double>( contacts ) / states : pair.contact_share; }
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
	bool touchAtDefault( const PairRow& row ) { return touch( m_at_default, row ); }
	/// The same where MoveIt's Setup Assistant looks for its reason Default: 0, or the middle of the limits where 0 is outside.
	bool touchAtMiddle( const PairRow& row ) { return touch( m_at_middle, row ); }
	/// True if the shapes of the two overlap as they are meant to, so that their contact tells nothing: in contact in nearly all random
	/// states, or in most of them while few joints are between the two. Evidence.
	static bool touchByDesign( const PairRow& row );

	/// Results of random states. @param state one of those in contact; empty if there is none
	void setContacts( std::size_t row, std::uint32_t contacts, std::uint32_t states, const std::vector<double>& state );
	void setContactState( std::size_t row, const std::vector<double>& state );
	void setNeverSeen( std::size_t row, std::uint64_t states );

private:
	static bool touch( LinkDistances& state, const PairRow& row );
	std::vector<std::uint32_t> variablesBetween( std::uint32_t link_a, std::uint32_t link_b ) const;
	std::vector<std::uint32_t> pathToRoot( std::uint32_t link ) const;

	Robot m_robot;
	Reach m_reach;
	std::vector<bool> m_geometry; ///< by link
	std::size_t m_geometry_count = 0;
	bool m_has_srdf = false;
	std::vector<PairRow> m_rows;
	LinkDistances m_at_default, m_at_middle;
};

} // namespace leeway::pairs
