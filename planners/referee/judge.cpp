// SPDX-License-Identifier: BSD-3-Clause
#include "referee/judge.hpp"

#include "leeway/handles.hpp"
#include "motions/seconds.hpp"
#include "referee/columns.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace leeway::referee
{
namespace
{

constexpr double largest_gap = 1e-6; // radians and metres between pieces of a spline
constexpr double deepest_seconds = 1;

using motions::Segment;

std::vector<double> valueAt( const Segment& segment, std::size_t count, double t )
{
	std::vector<double> row = segment.points;
	for ( std::size_t level = segment.degree; level > 0; --level )
	{
		for ( std::size_t i = 0; i < level * count; ++i )
		{
			row[i] += t * ( row[i + count] - row[i] );
		}
	}
	row.resize( count );
	return row;
}

/// In the order of the group.
std::vector<double> ordered( const std::vector<double>& rows, const std::vector<std::size_t>& columns )
{
	std::vector<double> out;
	for ( std::size_t row = 0; row < rows.size() / columns.size(); ++row )
	{
		for ( const std::size_t column : columns )
		{
			out.push_back( rows[row * columns.size() + column] );
		}
	}
	return out;
}

std::vector<Segment> edgesOf( const io::Problem& problem, const Item& item, std::vector<std::string>& problems )
{
	const std::vector<std::size_t> columns =
	    groupColumns( problem, item.joint_names, item.points.front().size(), item.file, item.element );
	std::vector<std::vector<double>> points;
	for ( const std::vector<double>& point : item.points )
	{
		points.push_back( ordered( point, columns ) );
		for ( const std::string& violation :
		    motions::groupLimitViolations( problem, points.back(), motions::limit_tolerance ) )
		{
			problems.push_back( fmt::format( "point {}: {}", points.size(), violation ) );
		}
	}
	points = motions::unwrapped( problem, std::move( points ) );
	std::vector<Segment> segments;
	for ( std::size_t i = 0; i == 0 || i + 1 < points.size(); ++i )
	{
		Segment segment;
		segment.begin = double( i );
		segment.seconds = 1;
		segment.points = points[i];
		const std::vector<double>& to = points[std::min( i + 1, points.size() - 1 )];
		segment.points.insert( segment.points.end(), to.begin(), to.end() );
		segments.push_back( std::move( segment ) );
	}
	return segments;
}

std::vector<Segment> splineOf( const io::Problem& problem, const Item& item, std::vector<std::string>& problems )
{
	std::vector<Segment> segments = item.segments;
	const std::size_t count = segments.front().points.size() / ( segments.front().degree + 1 );
	const std::vector<std::size_t> columns = groupColumns( problem, item.joint_names, count, item.file, item.element );
	for ( std::size_t i = 0; i < segments.size(); ++i )
	{
		if ( segments[i].points.size() != ( segments[i].degree + 1 ) * count )
		{
			throw io::Error( item.file, item.element, fmt::format( "its piece {} has another number of joints", i + 1 ),
			    "give all pieces the same joints" );
		}
		segments[i].points = ordered( segments[i].points, columns );
		double gap = 0;
		for ( std::size_t v = 0; i > 0 && v < count; ++v )
		{
			gap = std::max(
			    gap, std::fabs( segments[i].points[v] - segments[i - 1].points[segments[i - 1].degree * count + v] ) );
		}
		if ( gap > largest_gap )
		{
			problems.push_back( fmt::format( "at {:.6g} s a joint jumps by {:.3g}", segments[i].begin, gap ) );
		}
	}
	return segments;
}

/// Interpolations of a trajectory.
std::string interpolations( const motions::TrajectoryAudit& audit )
{
	std::string text;
	for ( const auto& [degree, name] :
	    { std::pair( 1U, "straight" ), std::pair( 3U, "cubic" ), std::pair( 5U, "quintic" ) } )
	{
		if ( audit.by_degree[degree] > 0 )
		{
			text += fmt::format( "{}{} {}", text.empty() ? "" : ", ", audit.by_degree[degree], name );
		}
	}
	return text;
}

class MotionJudge
{
public:
	MotionJudge( const io::Problem& problem, const io::RobotModel& robot, const Item& item, const JudgeSettings& settings )
	    : m_problem( problem ), m_robot( robot ), m_item( item ), m_settings( settings )
	{
	}

	Ruling run()
	{
		motions::TrajectorySettings settings;
		settings.edge.min_d = m_settings.region.min_d;
		settings.edge.flags = m_settings.region.flags;
		settings.interpolation = m_settings.interpolation;
		settings.limits = m_settings.limits;
		const std::map<std::string, double> none;
		settings.tolerance = motions::tolerances(
		    m_problem, m_item.file, m_item.trajectory ? m_item.trajectory->path_tolerance : none, m_settings.tolerance );
		m_item.trajectory ? judgeTrajectory( settings ) : judgeSegments( settings );
		if ( !settings.tolerance.empty() )
		{
			m_ruling.assumed.emplace_back( "deviations stay within the tolerances" );
		}
		if ( m_ruling.verdict == LW_VERDICT_BLOCKED )
		{
			findDeepest();
		}
		return m_ruling;
	}

private:
	void take( const motions::TrajectoryAudit& audit )
	{
		m_ruling.verdict = audit.violation.verdict;
		m_ruling.lower_bound = audit.lower_bound;
		m_ruling.q = audit.violation.q;
		m_ruling.self = audit.violation.self;
		m_ruling.pair = audit.violation.pair;
		m_ruling.place = m_ruling.verdict == LW_VERDICT_FREE ? "" : placeOf( audit.violation.time );
	}

	void judgeTrajectory( const motions::TrajectorySettings& settings )
	{
		m_ruling.kind = "trajectory";
		motions::Drive drive( m_settings.start );
		const motions::TrajectoryAudit& audit = drive.add( m_problem, m_robot, *m_item.trajectory, settings );
		m_ruling.segments = drive.segments();
		m_ruling.problems = audit.problems;
		m_ruling.assumed.push_back( fmt::format( "between points: {}", interpolations( audit ) ) );
		for ( const io::Notice& notice : drive.notices() )
		{
			m_ruling.assumed.push_back( notice.text );
		}
		take( audit );
	}

	void judgeSegments( const motions::TrajectorySettings& settings )
	{
		const bool is_path = m_item.segments.empty();
		m_ruling.kind = is_path ? "path" : "spline";
		m_ruling.segments =
		    is_path ? edgesOf( m_problem, m_item, m_ruling.problems ) : splineOf( m_problem, m_item, m_ruling.problems );
		if ( m_item.joint_names.empty() )
		{
			m_ruling.assumed.emplace_back( "columns are the group's variables in their order" );
		}
		const motions::TrajectoryAudit audit =
		    motions::auditTrajectory( m_problem, m_robot, m_item.file, m_ruling.segments, settings );
		if ( is_path )
		{
			m_ruling.assumed.emplace_back(
			    "straight from point to point, the shorter way around for joints without end; no times, so no velocities" );
		}
		else
		{
			m_ruling.problems.insert( m_ruling.problems.end(), audit.problems.begin(), audit.problems.end() );
			m_ruling.assumed.emplace_back( "driven as the spline says; joints without end are not wrapped" );
		}
		take( audit );
	}

	std::string placeOf( double time ) const
	{
		if ( m_ruling.kind != "path" )
		{
			return fmt::format( "{:.4f} s", time );
		}
		const std::size_t edge = std::min( static_cast<std::size_t>( std::max( time, 0.0 ) ), m_ruling.segments.size() - 1 );
		return fmt::format( "edge {}, t {:.4f}", edge + 1, time - double( edge ) );
	}

	void findDeepest()
	{
		const auto begin = std::chrono::steady_clock::now();
		const Query query = makeQuery( m_problem.checker.get() );
		const auto look = [&]( const Segment& segment, double t )
		{
			const std::vector<double> q = valueAt( segment, m_ruling.q.size(), t );
			const std::optional<Contact> contact = deepestContact( m_problem, query.get(), q, m_settings.region.flags );
			if ( contact && m_ruling.depth < contact->depth )
			{
				m_ruling.worst = q;
				m_ruling.worst_place = placeOf( segment.begin + t * segment.seconds );
				m_ruling.depth = contact->depth;
				m_ruling.pair = contact->pair;
				m_ruling.self = contact->self;
			}
		};
		m_ruling.worst = m_ruling.q;
		m_ruling.worst_place = m_ruling.place;
		const std::size_t steps = std::max<std::size_t>( 8, 200 / m_ruling.segments.size() );
		for ( const Segment& segment : m_ruling.segments )
		{
			for ( std::size_t i = 0; i <= steps && secondsSince( begin ) < deepest_seconds; ++i )
			{
				look( segment, double( i ) / double( steps ) );
			}
		}
	}

	const io::Problem& m_problem;
	const io::RobotModel& m_robot;
	const Item& m_item;
	const JudgeSettings& m_settings;
	Ruling m_ruling;
};

Ruling judgeOfRegion( const io::Problem& problem, const Item& item, const JudgeSettings& settings )
{
	Ruling ruling;
	ruling.kind = "region";
	ruling.region = judgeRegion( problem, *item.region, settings.region );
	ruling.verdict = ruling.region.verdict;
	ruling.assumed.emplace_back( "of the region, that part is judged which is within the joint limits" );
	if ( item.region->joint_names.empty() )
	{
		ruling.assumed.emplace_back( "columns are the group's variables in their order" );
	}
	if ( ruling.verdict == LW_VERDICT_BLOCKED )
	{
		ruling.q = ruling.region.q;
		ruling.worst = ruling.region.worst;
		ruling.pair = ruling.region.pair;
		ruling.self = ruling.region.self;
		ruling.place = ruling.worst_place = "a state of the region";
		ruling.depth = ruling.region.depth;
	}
	return ruling;
}

std::string stateText( const std::vector<std::string>& names, const std::vector<double>& q )
{
	std::string text;
	for ( std::size_t i = 0; i < q.size(); ++i )
	{
		text += fmt::format( "{}{} {:.6g}", i == 0 ? "" : ", ", names[i], q[i] );
	}
	return text;
}

std::string depthText( const Ruling& ruling )
{
	const Depth& depth = ruling.depth;
	if ( depth.most - depth.least < 1e-5 && depth.least > 0 )
	{
		return fmt::format( "{:.2f} mm deep", 1e3 * depth.least );
	}
	return depth.most <= 0 ? "touching, without a depth"
	                       : fmt::format( "{:.2f} to {:.2f} mm deep", 1e3 * depth.least, 1e3 * depth.most );
}

/// The reason in a few words.
std::string headline( const Ruling& ruling )
{
	const std::string pair = fmt::format( "{} - {}", ruling.pair.first, ruling.pair.second );
	switch ( ruling.verdict )
	{
	case LW_VERDICT_BLOCKED:
		return ruling.kind == "region" ? fmt::format( "a state of it collides: {}, {}", pair, depthText( ruling ) )
		                               : fmt::format( "collides from {} on: {}, {} at {}", ruling.place, pair,
		                                     depthText( ruling ), ruling.worst_place );
	case LW_VERDICT_FREE:
		return ruling.kind == "region" ? fmt::format( "all of it is proved, in {} boxes", ruling.region.boxes )
		                               : fmt::format( "proved, clearance at least {:.6f} m", ruling.lower_bound );
	default:
		return ruling.kind == "region" ? fmt::format( "no collision found in {} states; {:.1f} % is proved, in {} boxes",
		                                     ruling.region.states, 100 * ruling.region.proved, ruling.region.boxes )
		                               : fmt::format( "neither proved nor colliding: {} at {}", pair, ruling.place );
	}
}

/// Without characters that XML cannot hold.
std::string printable( std::string text )
{
	std::replace_if(
	    text.begin(), text.end(), []( char c ) { return static_cast<unsigned char>( c ) < 32 && c != '\n'; }, '?' );
	return text;
}

} // namespace

bool Ruling::passes( Policy policy ) const
{
	return policy == Policy::collision ? verdict == LW_VERDICT_FREE || verdict == LW_VERDICT_UNDECIDED
	                                   : verdict == LW_VERDICT_FREE && problems.empty();
}

Ruling judge( const io::Problem& problem, const io::RobotModel& robot, const Item& item, const JudgeSettings& settings )
{
	const auto begin = std::chrono::steady_clock::now();
	Ruling ruling =
	    item.region ? judgeOfRegion( problem, item, settings ) : MotionJudge( problem, robot, item, settings ).run();
	ruling.name = item.name;
	ruling.names = problem.variable_names;
	ruling.seconds = secondsSince( begin );
	return ruling;
}

std::string describe( const Ruling& ruling )
{
	std::string text = fmt::format(
	    "{:<10}{:<11}{}: {}\n", lw_verdict_name( ruling.verdict ), ruling.kind, ruling.name, headline( ruling ) );
	if ( ruling.verdict == LW_VERDICT_BLOCKED )
	{
		text += fmt::format( "          state      {}\n", stateText( ruling.names, ruling.worst ) );
	}
	for ( const std::string& problem : ruling.problems )
	{
		text += fmt::format( "          problem    {}\n", problem );
	}
	for ( const std::string& assumed : ruling.assumed )
	{
		text += fmt::format( "          assumed    {}\n", assumed );
	}
	return text;
}

motions::Json toJson( const Ruling& ruling, Policy policy )
{
	motions::Json json;
	json["name"] = ruling.name;
	json["kind"] = ruling.kind;
	json["passed"] = ruling.passes( policy );
	json["verdict"] = lw_verdict_name( ruling.verdict );
	json["reason"] = headline( ruling );
	json["problems"] = ruling.problems;
	json["assumed"] = ruling.assumed;
	if ( ruling.verdict != LW_VERDICT_FREE && !ruling.q.empty() )
	{
		json["first"] = { { "place", ruling.place }, { "state", ruling.q } };
		json["pair"] = { ruling.pair.first, ruling.pair.second };
	}
	if ( ruling.verdict == LW_VERDICT_BLOCKED )
	{
		json["worst"] = { { "place", ruling.worst_place }, { "state", ruling.worst },
		    { "depth", { ruling.depth.least, ruling.depth.most } } };
	}
	if ( ruling.kind == "region" )
	{
		json["region"] = { { "states", ruling.region.states }, { "descents", ruling.region.descents },
		    { "boxes", ruling.region.boxes }, { "proved_share", ruling.region.proved } };
	}
	else if ( ruling.verdict == LW_VERDICT_FREE )
	{
		json["lower_bound"] = motions::jsonNumber( ruling.lower_bound );
	}
	json["joint_names"] = ruling.names;
	json["seconds"] = ruling.seconds;
	return json;
}

std::string junit( const std::vector<Ruling>& rulings, Policy policy, const std::string& robot )
{
	const auto failures =
	    std::count_if( rulings.begin(), rulings.end(), [&]( const Ruling& ruling ) { return !ruling.passes( policy ); } );
	double seconds = 0;
	for ( const Ruling& ruling : rulings )
	{
		seconds += ruling.seconds;
	}
	const auto told = []( double value ) { return fmt::format( "{:.3f}", value ); };
	tinyxml2::XMLPrinter out;
	out.PushDeclaration( "xml version=\"1.0\" encoding=\"UTF-8\"" );
	out.OpenElement( "testsuite" );
	out.PushAttribute( "name", printable( "leeway referee " + robot ).c_str() );
	out.PushAttribute( "tests", static_cast<int64_t>( rulings.size() ) );
	out.PushAttribute( "failures", static_cast<int64_t>( failures ) );
	out.PushAttribute( "time", told( seconds ).c_str() );
	for ( const Ruling& ruling : rulings )
	{
		out.OpenElement( "testcase" );
		out.PushAttribute( "classname", printable( "leeway.referee." + ruling.kind ).c_str() );
		out.PushAttribute( "name", printable( ruling.name ).c_str() );
		out.PushAttribute( "time", told( ruling.seconds ).c_str() );
		if ( !ruling.passes( policy ) )
		{
			out.OpenElement( "failure" );
			out.PushAttribute( "type", lw_verdict_name( ruling.verdict ) );
			out.PushAttribute( "message", printable( headline( ruling ) ).c_str() );
			out.PushText( printable( describe( ruling ) ).c_str() );
			out.CloseElement();
		}
		out.CloseElement();
	}
	out.CloseElement();
	return out.CStr();
}

} // namespace leeway::referee
