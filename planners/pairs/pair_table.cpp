// SPDX-License-Identifier: BSD-3-Clause
// Pairs of links: class, proof, evidence, and the SRDF's word on them.
#include "leeway/pairs/pair_table.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace leeway::pairs
{
namespace
{

/// Share of the random states, see PairTable::touchByDesign().
constexpr double most = 0.5;
/// Variables between two links for which contact in most states is taken for design. In 42 robots each pair of links with few variables
/// between them in contact in 50 % or more overlaps around its joints (wrists in hands, shoulder blades in shoulders); pairs at the ends of longer
/// chains that are in contact that often, or neighbours' neighbours in contact less often, get out of each other's way.
constexpr std::uint32_t few_variables = 3;

/// Where MoveIt looks for its reason Default: 0, or the middle of the limits where 0 is outside.
std::vector<double> middleState( const lw_robot* robot )
{
	std::vector<double> q( lw_robot_variable_count( robot ) );
	lw_robot_default_state( robot, q.data() );
	for ( std::uint32_t v = 0; v < q.size(); ++v )
	{
		const lw_variable_info info = lw_robot_variable( robot, v );
		if ( info.lower > 0 || info.upper < 0 )
		{
			q[v] = std::isfinite( info.lower ) && std::isfinite( info.upper ) ? ( info.lower + info.upper ) / 2 : q[v];
		}
	}
	return q;
}

Opinion judge( const PairRow& row, bool has_srdf )
{
	if ( !has_srdf || row.pair.kind == LW_PAIR_RIGID )
	{
		return Opinion::NOTHING;
	}
	if ( row.pair.separation > 0 )
	{
		return row.disabled ? Opinion::CONFIRMED : Opinion::COULD_BE_DISABLED;
	}
	if ( !row.disabled )
	{
		return Opinion::NOTHING;
	}
	if ( row.always )
	{
		return Opinion::ALWAYS;
	}
	if ( row.pair.closest > 0 )
	{
		return row.never_seen > 0 ? Opinion::NEVER_SEEN : Opinion::NOT_PROVED;
	}
	if ( PairTable::touchByDesign( row ) && !row.pair.adjacent )
	{
		return Opinion::BY_DESIGN;
	}
	return row.pair.adjacent ? Opinion::ADJACENT_CONTACT : Opinion::FINDING;
}

} // namespace

const char* opinionName( Opinion opinion )
{
	switch ( opinion )
	{
	case Opinion::CONFIRMED:
		return "confirmed by proof";
	case Opinion::NOT_PROVED:
		return "not proved";
	case Opinion::NEVER_SEEN:
		return "never seen in contact (evidence, no proof)";
	case Opinion::FINDING:
		return "can collide";
	case Opinion::ADJACENT_CONTACT:
		return "adjacent, can touch";
	case Opinion::ALWAYS:
		return "always in contact";
	case Opinion::BY_DESIGN:
		return "in contact by design (evidence, no proof)";
	case Opinion::COULD_BE_DISABLED:
		return "could be disabled";
	case Opinion::NOTHING:
		break;
	}
	return "";
}

PairTable::PairTable( const io::RobotModel& model, Robot robot, Reach reach )
    : m_robot( std::move( robot ) ), m_reach( std::move( reach ) ), m_has_srdf( !model.srdf_file.empty() ),
      m_at_default( m_robot ), m_at_middle( m_robot )
{
	const lw_robot* const r = m_robot.get();
	m_geometry.assign( lw_robot_link_count( r ), false );
	for ( std::uint32_t i = 0; i < lw_robot_body_count( r ); ++i )
	{
		m_geometry[lw_robot_body( r, i ).link] = true;
	}
	m_geometry_count = static_cast<std::size_t>( std::count( m_geometry.begin(), m_geometry.end(), true ) );

	std::map<std::pair<std::string, std::string>, std::string> reasons;
	for ( const io::DisabledPair& pair : model.disabled )
	{
		reasons.emplace( std::minmax( pair.link1, pair.link2 ), pair.reason );
	}
	for ( std::uint32_t a = 0; a < m_geometry.size(); ++a )
	{
		for ( std::uint32_t b = a + 1; b < m_geometry.size(); ++b )
		{
			if ( !m_geometry[a] || !m_geometry[b] )
			{
				continue;
			}
			PairRow row;
			row.first = lw_robot_link_name( r, a );
			row.second = lw_robot_link_name( r, b );
			row.link_a = a;
			row.link_b = b;
			if ( row.second < row.first )
			{
				std::swap( row.first, row.second );
				std::swap( row.link_a, row.link_b );
			}
			row.pair = lw_reach_get_pair( m_reach.get(), a, b );
			const auto found = reasons.find( { row.first, row.second } );
			row.disabled = found != reasons.end();
			row.reason = row.disabled ? found->second : "";
			row.always = row.pair.kind == LW_PAIR_ALWAYS || ( row.pair.contact_share >= 1 && !( row.pair.closest > 0 ) );
			row.opinion = judge( row, m_has_srdf );
			m_rows.push_back( std::move( row ) );
		}
	}
	std::sort( m_rows.begin(), m_rows.end(),
	    []( const PairRow& x, const PairRow& y ) { return std::tie( x.first, x.second ) < std::tie( y.first, y.second ); } );

	std::vector<double> state( lw_robot_variable_count( r ) );
	lw_robot_default_state( r, state.data() );
	m_at_default.move( state );
	m_at_middle.move( middleState( r ) );
}

std::size_t PairTable::count( lw_pair_class kind ) const
{
	return static_cast<std::size_t>(
	    std::count_if( m_rows.begin(), m_rows.end(), [=]( const PairRow& row ) { return row.pair.kind == kind; } ) );
}

std::size_t PairTable::count( Opinion opinion ) const
{
	return static_cast<std::size_t>(
	    std::count_if( m_rows.begin(), m_rows.end(), [=]( const PairRow& row ) { return row.opinion == opinion; } ) );
}

/// The link itself first, the root last.
std::vector<std::uint32_t> PairTable::pathToRoot( std::uint32_t link ) const
{
	std::vector<std::uint32_t> path = { link };
	for ( std::uint32_t joint = lw_robot_link_joint( m_robot.get(), link ); joint != LW_INVALID_INDEX;
	      joint = lw_robot_link_joint( m_robot.get(), path.back() ) )
	{
		path.push_back( lw_robot_joint_parent( m_robot.get(), joint ) );
	}
	return path;
}

std::vector<std::uint32_t> PairTable::variablesBetween( std::uint32_t link_a, std::uint32_t link_b ) const
{
	const lw_robot* const r = m_robot.get();
	std::vector<std::uint32_t> up = pathToRoot( link_a ), down = pathToRoot( link_b ), variables;
	while ( !up.empty() && !down.empty() && up.back() == down.back() )
	{
		up.pop_back();
		down.pop_back();
	}
	up.insert( up.end(), down.begin(), down.end() );
	for ( const std::uint32_t link : up )
	{
		const std::uint32_t joint = lw_robot_link_joint( r, link ), leader = lw_robot_joint_mimic( r, joint );
		const std::uint32_t driver = leader == LW_INVALID_INDEX ? joint : leader;
		const std::uint32_t first = lw_robot_joint_variable( r, driver );
		for ( std::uint32_t i = 0; first != LW_INVALID_INDEX && i < lw_robot_joint_variable_count( r, driver ); ++i )
		{
			variables.push_back( first + i );
		}
	}
	std::sort( variables.begin(), variables.end() );
	variables.erase( std::unique( variables.begin(), variables.end() ), variables.end() );
	return variables;
}

std::vector<double> PairTable::evidenceState( const PairRow& row ) const
{
	if ( !row.contact_state.empty() )
	{
		return row.contact_state;
	}
	std::vector<double> state( lw_robot_variable_count( m_robot.get() ) );
	const bool found = lw_reach_closest_state( m_reach.get(), row.link_a, row.link_b, state.data() );
	return found ? state : std::vector<double>();
}

NamedValues PairTable::evidence( const PairRow& row ) const
{
	NamedValues values;
	const std::vector<double> state = evidenceState( row );
	if ( !state.empty() )
	{
		for ( const std::uint32_t variable : variablesBetween( row.link_a, row.link_b ) )
		{
			values.emplace_back( io::variableName( m_robot.get(), variable ), state[variable] );
		}
	}
	return values;
}

bool PairTable::touch( LinkDistances& state, const PairRow& row )
{
	return !( state.measure( row.link_a, row.link_b, contact_range ).lower > 0 );
}

bool PairTable::touchByDesign( const PairRow& row )
{
	return row.contactShare() >= nearly_all || ( row.contactShare() >= most && row.pair.variable_count <= few_variables );
}

void PairTable::setContacts(
    std::size_t row, std::uint32_t contacts, std::uint32_t states, const std::vector<double>& state )
{
	PairRow& pair = m_rows[row];
	pair.contacts = contacts;
	pair.states = states;
	pair.always = pair.always && contacts == states;
	if ( contacts > 0 && pair.pair.closest > 0 )
	{
		setContactState( row, state );
	}
	pair.opinion = judge( pair, m_has_srdf );
}

void PairTable::setContactState( std::size_t row, const std::vector<double>& state )
{
	m_rows[row].pair.closest = 0;
	m_rows[row].contact_state = state;
	m_rows[row].opinion = judge( m_rows[row], m_has_srdf );
}

void PairTable::setNeverSeen( std::size_t row, std::uint64_t states )
{
	m_rows[row].never_seen = states;
	m_rows[row].opinion = judge( m_rows[row], m_has_srdf );
}

} // namespace leeway::pairs
