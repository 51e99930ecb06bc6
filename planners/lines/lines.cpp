// SPDX-License-Identifier: BSD-3-Clause
// The whole way: parts, attempts with other starts and other postures in between, and times.
#include "leeway/lines/lines.hpp"

#include "ik/random.hpp"
#include "lines/shares.hpp"

#include <algorithm>
#include <cmath>

namespace leeway::lines
{
namespace
{

constexpr double far_limits = 100;                   // radians or metres: postures are drawn about the start instead
constexpr double same_start = 0.02;                  // two starts that differ by less in every joint are one
constexpr int most_draws = 60, most_end_draws = 200; // of starts and of ends that have their pose
constexpr std::size_t most_ends = 16;
constexpr int back_steps = 16;
constexpr int share_rounds = 4;         // in which legs of a run share its time otherwise
constexpr std::size_t few_attempts = 8; // if no state has the last pose: to see where the way ends

void check( const Task& task, std::size_t variables )
{
	if ( !( task.tolerance > 0 && task.tolerance < HUGE_VAL ) || !( task.angle > 0 ) || !( task.speed > 0 ) )
	{
		wrong( "tolerance", "is no number above 0, or the speed is none", "give tolerances and a speed above 0" );
	}
	if ( task.free_axis && !( length( *task.free_axis ) > 0 && std::isfinite( length( *task.free_axis ) ) ) )
	{
		wrong( "free axis", "has no length", "give a direction such as 0,0,1" );
	}
	if ( !task.start.empty() && task.start.size() != variables )
	{
		wrong( "start", "has another number of values than the group has variables", "give a state of the group" );
	}
	if ( task.waypoints.size() < ( task.any_start ? 2u : 1u ) )
	{
		wrong( "waypoints", "are too few", "give one, and two if the first is the start" );
	}
}

class Planning
{
public:
	Planning( const io::RobotModel& robot, const io::Problem& problem, const Task& task, const Settings& settings )
	    : m_problem( problem ), m_task( task ), m_settings( settings ), m_follower( robot, problem, task ),
	      m_query( makeQuery( problem.checker.get() ) ), m_fit( m_follower, problem, task, settings, m_query.get() ),
	      m_random( settings.seed )
	{
		const std::vector<double> start = task.start.empty() ? io::startState( problem ) : task.start;
		m_start = Eigen::Map<const State>( start.data(), static_cast<Eigen::Index>( start.size() ) );
		m_runs = runsOf( problem, task, task.any_start ? task.waypoints.front().pose : m_follower.pose( m_start ) );
	}

	Result run()
	{
		const bool one_way = !m_task.any_start && !isRedundant();
		const auto most = [&] { return m_no_end ? std::min( few_attempts, m_settings.attempts ) : m_settings.attempts; };
		const auto isStopped = [&] { return m_settings.stop && m_settings.stop(); };
		while ( !m_result.solved && m_result.attempts < ( one_way ? 1 : most() ) && !isStopped() && attempt() )
		{
		}
		m_result.windows = m_fit.windows();
		m_result.states = m_fit.states();
		return m_result;
	}

private:
	const Leg& firstLeg() const { return m_runs.front().legs.front(); }
	const Leg& lastLeg() const { return m_runs.back().legs.back(); }
	bool hasOneLeg() const { return m_runs.size() == 1 && m_runs.front().legs.size() == 1; }

	double drawn( Eigen::Index i )
	{
		const double lower = m_follower.lower()[i], upper = m_follower.upper()[i];
		return upper - lower < far_limits ? m_random.between( lower, upper )
		                                  : std::clamp( m_start[i] + m_random.between( -M_PI, M_PI ), lower, upper );
	}

	State drawn()
	{
		State q( m_start.size() );
		for ( Eigen::Index i = 0; i < q.size(); ++i )
		{
			q[i] = drawn( i );
		}
		return q;
	}

	bool isRedundant() const { return m_follower.variables() > ( m_task.free_axis ? 5u : 6u ); }

	/// States at the end of the way, those that are free if some are: postures from which a way comes to the end.
	void findEnds()
	{
		std::vector<State> blocked;
		for ( int draw = 0; draw < most_end_draws && m_ends.size() < most_ends; ++draw )
		{
			State q = drawn();
			if ( m_follower.correct( lastLeg().pose( most_places ), q ) )
			{
				( m_fit.isFree( lastLeg(), most_places, q ) ? m_ends : blocked ).push_back( q );
			}
		}
		m_no_end = m_ends.empty() && blocked.empty();
	}

	/// Moves a state at the end of the way to its start, by steps that change the joints least. @return false: it does not come there
	bool stepBack( State& q )
	{
		for ( auto run = m_runs.rbegin(); run != m_runs.rend(); ++run )
		{
			for ( auto leg = run->legs.rbegin(); leg != run->legs.rend(); ++leg )
			{
				for ( int i = back_steps - 1; i >= 0; --i )
				{
					const double way = parameter( leg->course.to - leg->course.from ) * i / back_steps;
					const auto place = leg->course.from + static_cast<std::uint32_t>( way * most_places );
					if ( !m_follower.correct( leg->pose( place ), q ) )
					{
						return false;
					}
				}
			}
		}
		return true;
	}

	/// Start and wish of an attempt: the first from the given start without a wish; then in turn towards a state at the end, and with redundant
	/// joints towards a random posture. @return false: no start was found
	bool findWay( State& q, Wish& wish )
	{
		if ( m_result.attempts == 1 )
		{
			findEnds();
		}
		q = m_start;
		wish.posture = q;
		const bool to_end = !m_ends.empty() && m_result.attempts % 2 == 1;
		if ( to_end || ( m_result.attempts > 0 && isRedundant() ) )
		{
			wish.posture = to_end ? m_ends[m_random.below( m_ends.size() )] : drawn();
			wish.arrives = to_end && hasOneLeg();
			wish.strength = m_random.between( 0, 4 );
		}
		if ( !m_task.any_start )
		{
			return true;
		}
		State back = wish.posture;
		const bool found = to_end && m_result.attempts % 4 == 1 && stepBack( back );
		q = found ? back : q;
		return found || findStart( q );
	}

	/// A start that no attempt had, or any known one for other postures. @return false: none was found
	bool findStart( State& q )
	{
		for ( int draw = 0; draw < most_draws; ++draw )
		{
			q = m_starts.empty() && draw == 0 ? m_start : drawn();
			if ( !m_follower.correct( firstLeg().pose( 0 ), q ) )
			{
				continue;
			}
			m_reached = true;
			const bool known = std::any_of( m_starts.begin(), m_starts.end(),
			    [&]( const State& other ) { return ( other - q ).cwiseAbs().maxCoeff() < same_start; } );
			if ( !known )
			{
				m_starts.push_back( q );
				return true;
			}
		}
		if ( isRedundant() && !m_starts.empty() )
		{
			q = m_starts[m_random.below( m_starts.size() )];
			return true;
		}
		return false;
	}

	/// @return false: no other attempt is of use
	bool attempt()
	{
		State q;
		Wish wish;
		if ( !findWay( q, wish ) )
		{
			if ( !m_reached )
			{
				m_result.stop.obstacle = Obstacle::UNREACHABLE;
				const double* t = firstLeg().def.start.t;
				m_result.stop.position = { t[0], t[1], t[2] };
			}
			return false;
		}
		++m_result.attempts;
		std::vector<std::vector<Piece>> pieces( m_runs.size() );
		std::size_t run = 0;
		bool good = m_fit.isFree( firstLeg(), 0, q );
		const bool hopeless = !good && !m_task.any_start;
		while ( good && run < m_runs.size() )
		{
			const State begin = q;
			good = m_fit.run( m_runs[run], wish, q, pieces[run] );
			good ? share( m_runs[run], wish, begin, q, pieces[run] ) : void();
			run += good ? 1 : 0;
		}
		if ( good )
		{
			m_result.solved = true;
			m_result.stop = {};
			time( pieces );
			return true;
		}
		const Stop& stop = m_fit.stop();
		const Stop& best = m_result.stop;
		if ( best.obstacle == Obstacle::NONE ||
		     stop.part + stop.fraction > static_cast<double>( best.part ) + best.fraction )
		{
			m_result.stop = stop;
		}
		return !hopeless;
	}

	/// Other shares of the time for the legs of a run, as long as they make it shorter and are proved.
	/// @param begin state @param q its end @param pieces of the run
	void share( Run& run, const Wish& wish, const State& begin, State& q, std::vector<Piece>& pieces )
	{
		for ( int round = 0; run.legs.size() > 1 && round < share_rounds; ++round )
		{
			const Courses courses = coursesOf( run );
			const std::int64_t before = nanoseconds( run, pieces );
			std::vector<Piece> shared;
			State end = begin;
			if ( !shareTime( run, pieces, m_settings.limits, m_task.speed ) )
			{
				return;
			}
			if ( !m_fit.run( run, wish, end, shared ) || nanoseconds( run, shared ) >= before )
			{
				setCourses( run, courses );
				return;
			}
			pieces = std::move( shared );
			q = end;
		}
	}

	/// Nanoseconds for a run: a whole number for each place.
	std::int64_t nanoseconds( const Run& run, const std::vector<Piece>& pieces ) const
	{
		const std::size_t count = m_follower.variables();
		double seconds = 0;
		for ( const Leg& leg : run.legs )
		{
			seconds = std::max( seconds, leg.course.mostFlow() * leg.length / m_task.speed );
		}
		for ( const Piece& piece : pieces )
		{
			const double width = static_cast<double>( piece.to - piece.from ) / most_places;
			for ( std::size_t v = 0; v < count; ++v )
			{
				const double* p = piece.points.data() + v;
				for ( std::size_t k = 0; k < 3; ++k )
				{
					const double speed = 3 * std::fabs( p[( k + 1 ) * count] - p[k * count] ) / width;
					seconds = std::max( seconds, speed / m_settings.limits.velocity[v] );
				}
				for ( std::size_t k = 0; k < 2; ++k )
				{
					const double change =
					    6 * std::fabs( p[( k + 2 ) * count] - 2 * p[( k + 1 ) * count] + p[k * count] ) / ( width * width );
					seconds = std::max( seconds, std::sqrt( change / m_settings.limits.acceleration[v] ) );
				}
				// Inside of a piece: from one to the next the acceleration jumps
				const double third =
				    6 * std::fabs( p[3 * count] - 3 * p[2 * count] + 3 * p[count] - p[0] ) / std::pow( width, 3 );
				seconds = std::max( seconds, std::cbrt( third / m_settings.limits.mostJerk( v ) ) );
			}
		}
		return ( static_cast<std::int64_t>( std::ceil( seconds * ( 1 + 1e-7 ) * 1e9 / most_places ) ) + 1 ) * most_places;
	}

	void time( const std::vector<std::vector<Piece>>& pieces )
	{
		std::int64_t begin = 0;
		for ( std::size_t i = 0; i < m_runs.size(); ++i )
		{
			const std::int64_t all = nanoseconds( m_runs[i], pieces[i] ), one = all / most_places;
			const auto paceOf = [&]( const Course& course )
			{
				return Pace{ 1e-9 * static_cast<double>( begin + one * course.from ),
				    1e-9 * static_cast<double>( one * ( course.to - course.from ) ), course.first, course.last };
			};
			for ( std::size_t number = 0; number < m_runs[i].legs.size(); ++number )
			{
				const Leg& leg = m_runs[i].legs[number];
				Part part;
				part.region = leg.def;
				part.pace = paceOf( leg.course );
				part.begin = part.pace.begin;
				part.seconds = part.pace.seconds;
				part.part = leg.part;
				part.turns_apart = leg.turns_apart;
				part.turning = leg.turning;
				part.turning_pace = paceOf( leg.turning_course );
				part.first = m_result.segments.size();
				for ( const Piece& piece : pieces[i] )
				{
					piece.leg == number ? add( piece, begin, one ) : void();
				}
				part.count = m_result.segments.size() - part.first;
				m_result.parts.push_back( part );
			}
			begin += all;
		}
	}

	/// @param one nanoseconds of a place
	void add( const Piece& piece, std::int64_t begin, std::int64_t one )
	{
		motions::Segment segment;
		segment.begin = 1e-9 * static_cast<double>( begin + one * piece.from );
		segment.seconds = 1e-9 * static_cast<double>( one * ( piece.to - piece.from ) );
		segment.degree = 3;
		segment.points = piece.points;
		m_result.segments.push_back( segment );
		m_result.position_error = std::max( m_result.position_error, piece.position_error );
		m_result.angle_error = std::max( m_result.angle_error, piece.angle_error );
	}

	const io::Problem& m_problem;
	const Task& m_task;
	const Settings& m_settings;
	Follower m_follower;
	const Query m_query;
	Fit m_fit;
	ik::Random m_random;
	State m_start;
	std::vector<Run> m_runs;
	std::vector<State> m_starts, m_ends;
	bool m_no_end = false; ///< no state has the last pose, as far as findEnds() sees
	bool m_reached = false;
	Result m_result;
};

} // namespace

Result planLines( const io::RobotModel& robot, const io::Problem& problem, const Task& task, const Settings& settings )
{
	check( task, problem.variables.size() );
	return Planning( robot, problem, task, settings ).run();
}

Task taskOf( const io::Problem& problem, const io::CartesianWay& way, const Task& with, const std::string& file,
    const std::string& element )
{
	Task task = with;
	task.tip = io::findFrame( problem, way.link, file, element + "link_name" );
	task.tip.pose = lw_transform_multiply( &task.tip.pose, &with.tip.pose );
	task.base = io::findFrame( problem, way.frame, file, element + "header.frame_id" );
	for ( const lw_transform& pose : way.poses )
	{
		task.waypoints.push_back( { pose } );
	}
	task.speed = way.speed > 0 ? std::min( way.speed, with.speed ) : with.speed;
	return task;
}

} // namespace leeway::lines
