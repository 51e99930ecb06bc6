// SPDX-License-Identifier: BSD-3-Clause
// Start and goal of a plan: of a request, and of --start and --goal over it.
#include "program/ends.hpp"

#include "motions/csv.hpp"
#include "motions/names.hpp"
#include "program/options.hpp"
#include "program/plan_bounds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <tuple>

namespace leeway::cli
{
namespace
{

const char* const how_to_write = "write joint=value,joint=value, the name of a group_state, or random";

// The variable that is meant, by its name with the prefix or without. @throws io::Error
std::string variableMeant( const std::string& option, const std::string& name, const io::RobotModel& robot,
    const std::vector<std::string>& known, const std::string& prefix )
{
	const std::string full = name.rfind( prefix, 0 ) == 0 ? name : prefix + name;
	for ( const std::string& meant : { prefix + name, full } )
	{
		if ( std::find( known.begin(), known.end(), meant ) != known.end() )
		{
			return meant;
		}
	}
	const UnknownVariable why = explainUnknown( full, robot );
	refuseOption( option + " " + name, why.problem, why.remedy );
}

End parseValues( const std::string& option, const std::string& text, const io::RobotModel& robot, const std::string& prefix )
{
	End end;
	const std::vector<std::string> known = variableNames( robot );
	for ( std::size_t from = 0; from <= text.size(); )
	{
		const std::size_t comma = std::min( text.find( ',', from ), text.size() );
		const std::string part = trimmed( text.substr( from, comma - from ) );
		from = comma + 1;
		const std::size_t equals = part.rfind( '=' );
		if ( equals == std::string::npos )
		{
			refuseOption( option, fmt::format( "'{}' is not joint=value", part ), how_to_write );
		}
		const std::string name = trimmed( part.substr( 0, equals ) ), value = trimmed( part.substr( equals + 1 ) );
		const std::string meant = variableMeant( option, name, robot, known, prefix );
		const std::optional<double> number_ = finiteNumber( value );
		if ( !number_ )
		{
			refuseOption( option + " " + name, fmt::format( "'{}' is not a finite number", value ),
			    "give a finite number in radians or metres" );
		}
		if ( !end.values.emplace( meant, *number_ ).second )
		{
			refuseOption( option + " " + name, "is given twice", "remove one of them" );
		}
	}
	return end;
}

// The state of that name: of the group if it has one, else the only one there is.
const io::GroupState& findState(
    const std::string& option, const std::string& name, const std::string& group, const io::RobotModel& robot )
{
	if ( robot.srdf_file.empty() && robot.group_states.empty() )
	{
		refuseOption( option, fmt::format( "'{}' names a state, and there is no SRDF", name ),
		    "give --srdf, or write joint=value,joint=value" );
	}
	const bool own = std::any_of( robot.group_states.begin(), robot.group_states.end(),
	    [&]( const io::GroupState& state ) { return state.name == name && state.group == group; } );
	return robot.useGroupState( own ? group : "", name );
}

End valuesOf( const std::string& option, const io::GroupState& state, const io::RobotModel& robot )
{
	End end;
	end.group = state.group;
	for ( const io::JointModel& joint : robot.joints )
	{
		const std::vector<std::string> names = io::variableNames( joint );
		const auto found = state.joints.find( joint.name );
		if ( found == state.joints.end() || names.empty() ) // states may list joints that follow others
		{
			continue;
		}
		if ( found->second.size() != names.size() )
		{
			throw io::Error( robot.srdf_file.empty() ? robot.urdf_file : robot.srdf_file,
			    fmt::format( "group_state {} (for {}), joint {}", state.name, option, joint.name ),
			    fmt::format(
			        "has {}, the joint {}", counted( found->second.size(), "value" ), counted( names.size(), "value" ) ),
			    "give one for each of " + listed( names ) );
		}
		for ( std::size_t i = 0; i < names.size(); ++i )
		{
			end.values[names[i]] = found->second[i];
		}
	}
	return end;
}

// The word, unless a state has this name.
bool isRandom( const std::string& text, const io::RobotModel& robot )
{
	const bool named = std::any_of( robot.group_states.begin(), robot.group_states.end(),
	    []( const io::GroupState& state ) { return state.name == "random"; } );
	return text == "random" && !named;
}

// The input as it stands when an end is drawn.
Input withRequest( const Input& input, const io::Request& request )
{
	Input with = input;
	with.request = request;
	return with;
}

/// A humanoid has one free state in thousands; a state takes ten to a hundred microseconds.
constexpr std::size_t most_tries = 100'000, wide_tries = 2000;
constexpr double most_seconds = 5;
constexpr double pi = 3.14159265358979323846;

// The interval in which a variable is drawn. Limits that are far away mean that there are none: a way across them is a million metres long.
// A turn has all places of a joint; of two states a whole turn apart (shoulder of a UR: 720 degrees) often no path leads from one to the other.
std::pair<double, double> drawnRange( const io::Problem& problem, const lw_variable_info& info )
{
	const bool turns = info.wraps || lw_robot_joint_type( problem.robot.get(), info.joint ) == LW_JOINT_REVOLUTE;
	const double reach = turns ? pi : 1, middle = info.wraps ? 0 : std::clamp( 0.0, info.lower, info.upper );
	if ( info.wraps )
	{
		return { -reach, reach };
	}
	return info.upper - info.lower <= ( turns ? 2 * reach : far_limits )
	           ? std::pair( info.lower, info.upper )
	           : std::pair( std::max( info.lower, middle - reach ), std::min( info.upper, middle + reach ) );
}

// The share of their ranges in which joints are drawn, around the reference state: all of it, until thousands of states were in contact.
double shareOf( std::size_t tries )
{
	constexpr double shares[] = { 1, 0.5, 0.2, 0.05 };
	return tries < wide_tries ? 1 : shares[tries % 4];
}

void draw( const io::Problem& problem, std::mt19937_64& random, double around, std::vector<double>& q )
{
	for ( std::size_t i = 0; i < q.size(); ++i )
	{
		const lw_variable_info info = lw_robot_variable( problem.robot.get(), problem.variables[i] );
		const auto [lower, upper] = drawnRange( problem, info );
		const double middle = std::clamp( problem.reference[problem.variables[i]], lower, upper );
		const double share = static_cast<double>( random() >> 11 ) * 0x1p-53;
		const double wide = lower + ( upper - lower ) * share;
		q[i] = around < 1 ? middle + around * ( wide - middle ) : wide;
		if ( lw_robot_joint_type( problem.robot.get(), info.joint ) == LW_JOINT_FLOATING && info.component == 6 )
		{
			const double length = std::hypot( std::hypot( q[i - 3], q[i - 2] ), std::hypot( q[i - 1], q[i] ) );
			std::for_each( &q[i - 3], &q[i] + 1, [=]( double& part ) { part = length > 0 ? part / length : 0.5; } );
		}
	}
}

// Counts of states by the pair that was in the way.
class Blame
{
public:
	explicit Blame( const io::Problem& problem ) : m_problem( problem ) {}
	void add( const lw_state_reason& reason )
	{
		if ( reason.verdict == LW_VERDICT_BLOCKED || reason.verdict == LW_VERDICT_UNDECIDED )
		{
			++m_counts[{ reason.self, reason.pair.a, reason.pair.b }];
		}
	}
	[[noreturn]] void refuse( const std::string& option, std::size_t tries ) const
	{
		const std::string problem = fmt::format( "none of {} random states is free", tries );
		const auto most = std::max_element(
		    m_counts.begin(), m_counts.end(), []( const auto& a, const auto& b ) { return a.second < b.second; } );
		if ( most == m_counts.end() )
		{
			refuseOption( option, problem, "`leeway check` shows why; or write joint=value,joint=value" );
		}
		lw_clearance pair{};
		const auto [self, a, b] = most->first;
		pair.a = a;
		pair.b = b;
		const Named named =
		    self ? nameSelf( m_problem.checker.get(), pair ) : nameEnvironment( m_problem.checker.get(), pair );
		const double share = double( most->second ) / double( tries );
		const std::string by_hand = "write joint=value,joint=value, or the name of a group_state";
		refuseOption( option,
		    fmt::format( "{}: {} - {} were too near in {:.0f} % of them", problem, named.first, named.second,
		        std::floor( 100 * share ) ),
		    share < 0.5
		        ? by_hand
		        : fmt::format(
		              "if they may touch, add --allow {}:{}, or an SRDF (`leeway pairs --out S.srdf` writes one); or {}",
		              named.first, named.second, by_hand ) );
	}

private:
	const io::Problem& m_problem;
	std::map<std::tuple<bool, std::uint32_t, std::uint32_t>, std::size_t> m_counts;
};

/// Values of the group's joints, the same for the same seed on every machine: uniform within the limits; joints without limits, and with limits
/// that are far away, turn once and shift by a metre, and no joint turns more than once. If thousands of states are in contact, nearer to the
/// reference state too. Joints outside of the group are where input.request starts, or at zero.
/// @param option "--goal random", for the error @param seed different for start and goal
/// @throws io::Error if none of many states is free
Values randomFreeState( const std::string& option, const Input& input, const std::string& group, std::uint64_t seed )
{
	const Progress progress( "looking for a free state" );
	io::ProblemOptions options = problemOptions( input, group, {} );
	options.find_reach.reset(); // tables are for many questions
	options.notice_enclosed = false;
	const io::Problem problem = io::buildProblem( input.robot, options );
	const Query query = makeQuery( problem.checker.get() );
	std::mt19937_64 random( seed );
	std::vector<double> q( problem.variables.size() );
	Blame blame( problem );
	const double begin = now();
	std::size_t tries = 0;
	for ( ; tries < most_tries && ( tries < 2 * wide_tries || now() - begin < most_seconds ); ++tries )
	{
		draw( problem, random, shareOf( tries ), q );
		bool free = false;
		lw_state_reason reason{};
		const lw_status status =
		    lw_checker_is_free( problem.checker.get(), query.get(), q.data(), LW_CHECK_BOTH, input.min_d, &free, &reason );
		if ( status == LW_OK && free )
		{
			Values values;
			for ( std::size_t i = 0; i < q.size(); ++i )
			{
				values[problem.variable_names[i]] = q[i];
			}
			return values;
		}
		blame.add( reason );
	}
	blame.refuse( option, tries );
}

// As RViz has them for goals: metres, radians.
constexpr double place_tolerance = 1e-4, turn_tolerance = 1e-3;

// LINK=X,Y,Z or LINK=X,Y,Z,QX,QY,QZ,QW, in the planning frame.
void readGoalPose( const std::string& text, io::Request& request )
{
	const char* const format = "write LINK=X,Y,Z or LINK=X,Y,Z,QX,QY,QZ,QW";
	const std::string option = "--goal-pose " + text;
	const std::size_t equals = text.rfind( '=' );
	if ( equals == std::string::npos || trimmed( text.substr( 0, equals ) ).empty() )
	{
		refuseOption( option, "names no link", format );
	}
	const std::vector<double> numbers = numbersOf( option, text.substr( equals + 1 ), format );
	if ( numbers.size() != 3 && numbers.size() != 7 )
	{
		refuseOption( option, fmt::format( "has {}, not 3 or 7", counted( numbers.size(), "number" ) ), format );
	}
	io::PositionGoal position;
	position.link = trimmed( text.substr( 0, equals ) );
	position.element = option;
	position.regions.emplace_back();
	position.regions.back().size = { place_tolerance, 0, 0 };
	std::copy_n( numbers.begin(), 3, position.regions.back().pose.t );
	request.goal_positions.push_back( position );
	if ( numbers.size() == 3 )
	{
		return;
	}
	io::OrientationGoal orientation;
	orientation.link = position.link;
	orientation.element = option;
	orientation.tolerance.fill( turn_tolerance );
	orientation.quaternion = unitQuaternion( option, &numbers[3] );
	request.goal_orientations.push_back( orientation );
}

/// The option, and the named state that it takes: a keyframe may be called random.
std::string stateElement( const std::string& option, const std::string& text, const io::RobotModel& robot )
{
	const bool named = text.find( '=' ) == std::string::npos && !isRandom( text, robot );
	return named ? fmt::format(
	                   "{}, the state {} of {}", option, text, robot.srdf_file.empty() ? robot.urdf_file : robot.srdf_file )
	             : option;
}

void clearGoal( io::Request& request, PlanEnds& ends, const std::string& option )
{
	request.goal.clear();
	request.goal_positions.clear();
	request.goal_orientations.clear();
	ends.goal = { "command line", option };
	request.goal_file = ends.goal.file;
	request.goal_element = ends.goal.element;
}

} // namespace

std::vector<double> numbersOf( const std::string& option, const std::string& text, const std::string& remedy )
{
	std::vector<double> numbers;
	for ( std::size_t from = 0; from <= text.size(); )
	{
		const std::size_t comma = std::min( text.find( ',', from ), text.size() );
		const std::string part = trimmed( text.substr( from, comma - from ) );
		const std::optional<double> value = finiteNumber( part );
		if ( !value )
		{
			refuseOption( option, fmt::format( "'{}' is not a finite number", part ), remedy );
		}
		numbers.push_back( *value );
		from = comma + 1;
	}
	return numbers;
}

std::array<double, 4> unitQuaternion( const std::string& option, const double* numbers )
{
	const double length = std::hypot( std::hypot( numbers[0], numbers[1] ), std::hypot( numbers[2], numbers[3] ) );
	if ( !( std::fabs( length - 1 ) <= 0.01 ) )
	{
		refuseOption( option, fmt::format( "the quaternion has length {:.4g}, not 1", length ),
		    "give QX,QY,QZ,QW of length 1; 0,0,0,1 turns nothing" );
	}
	return { numbers[0] / length, numbers[1] / length, numbers[2] / length, numbers[3] / length };
}

End parseEnd( const std::string& option, const std::string& text, const std::string& group, const io::RobotModel& robot,
    const std::string& prefix )
{
	const bool named = std::any_of( robot.group_states.begin(), robot.group_states.end(),
	    [&]( const io::GroupState& state ) { return state.name == prefix + text; } );
	return named || text.find( '=' ) == std::string::npos
	           ? valuesOf( option, findState( option, prefix + text, group, robot ), robot )
	           : parseValues( option, text, robot, prefix );
}

PlanEnds readEnds( const PlanOptions& options, Input& input )
{
	const bool from_file = input.request.has_value();
	PlanEnds ends;
	ends.start = ends.goal = { options.common.request, "" };
	ends.start.element = "start_state";
	ends.goal.element = "goal_constraints";
	if ( !options.goal.empty() && !options.goal_poses.empty() )
	{
		refuseOption( "--goal-pose", "stands beside --goal", "give one of them" );
	}
	io::Request request = from_file ? *input.request : io::Request();
	std::string state_group;
	if ( !options.goal.empty() )
	{
		const std::string wanted = options.common.group.empty() ? request.group : options.common.group;
		ends.goal_is_random = isRandom( options.goal, input.robot );
		const End goal =
		    ends.goal_is_random
		        ? End{ randomFreeState( "--goal random", withRequest( input, request ), wanted, 2 * options.seed + 1 ), "" }
		        : parseEnd( "--goal", options.goal, wanted, input.robot );
		state_group = goal.group;
		clearGoal( request, ends, stateElement( "--goal", options.goal, input.robot ) );
		for ( const auto& [name, value] : goal.values )
		{
			request.goal.push_back( { name, value, 0, 0 } );
		}
		request.goal_keeps_rest = true;
	}
	else if ( !options.goal_poses.empty() )
	{
		clearGoal( request, ends, "--goal-pose" );
		for ( const std::string& pose : options.goal_poses )
		{
			readGoalPose( pose, request );
		}
	}
	else if ( !from_file && options.line.poses.empty() )
	{
		refuseOption(
		    "--goal", "is missing", std::string( how_to_write ) + ", or give --goal-pose, --line or --request Q.yaml" );
	}
	ends.group = !options.common.group.empty() ? options.common.group : request.group;
	if ( !options.start.empty() )
	{
		const std::string wanted = ends.group.empty() ? state_group : ends.group;
		const End start =
		    isRandom( options.start, input.robot )
		        ? End{ randomFreeState( "--start random", withRequest( input, request ), wanted, 2 * options.seed ), "" }
		        : parseEnd( "--start", options.start, wanted, input.robot );
		if ( ends.group.empty() && !state_group.empty() && !start.group.empty() && start.group != state_group )
		{
			refuseOption( "--start", fmt::format( "is a state of group {}, --goal of group {}", start.group, state_group ),
			    "say which moves with --group" );
		}
		state_group = state_group.empty() ? start.group : state_group;
		for ( const auto& [name, value] : start.values )
		{
			request.start.values[name] = value;
		}
	}
	if ( !options.start.empty() || !from_file )
	{
		ends.start = { "command line", stateElement( "--start", options.start, input.robot ) };
	}
	request.file = from_file ? request.file : "command line";
	ends.group = ends.group.empty() ? state_group : ends.group;
	input.request = std::move( request );
	return ends;
}

std::vector<std::vector<double>> wholeTurns( const io::Problem& problem, const std::vector<double>& q )
{
	constexpr std::size_t most = 32;
	std::vector<std::vector<double>> states = { q };
	for ( std::size_t i = 0; i < q.size(); ++i )
	{
		const lw_variable_info info = lw_robot_variable( problem.robot.get(), problem.variables[i] );
		if ( info.wraps || lw_robot_joint_type( problem.robot.get(), info.joint ) != LW_JOINT_REVOLUTE )
		{
			continue;
		}
		for ( const double value : { q[i] - 2 * pi, q[i] + 2 * pi } )
		{
			const std::size_t count = value >= info.lower && value <= info.upper ? states.size() : 0;
			for ( std::size_t k = 0; k < count && states.size() < most; ++k )
			{
				if ( states[k][i] == q[i] )
				{
					states.push_back( states[k] );
					states.back()[i] = value;
				}
			}
		}
	}
	return states;
}

void setGoal( io::Request& request, const io::Problem& problem, const std::vector<double>& q )
{
	request.goal.clear();
	for ( std::size_t i = 0; i < q.size(); ++i )
	{
		request.goal.push_back( { problem.variable_names[i], q[i], 0, 0 } );
	}
}

} // namespace leeway::cli
