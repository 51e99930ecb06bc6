// SPDX-License-Identifier: BSD-3-Clause
// Inverse kinematics of one frame: descents from the start and from random states, judged by the engine's forward kinematics.
//
// A joint whose limits are a whole turn or more apart is a circle during a descent, and turned back into its limits after it: such limits stop
// no descent.
#include "leeway/ik/inverse.hpp"

#include "ik/goal_parts.hpp"
#include "ik/pose_errors.hpp"
#include "ik/random.hpp"
#include "ik/solver.hpp"

#include <fmt/format.h>

#include <optional>

namespace leeway::ik
{
namespace
{

constexpr std::size_t pose_freedoms = 6;
constexpr std::size_t searches_beyond = 40; // the limits, to see whether it is these

using State = std::vector<double>;

[[noreturn]] void wrong( const std::string& element, const std::string& problem, const std::string& remedy )
{
	throw io::Error( "inverse kinematics", element, problem, remedy );
}

void check( const InverseOptions& options )
{
	if ( options.states < 1 || options.searches < 1 || !( options.patience >= 0 ) || !( options.apart > 0 ) )
	{
		wrong(
		    "options", "states or searches are 0, patience is below 0, or `apart` is not above 0", "give numbers above 0" );
	}
	if ( options.clearances && !( options.min_d >= 0 && options.max_d > options.min_d ) )
	{
		wrong( "options", "min_d is below 0, or max_d is not above it", "give 0 <= min_d < max_d" );
	}
}

} // namespace

class Inverse::Search
{
public:
	Search( const io::RobotModel& robot, const io::Problem& problem, const io::Frame& tip, const io::Frame& base );
	InverseStates run( const lw_transform& pose, const double* start, const InverseOptions& options, lw_query* query );

private:
	void makeBounds();
	void begin( const lw_transform& pose, const double* start );
	void setDraw();
	bool step( const InverseOptions& options, lw_query* query );
	bool settle( State& q ) const;
	bool hasPose( const State& q );
	bool isKnown( const State& q, double apart ) const;
	void keep( const State& q, const InverseOptions& options, lw_query* query );
	void addTurns( std::size_t turning, State& q, const InverseOptions& options, lw_query* query );
	double distanceToStart( const State& q ) const;
	void sort( const InverseOptions& options );
	double nearMiddle( std::size_t variable, double value ) const;
	void explain( const InverseOptions& options );
	std::string nameGroup() const;

	const io::Problem& m_problem;
	io::Frame m_tip, m_base;
	Chain m_chain;
	PoseErrors m_errors;
	Descent m_descent;
	std::vector<Interval> m_limits;
	std::vector<std::size_t> m_turning; ///< variables that descents turn freely, and settle() turns back
	std::vector<char> m_circles;        ///< [variables] a whole turn leaves the tip where it is
	std::vector<char> m_turns;          ///< [variables] of m_turning
	Bounds m_bounds, m_draw;
	std::size_t m_freedoms = 0; ///< that move the tip
	Query m_query;
	State m_full;
	std::vector<lw_transform> m_links;

	// of one run
	Pose m_wanted;
	State m_start, m_q;
	std::optional<Random> m_random;
	std::vector<State> m_known; ///< one for each branch, whatever its clearance
	std::size_t m_free = 0, m_in_vain = 0;
	PoseExcess m_best{};
	InverseStates m_result;
};

Inverse::Search::Search(
    const io::RobotModel& robot, const io::Problem& problem, const io::Frame& tip, const io::Frame& base )
    : m_problem( problem ), m_tip( tip ), m_base( base ), m_chain( robot, problem ), m_errors( m_chain, tip, base ),
      m_descent( m_chain, m_errors.moving(), PoseErrors::rows ), m_limits( jointLimits( problem ) ),
      m_full( problem.reference ), m_links( lw_robot_link_count( problem.robot.get() ) )
{
	for ( std::size_t i = 0; i < m_chain.freedoms().size(); ++i )
	{
		m_freedoms += m_errors.moving()[i] ? 1 : 0;
		if ( m_chain.freedoms()[i].turn >= 0 && m_errors.moving()[i] )
		{
			throw io::Error( robot.urdf_file, nameGroup(), "has a floating joint, which moves the tip anywhere",
			    "choose a group without it, or search goal states" );
		}
	}
	if ( m_freedoms == 0 )
	{
		const std::string name =
		    tip.link == LW_INVALID_INDEX ? "the planning frame" : lw_robot_link_name( problem.robot.get(), tip.link );
		throw io::Error( robot.urdf_file, nameGroup(),
		    fmt::format( "no joint of it moves {} in the frame of the poses", name ),
		    "choose the group of its arm, or another link" );
	}
	makeBounds();
}

std::string Inverse::Search::nameGroup() const
{
	return m_problem.group.empty() ? "the robot" : "group " + m_problem.group;
}

void Inverse::Search::makeBounds()
{
	const auto count = static_cast<Eigen::Index>( m_chain.freedoms().size() );
	m_bounds = m_draw = { Eigen::VectorXd::Constant( count, -HUGE_VAL ), Eigen::VectorXd::Constant( count, HUGE_VAL ) };
	m_turns.assign( m_limits.size(), 0 );
	m_circles.assign( m_limits.size(), 0 );
	for ( std::size_t i = 0; i < m_chain.freedoms().size(); ++i )
	{
		const std::size_t variable = m_chain.freedoms()[i].variable;
		const Interval& limits = m_limits[variable];
		m_circles[variable] = m_errors.moving()[i] && m_chain.wholeTurns( i ) ? 1 : 0;
		// a millionth: files round pi
		if ( m_circles[variable] != 0 && limits.upper - limits.lower > 2 * pi - 1e-6 )
		{
			m_turning.push_back( variable );
			m_turns[variable] = 1;
			continue;
		}
		m_bounds.lower[static_cast<Eigen::Index>( i )] = limits.lower;
		m_bounds.upper[static_cast<Eigen::Index>( i )] = limits.upper;
	}
}

void Inverse::Search::begin( const lw_transform& pose, const double* start )
{
	if ( !lw_transform_is_valid( &pose ) )
	{
		wrong( "pose", "is no rigid motion: a number is not finite or too large, or the rotation is none",
		    "give a finite position and a rotation matrix, or a quaternion that is not zero" );
	}
	m_wanted = toPose( pose );
	m_wanted.r = Eigen::Quaterniond( m_wanted.r ).normalized().toRotationMatrix();
	m_errors.aim( m_wanted );
	m_start = start != nullptr ? State( start, start + m_limits.size() ) : io::startState( m_problem );
	for ( std::size_t i = 0; i < m_start.size(); ++i )
	{
		if ( !std::isfinite( m_start[i] ) )
		{
			wrong( "start", fmt::format( "joint {} is not finite", m_problem.variable_names[i] ), "give finite numbers" );
		}
	}
	m_random.reset();
	m_known.clear();
	m_free = m_in_vain = 0;
	m_best = { HUGE_VAL, HUGE_VAL };
	m_result = {};
}

/// Random states are drawn in the limits, or about the start.
void Inverse::Search::setDraw()
{
	for ( std::size_t i = 0; i < m_chain.freedoms().size(); ++i )
	{
		const auto k = static_cast<Eigen::Index>( i );
		const std::size_t variable = m_chain.freedoms()[i].variable;
		double lower = m_bounds.lower[k], upper = m_bounds.upper[k];
		const double start = std::clamp( m_start[variable], lower, upper );
		if ( upper - lower > far_limits )
		{
			const double distance = m_turns[variable] != 0 ? pi : draw_distance;
			lower = std::max( lower, start - distance );
			upper = std::min( upper, start + distance );
		}
		m_draw.lower[k] = m_errors.moving()[i] ? lower : start;
		m_draw.upper[k] = m_errors.moving()[i] ? upper : start;
	}
}

/// Turns joints back into their limits, as near to the start as they allow. @return false if one has no value there
bool Inverse::Search::settle( State& q ) const
{
	for ( const std::size_t variable : m_turning )
	{
		const Interval& joint = m_limits[variable];
		double& value = q[variable];
		const double start = std::clamp( m_start[variable], joint.lower, joint.upper );
		value = start + wrapped( value - start );
		value += value < joint.lower ? 2 * pi : value > joint.upper ? -2 * pi : 0;
		if ( !( value >= joint.lower && value <= joint.upper ) )
		{
			return false;
		}
	}
	return true;
}

/// By the engine.
bool Inverse::Search::hasPose( const State& q )
{
	lw_checker_full_state( m_problem.checker.get(), q.data(), m_full.data() );
	require( lw_robot_fk( m_problem.robot.get(), m_full.data(), m_links.data() ), "kinematics of a state" );
	const auto at = [&]( const io::Frame& frame )
	{ return frame.link == LW_INVALID_INDEX ? toPose( frame.pose ) : toPose( m_links[frame.link] ) * toPose( frame.pose ); };
	const Pose tip = inverse( at( m_base ) ) * at( m_tip );
	return ( tip.t - m_wanted.t ).norm() <= excess_rounding &&
	       logarithm( m_wanted.r.transpose() * tip.r ).norm() <= excess_rounding;
}

bool Inverse::Search::isKnown( const State& q, double apart ) const
{
	return std::any_of( m_known.begin(), m_known.end(),
	    [&]( const State& known )
	    {
		    bool same = true;
		    for ( std::size_t i = 0; same && i < q.size(); ++i )
		    {
			    const double difference = q[i] - known[i];
			    same = std::fabs( m_turns[i] != 0 ? wrapped( difference ) : difference ) < apart;
		    }
		    return same;
	    } );
}

void Inverse::Search::keep( const State& q, const InverseOptions& options, lw_query* query )
{
	InverseState state;
	state.q = q;
	if ( options.clearances )
	{
		const lw_range range = { options.min_d, options.max_d, 0 };
		lw_state_result r;
		require( lw_checker_state( m_problem.checker.get(), query, q.data(), options.flags, &range, false, &r ),
		    "clearance of a state" );
		state.lower = state.upper = HUGE_VAL;
		for ( const auto& [flag, clearance] :
		    { std::pair{ LW_CHECK_ENVIRONMENT, r.environment }, std::pair{ LW_CHECK_SELF, r.self } } )
		{
			if ( ( options.flags & flag ) != 0 )
			{
				state.lower = std::min( state.lower, clearance.lower );
				state.upper = std::min( state.upper, clearance.upper );
			}
		}
	}
	m_free += !options.clearances || state.lower > options.min_d ? 1 : 0;
	m_result.states.push_back( std::move( state ) );
}

/// All values of the joints from `turning` on, which differ by whole turns.
void Inverse::Search::addTurns( std::size_t turning, State& q, const InverseOptions& options, lw_query* query )
{
	if ( turning == m_turning.size() )
	{
		keep( q, options, query );
		return;
	}
	const Interval& joint = m_limits[m_turning[turning]];
	double& value = q[m_turning[turning]];
	const double nearest = value;
	addTurns( turning + 1, q, options, query );
	if ( std::isfinite( joint.upper - joint.lower ) )
	{
		for ( const double turn : { 2 * pi, -2 * pi } )
		{
			for ( value = nearest + turn; value >= joint.lower && value <= joint.upper; value += turn )
			{
				addTurns( turning + 1, q, options, query );
			}
		}
	}
	value = nearest;
}

/// One descent. @return false: the search is over
bool Inverse::Search::step( const InverseOptions& options, lw_query* query )
{
	m_q = m_start;
	if ( m_result.searches > 0 )
	{
		if ( !m_random )
		{
			m_random.emplace( options.seed );
			setDraw();
		}
		const double share = m_freedoms > pose_freedoms ? draw_shares[m_result.searches % std::size( draw_shares )] : 1;
		draw( m_chain.freedoms(), m_errors.moving(), m_draw, *m_random, share, m_q.data() );
	}
	++m_result.searches;
	m_descent.run( m_errors, m_bounds, m_q.data() );
	const PoseExcess excess = excessOf( m_descent.residual() );
	if ( !( excess.metres <= 0.5 * excess_rounding && excess.radians <= 0.5 * excess_rounding ) )
	{
		const auto sum = []( const PoseExcess& e ) { return e.metres + radian_length * e.radians; };
		m_best = sum( excess ) < sum( m_best ) ? excess : m_best;
		return m_result.searches < ( m_known.empty() ? ( options.searches + 3 ) / 4 : options.searches );
	}
	if ( settle( m_q ) && !isKnown( m_q, options.apart ) && hasPose( m_q ) )
	{
		m_known.push_back( m_q );
		m_in_vain = 0;
		options.turns ? addTurns( 0, m_q, options, query ) : keep( m_q, options, query );
	}
	else
	{
		++m_in_vain;
	}
	return m_free < options.states && m_result.searches < options.searches &&
	       static_cast<double>( m_in_vain ) < options.patience * static_cast<double>( m_known.size() + 1 );
}

double Inverse::Search::distanceToStart( const State& q ) const
{
	double sum = 0;
	for ( std::size_t i = 0; i < q.size(); ++i )
	{
		sum += ( q[i] - m_start[i] ) * ( q[i] - m_start[i] );
	}
	return sum;
}

void Inverse::Search::sort( const InverseOptions& options )
{
	std::vector<InverseState>& states = m_result.states;
	if ( states.size() > 1 )
	{
		std::stable_sort( states.begin(), states.end(),
		    [&]( const InverseState& a, const InverseState& b )
		    {
			    const bool first = a.lower > options.min_d, second = b.lower > options.min_d;
			    return first != second ? first : distanceToStart( a.q ) < distanceToStart( b.q );
		    } );
	}
	if ( states.size() > options.states )
	{
		states.resize( options.states );
	}
}

/// The turn of a value that is nearest to the middle of the limits.
double Inverse::Search::nearMiddle( std::size_t variable, double value ) const
{
	const double middle = 0.5 * ( m_limits[variable].lower + m_limits[variable].upper );
	return m_circles[variable] != 0 && std::isfinite( middle ) ? middle + wrapped( value - middle ) : value;
}

/// Descents with all limits lifted tell poses out of reach from poses that the limits exclude.
void Inverse::Search::explain( const InverseOptions& options )
{
	m_result.metres = m_best.metres;
	m_result.radians = m_best.radians;
	const auto count = static_cast<Eigen::Index>( m_chain.freedoms().size() );
	const Bounds none = { Eigen::VectorXd::Constant( count, -HUGE_VAL ), Eigen::VectorXd::Constant( count, HUGE_VAL ) };
	double least = HUGE_VAL;
	std::string text;
	Random random( options.seed );
	setDraw();
	for ( std::size_t i = 0; i < std::min( searches_beyond, m_result.searches ); ++i )
	{
		m_q = m_start;
		draw( m_chain.freedoms(), m_errors.moving(), m_draw, random, i == 0 ? 0 : 1, m_q.data() );
		if ( !m_descent.run( m_errors, none, m_q.data() ) )
		{
			continue;
		}
		double beyond = 0;
		std::string joints;
		for ( std::size_t k = 0; k < m_q.size(); ++k )
		{
			const double value = nearMiddle( k, m_q[k] );
			const double inside = std::clamp( value, m_limits[k].lower, m_limits[k].upper );
			if ( value != inside )
			{
				beyond += std::fabs( value - inside );
				joints += fmt::format( "{}joint {} at {:.4g}, {} its limit {:.4g}", joints.empty() ? "" : ", ",
				    m_problem.variable_names[k], value, value < inside ? "below" : "above", inside );
			}
		}
		if ( beyond > 0 && beyond < least )
		{
			least = beyond;
			text = joints;
		}
	}
	const std::string best = fmt::format( "the best of {} descents within the limits ends {:.3g} mm and {:.3g} rad away",
	    m_result.searches, 1000 * m_best.metres, m_best.radians );
	m_result.failure = text.empty() ? Failure::UNREACHABLE : Failure::OUT_OF_LIMITS;
	m_result.problem = text.empty()
	                       ? fmt::format( "no state of {} reaches the pose: {}", nameGroup(), best )
	                       : fmt::format( "the pose is reached only outside of the joint limits, with {}; {}", text, best );
	m_result.remedy = "choose another pose, another start, or a group with more joints";
}

InverseStates Inverse::Search::run(
    const lw_transform& pose, const double* start, const InverseOptions& options, lw_query* query )
{
	check( options );
	begin( pose, start );
	if ( options.clearances && query == nullptr )
	{
		if ( !m_query )
		{
			m_query = makeQuery( m_problem.checker.get() );
		}
		query = m_query.get();
	}
	while ( step( options, query ) )
	{
	}
	sort( options );
	if ( m_result.states.empty() )
	{
		explain( options );
	}
	else if ( m_free == 0 )
	{
		m_result.failure = Failure::IN_COLLISION;
		m_result.problem =
		    fmt::format( "of {} states that reach the pose none has a clearance above {} m; the best has {:.4g} m",
		        m_result.states.size(), options.min_d,
		        std::max_element( m_result.states.begin(), m_result.states.end(),
		            []( const auto& a, const auto& b ) { return a.upper < b.upper; } )
		            ->upper );
		m_result.remedy = "move the object or the pose, or allow contact of the pair";
	}
	return std::move( m_result );
}

Inverse::Inverse( const io::RobotModel& robot, const io::Problem& problem, const io::Frame& tip, const io::Frame& base )
    : m_search( std::make_unique<Search>( robot, problem, tip, base ) )
{
}

Inverse::~Inverse() = default;
Inverse::Inverse( Inverse&& ) noexcept = default;
Inverse& Inverse::operator=( Inverse&& ) noexcept = default;

InverseStates Inverse::solve( const lw_transform& pose, const double* start, const InverseOptions& options, lw_query* query )
{
	return m_search->run( pose, start, options, query );
}

} // namespace leeway::ik
