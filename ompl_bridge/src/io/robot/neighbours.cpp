// SPDX-License-Identifier: BSD-3-Clause
// Pairs of links that a robot without an SRDF does not check.
//
// Shapes of neighbours overlap by design: with all pairs checked hardly a robot has a free state. Other programs leave out parent
// and child too. Links that are in contact in every state that is tried are shapes that overlap, and no collision that a motion
// could avoid.
#include "robot/neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <random>
#include <set>

namespace leeway::io::detail
{

namespace
{

constexpr std::size_t state_count = 200;

using LinkPair = std::pair<std::size_t, std::size_t>; ///< indices of links, the lesser first

/// In [0, 1), the same on every machine.
double fraction( std::mt19937_64& random )
{
	return static_cast<double>( random() >> 11 ) * 0x1p-53;
}

class NeighbourFinder
{
public:
	explicit NeighbourFinder( RobotModel& model ) : m_model( model ), m_robot( createRobot( model, allowed() ) )
	{
		lw_query* query = nullptr;
		const lw_query_def def = lw_query_def_default();
		require( lw_query_create( &def, nullptr, nullptr, nullptr, &query ), "lw_query_create" );
		m_query.reset( query );
	}
	void findJoined();
	void findTouching();
	std::vector<DisabledPair> found;

private:
	std::vector<std::pair<std::string, std::string>> allowed() const;
	bool isSolid( std::size_t link ) const;
	void add( std::size_t a, std::size_t b, const std::string& reason );
	std::vector<LinkPair> pairsToTry() const;
	bool touch( const LinkPair& pair, const std::vector<lw_transform>& poses ) const;
	std::vector<lw_transform> posesAt( std::size_t state, std::mt19937_64& random ) const;

	RobotModel& m_model;
	Robot m_robot;
	std::unique_ptr<lw_query, decltype( &lw_query_destroy )> m_query{ nullptr, &lw_query_destroy };
	std::set<LinkPair> m_found;
};

std::vector<std::pair<std::string, std::string>> NeighbourFinder::allowed() const
{
	std::vector<std::pair<std::string, std::string>> pairs;
	const auto known = [&]( const std::string& name )
	{
		return std::any_of(
		    m_model.links.begin(), m_model.links.end(), [&]( const LinkModel& link ) { return link.name == name; } );
	};
	for ( const DisabledPair& pair : m_model.disabled )
	{
		if ( known( pair.link1 ) && known( pair.link2 ) )
		{
			pairs.emplace_back( pair.link1, pair.link2 );
		}
	}
	return pairs;
}

/// Whether the link has shapes that the core's robot has.
bool NeighbourFinder::isSolid( std::size_t link ) const
{
	const std::vector<PlacedShape>& shapes = m_model.links[link].collision;
	return std::any_of( shapes.begin(), shapes.end(), []( const PlacedShape& shape ) { return !isUnbounded( shape ); } );
}

void NeighbourFinder::add( std::size_t a, std::size_t b, const std::string& reason )
{
	if ( m_found.insert( std::minmax( a, b ) ).second )
	{
		found.push_back( { m_model.links[a].name, m_model.links[b].name, reason } );
	}
}

/// Each link and the nearest link with geometry above it.
void NeighbourFinder::findJoined()
{
	std::map<std::string, std::size_t> index;
	for ( std::size_t i = 0; i < m_model.links.size(); ++i )
	{
		index.emplace( m_model.links[i].name, i );
	}
	std::map<std::string, const JointModel*> joint_above;
	for ( const JointModel& joint : m_model.joints )
	{
		joint_above.emplace( joint.child, &joint );
	}
	for ( std::size_t i = 0; i < m_model.links.size(); ++i )
	{
		auto joint = joint_above.find( m_model.links[i].name );
		const JointModel* moving = nullptr; // fixed links are rigid anyway
		while ( isSolid( i ) && joint != joint_above.end() )
		{
			moving = moving == nullptr && joint->second->type != LW_JOINT_FIXED ? joint->second : moving;
			const std::size_t parent = index.at( joint->second->parent );
			if ( isSolid( parent ) )
			{
				if ( moving != nullptr )
				{
					add( parent, i, fmt::format( "Adjacent (joined by {})", moving->name ) );
				}
				break;
			}
			joint = joint_above.find( joint->second->parent );
		}
	}
}

std::vector<LinkPair> NeighbourFinder::pairsToTry() const
{
	std::vector<LinkPair> pairs;
	for ( std::size_t a = 0; a < m_model.links.size(); ++a )
	{
		for ( std::size_t b = a + 1; isSolid( a ) && b < m_model.links.size(); ++b )
		{
			const bool allowed =
			    lw_robot_pair_allowed( m_robot.get(), static_cast<std::uint32_t>( a ), static_cast<std::uint32_t>( b ) );
			if ( isSolid( b ) && !allowed && m_found.count( { a, b } ) == 0 )
			{
				pairs.emplace_back( a, b );
			}
		}
	}
	return pairs;
}

/// Poses of all links: at the default state, then at random ones. Joints without limits turn once and shift by a metre. Empty: unknown.
std::vector<lw_transform> NeighbourFinder::posesAt( std::size_t state, std::mt19937_64& random ) const
{
	const lw_robot* robot = m_robot.get();
	std::vector<double> q( lw_robot_variable_count( robot ) );
	lw_robot_default_state( robot, q.data() );
	for ( std::uint32_t i = 0; state > 0 && i < q.size(); ++i )
	{
		const lw_variable_info info = lw_robot_variable( robot, i );
		const bool bounded = std::isfinite( info.lower ) && std::isfinite( info.upper ) && !info.wraps;
		const double reach = info.wraps ? pi : 1;
		const double lower = bounded ? info.lower : -reach, upper = bounded ? info.upper : reach;
		q[i] = lower + ( upper - lower ) * fraction( random );
	}
	std::vector<lw_transform> poses( lw_robot_link_count( robot ) );
	if ( lw_robot_fk( robot, q.data(), poses.data() ) != LW_OK )
	{
		poses.clear(); // a zero quaternion, or values beyond all numbers
	}
	return poses;
}

bool NeighbourFinder::touch( const LinkPair& pair, const std::vector<lw_transform>& poses ) const
{
	const lw_range near = { 0, 1e-9, 0 };
	for ( const PlacedShape& one : m_model.links[pair.first].collision )
	{
		for ( const PlacedShape& other : m_model.links[pair.second].collision )
		{
			if ( isUnbounded( one ) || isUnbounded( other ) )
			{
				continue;
			}
			const lw_transform a = lw_transform_multiply( &poses[pair.first], &one.pose );
			const lw_transform b = lw_transform_multiply( &poses[pair.second], &other.pose );
			lw_clearance clearance;
			const lw_status status =
			    lw_shape_distance( one.shape.get(), &a, other.shape.get(), &b, &near, m_query.get(), &clearance );
			if ( status == LW_OK && clearance.kind == LW_CLEARANCE_VIOLATION )
			{
				return true;
			}
		}
	}
	return false; // also where nothing could be measured: the pair is checked
}

void NeighbourFinder::findTouching()
{
	std::mt19937_64 random( 1 );
	std::vector<LinkPair> pairs = pairsToTry();
	for ( std::size_t state = 0; state <= state_count && !pairs.empty(); ++state )
	{
		const std::vector<lw_transform> poses = posesAt( state, random );
		const auto apart = [&]( const LinkPair& pair )
		{ return poses.empty() || !touch( pair, poses ); }; // unknown: checked
		pairs.erase( std::remove_if( pairs.begin(), pairs.end(), apart ), pairs.end() );
	}
	for ( const auto& [a, b] : pairs )
	{
		add( a, b, fmt::format( "Always (in contact in all of {} random states)", state_count ) );
	}
}

} // namespace

void allowNeighbours( RobotModel& model, bool joined )
{
	NeighbourFinder finder( model );
	if ( joined )
	{
		finder.findJoined();
	}
	finder.findTouching();
	if ( finder.found.empty() )
	{
		return;
	}
	std::vector<std::string> names;
	for ( const DisabledPair& pair : finder.found )
	{
		names.push_back( fmt::format( "{} - {} ({})", pair.link1, pair.link2,
		    pair.reason.compare( 0, 6, "Always" ) == 0 ? "always in contact"
		                                               : pair.reason.substr( 10, pair.reason.size() - 11 ) ) );
	}
	model.report.notices.push_back( { model.urdf_file, "no SRDF",
	    fmt::format( "contact of {} pairs of links is allowed, and checked with --strict: {}", finder.found.size(),
	        joinNames( names, names.size() ) ) } );
	model.disabled.insert( model.disabled.end(), finder.found.begin(), finder.found.end() );
}

} // namespace leeway::io::detail
