// SPDX-License-Identifier: BSD-3-Clause
// Checker.goal_states(): inverse kinematics, states that are proved free. Checker.plan_line(): lines and arcs of a link's frame.
#include "objects.hpp"

#include "leeway/ik/goal_states.hpp"
#include "leeway/lines/lines.hpp"

#include <nanobind/stl/string.h>

#include <cmath>
#include <limits>

namespace leeway::python
{

namespace
{

using namespace nb::literals;

io::Request requestOf( const PyChecker& checker, const std::string& link, const lw_transform& pose, const std::string& frame,
    double position_tolerance, double angle_tolerance )
{
	io::Request request;
	request.file = "goal_states";
	request.group = checker.problem->group;
	io::PositionGoal position;
	position.link = link;
	position.frame = frame;
	position.element = "link " + link;
	io::GoalRegion region;
	region.type = io::GoalRegion::Type::Sphere;
	region.size = { position_tolerance, 0, 0 };
	region.pose = pose;
	position.regions.push_back( region );
	request.goal_positions.push_back( position );
	io::OrientationGoal orientation;
	orientation.link = link;
	orientation.frame = frame;
	orientation.element = "link " + link;
	lw_transform_to_quaternion( &pose, orientation.quaternion.data() );
	orientation.tolerance = { angle_tolerance, angle_tolerance, angle_tolerance };
	orientation.parameterization = io::OrientationGoal::Parameterization::rotation_vector;
	request.goal_orientations.push_back( orientation );
	return request;
}

nb::object goalStates( const PyChecker& checker, const std::string& link, const Doubles& pose, const std::string& frame,
    double position_tolerance, double angle_tolerance, const Whole& count, const Whole& seed, double min_d,
    const std::string& check )
{
	const io::Request request =
	    requestOf( checker, link, poseOf( pose, "pose" ), frame, position_tolerance, angle_tolerance );
	ik::Options options;
	options.seed = seed.seed();
	options.states = count.in( "count", 1, std::numeric_limits<std::uint32_t>::max() );
	options.min_d = min_d;
	options.flags = checkFlags( check );
	ik::GoalStates found;
	{
		const nb::gil_scoped_release unlocked;
		found = ik::findGoalStates( *checker.model, *checker.problem, request, options );
	}
	const NewArray<double> states( { found.states.size(), checker.variables() } );
	for ( std::size_t i = 0; i < found.states.size(); ++i )
	{
		std::copy( found.states[i].begin(), found.states[i].end(), states.data + i * checker.variables() );
	}
	const std::string message = found.problem.empty() ? "" : found.problem + "; " + found.remedy;
	return result( "GoalStates", nb::make_tuple( states.object, message.c_str() ) );
}

// ---- lines --------------------------------------------------------------------------------------------------------

/// Poses in order; a tuple of two is a pose and the place through which an arc leads there.
std::vector<lines::Waypoint> waypointsOf( const nb::object& poses )
{
	std::vector<lines::Waypoint> waypoints;
	for ( const nb::handle item : poses )
	{
		const bool arc = nb::isinstance<nb::tuple>( item ) && nb::len( item ) == 2;
		const nb::object pose = arc ? nb::object( item[0] ) : nb::borrow( item );
		waypoints.push_back( { poseOf( nb::cast<Doubles>( pose ), "poses" ) } );
		if ( arc )
		{
			const Doubles via = nb::cast<Doubles>( nb::object( item[1] ) );
			const double* place = vectorOf( via, 3, "poses", "numbers of a place" );
			waypoints.back().via = lw_vec3{ place[0], place[1], place[2] };
		}
	}
	return waypoints;
}

std::vector<double> limitOf(
    const PyChecker& checker, const nb::object& given, const char* name, std::vector<double> otherwise )
{
	if ( given.is_none() )
	{
		return otherwise;
	}
	const Doubles numbers = nb::cast<Doubles>( given );
	const double* values = vectorOf( numbers, checker.variables(), name, "variables of the group" );
	return { values, values + checker.variables() };
}

motions::MotionLimits limitsOf( const PyChecker& checker, const nb::object& velocity, const nb::object& acceleration )
{
	motions::MotionLimits limits;
	if ( velocity.is_none() )
	{
		limits = motions::motionLimits( *checker.problem, *checker.model, {} );
	}
	limits.velocity = limitOf( checker, velocity, "velocity", limits.velocity );
	limits.acceleration = limitOf(
	    checker, acceleration, "acceleration", std::vector<double>( checker.variables(), motions::default_acceleration ) );
	for ( const std::vector<double>* values : { &limits.velocity, &limits.acceleration } )
	{
		for ( const double value : *values )
		{
			if ( !( value > 0 && value < HUGE_VAL ) )
			{
				throw nb::value_error( "velocity, acceleration: limits have to be above 0, and finite" );
			}
		}
	}
	return limits;
}

nb::object lineOf( const PyChecker& checker, const lines::Result& line )
{
	const std::size_t points = line.solved ? line.segments.size() + 1 : 0, count = checker.variables();
	const NewArray<double> times( { points } ), positions( { points, count } ), velocities( { points, count } );
	for ( std::size_t i = 0; i < points; ++i )
	{
		// the first point of a cubic, or the last one of the last
		const bool last = i + 1 == points;
		const motions::Segment& s = line.segments[last ? i - 1 : i];
		const double* p = s.points.data() + ( last ? 3 * count : 0 );
		const double* q = s.points.data() + ( last ? 2 * count : count );
		times.data[i] = s.begin + ( last ? s.seconds : 0 );
		for ( std::size_t v = 0; v < count; ++v )
		{
			positions.data[i * count + v] = p[v];
			velocities.data[i * count + v] = 3 * ( last ? p[v] - q[v] : q[v] - p[v] ) / s.seconds;
		}
	}
	const std::string message = line.solved ? std::string() : lines::describe( *checker.problem, line );
	return result( "Line", nb::make_tuple( line.solved, times.object, positions.object, velocities.object,
	                           line.position_error, line.angle_error, line.attempts, message.c_str() ) );
}

nb::object planLine( const PyChecker& checker, const std::string& link, const nb::object& poses, const nb::object& start,
    const nb::object& tip, const std::string& frame, const nb::object& free_axis, double tolerance, double angle,
    double speed, const nb::object& velocity, const nb::object& acceleration, const Whole& seed, const Whole& attempts,
    double min_d, const std::string& check )
{
	const io::Problem& problem = *checker.problem;
	lines::Task task;
	task.tip = io::findFrame( problem, link, "plan_line", "link" );
	const lw_transform offset = poseOrIdentity( tip, "tip" );
	task.tip.pose = lw_transform_multiply( &task.tip.pose, &offset );
	task.base = io::findFrame( problem, frame, "plan_line", "frame" );
	task.waypoints = waypointsOf( poses );
	task.any_start = start.is_none();
	if ( !task.any_start )
	{
		const Doubles numbers = nb::cast<Doubles>( start );
		const double* values = vectorOf( numbers, checker.variables(), "start", "variables of the group" );
		task.start.assign( values, values + checker.variables() );
	}
	if ( !free_axis.is_none() )
	{
		const Doubles numbers = nb::cast<Doubles>( free_axis );
		const double* axis = vectorOf( numbers, 3, "free_axis", "numbers" );
		task.free_axis = lw_vec3{ axis[0], axis[1], axis[2] };
	}
	task.tolerance = tolerance;
	task.angle = angle;
	task.speed = speed;
	lines::Settings settings;
	settings.edge.min_d = min_d;
	settings.edge.flags = checkFlags( check );
	settings.limits = limitsOf( checker, velocity, acceleration );
	settings.seed = seed.seed();
	settings.attempts = attempts.in( "attempts", 1, std::numeric_limits<std::uint32_t>::max() );
	lines::Result line;
	{
		const nb::gil_scoped_release unlocked;
		line = lines::planLines( *checker.model, problem, task, settings );
	}
	return lineOf( checker, line );
}

void bindLine( nb::class_<PyChecker>& type )
{
	const lines::Task task;
	const lines::Settings settings;
	type.def( "plan_line", &planLine, "link"_a, "poses"_a, nb::kw_only(), "start"_a = nb::none(), "tip"_a = nb::none(),
	    "frame"_a = "", "free_axis"_a = nb::none(), "tolerance"_a = task.tolerance, "angle"_a = task.angle,
	    "speed"_a = HUGE_VAL, "velocity"_a = nb::none(), "acceleration"_a = nb::none(), "seed"_a.none() = settings.seed,
	    "attempts"_a.none() = settings.attempts, "min_d"_a = 0.0, "check"_a = "both",
	    nb::sig(
	        "def plan_line(self, link: str, poses: typing.Sequence, *, start: numpy.typing.ArrayLike | None = None, "
	        "tip: numpy.typing.ArrayLike | None = None, frame: str = '', free_axis: numpy.typing.ArrayLike | None = None, "
	        "tolerance: float = 0.0001, angle: float = 0.0017, speed: float = float('inf'), "
	        "velocity: numpy.typing.ArrayLike | None = None, acceleration: numpy.typing.ArrayLike | None = None, "
	        "seed: int = 1, attempts: int = 100, min_d: float = 0.0, check: str = 'both') -> leeway.results.Line" ),
	    "A link's frame (or `tip` in it, a pose) goes straight from pose to pose, by cubics of the joints that are proved to stay on the\n"
	    "line, free, and within limits, at all times.\n\n"
	    "poses: each as of goal_states(), in `frame`; a tuple (pose, place) goes along the arc of a circle through the place. With `start`,\n"
	    "float64 [dof], the line begins there; without, at the first pose, in any state that has it. free_axis: of the tip, about which it may\n"
	    "turn. tolerance: metres, of each coordinate; angle: radians; speed: metres per second at most. velocity, acceleration: float64 [dof]\n"
	    "limits (None: of the robot; 1). Returns Line; trajectory(times, positions, velocities) proves the same motion. Equal seeds give\n"
	    "equal answers. Raises InputError." );
}

} // namespace

void bindGoals( nb::class_<PyChecker>& type )
{
	const ik::Options defaults;
	type.def( "goal_states", &goalStates, "link"_a, "pose"_a, nb::kw_only(), "frame"_a = "", "position_tolerance"_a = 1e-4,
	    "angle_tolerance"_a = 1e-3, "count"_a.none() = defaults.states, "seed"_a.none() = defaults.seed, "min_d"_a = 0.0,
	    "check"_a = "both",
	    nb::sig(
	        "def goal_states(self, link: str, pose: numpy.typing.ArrayLike, *, frame: str = '', position_tolerance: float = 0.0001, "
	        "angle_tolerance: float = 0.001, count: int = 8, seed: int = 1, min_d: float = 0.0, check: str = 'both') -> "
	        "leeway.results.GoalStates" ),
	    "Inverse kinematics: states in which a link, or an attached object, has a pose, each proved free; goals for plan().\n\n"
	    "pose: a 4 x 4 matrix or x y z qx qy qz qw in `frame` (empty: the planning frame), within a ball of position_tolerance metres\n"
	    "and a turn of angle_tolerance radians about each axis (pi: any turn). Returns (states float64 [k, dof] with k <= count, the\n"
	    "nearest to `start` first; message with the reason if there is none). Equal seeds give equal states. Raises InputError." );
	bindLine( type );
}

} // namespace leeway::python
