// SPDX-License-Identifier: BSD-3-Clause
// Paths as numbers that go on without jumps.
#include "leeway/planners/unwrap.hpp"

#include "space.hpp"

#include <cmath>

namespace leeway::planners
{

namespace
{

constexpr double same = 1e-9; // radians or metres: a start that came through another library's state

/// Variables of a group that have several numbers for one state.
class Equivalents
{
public:
	explicit Equivalents( const lw_checker* checker )
	{
		const lw_robot* robot = lw_checker_robot( checker );
		for ( std::uint32_t i = 0; i < lw_checker_variable_count( checker ); ++i )
		{
			const lw_variable_info info = lw_robot_variable( robot, lw_checker_variable( checker, i ) );
			const bool first = lw_robot_joint_type( robot, info.joint ) == LW_JOINT_FLOATING && info.component == 3;
			m_kinds.push_back( info.wraps ? Kind::ANGLE : first ? Kind::QUATERNION : Kind::NUMBER );
		}
	}

	/// Rewrites `to` as the equivalent that is nearest to `from`. @return true if a number changed
	bool follow( const double* from, double* to ) const
	{
		bool changed = false;
		for ( std::size_t i = 0; i < m_kinds.size(); ++i )
		{
			if ( m_kinds[i] == Kind::ANGLE )
			{
				const double turns = std::nearbyint( ( from[i] - to[i] ) / full_turn );
				changed = changed || turns != 0;
				to[i] = turns != 0 ? to[i] + turns * full_turn : to[i];
			}
			else if ( m_kinds[i] == Kind::QUATERNION && dot( from + i, to + i ) < 0 )
			{
				changed = true;
				for ( std::size_t k = i; k < i + 4; ++k )
				{
					to[k] = -to[k];
				}
			}
		}
		return changed;
	}

private:
	enum class Kind
	{
		NUMBER,
		ANGLE,
		QUATERNION ///< the first of its four
	};

	static double dot( const double* a, const double* b ) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]; }

	std::vector<Kind> m_kinds;
};

} // namespace

bool unwrap( const lw_checker* checker, const double* start, Path& path )
{
	const Equivalents equivalents( checker );
	const std::vector<double> before(
	    path.values.begin(), path.values.begin() + static_cast<std::ptrdiff_t>( path.dimension ) );
	std::vector<double> first = before;
	equivalents.follow( start, first.data() );
	double off = 0;
	for ( std::size_t i = 0; i < first.size(); ++i )
	{
		off = std::max( off, std::fabs( first[i] - start[i] ) );
	}
	if ( off <= same )
	{
		first.assign( start, start + path.dimension );
	}
	std::copy( first.begin(), first.end(), path.values.begin() );
	bool changed = first != before;
	for ( std::size_t i = 1; i < path.count(); ++i )
	{
		changed = equivalents.follow( path[i - 1], path[i] ) || changed;
	}
	return changed;
}

lw_status areFree( const lw_checker* checker, lw_query* query, const lw_edge_def& edge, const Path& path, bool& free,
    Statistics* statistics )
{
	free = true;
	for ( std::size_t i = 0; free && i + 1 < path.count(); ++i )
	{
		lw_edge_result result;
		const lw_status status = lw_checker_edge( checker, query, path[i], path[i + 1], &edge, &result );
		if ( status != LW_OK )
		{
			free = false;
			return status;
		}
		free = result.verdict == LW_VERDICT_FREE;
		if ( statistics != nullptr )
		{
			++statistics->edges;
			++( free                                   ? statistics->free
			    : result.verdict == LW_VERDICT_BLOCKED ? statistics->blocked
			                                           : statistics->undecided );
			statistics->edge_queries += result.queries;
		}
	}
	return LW_OK;
}

} // namespace leeway::planners
